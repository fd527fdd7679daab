// Sunlight at a point: which fraction of the disc other worlds leave free, for ground, ships and the air itself.
//
// `point` is in metres from the camera, ICRF axes, like all positions of Frame and Body.

#include "lib/frame.wgsl"
#include "lib/occlusion.wgsl"

struct Eclipse {
    direct: f32,   // free fraction of the sun's disc at the point
    diffuse: f32,  // the same, averaged over the surroundings that send scattered light here
}

// Scattered light has come from around: its dimming is the mean of the free fraction over four points at `reach` metres towards, away from
// and across the shadow's axis (reach: about the depth of the air, the distance that light goes between two scatterings). So the air
// in the umbra's middle keeps the little light that comes in from its rim. An estimate: right in kind, within a factor of two.
// Several occluders: the product, see engine/src/light/occlusion.rs.
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
        if limb.y > sun_rad + shift {
            continue;
        }
        out.direct *= visible_behind_limb(sun_rad, limb.x, limb.y);
        if reach <= 0.0 {
            out.diffuse = out.direct;
            continue;
        }
        // Gaps at the four points; a great disc's limb is straight enough for the one across.
        var inward = limb.y - shift;
        var across = limb.y;
        if limb.z > 0.0 {
            let apart = limb.y + limb.z;
            inward = abs(apart - shift) - limb.z;
            across = sqrt(apart * apart + shift * shift) - limb.z;
        }
        out.diffuse *= 0.25 * (visible_behind_limb(sun_rad, limb.x, limb.y + shift) + visible_behind_limb(sun_rad, limb.x, inward))
            + 0.5 * visible_behind_limb(sun_rad, limb.x, across);
    }
    return out;
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
