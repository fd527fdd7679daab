// The vertex stage of every model's draw of the sky: one triangle over the picture. Not here: what a pixel is (lib/sky_pixel.wgsl).

#include "lib/frame.wgsl"

struct Varying {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    let uv = full_screen_uv(index);
    return Varying(full_screen_position(uv), uv);
}
