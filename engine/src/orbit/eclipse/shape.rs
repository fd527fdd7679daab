//! The shape of a body for eclipses: an ellipsoid of revolution, and the radii that its limb shows.
//!
//! Not here: relief. Vectors are in the body's own axes (+Z the pole) unless said otherwise.

use super::Place;
use glam::DVec3;

/// How large a body is where shadows are counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Equatorial radius, m.
    pub equatorial_m: f64,
    /// `(a − b)/a`.
    pub flattening: f64,
    /// Radius of the limb, m: `[for outer contacts (the mean limb), for inner contacts (the bottoms of its valleys)]`.
    pub limb_m: [f64; 2],
    /// Factor by which its shadow is larger than its equator's: air and shape together.
    pub shadow: f64,
}

impl Shape {
    /// A smooth sphere without air.
    pub const fn sphere(radius_m: f64) -> Self {
        Self { equatorial_m: radius_m, flattening: 0.0, limb_m: [radius_m; 2], shadow: 1.0 }
    }

    fn polar_m(&self) -> f64 {
        self.equatorial_m * (1.0 - self.flattening)
    }

    /// Unit vector of the plumb line at a point of the surface.
    pub fn normal(&self, p: DVec3) -> DVec3 {
        let k = 1.0 - self.flattening;
        DVec3::new(p.x, p.y, p.z / (k * k)).normalize_or(DVec3::Z)
    }

    /// Geodetic latitude and longitude of a point of the surface.
    pub fn place(&self, p: DVec3) -> Place {
        let n = self.normal(p);
        Place { lat_rad: libm::atan2(n.z, libm::hypot(n.x, n.y)), lon_rad: libm::atan2(n.y, n.x) }
    }

    /// The point of the surface at a place, m.
    pub fn point(&self, place: Place) -> DVec3 {
        self.touching(crate::space::sphere::direction_of_lat_lon(place.lat_rad, place.lon_rad))
    }

    /// The point whose outward normal is `n` (unit).
    pub fn touching(&self, n: DVec3) -> DVec3 {
        let (a, b) = (self.equatorial_m, self.polar_m());
        let m = DVec3::new(a * a * n.x, a * a * n.y, b * b * n.z);
        m / m.dot(n).max(f64::MIN_POSITIVE).sqrt()
    }

    /// Where a line through `origin` along unit `axis` first meets the surface, coming from −axis; `None` where it misses.
    pub fn first_hit(&self, origin: DVec3, axis: DVec3) -> Option<DVec3> {
        // Stretched along the pole the ellipsoid is a sphere, and lines stay lines.
        let stretch = DVec3::new(1.0, 1.0, 1.0 / (1.0 - self.flattening));
        let (o, d) = (origin * stretch, axis * stretch);
        let (a, b) = (d.length_squared(), o.dot(d));
        // The distance from the line, from a cross product: near a graze the difference of squares would cancel.
        let inside = self.equatorial_m * self.equatorial_m - o.cross(d).length_squared() / a;
        (inside >= 0.0).then(|| origin + axis * ((-b - (inside * a).sqrt()) / a))
    }

    /// Signed distance of a line from the outline that the body shows along `axis` (unit): positive outside, m; and the point of the
    /// outline that is nearest. `offset` is the point of the line nearest to the centre.
    pub fn outline(&self, offset: DVec3, axis: DVec3) -> (f64, DVec3) {
        let mut n = offset.normalize_or(axis.any_orthonormal_vector());
        // The largest n·offset − h(n) over directions across the axis, h the support function; h is nearly a constant.
        for _ in 0..6 {
            let t = axis.cross(n);
            let p = self.touching(n);
            let slope = t.dot(offset) - t.dot(p);
            // h + h″ is a radius of curvature: about that of the body.
            let bend = n.dot(offset).abs().max(0.2 * self.equatorial_m);
            n = (n + t * (slope / bend)).normalize_or(n);
        }
        let p = self.touching(n);
        (n.dot(offset) - n.dot(p), p)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{DEG, KM};

    const EARTH: Shape =
        Shape { equatorial_m: 6_378.137 * KM, flattening: 1.0 / 298.257_223_563, limb_m: [6_378.137 * KM; 2], shadow: 1.01 };

    #[test]
    fn geodetic_places_come_back() {
        // WGS 84: 45° N lies 6,367.490 km from the centre, its geocentric latitude is 44.807576°.
        let p = EARTH.point(Place { lat_rad: 45.0 * DEG, lon_rad: 0.3 });
        assert!((p.length() - 6_367_489.54).abs() < 0.5, "{}", p.length());
        assert!((libm::asin(p.z / p.length()) / DEG - 44.807_576).abs() < 1e-5);
        let back = EARTH.place(p);
        assert!((back.lat_rad - 45.0 * DEG).abs() < 1e-14 && (back.lon_rad - 0.3).abs() < 1e-14);
    }

    #[test]
    fn a_line_meets_the_surface_on_the_side_it_comes_from() {
        let d = DVec3::new(0.6, 0.0, -0.8);
        let o = DVec3::new(0.8, 0.1, 0.6) * (3_000.0 * KM);
        let hit = EARTH.first_hit(o, d).unwrap();
        let k = 1.0 - EARTH.flattening;
        let on = (hit.x * hit.x + hit.y * hit.y + hit.z * hit.z / (k * k)).sqrt();
        assert!((on - EARTH.equatorial_m).abs() < 1e-6, "{on}");
        assert!(hit.dot(d) < 0.0 && (hit - o).cross(d).length() < 1e-6);
        assert!(EARTH.first_hit(o * 3.0, d).is_none());
    }

    #[test]
    fn the_outline_of_an_ellipsoid() {
        // Seen from the equator the pole is b from the centre; a line 100 km beyond it.
        let b = 6_356.752_314 * KM;
        let (gap, p) = EARTH.outline(DVec3::new(0.0, 0.0, b + 100.0 * KM), DVec3::X);
        assert!((gap - 100.0 * KM).abs() < 1.0 && (p - DVec3::new(0.0, 0.0, b)).length() < 10.0, "{gap} {p}");
        // Slantwise the nearest point must be nearer than any other of the outline, sampled.
        let at = DVec3::new(0.0, 5_000.0 * KM, 4_500.0 * KM);
        let (gap, _) = EARTH.outline(at, DVec3::X);
        let nearest = (0..36_000)
            .map(|k| {
                let a = f64::from(k) * 0.01 * DEG;
                (DVec3::new(0.0, EARTH.equatorial_m * libm::cos(a), b * libm::sin(a)) - at).length()
            })
            .fold(f64::INFINITY, f64::min);
        assert!((gap - nearest).abs() < 1.0, "{gap} {nearest}");
    }
}
