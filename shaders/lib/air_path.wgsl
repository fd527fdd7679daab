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
    path.exit = air_reach(path.slope, (top - path.altitude) * (2.0 * bottom + top + path.altitude));
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

// Altitude at distance s from the start; of four distances at once.
fn air_altitude(air: Air, path: AirPath, s: f32) -> f32 {
    return air_altitudes(air, path, vec4<f32>(s)).x;
}
fn air_altitudes(air: Air, path: AirPath, s: vec4<f32>) -> vec4<f32> {
    let bottom = air.shape.x;
    let q = path.altitude * (2.0 * bottom + path.altitude) + s * (2.0 * path.slope + s);
    return q / (bottom + sqrt(max(bottom * bottom + q, vec4<f32>(0.0))));
}
