//! The model `limb_table` [Dolan, "Rendering High Quality Atmosphere On The Cheap"]: its settings, and its formula in f64.
//!
//! The light that a ray gathers on its way through the shell is `light_scale × ∫ (1 − h)³ ds` over the lit stretches: h is the altitude over
//! the top's, s is counted in radii of the planet, lit is what the planet does not hide from the light. Nothing is absorbed and no phase
//! function is asked, so the light is added to the picture and whatever lies behind keeps all of its own. The table holds that by two
//! cosines at the shell's top, of the eye and of the light against the zenith, both on the same side of it; any number of lights is
//! drawn by as many passes.
//!
//! Where the table leaves off: a chord that goes away from the light is looked up from its other end, where it goes towards it (without
//! absorption both ends see the same), and between the two sides by the cosine of the azimuth. Inside the shell there is no table: the
//! march starts at the eye, with the shadow where it is on the ground and where the table has it at the top ([`LimbTable::lit_column`]).
//!
//! Not here: the bake and the drawing (`shaders/lib/limb_table.wgsl`, `render/pass/sky/limb_table.rs`). The medium's layers are not asked.

use super::super::RangeError;
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

/// Settings of the model `limb_table`; the defaults are Dolan's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LimbTable {
    /// Texels each way, even, 8 … 1024.
    pub size: u32,
    /// What a stretch of one planet radius of air of density 1 sends, per unit of the light's illuminance, sr⁻¹ per channel, 0 … 1000.
    pub light_scale_per_sr: Vec3,
    /// Longest step of the bake's march, planet radii, 1e-5 … 1. A ray has [`LimbTable::LEAST_STEPS`] to [`LimbTable::MOST_STEPS`].
    pub march_step_radii: f32,
    /// Exponent n of the density (1 − h)ⁿ, 0 … 32.
    pub density_exponent: f32,
}

impl Default for LimbTable {
    fn default() -> Self {
        Self { size: 256, light_scale_per_sr: Vec3::new(0.1, 0.1, 0.3), march_step_radii: 0.005, density_exponent: 3.0 }
    }
}

/// A ray within the shell, by what the formula needs of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShellRay {
    /// Radius of the planet, m.
    pub radius_m: f64,
    /// Altitude of the shell's top, m.
    pub top_m: f64,
    /// Altitude of the ray's start, m, 0 … `top_m`.
    pub altitude_m: f64,
    /// Cosine of the ray against the zenith at its start.
    pub mu: f64,
    /// Cosine of the direction to the light against that zenith.
    pub mu_s: f64,
    /// Cosine between the ray and the direction to the light.
    pub nu: f64,
}

impl ShellRay {
    /// The same in the plane of the light: on the eye's side of the zenith as the light is (the table's rays), or on the other.
    #[must_use]
    pub fn coplanar(&self, light_on_the_eye_s_side: bool) -> Self {
        let sines = ((1.0 - self.mu * self.mu).max(0.0) * (1.0 - self.mu_s * self.mu_s).max(0.0)).sqrt();
        Self { nu: self.mu * self.mu_s + if light_on_the_eye_s_side { -sines } else { sines }, ..*self }
    }

    /// Where the ray ends, m: on the planet or at the top; true for the planet.
    pub fn end_m(&self) -> (f64, bool) {
        let (r, top) = (self.radius_m + self.altitude_m, self.radius_m + self.top_m);
        let slope = r * self.mu;
        let q = self.altitude_m * (2.0 * self.radius_m + self.altitude_m);
        let rest = slope * slope - q;
        if slope < 0.0 && rest > 0.0 {
            return ((q / (rest.sqrt() - slope)).max(0.0), true);
        }
        (-slope + (slope * slope - r * r + top * top).max(0.0).sqrt(), false)
    }

