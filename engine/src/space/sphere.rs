//! Directions on a sphere: latitude/longitude and the equi-angular cube that terrain tiles and maps share.
//!
//! A cube face has coordinates `u, v ∈ [−1, 1]`; the point on the cube is `(tan(πu/4), tan(πv/4), 1)` in the face's axes,
//! which makes cells nearly equal in size (1 : 1.4 instead of 1 : 5.2). Directions are body-fixed: +Z is the north pole, +X longitude 0.

use glam::DVec3;

/// A cube face, 0 … 5: +X, −X, +Y, −Y, +Z, −Z.
pub type Face = u8;

/// The `(right, up, out)` axes of each face, in body-fixed axes; `right × up = out`.
pub const FACE_AXES: [[DVec3; 3]; 6] = [
    [DVec3::Y, DVec3::Z, DVec3::X],
    [DVec3::NEG_Y, DVec3::Z, DVec3::NEG_X],
    [DVec3::NEG_X, DVec3::Z, DVec3::Y],
    [DVec3::X, DVec3::Z, DVec3::NEG_Y],
    [DVec3::Y, DVec3::NEG_X, DVec3::Z],
    [DVec3::Y, DVec3::X, DVec3::NEG_Z],
];

/// Unit direction of face coordinates `(u, v)`; `u`, `v` may lie a little outside [−1, 1] (the border of a tile).
pub fn direction_of(face: Face, u: f64, v: f64) -> DVec3 {
    let [right, up, out] = FACE_AXES[face as usize];
    let quarter = core::f64::consts::FRAC_PI_4;
    let p = right * libm::tan(u * quarter) + up * libm::tan(v * quarter) + out;
    p / p.length()
}

/// Face and face coordinates of a direction (not necessarily unit). The zero vector gives face 0, `(0, 0)`.
pub fn face_of(direction: DVec3) -> (Face, f64, f64) {
    let a = direction.abs();
    let face: Face = if a.x >= a.y && a.x >= a.z {
        if direction.x >= 0.0 { 0 } else { 1 }
    } else if a.y >= a.z {
        if direction.y >= 0.0 { 2 } else { 3 }
    } else if direction.z >= 0.0 {
        4
    } else {
        5
    };
    let [right, up, out] = FACE_AXES[face as usize];
    let depth = direction.dot(out);
    if depth <= 0.0 {
        return (0, 0.0, 0.0);
    }
    let scale = core::f64::consts::FRAC_2_PI * 2.0;
    let u = libm::atan(direction.dot(right) / depth) * scale;
    let v = libm::atan(direction.dot(up) / depth) * scale;
    (face, u, v)
}

/// Planetocentric latitude and east longitude of a direction, both in radians; longitude in (−π, π].
pub fn lat_lon_of(direction: DVec3) -> (f64, f64) {
    let horizontal = libm::hypot(direction.x, direction.y);
    (libm::atan2(direction.z, horizontal), libm::atan2(direction.y, direction.x))
}

/// Unit direction of a planetocentric latitude and east longitude, in radians.
pub fn direction_of_lat_lon(lat: f64, lon: f64) -> DVec3 {
    let c = libm::cos(lat);
    DVec3::new(c * libm::cos(lon), c * libm::sin(lon), libm::sin(lat))
}

/// The `(east, up, north)` unit vectors at a direction; at a pole, east is +Y.
pub fn east_up_north(up: DVec3) -> (DVec3, DVec3, DVec3) {
    let east = DVec3::new(-up.y, up.x, 0.0).normalize_or(DVec3::Y);
    (east, up, up.cross(east))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_are_right_handed_and_round_trip() {
        for (face, [right, up, out]) in FACE_AXES.iter().enumerate() {
            assert!((right.cross(*up) - *out).length() < 1e-15, "face {face}");
            for (u, v) in [(0.0, 0.0), (0.9, -0.4), (-0.99, 0.99)] {
                let d = direction_of(u8::try_from(face).unwrap(), u, v);
                let (f2, u2, v2) = face_of(d);
                assert_eq!(usize::from(f2), face);
                assert!((u2 - u).abs() < 1e-14 && (v2 - v).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn lat_lon_round_trips() {
        for (lat, lon) in [(0.0, 0.0), (0.7, 3.0), (-1.2, -2.9), (1.5, 0.1)] {
            let (a, b) = lat_lon_of(direction_of_lat_lon(lat, lon));
            assert!((a - lat).abs() < 1e-14 && (b - lon).abs() < 1e-13);
        }
    }

    #[test]
    fn east_up_north_is_right_handed() {
        let up = direction_of_lat_lon(0.4, 1.0);
        let (e, u, n) = east_up_north(up);
        assert!((e.cross(u) + n).length() < 1e-14, "east × up = −north: +Z of the anchor frame points south");
        assert!(n.z > 0.0);
    }
}
