// Phase functions, sr⁻¹. Twin of `Phase::value` in engine/src/air/medium/phase.rs.
//
// Every analytic one is a polynomial of the cosine c times Henyey & Greenstein's lobe: (x + y c + z c²) (1 − g²) / (4π (1 + g² − 2gc)^(3/2)).
// Rayleigh: ¾ (1 + c²), g = 0. Cornette–Shanks [1992, eq. 8]: 1.5 (1 + c²) / (2 + g²). Henyey–Greenstein [1941, eq. 2], isotropic: 1.
// Elek [2008, eq. 3.2]: 0.98 + 0.35 c, g = 0. So four classes are four lanes and no branch.

struct Phases {
    g: vec4<f32>,
    x: vec4<f32>,
    y: vec4<f32>,
    z: vec4<f32>,
}

fn phase_values(p: Phases, c: f32) -> vec4<f32> {
    // (1 − |g|)² + 2|g|(1 ∓ c): nothing cancels near the peak.
    let size = abs(p.g);
    let gap = vec4<f32>(1.0) - size;
    let d = gap * gap + 2.0 * size * (vec4<f32>(1.0) - sign(p.g) * c);
    let lobe = gap * (vec4<f32>(1.0) + size) / (12.5663706144 * max(d * sqrt(d), vec4<f32>(1e-12)));
    return (p.x + c * (p.y + c * p.z)) * lobe;
}
