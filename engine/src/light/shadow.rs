//! The shadow of a ball in a star's light: two cones about the line away from the star, the umbra, which narrows where the ball is smaller than the
//! star (and beyond its tip is where the ball stands wholly before the star), and the penumbra, which widens.
//!
//! Twin of `air_shade` of `shaders/lib/air_shadow.wgsl`. Not here: which fraction of the disc is free at a point ([`super::occlusion`]).

use glam::DVec3;

/// A ball's shadow. Positions in m from wherever the caller counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadow {
    /// Centre of the ball.
    pub from_m: DVec3,
    /// Away from the star, unit.
    pub axis: DVec3,
    /// Radius of the ball, m.
    pub radius_m: f64,
    /// Sines of the half angles of umbra and penumbra, signed as they widen.
    pub sines: [f64; 2],
}

/// A plane across a shadow, on which places go by x from the axis as t, −1 … 1: `|x| = half ((n |t| + bend)² − bend²)`, n = √(1 + bend²) − bend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// Its first direction, unit; the second is the axis times it.
    pub across: DVec3,
    /// From the axis to its edge, m.
    pub half_m: f64,
    /// How little denser it is at the axis.
    pub bend: f64,
}

impl Shadow {
    /// Of a ball, in the light of a star apart from it.
    pub fn new(ball: (DVec3, f64), star: (DVec3, f64)) -> Self {
        let away = ball.0 - star.0;
        let distance_m = away.length().max(1e-3);
        let sines = [ball.1 - star.1, ball.1 + star.1].map(|x| (x / distance_m).clamp(-0.999, 0.999));
        Self { from_m: ball.0, axis: away.normalize_or(DVec3::Z), radius_m: ball.1, sines }
    }

    /// Distance of a point along the axis, m, negative before the ball; and from the axis.
    pub fn place(&self, point_m: DVec3) -> (f64, f64) {
        let out = point_m - self.from_m;
        let along = out.dot(self.axis);
        (along, (out - self.axis * along).length())
    }

    /// Radii of umbra (negative beyond its tip) and penumbra at a distance along the axis, m.
    pub fn radii_m(&self, along_m: f64) -> [f64; 2] {
        self.sines.map(|s| (self.radius_m + along_m * s) / (1.0 - s * s).sqrt())
    }

    /// The plane across it in which what it does to a body is kept; `near_m`: how far beyond the penumbra that goes, `finest_m`: size of what must be
    /// told apart at the axis, `cells`: how many there are from side to side. `None` where the shadow stays that far from the body.
    pub fn sheet(&self, centre_m: DVec3, radius_m: f64, near_m: f64, finest_m: f64, cells: f64) -> Option<Sheet> {
        if !self.reaches(centre_m, radius_m, near_m) {
            return None;
        }
        let half_m = self.radii_m(self.place(centre_m).0 + radius_m)[1] + near_m;
        // Of x = X ((n t + a)² − a²), n = √(1 + a²) − a, the first cell is 4 a n X / cells.
        let q = (0.25 * finest_m * cells / half_m).min(0.45);
        let bend = q / (1.0 - 2.0 * q).sqrt();
        // Azimuths cannot be told where the ground stands across the first direction: a quarter turn from where the shadow falls.
        let up = self.meets_m(centre_m, radius_m) - centre_m;
        let across = self.axis.cross(up).try_normalize().unwrap_or_else(|| self.axis.any_orthonormal_vector());
        Some(Sheet { across, half_m, bend })
    }

    /// Whether any point of a ball has a part of the star hidden, or lies within `near_m` of one that has.
    pub fn reaches(&self, centre_m: DVec3, radius_m: f64, near_m: f64) -> bool {
        let (along, aside) = self.place(centre_m);
        let far = along + radius_m;
        // What is a distance away from the cone's side is at most that over the cosine from its radius there.
        far > -self.radius_m && aside <= self.radii_m(far)[1] + (radius_m + near_m) / (1.0 - self.sines[1] * self.sines[1]).sqrt()
    }

