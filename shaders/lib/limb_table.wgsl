// The model `limb_table`: light gathered on a way through a shell whose density is (1 − h)ⁿ, wherever the planet does not hide the light.
// Twin of engine/src/air/model/limb_table.rs, which says what is Dolan's and what goes on where his table ends.
//
// Bound by pass/sky_limb_table.wgsl; the table is baked by pass/limb_bake.wgsl. A light adds a term of its own to the sum, in one draw,
// where he blended a pass for each. Nothing behind is dimmed.
// Numbers of Sky: settings[0] rgb: light scale, sr⁻¹ per planet radius, w: n; settings[1] x: longest step of the bake, m, y: further lights;
// then for each of these its direction, and its illuminance over the star's.

#include "lib/eclipse_along.wgsl"

const LIMB_LIGHTS: u32 = 3u;

// Cosine, at the shell's top, of the ray that touches the ground.
fn limb_graze(air: Air) -> f32 {
    let top = air.shape.y;
    return sqrt(top * (2.0 * air.shape.x + top)) / (air.shape.x + top);
}

// Place in the table of a ray from the top: chords in one half, by the cosine of the eye; rays to the ground in the other, by its root,
// so that nothing is interpolated across the edge of the ground. The light by the signed root of its cosine.
fn limb_uv(air: Air, size: f32, eye: f32, light: f32, ground: bool) -> vec2<f32> {
    let graze = limb_graze(air);
    let half = 0.5 * size;
    var x = clamp(eye / graze, 0.0, 1.0) * (half - 1.0);
    if ground {
        x = half + sqrt(clamp((eye - graze) / max(1.0 - graze, 1e-6), 0.0, 1.0)) * (half - 1.0);
    }
    let y = (0.5 + 0.5 * sign(light) * sqrt(min(abs(light), 1.0))) * (size - 1.0);
    return (vec2<f32>(x, y) + 0.5) / size;
}
// The inverse for a texel: cosine of the eye, of the light, 1 for the ground.
fn limb_point(air: Air, size: f32, texel: vec2<u32>) -> vec3<f32> {
    let graze = limb_graze(air);
    let half = 0.5 * size;
    let x = f32(texel.x);
    let root = 2.0 * f32(texel.y) / (size - 1.0) - 1.0;
    let light = root * abs(root);
    if x < half {
        return vec3<f32>(graze * x / (half - 1.0), light, 0.0);
    }
    let y = (x - half) / (half - 1.0);
    return vec3<f32>(graze + (1.0 - graze) * y * y, light, 1.0);
}

fn limb_density(h: f32, exponent: f32) -> f32 {
    let rest = clamp(1.0 - h, 0.0, 1.0);
    return select(pow(rest, exponent), 1.0, exponent <= 0.0);
}

// The stretch of a ray without end that the planet hides from a light, m; from > to: none. `mu_s`, `nu`: cosines of the light to the
// zenith of the path's start and to the ray.
fn limb_hidden(path: AirPath, bottom: f32, mu_s: f32, nu: f32) -> vec2<f32> {
    let none = vec2<f32>(1.0, 0.0);
    let along = path.radius * mu_s;
    let a = 1.0 - nu * nu;
    let b = path.slope - along * nu;
    let c = path.altitude * (2.0 * bottom + path.altitude) - along * along;
    var hidden = vec2<f32>(0.0, 1e30);
    if a > 1e-7 {
        let rest = b * b - a * c;
        if rest <= 0.0 {
            return none;
        }
        let q = -(b + select(-1.0, 1.0, b >= 0.0) * sqrt(rest));
        let s = vec2<f32>(q / a, select(c / q, 0.0, q == 0.0));
        hidden = vec2<f32>(min(s.x, s.y), max(s.x, s.y));
    } else if c >= 0.0 {
        return none;
    }
    if nu > 1e-7 {
        hidden.y = min(hidden.y, -along / nu);
    } else if nu < -1e-7 {
        hidden.x = max(hidden.x, -along / nu);
    } else if along >= 0.0 {
        return none;
    }
    hidden.x = max(hidden.x, 0.0);
    return select(none, hidden, hidden.y > hidden.x);
}
fn limb_lit(hidden: vec2<f32>, from_s: f32, to_s: f32) -> f32 {
    if hidden.y <= hidden.x {
        return 1.0;
    }
    return 1.0 - clamp(max(min(to_s, hidden.y) - max(from_s, hidden.x), 0.0) / max(to_s - from_s, 1e-6), 0.0, 1.0);
}

// Where the shadow lies on a ray: as it is, and as the table has it on either side of the zenith.
struct LimbShadow {
    exact: vec2<f32>,
    near: vec2<f32>,
    far: vec2<f32>,
    side: f32,   // of `far` in the table's
    truth: f32,  // of `exact` in the mixture of it and the table's
}

