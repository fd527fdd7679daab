// Sunlight at a point: which fraction of the disc other worlds leave free, for ground, ships and the air itself.
//
// `point` is in metres from the camera, ICRF axes, like all positions of Frame and Body.

#include "lib/frame.wgsl"
#include "lib/medium.wgsl"
#include "lib/occlusion.wgsl"

struct Eclipse {
    direct: f32,         // free fraction of the sun's disc at the point
    diffuse: vec3<f32>,  // the same, averaged over the surroundings that send scattered light here
}

const NO_ECLIPSE: Eclipse = Eclipse(1.0, vec3<f32>(1.0));

// Free fraction on each of the rings, of the sun and of all occluders: smooth enough to be found at few places of a ray. Several occluders: the
// product, see engine/src/light/occlusion.rs.
fn eclipse_around(body: Body, star: vec4<f32>, point: vec3<f32>, radius: vec4<f32>) -> vec4<f32> {
    let to_star = star.xyz - point;
    let distance = length(to_star);
    let sun = to_star / distance;
    let sun_rad = asin_small(star.w / distance);
    // Seen from the sun a ring on the ground is an ellipse: the root of the mean square of its radius.
    let mu = dot(sun, normalize(point - body.centre.xyz));
    let slant = sqrt(0.5 + 0.5 * mu * mu);
    var around = vec4<f32>(1.0);
    let count = min(u32(max(body.ids.y, 0)), MAX_OCCLUDERS);
    for (var i = 0u; i < count; i++) {
        let offset = body.occluders[i].xyz - point;
        let away = length(offset);
        if away > distance {
            continue;
        }
        let limb = limb_of_sphere(sun, offset, body.occluders[i].w);
        let shift = radius * (slant / away);
        if limb.y > sun_rad + shift.w {
            continue;
        }
        around *= vec4<f32>(
            visible_around(sun_rad, limb, shift.x), visible_around(sun_rad, limb, shift.y),
            visible_around(sun_rad, limb, shift.z), visible_around(sun_rad, limb, shift.w));
    }
    return around;
}

// Of a point's own free fraction and those of its rings.
fn eclipse_of(direct: f32, around: vec4<f32>, weight: mat4x3<f32>) -> Eclipse {
    return Eclipse(direct, vec3<f32>(direct) + weight * (around - direct));
}

// Mean free fraction on a ring of angular radius `shift` about the point for which `limb` was made by limb_of_sphere: that at the mean
// distance of the ring from the shadow's axis, which is right where the fraction grows evenly with the distance. With x that of the point
// it is r + x²/4r for x ≪ r and x + r²/4x for x ≫ r; the root joins them, 4 % too far at x = r. A great disc's limb is straight: the mean
// of two points.
fn visible_around(sun_rad: f32, limb: vec3<f32>, shift: f32) -> f32 {
    if limb.z > 0.0 {
        let x2 = (limb.y + limb.z) * (limb.y + limb.z);
        let r2 = shift * shift;
        return visible_behind_limb(sun_rad, limb.x, sqrt(x2 + r2 - 0.5 * x2 * r2 / max(x2 + r2, 1e-30)) - limb.z);
    }
    let aside = 0.70710678 * shift;
    return 0.5 * (visible_behind_limb(sun_rad, limb.x, limb.y - aside) + visible_behind_limb(sun_rad, limb.x, limb.y + aside));
}

// Free fraction of the sun's disc at a point, other worlds considered; the body's own horizon is not.
fn eclipse_visible(body: Body, star: vec4<f32>, point: vec3<f32>) -> f32 {
    var free = 1.0;
    let to_star = star.xyz - point;
    let distance = length(to_star);
    let sun = to_star / distance;
    let sun_rad = asin_small(star.w / distance);
    let count = min(u32(max(body.ids.y, 0)), MAX_OCCLUDERS);
    for (var i = 0u; i < count; i++) {
        let offset = body.occluders[i].xyz - point;
        if length(offset) > distance {
            continue;
        }
        let limb = limb_of_sphere(sun, offset, body.occluders[i].w);
        free *= visible_behind_limb(sun_rad, limb.x, limb.y);
    }
    return free;
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
