// Where the entries of the tables of `view_table` lie. Twin of engine/src/air/model/view_space.rs, which explains it.
//
// `graded` is 1 where entries are dense at the horizon, the ground and the terminator, 0 where they are even (the thesis's). Coordinates
// run from 0 at the first entry of an axis to 1 at the last; the view axis counts texels.

#include "lib/graded.wgsl"

const HALF_TURN: f32 = 3.14159265359;

fn space_horizon_m(air: Air, altitude: f32) -> f32 {
    let h = clamp(altitude, 0.0, air.shape.y);
    return sqrt(h * (2.0 * air.shape.x + h));
}
fn space_horizon_rad(air: Air, altitude: f32) -> f32 {
    return 0.5 * HALF_TURN + atan2(space_horizon_m(air, altitude), air.shape.x);
}

fn space_height(air: Air, graded: bool, x: f32) -> f32 {
    if !graded {
        return x * air.shape.y;
    }
    let rho = x * space_horizon_m(air, air.shape.y);
    return min(rho * rho / (air.shape.x + sqrt(air.shape.x * air.shape.x + rho * rho)), air.shape.y);
}
fn space_height_x(air: Air, graded: bool, altitude: f32) -> f32 {
    if !graded {
        return clamp(altitude / air.shape.y, 0.0, 1.0);
    }
    return space_horizon_m(air, altitude) / space_horizon_m(air, air.shape.y);
}

// View angle of a texel, and 1 where the ray meets the ground.
fn space_view(air: Air, graded: bool, altitude: f32, texel: f32, size: f32) -> vec2<f32> {
    let horizon = space_horizon_rad(air, altitude);
    if !graded {
        let phi = HALF_TURN * texel / (size - 1.0);
        return vec2<f32>(phi, select(0.0, 1.0, phi > horizon));
    }
    let half = 0.5 * size;
    if texel < half {
        let y = 1.0 - texel / (half - 1.0);
        return vec2<f32>(horizon * (1.0 - y * y), 0.0);
    }
    let y = (texel - half) / (half - 1.0);
    return vec2<f32>(horizon + (HALF_TURN - horizon) * y * y, 1.0);
}
fn space_view_texel(air: Air, graded: bool, altitude: f32, phi: f32, ground: bool, size: f32) -> f32 {
    if !graded {
        return clamp(phi / HALF_TURN, 0.0, 1.0) * (size - 1.0);
    }
    let horizon = space_horizon_rad(air, altitude);
    let half = 0.5 * size;
    if ground {
        return half + sqrt(clamp((phi - horizon) / (HALF_TURN - horizon), 0.0, 1.0)) * (half - 1.0);
    }
    return (1.0 - sqrt(clamp((horizon - phi) / horizon, 0.0, 1.0))) * (half - 1.0);
}

// Cosine of the sun angle, and back.
fn space_sun(graded: bool, x: f32) -> f32 {
    let root = 1.0 - 2.0 * x;
    return select(cos(HALF_TURN * x), root * abs(root), graded);
}
fn space_sun_x(graded: bool, mu_s: f32) -> f32 {
    let c = clamp(mu_s, -1.0, 1.0);
    return select(acos(c) / HALF_TURN, 0.5 - 0.5 * sign(c) * sqrt(abs(c)), graded);
}

// Distances to the top from a height: straight up, and along the horizon.
fn space_reaches(air: Air, altitude: f32) -> vec2<f32> {
    return vec2<f32>(air.shape.y - clamp(altitude, 0.0, air.shape.y), space_horizon_m(air, altitude) + space_horizon_m(air, air.shape.y));
}

// Cosine to the zenith of a coordinate of the table of optical depth, and back.
fn space_depth(air: Air, graded: bool, altitude: f32, x: f32) -> f32 {
    if !graded {
        return cos(HALF_TURN * x);
    }
    let reaches = space_reaches(air, altitude);
    let reach = mix(reaches.x, reaches.y, x);
    if reach <= 1e-7 * air.shape.x {
        return 1.0;
    }
    let rho = space_horizon_m(air, altitude);
    let all = space_horizon_m(air, air.shape.y);
    return clamp(((all - rho) * (all + rho) - reach * reach) / (2.0 * (air.shape.x + altitude) * reach), -1.0, 1.0);
}
fn space_depth_x(air: Air, graded: bool, altitude: f32, mu: f32) -> f32 {
    if !graded {
        return acos(clamp(mu, -1.0, 1.0)) / HALF_TURN;
    }
    let reaches = space_reaches(air, altitude);
    let rho = space_horizon_m(air, altitude);
    let all = space_horizon_m(air, air.shape.y);
    let reach = air_reach((air.shape.x + clamp(altitude, 0.0, air.shape.y)) * mu, (all - rho) * (all + rho));
    return clamp((reach - reaches.x) / max(reaches.y - reaches.x, 1e-6), 0.0, 1.0);
}

// Along a path: even steps, or graded ones.
fn space_step(steps: Graded, graded: bool, x: f32, end: f32) -> f32 {
    return select(x * end, graded_step(steps, x), graded);
}
