// Spheres seen from the camera at the origin: where a ray meets one, and the map coordinates of a direction. f32-safe.

struct SphereHit {
    distance: f32,  // along the ray to the near side (the far side from within); the closest approach where it misses
    miss: f32,      // distance of closest approach from the centre
    along: f32,     // distance along the ray of the closest approach
}

// `altitude` is the camera's height above the sphere, known better than |centre| − radius.
// Stable forms: the miss distance from the difference vector [Haines et al. 2019, Ray Tracing Gems ch. 7], the near root as c / far root.
fn sphere_hit(ray: vec3<f32>, centre: vec3<f32>, radius: f32, altitude: f32) -> SphereHit {
    let along = dot(ray, centre);
    let miss = length(ray * along - centre);
    let half = sqrt(max((radius - miss) * (radius + miss), 0.0));
    let c = altitude * (2.0 * radius + altitude);
    var out: SphereHit;
    out.along = along;
    out.miss = miss;
    if c <= 0.0 {
        out.distance = along + half;
    } else {
        out.distance = select(-1.0, c / max(along + half, 1e-6), along > 0.0);
    }
    return out;
}

// Equirectangular map coordinates of a body-fixed unit direction: u = 0.5 at longitude 0, v = 0 at the north pole.
fn equirect_uv(fixed: vec3<f32>) -> vec2<f32> {
    return vec2<f32>(atan2(fixed.y, fixed.x) / 6.28318530718 + 0.5, acos(clamp(fixed.z, -1.0, 1.0)) / 3.14159265359);
}
