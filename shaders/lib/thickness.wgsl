// The model `thickness` along a ray: widths of lit and of shadowed air. Twin of engine/src/air/model/thickness.rs, which derives it.
//
// Numbers of Sky: settings[0] colour · brightness / π, k; settings[1] 1 / unit, opacity, 1 for cones (0: cylinders), 1 for a shell
// without ground. The planet's own shadow is found from q = |p|² − R² (lib/air_path.wgsl), those of other worlds from offsets across
// their axes: each keeps its digits where the other would lose them. Bound by pass/sky_thickness.wgsl.

#include "lib/sky_pixel.wgsl"

const FOREVER: f32 = 1e30;
const MAX_SHADOWS: u32 = 9u;  // MAX_OCCLUDERS and the planet itself

fn thickness_path(body: Body, air: Air, sky: Sky, view: SkyView) -> AirPath {
    var path = sky_path(body, air, view);
    if sky.settings[1].w > 0.5 {
        path.ground = -1.0;
    }
    return path;
}

fn thickness_light(body: Body, air: Air, star: vec4<f32>, sky: Sky, view: SkyView) -> AirLight {
    let path = thickness_path(body, air, sky, view);
    let end = sky_end(air, path, view);
    if end <= 0.0 {
        return AirLight(vec3<f32>(0.0), vec3<f32>(1.0));
    }
    let widths = thickness_widths(body, air, star, path, view.ray, end, sky.settings[1].z > 0.5);
    let lit = (widths.x + sky.settings[0].w * widths.y) * sky.settings[1].x;
    let all = (widths.x + widths.y) * sky.settings[1].x;
    return AirLight(sky.settings[0].rgb * lit, vec3<f32>(exp(-sky.settings[1].y * all)));
}

// Lit and shadowed width of the air from the path's start to `end`, m.
fn thickness_widths(body: Body, air: Air, star: vec4<f32>, path: AirPath, ray: vec3<f32>, end: f32, cones: bool) -> vec2<f32> {
    var spans: array<vec2<f32>, MAX_SHADOWS>;
    var count = 0u;
    let shadows = 1u + min(u32(max(body.ids.y, 0)), MAX_OCCLUDERS);
    for (var i = 0u; i < shadows; i++) {
        var span = vec2<f32>(0.0);
        if i == 0u {
            span = own_shadow(body, air, star, path, ray, cones);
        } else {
            span = other_shadow(body, star, body.occluders[i - 1u], ray * path.start, ray, cones);
        }
        span = clamp(span, vec2<f32>(0.0), vec2<f32>(end));
        if span.x >= span.y {
            continue;
        }
        // In order of their beginnings.
        var place = count;
        while place > 0u && spans[place - 1u].x > span.x {
            spans[place] = spans[place - 1u];
            place -= 1u;
        }
        spans[place] = span;
        count += 1u;
    }
    var shadowed = 0.0;
    var reached = 0.0;
    for (var i = 0u; i < count; i++) {
        shadowed += max(spans[i].y - max(spans[i].x, reached), 0.0);
        reached = max(reached, spans[i].y);
    }
    return vec2<f32>(end - shadowed, shadowed);
}

// Span of the ray in the planet's own shadow, from the path's start.
fn own_shadow(body: Body, air: Air, star: vec4<f32>, path: AirPath, ray: vec3<f32>, cones: bool) -> vec2<f32> {
    let radius = air.shape.x;
    let axis = -body.sun.xyz;
    // (R☉ − R) / distance, the sun's radius over its distance being the sine of its angular radius.
    let sine = select(0.0, sin(body.sun.w) * (1.0 - select(0.0, radius / star.w, star.w > 0.0)), cones);
    let cos2 = 1.0 - sine * sine;
    let m = dot(ray, axis);
    let z = path.radius * dot(path.up, axis);
    let w = z - radius * sine;
    let q = path.altitude * (2.0 * radius + path.altitude);
    let across = cross(ray, axis);
    let slab = both(half_line(w, m), half_line(radius - z * sine, -m * sine));
    return both(slab, cone_span(dot(across, across) - sine * sine, cos2 * path.slope - w * m, cos2 * q - w * w, m * sine));
}

// The same for another world; `start` is the path's start from the camera.
fn other_shadow(body: Body, star: vec4<f32>, occluder: vec4<f32>, start: vec3<f32>, ray: vec3<f32>, cones: bool) -> vec2<f32> {
    let away = occluder.xyz - star.xyz;
    let distance = max(length(away), 1.0);
    let near = star.w > 0.0;
    let axis = select(-body.sun.xyz, away / distance, near);
    let sine = select(0.0, select(sin(body.sun.w), (star.w - occluder.w) / distance, near), cones);
    let offset = start - occluder.xyz;
    let m = dot(ray, axis);
    let z = dot(offset, axis);
    let at = cross(axis, offset);
    let across = cross(axis, ray);
    let l = occluder.w - z * sine;
    let cos2 = 1.0 - sine * sine;
    let slab = both(half_line(z - occluder.w * sine, m), half_line(l, -m * sine));
    return both(slab, cone_span(dot(across, across) - sine * sine, cos2 * dot(at, across) + l * m * sine, cos2 * dot(at, at) - l * l, m * sine));
}

fn both(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(max(a.x, b.x), min(a.y, b.y));
}

// Where w + m s ≥ 0.
fn half_line(w: f32, m: f32) -> vec2<f32> {
    if abs(m) < 1e-18 {
        return select(vec2<f32>(FOREVER, -FOREVER), vec2<f32>(-FOREVER, FOREVER), w >= 0.0);
    }
    return select(vec2<f32>(-FOREVER, -w / m), vec2<f32>(-w / m, FOREVER), m > 0.0);
}

// Where a s² + 2b s + c ≤ 0; for a < 0, of its two parts the one on the cone's own side: `toward` > 0 where the ray goes toward the apex.
fn cone_span(a: f32, b: f32, c: f32, toward: f32) -> vec2<f32> {
    let d = b * b - a * c;
    if d < 0.0 && a > 0.0 {
        return vec2<f32>(FOREVER, -FOREVER);
    }
    let t = -(b + select(-1.0, 1.0, b >= 0.0) * sqrt(max(d, 0.0)));
    if t == 0.0 {
        return select(vec2<f32>(FOREVER, -FOREVER), vec2<f32>(-FOREVER, FOREVER), c <= 0.0);
    }
    let r1 = select(t / a, select(-FOREVER, FOREVER, t > 0.0), abs(a) <= abs(t) / FOREVER);
    let r2 = c / t;
    if a >= 0.0 {
        return vec2<f32>(min(r1, r2), max(r1, r2));
    }
    return select(vec2<f32>(max(r1, r2), FOREVER), vec2<f32>(-FOREVER, min(r1, r2)), toward > 0.0);
}
