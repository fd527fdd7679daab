//! Swarm: many test particles at once (ships, debris), on all cores.
//!
//! Each goes its own way from its own knot, so the bits do not depend on how many threads share the work.

use super::{End, Knot, Model, Path, Places};
use crate::time::SimTime;
use rayon::prelude::*;

/// Where particles are at `until`: for each the knot there (exactly at that tick), or where its path came to the least height
/// before, with the reason. At most `most_steps` steps each; who needs more stops where it is.
pub fn propagate(model: &Model, places: &dyn Places, particles: &[Knot], until: SimTime, most_steps: usize) -> Vec<(Knot, End)> {
    let one = |knot: &Knot| {
        let mut path = Path::new(model, places, *knot);
        for _ in 0..most_steps {
            if path.step().covers(until) {
                return (path.step().knot_at(until.into()), End::Natural);
            }
            if path.next(model, places).is_some_and(|e| e.end == End::Low) {
                return (path.step().knot_at(path.step().until), End::Low);
            }
        }
        (*path.knot(), path.step().end)
    };
    particles.par_iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::ephemeris::Ephemeris;
    use crate::orbit::field::{Bound, Source};
    use crate::orbit::path::Body;
    use crate::orbit::{BodyId, State, kepler};
    use crate::space::{Centred, Position, Velocity};

    #[test]
    fn bits_do_not_depend_on_the_number_of_threads() {
        let gm = 3.986e14;
        let source = Source { gm_m3_s2: gm, zonal: [1.08e-3, 0.0, 0.0], reference_radius_m: 6.378e6, ..Source::default() };
        let body = Body { source, soi_m: f64::INFINITY, low_m: 6.4e6, ..Body::default() };
        let (model, places) = (Model::new(vec![body], Bound::COAST), Ephemeris::default());
        let start = SimTime::from_ticks(77);
        let state = |i: u32| State::<Centred> {
            position: Position::xyz(6.8e6 + 1e3 * f64::from(i), 0.0, 0.0),
            velocity: Velocity::xyz(10.0 * f64::from(i % 7), 7.6e3, 50.0),
        };
        let debris: Vec<Knot> = (0..60).map(|i| Knot::new(BodyId(0), start, &state(i))).collect();
        let until = start.plus(60 * 40_000);
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| propagate(&model, &places, &debris, until, 10_000))
        };
        let one = run(1);
        assert_eq!(one, run(3));
        assert!(one.iter().all(|(knot, end)| *end == End::Low || knot.at == until.into()));
        // J₂ alone has moved them: hundreds of kilometres from Kepler's.
        let free = kepler::propagate(gm, &state(30), until.since(start)).position.0;
        assert!((one[30].0.position.value() - free).length() > 1e5);
    }
}
