// The medium: an atmosphere as at most four classes that scatter side by side. Lengths in m, coefficients in m⁻¹ per channel.
//
// Twin of engine/src/air/medium/classes.rs; the struct is mirrored in engine/src/scene/gpu_air.rs. Up to four analytic layers are formulas
// of altitude; any other medium is a table: `media`, a layer per slot, with rows over altitude (scattering of the four classes, extinction)
// and over angle (phase functions, and those of the aureole, a class per channel). A pipeline that is drawn with for formulas alone sets
// MEDIA_TABLES to false and does not even carry the branch.

#include "lib/phase.wgsl"

override MEDIA_TABLES: bool = true;

const MAX_AIRS: u32 = 32u;
const AIR_FLOOR_M: f32 = 10000.0;  // Medium::FLOOR_M
const MEDIA_COLUMNS: u32 = 1024u;
const MEDIA_EXTINCTION: u32 = 4u;
const MEDIA_PHASE: u32 = 5u;
const MEDIA_AUREOLE: u32 = 6u;

struct Air {
    shape: vec4<f32>,           // radius of the datum, altitude of the top, 1 where the medium is a table, 1 where density jumps
    albedo: vec4<f32>,          // rgb: of the ground; w: root of floor / top, for tables
    scattering: mat4x3<f32>,    // a column per class at density 1
    extinction: mat4x3<f32>,
    inverse_height: vec4<f32>,  // 1 / scale height; 0: the profile is a tent or a step
    tent_bottom: vec4<f32>,
    tent_rise: vec4<f32>,       // 1 / (peak − bottom); of a step: so much that it is one
    tent_top: vec4<f32>,
    tent_fall: vec4<f32>,       // 1 / (top − peak)
    phases: Phases,
    jumps_low: vec4<f32>,       // altitudes where density jumps; −1e9: none
    jumps_high: vec4<f32>,
    orders: vec4<f32>,          // how the sun's height is mapped in the table of further orders: SunMap of engine/src/air/model/orders.rs
    bands: array<vec4<f32>, 6>, // columns of the matrices to linear sRGB of the one or two media that draw it; w of a first: that medium's slot; w of [1]: how many
    rings: array<vec4<f32>, 16>, // from how far scattered light comes: engine/src/air/model/spread.rs. Weights at the datum (w: radius), their rise with altitude, both more under a high sun
    forward: vec4<f32>,         // of what each class scatters, the share that goes straight on: engine/src/air/model/forward.rs
    cap: vec4<f32>,             // value at which its peak is then cut off, sr⁻¹
    aureole: Phases,            // where it scatters light that such peaks have turned before
    levels: array<vec4<f32>, 4>,       // roots of the altitudes of the rows of further orders, by the top's: engine/src/air/model/levels.rs
    level_steps: array<vec4<f32>, 4>,  // 1 / from each to the next; 0 after the last
    tilt: array<vec4<f32>, 4>,  // by what rings' weights grow for a view up and down at the datum; the rise of both with altitude
    ring_parts: array<vec4<f32>, 3>,  // distances in each ring along the ground, m, near to far
    pad: array<vec4<f32>, 15>,  // to a multiple of 256 bytes: any graphics card binds one air of the list
}

struct Airs {
    list: array<Air, MAX_AIRS>,
}

// What light meets at a point.
struct AirMatter {
    scattering: mat4x3<f32>,  // a column per class
    extinction: vec3<f32>,
}

// Rings about a point from which light comes that is scattered there not for the first time.
struct Rings {
    weight: mat4x3<f32>,  // a column per ring, per channel; the point itself has the rest to 1
}
fn air_rings(air: Air, altitude: f32, mu_s: f32, mu_v: f32) -> Rings {
    // Between the datum and the altitude of the second four weights rise as x (1 + x) / 2; with the sun's height evenly.
    let x = clamp(altitude * air.rings[4].w, 0.0, 1.0);
    let h = 0.5 * (x + x * x);
    let m = clamp((mu_s - air.rings[5].w) * air.rings[6].w, 0.0, 1.0);
    let tilt = 1.0 + (mu_v * mu_v) * select(air.tilt[1] + h * air.tilt[3], air.tilt[0] + h * air.tilt[2], mu_v > 0.0);
    return Rings(
        mat4x3<f32>(
            tilt.x * ring_weight(air, 0u, h, m), tilt.y * ring_weight(air, 1u, h, m),
            tilt.z * ring_weight(air, 2u, h, m), tilt.w * ring_weight(air, 3u, h, m)));
}
fn ring_weight(air: Air, k: u32, h: f32, m: f32) -> vec3<f32> {
    return air.rings[k].rgb + h * air.rings[4u + k].rgb + m * (air.rings[8u + k].rgb + h * air.rings[12u + k].rgb);
}

