//! Rendering: a snapshot becomes pixels. Read [`frame`] first: the passes in their order.
//!
//! [`shared`] holds what all passes bind (group 0: frame, bodies, exposure; group 1: light), [`targets`] the textures sized
//! by the picture, [`pass`] one file per pass. Stored HDR is *pre-exposed*: luminance (cd/m²) × `exposure.pre`.

pub mod frame;
pub mod image;
pub mod maps;
pub mod pass;
pub mod pipeline;
pub mod report;
pub mod shared;
pub mod sky_bench;
pub mod targets;
#[cfg(test)]
pub(crate) mod tests;

pub use image::{HdrImage, OffscreenImage};
pub use maps::{BodyMaps, ColourMap};
pub use pass::stars::StarCatalogue;
pub use report::{AirReport, FrameReport, PassReport};

use crate::gpu::readback;
use crate::gpu::timer::Timer;
use crate::gpu::{Gpu, GpuError, ShaderError, ShaderLibrary};
use crate::scene::Snapshot;
use crate::scene::gpu_data::{BodiesUniform, ExposureUniform, FrameUniform};
use maps::MapStore;
use pass::Passes;
use shared::{FrameContext, Shared};
use targets::Targets;

/// What cannot be drawn, and why.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// A shader does not compile.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// The device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The device was lost: make a new [`Gpu`] and a new [`Renderer`].
    #[error("the graphics device was lost ({0}); a new one must be opened")]
    DeviceLost(String),
    /// The driver or wgpu refused what was asked.
    #[error("the graphics device refused the frame: {0}")]
    Refused(String),
    /// A map whose size and data disagree, or that the device cannot hold.
    #[error("map `{name}` of body {id}: {reason}")]
    Map {
        /// The body.
        id: u16,
        /// Which map.
        name: &'static str,
        /// What is wrong with it.
        reason: String,
    },
    /// Nothing has been drawn yet that could be read.
    #[error("no frame has been drawn yet: call `Renderer::render` first")]
    NothingDrawn,
}

/// Where a frame goes.
#[derive(Clone, Copy)]
pub enum Target<'a> {
    /// A window's surface texture.
    Surface {
        /// Its view.
        view: &'a wgpu::TextureView,
        /// Its format.
        format: wgpu::TextureFormat,
        /// Its size; with a zero nothing is drawn.
        size: [u32; 2],
    },
    /// An image in memory.
    Image(&'a OffscreenImage),
}

impl Target<'_> {
    pub(crate) fn parts(&self) -> (&wgpu::TextureView, wgpu::TextureFormat, [u32; 2]) {
        match self {
            Self::Surface { view, format, size } => (view, *format, *size),
            Self::Image(image) => (&image.colour.view, OffscreenImage::FORMAT, image.size),
        }
    }
}

/// What is painted over the finished picture (the HUD).
pub trait Overlay {
    /// Records its passes; `view` holds the picture in `format` and must be loaded, not cleared.
    fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        format: wgpu::TextureFormat,
        size_px: [u32; 2],
    );
}

/// How to set up a renderer.
#[derive(Clone, Debug, Default)]
pub struct RendererOptions {
    /// Where shaders come from.
    pub shaders: ShaderLibrary,
    /// Fill `gpu_ms` of the reports.
    pub measure: bool,
}

/// Draws snapshots.
pub struct Renderer {
    pub(crate) shared: Shared,
    pub(crate) passes: Passes,
    pub(crate) targets: Option<Targets>,
    pub(crate) maps: MapStore,
    pub(crate) timer: Timer,
    pub(crate) catalogue: StarCatalogue,
    pub(crate) options: RendererOptions,
    /// Frames drawn.
    pub(crate) number: u32,
    /// The last frame's finished light is in `aerial`, else in `opaque`.
    pub(crate) in_aerial: bool,
    /// An exposure has been found (so that the next live frame may adapt from it).
    pub(crate) exposed: bool,
}

impl Renderer {
    /// Compiles all passes.
    pub fn new(gpu: &Gpu, options: RendererOptions) -> Result<Self, RenderError> {
        let shared = Shared::new(gpu);
        let maps = MapStore::new(gpu);
        let passes = Passes::new(gpu, &options.shaders, &shared, &maps)?;
        let timer = Timer::new(gpu);
        let renderer = Self {
            shared,
            passes,
            targets: None,
            maps,
            timer,
            catalogue: StarCatalogue::default(),
            options,
            number: 0,
            in_aerial: false,
            exposed: false,
        };
        match gpu.take_error() {
            Some(e) => Err(RenderError::Refused(e)),
            None => Ok(renderer),
        }
    }

    /// Compiles all passes anew (after a shader was edited); on an error the old ones stay.
    pub fn reload_shaders(&mut self, gpu: &Gpu) -> Result<(), RenderError> {
        let passes = Passes::new(gpu, &self.options.shaders, &self.shared, &self.maps)?;
        if let Some(e) = gpu.take_error() {
            return Err(RenderError::Refused(e));
        }
        self.passes = passes;
        self.passes.stars.set_catalogue(gpu, &self.catalogue);
        self.exposed = false;
        Ok(())
    }

