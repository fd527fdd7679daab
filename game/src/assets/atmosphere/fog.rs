//! Banks of fog and nebulae, `[[fog]]`: balls of air by the model `thickness`, placed in the body's turning frame.
//!
//! Not here: how they are lit and drawn (`engine::air::model::thickness`), nor the body's own air ([`super`]).

use super::layers::check_names;
use super::{Datum, tell};
use crate::assets::fault::Fault;
use crate::assets::reader::{ANY, Reader};
use crate::assets::tree::Node;
use crate::world::system::Fog;
use engine::air::model::Thickness;
use engine::scene::gpu_data::MAX_BODIES;
use engine::space::sphere::direction_of_lat_lon;
use engine::units::DEG;

/// Banks of one body that a picture holds, with the body itself and a moon.
pub const MOST: usize = MAX_BODIES - 2;

/// Reads the list; what is out of range is written down.
pub fn read(r: &Reader<'_>, datum: Datum) -> Vec<Fog> {
    let tables = r.tables("fog");
    check_names(&tables);
    if let Some(first) = tables.get(MOST) {
        let message =
            format!("{} banks of fog: a picture holds {MAX_BODIES} worlds and banks, so that the farthest will be left out", tables.len());
        let help = format!("{MOST} at most; one large bank costs less than several small ones");
        r.fault(Fault::warning(&first.node.at, message).help(Some(help)));
    }
    tables.iter().filter_map(|t| bank(t, datum)).collect()
}

fn bank(t: &Reader<'_>, datum: Datum) -> Option<Fog> {
    let deg = |key| t.number(key, ANY) * DEG;
    let direction = direction_of_lat_lon(deg("latitude_deg"), deg("longitude_deg"));
    let centre_m = direction * (datum.radius_m + t.number("altitude_m", ANY));
    let settings = t.node.get("thickness").map_or_else(|| serde_json::json!({}), |e| Node::json(&e.value));
    match serde_json::from_value::<Thickness>(settings) {
        Ok(look) => {
            let errors = look.validate();
            let look = tell(t, "thickness.", if errors.is_empty() { Ok(look) } else { Err(errors) })?;
            Some(Fog { centre_m, air: look.ball(t.number("radius_m", ANY)) })
        }
        Err(e) => {
            t.wrong("thickness", format!("`thickness`: {e}: expected the settings of the model \"thickness\""));
            None
        }
    }
}
