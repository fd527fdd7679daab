// The sky by the model `physical`, for a picture and for given rays. Rust side: engine/src/render/pass/sky/physical.rs.
//
// `fragment` (of pass/sky.wgsl) marches at every pixel. `half_rate` marches at every second pixel of every second row, into two textures of half the size;
// `merge` then draws the picture: a pixel between four that agree takes their mean, any other marches by itself.

#include "pass/sky.wgsl"
#include "lib/physical.wgsl"
#include "lib/second_light.wgsl"

@group(3) @binding(0) var half_radiance: texture_2d<f32>;
@group(3) @binding(1) var half_transmittance: texture_2d<f32>;

struct Half {
    @location(0) radiance: vec4<f32>,       // pre-exposed
    @location(1) transmittance: vec4<f32>,  // a: 1 where one ray stands for the pixel
}

// Of its colour, how much a pixel may differ from those around it and still take their mean. What varies evenly by this much is then
// right to an eighth of its square, 1e-3; the bend of an edge to a quarter, 2 %, on a line one pixel wide.
const AGREE: f32 = 0.08;
// Optical depth between a pixel's surface and the mean of those around it.
const AGREE_DEPTH: f32 = 0.01;

// By the air's own medium, or by its two band media; in the star's light and the second one.
fn sky_light(body: Body, star: vec4<f32>, view: SkyView) -> AirLight {
    let air = airs.list[u32(body.ids.z)];
    var luminance = vec3<f32>(0.0);
    var through = vec3<f32>(0.0);
    let first = u32(max(body.lights.w, 0));
    for (var l = first; l < light_count(body); l++) {
        var by = in_light(body, l);
        var radiance = vec3<f32>(0.0);
        for (var k = 0u; k < u32(air.bands[1].w); k++) {
            by.ids.z = i32(air.bands[3u * k].w);
            let light = physical_light(by, airs.list[u32(by.ids.z)], media, transmittance, orders, linear, star, sky, view);
            radiance += air_to_rgb(air, k) * light.radiance;
            through += air_to_rgb(air, k) * light.transmittance * select(0.0, 1.0, l == first);
        }
        luminance += max(radiance, vec3<f32>(0.0)) * by.illuminance.rgb;
    }
    return AirLight(luminance, clamp(through, vec3<f32>(0.0), vec3<f32>(1.0)));
}

@fragment
fn half_rate(in: Varying) -> Half {
    let pixel = 2u * vec2<u32>(in.position.xy);
    let body = bodies.list[sky.ids.x];
    let air = airs.list[u32(body.ids.z)];
    let view = sky_view(frame, (vec2<f32>(pixel) + 0.5) * frame.size.zw, textureLoad(depth, pixel, 0));
    let rays = sky_rays(body, air, view);
    let sum = sky_sum(body, view, min(rays, 1u));
    return Half(vec4<f32>(to_hdr(sum.radiance, exposure.pre), 1.0), vec4<f32>(sum.transmittance, select(0.0, 1.0, rays <= 1u)));
}

@fragment
fn merge(in: Varying) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(in.position.xy);
    let behind = textureLoad(opaque, pixel, 0).rgb;
    let body = bodies.list[sky.ids.x];
    let air = airs.list[u32(body.ids.z)];
    let view = sky_view(frame, in.uv, textureLoad(depth, pixel, 0));

    let last = textureDimensions(half_radiance) - 1u;
    let a = pixel / 2u;
    let d = min(a + (pixel & vec2<u32>(1u)), last);
    let b = vec2<u32>(d.x, a.y);
    let c = vec2<u32>(a.x, d.y);
    let ra = textureLoad(half_radiance, a, 0).rgb;
    let rb = textureLoad(half_radiance, b, 0).rgb;
    let rc = textureLoad(half_radiance, c, 0).rgb;
    let rd = textureLoad(half_radiance, d, 0).rgb;
    let ta = textureLoad(half_transmittance, a, 0);
    let tb = textureLoad(half_transmittance, b, 0);
    let tc = textureLoad(half_transmittance, c, 0);
    let td = textureLoad(half_transmittance, d, 0);
    let radiance = 0.25 * (ra + rb + rc + rd);
    let through = 0.25 * (ta + tb + tc + td);
    let spread = max(max(ra, rb), max(rc, rd)) - min(min(ra, rb), min(rc, rd));
    let veil = (max(max(ta, tb), max(tc, td)) - min(min(ta, tb), min(tc, td))).rgb;
    let colour = behind * through.rgb + radiance;
    var fine = through.a > 0.999 && all(spread + behind * veil <= AGREE * colour);

    // The surfaces seen there and here: all or none, and as far as it matters alike.
    let depths = vec4<f32>(
        textureLoad(depth, 2u * a, 0), textureLoad(depth, 2u * b, 0), textureLoad(depth, 2u * c, 0), textureLoad(depth, 2u * d, 0));
    if view.datum {
        fine &= all(depths <= vec4<f32>(0.0));
    } else {
        let own = view.surface;
        let stretch = own * textureLoad(depth, pixel, 0);
        // Stored depth is linear on a plane: ground that stretches away from the eye is between those around it.
        let apart = abs(stretch / max(dot(depths, vec4<f32>(0.25)), 1e-30) - own);
        fine &= all(depths > vec4<f32>(0.0)) && apart * sky.settings[0].x < AGREE_DEPTH;
    }

    // A loop of one turn or none, and not a branch: where a processor stands in for a GPU it takes both sides of a branch.
    var out = vec4<f32>(to_hdr(colour, 1.0), 1.0);
    let rays = sky_rays(body, air, view);
    for (var marches = select(1u, 0u, fine && rays <= 1u); marches > 0u; marches--) {
        out = sky_over(behind, sky_sum(body, view, rays), rays, exposure);
    }
    return out;
}
