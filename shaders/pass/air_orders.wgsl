// One order of scattering after another, for the table of lib/air_orders.wgsl: `first` gathers the light scattered once along every
// direction of the plan (and sunlight from the ground), `next` that of the order before; `turn` scatters what was gathered once more.
// The method and the plan: engine/src/air/model/orders.rs. Rust side: engine/src/render/pass/air_orders.rs; then comes air_orders_sum.wgsl.

#include "lib/air.wgsl"
#include "lib/sunlight.wgsl"
#include "lib/air_orders_plan.wgsl"

const SUN_RAD: f32 = 0.0047;
// How many azimuths of half the circle are gathered; the other half is its mirror image.
override AZIMUTHS: u32 = 8u;

struct Order {
    numbers: vec4<u32>,                // which (0: the first), how many, slot, 0
    azimuths: array<vec4<f32>, 16>,    // cosine, weight, 0, 0
}

@group(0) @binding(0) var<uniform> air: Air;
@group(0) @binding(1) var transmittance: texture_2d_array<f32>;               // of this air alone
@group(0) @binding(2) var linear: sampler;
@group(0) @binding(3) var<uniform> order: Order;
@group(0) @binding(4) var<storage, read> plan: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> gathered: array<vec4<f32>>;    // altitude, direction, sun: modes of red, of green, of blue
@group(0) @binding(6) var<storage, read_write> sources: array<vec4<f32>>;     // order, altitude, view, sun: coded modes of red, of green, of blue
@group(0) @binding(7) var<storage, read_write> irradiance: array<vec4<f32>>;  // order, altitude, sun: its fourth root; after all orders what the aureole adds
@group(0) @binding(8) var<storage, read_write> drawn: array<vec4<f32>>;       // like sources, by the phase functions' full shape
@group(0) @binding(9) var media: texture_2d_array<f32>;                       // of this air alone

// The sources of the order before at a step's altitude and zenith cosine, for every sun.
var<workgroup> red: array<vec4<f32>, ORDERS_SUNS>;
var<workgroup> green: array<vec4<f32>, ORDERS_SUNS>;
var<workgroup> blue: array<vec4<f32>, ORDERS_SUNS>;

struct Modes {
    red: vec4<f32>,
    green: vec4<f32>,
    blue: vec4<f32>,
}

fn add_modes(sum: Modes, value: vec3<f32>, c: f32, weight: f32) -> Modes {
    let c2 = 2.0 * c * c - 1.0;
    let modes = vec4<f32>(1.0, c, c2, (2.0 * c2 - 1.0) * c) * weight;
    return Modes(sum.red + modes * value.r, sum.green + modes * value.g, sum.blue + modes * value.b);
}

fn store(at: vec3<u32>, sun: u32, sum: Modes) {
    let to = ((at.y * PLAN_DIRECTIONS + at.x) * ORDERS_SUNS + sun) * 3u;
    gathered[to] = sum.red;
    gathered[to + 1u] = sum.green;
    gathered[to + 2u] = sum.blue;
}

// Cosine of the zenith angle of the k-th sun at an altitude of the table.
fn sun_mu(altitude_row: u32, k: u32) -> f32 {
    return orders_sun_mu(air, horizon_dip(air.shape.x, orders_altitude(air, altitude_row)), f32(k) / f32(ORDERS_SUNS - 1u));
}

