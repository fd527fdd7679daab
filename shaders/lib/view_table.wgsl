// The model `view_table`: single scattering from a 3-D table by height, view angle and sun angle, RGB and alpha; phase functions
// for every pixel. Twin of engine/src/air/model/view_table.rs, which has the equations [Elek 2008] and the words for all of it.
//
// Entries of the 3-D table are square roots (half floats then reach into twilight); texels along x by view angle, y by sun, z by height.
// The table of optical depth holds full floats, because depths are taken from each other [eq. 3.9]; it is interpolated here. Tables are
// baked by pass/view_depth.wgsl and pass/view_scatter.wgsl. Bound by pass/sky_view_table.wgsl. Not here: ambient light (pass/view_ambient.wgsl).

#include "lib/eclipse_along.wgsl"
#include "lib/view_space.wgsl"

struct ViewTable {
    rgb: vec4<f32>,          // 1 for each class of the medium that is in RGB
    alpha: vec4<f32>,        // 1 for each that is in alpha
    rgb_phase: vec4<f32>,    // weights of the classes' phase functions in RGB
    alpha_phase: vec4<f32>,  // and in alpha
    tint: vec4<f32>,         // rgb: colour of what is in alpha over its mean; w: 1 where it is reddened as RGB is
    inverse: vec4<f32>,      // rgb: 1 / vertical scattering depth of RGB, 0 where that is 0
    counts: vec4<u32>,       // trapezoids of a ray, of a depth; directions of the ambient integral each way; 1: graded
    ids: vec4<i32>,          // id of the body; −1: of none
}

// What light meets at a height: scattering of RGB, of alpha (mean of the channels); extinction. Per m.
struct ViewMatter {
    rgb: vec3<f32>,
    alpha: f32,
    extinction: vec3<f32>,
}
fn view_matter(air: Air, media: texture_2d_array<f32>, slot: i32, vt: ViewTable, altitude: f32) -> ViewMatter {
    let matter = air_matter(air, media, slot, max(altitude, 0.0));
    return ViewMatter(matter.scattering * vt.rgb, dot(matter.scattering * vt.alpha, vec3<f32>(1.0 / 3.0)), matter.extinction);
}

// Optical depth from a height to the top at cosine `mu`.
fn view_depth(air: Air, vt: ViewTable, depth: texture_2d<f32>, altitude: f32, mu: f32) -> vec3<f32> {
    let graded = vt.counts.w > 0u;
    let size = vec2<f32>(textureDimensions(depth));
    let x = vec2<f32>(space_depth_x(air, graded, altitude, mu), space_height_x(air, graded, altitude)) * (size - 1.0);
    let low = min(vec2<u32>(x), vec2<u32>(size) - 2u);
    let t = x - vec2<f32>(low);
    let near = mix(textureLoad(depth, low, 0).rgb, textureLoad(depth, low + vec2<u32>(1u, 0u), 0).rgb, t.x);
    let far = mix(textureLoad(depth, low + vec2<u32>(0u, 1u), 0).rgb, textureLoad(depth, low + vec2<u32>(1u, 1u), 0).rgb, t.x);
    return mix(near, far, t.y);
}

// The sun at a point of a path: transmittance to it, and the angle of its centre above the horizon. `up_sun` is r₀ μₛ, `nu` the cosine of ray and sun.
struct ViewSun {
    transmittance: vec3<f32>,
    elevation: f32,
}
fn view_sun(air: Air, vt: ViewTable, depth: texture_2d<f32>, altitude: f32, mu_s: f32) -> ViewSun {
    let h = max(altitude, 0.0);
    let horizon = -space_horizon_m(air, h) / (air.shape.x + h);
    return ViewSun(exp(-view_depth(air, vt, depth, h, max(mu_s, horizon))), sun_elevation(air.shape.x, h, mu_s));
}

// Light without its phase functions: RGB and alpha.
fn view_entry(air: Air, vt: ViewTable, scatter: texture_3d<f32>, linear: sampler, altitude: f32, mu: f32, ground: bool, mu_s: f32) -> vec4<f32> {
    let graded = vt.counts.w > 0u;
    let size = vec3<f32>(textureDimensions(scatter));
    let h = clamp(altitude, 0.0, air.shape.y);
    let c = clamp(mu, -1.0, 1.0);
    let phi = atan2(sqrt(1.0 - c * c), c);
    let texel = vec3<f32>(
        space_view_texel(air, graded, h, phi, ground, size.x),
        space_sun_x(graded, mu_s) * (size.y - 1.0),
        space_height_x(air, graded, h) * (size.z - 1.0));
    let root = textureSampleLevel(scatter, linear, (texel + 0.5) / size, 0.0);
    return root * root;
}

// An entry in colour, sr⁻¹. `phases`: of RGB and of alpha.
fn view_colour(vt: ViewTable, entry: vec4<f32>, phases: vec2<f32>) -> vec3<f32> {
    var colour = vt.tint.rgb;
    if vt.tint.w > 0.0 {
        // As the light in RGB is reddened, over green [Bruneton & Neyret 2008, §4].
        let per = entry.rgb * vt.inverse.rgb;
        if per.g > 1e-12 {
            colour *= select(vec3<f32>(1.0), min(per / per.g, vec3<f32>(1e3)), vt.inverse.rgb > vec3<f32>(0.0));
        }
    }
    return entry.rgb * phases.x + colour * (entry.a * phases.y);
}

