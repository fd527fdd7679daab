// Hull: materials of ships, the GGX reflection of a light with a disc, and the glow of heat.

struct Material {
    albedo: vec3<f32>,
    metallic: f32,
    roughness: f32,
    lamp: f32,       // luminance of its own, cd/m²
}

// By index; the order of `Material` in engine/src/render/pass/ship_mesh.rs.
fn hull_material(index: u32) -> Material {
    switch index {
        case 0u: { return Material(vec3<f32>(0.74, 0.73, 0.70), 0.0, 0.42, 0.0); }     // ceramic
        case 1u: { return Material(vec3<f32>(0.035, 0.036, 0.04), 0.0, 0.62, 0.0); }   // heat shield
        case 2u: { return Material(vec3<f32>(0.012, 0.015, 0.02), 0.0, 0.06, 0.0); }   // glass
        case 3u: { return Material(vec3<f32>(0.86, 0.62, 0.30), 0.9, 0.34, 0.0); }     // tank: gilt foil
        case 4u: { return Material(vec3<f32>(0.46, 0.46, 0.48), 0.9, 0.38, 0.0); }     // metal
        case 5u: { return Material(vec3<f32>(0.24, 0.22, 0.22), 0.85, 0.36, 0.0); }    // bell
        case 6u: { return Material(vec3<f32>(0.72, 0.16, 0.03), 0.0, 0.45, 0.0); }     // accent
        case 7u: { return Material(vec3<f32>(1.0, 0.04, 0.03), 0.0, 0.3, 30.0); }      // lamps
        case 8u: { return Material(vec3<f32>(0.03, 1.0, 0.15), 0.0, 0.3, 25.0); }
        default: { return Material(vec3<f32>(1.0, 0.95, 0.9), 0.0, 0.3, 30.0); }
    }
}

// Cook–Torrance with GGX and Smith's height-correlated visibility, Schlick's Fresnel [Walter et al. 2007; Heitz 2014].
// Returns reflected luminance for an illuminance of 1 lx on a surface that faces the light. Roughness is widened by the
// light's angular radius [Karis 2013].
fn ggx_reflect(m: Material, n: vec3<f32>, v: vec3<f32>, l: vec3<f32>, sigma: f32) -> vec3<f32> {
    let nl = max(dot(n, l), 0.0);
    let nv = max(dot(n, v), 1e-3);
    let h = normalize(l + v);
    let nh = max(dot(n, h), 0.0);
    let vh = max(dot(v, h), 0.0);
    let alpha = min(m.roughness * m.roughness + 0.5 * sigma, 1.0);
    let a2 = alpha * alpha;
    let d = nh * nh * (a2 - 1.0) + 1.0;
    let ggx = a2 / (3.14159265 * d * d);
    let smith = 0.5 / (nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2) + 1e-5);
    let f0 = mix(vec3<f32>(0.04), m.albedo, m.metallic);
    let fresnel = f0 + (1.0 - f0) * pow(1.0 - vh, 5.0);
    let diffuse = m.albedo * (1.0 - m.metallic) / 3.14159265 * (1.0 - fresnel);
    return (diffuse + fresnel * ggx * smith) * nl;
}

// Luminance of glowing metal against how hot it is, 0…1: dull red to yellow-white.
fn heat_glow(x: f32) -> vec3<f32> {
    let h = clamp(x, 0.0, 1.0);
    let colour = mix(vec3<f32>(1.0, 0.12, 0.01), vec3<f32>(1.0, 0.62, 0.28), h);
    return colour * 3.0e4 * h * h * h;
}

// Dark joints between panels, 0…1 (1: no joint): rings along the hull and lines along its length.
fn panel_joints(p: vec3<f32>, pixel: f32) -> f32 {
    let ring = abs(fract(p.z / 1.25 + 0.3) - 0.5) * 1.25;
    let row = floor(p.z / 1.25 + 0.3);
    let around = atan2(p.y, p.x) / 6.2831853 * 14.0 + 0.5 * (row - 2.0 * floor(0.5 * row));
    let line = abs(fract(around) - 0.5) * length(p.xy) * 6.2831853 / 14.0;
    let wide = max(0.012, 0.7 * pixel);
    let strength = min(0.012 / wide, 1.0);
    let a = smoothstep(0.0, wide, 0.625 - ring) ;
    let b = smoothstep(0.0, wide, max(length(p.xy) * 3.1415927 / 14.0 - line, 0.0));
    return 1.0 - 0.55 * strength * (1.0 - min(a, b));
}
