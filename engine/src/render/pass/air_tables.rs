//! Air tables: transmittance, further orders of scattering and sky irradiance of each air that is drawn or lights what is drawn, baked only
//! when it comes into view for the first time or its medium has changed. Those of an air that goes out of view stay while there is room.
//!
//! An air that is drawn in bands ([`crate::air::spectral`]) takes three slots: its own, whose tables everyone asks, and one for each
//! band medium, by which its light along a ray is found.
//!
//! A slot (a layer of texture arrays, two of transmittance, a block of the table of further orders) belongs to a body's id; the slot longest unused is given away when all are taken.
//! What the tables mean and how to ask them is in `shaders/lib/air.wgsl`; bodies without air have no slot and ask nothing.

use super::air_bands::{BandMixer, Tables};
use super::air_orders::{Inputs, OrdersBaker};
use super::sky::choose::without_tables;
use crate::air::model::orders::Plan;
use crate::air::model::spread::Spread;
use crate::air::spectral::bands::Band;
use crate::air::{Air, Classes, Medium, Model};
use crate::gpu::buffer::Uniform;
use crate::gpu::texture::{Texture, linear_sampler};
use crate::gpu::{Gpu, ShaderLibrary};
use crate::render::RenderError;
use crate::render::pipeline::{compute_pipeline, loaded_entry, stored_texture_entry, uniform_entry};
use crate::render::report::TABLES_MADE;
use crate::render::shared::{AirTables, FrameContext};
use crate::render::targets::HDR;
use crate::scene::gpu_data::{AirUniform, AirsUniform, MAX_AIRS, MEDIA_COLUMNS, MEDIA_ROWS, media_rows};
use crate::scene::{Body, Snapshot, Surface};
use bytemuck::Zeroable;
use glam::DMat3;
use wgpu::{BindingResource, TextureUsages, TextureViewDimension};

/// Texels of the transmittance table, as in `shaders/lib/air.wgsl`.
pub const TRANSMITTANCE_SIZE: [u32; 2] = [128, 128];

/// What of an air a slot holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    /// The air as surfaces ask for it.
    Own,
    /// A medium of its bands.
    Band(usize),
    /// Only its shape: nothing asks for tables.
    Bare,
}

/// How an air is mixed of its bands: the slot of each, and its matrix to linear sRGB.
type InBands = Vec<(u32, DMat3)>;

/// Whose air a slot holds.
struct Slot {
    id: u16,
    part: Part,
    medium: Medium,
    spread: Spread,
    bands: Option<InBands>,
    /// The air's model puts what it says of the ground's light over these tables (`sky_daylight`).
    overlaid: bool,
    used: u64,
    baked: bool,
}

/// The pass.
pub struct AirBaker {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
    orders: OrdersBaker,
    mixer: BandMixer,
    transmittance: Texture,
    irradiance: Texture,
    media: Texture,
    values: AirTables,
    airs: Uniform<AirsUniform>,
    linear: wgpu::Sampler,
    slots: Vec<Slot>,
    clock: u64,
    /// What becomes of the tables of each body of the scene, in words.
    told: Vec<String>,
}

