//! Refracted light: for every planet with air whose shadow falls on something drawn, the table of the light that its air bends into it.
//!
//! The rows that receivers need are made on the CPU ([`crate::air::refraction::shade`]), when they are first needed or the air has changed; a
//! layer of the texture belongs to a planet. Asked by `shaders/lib/refracted.wgsl`. Not here: the shadow itself in air
//! (`shaders/lib/air_shadow.wgsl`), which stays without colour.

use crate::air::Air;
use crate::air::refraction::Limb;
use crate::air::refraction::shade::{COLUMNS, ROWS, Row, Shade};
use crate::gpu::Gpu;
use crate::gpu::texture::Texture;
use crate::render::pass::smooth_body::{POINT_BELOW_PX, radius_px};
use crate::render::shared::FrameContext;
use crate::scene::gpu_data::{Layers, MAX_BODIES, MAX_OCCLUDERS};
use crate::scene::{Body, Snapshot, Surface};
use crate::space::relative::narrow;
use std::ops::RangeInclusive;
use wgpu::TextureUsages;

/// Planets whose shadows are kept.
const KEPT: usize = 6;

/// The shadow of one planet.
struct Layer {
    id: u16,
    air: Air,
    shade: Option<Shade>,
    rows: Vec<Option<Row>>,
    /// Rows to be made.
    wanted: Vec<usize>,
    used: u64,
}

/// The pass.
pub struct Refracted {
    texture: Texture,
    layers: Vec<Layer>,
    clock: u64,
    /// Whether any shadow reaches anything.
    falls: bool,
}

impl Refracted {
    /// Makes room.
    #[allow(clippy::cast_possible_truncation)]
    pub fn new(gpu: &Gpu) -> Self {
        let size = [COLUMNS as u32 + 1, ROWS as u32, KEPT as u32];
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
        let texture = Texture::with(&gpu.device, "refracted light", size, 1, wgpu::TextureFormat::Rgba32Float, usage);
        Self { texture, layers: Vec::new(), clock: 0, falls: false }
    }

    /// Notes whose shadow falls on what, and gives each body its layers; rows that are missing wait for [`Refracted::record`].
    pub fn assign(&mut self, scene: &Snapshot) -> Vec<Layers> {
        self.clock += 1;
        self.falls = false;
        let mut all = vec![Layers::default(); scene.bodies.len()];
        for (i, (layers, body)) in all.iter_mut().zip(&scene.bodies).take(MAX_BODIES).enumerate() {
            for (slot, occluder) in layers.casters.iter_mut().zip(body.occluders.iter().take(MAX_OCCLUDERS)).filter(|_| drawn(scene, body))
            {
                let Some(caster) = scene.bodies.iter().find(|b| b.id == occluder.id) else { continue };
                let away = (occluder.centre_m - body.centre_m).length();
                *slot = self.layer_of(scene, caster, f64::from(away - body.radius_m)..=f64::from(away + body.radius_m));
            }
            // A ship above the air of its own planet, behind it.
            for ship in scene.ships.iter().filter(|s| s.host == Some(i)) {
                let out = ship.centre_m - body.centre_m;
                let top = body.air.as_ref().map_or(f32::INFINITY, |a| narrow(a.medium.top_altitude_m));
                if out.dot(body.sun_direction) < 0.0 && out.length() > body.radius_m + top {
                    layers.own = self.layer_of(scene, body, f64::from(out.length())..=f64::from(out.length()));
                }
            }
        }
        all
    }

    /// The layer of a planet's shadow at these distances, m; `None` where it has no air that lets light through.
    #[allow(clippy::cast_possible_truncation)]
    fn layer_of(&mut self, scene: &Snapshot, caster: &Body, distances_m: RangeInclusive<f64>) -> Option<u32> {
        let air = caster.air.as_ref()?;
        let star_m = f64::from((scene.star.centre_m - caster.centre_m).length());
        let star_radius_m = f64::from(scene.star.radius_m);
        let found = self.layers.iter().position(|l| l.id == caster.id);
        let fits = |l: &Layer| l.air == *air && l.shade.as_ref().is_none_or(|s| s.fits(star_radius_m, star_m));
        let at = match found.filter(|i| self.layers.get(*i).is_some_and(fits)) {
            Some(at) => at,
            None => {
                let at = found.or_else(|| self.free())?;
                let shade = Limb::new(air).map(|limb| Shade::new(limb, star_radius_m, star_m));
                let new = Layer { id: caster.id, air: air.clone(), shade, rows: vec![None; ROWS], wanted: Vec::new(), used: self.clock };
                if let Some(old) = self.layers.get_mut(at) {
                    *old = new;
                } else {
                    self.layers.push(new);
                }
                at
            }
        };
        let layer = self.layers.get_mut(at)?;
        layer.used = self.clock;
        let shade = layer.shade.as_ref()?;
        let rows = shade.rows(*distances_m.start(), *distances_m.end());
        layer.wanted.extend(rows.chain([0]).filter(|row| layer.rows.get(*row).is_some_and(Option::is_none)));
        self.falls = true;
        Some(at as u32)
    }

    /// A place for one planet more; `None` where all are in use.
    fn free(&self) -> Option<usize> {
        if self.layers.len() < KEPT {
            return Some(self.layers.len());
        }
        let (at, oldest) = self.layers.iter().enumerate().min_by_key(|(_, l)| l.used)?;
        (oldest.used < self.clock).then_some(at)
    }

    /// Why the scene does not need it.
    pub fn skip(&self) -> Option<String> {
        if !self.falls {
            return Some("no shadow of a world with air falls on what is drawn".to_owned());
        }
        self.layers
            .iter()
            .all(|l| l.wanted.is_empty())
            .then(|| "the shadows in view are as they were when their tables were made".to_owned())
    }

    /// Makes the rows that wait, and gives the table.
    #[allow(clippy::cast_possible_truncation)]
    pub fn record(&mut self, f: &FrameContext<'_>) -> wgpu::TextureView {
        for (at, layer) in self.layers.iter_mut().enumerate().filter(|(_, l)| !l.wanted.is_empty()) {
            let Some(shade) = &layer.shade else { continue };
            for row in core::mem::take(&mut layer.wanted) {
                if let Some(slot) = layer.rows.get_mut(row) {
                    slot.get_or_insert_with(|| shade.row(row));
                }
            }
            let empty = [[0.0_f32; 4]; COLUMNS + 1];
            let texels: Vec<[f32; 4]> = layer.rows.iter().flat_map(|row| row.unwrap_or(empty)).collect();
            self.texture.write(&f.gpu.queue, 0, at as u32, bytemuck::cast_slice(&texels));
        }
        self.table()
    }

    /// The table, a layer per planet.
    pub fn table(&self) -> wgpu::TextureView {
        self.texture.array_view()
    }
}

/// Whether a body's surface is in the picture as more than a point.
fn drawn(scene: &Snapshot, body: &Body) -> bool {
    let hosts_ship = || scene.ships.iter().any(|s| s.host.and_then(|h| scene.bodies.get(h)).is_some_and(|h| h.id == body.id));
    match body.surface {
        Surface::Tiles(_) => true,
        Surface::Smooth => radius_px(scene, body) >= POINT_BELOW_PX || hosts_ship(),
        Surface::Nothing => false,
    }
}