// A thread per sun, a group per direction and altitude.
@compute @workgroup_size(32)
fn first(@builtin(workgroup_id) at: vec3<u32>, @builtin(local_invocation_index) k: u32) {
    let path = (at.y * PLAN_DIRECTIONS + at.x) * PLAN_PATH;
    let head = plan[path];
    let ground = plan[path + 1u].rgb;
    let mu = sun_mu(at.y, k);
    let across = sqrt(max((1.0 - mu * mu) * (1.0 - head.x * head.x), 0.0));
    var sum = Modes(vec4<f32>(0.0), vec4<f32>(0.0), vec4<f32>(0.0));
    for (var a = 0u; a < AZIMUTHS; a++) {
        let turn = across * order.azimuths[a].x + mu * head.x;
        let phase = min(air_phase(air, media, 0, turn), air.cap);
        var light = vec3<f32>(0.0);
        for (var i = 0u; i < PLAN_STEPS; i++) {
            let step = path + PLAN_HEAD + i * PLAN_STEP;
            let place = plan[step];
            let mu_s = clamp(place.x * mu + place.y * turn, -1.0, 1.0);
            let visible = visible_above_limb(SUN_RAD, sun_elevation(air.shape.x, place.w, mu_s));
            if visible > 0.0 {
                let turned = plan[step + 3u].rgb * phase.x + plan[step + 4u].rgb * phase.y + plan[step + 5u].rgb * phase.z + plan[step + 6u].rgb * phase.w;
                light += turned * visible * air_sun_beam(air, transmittance, linear, 1, place.w, mu_s).rgb;
            }
        }
        let mu_s = clamp(head.y * mu + head.z * turn, -1.0, 1.0);
        if max(max(ground.r, ground.g), ground.b) > 0.0 && mu_s > 0.0 {
            light += ground * (mu_s * visible_above_limb(SUN_RAD, asin_small(min(mu_s, 0.3))))
                * air_sun_beam(air, transmittance, linear, 1, 0.0, mu_s).rgb;
        }
        sum = add_modes(sum, light, order.azimuths[a].x, order.azimuths[a].y);
    }
    store(at, k, sum);
}

// The coded sources of the order before, between rows of altitude and of view.
fn source_between(z: f32, row: vec4<f32>, k: u32, channel: u32) -> vec4<f32> {
    let low = min(u32(row.x), ORDERS_ALTITUDES - 2u);
    let near = min(u32(z), ORDERS_VIEWS - 2u);
    let at = (((((order.numbers.x - 1u) * ORDERS_ALTITUDES + low) * ORDERS_VIEWS + near) * ORDERS_SUNS) + k) * 3u + channel;
    let view = ORDERS_SUNS * 3u;
    let altitude = ORDERS_VIEWS * view;
    let f = z - f32(near);
    return mix(mix(sources[at], sources[at + view], f), mix(sources[at + altitude], sources[at + altitude + view], f), row.x - f32(low));
}

@compute @workgroup_size(32)
fn next(@builtin(workgroup_id) at: vec3<u32>, @builtin(local_invocation_index) k: u32) {
    let path = (at.y * PLAN_DIRECTIONS + at.x) * PLAN_PATH;
    let head = plan[path];
    let ground = plan[path + 1u].rgb;
    let mu = sun_mu(at.y, k);
    let across = sqrt(max((1.0 - mu * mu) * (1.0 - head.x * head.x), 0.0));
    var sum = Modes(vec4<f32>(0.0), vec4<f32>(0.0), vec4<f32>(0.0));
    for (var i = 0u; i < PLAN_STEPS; i++) {
        let step = path + PLAN_HEAD + i * PLAN_STEP;
        let place = plan[step];
        let row = plan[step + 1u];
        let arrives = plan[step + 2u].rgb;
        let z = orders_view_z(place.z) * f32(ORDERS_VIEWS - 1u);
        workgroupBarrier();
        red[k] = source_between(z, row, k, 0u);
        green[k] = source_between(z, row, k, 1u);
        blue[k] = source_between(z, row, k, 2u);
        workgroupBarrier();
        for (var a = 0u; a < AZIMUTHS; a++) {
            let turn = across * order.azimuths[a].x + mu * head.x;
            let mu_s = clamp(place.x * mu + place.y * turn, -1.0, 1.0);
            let x = orders_sun_x(air, row.yz, mu_s) * f32(ORDERS_SUNS - 1u);
            let low = min(u32(x), ORDERS_SUNS - 2u);
            let f = x - f32(low);
            let azimuth = orders_azimuth(place.z, mu_s, turn);
            let source = vec3<f32>(
                orders_decode(mix(red[low], red[low + 1u], f), azimuth),
                orders_decode(mix(green[low], green[low + 1u], f), azimuth),
                orders_decode(mix(blue[low], blue[low + 1u], f), azimuth),
            );
            sum = add_modes(sum, arrives * source, order.azimuths[a].x, order.azimuths[a].y);
        }
    }
    if max(max(ground.r, ground.g), ground.b) > 0.0 {
        for (var a = 0u; a < AZIMUTHS; a++) {
            let turn = across * order.azimuths[a].x + mu * head.x;
            let x = orders_sun_x(air, vec2<f32>(0.0, 1.0), clamp(head.y * mu + head.z * turn, -1.0, 1.0)) * f32(ORDERS_SUNS - 1u);
            let low = min(u32(x), ORDERS_SUNS - 2u);
            let at_ground = (order.numbers.x - 1u) * ORDERS_ALTITUDES * ORDERS_SUNS + low;
            let root = mix(irradiance[at_ground].rgb, irradiance[at_ground + 1u].rgb, x - f32(low));
            sum = add_modes(sum, ground * root * root * root * root, order.azimuths[a].x, order.azimuths[a].y);
        }
    }
    store(at, k, sum);
}

