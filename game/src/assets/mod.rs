//! Assets: text files that people write, checked and turned into what the World and the renderer use.
//!
//! # Folders
//! ```text
//! assets/systems/<system>/system.toml    name, description, which bodies, masses that are no body
//! assets/bodies/<body>/body.toml         one folder a body; its name is the body's key
//! assets/bodies/<body>/atmosphere.toml   its air; a body without this file has none
//! assets/maps/…                          maps that bodies name (also looked for beside the body's file)
//! assets/ships/<ship>.toml               ships
//! assets/starts/<start>.toml             where and when a flight begins
//! ```
//! # Mods
//! A mod is a folder with the same layout, laid over the assets. The order, from the bottom: the assets; the folders in `mods/` of the data
//! folder, by name; the folders of `--mods DIR`, as named. What lies higher wins:
//! - *add*: a file that is not there yet. A new planet is a folder `bodies/vulcan/` with a `body.toml`, and a system that lists it;
//! - *replace*: a file at the same path;
//! - *modify*: `body.patch.toml`, `atmosphere.patch.toml` or `system.patch.toml` changes only the keys that it holds. Tables merge key by
//!   key (one whose `kind` changes is replaced), values and lists are replaced. A *table* laid over a *list* changes items of the list:
//!   `[layers.dust]` those keys of the layer named `dust`, `layers.remove = ["ozone"]` takes out, `[[layers.add]]` appends; likewise
//!   `bodies.add = ["vulcan"]` in a system. `remove = ["scale_m"]` in a table takes a key out.
//!
//! `syzygy check-assets DIR` tells everything that is wrong at once, in the words in which the game tells it. What can be used and is hardly
//! meant is a warning ([`atmosphere::plausible`]).
//!
//! A file that is saved while one flies is there within 0.3 s ([`reload`]); files named `atmosphere…` (painted maps as well) are read alone.
//! The editor in the game turns an air and writes its file ([`draft`]).
//!
//! # What a flight depends on
//! A replay refuses other assets than its own: it compares [`System::hash`], which is made of the *values* that the World reads. Comments,
//! the order of keys, names, colours, and all of an atmosphere but `[physics]` are no part of it.
//!
//! # `body.toml`
//! Every key ends in its unit. Angles in °, Julian dates in TDB, axes ICRF. There are no silent defaults: a key left out is
//! either marked *optional* or an error.
//!
//! | table | keys |
//! |---|---|
//! | (top) | `name`, `parent` (key of the body it orbits; only the star has none), `gm_km3_s2`, `radius_km` (datum sphere: sea level), `albedo = [r, g, b]` (linear sRGB, 0 … 1) |
//! | `[star]` | for the star only: `illuminance_at_1_au_lx` (Sun: 1.28e5), *optional* its spectrum: `temperature_k` (a black body's), or `wavelengths_nm` (rising) and `irradiance` (any scale); the Sun's where neither is given. *Optional* `colour = [r, g, b]` (linear sRGB, luminance 1), that of the spectrum against D65 where it is left out |
//! | `[rotation]` | *optional* `model`: `"earth"` (precession, nutation, observed UT1; takes no other key) or `"iau"` (the same as none). IAU form: `pole_ra_deg`, `pole_ra_deg_per_century`, `pole_dec_deg`, `pole_dec_deg_per_century`, `meridian_deg`, `meridian_deg_per_day`; *optional* `meridian_deg_per_century2` and lists of `[amplitude_deg, phase_deg, rate_deg_per_century]`: `pole_ra_terms` (sines), `pole_dec_terms` (cosines), `meridian_terms` (sines) |
//! | `[shape]` | *optional*, for eclipses; all keys *optional*: `equatorial_radius_km` (else `radius_km`), `flattening` (0 … 0.5), `limb_radius_km = [outer, inner]` (of the limb at outer and inner contacts), `shadow_enlargement` (1 … 1.1: by air and oblateness, for eclipses of its moons) |
//! | `[gravity]` | *optional*, what makes it more than a point: `reference_radius_km`, `j2`, `j3`, `j4` (unnormalised); *optional* `c22`, `tide_k2` and `tide_lag_s` (the bulge that others raise on it), `gm_with_moons_km3_s2` (with moons that have no folder) |
//! | `[orbit]` | `kind`, `epoch_jd_tdb`, and by kind: |
//! | … `"barycentric"` | state from the system's barycentre: `position_km`, `velocity_km_s`, `with_moons` (true: of the body with its moons) |
//! | … `"from_parent"` | the same from the parent's centre: `position_km`, `velocity_km_s` |
//! | … `"mean"` | precessing ellipse: `semi_major_axis_km`, `eccentricity`, `inclination_deg`, `node_deg`, `node_deg_per_year`, `argument_deg`, `argument_deg_per_year`, `mean_anomaly_deg`, `mean_longitude_deg_per_day`, and the pole of the plane that the angles refer to: `plane_pole_ra_deg`, `plane_pole_dec_deg` |
//! | `[relief]` | *optional* (giants and stars have none): `relief_max` (exaggeration from afar, 1 = never), `ground` (`"rock"`, `"regolith"`, `"living"`, `"ice"`), `water`; *optional* files `map`, `coast`, `colour`; *optional* tables `[relief.noise]`, `[relief.craters]`, `[relief.provinces]`: see [`engine::terrain::spec`] |
//!
//! An orbit tells where a body starts: from the star's epoch on all bodies move each other (see [`engine::orbit::ephemeris`]).
//!
//! # `atmosphere.toml`
//! What one sees is apart from what drags: a body may have either without the other.
//!
//! | table | keys |
//! |---|---|
//! | (top) | *optional* `model`: `"physical"` (the same as none), `"thickness"`, `"limb_table"`, `"view_table"`, `"gradient"`, `"none"` (nothing is seen); *optional* `spectrum`: `"rgb"` (the same as none) or `"spectral"`; *optional* `wavelengths_nm = [red, green, blue]`, where numbers in threes hold; `top_altitude_m`; `ground_albedo` and `layers` (*optional* but for `physical` and `view_table`) |
//! | `[[layers]]` | any number; *optional* `name` (for patches), `profile`, `phase`, and *one* of: `scattering_per_m` with `absorption_per_m` (at density 1), `gas`, `aerosol`, `absorber`, `table`: see [`engine::air::optics`] |
//! | … `profile` | `{ kind = "exponential", scale_height_m }`, `{ kind = "tent", bottom_m, peak_m, top_m }`, `{ kind = "constant", bottom_m, top_m }`, `{ kind = "table", altitude_m = [..], density = [..] }`; a `gas` needs none |
//! | … `phase` | `{ kind = "rayleigh" }`, `"henyey_greenstein"` and `"cornette_shanks"` with `g`, `"elek_rayleigh"`, `"isotropic"`, `{ kind = "table", angle_deg = [..], value = [..] }`; a `gas` or an `absorber` needs none |
//! | `[thickness]`, `[limb_table]`, `[view_table]`, `[gradient]` | *optional*, the settings of that model; every key may be left out: see [`engine::air::model`] |
//! | `[[fog]]` | *optional*, banks of fog and nebulae, whatever the `model`: `latitude_deg`, `longitude_deg`, `altitude_m` of the centre, `radius_m`; *optional* `name`, `thickness = { … }` with the keys of `[thickness]` |
//! | `[physics]` | *optional*, what drags: `kind = "us76"` (Earth) or `"hydrostatic"`; `drag_top_m`; hydrostatic also `temperature_k`, `pressure_pa`, `molar_mass_kg_mol`, `heat_capacity_ratio`, *optional* `lapse = [{ to_altitude_m, k_per_m }]`. Gravity is the body's own |
//!
//! # `system.toml`
//! `name`, `bodies` (keys of folders in `bodies/`, in any order), *optional* `description`, and *optional* `[[masses]]`: what attracts and is no body one can go to (asteroids), each with
//! `name`, `gm_km3_s2`, `position_km`, `velocity_km_s` from the barycentre at the epoch of the star.
//!
//! # Here
//! [`system`], [`ship`] and [`start`] load; [`reader`] takes keys out of a [`tree`] and gathers [`fault`]s; [`fields`] are keys as data, of which
//! reader, [`schema`] and editor are made; [`overlay`] finds and reads files, [`write`](mod@write) changes them; [`reload`] watches them. Not
//! here: what a World does with it all.

