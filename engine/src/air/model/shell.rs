//! The shell of air around a planet, as a ray meets it: where it enters, where it leaves, and where the ground stands in the way.
//!
//! For the models that know a shell and no medium ([`super::thickness`], [`super::gradient`]). f32 twin: `shaders/lib/air_path.wgsl`.

use glam::DVec3;

/// The part of a ray that lies in a shell; distances from the eye, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    /// Where the air begins; 0 for an eye inside.
    pub start_m: f64,
    /// Where the shell ends.
    pub exit_m: f64,
    /// Where the datum is met; none where it is not, or where the eye lies below it.
    pub ground_m: Option<f64>,
    /// Lowest altitude of the ray within the shell, the ground not considered, m; negative for a ray that meets it.
    pub lowest_m: f64,
}

impl Chord {
    /// The chord of a ray from `eye` (from the planet's centre, m) along the unit vector `ray` through the shell from `bottom_m` (a
    /// radius) to `top_m` above that; none where the ray misses it.
    ///
    /// No difference of squares of large numbers is formed: `q = h(2R + h)` takes the place of `r² − R²`.
    pub fn new(eye: DVec3, ray: DVec3, bottom_m: f64, top_m: f64) -> Option<Self> {
        let altitude = eye.length() - bottom_m;
        let slope = eye.dot(ray);
        let q = altitude * (2.0 * bottom_m + altitude);
        let above = q - top_m * (2.0 * bottom_m + top_m);
        // s² + 2 slope s + above = 0 where the shell's top is met.
        let miss = eye.cross(ray).length();
        let outer = bottom_m + top_m;
        if above > 0.0 && (slope >= 0.0 || miss >= outer) {
            return None;
        }
        let half = ((outer - miss) * (outer + miss)).max(0.0).sqrt();
        let (start_m, exit_m) = if above > 0.0 {
            let far = half - slope;
            ((above / far).max(0.0), far)
        } else if slope > 0.0 {
            (0.0, -above / (slope + half))
        } else {
            (0.0, half - slope)
        };
        let deep = (bottom_m - miss) * (bottom_m + miss);
        let ground_m = (slope < 0.0 && deep > 0.0 && q > 0.0).then(|| q / (deep.sqrt() - slope));
        let low_s = (-slope).clamp(start_m, exit_m);
        let low_q = q + low_s * (2.0 * slope + low_s);
        let lowest_m = low_q / (bottom_m + (bottom_m * bottom_m + low_q).max(0.0).sqrt());
        Some(Self { start_m, exit_m, ground_m, lowest_m })
    }

    /// Where the air ends for the eye: at what is drawn `surface_m` away, else at the datum, else at the shell's far side, m.
    pub fn end_m(&self, surface_m: Option<f64>) -> f64 {
        surface_m.or(self.ground_m).unwrap_or(self.exit_m).clamp(self.start_m, self.exit_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const R: f64 = 6.371e6;
    const TOP: f64 = 1.0e5;

    #[test]
    fn chords_have_their_closed_forms() {
        let outer = R + TOP;
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-6 * b.abs().max(1.0), "{a} is not {b}");
        // Straight up and level from the ground; straight down from afar; past the limb.
        let eye = DVec3::X * R;
        close(Chord::new(eye, DVec3::X, R, TOP).unwrap().exit_m, TOP);
        close(Chord::new(eye, DVec3::Y, R, TOP).unwrap().exit_m, (outer * outer - R * R).sqrt());
        let afar = DVec3::X * (R + 6.0e7);
        let down = Chord::new(afar, -DVec3::X, R, TOP).unwrap();
        close(down.start_m, 6.0e7 - TOP);
        close(down.ground_m.unwrap(), 6.0e7);
        close(down.lowest_m, -R);
        let grazing = DVec3::new(-(1.0 - (R / afar.x).powi(2)).sqrt(), R / afar.x, 0.0);
        let limb = Chord::new(afar, grazing, R, TOP).unwrap();
        close(limb.exit_m - limb.start_m, 2.0 * (outer * outer - R * R).sqrt());
        assert!(limb.lowest_m.abs() < 1e-3, "{}", limb.lowest_m);
    }

    #[test]
    fn what_misses_has_no_chord_and_a_surface_cuts_it() {
        assert_eq!(Chord::new(DVec3::X * 2.0 * R, DVec3::X, R, TOP), None);
        assert_eq!(Chord::new(DVec3::X * 2.0 * R, DVec3::Y, R, TOP), None);
        let chord = Chord::new(DVec3::X * (R + 1e3), DVec3::new(-1.0, 1.0, 0.0).normalize(), R, TOP).unwrap();
        assert!((1414.0..1415.0).contains(&chord.end_m(None)));
        assert_eq!(chord.end_m(Some(700.0)), 700.0);
        assert_eq!(chord.end_m(Some(1e30)), chord.exit_m);
        // A core of no size: a ball of fog.
        let ball = Chord::new(DVec3::X * 5e3, -DVec3::X, 0.0, 1e3).unwrap();
        assert_eq!((ball.start_m, ball.exit_m), (4e3, 6e3));
    }
}
