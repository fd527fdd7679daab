// Sunlight at a point: which fraction of the disc other worlds leave free, for ground, ships and the air itself.
//
// `point` is in metres from the camera, ICRF axes, like all positions of Frame and Body.

#include "lib/frame.wgsl"
#include "lib/occlusion.wgsl"

struct Eclipse {
    direct: f32,   // free fraction of the sun's disc at the point
    diffuse: f32,  // the same, averaged over the surroundings that send scattered light here
}

// Scattered light has come from around, from near more than from far: of what reaches a point in air after two or more scatterings
// about four fifths have set out within a scale height or two, and the share from beyond a distance d falls like E₁(βd). The mean of
// the free fraction with that weight is taken as the point's own and those of two rings about it, at about half of `reach` and one and a half
// (reach: the depth of the air), each ring by two points 45° off the line through the shadow's axis: exact up to its third harmonic.
// For the Earth, whose air the weights were fitted to, in green and blue: 7e-4 is left on the axis of a shadow of 67 km (the integral
// gives 3e-4 in blue, 1.5e-3 in green), and within a third of the integral from the umbra's edge outwards.
// Several occluders: the product, see engine/src/light/occlusion.rs.
const NEAR_RING: vec2<f32> = vec2<f32>(0.55, 0.15);  // radius over reach, weight
const FAR_RING: vec2<f32> = vec2<f32>(1.5, 0.03);

fn eclipse_at(body: Body, star: vec4<f32>, point: vec3<f32>, reach: f32) -> Eclipse {
    var out = Eclipse(1.0, 1.0);
    let to_star = star.xyz - point;
    let distance = length(to_star);
    let sun = to_star / distance;
    let sun_rad = asin_small(star.w / distance);
    let count = min(u32(max(body.ids.y, 0)), MAX_OCCLUDERS);
    for (var i = 0u; i < count; i++) {
        let offset = body.occluders[i].xyz - point;
        let away = length(offset);
        if away > distance {
            continue;
        }
        let limb = limb_of_sphere(sun, offset, body.occluders[i].w);
        let shift = reach / away;
        if limb.y > sun_rad + FAR_RING.x * shift {
            continue;
        }
        let own = visible_behind_limb(sun_rad, limb.x, limb.y);
        out.direct *= own;
        if reach <= 0.0 {
            out.diffuse = out.direct;
            continue;
        }
        out.diffuse *= (1.0 - NEAR_RING.y - FAR_RING.y) * own
            + NEAR_RING.y * visible_around(sun_rad, limb, NEAR_RING.x * shift)
            + FAR_RING.y * visible_around(sun_rad, limb, FAR_RING.x * shift);
    }
    return out;
}

// Mean free fraction on a ring of angular radius `shift` about the point for which `limb` was made by limb_of_sphere. A great
// disc's limb is straight enough for a ring.
fn visible_around(sun_rad: f32, limb: vec3<f32>, shift: f32) -> f32 {
    let aside = 0.70710678 * shift;
    var gaps = vec2<f32>(limb.y - aside, limb.y + aside);
    if limb.z > 0.0 {
        let apart = vec2<f32>(limb.y + limb.z) + vec2<f32>(-aside, aside);
        gaps = sqrt(apart * apart + aside * aside) - limb.z;
    }
    return 0.5 * (visible_behind_limb(sun_rad, limb.x, gaps.x) + visible_behind_limb(sun_rad, limb.x, gaps.y));
}

// Free fraction of the sun's disc at a point, other worlds considered; the body's own horizon is not.
fn eclipse_visible(body: Body, star: vec4<f32>, point: vec3<f32>) -> f32 {
    if body.ids.y <= 0 {
        return 1.0;
    }
    return eclipse_at(body, star, point, 0.0).direct;
}

// Altitude above the datum of a point given from the camera: from the camera's own altitude, without |p| − R.
fn altitude_of(body: Body, point: vec3<f32>) -> f32 {
    let radius = body.centre.w;
    let h = body.up.w;
    let q = h * (2.0 * radius + h) + 2.0 * (radius + h) * dot(body.up.xyz, point) + dot(point, point);
    return q / (radius + sqrt(max(radius * radius + q, 0.0)));
}

// Angle of the sun's centre above the horizon of a sphere, rad: exact near zero, rising more slowly beyond, right in sign. Below the
// sphere's surface the horizon is level.
fn sun_elevation(radius: f32, altitude: f32, mu_s: f32) -> f32 {
    let h = max(altitude, 0.0);
    let sine_dip = sqrt(h * (2.0 * radius + h)) / (radius + h);
    let c = clamp(mu_s, -1.0, 1.0);
    let sine = c * (radius / (radius + h)) + sqrt(1.0 - c * c) * sine_dip;
    return sine * (1.0 + sine * sine / 6.0);
}
