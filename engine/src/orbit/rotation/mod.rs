//! Rotation: where a body's pole and prime meridian point.
//!
//! The IAU form: right ascension α and declination δ of the pole drift linearly, the prime meridian W turns, and short lists of
//! periodic terms carry what matters beyond that (the Moon's librations, Phobos's swing, the nodding of Mars's pole …).
//! The numbers live in `assets/`; this file only evaluates them. The Earth's turning is observed, not a formula of TDB: [`earth`].
//! - [Archinal et al. 2018] "Report of the IAU Working Group on Cartographic Coordinates and Rotational Elements: 2015".

pub mod earth;

use crate::space::{Fixed, Icrf, Rotation, Vector};
use crate::time::{Moment, SimTime};
use crate::units::{DAY, DEG, JULIAN_CENTURY};
use core::f64::consts::{FRAC_PI_2, TAU};
use glam::DQuat;

/// One periodic term: `amplitude × sin(phase + rate T)` for α and W, `cos` for δ, T in Julian centuries from J2000 TDB.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Term {
    /// rad.
    pub amplitude_rad: f64,
    /// Angle at J2000, rad.
    pub phase_rad: f64,
    /// rad per Julian century.
    pub rate_rad_per_century: f64,
}

impl Term {
    fn angle(&self, centuries: f64) -> f64 {
        self.phase_rad + self.rate_rad_per_century * centuries
    }
}

/// What is evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Model {
    /// The numbers of [`Spin`].
    #[default]
    Iau,
    /// Precession, nutation and UT1: [`earth`]. The numbers of [`Spin`] are then an approximation to a few arcminutes.
    Earth,
}

/// Pole and prime meridian of a body: right ascension and declination of the pole, and W.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spin {
    /// What is evaluated.
    pub model: Model,
    /// Right ascension of the pole at J2000, rad, and its rate, rad per Julian century.
    pub pole_ra_rad: [f64; 2],
    /// Declination of the pole at J2000, rad, and its rate, rad per Julian century.
    pub pole_dec_rad: [f64; 2],
    /// Prime meridian W at J2000, rad, and its rate, rad per day.
    pub meridian_rad: [f64; 2],
    /// Quadratic term of W, rad per Julian century squared.
    pub meridian_quadratic_rad: f64,
    /// Sine terms of α.
    pub pole_ra_terms: Vec<Term>,
    /// Cosine terms of δ.
    pub pole_dec_terms: Vec<Term>,
    /// Sine terms of W.
    pub meridian_terms: Vec<Term>,
}

fn sines(terms: &[Term], centuries: f64) -> f64 {
    terms.iter().map(|t| t.amplitude_rad * libm::sin(t.angle(centuries))).sum()
}

fn about_z(a: f64) -> DQuat {
    let (s, c) = libm::sincos(0.5 * a);
    DQuat::from_xyzw(0.0, 0.0, s, c)
}

fn about_x(a: f64) -> DQuat {
    let (s, c) = libm::sincos(0.5 * a);
    DQuat::from_xyzw(s, 0.0, 0.0, c)
}

impl Spin {
    /// The Earth's.
    pub fn earth() -> Self {
        Self {
            model: Model::Earth,
            pole_ra_rad: [0.0, -0.641 * DEG],
            pole_dec_rad: [90.0 * DEG, -0.557 * DEG],
            meridian_rad: [190.193_93 * DEG, 360.985_610_02 * DEG],
            ..Self::default()
        }
    }

    /// The body's axes at `t`.
    pub fn icrf_from_fixed(&self, t: SimTime) -> Rotation<Icrf, Fixed> {
        self.icrf_from_fixed_at(t.into())
    }

    /// The body's axes at any moment: `R_z(α + 90°) R_x(90° − δ) R_z(W)`, or the Earth's.
    pub fn icrf_from_fixed_at(&self, m: Moment) -> Rotation<Icrf, Fixed> {
        let s = m.seconds();
        if self.model == Model::Earth {
            return Rotation::new(earth::icrf_from_fixed(s / JULIAN_CENTURY, m.ut1_days()));
        }
        let (days, centuries) = (s / DAY, s / JULIAN_CENTURY);
        let (ra, dec) = self.pole_ra_dec(centuries);
        // Whole turns are taken off before the half angle, so that the digits of W go to its fraction.
        let turn = libm::remainder(self.meridian_rad[1] * days, TAU);
        let w =
            self.meridian_rad[0] + turn + self.meridian_quadratic_rad * (centuries * centuries) + sines(&self.meridian_terms, centuries);
        Rotation::new(about_z(ra + FRAC_PI_2) * about_x(FRAC_PI_2 - dec) * about_z(w))
    }

    fn pole_ra_dec(&self, centuries: f64) -> (f64, f64) {
        let ra = self.pole_ra_rad[0] + self.pole_ra_rad[1] * centuries + sines(&self.pole_ra_terms, centuries);
        let nod: f64 = self.pole_dec_terms.iter().map(|t| t.amplitude_rad * libm::cos(t.angle(centuries))).sum();
        (ra, self.pole_dec_rad[0] + self.pole_dec_rad[1] * centuries + nod)
    }

