// Lambert's cosine for a light with a disc: the mean of max(0, cos θ) over the disc of angular radius σ.

// Exact where the disc is all above or all below the plane; between, the parabola that joins both (error under 0.15 σ).
fn sun_cosine(cosine: f32, sigma: f32) -> f32 {
    let s = max(sigma, 1e-6);
    if cosine >= s {
        return cosine;
    }
    let x = max(cosine + s, 0.0);
    return x * x / (4.0 * s);
}
