//! Where a mode's folders are named: behind its command, or before it.

use super::{Bench, Mode, Places, PlayArgs, Probe};

impl Mode {
    /// The folders that the mode works in.
    pub const fn places_mut(&mut self) -> &mut Places {
        match self {
            Self::Play(a) => &mut a.places,
            Self::Headless(a) => &mut a.places,
            Self::Replay(a) => &mut a.places,
            Self::Shot(a) => &mut a.places,
            Self::CheckAssets(a) => &mut a.places,
            Self::Probe(Probe::Air(a)) => &mut a.common.places,
            Self::Probe(Probe::Height(a)) => &mut a.common.places,
            Self::Probe(Probe::Kepler(a)) => &mut a.places,
            Self::Probe(Probe::Ephemeris(a)) => &mut a.common.places,
            Self::Probe(Probe::Eclipses(a)) => &mut a.common.places,
            Self::Probe(Probe::Propagate(a)) => &mut a.common.places,
            Self::Probe(Probe::Sky(a)) => &mut a.places,
            Self::Bench(Bench::Orbit(a)) => &mut a.places,
            Self::Bench(Bench::Ships(a)) => &mut a.places,
            Self::Bench(Bench::Kepler(a)) => &mut a.places,
            Self::Bench(Bench::Ephemeris(a)) => &mut a.places,
            Self::Bench(Bench::Air(a)) => &mut a.places,
        }
    }
}

impl Places {
    /// Takes in what was written before these: mods from there lie below, and of two folders the one written here counts.
    pub(super) fn lead(&mut self, before: Self) {
        self.assets = self.assets.take().or(before.assets);
        self.data_dir = self.data_dir.take().or(before.data_dir);
        self.mods.splice(0..0, before.mods);
        self.safe_mode |= before.safe_mode;
        self.verbose = self.verbose.saturating_add(before.verbose);
    }
}

impl PlayArgs {
    /// An option of `play` that is given and names no folder.
    pub(super) fn beside_places(&self) -> Option<&'static str> {
        let given = [
            (self.start.is_some(), "--start"),
            (self.backend.is_some(), "--backend"),
            (self.size.is_some(), "--size"),
            (self.edit_assets, "--edit-assets"),
        ];
        given.into_iter().find(|(is, _)| *is).map(|(_, option)| option)
    }
}