// Cosines between ray and light where all lie in one plane: the light on the eye's side, and on the other.
fn limb_sides(mu: f32, mu_s: f32) -> vec2<f32> {
    let sines = sqrt(max(1.0 - mu * mu, 0.0) * max(1.0 - mu_s * mu_s, 0.0));
    return vec2<f32>(mu * mu_s - sines, mu * mu_s + sines);
}
fn limb_side(sides: vec2<f32>, nu: f32) -> f32 {
    return clamp((nu - sides.x) / max(sides.y - sides.x, 1e-6), 0.0, 1.0);
}

// ∫ density ds over the lit part from the path's start to `end`, planet radii. Steps are even in the bake; else they grow with the
// distance from the lowest point.
fn limb_column(air: Air, path: AirPath, end: f32, exponent: f32, shadow: LimbShadow, count: u32, even: bool) -> f32 {
    let steps = graded_steps(path, end);
    var sum = 0.0;
    var from_s = 0.0;
    for (var i = 1u; i <= count; i++) {
        let x = f32(i) / f32(count);
        let to_s = select(graded_step(steps, x), end * x, even);
        let table = mix(limb_lit(shadow.near, from_s, to_s), limb_lit(shadow.far, from_s, to_s), shadow.side);
        let lit = mix(table, limb_lit(shadow.exact, from_s, to_s), shadow.truth);
        sum += limb_density(air_altitude(air, path, 0.5 * (from_s + to_s)) / air.shape.y, exponent) * lit * (to_s - from_s);
        from_s = to_s;
    }
    return sum / air.shape.x;
}

// What one light's air sends along the path to `end`, for a light scale of 1. From outside: by the table, `whole` being where the air or the
// ground ends the ray; what a nearer surface on the way down cuts off is its share of a flat shell.
fn limb_gathered(
    air: Air, table: texture_2d<f32>, linear: sampler, sky: Sky, path: AirPath, ray: vec3<f32>, end: f32, light: vec3<f32>,
) -> vec3<f32> {
    let scale = sky.settings[0];
    let ground = path.ground >= 0.0;
    let mu = path.slope / max(path.radius, 1.0);
    let mu_s = dot(path.up, light);
    let nu = dot(ray, light);
    let sides = limb_sides(mu, mu_s);
    let side = select(limb_side(sides, nu), 0.0, ground);
    let whole = select(path.exit, path.ground, ground);
    if path.start > 0.0 && (ground || end >= 0.999 * whole) {
        let size = f32(textureDimensions(table).x);
        var sum = textureSampleLevel(table, linear, limb_uv(air, size, -mu, mu_s, ground), 0.0).rgb;
        if !ground {
            let there = (path.radius * mu_s + path.exit * nu) / path.radius;
            sum = mix(sum, textureSampleLevel(table, linear, limb_uv(air, size, -mu, there, false), 0.0).rgb, side);
        }
        let altitude = select(0.0, air_altitude(air, path, end), ground && end < path.ground);
        return sum * limb_density(altitude / air.shape.y, scale.w + 1.0);
    }
    let h = clamp(path.altitude / air.shape.y, 0.0, 1.0);
    let shadow = LimbShadow(
        limb_hidden(path, air.shape.x, mu_s, nu), limb_hidden(path, air.shape.x, mu_s, sides.x),
        limb_hidden(path, air.shape.x, mu_s, sides.y), side, 1.0 - h * h);
    return scale.rgb * limb_column(air, path, end, scale.w, shadow, 2u * sky.ids.y, false);
}

// By all lights; `lit` is the free fraction of the star.
fn limb_lights(
    body: Body, air: Air, table: texture_2d<f32>, linear: sampler, sky: Sky, path: AirPath, ray: vec3<f32>, end: f32, lit: f32,
) -> vec3<f32> {
    var sum = limb_gathered(air, table, linear, sky, path, ray, end, body.sun.xyz) * lit;
    let further = min(u32(sky.settings[1].y), LIMB_LIGHTS);
    for (var i = 0u; i < further; i++) {
        sum += sky.settings[3u + 2u * i].rgb * limb_gathered(air, table, linear, sky, path, ray, end, sky.settings[2u + 2u * i].xyz);
    }
    return sum;
}

fn limb_table_light(
    body: Body, air: Air, table: texture_2d<f32>, linear: sampler, star: vec4<f32>, sky: Sky, view: SkyView,
) -> AirLight {
    let path = graded_above(air, air_path(air, body.up.xyz, body.up.w, view.ray), view.datum);
    let end = sky_end(air, path, view);
    if end <= 0.0 {
        return AirLight(vec3<f32>(0.0), vec3<f32>(1.0));
    }
    let lit = eclipse_along(body, star, air, path, view.ray, end);
    var sum = limb_lights(body, air, table, linear, sky, path, view.ray, end, lit);
    let beyond = edge_share(air, path, view, end);
    if beyond > 0.0 {
        var behind = path;
        behind.ground = -1.0;
        sum = mix(sum, limb_lights(body, air, table, linear, sky, behind, view.ray, path.exit, lit), beyond);
    }
    return AirLight(sum, vec3<f32>(1.0));
}