    /// The stretch that the planet hides from the light, m along the ray without end; `None` where all of it is lit. A point p is hidden
    /// when p·L < 0 and its distance from the line through the centre along L is under the radius.
    pub fn hidden_m(&self) -> Option<(f64, f64)> {
        let r = self.radius_m + self.altitude_m;
        let (along, slope) = (r * self.mu_s, r * self.mu);
        let a = 1.0 - self.nu * self.nu;
        let b = slope - along * self.nu;
        let c = self.altitude_m * (2.0 * self.radius_m + self.altitude_m) - along * along;
        let mut hidden = (0.0, f64::INFINITY);
        if a > 1e-12 {
            let rest = b * b - a * c;
            if rest <= 0.0 {
                return None;
            }
            hidden = ((-b - rest.sqrt()) / a, (-b + rest.sqrt()) / a);
        } else if c >= 0.0 {
            return None;
        }
        // The half on the light's side is free: along + s ν < 0 is hidden.
        if self.nu > 0.0 {
            hidden.1 = hidden.1.min(-along / self.nu);
        } else if self.nu < 0.0 {
            hidden.0 = hidden.0.max(-along / self.nu);
        } else if along >= 0.0 {
            return None;
        }
        hidden.0 = hidden.0.max(0.0);
        (hidden.1 > hidden.0).then_some(hidden)
    }
}

/// Part of a step that is not hidden.
fn lit_part(from: f64, to: f64, hidden: Option<(f64, f64)>) -> f64 {
    let Some((a, b)) = hidden else { return 1.0 };
    1.0 - ((to.min(b) - from.max(a)).max(0.0) / (to - from)).min(1.0)
}

impl LimbTable {
    /// Fewest steps of a ray in the bake: his own step is longer than thin air is deep.
    pub const LEAST_STEPS: u32 = 16;
    /// Most steps of a ray in the bake.
    pub const MOST_STEPS: u32 = 4096;

    /// Everything that is out of range, all together; empty when all is well.
    pub fn validate(&self) -> Vec<RangeError> {
        let mut e = Vec::new();
        RangeError::check(&mut e, "size", f64::from(self.size), 8.0, 1024.0);
        if !self.size.is_multiple_of(2) {
            e.push(RangeError { field: "size".into(), found: f64::from(self.size), expected: "an even number".into() });
        }
        for (i, x) in self.light_scale_per_sr.to_array().into_iter().enumerate() {
            RangeError::check(&mut e, &format!("light_scale_per_sr[{i}]"), f64::from(x), 0.0, 1000.0);
        }
        RangeError::check(&mut e, "march_step_radii", f64::from(self.march_step_radii), 9.99e-6, 1.0);
        RangeError::check(&mut e, "density_exponent", f64::from(self.density_exponent), 0.0, 32.0);
        e
    }

    /// Density at an altitude over the top's altitude; 1 below the datum, 0 above the top.
    pub fn density(&self, h: f64) -> f64 {
        libm::pow((1.0 - h).clamp(0.0, 1.0), f64::from(self.density_exponent))
    }

