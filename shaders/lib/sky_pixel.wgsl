// What every model of air shares when it is drawn or probed: the ray through a pixel and how far it is seen, the rays that stand for
// a pixel on a limb, and how light and transmittance are laid over the picture.
//
// A model is one pure function in its own file of shaders/lib, `… -> AirLight`, asked with a `SkyView`; shaders/pass/sky_<model>.wgsl
// binds it, for the picture and for given rays (pass/sky.wgsl).

#include "lib/air_path.wgsl"
#include "lib/frame.wgsl"

const SKY_SETTINGS: u32 = 8u;
const SKY_SINGLE: u32 = 1u;  // flag: orders beyond the first are left out (probes only)

struct Sky {
    ids: vec4<u32>,                              // index of the body; steps of a long march; flags; of a front: index of the bank; of a bank: of the body whose air it is in
    settings: array<vec4<f32>, SKY_SETTINGS>,    // the model's numbers, in its own order
}

struct AirLight {
    radiance: vec3<f32>,       // per unit of the sun's illuminance above the air, sr⁻¹
    transmittance: vec3<f32>,  // of what lies behind
}

// A ray of sight.
struct SkyView {
    ray: vec3<f32>,   // unit
    surface: f32,     // distance to what was drawn there; 1e30 where nothing was
    datum: bool,      // where the ray meets the datum and nothing nearer was drawn, the datum ends it
    pixel: f32,       // angle of a pixel, rad; 0: a line of no width
}

// A ray to probe, and what it brings.
struct ProbeRay {
    up: vec4<f32>,   // unit zenith of the eye, its altitude, m
    ray: vec4<f32>,  // unit direction of sight, distance to a surface seen (0: none, the datum ends the ray)
    sun: vec4<f32>,  // unit direction to the sun, its angular radius, rad
}
struct ProbeLight {
    radiance: vec4<f32>,
    transmittance: vec4<f32>,
}

// `stored` is the depth of the pixel.
fn sky_view(frame: Frame, uv: vec2<f32>, stored: f32) -> SkyView {
    let through = view_ray(frame, uv);
    let stretch = length(through);
    let drawn = stored > 0.0;
    return SkyView(through / stretch, select(1e30, axis_distance(frame, stored) * stretch, drawn), !drawn, frame.up.w);
}

// How many rays stand for a pixel, and where: they cross it from the planet's centre outwards. −½ and ½: the pixel's edges.
struct SkySpread {
    nodes: u32,        // of a Gauss–Legendre rule on each part; 1 where there is but one ray: the view itself
    below: vec2<f32>,  // part before the ground, from and to
    above: vec2<f32>,  // part above it, up to the top of the air
    width: f32,        // angle from one edge to the other, rad
    surface: f32,      // distance to what was drawn before it all; 1e30 where that is the planet itself, or nothing
}

const SKY_ALONE: SkySpread = SkySpread(1u, vec2<f32>(-0.5), vec2<f32>(-0.5, 0.5), 0.0, 1e30);
// Parts of the air's height from which on a pixel wants two rays, and three.
const SKY_TWO: f32 = 0.05;
const SKY_THREE: f32 = 0.4;

// Unit vector across the ray, from the planet's centre outwards.
fn sky_outwards(body: Body, view: SkyView) -> vec3<f32> {
    let outwards = body.up.xyz - view.ray * dot(view.ray, body.up.xyz);
    return outwards / max(length(outwards), 1e-20);
}
// Angle by which a pixel reaches across its ray in a direction: the picture is a plane, on which far from its middle an angle takes more room.
fn sky_pixel_width(frame: Frame, view: SkyView, across: vec3<f32>) -> f32 {
    let ahead = dot(view.ray, frame.forward.xyz);
    return view.pixel * ahead / length(across - view.ray * (dot(across, frame.forward.xyz) / ahead));
}

// From afar the air at a limb is thinner than a pixel: there, several rays stand for one. So they do along the horizon of a smooth body, whose
// own picture fades over one pixel there. Elsewhere one does. From within the air, ground that was drawn ends the ray where it stands.
fn sky_spread(frame: Frame, body: Body, air: Air, view: SkyView) -> SkySpread {
    let path = air_path(air, body.up.xyz, body.up.w, view.ray);
    // Of a pixel whose middle misses the air a part may not.
    let misses = path.start < 0.0;
    let eye = air.shape.x + body.up.w;
    let horizon = select(path.start - path.slope, -eye * dot(body.up.xyz, view.ray), misses);
    if view.surface <= select(path.start, 0.8 * horizon, misses) {
        return SKY_ALONE;
    }
    let low = select(
        air_altitude(air, path, clamp(-path.slope, 0.0, path.exit)), eye * length(cross(body.up.xyz, view.ray)) - air.shape.x, misses);
    let width = sky_pixel_width(frame, view, sky_outwards(body, view));
    let pixel = width * max(horizon, 0.0);
    let fades = body.ids.w == 0 && view.surface > 0.8 * horizon && abs(low) < pixel;
    let thin = (path.start != 0.0 || view.datum) && pixel > SKY_TWO * air.shape.y && low > -pixel;
    if !fades && !thin || horizon <= 0.0 || low >= air.shape.y + 0.5 * pixel {
        return SKY_ALONE;
    }
    let own = misses || air_altitude(air, path, min(view.surface - path.start, path.exit)) < 2.0 * pixel;
    let edges = clamp((vec2<f32>(0.0, air.shape.y) - low) / pixel, vec2<f32>(-0.5), vec2<f32>(0.5));
    return SkySpread(
        1u + u32(pixel > SKY_TWO * air.shape.y) + u32(pixel > SKY_THREE * air.shape.y), vec2<f32>(-0.5, edges.x), edges, width,
        select(view.surface, 1e30, own));
}

