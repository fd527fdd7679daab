// The sum of all orders of scattering from the first few: `products` and `sum`, after air_orders.wgsl. Rust side: engine/src/render/pass/air_orders.rs.
//
// Orders follow M₂ = A M₁, M₃ = A M₂ …; their sum x solves x = M₁ + A x. A geometric tail would guess the rest from the last ratio. Better: of all
// x = M₁ + Σ yₖ Mₖ₊₁ take the one that solves it best. With z = Σ yₖ Mₖ the equation's remainder M₁ − z + A z is M₁ − Σ yₖ (Mₖ − Mₖ₊₁), which is made least in the
// mean square: this is what GMRES does in as many steps [Saad & Schultz 1986], and A z + M₁ is one step further at no cost.
// In deep air the plan brings x itself, which takes the place of all this, or of a share of it (engine/src/air/model/streams/mod.rs).

#include "lib/air_orders_plan.wgsl"

@group(0) @binding(3) var<uniform> order: vec4<u32>;                          // where the plan has the solution of deep air, how many orders, slot, whether it has one
@group(0) @binding(4) var<storage, read> sources: array<vec4<f32>>;           // order, altitude, view, sun: coded modes of red, of green, of blue
@group(0) @binding(5) var<storage, read> irradiance: array<vec4<f32>>;        // order, altitude, sun: its fourth root; then the aureole's
@group(0) @binding(6) var<storage, read_write> scalars: array<vec4<f32>>;     // products, row by row of PLAN_MAX_ORDERS
@group(0) @binding(7) var table: texture_storage_3d<rgba16float, write>;
@group(0) @binding(9) var<storage, read> drawn: array<vec4<f32>>;             // like sources, by the phase functions' full shape
@group(0) @binding(10) var<storage, read> plan: array<vec4<f32>>;
@group(0) @binding(8) var sky: texture_storage_2d_array<rgba16float, write>;

const TEXELS: u32 = ORDERS_ALTITUDES * ORDERS_VIEWS * ORDERS_SUNS;

fn mean_of(k: u32, texel: u32) -> vec3<f32> {
    let at = (k * TEXELS + texel) * 3u;
    let root = vec3<f32>(sources[at].x, sources[at + 1u].x, sources[at + 2u].x);
    return root * root * root * root;
}

var<workgroup> partial: array<vec3<f32>, 128>;

// Entry (row, column) of the normal equations; the last column is the right-hand side. Each texel counts by about its own brightness, so that twilight has its say.
@compute @workgroup_size(128)
fn products(@builtin(workgroup_id) at: vec3<u32>, @builtin(local_invocation_index) index: u32) {
    let unknowns = order.y - 1u;
    var sum = vec3<f32>(0.0);
    for (var texel = index; texel < TEXELS; texel += 128u) {
        let first = mean_of(0u, texel);
        var left = mean_of(at.x, texel) - mean_of(at.x + 1u, texel);
        var right = first;
        if at.y < unknowns {
            right = mean_of(at.y, texel) - mean_of(at.y + 1u, texel);
        }
        sum += left * right / (first + 1e-4);
    }
    partial[index] = sum;
    workgroupBarrier();
    for (var half = 64u; half > 0u; half /= 2u) {
        if index < half {
            partial[index] += partial[index + half];
        }
        workgroupBarrier();
    }
    if index == 0u {
        scalars[at.x * PLAN_MAX_ORDERS + at.y] = vec4<f32>(partial[0], 0.0);
    }
}

var<workgroup> share: array<vec3<f32>, PLAN_MAX_ORDERS>;

// Gauss elimination of the equations of one channel, scaled to a unit diagonal; a little is added to it, so that orders which are next to parallel do no harm.
fn solve(channel: u32) {
    let n = order.y - 1u;
    var a: array<array<f32, PLAN_MAX_ORDERS>, PLAN_MAX_ORDERS>;
    var scale: array<f32, PLAN_MAX_ORDERS>;
    for (var i = 0u; i < n; i++) {
        let diagonal = scalars[i * PLAN_MAX_ORDERS + i][channel];
        scale[i] = select(0.0, inverseSqrt(max(diagonal, 1e-30)), diagonal > 1e-30);
    }
    for (var i = 0u; i < n; i++) {
        for (var j = 0u; j < n; j++) {
            a[i][j] = scalars[i * PLAN_MAX_ORDERS + j][channel] * scale[i] * scale[j];
        }
        a[i][i] += select(1.0, 1e-5, scale[i] > 0.0);
        a[i][n] = scalars[i * PLAN_MAX_ORDERS + n][channel] * scale[i];
    }
    for (var i = 0u; i < n; i++) {
        let pivot = 1.0 / max(a[i][i], 1e-7);
        for (var r = i + 1u; r < n; r++) {
            let f = a[r][i] * pivot;
            for (var j = i; j <= n; j++) {
                a[r][j] -= f * a[i][j];
            }
        }
    }
    for (var back = 0u; back < n; back++) {
        let i = n - 1u - back;
        var y = a[i][n];
        for (var j = i + 1u; j < n; j++) {
            y -= a[i][j] * a[j][n];
        }
        a[i][n] = y / max(a[i][i], 1e-7);
        share[i][channel] = a[i][n] * scale[i];
    }
}

fn decoded(k: u32, texel: u32, channel: u32) -> vec4<f32> {
    let coded = drawn[(k * TEXELS + texel) * 3u + channel];
    let mean = coded.x * coded.x * coded.x * coded.x;
    return vec4<f32>(mean, mean * coded.yzw);
}

// A thread per sun, a group per view and altitude.
@compute @workgroup_size(32)
fn sum(@builtin(workgroup_id) at: vec3<u32>, @builtin(local_invocation_index) k: u32) {
    if k < 3u && order.y > 0u {
        solve(k);
    }
    workgroupBarrier();
    let texel = (at.y * ORDERS_VIEWS + at.x) * ORDERS_SUNS + k;
    let y = order.z * ORDERS_ALTITUDES + at.y;
    var deep = vec3<f32>(0.0);
    if order.w > 0u {
        deep = plan[order.x].rgb;
    }
    for (var channel = 0u; channel < 3u; channel++) {
        var all = vec4<f32>(0.0);
        for (var i = 0u; i < order.y; i++) {
            all += select(share[max(i, 1u) - 1u][channel], 1.0, i == 0u) * decoded(i, texel, channel);
        }
        if order.w > 0u {
            all = mix(all, plan[order.x + 1u + texel * 3u + channel], deep[channel]);
        }
        textureStore(table, vec3<u32>(channel * ORDERS_SUNS + k, y, at.x), orders_encode(all));
    }
    if at.x == 0u {
        var lit = vec3<f32>(0.0);
        if order.y > 0u {
            lit = irradiance[(PLAN_MAX_ORDERS * ORDERS_ALTITUDES + at.y) * ORDERS_SUNS + k].rgb;
        }
        for (var i = 0u; i < order.y; i++) {
            let root = irradiance[(i * ORDERS_ALTITUDES + at.y) * ORDERS_SUNS + k].rgb;
            let weight = select(share[max(i, 1u) - 1u], vec3<f32>(1.0), i == 0u);
            lit += weight * root * root * root * root;
        }
        if order.w > 0u {
            lit = mix(lit, plan[order.x + 1u + TEXELS * 3u + at.y * ORDERS_SUNS + k].rgb, deep);
        }
        textureStore(sky, vec2<u32>(k, at.y), order.z, vec4<f32>(sqrt(sqrt(clamp(lit, vec3<f32>(0.0), vec3<f32>(1e4)))), 1.0));
    }
}
