//! What paths ask of an ephemeris, answered by the house's own.

use super::model::Places;
use crate::orbit::ephemeris::Ephemeris;
use crate::orbit::{BodyId, State};
use crate::space::Icrf;
use crate::time::Moment;
use glam::DVec3;

impl Places for Ephemeris {
    fn relative_at(&self, body: BodyId, center: BodyId, at: Moment) -> State<Icrf> {
        Self::relative_at(self, body, center, at)
    }

    fn series(&self, body: BodyId, center: BodyId, at: Moment, out: &mut [DVec3]) -> f64 {
        Self::series(self, body, center, at, out)
    }
}
