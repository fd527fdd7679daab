//! Full: every term on a ship, whether it counts or not, as one function; the yardstick of what [`crate::orbit::field`] leaves out.
//!
//! Written with the house's plain accelerations ([`crate::orbit::gravity`]) and run by any method of
//! [`crate::orbit::integrate`]: nothing is shared with the steps of a path but the ephemeris.

use super::model::{Model, Places};
use crate::orbit::BodyId;
use crate::orbit::gravity::relativity::schwarzschild;
use crate::orbit::gravity::zonal::zonal;
use crate::orbit::gravity::{point_mass, tide};
use crate::orbit::integrate::Force;
use crate::space::{Centred, Position, Velocity};
use crate::time::Moment;
use glam::DVec3;

/// The force on ships about one body, which need not dominate: times are seconds after `epoch`.
#[derive(Clone, Copy)]
pub struct Full<'a> {
    /// The system.
    pub model: &'a Model,
    /// Where its bodies are.
    pub places: &'a dyn Places,
    /// The body at the origin.
    pub host: BodyId,
    /// Time 0.
    pub epoch: Moment,
}

impl Force for Full<'_> {
    const USES_VELOCITY: bool = true;

    #[allow(clippy::cast_possible_truncation)]
    fn accelerations(&self, t: f64, q: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
        let at = self.epoch.plus_s(t);
        let Some(host) = self.model.body(self.host).map(|b| b.source) else { return };
        let [pole, _] = self.model.pole(self.host, at);
        let others: Vec<(f64, Position<Centred>)> = (0..self.model.len())
            .map(|i| BodyId(i as u16))
            .filter(|id| *id != self.host)
            .filter_map(|id| {
                let gm = self.model.body(id)?.source.gm_m3_s2;
                Some((gm, Position::new(self.places.relative_at(id, self.host, at).position.0)))
            })
            .collect();
        for ((q, v), a) in q.iter().zip(v).zip(a) {
            let here = Position::<Centred>::new(*q);
            let mut sum = point_mass(host.gm_m3_s2, here).0;
            sum += zonal(host.gm_m3_s2, host.zonal, host.reference_radius_m, pole, here).0;
            sum += schwarzschild(host.gm_m3_s2, here, Velocity::new(*v)).0;
            *a = others.iter().fold(sum, |sum, (gm, place)| sum + tide(*gm, *place, here).0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::ephemeris::{Ephemeris, Orbit, Path as Given};
    use crate::orbit::field::{Bound, Source};
    use crate::orbit::integrate::Points;
    use crate::orbit::integrate::gauss_radau::GaussRadau;
    use crate::orbit::path::{Body, Knot, Path};
    use crate::orbit::rotation::Spin;
    use crate::orbit::{BodyId, State};
    use crate::time::SimTime;
    use crate::units::{AU, DAY, DEG};

    /// Parent, GM, position, velocity.
    type Listed = (Option<u16>, f64, [f64; 3], [f64; 3]);

    /// Sun, Venus, Earth, Moon, Jupiter of SS11 in `orbit_cases.json` (JPL DE440, J2000.0; AU, AU/day, AU³/day²).
    const BODIES: [Listed; 5] = [
        (
            None,
            2.959_122_082_841_195_6e-4,
            [-0.007_137_179_161_607_904, -0.002_647_338_380_839_309, -0.000_922_908_752_917_703_9],
            [5.378_460_339_618_783e-6, -6.758_185_291_968_558_5e-6, -3.032_860_013_356_532_6e-6],
        ),
        (
            Some(0),
            7.243_452_332_644_119e-10,
            [-0.725_439_485_506_996_8, -0.048_921_585_082_952_655, 0.023_717_729_702_510_907],
            [8.034_959_761_149_406e-4, -0.018_498_595_666_354_38, -0.008_372_768_198_033_481],
        ),
        (
            Some(0),
            8.887_692_446_707_102e-10,
            [-0.184_272_278_434_281_54, 0.884_781_183_944_642_3, 0.383_819_990_335_272_3],
            [-0.017_202_246_608_380_416, -0.002_904_925_902_856_414_2, -0.001_259_427_912_193_897],
        ),
        (
            Some(2),
            1.093_189_462_402_435e-11,
            [-0.186_221_560_086_947_68, 0.882_998_292_034_843_1, 0.383_311_276_630_031_7],
            [-0.016_830_576_131_797_06, -0.003_289_623_730_681_292, -0.001_433_458_069_098_185_2],
        ),
        (
            Some(0),
            2.825_345_825_225_792e-7,
            [3.994_039_981_964_449, 2.733_931_385_640_763, 1.074_589_372_071_324],
            [-0.004_562_935_066_413_099, 0.005_874_703_944_687_598, 0.002_629_270_155_912_163],
        ),
    ];

    /// The system under two bounds.
    fn sol(bounds: [Bound; 2]) -> ([Model; 2], Ephemeris) {
        let (gm, speed) = (AU * AU * AU / (DAY * DAY), AU / DAY);
        let epoch = SimTime::from_ticks(0);
        let orbits: Vec<Orbit> = BODIES
            .iter()
            .map(|(parent, mass, r, v)| Orbit {
                parent: parent.map(BodyId),
                gm_m3_s2: mass * gm,
                path: Given::Barycentric {
                    epoch,
                    state: State { position: Position::new(DVec3::from(*r) * AU), velocity: Velocity::new(DVec3::from(*v) * speed) },
                    of_system: false,
                },
            })
            .collect();
        let places = Ephemeris::new(orbits.clone()).unwrap();
        let list = |_| -> Vec<Body> {
            (0..5_u16)
                .map(|i| {
                    let o = &orbits[usize::from(i)];
                    let mut source = Source { parent: o.parent, reach: places.reach(BodyId(i)), gm_m3_s2: o.gm_m3_s2, ..Source::default() };
                    if i == 2 {
                        source.zonal = [1.082_625_39e-3, -2.532_41e-6, -1.619_898e-6];
                        source.reference_radius_m = 6.378_136_6e6;
                    }
                    let soi_m = [f64::INFINITY, 6.2e8, 9.2e8, 6.6e7, 4.8e10][usize::from(i)];
                    let spin = Spin { pole_dec_rad: [90.0 * DEG, -0.5567 * DEG], ..Spin::default() };
                    Body { source, spin, soi_m, low_m: [7e8, 6.1e6, 6.4e6, 1.74e6, 7e7][usize::from(i)], ..Body::default() }
                })
                .collect()
        };
        (bounds.map(|b| Model::new(list(b), b)), places)
    }

    #[test]
    fn thirty_days_about_the_earth_and_past_the_moon_lie_within_a_decimetre_of_the_full_force() {
        let ([model, everything], places) = sol([Bound::COAST, Bound { position_m: 0.0, over_s: 1.0 }]);
        let epoch = SimTime::from_ticks(60 * 86_400 * 3);
        let end = epoch.plus(60 * 86_400 * 30);
        for (r, v) in [
            // Perigee 30,000 km, apogee 300,000 km; a low orbit; one that the Moon stirs.
            ([3.0e7, 0.0, 0.0], [0.0, 4.62e3, 1.4e3]),
            ([6.9e6, 0.0, 0.0], [0.0, 4.3e3, 6.3e3]),
            ([2.0e8, 1.5e8, 0.0], [-250.0, 900.0, 300.0]),
        ] {
            let start = State::<Centred> { position: Position::new(r.into()), velocity: Velocity::new(v.into()) };
            let knot = Knot::new(BodyId(2), epoch, &start);
            let fly = |model: &Model| {
                let mut path = Path::new(model, &places, knot);
                while path.advance(model, &places, end).is_some() {}
                let s = path.sample(end).position.0;
                if path.host() == BodyId(2) { s } else { s + places.relative_at(path.host(), BodyId(2), end.into()).position.0 }
            };
            let full = Full { model: &everything, places: &places, host: BodyId(2), epoch: epoch.into() };
            let mut points = Points { t: 0.0, q: vec![start.position.0], v: vec![start.velocity.0] };
            GaussRadau::new(1, GaussRadau::TOLERANCE).run(&full, &mut points, 30.0 * DAY);
            let (bounded, all) = (fly(&model), fly(&everything));
            let (ours, method) = ((bounded - points.q[0]).length(), (all - points.q[0]).length());
            assert!(ours < 0.1, "{r:?}: {ours} m from the full force, {method} m of it by the method");
            assert!(method < 0.02, "{r:?}: two methods differ by {method} m under one force");
        }
    }
}