    /// Time against error in air: points of a march through a whole sky, 4 … 256 ([`pass::sky::STEPS`] unless told), and how much of its light a
    /// pixel may err that is drawn between rays, 0 … 1 ([`pass::sky::physical::AGREE`] unless told).
    pub fn set_sky(&mut self, points: u32, agree: f32) {
        self.passes.sky.steps = points.clamp(4, 256);
        self.passes.sky.agree = agree.clamp(0.0, 1.0);
    }

    /// Gives a body its maps; bodies without any are drawn in their mean albedo. `id` is [`crate::scene::Body::id`].
    pub fn register_body(&mut self, gpu: &Gpu, id: u16, maps: &BodyMaps) -> Result<(), RenderError> {
        self.maps.register(gpu, id, maps)
    }

    /// Replaces the stars of the sky; there are none before.
    pub fn set_stars(&mut self, gpu: &Gpu, catalogue: StarCatalogue) {
        self.passes.stars.set_catalogue(gpu, &catalogue);
        self.catalogue = catalogue;
    }

    /// Draws one frame: [`frame::draw`], submitted. Stills (`adapt_s: None`) wait for the pass times if they are measured.
    pub fn render(
        &mut self,
        gpu: &Gpu,
        scene: &Snapshot,
        target: Target<'_>,
        overlay: Option<&mut dyn Overlay>,
    ) -> Result<FrameReport, RenderError> {
        if let Some(reason) = gpu.lost() {
            return Err(RenderError::DeviceLost(reason));
        }
        let report = frame::draw(self, gpu, scene, target, overlay)?;
        if let Some(reason) = gpu.lost() {
            return Err(RenderError::DeviceLost(reason));
        }
        match gpu.take_error() {
            Some(e) => Err(RenderError::Refused(e)),
            None => Ok(report),
        }
    }

    /// The context of one round of passes; uniforms are written here. A round into targets of its own
    /// (to meter) is not timed.
    pub(crate) fn begin<'a>(
        &'a mut self,
        gpu: &'a Gpu,
        scene: &'a Snapshot,
        own_targets: Option<&'a Targets>,
    ) -> Result<(FrameContext<'a>, &'a mut Passes), RenderError> {
        let targets = own_targets.or(self.targets.as_ref()).ok_or(RenderError::NothingDrawn)?;
        let number = if scene.adapt_s.is_some() { self.number } else { 0 };
        let layers = self.passes.layers(scene);
        self.shared.frame.write(&gpu.queue, &FrameUniform::new(scene, number));
        self.shared.bodies.write(&gpu.queue, &BodiesUniform::new(scene, |i| layers.get(i).cloned().unwrap_or_default()));
        self.timer.poll(gpu);
        self.timer.begin_frame();
        let context = FrameContext {
            gpu,
            encoder: gpu.encoder("frame"),
            scene,
            shared: &self.shared,
            targets,
            maps: &self.maps,
            air_slots: layers.iter().map(|l| l.air).collect(),
            timer: (own_targets.is_none() && self.options.measure).then_some(&mut self.timer),
            report: FrameReport::default(),
        };
        Ok((context, &mut self.passes))
    }

    /// Fills in the pass times; a still waits for its own, a live frame shows the newest known.
    pub(crate) fn end(&mut self, gpu: &Gpu, mut report: FrameReport, still: bool) -> Result<FrameReport, RenderError> {
        self.exposed = true;
        self.in_aerial = self.passes.sky.in_aerial();
        self.number = self.number.wrapping_add(1).max(1);
        if still {
            self.timer.settle(gpu)?;
        }
        for pass in &mut report.passes {
            pass.gpu_ms = self.timer.ms(&pass.name).filter(|_| pass.ran);
        }
        Ok(report)
    }

    /// The last frame's scene-linear luminance, cd/m² per channel, before exposure, bloom and tone mapping.
    pub fn read_hdr(&self, gpu: &Gpu) -> Result<HdrImage, RenderError> {
        let targets = self.targets.as_ref().filter(|_| self.number > 0).ok_or(RenderError::NothingDrawn)?;
        let exposure: ExposureUniform = bytemuck::pod_read_unaligned(&readback::buffer(gpu, &self.shared.exposure_used.buffer)?);
        let scale = 1.0 / exposure.pre.max(f32::MIN_POSITIVE);
        let mut rgba = readback::texture_f32(gpu, if self.in_aerial { &targets.aerial.texture } else { &targets.opaque.texture }, 0)?;
        for texel in rgba.chunks_exact_mut(4) {
            texel[..3].iter_mut().for_each(|c| *c *= scale);
            texel[3] = 1.0;
        }
        Ok(HdrImage { size: targets.size, rgba })
    }
}
