// A baseline for `bench air`, not used by any picture: the sky after Hillaire 2020, "A Scalable and Production Ready Sky and Atmosphere
// Rendering Technique": a march with few steps, the table of isotropic multiple scattering (pass/baseline_hillaire.wgsl), and how the tables
// that hang on the eye are laid out. Bound by pass/baseline_hillaire_sky.wgsl.

#include "lib/air.wgsl"
#include "lib/sunlight.wgsl"
#include "lib/sky_pixel.wgsl"

const HILLAIRE_SKY: vec2<u32> = vec2<u32>(192u, 108u);  // §5.3
const HILLAIRE_FROXELS: u32 = 32u;                      // §5.4: each way
const HILLAIRE_REACH_M: f32 = 128000.0;

// The table of multiple scattering at a point: luminance scattered into any direction, per unit of the scattering coefficient and of illuminance.
fn hillaire_multiple(air: Air, multiple: texture_2d<f32>, linear: sampler, altitude: f32, mu_s: f32) -> vec3<f32> {
    let x = vec2<f32>(0.5 + 0.5 * sign(mu_s) * sqrt(abs(mu_s)), sqrt(clamp(altitude / air.shape.y, 0.0, 1.0)));
    let root = textureSampleLevel(multiple, linear, table_uv(x, vec2<f32>(textureDimensions(multiple))), 0.0).rgb;
    return root * root;
}

// One step of a march: the light that `length` metres of even air about a point add, dimmed by themselves alone, and their transmittance [eq. 4 of
// Hillaire 2015, "Physically Based and Unified Volumetric Rendering in Frostbite"].
struct HillaireStep {
    light: vec3<f32>,
    through: vec3<f32>,
}
fn hillaire_step(
    air: Air, media: texture_2d_array<f32>, transmittance: texture_2d_array<f32>, multiple: texture_2d<f32>, linear: sampler, slot: i32,
    path: AirPath, sun: vec4<f32>, nu: f32, phase: vec4<f32>, s: f32, length: f32,
) -> HillaireStep {
    let h = max(air_altitude(air, path, s), 0.0);
    let mu_s = (path.radius * dot(path.up, sun.xyz) + s * nu) / (air.shape.x + h);
    let matter = air_matter(air, media, slot, h);
    let lit = visible_above_limb(sun.w, sun_elevation(air.shape.x, h, mu_s)) * air_sun_transmittance(air, transmittance, linear, slot, h, mu_s);
    let source = (matter.scattering * phase) * lit
        + (matter.scattering * vec4<f32>(1.0)) * hillaire_multiple(air, multiple, linear, h, mu_s);
    let depth = matter.extinction * length;
    let through = exp(-depth);
    let mean = select(vec3<f32>(1.0), (1.0 - through) / max(depth, vec3<f32>(1e-9)), depth > vec3<f32>(1e-4));
    return HillaireStep(source * mean * length, through);
}

// The march from the path's start to `end`. Steps grow with the distance from an eye in the air, as the square of their number.
fn hillaire_march(
    air: Air, media: texture_2d_array<f32>, transmittance: texture_2d_array<f32>, multiple: texture_2d<f32>, linear: sampler, slot: i32,
    path: AirPath, end: f32, ray: vec3<f32>, sun: vec4<f32>, steps: u32,
) -> AirLight {
    let nu = dot(ray, sun.xyz);
    let phase = air_phase(air, media, slot, nu);
    var out = AirLight(vec3<f32>(0.0), vec3<f32>(1.0));
    for (var i = 0u; i < steps; i++) {
        var x = vec2<f32>(f32(i), f32(i + 1u)) / f32(steps);
        x *= select(x, vec2<f32>(1.0), path.start > 0.0);
        let length = (x.y - x.x) * end;
        let step = hillaire_step(
            air, media, transmittance, multiple, linear, slot, path, sun, nu, phase, x.x * end + HILLAIRE_AT * length, length);
        out.radiance += out.transmittance * step.light;
        out.transmittance *= step.through;
    }
    return out;
}
// Where in its step a sample lies; his own demonstration takes 0.3.
const HILLAIRE_AT: f32 = 0.3;

// The sky-view table: rows by the angle from the horizon, by its root, half above it and half below; columns by the azimuth from the sun [§5.3].
// Cosine of the zenith angle and of the azimuth at a texel.
fn hillaire_sky_ray(dip: vec2<f32>, texel: vec2<u32>) -> vec2<f32> {
    let half = HILLAIRE_SKY.y / 2u;
    let horizon = acos(clamp(-dip.x, -1.0, 1.0));
    let below = texel.y >= half;
    let row = f32(select(half - 1u - texel.y, texel.y - half, below)) / f32(half - 1u);
    let zenith = horizon + row * row * select(-horizon, PI - horizon, below);
    let column = f32(texel.x) / f32(HILLAIRE_SKY.x - 1u);
    return vec2<f32>(cos(zenith), 1.0 - 2.0 * column * column);
}
// Its texture coordinate for a view above the horizon.
fn hillaire_sky_uv(dip: vec2<f32>, mu: f32, azimuth: f32) -> vec2<f32> {
    let half = f32(HILLAIRE_SKY.y / 2u);
    let horizon = acos(clamp(-dip.x, -1.0, 1.0));
    let row = sqrt(clamp(1.0 - acos(clamp(mu, -1.0, 1.0)) / horizon, 0.0, 1.0));
    let column = sqrt(clamp(0.5 - 0.5 * azimuth, 0.0, 1.0));
    let texel = vec2<f32>(column * f32(HILLAIRE_SKY.x - 1u), (1.0 - row) * (half - 1.0));
    return (texel + 0.5) / vec2<f32>(HILLAIRE_SKY);
}
