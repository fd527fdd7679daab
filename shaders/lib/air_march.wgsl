// Light along a ray through air: single scattering exact along the ray, further orders from the table, by lib/air_quadrature.wgsl.
//
// The planet's own shadow is a cone that no light enters: stretches end at its edge, and so at the edges of the shadow that another
// world throws. Within a stretch the visible share of the sun's disc is taken at each point.

#include "lib/air.wgsl"
#include "lib/air_shadow.wgsl"
#include "lib/eclipse_rings.wgsl"
#include "lib/sky_pixel.wgsl"

// Set to false in pipelines for airs on which no shadow of another world can fall.
override AIR_ECLIPSES: bool = true;

const ONES: vec4<f32> = vec4<f32>(1.0);

// What lights the air.
struct AirSun {
    direction: vec3<f32>,
    angular_radius: f32,
    single: f32,    // 1; 0 leaves direct light out
    multiple: f32,  // 1; 0 leaves further orders out, those of the aureole too
}

// All that is the same at every point of a ray.
struct AirRay {
    path: AirPath,
    ray: vec3<f32>,
    up_sun: f32,       // r₀ μₛ at the start
    ray_sun: f32,
    phase: vec4<f32>,
    aureole: vec4<f32>,  // of light that forward peaks have turned before
    beam: i32,           // layer of the transmittance that has it
}

// Light scattered towards the eye at a point, m⁻¹ sr⁻¹ per unit of illuminance. `phased`, `turned` and `scattering` are the point's scattering
// by the classes' phase functions, by those of the aureole, and by none, per channel.
fn air_source(
    air: Air, transmittance: texture_2d_array<f32>, orders: texture_3d<f32>, linear: sampler, slot: i32,
    along: AirRay, sun: AirSun, phased: vec3<f32>, turned: vec3<f32>, scattering: vec3<f32>, s: f32, altitude: f32, direct: f32, diffuse: vec3<f32>,
) -> vec3<f32> {
    let mu_s = (along.up_sun + s * along.ray_sun) / (air.shape.x + altitude);
    let lit = visible_above_limb(sun.angular_radius, sun_elevation(air.shape.x, altitude, mu_s));
    let beam = air_sun_beam(air, transmittance, linear, along.beam, altitude, mu_s);
    return mix(turned, phased, beam.a) * (lit * direct) * beam.rgb
        + scattering * (sun.multiple * diffuse)
            * air_orders(air, orders, linear, slot, altitude, mu_s, (along.path.slope + s) / (air.shape.x + altitude), along.ray_sun);
}

// How low sunlight has come on its way to a point, for a sun below the level there: the altitude of its ray's lowest point.
fn sun_lowest(air: Air, altitude: f32, r_mu_s: f32) -> f32 {
    let r = air.shape.x + altitude;
    let x = min(r_mu_s, 0.0);
    return altitude - x * x / (r + sqrt(max(r * r - x * x, 0.0)));
}

// Panels for a stretch: one where little changes on it, `most` on a long one.
fn air_panels(air: Air, media: texture_2d_array<f32>, slot: i32, along: AirRay, begin: f32, end: f32, most: u32) -> u32 {
    let low = air_altitude(air, along.path, begin);
    let high = air_altitude(air, along.path, end);
    let sunk = vec2<f32>(
        sun_lowest(air, low, along.up_sun + begin * along.ray_sun), sun_lowest(air, high, along.up_sun + end * along.ray_sun));
    let redder = abs(sunk.y - sunk.x);
    let extinction = air_extinction(air, media, slot, min(low, high));
    let depth = max(max(extinction.x, extinction.y), extinction.z) * (end - begin);
    // Points for the optical depth that can be seen through, and for a sun that sinks on the way, on top of those for the shape of the path.
    let more = clamp(0.125 * depth - 1.0, 0.0, 3.0) + min(8.0 * redder / air.shape.y, 4.0);
    return u32(clamp(ceil(max(depth, max(40.0 * abs(high - low), 20.0 * redder) / air.shape.y)), 1.0, ceil(f32(most) + more)));
}

// What of a point's further orders its surroundings and its own place have in an eclipse.
fn air_further(
    air: Air, along: AirRay, sheets: texture_2d_array<f32>, linear: sampler, sheet: Sheet, centre: vec3<f32>, s: f32,
) -> Further {
    let rings = air_rings(
        air, air_altitude(air, along.path, s), (along.up_sun + s * along.ray_sun) / air.shape.x, (along.path.slope + s) / air.shape.x);
    let point = along.ray * (along.path.start + s);
    return eclipse_further(rings, sheet_seen(sheets, linear, sheet, normalize(point - centre), point, along.ray));
}

