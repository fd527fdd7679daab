// Bloom: one step down or up the chain. Rust side: engine/src/render/pass/bloom.rs.

#include "lib/frame.wgsl"

@group(1) @binding(0) var picture: texture_2d<f32>;
@group(1) @binding(1) var linear: sampler;

// 0: from a level to the next smaller one; 1: back up.
override up: f32 = 0.0;

struct Varying {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    var out: Varying;
    out.uv = full_screen_uv(index);
    out.position = full_screen_position(out.uv);
    return out;
}

fn tap(uv: vec2<f32>) -> vec3<f32> {
    return textureSampleLevel(picture, linear, uv, 0.0).rgb;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4<f32> {
    let texel = 1.0 / vec2<f32>(textureDimensions(picture));
    let uv = in.uv;
    if up > 0.5 {
        // 3 × 3 tent.
        var sum = 4.0 * tap(uv);
        sum += 2.0 * (tap(uv + texel * vec2<f32>(1.0, 0.0)) + tap(uv - texel * vec2<f32>(1.0, 0.0)));
        sum += 2.0 * (tap(uv + texel * vec2<f32>(0.0, 1.0)) + tap(uv - texel * vec2<f32>(0.0, 1.0)));
        sum += tap(uv + texel) + tap(uv - texel) + tap(uv + texel * vec2<f32>(1.0, -1.0)) + tap(uv - texel * vec2<f32>(1.0, -1.0));
        return vec4<f32>(sum / 16.0, 1.0);
    }
    // Dual filter [Bjørge 2015, "Bandwidth-efficient rendering"]: the centre and four half-texel corners; constant total weight.
    var sum = 4.0 * tap(uv);
    sum += tap(uv + texel) + tap(uv - texel) + tap(uv + texel * vec2<f32>(1.0, -1.0)) + tap(uv - texel * vec2<f32>(1.0, -1.0));
    return vec4<f32>(sum / 8.0, 1.0);
}
