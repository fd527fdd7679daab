// The ship's shadow: how much of the sun's disc a ship leaves free at a point, from an orthographic depth map around it.
// Bind from group 1: @binding(5) depth map, @binding(6) comparison sampler, @binding(7) var<uniform> shadow: Shadow.

struct Shadow {
    map_from_icrf: mat4x4<f32>,  // camera-relative ICRF metres to map: xy −1…1, z 0 (far from the light) … 1
    shape: vec4<f32>,            // x: strength, 0 where there is no shadow at all; y: texel of the map, as a share of it; z: m of depth per unit of z; w: m across the map
}

// 1 in the open, 0 behind a ship. `sigma` is the angular radius of the sun: penumbra grows with the distance from the ship.
fn ship_shadow(shadow: Shadow, depth: texture_depth_2d, compare: sampler_comparison, point: vec3<f32>, sigma: f32) -> f32 {
    if shadow.shape.x <= 0.0 {
        return 1.0;
    }
    let p = shadow.map_from_icrf * vec4<f32>(point, 1.0);
    // The ship sits at z ≈ 0.5; a point further down the light by d metres sees a penumbra of d · 2σ.
    let behind = max(0.5 - p.z, 0.0) * shadow.shape.z;
    let blur = max(behind * sigma / max(shadow.shape.w, 1e-3), 1.2 * shadow.shape.y);
    if any(abs(p.xy) > vec2<f32>(1.0 + 2.0 * blur)) {
        return 1.0;
    }
    let uv = vec2<f32>(0.5 + 0.5 * p.x, 0.5 - 0.5 * p.y);
    let z = clamp(p.z, 0.0, 1.0) + 0.002;
    var open = 0.0;
    for (var i = 0; i < 12; i++) {
        // A spiral of 12 taps over the disc [Vogel 1979].
        let r = sqrt((f32(i) + 0.5) / 12.0);
        let a = f32(i) * 2.39996323;
        open += textureSampleCompareLevel(depth, compare, uv + blur * r * vec2<f32>(cos(a), sin(a)), z);
    }
    return mix(1.0, open / 12.0, shadow.shape.x);
}
