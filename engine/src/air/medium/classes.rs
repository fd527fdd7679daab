//! Classes: the layers of a medium gathered by phase function into at most four, which is what the GPU sees of it.
//!
//! Up to four layers of analytic profile and phase stand as they are, one class each, and cost the shader their formulas alone. Any other
//! medium is *gathered*: layers of the same phase function become one class, whose scattering is a table over altitude; where more than
//! four phase functions scatter, those that scatter least share the last class, mixed in proportion to their vertical optical depths.
//! The uniform and the tables are made in `scene/gpu_air.rs`; the twin is `shaders/lib/medium.wgsl`.

use super::{Layer, Medium, Phase, Profile};
use glam::DVec3;

/// Layers that scatter into the same directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Class {
    /// Phase functions with their shares, which sum to 1.
    pub phases: Vec<(f64, Phase)>,
    /// Its layers, as places in [`Medium::layers`].
    pub layers: Vec<usize>,
}

/// The classes of a medium.
#[derive(Clone, Debug, PartialEq)]
pub struct Classes {
    /// At most [`Classes::MAX`].
    pub list: Vec<Class>,
    /// Whether each is one layer of analytic profile and phase, in the order of the medium.
    pub direct: bool,
}

impl Class {
    /// Value of the phase function at the cosine of the scattering angle, sr⁻¹.
    pub fn value(&self, cos_theta: f64) -> f64 {
        self.phases.iter().map(|(share, phase)| share * phase.value(cos_theta)).sum()
    }

    /// Legendre coefficients χ₀ … χ_`l_max`, as [`Phase::legendre`].
    pub fn legendre(&self, l_max: usize) -> Vec<f64> {
        let mut chi = vec![0.0; l_max + 1];
        for (share, phase) in &self.phases {
            chi.iter_mut().zip(phase.legendre(l_max)).for_each(|(sum, x)| *sum += share * x);
        }
        chi
    }

    /// Scattering coefficient at an altitude, m⁻¹ per channel.
    pub fn scattering(&self, medium: &Medium, altitude_m: f64) -> DVec3 {
        let layers = self.layers.iter().filter_map(|i| medium.layers.get(*i));
        layers.map(|l| l.scattering_per_m.as_dvec3() * l.profile.density(altitude_m)).sum()
    }
}

impl Classes {
    /// Classes that there may be.
    pub const MAX: usize = 4;