    /// Angular velocity at `t`, in ICRF axes, rad/s.
    pub fn angular_velocity(&self, t: SimTime) -> Vector<Icrf> {
        self.angular_velocity_at(t.into())
    }

    /// Angular velocity at any moment, in ICRF axes, rad/s: the uniform part of the turning about the pole (precession and
    /// librations give less than 1e-4 of it).
    pub fn angular_velocity_at(&self, m: Moment) -> Vector<Icrf> {
        self.icrf_from_fixed_at(m).vector(Vector::xyz(0.0, 0.0, self.rate_rad_s()))
    }

    /// The uniform rate of turning, rad/s; negative when retrograde.
    pub fn rate_rad_s(&self) -> f64 {
        match self.model {
            Model::Iau => self.meridian_rad[1] / DAY,
            Model::Earth => earth::RATE_RAD_S,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::sphere::lat_lon_of;
    use glam::DVec3;

    /// The IAU form with the Earth's numbers.
    fn earth() -> Spin {
        Spin { model: Model::Iau, ..Spin::earth() }
    }

    #[test]
    fn the_earth_turns_its_meridians_to_the_sun_as_the_almanac_says() {
        // Apparent place of the Sun and GMST, low-precision formulae of the Astronomical Almanac (0.01°), with UT1 = TT − 69.1 s.
        for jd in [2_461_265.241_041_667_f64, 2_461_041.5, 2_461_400.9] {
            let t = SimTime::from_jd_tdb(jd);
            let n = jd - 2_451_545.0;
            let (mean, g) = (280.460 + 0.985_647_4 * n, (357.528 + 0.985_600_3 * n) * DEG);
            let lambda = (mean + 1.915 * libm::sin(g) + 0.020 * libm::sin(2.0 * g)) * DEG;
            let tilt = (23.439 - 4e-7 * n) * DEG;
            let ra_of_date = libm::atan2(libm::cos(tilt) * libm::sin(lambda), libm::cos(lambda));
            let dec_of_date = libm::asin(libm::sin(tilt) * libm::sin(lambda));
            let ut = n - 69.1 / 86_400.0;
            let gmst = (18.697_374_558 + 24.065_709_824_419_08 * ut) * 15.0 * DEG;
            let expected_lon = libm::remainder(ra_of_date - gmst, TAU);
            // The same Sun in ICRF: back by the precession in longitude, 1.396 971°/century, about the pole of the ecliptic.
            let l0 = lambda - 1.396_971 * DEG * n / 36_525.0;
            let e0 = 23.439_291 * DEG;
            let sun = DVec3::new(libm::cos(l0), libm::cos(e0) * libm::sin(l0), libm::sin(e0) * libm::sin(l0));
            let (lat, lon) = lat_lon_of(Spin::earth().icrf_from_fixed(t).inverse().raw(sun));
            let miss = libm::remainder(lon - expected_lon, TAU) / DEG;
            assert!(miss.abs() < 0.02, "jd {jd}: longitude off by {miss}°");
            assert!((lat - dec_of_date).abs() < 0.01 * DEG, "jd {jd}: latitude {} for {}", lat / DEG, dec_of_date / DEG);
        }
    }

    #[test]
    fn terms_add_where_the_report_says() {
        let plain = earth();
        let t = SimTime::from_jd_tdb(2_451_545.0);
        let quarter = Term { amplitude_rad: 1.0 * DEG, phase_rad: FRAC_PI_2, rate_rad_per_century: 0.0 };
        let turned = Spin { meridian_terms: vec![quarter], ..plain.clone() };
        let x = plain.icrf_from_fixed(t).inverse().raw(turned.icrf_from_fixed(t).raw(DVec3::X));
        assert!((libm::atan2(x.y, x.x) - 1.0 * DEG).abs() < 1e-12, "W + 1°: the meridian moves east");
        let nodded = Spin { pole_dec_terms: vec![Term { phase_rad: 0.0, ..quarter }], ..plain.clone() };
        let pole = nodded.icrf_from_fixed(t).raw(DVec3::Z);
        assert!((pole - DVec3::new(-libm::sin(1.0 * DEG), 0.0, libm::cos(1.0 * DEG))).length() < 1e-12, "{pole}");
    }

    #[test]
    fn angular_velocity_is_the_turning_of_the_axes() {
        for spin in [earth(), Spin::earth()] {
            let t = SimTime::from_jd_tdb(2_461_265.3);
            let a = spin.icrf_from_fixed(t).raw(DVec3::X);
            let b = spin.icrf_from_fixed(t.plus(60)).raw(DVec3::X);
            let omega = spin.angular_velocity(t.plus(30)).0;
            let middle = spin.icrf_from_fixed_at(Moment::after(t, 0.5)).raw(DVec3::X);
            assert!(((b - a) - omega.cross(middle)).length() < 2e-11, "{}", ((b - a) - omega.cross(middle)).length());
        }
    }
}