// From the path's start to `end` metres further; `count` points on a long stretch. `ray` is the direction of sight, `star` the star's sphere.
fn air_march(
    air: Air, media: texture_2d_array<f32>, transmittance: texture_2d_array<f32>, orders: texture_3d<f32>, linear: sampler,
    slot: i32, path: AirPath, end: f32, ray: vec3<f32>, sun: AirSun, body: Body, star: vec4<f32>,
    sheets: texture_2d_array<f32>, count: u32,
) -> AirLight {
    let cosine = dot(ray, sun.direction);
    let along = AirRay(
        path, ray, path.radius * dot(path.up, sun.direction), cosine, air_phase(air, media, slot, cosine) * sun.single,
        air_aureole(air, media, slot, cosine) * sun.single, 2 * slot + i32(sun.multiple));
    let night = air_night(air.shape.x, path, along.up_sun, cosine, sun.angular_radius, end);
    var shade = AirShade(vec4<f32>(-1.0), 0u, 0u);
    if AIR_ECLIPSES && body.ids.y > 0 {
        shade = air_shade(body, star, ray * path.start, ray, end, air.rings[3].w);
    }
    // Loops of one turn or none, and not branches: where a processor stands in for a GPU it takes both sides of a branch.
    let eclipsed = min(shade.count, 1u);
    // Asked once a ray: a list asked by an index is copied whole.
    let sheet = sheet_of(body, star, shade.deepest);
    let most = max(count / 4u, 1u);

    var out = AirLight(vec3<f32>(0.0), vec3<f32>(1.0));
    var depth = vec3<f32>(0.0);
    var begin = 0.0;
    // Loops ask at their ends: a processor that stands in for a GPU goes once more through one that asks before, with nothing to do.
    var k = 0u;
    loop {
        let next = air_next_cut(air, path, begin, end, vec4<f32>(night, -1.0, -1.0), shade.cuts);
        let middle = 0.5 * (begin + next);
        let free = select(air_shade_even(shade, middle), 1.0, shade.count == 0u);
        let dark = middle > night.x && middle < night.y;
        let panels = air_panels(air, media, slot, along, begin, next, select(most, (most + 1u) / 2u, dark));
        var i = 0u;
        loop {
            let n = air_nodes(air, path, begin, next, i, panels);
            // What comes from around is found at the two Gauss points of the panel, evenly between and beyond: its integral is exact to third order.
            var middling = Further(vec3<f32>(0.0), vec3<f32>(0.0));
            var growth = Further(vec3<f32>(0.0), vec3<f32>(0.0));
            if AIR_ECLIPSES {
                for (var turn = 0u; turn < 2u * eclipsed; turn++) {
                    let at = select(GAUSS_TWO.x, GAUSS_TWO.y, turn == 1u);
                    let place = air_panel_places(path, begin, next, vec2<f32>(f32(i) + at) / f32(panels)).x;
                    let found = air_further(air, along, sheets, linear, sheet, body.centre.xyz, place);
                    let slope = (at - 0.5) / ((GAUSS_TWO.y - GAUSS_TWO.x) * (GAUSS_TWO.y - 0.5));
                    middling.around += 0.5 * found.around;
                    middling.own += 0.5 * found.own;
                    growth.around += slope * found.around;
                    growth.own += slope * found.own;
                }
            }
            let m0 = air_matter(air, media, slot, n.altitude.x);
            let m1 = air_matter(air, media, slot, n.altitude.y);
            let m2 = air_matter(air, media, slot, n.altitude.z);
            let m3 = air_matter(air, media, slot, n.altitude.w);
            let depths = mat4x3<f32>(m0.extinction * n.span.x, m1.extinction * n.span.y, m2.extinction * n.span.z, m3.extinction * n.span.w);
            let run = depths * GAUSS_RUN;
            let phased = mat4x3<f32>(m0.scattering * along.phase, m1.scattering * along.phase, m2.scattering * along.phase, m3.scattering * along.phase);
            let turned = mat4x3<f32>(m0.scattering * along.aureole, m1.scattering * along.aureole, m2.scattering * along.aureole, m3.scattering * along.aureole);
            let all = mat4x3<f32>(m0.scattering * ONES, m1.scattering * ONES, m2.scattering * ONES, m3.scattering * ONES);
            var before = vec3<f32>(0.0);
            var j = 0u;
            loop {
                let one = select(vec4<f32>(0.0), ONES, vec4<u32>(0u, 1u, 2u, 3u) == vec4<u32>(j));
                let s = dot(n.s, one);
                var direct = free;
                var diffuse = vec3<f32>(1.0);
                if AIR_ECLIPSES {
                    for (var turn = 0u; turn < select(0u, 1u, free < 0.0 && shade.count == 1u); turn++) {
                        direct = visible_behind(sheet.ball, star_seen(star, ray * (path.start + s)), ray * (path.start + s));
                    }
                    for (var turn = 0u; turn < select(0u, 1u, shade.count > 1u); turn++) {
                        direct = eclipse_visible(body, star, ray * (path.start + s));
                    }
                    for (var turn = 0u; turn < eclipsed; turn++) {
                        let x = dot(GAUSS_X, one) - 0.5;
                        diffuse = max(middling.around + x * growth.around, vec3<f32>(0.0)) + (middling.own + x * growth.own) * direct;
                    }
                }
                // Where a point stands for much optical depth, the collocation overshoots: there its source is taken as even over its share.
                let own = depths * (GAUSS_WEIGHT * one);
                let even = (1.0 - exp(-own)) / max(own, vec3<f32>(1e-6));
                let seen = mix(exp(-clamp(run * one - before, vec3<f32>(0.0), own)), even, smoothstep(vec3<f32>(3.0), vec3<f32>(6.0), own));
                out.radiance += (dot(n.span * GAUSS_WEIGHT, one) * exp(-depth - before)) * seen
                    * air_source(air, transmittance, orders, linear, slot, along, sun, phased * one, turned * one, all * one, s, dot(n.altitude, one), direct, diffuse);
                before += own;
                j++;
                if j >= 4u {
                    break;
                }
            }
            depth += depths * GAUSS_WEIGHT;
            i++;
            if i >= panels {
                break;
            }
        }
        begin = next;
        k++;
        if k >= 24u || begin >= end {
            break;
        }
    }
    out.transmittance = exp(-depth);
    return out;
}