impl AirBaker {
    /// Compiles the three bakes and makes room for [`MAX_AIRS`] airs.
    #[allow(clippy::cast_possible_truncation)]
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary) -> Result<Self, RenderError> {
        let storage = stored_texture_entry(1, HDR, TextureViewDimension::D2Array);
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("air transmittance"),
            entries: &[uniform_entry(0), storage, loaded_entry(2, TextureViewDimension::D2Array)],
        });
        let module = shaders.load(&gpu.device, "pass/air_transmittance.wgsl")?;
        let pipeline = compute_pipeline(gpu, "air_transmittance", &module, &[&layout], "bake");
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC;
        let [w, h] = TRANSMITTANCE_SIZE;
        let transmittance = Texture::with(&gpu.device, "air transmittance", [w, h, 2 * MAX_AIRS as u32], 1, HDR, usage);
        let irradiance = OrdersBaker::irradiance_tables(gpu);
        let orders = OrdersBaker::new(gpu, shaders)?;
        let mixer = BandMixer::new(gpu, shaders)?;
        let media = Texture::with(
            &gpu.device,
            "media",
            [MEDIA_COLUMNS as u32, MEDIA_ROWS as u32, MAX_AIRS as u32],
            1,
            wgpu::TextureFormat::Rgba32Float,
            TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        );
        let airs = Uniform::new(&gpu.device, "Airs", wgpu::BufferUsages::empty());
        let values = AirTables {
            airs: airs.buffer.clone(),
            transmittance: transmittance.array_view(),
            orders: orders.view(),
            irradiance: irradiance.array_view(),
            media: media.array_view(),
        };
        let linear = linear_sampler(&gpu.device, "air tables", false);
        Ok(Self {
            layout,
            pipeline,
            orders,
            mixer,
            transmittance,
            irradiance,
            media,
            values,
            airs,
            linear,
            slots: Vec::new(),
            clock: 0,
            told: Vec::new(),
        })
    }

    /// The slot of each body of the scene whose air needs tables; new and changed media wait for [`AirBaker::record`].
    ///
    /// In a forced frame all airs get theirs.
    pub fn assign(&mut self, scene: &Snapshot) -> Vec<Option<u32>> {
        self.clock += 1;
        self.told.clear();
        let mut slots = Vec::new();
        for (i, body) in scene.bodies.iter().enumerate() {
            let why = without_tables(scene, i).filter(|_| !scene.force.all);
            let air = body.air.as_ref().filter(|_| why.is_none());
            let slot = air.and_then(|air| match is_bare(body, air) {
                true => self.slot_of(body.id, Part::Bare, &air.medium, None),
                false => self.slots_of(body.id, air),
            });
            let held = slot.and_then(|s| self.slots.get(s as usize));
            self.told.push(match (why, held) {
                (Some(why), _) => format!("none: {why}"),
                (None, Some(slot)) if slot.part == Part::Bare => "none: its model asks none".to_owned(),
                (None, Some(slot)) if slot.baked => "as they were made".to_owned(),
                (None, Some(_)) => TABLES_MADE.to_owned(),
                (None, None) => "none".to_owned(),
            });
            slots.push(slot);
        }
        slots
    }

    /// What [`AirBaker::assign`] found of the tables of a body, in words.
    pub fn told(&self, body: u32) -> &str {
        self.told.get(body as usize).map_or("", String::as_str)
    }

    /// The slot of an air, and those of its bands; where there is no room for these it is drawn without.
    fn slots_of(&mut self, id: u16, air: &Air) -> Option<u32> {
        let own = self.slot_of(id, Part::Own, &air.medium, None)?;
        let rings = self.spread(own).copied();
        let bands: Option<InBands> = air.bands.as_ref().and_then(|bands| {
            let slot = |(k, band): (usize, &Band)| Some((self.slot_of(id, Part::Band(k), &band.medium, rings.as_ref())?, band.to_rgb));
            bands.list.iter().enumerate().map(slot).collect()
        });
        let overlaid = matches!(air.model, Model::ViewTable(_));
        if let Some(slot) = self.slots.get_mut(own as usize) {
            // What another model laid over them is not taken for what was baked.
            slot.baked &= slot.bands == bands && slot.overlaid == overlaid;
            (slot.bands, slot.overlaid) = (bands, overlaid);
        }
        Some(own)
    }

    /// `rings`: those of another medium, whose sheets of eclipses it shares.
    #[allow(clippy::cast_possible_truncation)]
    fn slot_of(&mut self, id: u16, part: Part, medium: &Medium, rings: Option<&Spread>) -> Option<u32> {
        let fresh = || Slot {
            id,
            part,
            medium: medium.clone(),
            spread: rings.map_or_else(|| Spread::new(medium), |rings| Spread::in_rings(medium, rings)),
            bands: None,
            overlaid: false,
            used: self.clock,
            baked: false,
        };
        let at = match self.slots.iter().position(|s| s.id == id && s.part == part) {
            Some(i) => i,
            None if self.slots.len() < MAX_AIRS => {
                let fresh = fresh();
                self.slots.push(fresh);
                return Some(self.slots.len() as u32 - 1);
            }
            None => {
                let (i, oldest) = self.slots.iter().enumerate().min_by_key(|(_, s)| s.used)?;
                if oldest.used == self.clock {
                    return None; // more airs in one scene than slots: the farthest go without
                }
                i
            }
        };
        let slot = self.slots.get_mut(at)?;
        if slot.id == id && slot.part == part && slot.medium == *medium {
            slot.used = self.clock;
        } else {
            *slot = fresh();
        }
        Some(at as u32)
    }

    /// From how far scattered light comes in the air of a slot.
    pub fn spread(&self, slot: u32) -> Option<&Spread> {
        self.slots.get(slot as usize).map(|s| &s.spread)
    }

    /// Why the scene does not need it.
    pub fn skip(&self, scene: &Snapshot) -> Option<String> {
        if scene.bodies.iter().all(|b| b.air.is_none()) {
            return Some("no body in the scene has air".to_owned());
        }
        if self.slots.iter().all(|s| s.used < self.clock) {
            return Some("no air in view covers a pixel, and none lights a ship".to_owned());
        }
        self.slots.iter().all(|s| s.baked).then(|| "no medium in view has changed since its tables were made".to_owned())
    }

    /// Bakes what waits (everything, where the frame is forced) and gives the tables.
    pub fn record(&mut self, f: &mut FrameContext<'_>) -> AirTables {
        let forced = f.scene.force.all;
        for slot in &mut self.slots {
            slot.baked &= !(forced && slot.used == self.clock);
        }
        let gpu = f.gpu;
        self.bake(gpu, &mut f.compute("air_tables"));
        self.values()
    }

    /// The tables as they are.
    pub fn values(&self) -> AirTables {
        self.values.clone()
    }

    /// Bakes every slot that waits.
    #[allow(clippy::cast_possible_truncation)]
    pub fn bake(&mut self, gpu: &Gpu, pass: &mut wgpu::ComputePass<'_>) {
        let mut all = AirsUniform::zeroed();
        for ((air, slot), i) in all.list.iter_mut().zip(&self.slots).zip(0..) {
            *air = AirUniform::new(&slot.medium, &Classes::of(&slot.medium)).with_rings(&slot.spread).in_slot(i);
            if let Some(bands) = &slot.bands {
                *air = air.in_bands(bands);
            }
        }
        self.airs.write(&gpu.queue, &all);
        let waiting: Vec<u32> = self.slots.iter().enumerate().filter(|(_, s)| !s.baked).map(|(i, _)| i as u32).collect();
        for slot in &waiting {
            self.write_media(gpu, *slot);
            self.bake_slot(gpu, pass, *slot);
        }
        for slot in waiting {
            self.mix_slot(gpu, pass, slot);
        }
        self.slots.iter_mut().for_each(|s| s.baked = true);
    }

    /// Hands over the tables of a medium that is not formulas.
    fn write_media(&self, gpu: &Gpu, slot: u32) {
        let Some(medium) = self.slots.get(slot as usize).map(|s| &s.medium) else { return };
        let classes = Classes::of(medium);
        if !classes.direct {
            self.media.write(&gpu.queue, 0, slot, bytemuck::cast_slice(&media_rows(medium, &classes)));
        }
    }

    fn bake_slot(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass<'_>, slot: u32) {
        // Those of an air in bands are mixed from theirs.
        let Some(held) = self.slots.get(slot as usize).filter(|s| s.part != Part::Bare && s.bands.is_none()) else { return };
        let transmittance = layers_of(&self.transmittance, 2 * slot, 2, TextureViewDimension::D2Array);
        let media = layers_of(&self.media, slot, 1, TextureViewDimension::D2Array);
        let air = self.air_in(slot);
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("air transmittance"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: BindingResource::Buffer(air.clone()) },
                wgpu::BindGroupEntry { binding: 1, resource: BindingResource::TextureView(&transmittance) },
                wgpu::BindGroupEntry { binding: 2, resource: BindingResource::TextureView(&media) },
            ],
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        let [w, h] = TRANSMITTANCE_SIZE;
        pass.dispatch_workgroups(w.div_ceil(8), h.div_ceil(8), 1);
        let inputs =
            Inputs { air, transmittance: &transmittance, media: &media, linear: &self.linear, irradiance: &self.values.irradiance, slot };
        self.orders.bake(gpu, pass, &Plan::new(&held.medium), &inputs);
    }

    /// Mixes the tables of an air that is drawn in bands from theirs.
    fn mix_slot(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass<'_>, slot: u32) {
        let bands = self.slots.get(slot as usize).and_then(|s| s.bands.as_deref()).unwrap_or_default();
        // The second of one counts for nothing: its matrix is zero.
        let (Some((one, _)), Some((other, _))) = (bands.first(), bands.last()) else { return };
        let read = |table, layer| layers_of(table, layer, 1, TextureViewDimension::D2Array);
        let written = |table, layer| layers_of(table, layer, 1, TextureViewDimension::D2);
        let tables = Tables {
            own: [written(&self.transmittance, 2 * slot), written(&self.irradiance, slot)],
            bands: [
                read(&self.transmittance, 2 * *one),
                read(&self.transmittance, 2 * *other),
                read(&self.irradiance, *one),
                read(&self.irradiance, *other),
            ],
        };
        self.mixer.mix(gpu, pass, self.air_in(slot), &tables, TRANSMITTANCE_SIZE);
    }

    /// `Air` of a slot.
    fn air_in(&self, slot: u32) -> wgpu::BufferBinding<'_> {
        let size = size_of::<AirUniform>() as u64;
        wgpu::BufferBinding { buffer: &self.airs.buffer, offset: u64::from(slot) * size, size: wgpu::BufferSize::new(size) }
    }

    /// One air alone, in slot 0 (its bands behind it), waits to be baked.
    pub fn assign_alone(&mut self, air: &Air) {
        self.slots.clear();
        self.slots_of(0, air);
    }

    /// Tables of one air alone, as [`AirBaker::assign_alone`] has it, submitted: for probes and tests.
    pub fn bake_alone(&mut self, gpu: &Gpu, air: &Air) -> AirTables {
        self.assign_alone(air);
        let mut encoder = gpu.encoder("air tables");
        self.bake(gpu, &mut encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default()));
        gpu.submit(encoder);
        self.values()
    }

    /// The texture arrays of transmittance and of irradiance (which holds fourth roots).
    pub const fn textures(&self) -> [&Texture; 2] {
        [&self.transmittance, &self.irradiance]
    }
}

/// Whether an air lights no ground, by a model that knows no tables: a bank of fog.
pub(super) const fn is_bare(body: &Body, air: &Air) -> bool {
    matches!(body.surface, Surface::Nothing) && matches!(air.model, Model::Thickness(_) | Model::Gradient(_) | Model::LimbTable(_))
}

/// Some layers of a table.
fn layers_of(table: &Texture, from: u32, count: u32, dimension: TextureViewDimension) -> wgpu::TextureView {
    table.texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(dimension),
        base_array_layer: from,
        array_layer_count: Some(count),
        ..Default::default()
    })
}
