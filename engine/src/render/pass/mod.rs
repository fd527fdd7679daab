//! The passes: one file each, with a shader of the same name in `shaders/pass/`. Their order is in [`super::frame`].
//!
//! A pass has `new` (compiles), `skip` (why the scene does not need it, in words) and `record`.

pub mod air_bands;
pub mod air_orders;
pub mod air_tables;
pub mod baseline_bruneton;
pub mod baseline_hillaire;
pub mod baseline_hillaire_sky;
pub mod bloom;
pub mod eclipse_rings;
pub mod exposure;
pub mod refracted;
pub mod shadow;
pub mod ship_mesh;
pub mod ships;
pub mod sky;
pub mod sky_probe;
pub mod smooth_body;
pub mod stars;
pub mod sun_disc;
pub mod terrain;
pub mod tile_heights;
pub mod tonemap;

use super::RenderError;
use super::maps::MapStore;
use super::shared::{ShadowMap, Shared};
use crate::gpu::{Gpu, ShaderLibrary};
use crate::scene::Snapshot;
use crate::scene::gpu_data::Layers;

/// All passes, compiled.
pub struct Passes {
    /// Transmittance, further orders and irradiance of every air in view.
    pub air_tables: air_tables::AirBaker,
    /// What the shadow map is while no ship throws a shadow.
    pub no_shadow: ShadowMap,
    /// Light that air bends into shadows.
    pub refracted: refracted::Refracted,
    /// Eclipsed surroundings of places in air.
    pub eclipse_rings: eclipse_rings::EclipseRings,
    /// Spheres without terrain.
    pub smooth_body: smooth_body::SmoothBody,
    /// The ship's shadow.
    pub shadow: shadow::ShipShadow,
    /// Ground with relief.
    pub terrain: terrain::Terrain,
    /// Hulls and flames.
    pub ships: ships::Ships,
    /// Where this frame's ships are.
    pub ship_geometry: ships::ShipGeometry,
    /// Points of light.
    pub stars: stars::Stars,
    /// The star's disc.
    pub sun_disc: sun_disc::SunDisc,
    /// Glare.
    pub bloom: bloom::Bloom,
    /// Air laid over the picture.
    pub sky: sky::Sky,
    /// Histogram and adaptation.
    pub exposure: exposure::Exposure,
    /// HDR to the screen.
    pub tonemap: tonemap::Tonemap,
}

impl Passes {
    /// Compiles all.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary, shared: &Shared, maps: &MapStore) -> Result<Self, RenderError> {
        Ok(Self {
            air_tables: air_tables::AirBaker::new(gpu, shaders)?,
            no_shadow: ShadowMap::none(gpu),
            refracted: refracted::Refracted::new(gpu),
            eclipse_rings: eclipse_rings::EclipseRings::new(gpu, shaders, shared)?,
            smooth_body: smooth_body::SmoothBody::new(gpu, shaders, shared, maps)?,
            shadow: shadow::ShipShadow::new(gpu, shaders, shared)?,
            terrain: terrain::Terrain::new(gpu, shaders, shared, maps)?,
            ships: ships::Ships::new(gpu, shaders, shared)?,
            ship_geometry: ships::ShipGeometry::new(gpu),
            stars: stars::Stars::new(gpu, shaders, shared)?,
            sun_disc: sun_disc::SunDisc::new(gpu, shaders, shared)?,
            bloom: bloom::Bloom::new(gpu, shaders, shared)?,
            sky: sky::Sky::new(gpu, shaders, shared)?,
            exposure: exposure::Exposure::new(gpu, shaders, shared)?,
            tonemap: tonemap::Tonemap::new(gpu, shaders, shared)?,
        })
    }

    /// Where the tables of each body of the scene lie.
    pub fn layers(&mut self, scene: &Snapshot) -> Vec<Layers> {
        let mut all = self.refracted.assign(scene);
        all.iter_mut().zip(self.air_tables.assign(scene)).for_each(|(layers, air)| layers.air = air);
        self.eclipse_rings.assign(scene, &self.air_tables, &mut all);
        all
    }
}