    /// Where the axis enters a ball, or is nearest to its centre where it misses it.
    pub fn meets_m(&self, centre_m: DVec3, radius_m: f64) -> DVec3 {
        let (along, aside) = self.place(centre_m);
        self.from_m + self.axis * (along - (radius_m * radius_m - aside * aside).max(0.0).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::occlusion::visible_behind_disc;
    use crate::units::{AU, KM};

    #[test]
    fn cones_are_where_discs_touch() {
        let (sun, moon) = ((DVec3::X * AU, 695_700.0 * KM), (DVec3::X * 3.6e8, 1737.4 * KM));
        let shadow = Shadow::new(moon, sun);
        let free = |point: DVec3| {
            let (s, m) = (sun.0 - point, moon.0 - point);
            let angle = |v: DVec3, r: f64| libm::asin(r / v.length());
            visible_behind_disc(angle(s, sun.1), angle(m, moon.1), s.angle_between(m))
        };
        for along in [3.5e8, 3.6e8, 3.9e8] {
            let [umbra, penumbra] = shadow.radii_m(along).map(f64::abs);
            let at = |aside: f64| free(moon.0 - DVec3::X * along + DVec3::Y * aside);
            assert!(at(penumbra + 2e3) == 1.0 && at(penumbra - 2e3) < 1.0, "{along}");
            // Inside: nothing, or what stands over around the whole disc.
            assert!(at(umbra - 2e3) == at(0.0) || (at(umbra - 2e3) - at(0.0)).abs() < 1e-6, "{along}");
            assert!(at(umbra + 2e3) > at(0.0), "{along}");
        }
        assert!(shadow.radii_m(3.6e8)[0] > 0.0 && shadow.radii_m(3.9e8)[0] < 0.0);
    }

    /// Mean free fractions on a ring of ground about a place across the shadow, and their second moments, by this many azimuths; `None` off the day side.
    fn ring(
        shadow: &Shadow,
        sun: (DVec3, f64),
        ground_m: f64,
        sheet: &Sheet,
        x: [f64; 2],
        radius_m: f64,
        azimuths: u32,
    ) -> Option<[f64; 3]> {
        let (first, second) = (sheet.across, shadow.axis.cross(sheet.across));
        let aside = shadow.from_m - shadow.axis * shadow.from_m.dot(shadow.axis) + first * x[0] + second * x[1];
        let out = aside - shadow.axis * (ground_m * ground_m - aside.length_squared()).max(0.0).sqrt();
        let up = out.normalize();
        let ahead = (first - up * first.dot(up)).normalize();
        let mut sum = [0.0; 3];
        for i in 0..azimuths {
            let (s, c) = (core::f64::consts::TAU * (f64::from(i) + 0.5) / f64::from(azimuths)).sin_cos();
            let at = out + (ahead * c + up.cross(ahead) * s) * radius_m;
            let (star, ball) = (sun.0 - at, shadow.from_m - at);
            let angle = |v: DVec3, r: f64| libm::asin(r / v.length());
            let free = visible_behind_disc(angle(star, sun.1), angle(ball, shadow.radius_m), star.angle_between(ball));
            [1.0, c * c - s * s, 2.0 * s * c].iter().zip(&mut sum).for_each(|(w, sum)| *sum += w * free / f64::from(azimuths));
        }
        (aside.length() < 0.97 * ground_m).then_some(sum)
    }

    #[test]
    fn a_sheet_keeps_its_rings() {
        // As pass/eclipse_rings.wgsl fills it and lib/eclipse_rings.wgsl reads it: 80 texels each way, 12 azimuths, even in between.
        const N: usize = 80;
        let ground_m = 6371.0 * KM;
        let sun = ((DVec3::new(0.8, 0.3, 0.52)).normalize() * AU, 695_700.0 * KM);
        let to_moon = sun.0.normalize() * 3.66e8 + sun.0.normalize().any_orthonormal_vector() * 4.0e6;
        let shadow = Shadow::new((to_moon, 1737.4 * KM), sun);
        let sheet = shadow.sheet(DVec3::ZERO, ground_m, 6e5, 14e3, N as f64).unwrap();
        let scale = (1.0 + sheet.bend * sheet.bend).sqrt() - sheet.bend;
        let offset = |t: f64| ((t.abs() * scale + sheet.bend).powi(2) - sheet.bend * sheet.bend) * sheet.half_m * t.signum();
        let texel = |i: usize| offset(2.0 * i as f64 / (N - 1) as f64 - 1.0);
        let (mut worst, mut places) = ([0.0_f64; 3], 0);
        for radius_m in [4e4, 1.2e5, 4.5e5] {
            for k in 0..400_usize {
                // Places dense about the axis, between texels.
                let [i, j] = [k * 7 % (N - 1), k * 11 % (N - 1)];
                let [fx, fy] = [k * 13 % 16, k * 5 % 16].map(|f| (f as f64 + 0.5) / 16.0);
                let x = [(i, fx), (j, fy)].map(|(i, f)| offset(2.0 * (i as f64 + f) / (N - 1) as f64 - 1.0));
                let Some(truth) = ring(&shadow, sun, ground_m, &sheet, x, radius_m, 96) else { continue };
                let at = |di: usize, dj: usize| ring(&shadow, sun, ground_m, &sheet, [texel(i + di), texel(j + dj)], radius_m, 12);
                let [Some(a), Some(b), Some(c), Some(d)] = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)] else { continue };
                places += 1;
                for m in 0..3 {
                    let found = (a[m] * (1.0 - fx) + b[m] * fx) * (1.0 - fy) + (c[m] * (1.0 - fx) + d[m] * fx) * fy;
                    worst[m] = worst[m].max((found - truth[m]).abs());
                }
            }
        }
        println!("{places} places: {worst:?}");
        assert!(places > 300 && worst.iter().all(|w| *w < 2e-3) && worst[0] > 1e-4, "{places}: {worst:?}");
    }

    #[test]
    fn a_ball_is_reached_from_the_cone_s_side_on() {
        let shadow = Shadow::new((DVec3::X * 3.6e8, 1737.4 * KM), (DVec3::X * AU, 695_700.0 * KM));
        let ball = 6371.0 * KM;
        let side = shadow.radii_m(3.6e8)[1] + ball;
        let reaches = |y: f64, near| shadow.reaches(DVec3::Y * y, ball, near);
        assert!(reaches(side - 10e3, 0.0) && !reaches(side + 50e3, 0.0) && reaches(side + 50e3, 60e3));
        // On the day side of the caster nothing is shaded.
        assert!(!shadow.reaches(DVec3::X * 3.7e8, 5e6, 0.0) && shadow.reaches(DVec3::X * 3.7e8, 2e7, 0.0));
        let at = shadow.meets_m(DVec3::Y * 3e6, ball);
        assert!(((at - DVec3::Y * 3e6).length() - ball).abs() < 1.0 && at.x > 0.0);
    }
}