// Whether the view itself stands for the pixel.
fn sky_alone(spread: SkySpread) -> bool {
    return spread.nodes == 1u && spread.above.x <= -0.5 && spread.above.y >= 0.5;
}

fn sky_rays(spread: SkySpread) -> u32 {
    let parts = u32(spread.below.y > spread.below.x) + u32(spread.above.y > spread.above.x);
    return max(parts * spread.nodes, 1u);
}

struct SkyShare {
    view: SkyView,
    weight: f32,
}
// The k-th of the rays, and its share of the pixel. What they leave sees no air.
fn sky_across(body: Body, view: SkyView, spread: SkySpread, k: u32) -> SkyShare {
    if sky_alone(spread) {
        return SkyShare(view, 1.0);
    }
    let part = select(spread.above, spread.below, k < spread.nodes && spread.below.y > spread.below.x);
    let node = f32(k % spread.nodes) - 0.5 * f32(spread.nodes - 1u);
    // Gauss–Legendre: at 0; ±1/√3; 0 and ±√(3/5) with 4/9 and 5/18.
    let two = spread.nodes == 2u;
    let at = node * select(0.774596669, 1.154700538, two);
    let share = select(select(5.0 / 18.0, 4.0 / 9.0, node == 0.0), 1.0 / f32(spread.nodes), spread.nodes < 3u);
    let aside = mix(part.x, part.y, 0.5 + 0.5 * at) * spread.width;
    let ray = normalize(view.ray + sky_outwards(body, view) * aside);
    // What was drawn in the pixel's middle is not what its other parts show: there the datum decides.
    return SkyShare(SkyView(ray, spread.surface, true, view.pixel), share * (part.y - part.x));
}

// The path of a ray of sight. Between the datum's horizon and that of ground which lies deeper, a picture from within the air has drawn nothing:
// there the datum ends no ray.
fn sky_path(body: Body, air: Air, view: SkyView) -> AirPath {
    var path = air_path(air, body.up.xyz, body.up.w, view.ray);
    let relief = body.ids.w != 0 && view.pixel > 0.0 && path.start == 0.0 && path.ground >= 0.0;
    if relief && air_altitude(air, path, -path.slope) > -AIR_FLOOR_M {
        path.ground = -1.0;
    }
    return path;
}

// Where the ray ends, from the path's start; nothing to see where it is not positive. What is drawn by more than a pixel above the datum is
// relief, and ends the air where it stands; below that the datum, where it counts, is the finer of the two.
fn sky_end(air: Air, path: AirPath, view: SkyView) -> f32 {
    if path.start < 0.0 || view.surface <= path.start {
        return 0.0;
    }
    let exit = select(path.exit, path.ground, path.ground >= 0.0 && view.datum);
    let drawn = view.surface - path.start;
    let relief = drawn < path.exit && air_altitude(air, path, min(drawn, path.exit)) > 1.5 * view.pixel * view.surface;
    return select(exit, min(exit, drawn), relief || !view.datum);
}

// The body as a probe's ray stands to it.
fn sky_probe_body(body: Body, asked: ProbeRay) -> Body {
    var there = body;
    there.up = asked.up;
    there.sun = asked.sun;
    let from_centre = asked.up.xyz * (body.centre.w + asked.up.w);
    there.centre = vec4<f32>(-from_centre, body.centre.w);
    for (var i = 0u; i < MAX_OCCLUDERS; i++) {
        there.occluders[i] = vec4<f32>(body.occluders[i].xyz - from_centre, body.occluders[i].w);
    }
    return there;
}
// The star of a probe: at infinity in the ray's own direction where none was placed. The far distance is one whose square is a number.
fn sky_probe_star(frame: Frame, body: Body, asked: ProbeRay) -> vec4<f32> {
    let far = vec4<f32>(asked.sun.xyz, sin(asked.sun.w)) * 1e17;
    return select(far, vec4<f32>(frame.star.xyz + body.centre.xyz, frame.star.w), vec4<bool>(frame.star.w > 0.0));
}
fn sky_probe_view(asked: ProbeRay) -> SkyView {
    let seen = asked.ray.w > 0.0;
    return SkyView(asked.ray.xyz, select(1e30, asked.ray.w, seen), !seen, 0.0);
}

// Light found per unit of the star's illuminance, in cd/m².
fn in_starlight(body: Body, light: AirLight) -> AirLight {
    return AirLight(light.radiance * body.illuminance.rgb, light.transmittance);
}

// Radius in pixels of a disc that has all of its air.
const SKY_WHOLE: f32 = 3.0;

// A body that is a point shines by its surface alone: what its air makes of it comes in by degrees. Where a disc begins, that makes up for what
// the air takes of the sunlight on the ground.
fn sky_presence(frame: Frame, body: Body, air: Air) -> f32 {
    return smoothstep(0.0, SKY_WHOLE, (air.shape.x + air.shape.y) / max((body.centre.w + body.up.w) * frame.up.w, 1e-30));
}

// Luminance and transmittance laid over a stored colour.
fn sky_over(behind: vec3<f32>, light: AirLight, exposure: Exposure) -> vec4<f32> {
    return vec4<f32>(to_hdr(behind * light.transmittance + light.radiance * exposure.pre, 1.0), 1.0);
}
