// Tiles of the cube-sphere: where a sample lies, as an offset from its tile's centre that keeps f32's relative error.
// The derivation is at the head of engine/src/terrain/tile.rs.

struct TileFrame {
    centre: vec4<f32>,    // xyz: unit direction of the centre, body-fixed; w: |p₀|
    tangent: vec4<f32>,   // xy: tan(πu₀/4), tan(πv₀/4); z: π/4 × edge in face coordinates; w: radius of the datum, m
}

// A sample: its direction less the centre's, and its direction.
struct TilePoint {
    offset: vec3<f32>,
    direction: vec3<f32>,
}

fn face_axes(face: u32) -> mat3x3<f32> {
    var right = array<vec3<f32>, 6>(
        vec3<f32>(0.0, 1.0, 0.0), vec3<f32>(0.0, -1.0, 0.0), vec3<f32>(-1.0, 0.0, 0.0),
        vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), vec3<f32>(0.0, 1.0, 0.0));
    var up = array<vec3<f32>, 6>(
        vec3<f32>(0.0, 0.0, 1.0), vec3<f32>(0.0, 0.0, 1.0), vec3<f32>(0.0, 0.0, 1.0),
        vec3<f32>(0.0, 0.0, 1.0), vec3<f32>(-1.0, 0.0, 0.0), vec3<f32>(1.0, 0.0, 0.0));
    return mat3x3<f32>(right[face], up[face], cross(right[face], up[face]));
}

// tan for |y| ≤ π/4 by its continued fraction, to 1e-7: built-in ones may be good to 1e-3 only.
fn tan_small(y: vec2<f32>) -> vec2<f32> {
    let s = y * y;
    return y / (1.0 - s / (3.0 - s / (5.0 - s / (7.0 - s / (9.0 - s / 11.0)))));
}

// `at`: place in the tile, −½ … ½ along each edge.
fn tile_point(tile: TileFrame, axes: mat3x3<f32>, at: vec2<f32>) -> TilePoint {
    let t = tan_small(at * tile.tangent.z);
    let a0 = tile.tangent.xy;
    let delta = (1.0 + a0 * a0) * t / (1.0 - a0 * t);
    let p0 = axes[0] * a0.x + axes[1] * a0.y + axes[2];
    let d = axes[0] * delta.x + axes[1] * delta.y;
    let p = p0 + d;
    let l0 = tile.centre.w;
    let l = length(p);
    var out: TilePoint;
    out.offset = d / l - p0 * (dot(d, p + p0) / (l * l0 * (l + l0)));
    out.direction = tile.centre.xyz + out.offset;
    return out;
}

// Change of direction per unit of `at`, along u and v, at a direction of the face.
fn tile_tangents(tile: TileFrame, axes: mat3x3<f32>, direction: vec3<f32>) -> mat2x3<f32> {
    let depth = max(dot(direction, axes[2]), 0.3);
    let a = dot(direction, axes[0]) / depth;
    let b = dot(direction, axes[1]) / depth;
    let along_u = (axes[0] - direction * dot(direction, axes[0])) * (depth * (1.0 + a * a) * tile.tangent.z);
    let along_v = (axes[1] - direction * dot(direction, axes[1])) * (depth * (1.0 + b * b) * tile.tangent.z);
    return mat2x3<f32>(along_u, along_v);
}
