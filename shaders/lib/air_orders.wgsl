// Further orders of scattering at a point of the air: the light that has been scattered at least once, scattered there once more.
//
// What it means and how it is found: engine/src/air/model/orders.rs. The table is a 3-D texture: x is the sun's height (a block of
// ORDERS_SUNS per channel), y the altitude (a block of ORDERS_ALTITUDES per slot of an air), z the zenith cosine of the view. A texel holds the Fourier modes
// of one channel in the azimuth from the sun: the fourth root of the mean (half floats then reach into deep twilight), and the other three by the mean.

#include "lib/medium.wgsl"

const ORDERS_SUNS: u32 = 32u;
const ORDERS_ALTITUDES: u32 = 16u;
const ORDERS_VIEWS: u32 = 20u;
const ORDERS_SIZE: vec3<f32> = vec3<f32>(3.0 * 32.0, f32(MAX_AIRS) * 16.0, 20.0);

// Sine and cosine of the angle by which the horizon lies below the level.
fn horizon_dip(radius: f32, altitude: f32) -> vec2<f32> {
    let h = max(altitude, 0.0);
    return vec2<f32>(sqrt(h * (2.0 * radius + h)), radius) / (radius + h);
}

// Coordinate of the sun, 0 to 1, from the dip and the cosine of the sun's zenith angle: air.orders holds its SunMap (scale, low, inverse,
// knee). With e the sun's angle above the horizon, t = 2 sin(e/2) = sin e / cos(e/2) keeps its digits near zero.
fn orders_sun_x(air: Air, dip: vec2<f32>, mu_s: f32) -> f32 {
    let level = sqrt(max(1.0 - mu_s * mu_s, 0.0));
    let sine = mu_s * dip.y + level * dip.x;
    let cosine = level * dip.y - mu_s * dip.x;
    let t = sine * inverseSqrt(max(0.5 + 0.5 * cosine, 1e-6));
    let low = min(t, air.orders.w) * air.orders.x;
    let asinh_low = sign(low) * log(abs(low) + sqrt(low * low + 1.0));
    return clamp((asinh_low + max(t / air.orders.w - 1.0, 0.0) + air.orders.y) * air.orders.z, 0.0, 1.0);
}
// The inverse: cosine of the sun's zenith angle.
fn orders_sun_mu(air: Air, dip: vec2<f32>, x: f32) -> f32 {
    // At low altitudes the sun stands in the zenith before x is 1.
    let y = x / air.orders.z - air.orders.y;
    let knee = air.orders.w * air.orders.x;
    let above = max(y - log(knee + sqrt(knee * knee + 1.0)), 0.0);
    let t = clamp(select(sinh(y) / air.orders.x, air.orders.w * (1.0 + above), above > 0.0), -1.41421356, sqrt(2.0 + 2.0 * dip.x));
    let sine = t * sqrt(max(1.0 - 0.25 * t * t, 0.0));
    return clamp(sine * dip.y - (1.0 - 0.5 * t * t) * dip.x, -1.0, 1.0);
}

// Coordinate of the altitude, 0 to 1: even from row to row.
fn orders_altitude_y(air: Air, altitude: f32) -> f32 {
    let root = vec4<f32>(sqrt(clamp(altitude / air.shape.y, 0.0, 1.0)));
    let zero = vec4<f32>(0.0);
    let one = vec4<f32>(1.0);
    let rows = clamp((root - air.levels[0]) * air.level_steps[0], zero, one) + clamp((root - air.levels[1]) * air.level_steps[1], zero, one)
        + clamp((root - air.levels[2]) * air.level_steps[2], zero, one) + clamp((root - air.levels[3]) * air.level_steps[3], zero, one);
    return dot(rows, one) / f32(ORDERS_ALTITUDES - 1u);
}
// Altitude of a row.
fn orders_altitude(air: Air, row: u32) -> f32 {
    let root = air.levels[row / 4u][row % 4u];
    return min(root * root, 1.0) * air.shape.y;
}

