// A baseline for `bench air`, not used by any picture: the 4-D table of Bruneton & Neyret 2008, "Precomputed Atmospheric Scattering", with
// the coordinates of Bruneton 2017, "Precomputed Atmospheric Scattering: a New Implementation". Baked by pass/baseline_bruneton.wgsl, drawn by
// pass/baseline_bruneton_sky.wgsl.
//
// A texture of three dimensions holds four: x is the cosine ν between view and sun (a block for each of its values) and the sun's height
// within a block, y the view's zenith cosine μ (rays that meet the ground in the lower half), z the altitude. `sizes`: altitude, μ, μₛ, ν.

#include "lib/air.wgsl"

const BRUNETON_SCALE: f32 = 4096.0;     // what textures hold is radiance times this
const BRUNETON_MU_S_MIN: f32 = -0.20791;  // sun at 102°

struct BrunetonPoint {
    altitude: f32,
    mu: f32,
    mu_s: f32,
    nu: f32,
    ground: bool,
}

// H² = R_top² − R².
fn bruneton_h2(air: Air) -> f32 {
    return air.shape.y * (2.0 * air.shape.x + air.shape.y);
}

// Sun's coordinate, 0 to 1, by the distance to the top from the datum towards it, and the inverse.
fn bruneton_sun_x(air: Air, mu_s: f32) -> f32 {
    let bottom = air.shape.x;
    let reach = vec2<f32>(air_reach(bottom * mu_s, bruneton_h2(air)), air_reach(bottom * BRUNETON_MU_S_MIN, bruneton_h2(air)));
    let a = (reach - air.shape.y) / (sqrt(bruneton_h2(air)) - air.shape.y);
    return max(1.0 - a.x / a.y, 0.0) / (1.0 + a.x);
}
fn bruneton_sun_mu(air: Air, x: f32) -> f32 {
    let bottom = air.shape.x;
    let all = sqrt(bruneton_h2(air)) - air.shape.y;
    let most = (air_reach(bottom * BRUNETON_MU_S_MIN, bruneton_h2(air)) - air.shape.y) / all;
    let a = (most - x * most) / (1.0 + x * most);
    let d = air.shape.y + min(a, most) * all;
    return clamp((bruneton_h2(air) - d * d) / (2.0 * bottom * d), -1.0, 1.0);
}

// View's coordinate in texels of `count`, and the inverse: cosine and whether the ray meets the ground.
fn bruneton_view_texel(air: Air, altitude: f32, mu: f32, ground: bool, count: f32) -> f32 {
    let bottom = air.shape.x;
    let last = 0.5 * count - 1.0;
    let rho2 = altitude * (2.0 * bottom + altitude);
    let rho = sqrt(rho2);
    let slope = (bottom + altitude) * mu;
    if ground {
        let d = rho2 / max(sqrt(max(slope * slope - rho2, 0.0)) - slope, 1e-3);
        let x = clamp((d - altitude) / max(rho - altitude, 1e-3), 0.0, 1.0);
        return last - x * last;
    }
    let d = air_reach(slope, bruneton_h2(air) - rho2);
    let least = air.shape.y - altitude;
    let x = clamp((d - least) / (rho + sqrt(bruneton_h2(air)) - least), 0.0, 1.0);
    return last + 1.0 + x * last;
}
fn bruneton_view_mu(air: Air, altitude: f32, texel: u32, count: u32) -> vec2<f32> {
    let last = count / 2u - 1u;
    let r = air.shape.x + altitude;
    let rho2 = altitude * (2.0 * air.shape.x + altitude);
    let rho = sqrt(rho2);
    if texel <= last {
        let d = altitude + f32(last - texel) / f32(last) * (rho - altitude);
        return vec2<f32>(select(clamp(-(rho2 + d * d) / (2.0 * r * max(d, 1e-3)), -1.0, 1.0), -1.0, d <= 0.0), 1.0);
    }
    let least = air.shape.y - altitude;
    let d = least + f32(texel - last - 1u) / f32(last) * (rho + sqrt(bruneton_h2(air)) - least);
    return vec2<f32>(select(clamp((bruneton_h2(air) - rho2 - d * d) / (2.0 * r * max(d, 1e-3)), -1.0, 1.0), 1.0, d <= 0.0), 0.0);
}

// What a texel stands for.
fn bruneton_point(air: Air, sizes: vec4<u32>, texel: vec3<u32>) -> BrunetonPoint {
    let rho = f32(texel.z) / f32(sizes.x - 1u) * sqrt(bruneton_h2(air));
    let altitude = min(rho * rho / (air.shape.x + sqrt(air.shape.x * air.shape.x + rho * rho)), air.shape.y);
    let view = bruneton_view_mu(air, altitude, texel.y, sizes.y);
    let mu_s = bruneton_sun_mu(air, f32(texel.x % sizes.z) / f32(sizes.z - 1u));
    let nu = 2.0 * f32(texel.x / sizes.z) / f32(sizes.w - 1u) - 1.0;
    let sines = sqrt(max((1.0 - view.x * view.x) * (1.0 - mu_s * mu_s), 0.0));
    return BrunetonPoint(altitude, view.x, mu_s, clamp(nu, view.x * mu_s - sines, view.x * mu_s + sines), view.y > 0.0);
}

// The table at a point: linear in all four.
fn bruneton_at(air: Air, sizes: vec4<u32>, table: texture_3d<f32>, linear: sampler, p: BrunetonPoint) -> vec3<f32> {
    let h = clamp(p.altitude, 0.0, air.shape.y);
    let z = (sqrt(h * (2.0 * air.shape.x + h) / bruneton_h2(air)) * f32(sizes.x - 1u) + 0.5) / f32(sizes.x);
    let y = (bruneton_view_texel(air, h, clamp(p.mu, -1.0, 1.0), p.ground, f32(sizes.y)) + 0.5) / f32(sizes.y);
    let sun = bruneton_sun_x(air, clamp(p.mu_s, -1.0, 1.0)) * f32(sizes.z - 1u) + 0.5;
    let across = clamp(0.5 + 0.5 * p.nu, 0.0, 1.0) * f32(sizes.w - 1u);
    let block = min(floor(across), f32(sizes.w - 2u));
    let wide = f32(sizes.z * sizes.w);
    let a = textureSampleLevel(table, linear, vec3<f32>((block * f32(sizes.z) + sun) / wide, y, z), 0.0).rgb;
    let b = textureSampleLevel(table, linear, vec3<f32>(((block + 1.0) * f32(sizes.z) + sun) / wide, y, z), 0.0).rgb;
    return mix(a, b, across - block) / BRUNETON_SCALE;
}

// Transmittance between two points of a ray, of altitudes and zenith cosines in its direction: the ratio of those to the top.
fn bruneton_between(
    air: Air, transmittance: texture_2d_array<f32>, linear: sampler, slot: i32, h: f32, mu: f32, there: f32, mu_there: f32, ground: bool,
) -> vec3<f32> {
    var near = vec2<f32>(h, mu);
    var far = vec2<f32>(there, mu_there);
    if ground {
        near = vec2<f32>(there, -mu_there);
        far = vec2<f32>(h, -mu);
    }
    let all = air_sun_transmittance(air, transmittance, linear, slot, near.x, near.y);
    return min(all / max(air_sun_transmittance(air, transmittance, linear, slot, far.x, far.y), vec3<f32>(1e-7)), vec3<f32>(1.0));
}
