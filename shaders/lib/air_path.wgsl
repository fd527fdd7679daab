// Paths through air: where a ray enters and leaves, and how high it is on the way. f32-safe from 2 m to 60,000 km.
//
// Altitude along a ray never comes from |p| − R. With q = r² − R² = h(2R + h), a step s from a point of altitude h₀, radius r₀ and
// zenith cosine μ₀ gives q = q₀ + s(2 r₀μ₀ + s) and h = q / (R + √(R² + q)): no difference of large numbers.

#include "lib/medium.wgsl"

struct AirPath {
    start: f32,     // distance from the eye to where the air begins (0 inside); negative: the ray misses the air
    exit: f32,      // from there to where the air ends
    ground: f32,    // from there to the datum; negative: never
    radius: f32,    // r₀, at the start
    altitude: f32,  // h₀
    slope: f32,     // r₀ μ₀
    up: vec3<f32>,  // zenith at the start
}

// `up` and `altitude` are the eye's; `ray` is a unit vector.
fn air_path(air: Air, up: vec3<f32>, altitude: f32, ray: vec3<f32>) -> AirPath {
    let bottom = air.shape.x;
    let top = air.shape.y;
    let eye = bottom + altitude;
    let mu = dot(up, ray);
    var path: AirPath;
    path.start = 0.0;
    path.radius = eye;
    path.altitude = altitude;
    path.slope = eye * mu;
    path.up = up;
    if altitude > top {
        let outer = bottom + top;
        let miss = eye * length(cross(up, ray));
        if mu >= 0.0 || miss >= outer {
            path.start = -1.0;
            return path;
        }
        let half = sqrt((outer - miss) * (outer + miss));
        path.start = max(-eye * mu - half, 0.0);
        path.radius = outer;
        path.altitude = top;
        path.slope = -half;
        path.up = normalize(up * eye + ray * path.start);
    }
    let q = path.altitude * (2.0 * bottom + path.altitude);
    path.exit = air_reach(path.slope, top * (2.0 * bottom + top) - q);
    path.ground = -1.0;
    let rest = path.slope * path.slope - q;
    if path.slope < 0.0 && rest > 0.0 && q > 0.0 {
        path.ground = q / (sqrt(rest) - path.slope);
    }
    return path;
}

// Positive root of s² + 2 b s = c, for c ≥ 0.
fn air_reach(b: f32, c: f32) -> f32 {
    let rest = max(c, 0.0);
    let root = sqrt(b * b + rest);
    if b > 0.0 {
        return rest / max(b + root, 1e-6);
    }
    return root - b;
}

// Altitude at distance s from the start.
fn air_altitude(air: Air, path: AirPath, s: f32) -> f32 {
    let bottom = air.shape.x;
    let q = path.altitude * (2.0 * bottom + path.altitude) + s * (2.0 * path.slope + s);
    return q / (bottom + sqrt(max(bottom * bottom + q, 0.0)));
}

// How the steps of a march lie on a stretch from 0 to `end`: squares of equal parts counted from the lowest point, where air is
// densest, so that steps grow with the distance from it.
struct AirSteps {
    low: f32,
    scale: f32,
    offset: f32,
}
fn air_steps(path: AirPath, end: f32) -> AirSteps {
    let low = clamp(-path.slope, 0.0, end);
    let before = sqrt(low);
    let both = before + sqrt(end - low);
    return AirSteps(low, both * both, before / max(both, 1e-12));
}
// x from 0 to 1.
fn air_step(steps: AirSteps, x: f32) -> f32 {
    let y = x - steps.offset;
    return max(steps.low + steps.scale * y * abs(y), 0.0);
}

// Optical depth from 0 to `end`, by Simpson's rule on each step.
fn air_optical_depth(air: Air, path: AirPath, end: f32, count: u32) -> vec3<f32> {
    let steps = air_steps(path, end);
    var sum = vec4<f32>(0.0);
    var from_s = 0.0;
    var from_density = air_density(air, path.altitude);
    for (var i = 1u; i <= count; i++) {
        let to_s = air_step(steps, f32(i) / f32(count));
        let middle = air_density(air, air_altitude(air, path, 0.5 * (from_s + to_s)));
        let to_density = air_density(air, air_altitude(air, path, to_s));
        sum += (from_density + 4.0 * middle + to_density) * ((to_s - from_s) / 6.0);
        from_s = to_s;
        from_density = to_density;
    }
    return air.extinction * sum;
}
