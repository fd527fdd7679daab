//! Assets: text files become validated values, or a list of everything that is wrong with them.
//!
//! - [`document`]: one TOML file, the overlay of mods, a place for every key
//! - [`fault`]: what is wrong, where, what was expected, what to do
//! - [`schema`]: the words of `system.toml` and `body.toml` · [`system`]: what they come to
//! - [`reload`]: files that change while one flies
//!
//! Ships (`ships/*.toml`) and starts (`starts/*.toml`) speak the words of [`crate::world::ship::spec`] and
//! [`crate::world::start`].

pub mod document;
pub mod fault;
pub mod reload;
pub mod schema;
pub mod system;

pub use fault::{AssetErrors, Fault};

use crate::world::World;
use crate::world::ship::spec::ShipSpec;
use crate::world::start::StartSpec;
use crate::world::system::System;
use document::{Document, Overlay};
use fault::did_you_mean;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The assets folder with mods over it.
#[derive(Clone, Debug)]
pub struct Assets {
    /// Where files are found.
    pub overlay: Overlay,
}

impl Assets {
    /// Assets in `dir`, with `mods` over them, the last on top.
    pub fn new(dir: PathBuf, mods: Vec<PathBuf>) -> Self {
        Self { overlay: Overlay { roots: std::iter::once(dir).chain(mods).collect() } }
    }

    /// A system; `progress` hears how much is done, 0 … 1, and of what.
    pub fn system(&self, key: &str, progress: &(dyn Fn(f32, &str) + Sync)) -> Result<Arc<System>, AssetErrors> {
        system::load(&self.overlay, key, progress)
    }

    /// A ship.
    pub fn ship(&self, key: &str) -> Result<Arc<ShipSpec>, AssetErrors> {
        let document = self.named("ships", key)?;
        let spec: ShipSpec = document.parse()?;
        let mut errors = AssetErrors::default();
        for (key, what) in spec.faults() {
            errors.push(document.fault_at(key, format!("{key}: {what}")));
        }
        errors.or(Arc::new(spec))
    }

    /// A start.
    pub fn start(&self, key: &str) -> Result<StartSpec, AssetErrors> {
        self.named("starts", key)?.parse()
    }

    /// A World from a start.
    pub fn begin(&self, key: &str, progress: &(dyn Fn(f32, &str) + Sync)) -> Result<World, AssetErrors> {
        let start = self.start(key)?;
        let mut errors = AssetErrors::default();
        let ship = errors.keep(self.ship(&start.ship));
        let system = errors.keep(self.system(&start.system, progress));
        let (Some(ship), Some(system)) = (ship, system) else { return Err(errors) };
        self.world(key, &start, system, ship)
    }

    /// A World from a start that was read.
    pub fn world(&self, key: &str, start: &StartSpec, system: Arc<System>, ship: Arc<ShipSpec>) -> Result<World, AssetErrors> {
        let document = self.named("starts", key)?;
        World::from_start(system, ship, start).map_err(|e| {
            let message = e.to_string();
            let place = message.split([' ', ':']).next().unwrap_or_default().to_owned();
            AssetErrors::one(document.fault_at(&place, message))
        })
    }

    /// The starts there are, in the order of their names, readable or not.
    pub fn starts(&self) -> Vec<(String, Result<StartSpec, AssetErrors>)> {
        self.names("starts").into_iter().map(|key| (key.clone(), self.start(&key))).collect()
    }

    /// The systems there are.
    pub fn systems(&self) -> Vec<String> {
        let exists = |name: &String| self.overlay.find(&Path::new("systems").join(name).join("system.toml")).is_some();
        self.overlay.entries(Path::new("systems")).into_iter().filter(exists).collect()
    }

    /// The ships there are.
    pub fn ships(&self) -> Vec<String> {
        self.names("ships")
    }

    /// Everything, checked: what `check-assets` does.
    pub fn check(&self) -> Result<(), AssetErrors> {
        let mut errors = AssetErrors::default();
        for key in self.systems() {
            errors.keep(self.system(&key, &|_, _| ()));
        }
        for key in self.ships() {
            errors.keep(self.ship(&key));
        }
        if errors.faults.is_empty() {
            for key in self.names("starts") {
                errors.keep(self.begin(&key, &|_, _| ()));
            }
        }
        errors.or(())
    }

    fn names(&self, folder: &str) -> Vec<String> {
        let entries = self.overlay.entries(Path::new(folder)).into_iter();
        entries.filter_map(|n| n.strip_suffix(".toml").filter(|n| !n.ends_with(".patch")).map(str::to_owned)).collect()
    }

    fn named(&self, folder: &str, key: &str) -> Result<Document, AssetErrors> {
        let file = Path::new(folder).join(format!("{key}.toml"));
        if self.overlay.find(&file).is_none() {
            let known = self.names(folder);
            let path = self.overlay.roots.first().map_or_else(|| file.clone(), |root| root.join(&file));
            let fault = Fault::of_file(&path, format!("there is no `{key}` in {folder}"));
            let near = did_you_mean(key, known.iter().map(String::as_str)).map(|n| format!("did you mean `{n}`? "));
            return Err(AssetErrors::one(fault.help(format!("{}there are {}", near.unwrap_or_default(), known.join(", ")))));
        }
        Document::open(&self.overlay, &file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use engine::orbit::BodyId;
    use engine::space::Icrf;
    use engine::time::SimTime;

    fn shipped() -> Assets {
        Assets::new(Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets"), Vec::new())
    }

    #[test]
    fn everything_shipped_is_sound() {
        if let Err(errors) = shipped().check() {
            panic!("{}", errors.lines());
        }
    }

    #[test]
    fn the_moon_stands_before_the_sun_at_greatest_eclipse() {
        let system = shipped().system("sol", &|_, _| ()).unwrap();
        let t = SimTime::from_jd_tdb(2_461_265.241_041_667);
        let at = |key: &str| -> engine::space::Position<Icrf> { system.ephemeris.state(system.find(key).unwrap(), t).position };
        let (to_sun, to_moon) = ((at("sun") - at("earth")).0, (at("moon") - at("earth")).0);
        let angle = libm::acos(to_sun.normalize().dot(to_moon.normalize()));
        // gamma 0.8977 Earth radii at the Moon's distance: 0.86 degrees.
        assert!((angle.to_degrees() - 0.86).abs() < 0.1, "{}", angle.to_degrees());
        assert!(system.body(BodyId(0)).soi_radius_m.is_infinite());
        let moon = system.body(system.find("moon").unwrap());
        assert!((6.0e7..7.0e7).contains(&moon.soi_radius_m), "{}", moon.soi_radius_m);
    }
}