// Luminance over illuminance that water on the datum mirrors to the eye: the table seen from the ground along the reflected ray. `view`
// goes to the eye; all unit, with the zenith in one frame. [Elek 2008, §3.5]; by how much of it the water answers is the caller's.
fn view_mirrored(
    air: Air, media: texture_2d_array<f32>, slot: i32, vt: ViewTable, scatter: texture_3d<f32>, linear: sampler,
    up: vec3<f32>, view: vec3<f32>, sun: vec3<f32>,
) -> vec3<f32> {
    let ray = 2.0 * dot(view, up) * up - view;
    let values = air_phase(air, media, slot, dot(ray, sun));
    let entry = view_entry(air, vt, scatter, linear, 0.0, max(dot(ray, up), 0.0), false, dot(sun, up));
    return view_colour(vt, entry, vec2<f32>(dot(values, vt.rgb_phase), dot(values, vt.alpha_phase)));
}

// Over a short way: what is gathered and the depth of it, by the air itself. Differences of two table entries would be mostly error.
struct ViewStretch {
    light: vec4<f32>,
    depth: vec3<f32>,
}
fn view_near(
    air: Air, media: texture_2d_array<f32>, slot: i32, vt: ViewTable, depth: texture_2d<f32>, path: AirPath, end: f32, mu_s: f32, nu: f32,
    sun_rad: f32,
) -> ViewStretch {
    var out = ViewStretch(vec4<f32>(0.0), vec3<f32>(0.0));
    let ds = end / 3.0;
    for (var i = 0u; i < 3u; i++) {
        let s = (f32(i) + 0.5) * ds;
        let altitude = air_altitude(air, path, s);
        let matter = view_matter(air, media, slot, vt, altitude);
        let sun = view_sun(air, vt, depth, altitude, (path.radius * mu_s + s * nu) / (air.shape.x + altitude));
        let step = matter.extinction * ds;
        let kept = sun.transmittance * exp(-out.depth - 0.5 * step) * (ds * visible_above_limb(sun_rad, sun.elevation));
        out.light += vec4<f32>(matter.rgb * kept, matter.alpha * kept.g);
        out.depth += step;
    }
    return out;
}

// Depth between the path's start and a point `end` further: the difference of two depths to the top along the way up [eq. 3.9].
fn view_depth_between(air: Air, vt: ViewTable, depth: texture_2d<f32>, path: AirPath, end: f32) -> vec3<f32> {
    let there = air_altitude(air, path, end);
    let mu = path.slope / max(path.radius, 1.0);
    let mu_there = (path.slope + end) / (air.shape.x + there);
    if mu + mu_there < 0.0 {
        return max(view_depth(air, vt, depth, there, -mu_there) - view_depth(air, vt, depth, path.altitude, -mu), vec3<f32>(0.0));
    }
    return max(view_depth(air, vt, depth, path.altitude, mu) - view_depth(air, vt, depth, there, mu_there), vec3<f32>(0.0));
}

// Ways shorter than the first of these, over the depth of the air, are taken by `view_near`, longer than the second by differences.
const VIEW_NEAR: vec2<f32> = vec2<f32>(0.01, 0.04);

fn view_table_light(
    body: Body, air: Air, media: texture_2d_array<f32>, vt: ViewTable, scatter: texture_3d<f32>, depth: texture_2d<f32>, linear: sampler,
    star: vec4<f32>, view: SkyView,
) -> AirLight {
    let path = graded_above(air, air_path(air, body.up.xyz, body.up.w, view.ray), view.datum);
    let end = sky_end(air, path, view);
    if end <= 0.0 {
        return AirLight(vec3<f32>(0.0), vec3<f32>(1.0));
    }
    let mu = path.slope / max(path.radius, 1.0);
    let mu_s = dot(path.up, body.sun.xyz);
    let nu = dot(view.ray, body.sun.xyz);
    let ground = path.ground >= 0.0;
    let whole = select(path.exit, path.ground, ground);
    let slot = body.ids.z;
    let values = air_phase(air, media, slot, nu);
    let phases = vec2<f32>(dot(values, vt.rgb_phase), dot(values, vt.alpha_phase));

    var light = vec4<f32>(0.0);
    var between = vec3<f32>(0.0);
    let cut = end < whole * 0.9999;
    let seen = cut || ground;
    let far = select(1.0, smoothstep(VIEW_NEAR.x, VIEW_NEAR.y, end / air.shape.y), seen);
    if far > 0.0 {
        light = view_entry(air, vt, scatter, linear, path.altitude, mu, ground, mu_s);
        if seen {
            between = view_depth_between(air, vt, depth, path, min(end, whole));
        } else {
            between = view_depth(air, vt, depth, path.altitude, mu);
        }
        if cut {
            // What lies beyond the surface seen is taken away, dimmed by what lies before it.
            let there = air_altitude(air, path, end);
            let radius = air.shape.x + there;
            let beyond = view_entry(air, vt, scatter, linear, there, (path.slope + end) / radius, ground, (path.radius * mu_s + end * nu) / radius);
            let kept = exp(-between);
            light = max(light - vec4<f32>(kept, kept.g) * beyond, vec4<f32>(0.0));
        }
    }
    if far < 1.0 {
        let near = view_near(air, media, slot, vt, depth, path, end, mu_s, nu, body.sun.w);
        light = mix(near.light, light, far);
        between = mix(near.depth, between, far);
    }
    let beyond = edge_share(air, path, view, end);
    if beyond > 0.0 {
        light = mix(light, view_entry(air, vt, scatter, linear, path.altitude, mu, false, mu_s), beyond);
    }
    let lit = eclipse_along(body, star, air, path, view.ray, end);
    return AirLight(view_colour(vt, light, phases) * lit, exp(-between));
}