    /// Steps of the bake's march over a stretch.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub fn steps(&self, stretch_radii: f64) -> u32 {
        let wanted = (stretch_radii / f64::from(self.march_step_radii)).ceil();
        if wanted.is_finite() { (wanted as u32).clamp(Self::LEAST_STEPS, Self::MOST_STEPS) } else { Self::MOST_STEPS }
    }

    /// `∫ density ds` over the lit part of a ray from its start to `end_m`, planet radii, by `steps` midpoints. `lit(from, to)` is the part of
    /// a step (m) that is lit.
    pub fn column(&self, ray: &ShellRay, end_m: f64, steps: u32, lit: impl Fn(f64, f64) -> f64) -> f64 {
        let dt = end_m / f64::from(steps.max(1));
        if dt <= 0.0 {
            return 0.0;
        }
        let q = ray.altitude_m * (2.0 * ray.radius_m + ray.altitude_m);
        let slope = (ray.radius_m + ray.altitude_m) * ray.mu;
        let at = |i: u32| {
            let from = f64::from(i) * dt;
            let s = from + 0.5 * dt;
            let q = q + s * (2.0 * slope + s);
            let altitude = q / (ray.radius_m + (ray.radius_m * ray.radius_m + q).max(0.0).sqrt());
            self.density(altitude / ray.top_m) * lit(from, from + dt)
        };
        (0..steps).map(at).sum::<f64>() * dt / ray.radius_m
    }

    /// An entry of the table, planet radii: the eye at cosine `eye`, the light at cosine `light` against the zenith of a point of the top.
    pub fn entry(&self, radius_m: f64, top_m: f64, eye: f64, light: f64) -> f64 {
        let ray = ShellRay { radius_m, top_m, altitude_m: top_m, mu: -eye, mu_s: light, nu: 0.0 }.coplanar(true);
        let (end, hidden) = (ray.end_m().0, ray.hidden_m());
        self.column(&ray, end, self.steps(end / radius_m), |a, b| lit_part(a, b, hidden))
    }

    /// The same for the ray as it is drawn, from any altitude in the shell to `end_m`, by `steps`: at the top as the table has it, lower
    /// more and more by the light's true direction (all of it on the ground).
    pub fn lit_column(&self, ray: &ShellRay, end_m: f64, steps: u32) -> f64 {
        let near = ray.coplanar(true);
        let far = ray.coplanar(false);
        let side = if ray.end_m().1 { 0.0 } else { ((ray.nu - near.nu) / (far.nu - near.nu).max(1e-12)).clamp(0.0, 1.0) };
        let true_part = 1.0 - (ray.altitude_m / ray.top_m) * (ray.altitude_m / ray.top_m);
        let hidden = [ray, &near, &far].map(ShellRay::hidden_m);
        self.column(ray, end_m, steps, |a, b| {
            let [exact, near, far] = hidden.map(|h| lit_part(a, b, h));
            let table = near + (far - near) * side;
            table + (exact - table) * true_part
        })
    }

    /// What a ray from outside brings by the table, per unit of illuminance, sr⁻¹ per channel. `from_m` is relative to the planet's
    /// centre; `direction` and `light` are unit vectors.
    pub fn from_outside(&self, radius_m: f64, top_m: f64, from_m: DVec3, direction: DVec3, light: DVec3) -> DVec3 {
        let top = radius_m + top_m;
        let b = from_m.dot(direction);
        let rest = b * b - from_m.length_squared() + top * top;
        if rest <= 0.0 || b >= 0.0 {
            return DVec3::ZERO;
        }
        let start = from_m + direction * (-b - rest.sqrt());
        let (eye, mu_s) = (-start.dot(direction) / top, start.dot(light) / top);
        let ray = ShellRay { radius_m, top_m, altitude_m: top_m, mu: -eye, mu_s, nu: direction.dot(light) };
        let (end, ground) = ray.end_m();
        let near = self.entry(radius_m, top_m, eye, mu_s);
        let column = if ground {
            near
        } else {
            let (same, other) = (ray.coplanar(true).nu, ray.coplanar(false).nu);
            let side = ((ray.nu - same) / (other - same).max(1e-12)).clamp(0.0, 1.0);
            let far = self.entry(radius_m, top_m, eye, (start + direction * end).dot(light) / top);
            near + (far - near) * side
        };
        self.light_scale_per_sr.as_dvec3() * column
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const R: f64 = 1.0e6;
    const TOP: f64 = 5.0e4;

    fn ray(altitude_m: f64, mu: f64, mu_s: f64) -> ShellRay {
        ShellRay { radius_m: R, top_m: TOP, altitude_m, mu, mu_s, nu: 0.0 }.coplanar(true)
    }

    /// His loop as he describes it: fixed steps from the entry, each counted whole where the line to the light misses the planet.
    fn by_his_steps(settings: &LimbTable, eye: f64, light: f64, step_radii: f64) -> f64 {
        let up = DVec3::Z;
        let towards = |c: f64| DVec3::new((1.0 - c * c).sqrt(), 0.0, c);
        let (along, light) = (-towards(eye), towards(light));
        let start = up * (1.0 + TOP / R);
        let end = ray(TOP, -eye, 0.0).end_m().0 / R;
        let (mut sum, mut t) = (0.0, 0.0);
        while t < end {
            let p = start + along * t;
            let b = p.dot(light);
            let blocked = b < 0.0 && p.length_squared() - b * b < 1.0;
            if !blocked {
                sum += settings.density((p.length() - 1.0) / (TOP / R)) * step_radii;
            }
            t += step_radii;
        }
        sum
    }

    #[test]
    fn the_bake_is_his_loop() {
        let settings = LimbTable { march_step_radii: 2e-4, ..LimbTable::default() };
        for eye in [0.02, 0.1, 0.2, 0.29, 0.32, 0.6, 1.0] {
            for light in [-1.0, -0.4, -0.3, -0.25, -0.1, 0.0, 0.2, 0.9, 1.0] {
                let (ours, his) = (settings.entry(R, TOP, eye, light), by_his_steps(&settings, eye, light, 2e-5));
                assert!((ours - his).abs() < 4e-5, "{eye}, {light}: {ours}, by his steps {his}");
            }
        }
    }

    #[test]
    fn straight_down_it_has_its_closed_form() {
        // ∫₀¹ (1 − h)ⁿ dh = 1/(n+1), times the shell's depth in radii.
        for n in [0.0, 1.0, 3.0, 6.5] {
            let settings = LimbTable { density_exponent: n, march_step_radii: 1e-4, ..LimbTable::default() };
            let truth = TOP / R / f64::from(n + 1.0);
            assert!((settings.entry(R, TOP, 1.0, 1.0) / truth - 1.0).abs() < 1e-5, "{n}");
        }
        let flat = LimbTable { density_exponent: 0.0, ..LimbTable::default() };
        let chord = 2.0 * 0.1 * (R + TOP) / R;
        assert!((flat.entry(R, TOP, 0.1, 1.0) / chord - 1.0).abs() < 1e-12, "a chord of even air is its length");
        assert_eq!(flat.entry(R, TOP, 1.0, -1.0), 0.0, "midnight");
    }

    #[test]
    fn a_chord_looks_the_same_from_both_ends() {
        // No absorption: what goes away from the light in its plane is the reverse of what comes towards it.
        let settings = LimbTable { march_step_radii: 1e-4, ..LimbTable::default() };
        let from = DVec3::new(3.0e6, 0.0, 1.03e6);
        for angle in [0.2, 1.4, 1.7, 3.0_f64] {
            let light = DVec3::new(angle.cos(), 0.0, angle.sin());
            let there = settings.from_outside(R, TOP, from, DVec3::NEG_X, light);
            let back = settings.from_outside(R, TOP, DVec3::new(-3.0e6, 0.0, 1.03e6), DVec3::X, light);
            assert!((there - back).length() < 1e-4 * there.length().max(1e-3), "{angle}: {there} and {back}");
        }
    }

    #[test]
    fn the_march_from_inside_meets_the_table_at_the_top() {
        let settings = LimbTable { march_step_radii: 1e-4, ..LimbTable::default() };
        for (eye, mu_s, azimuth) in [(0.1_f64, -0.05_f64, 0.0), (0.2, -0.1, 2.2), (0.25, 0.1, 3.1), (0.5, -0.2, 1.0), (0.9, 0.7, 0.3_f64)] {
            let light = DVec3::new((1.0 - mu_s * mu_s).sqrt() * azimuth.cos(), (1.0 - mu_s * mu_s).sqrt() * azimuth.sin(), mu_s);
            let direction = DVec3::new(-(1.0 - eye * eye).sqrt(), 0.0, -eye);
            let start = DVec3::Z * (R + TOP);
            let outside = settings.from_outside(R, TOP, start - direction * 1e3, direction, light);
            let inner = ShellRay { radius_m: R, top_m: TOP, altitude_m: TOP, mu: -eye, mu_s, nu: direction.dot(light) };
            let inside = settings.light_scale_per_sr.as_dvec3() * settings.lit_column(&inner, inner.end_m().0, 4000);
            // The two azimuths are exact; between them the blend of lookups is the blend of parts only where the ends' shadows are alike.
            assert!((inside - outside).length() < 0.02 * outside.length().max(1e-3), "{eye}, {mu_s}: {inside} and {outside}");
        }
    }

    #[test]
    fn the_shadow_is_a_half_cylinder() {
        // Level at the terminator, towards the night: hidden from where the line dips under the radius.
        let r = ShellRay { radius_m: R, top_m: TOP, altitude_m: TOP, mu: 0.0, mu_s: 0.0, nu: -1.0 };
        assert_eq!(r.hidden_m(), None, "the line stays above the planet's edge");
        let grazing = ShellRay { altitude_m: 0.5 * TOP, nu: 0.0, mu: 0.0, mu_s: -0.5, ..r };
        let (a, b) = grazing.hidden_m().unwrap();
        let half = (R * R - (0.75_f64 * (R + 0.5 * TOP) * (R + 0.5 * TOP))).sqrt();
        assert!(a == 0.0 && (b / half - 1.0).abs() < 1e-9, "{a}, {b}, {half}");
    }

    #[test]
    fn bad_settings_are_told_all_at_once() {
        assert!(LimbTable::default().validate().is_empty());
        let bad = LimbTable { size: 7, light_scale_per_sr: Vec3::new(0.1, -1.0, f32::NAN), march_step_radii: 0.0, density_exponent: 99.0 };
        let fields: Vec<String> = bad.validate().into_iter().map(|e| e.field).collect();
        let expected = ["size", "size", "light_scale_per_sr[1]", "light_scale_per_sr[2]", "march_step_radii", "density_exponent"];
        assert_eq!(fields, expected);
    }
}