// Illuminance on level ground by the light that scattering left going straight on: of the sky, but in no order's radiance.
fn aureole(row: u32, mu: f32) -> vec3<f32> {
    let altitude = orders_altitude(air, row);
    let lit = max(mu, 0.0) * visible_above_limb(SUN_RAD, sun_elevation(air.shape.x, altitude, mu));
    return lit * (air_sun_beam(air, transmittance, linear, 1, altitude, mu).rgb - air_sun_transmittance(air, transmittance, linear, 0, altitude, mu));
}

// A thread per sun, a group per view and altitude.
@compute @workgroup_size(32)
fn turn(@builtin(workgroup_id) at: vec3<u32>, @builtin(local_invocation_index) k: u32) {
    let kernel = PLAN_KERNELS_AT + (at.y * ORDERS_VIEWS + at.x) * PLAN_DIRECTIONS * 3u;
    let full = kernel + PLAN_DRAWN_AT - PLAN_KERNELS_AT;
    var sum = Modes(vec4<f32>(0.0), vec4<f32>(0.0), vec4<f32>(0.0));
    var sharp = Modes(vec4<f32>(0.0), vec4<f32>(0.0), vec4<f32>(0.0));
    var lit = vec3<f32>(0.0);
    for (var d = 0u; d < PLAN_DIRECTIONS; d++) {
        let at_direction = ((at.y * PLAN_DIRECTIONS + d) * ORDERS_SUNS + k) * 3u;
        let by = kernel + d * 3u;
        let light = Modes(gathered[at_direction], gathered[at_direction + 1u], gathered[at_direction + 2u]);
        sum.red += plan[by] * light.red;
        sum.green += plan[by + 1u] * light.green;
        sum.blue += plan[by + 2u] * light.blue;
        sharp.red += plan[full + d * 3u] * light.red;
        sharp.green += plan[full + d * 3u + 1u] * light.green;
        sharp.blue += plan[full + d * 3u + 2u] * light.blue;
        lit += plan[(at.y * PLAN_DIRECTIONS + d) * PLAN_PATH].w * vec3<f32>(light.red.x, light.green.x, light.blue.x);
    }
    let to = (((order.numbers.x * ORDERS_ALTITUDES + at.y) * ORDERS_VIEWS + at.x) * ORDERS_SUNS + k) * 3u;
    sources[to] = orders_encode(sum.red);
    sources[to + 1u] = orders_encode(sum.green);
    sources[to + 2u] = orders_encode(sum.blue);
    drawn[to] = orders_encode(sharp.red);
    drawn[to + 1u] = orders_encode(sharp.green);
    drawn[to + 2u] = orders_encode(sharp.blue);
    if at.x == 0u {
        if order.numbers.x == 0u {
            irradiance[(PLAN_MAX_ORDERS * ORDERS_ALTITUDES + at.y) * ORDERS_SUNS + k] = vec4<f32>(aureole(at.y, sun_mu(at.y, k)), 0.0);
        }
        irradiance[(order.numbers.x * ORDERS_ALTITUDES + at.y) * ORDERS_SUNS + k] = vec4<f32>(sqrt(sqrt(max(lit, vec3<f32>(0.0)))), 0.0);
    }
}