// From the channels of the k-th of the media that draw the air to linear sRGB. One that is not drawn in bands is the first itself.
fn air_to_rgb(air: Air, k: u32) -> mat3x3<f32> {
    return mat3x3<f32>(air.bands[3u * k].xyz, air.bands[3u * k + 1u].xyz, air.bands[3u * k + 2u].xyz);
}

// Relative density of each class of an analytic medium.
fn air_density(air: Air, altitude: f32) -> vec4<f32> {
    let h = max(altitude, -AIR_FLOOR_M);
    let tent = clamp(min((h - air.tent_bottom) * air.tent_rise, (air.tent_top - h) * air.tent_fall), vec4<f32>(0.0), vec4<f32>(1.0));
    // Far below the datum a thin layer would be denser than a number can be.
    return select(exp(min(-h * air.inverse_height, vec4<f32>(60.0))), tent, air.tent_rise > vec4<f32>(0.0));
}

// A row of the table at a column that need not be whole.
fn media_at(media: texture_2d_array<f32>, slot: i32, row: u32, column: f32) -> vec4<f32> {
    let at = clamp(column, 0.0, f32(MEDIA_COLUMNS - 1u));
    let low = min(u32(at), MEDIA_COLUMNS - 2u);
    let a = textureLoad(media, vec2<u32>(low, row), slot, 0);
    return mix(a, textureLoad(media, vec2<u32>(low + 1u, row), slot, 0), at - f32(low));
}
// Columns go by the signed root of altitude, from AIR_FLOOR_M below the datum to the top.
fn media_column(air: Air, altitude: f32) -> f32 {
    let root = sign(altitude) * sqrt(abs(altitude) / air.shape.y);
    return (root + air.albedo.w) / (1.0 + air.albedo.w) * f32(MEDIA_COLUMNS - 1u);
}

fn air_extinction(air: Air, media: texture_2d_array<f32>, slot: i32, altitude: f32) -> vec3<f32> {
    if MEDIA_TABLES && air.shape.z > 0.0 {
        return media_at(media, slot, MEDIA_EXTINCTION, media_column(air, altitude)).rgb;
    }
    return air.extinction * air_density(air, altitude);
}

fn air_matter(air: Air, media: texture_2d_array<f32>, slot: i32, altitude: f32) -> AirMatter {
    if MEDIA_TABLES && air.shape.z > 0.0 {
        let column = media_column(air, altitude);
        return AirMatter(
            mat4x3<f32>(
                media_at(media, slot, 0u, column).rgb, media_at(media, slot, 1u, column).rgb,
                media_at(media, slot, 2u, column).rgb, media_at(media, slot, 3u, column).rgb),
            media_at(media, slot, MEDIA_EXTINCTION, column).rgb);
    }
    let d = air_density(air, altitude);
    return AirMatter(
        mat4x3<f32>(air.scattering[0] * d.x, air.scattering[1] * d.y, air.scattering[2] * d.z, air.scattering[3] * d.w),
        air.extinction * d);
}

// Column of a scattering angle of this cosine: columns go by the root of the angle.
fn media_angle(c: f32) -> f32 {
    // acos loses the last of a small angle: there it is 2 asin √(½(1 − c)).
    let half = sqrt(max(0.5 - 0.5 * c, 0.0));
    let angle = select(acos(clamp(c, -1.0, 1.0)), 2.0 * half * (1.0 + half * half / 6.0), half < 0.1);
    return sqrt(angle / 3.14159265359) * f32(MEDIA_COLUMNS - 1u);
}

// Phase function of each class at the cosine of the scattering angle.
fn air_phase(air: Air, media: texture_2d_array<f32>, slot: i32, c: f32) -> vec4<f32> {
    if MEDIA_TABLES && air.shape.z > 0.0 {
        return media_at(media, slot, MEDIA_PHASE, media_angle(c));
    }
    return phase_values(air.phases, c);
}

// Where each class scatters light that forward peaks have turned before.
fn air_aureole(air: Air, media: texture_2d_array<f32>, slot: i32, c: f32) -> vec4<f32> {
    if MEDIA_TABLES && air.shape.z > 0.0 {
        return media_at(media, slot, MEDIA_AUREOLE, media_angle(c));
    }
    return phase_values(air.aureole, c);
}