pub mod atmosphere;
pub mod body;
pub mod draft;
pub mod fault;
pub mod fields;
pub mod listing;
pub mod overlay;
pub mod planet;
pub mod reader;
pub mod relief;
pub mod reload;
pub mod schema;
pub mod ship;
pub mod start;
pub mod system;
pub mod tree;
pub mod write;

pub use fault::{AssetErrors, Fault};
pub use reload::Reloader;

use crate::world::World;
use crate::world::ship::spec::ShipSpec;
use crate::world::start::StartSpec;
use crate::world::system::System;
use atmosphere::AirSpec;
use engine::light::spectrum::Starlight;
use overlay::Overlay;
use std::path::PathBuf;
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
        Self { overlay: Overlay::new(&dir, &mods) }
    }

    /// A system; `progress` hears how much is done, 0 … 1, and of what.
    pub fn system(&self, key: &str, progress: &(dyn Fn(f32, &str) + Sync)) -> Result<Arc<System>, AssetErrors> {
        system::load_system(&self.overlay, key, progress)
    }

    /// The air of a body under a star, without the system around it; the default where it has none.
    pub fn air(&self, body: &str, star: &Starlight) -> Result<AirSpec, AssetErrors> {
        system::load_air(&self.overlay, body, star)
    }

    /// A system with its airs read anew, everything else as it is.
    pub fn airs(&self, system: &System) -> Result<Arc<System>, AssetErrors> {
        system::reread_airs(&self.overlay, system)
    }

    /// A ship.
    pub fn ship(&self, key: &str) -> Result<Arc<ShipSpec>, AssetErrors> {
        ship::load_ship(&self.overlay, key)
    }

    /// A start.
    pub fn start(&self, key: &str) -> Result<StartSpec, AssetErrors> {
        start::load_start(&self.overlay, key)
    }

    /// A World from a start.
    pub fn begin(&self, key: &str, progress: &(dyn Fn(f32, &str) + Sync)) -> Result<World, AssetErrors> {
        let start = self.start(key)?;
        let mut errors = AssetErrors::default();
        let ship = errors.keep(self.named_by(key, "ship", &start.ship, &self.ships(), self.ship(&start.ship)));
        let system = errors.keep(self.named_by(key, "system", &start.system, &self.systems(), self.system(&start.system, progress)));
        let (Some(ship), Some(system)) = (ship, system) else { return Err(errors) };
        self.world(key, &start, system, ship)
    }

    /// What came of a name in a start; where there is nothing of that name, it is told at the start's line.
    fn named_by<T>(&self, start: &str, field: &str, name: &str, known: &[String], found: Result<T, AssetErrors>) -> Result<T, AssetErrors> {
        if known.iter().any(|k| k == name) {
            return found;
        }
        found.map_err(|errors| {
            let Ok(tree) = start::start_tree(&self.overlay, start) else { return errors };
            let at = tree.place_of(field);
            let told = |fault: Fault| Fault { at: Some(at.clone()), path: at.source.path.clone(), ..fault };
            AssetErrors { faults: errors.faults.into_iter().map(told).collect() }
        })
    }

    /// A World from a start's words, when the system and the ship that they name are there already.
    pub fn world(&self, key: &str, start: &StartSpec, system: Arc<System>, ship: Arc<ShipSpec>) -> Result<World, AssetErrors> {
        World::from_start(system, ship, start).map_err(|e| {
            let message = e.to_string();
            let place = message.split([' ', ':']).next().unwrap_or_default().to_owned();
            match start::start_tree(&self.overlay, key) {
                Ok(tree) => AssetErrors::one(Fault::at(&tree.place_of(&place), message)),
                Err(errors) => errors,
            }
        })
    }

    /// The starts there are, in the order of their names, readable or not.
    pub fn starts(&self) -> Vec<(String, Result<StartSpec, AssetErrors>)> {
        self.overlay.names("starts", Some(".toml")).into_iter().map(|key| (key.clone(), self.start(&key))).collect()
    }

    /// The systems there are.
    pub fn systems(&self) -> Vec<String> {
        let exists = |name: &String| self.overlay.find(format!("systems/{name}/system.toml")).is_some();
        self.overlay.names("systems", None).into_iter().filter(exists).collect()
    }

    /// The bodies there are.
    pub fn bodies(&self) -> Vec<String> {
        listing::bodies(&self.overlay)
    }

    /// One body checked: its own files, and the systems that list it. Those, and what is hardly meant.
    pub fn check_body(&self, key: &str) -> Result<(Vec<String>, Vec<String>), AssetErrors> {
        let systems: Vec<String> = self.systems().into_iter().filter(|s| listing::lists(&self.overlay, s, key)).collect();
        let (mut errors, mut warnings) = (AssetErrors::default(), Vec::new());
        if systems.is_empty() {
            warnings.extend(errors.keep(system::load_body(&self.overlay, key)).into_iter().flatten());
        }
        for system in &systems {
            warnings.extend(errors.keep(self.system(system, &|_, _| ())).into_iter().flat_map(|s| s.warnings.clone()));
        }
        once(&mut warnings);
        once(&mut errors.faults);
        errors.or((systems, warnings))
    }

    /// The ships there are.
    pub fn ships(&self) -> Vec<String> {
        self.overlay.names("ships", Some(".toml")).into_iter().collect()
    }

    /// Everything, checked: what `check-assets` does. What is hardly meant comes back.
    pub fn check(&self) -> Result<Vec<String>, AssetErrors> {
        let (mut errors, mut warnings) = (AssetErrors::default(), Vec::new());
        let mut systems = std::collections::BTreeMap::new();
        for key in self.systems() {
            let system = errors.keep(self.system(&key, &|_, _| ()));
            warnings.extend(system.iter().flat_map(|s| s.warnings.iter().cloned()));
            systems.insert(key, system);
        }
        for body in self.bodies() {
            if !systems.keys().any(|s| listing::lists(&self.overlay, s, &body)) {
                warnings.extend(errors.keep(system::load_body(&self.overlay, &body)).into_iter().flatten());
            }
        }
        for key in self.ships() {
            errors.keep(self.ship(&key));
        }
        for (key, start) in self.starts() {
            let Some(start) = errors.keep(start) else { continue };
            let system = match systems.get(&start.system) {
                Some(system) => system.clone(),
                // Names a system that there is none of: the fault is told by the attempt.
                None => errors.keep(self.named_by(&key, "system", &start.system, &self.systems(), self.system(&start.system, &|_, _| ()))),
            };
            let ship = self.named_by(&key, "ship", &start.ship, &self.ships(), self.ship(&start.ship));
            // Faults of a ship that is there were told above.
            let ship = if self.ships().contains(&start.ship) { ship.ok() } else { errors.keep(ship) };
            if let (Some(system), Some(ship)) = (system, ship) {
                errors.keep(self.world(&key, &start, system, ship));
            }
        }
        once(&mut warnings);
        once(&mut errors.faults);
        errors.or(warnings)
    }
}

/// What several systems have in common is told once.
fn once<T: PartialEq>(told: &mut Vec<T>) {
    let mut i = 0;
    while i < told.len() {
        let (before, rest) = told.split_at(i);
        if rest.first().is_some_and(|this| before.contains(this)) { drop(told.remove(i)) } else { i += 1 }
    }
}

#[cfg(test)]
pub(crate) mod tests;
