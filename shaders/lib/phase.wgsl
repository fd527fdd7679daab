// Phase functions, sr⁻¹: the integral over the sphere is 1. Twin of `Phase::value` in engine/src/air/medium.rs.

const PHASE_RAYLEIGH: f32 = 2.0;  // stands for an asymmetry: no Cornette–Shanks lobe has one beyond ±1

fn rayleigh_phase(c: f32) -> f32 {
    return 0.0596831036595 * (1.0 + c * c);
}

// [Cornette & Shanks 1992, eq. 8]
fn cornette_shanks_phase(g: f32, c: f32) -> f32 {
    let d = max(1.0 + g * g - 2.0 * g * c, 1e-6);
    return 0.119366207319 * (1.0 - g * g) * (1.0 + c * c) / ((2.0 + g * g) * d * sqrt(d));
}

// By the number that stands for a layer's phase function.
fn layer_phase(asymmetry: f32, c: f32) -> f32 {
    if asymmetry > 1.5 {
        return rayleigh_phase(c);
    }
    return cornette_shanks_phase(asymmetry, c);
}
