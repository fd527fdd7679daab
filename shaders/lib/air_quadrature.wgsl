// Quadrature along a path: stretches between cuts, panels of four Gauss–Legendre points on each, running integrals between the points.
//
// A stretch never holds the path's lowest point, the edge of a shadow or a jump of density inside it, so that what is integrated is smooth
// there. Points lie by squares from the stretch's lower end, where air is densest. Integrals from a panel's beginning to each of its points come from the same four values as the whole
// [Butcher 1964, "Implicit Runge-Kutta Processes": the collocation matrix of the Gauss points].

#include "lib/air_path.wgsl"

const GAUSS_X: vec4<f32> = vec4<f32>(0.069431844203, 0.330009478208, 0.669990521792, 0.930568155797);
const GAUSS_WEIGHT: vec4<f32> = vec4<f32>(0.173927422569, 0.326072577431, 0.326072577431, 0.173927422569);
// Column i: weights of the four values in the integral from 0 to point i.
const GAUSS_RUN: mat4x4<f32> = mat4x4<f32>(
    0.086963711284, -0.026604180085, 0.012627462689, -0.003555149686,
    0.1881181175, 0.163036288716, -0.027880428602, 0.006735500595,
    0.167191921974, 0.353953006034, 0.163036288716, -0.014190694931,
    0.177482572255, 0.313445114742, 0.352676757516, 0.086963711284);

struct AirNodes {
    s: vec4<f32>,         // distances from the path's start
    span: vec4<f32>,      // ds/dx: times GAUSS_WEIGHT, the weights of a sum over the points
    altitude: vec4<f32>,
}

// Points of panel `panel` of `panels` on the stretch.
fn air_nodes(air: Air, path: AirPath, begin: f32, end: f32, panel: u32, panels: u32) -> AirNodes {
    let rising = 0.5 * (begin + end) + path.slope > 0.0;
    let part = 1.0 / f32(panels);
    let x = (f32(panel) + GAUSS_X) * part;
    let u = select(vec4<f32>(1.0) - x, x, rising);
    let length = end - begin;
    let away = length * u * u;
    let s = select(end - away, begin + away, rising);
    return AirNodes(s, (2.0 * length * part) * u, air_altitudes(air, path, s));
}

const GAUSS_TWO: vec2<f32> = vec2<f32>(0.211324865405, 0.788675134595);

// Distances of the places that lie at parts `x` of the points' own measure of a stretch.
fn air_panel_places(path: AirPath, begin: f32, end: f32, x: vec2<f32>) -> vec2<f32> {
    let rising = 0.5 * (begin + end) + path.slope > 0.0;
    let u = select(1.0 - x, x, rising);
    let away = (end - begin) * u * u;
    return select(end - away, begin + away, rising);
}

// Where the next stretch ends: at the nearest of `cuts`, the lowest point, a jump of density, or `end`.
fn air_next_cut(air: Air, path: AirPath, begin: f32, end: f32, cuts: vec4<f32>, more: vec4<f32>) -> f32 {
    let least = begin + 1e-4 * end;
    var next = select(end, -path.slope, -path.slope > least && -path.slope < end);
    let later = min(select(vec4<f32>(end), cuts, cuts > vec4<f32>(least)), select(vec4<f32>(end), more, more > vec4<f32>(least)));
    next = min(next, min(min(later.x, later.y), min(later.z, later.w)));
    if MEDIA_TABLES && air.shape.w > 0.0 {
        next = min(next, min(next_jump(air, path, least, end, air.jumps_low), next_jump(air, path, least, end, air.jumps_high)));
    }
    return select(next, end, next > end - 1e-4 * end);
}

// The nearest crossing of four altitudes beyond `least`.
fn next_jump(air: Air, path: AirPath, least: f32, end: f32, altitude: vec4<f32>) -> f32 {
    let root = sqrt(max(path.slope * path.slope + (altitude - path.altitude) * (2.0 * air.shape.x + altitude + path.altitude), vec4<f32>(0.0)));
    let near = -path.slope - root;
    let far = -path.slope + root;
    let crossed = root > vec4<f32>(0.0);
    let later = min(select(vec4<f32>(end), near, crossed & (near > vec4<f32>(least))), select(vec4<f32>(end), far, crossed & (far > vec4<f32>(least))));
    return min(min(later.x, later.y), min(later.z, later.w));
}

const NO_CUTS: vec4<f32> = vec4<f32>(-1.0);

// Optical depth from 0 to `end`, and of it that of light which scattering leaves going straight on.
fn air_optical_depths(air: Air, media: texture_2d_array<f32>, slot: i32, path: AirPath, end: f32, panels: u32) -> mat2x3<f32> {
    var depth = vec3<f32>(0.0);
    var forward = vec3<f32>(0.0);
    var begin = 0.0;
    for (var k = 0u; k < 24u && begin < end; k++) {
        let next = air_next_cut(air, path, begin, end, NO_CUTS, NO_CUTS);
        for (var i = 0u; i < panels; i++) {
            let nodes = air_nodes(air, path, begin, next, i, panels);
            let weights = nodes.span * GAUSS_WEIGHT;
            for (var j = 0u; j < 4u; j++) {
                let matter = air_matter(air, media, slot, nodes.altitude[j]);
                depth += matter.extinction * weights[j];
                forward += matter.scattering * (air.forward * weights[j]);
            }
        }
        begin = next;
    }
    return mat2x3<f32>(depth, forward);
}
