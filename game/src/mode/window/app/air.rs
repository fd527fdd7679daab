//! The editor of airs in the window: which body, the air that is drawn of a draft, and the file. Not here: the panel ([`crate::hud::air`]).

use super::App;
use crate::assets::atmosphere::Datum;
use crate::assets::draft::{Draft, Place, Target};
use crate::hud::Screen;
use engine::air::Model;
use engine::air::model::{Gradient, LimbTable, Physical, Thickness, ViewTable};
use serde_json::{Value, json};
use std::sync::Arc;

impl App {
    /// Opens the editor on the air of the body that the ship is at. A draft of it that was left is gone on with.
    pub(super) fn edit_air(&mut self) {
        let Some(flight) = &self.flight else { return };
        let system = &flight.session.world.system;
        let body = system.body(flight.readout.body);
        if self.hud.air.draft.as_ref().is_some_and(|d| d.body == body.key && !d.is_saved()) {
            self.hud.screen = Screen::Air;
            return;
        }
        match Draft::open(&self.opening.assets.overlay, &body.key, self.target()) {
            Ok(draft) => {
                let readout = &flight.readout;
                let place = Place {
                    lat_lon_rad: readout.lat_lon_rad,
                    heading_rad: readout.heading_pitch_roll_rad[0],
                    altitude_m: readout.altitude_m,
                    ground_m: readout.ground_m,
                    radius_m: body.radius_m,
                };
                self.hud.air.enter(draft, place, defaults());
                self.hud.screen = Screen::Air;
            }
            Err(errors) => self.hud.message = Some(errors.lines()),
        }
    }

    /// Where a draft is written.
    const fn target(&self) -> Target {
        if self.opening.args.edit_assets { Target::Assets } else { Target::Mod }
    }

    /// Takes files that changed into the draft, too.
    pub(super) fn follow_air(&mut self) {
        let target = self.target();
        if let Some(draft) = &mut self.hud.air.draft {
            draft.follow(&self.opening.assets.overlay, target);
        }
        self.hud.air.changed = true;
    }

    /// Builds what is drawn of a draft that changed; one that cannot be built leaves the last one in the picture.
    pub(super) fn hear_air(&mut self) {
        let editor = &mut self.hud.air;
        if self.hud.screen != Screen::Air || !std::mem::take(&mut editor.changed) {
            return;
        }
        let (Some(flight), Some(draft)) = (&self.flight, &editor.draft) else { return };
        let system = &flight.session.world.system;
        let Some(id) = system.find(&draft.body) else { return };
        let body = system.body(id);
        match draft.build(&self.opening.assets.overlay, Datum::new(body.gm_m3_s2, body.radius_m), &system.starlight) {
            Ok((air, warnings)) => {
                (editor.wrong, editor.warnings) = (None, warnings);
                self.trial = Some(Arc::new(system.with_look(id, air.look, air.fog)));
            }
            Err(wrong) => editor.wrong = Some(wrong),
        }
    }

    /// Writes the draft; the hot reload takes the file over. A mod whose folder is new is watched from now on.
    pub(super) fn save_air(&mut self) {
        let Some(draft) = &mut self.hud.air.draft else { return };
        let root = draft.path.ancestors().nth(3).map(std::path::Path::to_owned);
        let watched = root.as_ref().is_some_and(|r| r.is_dir());
        match draft.save() {
            Ok(()) => {
                let text = format!("Saved: {}", draft.path.display());
                self.hud.notice(text);
                if !watched {
                    self.watch_anew();
                }
            }
            Err(e) => self.hud.message = Some(e),
        }
    }
}

/// The settings of every model where a file leaves them out, by the model's name.
fn defaults() -> Value {
    let of = |model: &Model| serde_json::to_value(model).unwrap_or(Value::Null);
    json!({
        "physical": of(&Model::Physical(Physical::default())),
        "thickness": of(&Model::Thickness(Thickness::default())),
        "limb_table": of(&Model::LimbTable(LimbTable::default())),
        "view_table": of(&Model::ViewTable(ViewTable::default())),
        "gradient": of(&Model::Gradient(Gradient::default())),
    })
}
