//! Sky bench: pictures of one air by any model, and by the published baselines beside them, timed on the GPU and read back.
//!
//! A picture is drawn as a frame draws it: the black ball and its depth, then the painter's own passes over all of it. What is timed is
//! those, with all tables that hang on the eye or the sun; tables that hang on the medium alone are timed when they are made. Where a processor
//! stands in for a GPU its time is counted, as the caller's [`Clock`] tells it: by timestamps, whatever else it does would count too. [`view`]: what is
//! looked at; [`truth`]: what the reference says of it; [`front`]: errors and times put together.
//! Not here: probes along single rays ([`super::pass::sky_probe`]).

pub mod front;
pub mod truth;
pub mod view;

use super::RenderError;
use super::maps::MapStore;
use super::pass::air_tables::AirBaker;
use super::pass::eclipse_rings::EclipseRings;
use super::pass::sky::choose::Rect;
use super::pass::sky::physical::{AGREE, UNSEEN};
use super::pass::sky::{Draw, Painter, Parts, paint, painter, picture_layout};
use super::pass::smooth_body::SmoothBody;
use super::pass::{baseline_bruneton, baseline_hillaire_sky};
use super::report::FrameReport;
use super::shared::{FrameContext, Mirror, ShadowMap, Shared};
use super::targets::Targets;
use crate::air::{Air, Medium, Model};
use crate::gpu::buffer::Uniform;
use crate::gpu::timer::Timer;
use crate::gpu::{Gpu, ShaderLibrary, readback};
use crate::scene::Snapshot;
use crate::scene::gpu_data::{BodiesUniform, ExposureUniform, FrameUniform, Layers, SkyUniform};
use crate::space::relative::narrow;
use wgpu::{BindGroupEntry, BindingResource};

/// Stored is radiance times this: half floats then hold 1e-8 … 6 sr⁻¹ to a thousandth.
const PRE: f32 = 1e4;

/// A planet to bench.
#[derive(Clone, Debug, PartialEq)]
pub struct Planet {
    /// Its name in tables and files.
    pub name: String,
    /// Its air.
    pub medium: Medium,
    /// Angular radius of its sun, rad.
    pub sun_rad: f64,
}

/// Tables that take longer are made once.
const SLOW_MS: f64 = 2000.0;

/// How an air is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Technique {
    /// By a model of the game.
    Model(Model),
    /// [`baseline_hillaire_sky`].
    Hillaire,
    /// [`baseline_bruneton`].
    Bruneton(baseline_bruneton::Sizes),
}

/// A painter with its tables made.
pub struct Prepared {
    painter: Box<dyn Painter>,
    /// The air as it is drawn.
    pub air: Air,
    /// Time of its own tables of the medium, ms; that of the transmittance and orders of [`SkyBench::tables_ms`] is not in it.
    pub own_ms: f64,
}

/// How a prepared painter draws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Steps of a march.
    pub steps: u32,
    /// March at every pixel: no means of pixels around, no tables that hang on the eye.
    pub every_pixel: bool,
    /// In place of what `physical` has for how much pixels may differ and still agree.
    pub agree: Option<f32>,
}

/// Tells the processor time of this process and all its threads so far, s.
pub type Clock<'a> = &'a dyn Fn() -> f64;

/// What draws, and where into.
pub struct SkyBench<'a> {
    gpu: &'a Gpu,
    shaders: ShaderLibrary,
    shared: Shared,
    picture: wgpu::BindGroupLayout,
    tables: AirBaker,
    ground: SmoothBody,
    maps: MapStore,
    targets: Targets,
    uniform: Uniform<SkyUniform>,
    timer: Timer,
    sun_rad: f64,
    clock: Option<Clock<'a>>,
    /// Time of the transmittance and the further orders of the air, which the model `physical` takes both from, ms.
    pub tables_ms: f64,
}

impl<'a> SkyBench<'a> {
    /// Compiles what all share and makes the air tables of a planet, for pictures of a size.
    ///
    /// # Errors
    /// A shader that does not compile, a device that fails.
    pub fn new(gpu: &'a Gpu, shaders: &ShaderLibrary, size: [u32; 2], planet: &Planet, clock: Clock<'a>) -> Result<Self, RenderError> {
        let shared = Shared::new(gpu);
        let maps = MapStore::new(gpu);
        let mut bench = Self {
            gpu,
            shaders: shaders.clone(),
            picture: picture_layout(gpu),
            tables: AirBaker::new(gpu, shaders)?,
            ground: SmoothBody::new(gpu, shaders, &shared, &maps)?,
            maps,
            shared,
            targets: Targets::new(gpu, size),
            uniform: Uniform::new(&gpu.device, "Sky", wgpu::BufferUsages::STORAGE),
            timer: Timer::new(gpu),
            sun_rad: planet.sun_rad,
            clock: (gpu.info.device_type == wgpu::DeviceType::Cpu).then_some(clock),
            tables_ms: f64::INFINITY,
        };
        // The first round compiles.
        let air = Air::from(planet.medium.clone());
        for _ in 0..3 {
            bench.tables.assign_alone(&air);
            let ms = timed(gpu, &mut bench.timer, bench.clock, |pass| bench.tables.bake(gpu, pass))?;
            bench.tables_ms = bench.tables_ms.min(ms);
        }
        Ok(bench)
    }

