// Ground: what it is made of and how it answers light. Pure functions of place, slope and noise; twin of nothing.

#include "lib/noise.wgsl"

// How a body's ground looks.
struct Paint {
    kind: vec4<u32>,      // 0 rock, 1 regolith, 2 living, 3 ice; 1 where there is water; body in the frame's list; 1 where there is a colour map
    province: vec4<f32>,  // radius over wavelength, or 0; bias; albedo of the low ones over the others'; octaves
    shifts: array<vec4<f32>, 8>,  // xyz: shift of each octave's lattice
    seeds: array<vec4<u32>, 2>,   // of each octave
}

struct Material {
    albedo: vec3<f32>,
    roughness: f32,
}

// Noise of one wave of paint: `q` is the place in cells of a lattice whose origin is `cell`, 2^k waves to a cell; faded where a pixel
// covers too much of a wave.
fn paint_wave(cell: vec3<i32>, q: vec3<f32>, k: u32, cell_m: f32, footprint: f32) -> f32 {
    let waves = f32(1u << k);
    let keep = clamp(1.5 - 3.0 * footprint * waves / cell_m, 0.0, 1.0);
    if keep <= 0.0 {
        return 0.0;
    }
    let p = lattice_point(cell << vec3<u32>(k), q * waves);
    return keep * gradient_noise(p.cell, p.fraction, 77u + k);
}

// 1 on high ground, 0 in low provinces, as in the height function.
fn paint_province(paint: Paint, direction: vec3<f32>) -> f32 {
    if paint.province.x <= 0.0 {
        return 1.0;
    }
    var sum = paint.province.y;
    var waves = paint.province.x;
    var weight = 1.0;
    for (var k = 0u; k < u32(paint.province.w); k++) {
        let p = lattice_point(vec3<i32>(0), direction * waves + paint.shifts[k].xyz);
        sum += weight * gradient_noise(p.cell, p.fraction, paint.seeds[k / 4u][k % 4u]);
        waves *= 2.0;
        weight *= 0.5;
    }
    return smoothstep(-0.1, 0.1, sum);
}

// Grass, rock, sand and snow. `tint`: colour from the map; `coarse`, `fine`: noise of about −1 … 1; `near`: 1 on the ground, 0 from afar.
fn living_ground(tint: vec3<f32>, height: f32, slope: f32, latitude: f32, coarse: f32, fine: f32, near: f32) -> Material {
    let light = max(dot(tint, vec3<f32>(0.2126, 0.7152, 0.0722)), 1e-3);
    // The map's own shade is kept, but dark texels are blue from haze and from the sea beside them: they become the green that lies there.
    let blue = (1.0 - smoothstep(0.08, 0.25, light)) * clamp((tint.b - 0.45 * tint.g) / (0.4 * light), 0.0, 1.0);
    let lifted = mix(pow(max(tint, vec3<f32>(0.0)), vec3<f32>(0.88)), vec3<f32>(0.92, 1.0, 0.58) * max(1.1 * light, 0.045), blue);
    var soil = lifted * (1.0 + 0.30 * coarse) * mix(1.0, clamp(0.10 / light, 1.0, 1.8), 0.6 * near);
    soil = mix(soil, soil * vec3<f32>(1.25, 1.05, 0.75), near * clamp(0.5 * fine + 0.3 * coarse, 0.0, 0.6));
    soil *= 1.0 + 0.35 * fine * near;
    let rock = vec3<f32>(0.20, 0.185, 0.17) * (1.0 + 0.30 * fine + 0.25 * coarse);
    var m = Material(soil, 0.95);
    let bare = smoothstep(0.35, 0.75, slope + 0.18 * fine + 0.08 * coarse) * mix(0.45, 1.0, near);
    m.albedo = mix(m.albedo, rock, bare);
    let beach = near * (1.0 - smoothstep(0.8, 2.4, height + 0.8 * coarse)) * (1.0 - smoothstep(0.1, 0.3, slope));
    m.albedo = mix(m.albedo, vec3<f32>(0.42, 0.36, 0.26) * (1.0 + 0.12 * fine), beach);
    // Snow line in late summer, m: 5,500 at the equator, 2,700 at 45°, at the sea from 76°.
    let c = cos(latitude);
    let line = 5850.0 * (c * c - 0.06) + 450.0 * coarse;
    let snow = smoothstep(-250.0, 250.0, height - line) * (1.0 - smoothstep(0.55, 0.95, slope + 0.1 * fine)) * near;
    m.albedo = mix(m.albedo, vec3<f32>(0.80, 0.82, 0.85) * (1.0 + 0.05 * fine), snow);
    m.roughness = mix(m.roughness, 0.6, snow);
    return m;
}

// Share of dusty ground's brightness by Lommel and Seeliger, with a Lambert part and the surge at opposition, over Lambert's:
// 1 for sun and eye at the zenith. `c0`, `c1`: cosines of incidence and emission; `phase`: cosine between sun and eye.
fn regolith_response(c0: f32, c1: f32, phase: f32) -> f32 {
    let seeliger = 2.0 * c0 / max(c0 + c1, 1e-3);
    let angle = acos(clamp(phase, -1.0, 1.0));
    let dimming = mix(1.0, 0.55, smoothstep(0.0, 1.6, angle));
    let surge = 1.0 + 0.25 * exp(-angle / 0.09);
    return mix(c0, seeliger, 0.75) * dimming * surge / 1.25;
}

// Fresnel reflectance of water (n = 1.33), Schlick.
fn water_fresnel(c: f32) -> f32 {
    return 0.02 + 0.98 * pow(clamp(1.0 - c, 0.0, 1.0), 5.0);
}

// Sun glint: luminance per illuminance, sr⁻¹, of facets whose slopes are Gaussian with the mean square of [Cox & Munk 1954]
// at 6 m/s, seen under the half vector; shadowing by the height-correlated form of GGX's.
fn water_glint(n: vec3<f32>, v: vec3<f32>, l: vec3<f32>, mean_square: f32) -> f32 {
    let h = normalize(v + l);
    let nh = max(dot(n, h), 1e-3);
    let nv = max(dot(n, v), 0.02);
    let nl = max(dot(n, l), 0.0);
    let t2 = (1.0 - nh * nh) / (nh * nh);
    let d = exp(-t2 / mean_square) / (3.14159265 * mean_square * nh * nh * nh * nh);
    let a2 = mean_square;
    let shadowing = 0.5 / max(nl * sqrt(a2 + (1.0 - a2) * nv * nv) + nv * sqrt(a2 + (1.0 - a2) * nl * nl), 1e-3);
    return water_fresnel(dot(v, h)) * d * shadowing * nl;
}