// How far the first views lie from the level: tan(e/2) by the coordinate there.
const ORDERS_NEAR: f32 = 0.6;

// Coordinate of the view's zenith cosine, 0 to 1: of tan(e/2) = x (n + (1 − n) x), e the angle from the level. Twin: view_cosine.
fn orders_view_z(mu: f32) -> f32 {
    let t = abs(mu) / (1.0 + sqrt(max(1.0 - mu * mu, 0.0)));
    let half = 0.5 * ORDERS_NEAR;
    let x = t / (half + sqrt(half * half + (1.0 - ORDERS_NEAR) * t));
    return 0.5 + 0.5 * sign(mu) * x;
}

// Cosines of 1, 2, 3 and 4 times the azimuth of a view of zenith cosine `mu` from the sun of zenith cosine `mu_s`, `turn` the cosine between the two.
fn orders_azimuth(mu: f32, mu_s: f32, turn: f32) -> vec4<f32> {
    let sines = sqrt(max((1.0 - mu * mu) * (1.0 - mu_s * mu_s), 1e-10));
    let c = clamp((turn - mu * mu_s) / sines, -1.0, 1.0);
    let c2 = 2.0 * c * c - 1.0;
    return vec4<f32>(c, c2, (2.0 * c2 - 1.0) * c, 2.0 * c2 * c2 - 1.0);
}

// A channel's value from its coded modes. A forward lobe has more modes than four; they fall about geometrically, by the ratio of the last
// two, and Σ q^k cos (3+k)φ has a closed form.
fn orders_decode(coded: vec4<f32>, azimuth: vec4<f32>) -> f32 {
    let mean = coded.x * coded.x;
    var shape = 1.0 + dot(coded.yzw, azimuth.xyz);
    if min(coded.z, coded.w) > 0.0 {
        let q = min(coded.w / coded.z, 0.85);
        shape += coded.w * q * (azimuth.w - q * azimuth.z) / (1.0 + q * q - 2.0 * q * azimuth.x);
    }
    return mean * mean * max(shape, 0.0);
}

// The other way: modes to code. Nothing that is not a number gets into the table.
fn orders_encode(modes: vec4<f32>) -> vec4<f32> {
    let mean = clamp(modes.x, 0.0, 1e12);
    if !(mean > 1e-30) {
        return vec4<f32>(0.0);
    }
    return vec4<f32>(sqrt(sqrt(mean)), clamp(modes.yzw / mean, vec3<f32>(-2.0), vec3<f32>(2.0)));
}

// Light scattered towards the eye at a point, after one scattering or more before, per unit of the scattering coefficient and of the sun's illuminance
// above the air, sr⁻¹. `mu` and `mu_s` are cosines of the zenith angles of the ray of sight and of the sun at the point, `turn` the cosine between the two.
fn air_orders(
    air: Air, table: texture_3d<f32>, linear: sampler, slot: i32, altitude: f32, mu_s: f32, mu: f32, turn: f32,
) -> vec3<f32> {
    let x = orders_sun_x(air, horizon_dip(air.shape.x, altitude), mu_s);
    let y = orders_altitude_y(air, altitude);
    let red = vec3<f32>(
        x * f32(ORDERS_SUNS - 1u) + 0.5,
        f32(slot) * f32(ORDERS_ALTITUDES) + y * f32(ORDERS_ALTITUDES - 1u) + 0.5,
        orders_view_z(mu) * f32(ORDERS_VIEWS - 1u) + 0.5,
    ) / ORDERS_SIZE;
    let azimuth = orders_azimuth(mu, mu_s, turn);
    return vec3<f32>(
        orders_decode(textureSampleLevel(table, linear, red, 0.0), azimuth),
        orders_decode(textureSampleLevel(table, linear, red + vec3<f32>(1.0 / 3.0, 0.0, 0.0), 0.0), azimuth),
        orders_decode(textureSampleLevel(table, linear, red + vec3<f32>(2.0 / 3.0, 0.0, 0.0), 0.0), azimuth),
    );
}