    /// Compiles a technique and makes its tables; where that is quick they are made twice, and the faster is counted.
    ///
    /// # Errors
    /// As [`SkyBench::new`].
    pub fn prepare(&mut self, medium: &Medium, technique: &Technique) -> Result<Prepared, RenderError> {
        let mut air = Air::from(medium.clone());
        let parts = Parts { gpu: self.gpu, shaders: &self.shaders, shared: &self.shared, picture: &self.picture };
        let mut painter = match technique {
            Technique::Model(model) => {
                air.model = model.clone();
                painter(&parts, model)?
            }
            Technique::Hillaire => baseline_hillaire_sky::make(&parts, &self.tables.values())?,
            Technique::Bruneton(sizes) => baseline_bruneton::make(&parts, &self.tables.values(), *sizes, narrow(self.sun_rad))?,
        };
        let mut own_ms = f64::INFINITY;
        for _ in 0..2 {
            if painter.plan(self.gpu, &[(0, &air)], true) == 0 {
                own_ms = 0.0;
                break;
            }
            own_ms = own_ms.min(timed(self.gpu, &mut self.timer, self.clock, |pass| painter.bake(self.gpu, pass))?);
            if own_ms > SLOW_MS {
                break;
            }
        }
        Ok(Prepared { painter, air, own_ms })
    }

    /// Draws `scene`, whose one body has the air that was given, and tells the time of the air, ms. `white`: radiance that the game would expose to 1 there,
    /// where it is known.
    ///
    /// # Errors
    /// A device that fails or refuses.
    pub fn draw(&mut self, scene: &Snapshot, prepared: &mut Prepared, setting: Setting, white: Option<f32>) -> Result<f64, RenderError> {
        let gpu = self.gpu;
        let mut scene = scene.clone();
        scene.force.all = setting.every_pixel;
        self.shared.frame.write(&gpu.queue, &FrameUniform::new(&scene, 0));
        self.shared.bodies.write(&gpu.queue, &BodiesUniform::new(&scene, |_| Layers { air: Some(0), ..Layers::default() }));
        self.shared.write_exposure(gpu, &ExposureUniform::starting(PRE));
        let Some(body) = scene.bodies.first() else { return Err(RenderError::NothingDrawn) };
        let mut settings = prepared.painter.settings_in(&scene, body, &prepared.air);
        let rect = Rect::whole(self.targets.size);
        prepared.painter.place(&mut settings, rect);
        if let Model::Physical(_) = prepared.air.model {
            prepared.painter.agree(&mut settings, setting.agree.unwrap_or(AGREE));
            settings[2][0] = white.map_or(0.0, |w| UNSEEN * PRE * w);
        }
        self.uniform.write(&gpu.queue, &SkyUniform { ids: [0, setting.steps, 0, 0], settings });
        self.timer.begin_frame();
        let mut f = FrameContext {
            gpu,
            encoder: gpu.encoder("sky bench"),
            scene: &scene,
            shared: &self.shared,
            targets: &self.targets,
            maps: &self.maps,
            air_slots: vec![Some(0)],
            timer: Some(&mut self.timer),
            report: FrameReport::default(),
        };
        let tables = self.tables.values();
        let light =
            self.shared.light_group(gpu, &tables, &tables.media, &EclipseRings::none(gpu), &Mirror::none(gpu), &ShadowMap::none(gpu));
        f.clear_opaque();
        self.ground.record(&mut f, &light);
        let before = std::mem::replace(&mut f.encoder, gpu.encoder("sky bench, air"));
        gpu.submit(before);
        gpu.wait()?;
        let picture = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("sky"),
            layout: &self.picture,
            entries: &[
                BindGroupEntry { binding: 0, resource: BindingResource::TextureView(&self.targets.opaque.view) },
                BindGroupEntry { binding: 1, resource: BindingResource::TextureView(&self.targets.depth.view) },
                BindGroupEntry { binding: 2, resource: self.uniform.buffer.as_entire_binding() },
            ],
        });
        let draw = Draw { body, air: &prepared.air, rect, light: &light, picture: &picture, held: false, lit: false };
        paint(&mut f, &mut *prepared.painter, &draw, 0, &self.targets.aerial.view, false);
        let begun = self.clock.map(|now| now());
        f.submit();
        gpu.wait()?;
        let took = spent(self.clock, begun);
        self.timer.settle(gpu)?;
        if let Some(e) = gpu.take_error() {
            return Err(RenderError::Refused(e));
        }
        Ok(took.or_else(|| self.timer.ms("sky")).unwrap_or(f64::NAN))
    }

    /// The last picture: radiance per unit of illuminance, sr⁻¹, RGBA row by row.
    ///
    /// # Errors
    /// A device that fails.
    pub fn read(&self) -> Result<Vec<f32>, RenderError> {
        let mut rgba = readback::texture_f32(self.gpu, &self.targets.aerial.texture, 0)?;
        rgba.iter_mut().for_each(|x| *x /= PRE);
        Ok(rgba)
    }

    /// Width and height of the pictures.
    pub const fn size(&self) -> [u32; 2] {
        self.targets.size
    }
}

/// Time of a compute pass, ms.
fn timed(
    gpu: &Gpu,
    timer: &mut Timer,
    clock: Option<Clock<'_>>,
    work: impl FnOnce(&mut wgpu::ComputePass<'_>),
) -> Result<f64, RenderError> {
    timer.begin_frame();
    let mut encoder = gpu.encoder("tables");
    let mut pass =
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("tables"), timestamp_writes: timer.compute("tables") });
    work(&mut pass);
    drop(pass);
    timer.end_frame(&mut encoder);
    let begun = clock.map(|now| now());
    gpu.submit(encoder);
    timer.after_submit();
    gpu.wait()?;
    timer.settle(gpu)?;
    Ok(spent(clock, begun).or_else(|| timer.ms("tables")).unwrap_or(f64::NAN))
}

/// Processor time since, ms.
fn spent(clock: Option<Clock<'_>>, begun: Option<f64>) -> Option<f64> {
    Some((clock?() - begun?) * 1e3)
}
