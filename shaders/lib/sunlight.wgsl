// Sunlight at a point: which fraction of the disc other worlds leave free, for ground, ships and the air itself.
//
// `point` is in metres from the camera, ICRF axes, like all positions of Frame and Body.

#include "lib/frame.wgsl"
#include "lib/medium.wgsl"
#include "lib/occlusion.wgsl"

// The star as a point sees it.
struct StarSeen {
    direction: vec3<f32>,
    distance: f32,
    radius: f32,  // rad
}
fn star_seen(star: vec4<f32>, point: vec3<f32>) -> StarSeen {
    let away = star.xyz - point;
    let distance = length(away);
    return StarSeen(away / distance, distance, asin_small(star.w / distance));
}

// Free fraction of its disc behind one world; 1 where that is farther away.
fn visible_behind(ball: vec4<f32>, seen: StarSeen, point: vec3<f32>) -> f32 {
    let offset = ball.xyz - point;
    let limb = limb_of_sphere(seen.direction, offset, ball.w);
    return select(visible_behind_limb(seen.radius, limb.x, limb.y), 1.0, length(offset) > seen.distance);
}

// Free fraction at a point, other worlds considered: their product, see engine/src/light/occlusion.rs. The body's own horizon is not.
fn eclipse_visible(body: Body, star: vec4<f32>, point: vec3<f32>) -> f32 {
    let seen = star_seen(star, point);
    var free = 1.0;
    for (var i = 0u; i < min(u32(max(body.ids.y, 0)), MAX_OCCLUDERS); i++) {
        free *= visible_behind(body.occluders[i], seen, point);
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