    /// Those of a medium.
    pub fn of(medium: &Medium) -> Self {
        let analytic = |l: &Layer| !matches!(l.profile, Profile::Table { .. }) && !matches!(l.phase, Phase::Table { .. });
        if medium.layers.len() <= Self::MAX && medium.layers.iter().all(analytic) {
            let single = |(i, l): (usize, &Layer)| Class { phases: vec![(1.0, l.phase.clone())], layers: vec![i] };
            return Self { list: medium.layers.iter().enumerate().map(single).collect(), direct: true };
        }
        let mut found: Vec<(f64, Class)> = Vec::new();
        for (i, layer) in medium.layers.iter().enumerate() {
            let depth = vertical_depth(layer, medium.top_altitude_m);
            if depth <= 0.0 {
                continue;
            }
            match found.iter_mut().find(|(_, c)| c.phases.iter().any(|p| p.1 == layer.phase)) {
                Some((sum, class)) => {
                    *sum += depth;
                    class.layers.push(i);
                }
                None => found.push((depth, Class { phases: vec![(1.0, layer.phase.clone())], layers: vec![i] })),
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        if found.len() > Self::MAX {
            let rest = found.split_off(Self::MAX - 1);
            let whole: f64 = rest.iter().map(|r| r.0).sum();
            let mut mixed = Class { phases: Vec::new(), layers: Vec::new() };
            for (depth, class) in rest {
                mixed.phases.extend(class.phases.into_iter().map(|(_, phase)| (depth / whole, phase)));
                mixed.layers.extend(class.layers);
            }
            found.push((whole, mixed));
        }
        Self { list: found.into_iter().map(|f| f.1).collect(), direct: false }
    }
}

/// Vertical depth of scattering beyond which a march heeds the bends of a tent: a panel laid across them errs by a twentieth of that depth.
const SEEN: f64 = 0.02;

/// Optical depth of scattering from the datum to the top, mean of the channels.
fn vertical_depth(layer: &Layer, top_m: f64) -> f64 {
    const PARTS: i32 = 256;
    let mean = f64::from(layer.scattering_per_m.element_sum()) / 3.0;
    // Squares of equal parts, as the tables have them.
    let at = |x: i32| {
        let x = (f64::from(x) + 0.5) / f64::from(PARTS);
        layer.profile.density(x * x * top_m) * 2.0 * x * top_m / f64::from(PARTS)
    };
    mean * (0..PARTS).map(at).sum::<f64>()
}

impl Medium {
    /// Extinction coefficient at an altitude, m⁻¹ per channel.
    pub fn extinction(&self, altitude_m: f64) -> DVec3 {
        self.layers.iter().map(|l| (l.scattering_per_m + l.absorption_per_m).as_dvec3() * l.profile.density(altitude_m)).sum()
    }

    /// Altitudes between datum and top where the density of some layer jumps, m: a march must not step across them. At most `most`.
    pub fn jumps_m(&self, most: usize) -> Vec<f64> {
        self.edges_m(most, f64::INFINITY)
    }

    /// The same with the bends of tents deep enough to be seen.
    pub fn cuts_m(&self, most: usize) -> Vec<f64> {
        self.edges_m(most, SEEN)
    }

    fn edges_m(&self, most: usize, seen: f64) -> Vec<f64> {
        let mut all: Vec<(f64, f64)> = Vec::new();
        for layer in &self.layers {
            let strength = f64::from((layer.scattering_per_m + layer.absorption_per_m).max_element());
            let bends = matches!(layer.profile, Profile::Tent { .. }) && vertical_depth(layer, self.top_altitude_m) > seen;
            let peak = layer.profile.breaks_m().into_iter().map(|h| layer.profile.density(h)).fold(0.0, f64::max);
            for h in layer.profile.breaks_m().into_iter().filter(|h| *h > 0.0 && *h < self.top_altitude_m) {
                // A table's steep rise within a few metres is a jump to a march as well.
                let reach = 1e-4 * self.top_altitude_m;
                let jump = (layer.profile.density(h + reach) - layer.profile.density(h - reach)).abs();
                if bends || jump > 0.05 * peak {
                    all.push((strength * jump, h));
                }
            }
        }
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut kept: Vec<f64> = Vec::new();
        for (_, h) in all {
            if kept.len() < most && kept.iter().all(|k| (k - h).abs() > 2e-4 * self.top_altitude_m) {
                kept.push(h);
            }
        }
        kept.sort_by(f64::total_cmp);
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::air::medium::tests::earth;
    use glam::Vec3;

    fn layer(scattering: f32, phase: Phase) -> Layer {
        Layer {
            scattering_per_m: Vec3::splat(scattering),
            absorption_per_m: Vec3::ZERO,
            profile: Profile::Exponential { scale_height_m: 8000.0 },
            phase,
        }
    }

    #[test]
    fn a_simple_medium_stands_as_it_is() {
        let classes = Classes::of(&earth());
        assert!(classes.direct && classes.list.len() == 3);
        assert_eq!(classes.list[1].phases, [(1.0, Phase::CornetteShanks { g: 0.8 })]);
    }

    #[test]
    fn layers_of_one_phase_are_one_class_and_the_weakest_share_the_last() {
        let mut medium = earth();
        let g = |g| Phase::HenyeyGreenstein { g };
        medium.layers = vec![
            layer(1e-6, g(0.1)),
            layer(8e-6, g(0.2)),
            layer(2e-6, g(0.3)),
            layer(9e-6, Phase::Rayleigh),
            layer(7e-6, g(0.5)),
            layer(1e-6, Phase::Rayleigh),
            layer(0.0, g(0.6)),
        ];
        let classes = Classes::of(&medium);
        assert!(!classes.direct);
        let layers: Vec<_> = classes.list.iter().map(|c| c.layers.clone()).collect();
        assert_eq!(layers, [vec![3, 5], vec![1], vec![4], vec![2, 0]]);
        // Their light is kept: what the classes scatter in a direction is what the layers scatter, for profiles of one shape.
        for (c, h) in [(0.3, 0.0), (-0.9, 5e3), (1.0, 2e4)] {
            let one: DVec3 = classes.list.iter().map(|k| k.scattering(&medium, h) * k.value(c)).sum();
            let all: DVec3 = medium.layers.iter().map(|l| l.scattering_per_m.as_dvec3() * l.profile.density(h) * l.phase.value(c)).sum();
            assert!((one / all - 1.0).abs().max_element() < 1e-6, "{c} {h}: {one} {all}");
        }
        let chi = classes.list[3].legendre(2);
        assert!((chi[0] - 1.0).abs() < 1e-9 && (chi[1] - (2.0 * 0.3 + 0.1) / 3.0).abs() < 1e-6, "{chi:?}");
    }

    #[test]
    fn jumps_are_edges_of_constant_layers_and_not_bends() {
        let mut medium = earth();
        assert!(medium.jumps_m(8).is_empty());
        medium.layers[0].profile = Profile::Constant { bottom_m: 2000.0, top_m: 2500.0 };
        medium.layers[1].profile = Profile::Table { altitude_m: vec![0.0, 5000.0, 5001.0, 9000.0], density: vec![1.0, 1.0, 0.1, 0.0] };
        let jumps = medium.jumps_m(8);
        assert!(jumps.len() == 3 && jumps[..2] == [2000.0, 2500.0] && (jumps[2] - 5000.5).abs() < 1.0, "{jumps:?}");
        assert_eq!(medium.jumps_m(1).len(), 1);
        // The bends of dust aloft are cuts too; those of a breath of it are not worth it.
        medium.layers.truncate(1);
        medium.layers[0].profile = Profile::Tent { bottom_m: 2000.0, peak_m: 3000.0, top_m: 4000.0 };
        medium.layers[0].scattering_per_m = Vec3::splat(1e-5);
        assert_eq!(medium.cuts_m(8), Vec::<f64>::new());
        medium.layers[0].scattering_per_m = Vec3::splat(3e-5);
        assert_eq!((medium.cuts_m(8), medium.jumps_m(8)), (vec![2000.0, 3000.0, 4000.0], Vec::new()));
    }
}
