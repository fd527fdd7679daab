// Where along a ray through air a shadow begins and ends: the planet's own, and those that other worlds throw.
//
// A shadow is a cone about the line away from the star. With p(s) the offset of the ray from that line and ρ(s) the cone's radius, both
// linear in s, the ray is inside where |p|² < ρ²: between the roots of one quadratic.

#include "lib/sunlight.wgsl"
#include "lib/air_path.wgsl"

// Roots of a s² + 2 b s + c, a > 0, held to 0 … end; (end, end) where there are none.
fn cone_roots(a: f32, b: f32, c: f32, end: f32) -> vec2<f32> {
    let rest = b * b - a * c;
    if a <= 0.0 || rest <= 0.0 {
        return vec2<f32>(end);
    }
    let t = -b - select(-1.0, 1.0, b >= 0.0) * sqrt(rest);
    let roots = vec2<f32>(t / a, c / select(t, 1e-20, t == 0.0));
    return clamp(vec2<f32>(min(roots.x, roots.y), max(roots.x, roots.y)), vec2<f32>(0.0), vec2<f32>(end));
}

// The stretch within the planet's umbra, where no part of the sun stands above the horizon: from, to; (end, end): nowhere.
// `up_sun` is r₀ μₛ at the path's start; no difference of large squares: |p|² − R² is q − x² with q = h (2R + h).
fn air_night(bottom: f32, path: AirPath, up_sun: f32, ray_sun: f32, sun_rad: f32, end: f32) -> vec2<f32> {
    let narrows = tan(min(sun_rad, 1.0));
    let k2 = narrows * narrows;
    let slant = bottom * sqrt(1.0 + k2) * narrows;
    let q = path.altitude * (2.0 * bottom + path.altitude);
    let x = -up_sun;
    let roots = cone_roots(
        1.0 - ray_sun * ray_sun * (1.0 + k2),
        path.slope + x * ray_sun * (1.0 + k2) - slant * ray_sun,
        q - x * x * (1.0 + k2) - bottom * bottom * k2 + 2.0 * slant * x,
        end);
    let behind = x - 0.5 * (roots.x + roots.y) * ray_sun > 0.0;
    return select(vec2<f32>(end), roots, roots.y > roots.x && behind);
}

struct AirShade {
    cuts: vec4<f32>,  // where umbra and penumbra of the deepest shadow begin and end; negative: nowhere
    count: u32,       // how many shadows touch the ray
    deepest: u32,     // occluder that throws that
}

// Shadows of the body's occluders on the ray from `point` (m from the camera) to `end` metres further; `reach`: how far beyond a
// penumbra light scattered from within it still counts.
fn air_shade(body: Body, star: vec4<f32>, point: vec3<f32>, ray: vec3<f32>, end: f32, reach: f32) -> AirShade {
    var out = AirShade(vec4<f32>(-1.0), 0u, 0u);
    let count = min(u32(body.ids.y), MAX_OCCLUDERS);
    var deepest = 1e30;
    for (var i = 0u; i < count; i++) {
        let ball = body.occluders[i];
        let from_star = ball.xyz - star.xyz;
        let distance = length(from_star);
        let axis = from_star / distance;
        let d = point - ball.xyz;
        let x0 = dot(d, axis);
        let x1 = dot(ray, axis);
        if x0 + max(x1 * end, 0.0) < -ball.w {
            continue;
        }
        let p0 = d - axis * x0;
        let p1 = ray - axis * x1;
        // Radius of umbra and penumbra: ρ at the ball's centre, growing along the axis by the tangent of the cone's half angle.
        let sines = vec2<f32>(ball.w - star.w, ball.w + star.w) / distance;
        let cosines = sqrt(max(vec2<f32>(1.0) - sines * sines, vec2<f32>(1e-6)));
        let r0 = ball.w / cosines + x0 * sines / cosines;
        let r1 = x1 * sines / cosines;
        let wide = cone_cut(p0, p1, r0.y + reach, r1.y, end);
        if wide.y <= wide.x {
            continue;
        }
        out.count++;
        let nearest = length(p0 + p1 * clamp(-dot(p0, p1) / max(dot(p1, p1), 1e-12), 0.0, end)) / max(r0.y, 1.0);
        if nearest < deepest {
            deepest = nearest;
            out.deepest = i;
            out.cuts = vec4<f32>(cone_cut(p0, p1, r0.x, r1.x, end), cone_cut(p0, p1, r0.y, r1.y, end));
        }
    }
    return out;
}

// Whether the free fraction is the same on a whole stretch about `middle`, and which: of one shadow alone, 0 in its umbra, 1 outside of its penumbra.
// Negative: it is not.
fn air_shade_even(shade: AirShade, middle: f32) -> f32 {
    let dark = middle > shade.cuts.x && middle < shade.cuts.y;
    let aside = middle < shade.cuts.z || middle > shade.cuts.w;
    return select(-1.0, select(1.0, 0.0, dark), shade.count == 1u && (dark || aside));
}

// Where |p₀ + s p₁| < r₀ + s r₁ between 0 and `end`; (end, end): nowhere. A ray that turns from the axis by less than the cone opens meets
// it once: from there on it is inside where the cone widens, until there where it narrows.
fn cone_cut(p0: vec3<f32>, p1: vec3<f32>, r0: f32, r1: f32, end: f32) -> vec2<f32> {
    let a = dot(p1, p1) - r1 * r1;
    let b = dot(p0, p1) - r0 * r1;
    let c = dot(p0, p0) - r0 * r0;
    let rest = b * b - a * c;
    if rest <= 0.0 {
        return select(vec2<f32>(end), vec2<f32>(0.0, end), a < 0.0 && r0 > 0.0);
    }
    let t = -b - select(-1.0, 1.0, b >= 0.0) * sqrt(rest);
    // Beyond any end where a ray is parallel to the cone's side.
    let far = select(t / a, select(-1e30, 1e30, t >= 0.0), abs(a) < 1e-30);
    let near = c / select(t, 1e-30, t == 0.0);
    let low = min(near, far);
    let high = max(near, far);
    var cut = vec2<f32>(low, high);
    if a < 0.0 {
        cut = select(vec2<f32>(-1e30, low), vec2<f32>(high, 1e30), r1 >= 0.0);
    }
    let held = clamp(cut, vec2<f32>(0.0), vec2<f32>(end));
    let inside = r0 + 0.5 * (held.x + held.y) * r1 > 0.0;
    return select(vec2<f32>(end), held, held.y > held.x && inside);
}
