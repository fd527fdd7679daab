// Daylight: what of the star's light reaches a point of a world or near it, directly and by way of the sky. For ground and ships.
//
// Behind other worlds the light is that which goes round them and through their air; so it is behind the world itself, above its air.
// Both are shares of the illuminance above the air (Body.illuminance, or frame.intensity / distance²). Bind group 1 as
// lib/air.wgsl says. A surface of albedo ρ whose normal is n, the zenith `up`: luminance = ρ/π · E · (sun · max(n·l, 0) + sky · (0.5 + 0.5 n·up)).
// Not here: shadows of ships and mountains.

#include "lib/air.wgsl"
#include "lib/eclipse_rings.wgsl"
#include "lib/refracted.wgsl"

// By all stars and what glows in the air of the Earth, on horizontal ground.
const STARLIGHT_LX: f32 = 1e-3;
// Zenith cosine whose square is the mean over all directions.
const ALL_AROUND: f32 = 0.57735027;

struct Daylight {
    sun: vec3<f32>,  // face-on: horizon, eclipses, reddening by air
    sky: vec3<f32>,  // on horizontal ground
    up: vec3<f32>,   // zenith at the point
}

// Albedo of a body's ground. A world's own albedo is that of the whole, clouds and all; under air that tells of its ground the ground is as bright
// as that air is lit by it.
fn ground_albedo(body: Body, air: Air) -> vec3<f32> {
    let told = body.ids.z >= 0 && any(air.albedo.rgb > vec3<f32>(0.0));
    return select(body.albedo.rgb, air.albedo.rgb, told);
}

// `point`: metres from the camera. `air`: airs.list[slot] where the body has one, any otherwise.
fn daylight(
    body: Body, star: vec4<f32>, point: vec3<f32>,
    air: Air, transmittance: texture_2d_array<f32>, irradiance: texture_2d_array<f32>, refracted: texture_2d_array<f32>,
    sheets: texture_2d_array<f32>, linear: sampler,
) -> Daylight {
    let slot = body.ids.z;
    let altitude = altitude_of(body, point);
    let up = normalize(point - body.centre.xyz);
    let mu_s = dot(up, body.sun.xyz);
    var direct = 1.0;
    var diffuse = vec3<f32>(1.0);
    if body.ids.y > 0 && (slot >= 0 || body.lights.x == 0) {
        direct = eclipse_visible(body, star, point);
        if slot >= 0 {
            let further = eclipse_further(air_rings(air, altitude, mu_s, ALL_AROUND), eclipse_around(sheets, linear, body, star, point));
            diffuse = further.around + further.own * direct;
        }
    }
    var free = vec3<f32>(direct);
    if body.lights.x > 0 {
        free = eclipse_light(body, star, point, refracted);
    }
    let visible = visible_above_limb(body.sun.w, sun_elevation(body.centre.w, altitude, mu_s));
    var out = Daylight(free * visible, vec3<f32>(0.0), up);
    if slot >= 0 && altitude < air.shape.y {
        out.sun *= air_sun_transmittance(air, transmittance, linear, slot, altitude, mu_s);
        out.sky = air_sky_irradiance(air, irradiance, linear, slot, altitude, mu_s) * diffuse;
    } else if body.lights.y >= 0 {
        out.sun = free * own_limb_light(body, star, point, altitude, refracted);
    } else if slot >= 0 {
        // Above the air its limb still reddens a low sun: the path to the star may cross it.
        let path = air_path(air, up, altitude, body.sun.xyz);
        if path.start >= 0.0 {
            out.sun *= air_sun_transmittance(air, transmittance, linear, slot, air.shape.y, path.slope / path.radius);
        }
    }
    return out;
}
