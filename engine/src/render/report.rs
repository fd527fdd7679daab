//! The report: which passes ran, which were skipped, and why. Written by [`super::frame`], printed by `syzygy shot --passes`.

use serde::{Deserialize, Serialize};

/// What [`AirReport::tables`] says of tables that were made for this frame.
pub const TABLES_MADE: &str = "made: new or changed";

/// What became of one pass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PassReport {
    /// Its name: that of its file in `render/pass/`.
    pub name: String,
    /// Whether it ran.
    pub ran: bool,
    /// Why it ran or was skipped, in words.
    pub reason: String,
    /// Time on the GPU, ms, where it was measured.
    pub gpu_ms: Option<f64>,
}

/// What became of one body's air.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AirReport {
    /// Id of the body.
    pub body: u16,
    /// Name of its model.
    pub model: String,
    /// Whether it was drawn.
    pub ran: bool,
    /// Why it was drawn as it was, or skipped, in words.
    pub reason: String,
    /// Share of the picture that it was drawn over, 0 … 1.
    pub covers: f32,
    /// What became of its tables, in words.
    #[serde(default)]
    pub tables: String,
}

/// What became of a frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrameReport {
    /// The passes in the order of the frame.
    pub passes: Vec<PassReport>,
    /// Every air of the scene, far to near.
    #[serde(default)]
    pub airs: Vec<AirReport>,
}

impl FrameReport {
    /// The entry of a pass.
    pub fn pass(&self, name: &str) -> Option<&PassReport> {
        self.passes.iter().find(|p| p.name == name)
    }

    /// What ran in an earlier round of the same frame (to meter it), and so was not needed again, ran.
    pub(super) fn add_earlier_round(&mut self, earlier: &Self) {
        for pass in self.passes.iter_mut().filter(|p| !p.ran) {
            if let Some(first) = earlier.pass(&pass.name).filter(|p| p.ran) {
                pass.ran = true;
                pass.reason.clone_from(&first.reason);
            }
        }
        for air in &mut self.airs {
            if let Some(first) = earlier.airs.iter().find(|a| a.body == air.body && a.tables == TABLES_MADE) {
                air.tables.clone_from(&first.tables);
            }
        }
    }
}
