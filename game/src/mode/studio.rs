//! The studio: a device and a renderer without a window, for pictures and film strips.

use crate::cli::Backend;
use crate::picture::{self, Kind, PictureError};
use crate::view::{Picture, Rig, snapshot};
use crate::world::World;
use engine::gpu::{BackendChoice, Gpu, GpuError};
use engine::render::{FrameReport, HdrImage, OffscreenImage, RenderError, Renderer, RendererOptions, StarCatalogue, Target};
use engine::scene::Force;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The sky of stills: that of the build, so that a picture does not depend on where it was taken.
const STARS: &[u8] = include_bytes!("../../../assets/stars/stars.bin");

/// Why there is no picture.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum StudioError {
    /// No device.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The frame was not drawn.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The file was not written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The list of passes was not written.
    #[error("{path}: cannot be written: {source}")]
    Passes {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// A device, a renderer and an image in memory.
pub struct Studio {
    gpu: Gpu,
    renderer: Renderer,
    image: OffscreenImage,
    size_px: [u32; 2],
    force: Force,
}

impl Studio {
    /// Opens a device and compiles the passes.
    pub fn open(backend: Option<Backend>, (width, height): (u32, u32), force: Force) -> Result<Self, StudioError> {
        let gpu = Gpu::headless(backend.map_or(BackendChoice::Auto, Backend::choice))?;
        let mut renderer = Renderer::new(&gpu, RendererOptions { measure: true, ..RendererOptions::default() })?;
        match StarCatalogue::parse(STARS) {
            Ok(catalogue) => renderer.set_stars(&gpu, catalogue),
            Err(e) => tracing::warn!("{e}"),
        }
        let image = OffscreenImage::new(&gpu, [width, height]);
        Ok(Self { gpu, renderer, image, size_px: [width, height], force })
    }

    /// Draws a still of the World.
    pub fn draw(&mut self, world: &World, rig: &Rig) -> Result<FrameReport, StudioError> {
        let picture = Picture { size_px: self.size_px, alpha: 0.0, adapt_s: None, force: self.force };
        let (scene, _) = snapshot(world, rig, &picture);
        Ok(self.renderer.render(&self.gpu, &scene, Target::Image(&self.image), None)?)
    }

    /// Another size for the pictures to come, pixels.
    pub fn resize(&mut self, (width, height): (u32, u32)) {
        if self.size_px != [width, height] {
            self.size_px = [width, height];
            self.image = OffscreenImage::new(&self.gpu, self.size_px);
        }
    }

    /// Passes to force in the pictures to come.
    pub fn force(&mut self, force: Force) {
        self.force = force;
    }

    /// The last picture, scene-linear, cd/m² per channel, before exposure.
    pub fn hdr(&self) -> Result<HdrImage, StudioError> {
        Ok(self.renderer.read_hdr(&self.gpu)?)
    }

    /// The last picture, 8-bit sRGB RGBA.
    pub fn pixels(&self) -> Result<Vec<u8>, StudioError> {
        Ok(self.image.read_rgba8(&self.gpu)?)
    }

    /// Writes the last picture, as the file's ending says.
    pub fn write(&self, path: &Path) -> Result<(), StudioError> {
        let [width, height] = self.size_px;
        match Kind::of(path)? {
            Kind::Png => picture::write_png(path, width, height, &self.pixels()?)?,
            Kind::Exr => picture::write_exr(path, width, height, &self.hdr()?.rgba)?,
        }
        Ok(())
    }
}

/// Writes what ran, what was skipped and why.
pub fn write_passes(path: &Path, report: &FrameReport) -> Result<(), StudioError> {
    let failed = |source| StudioError::Passes { path: path.to_owned(), source };
    let text = serde_json::to_string_pretty(report).map_err(|e| failed(e.into()))?;
    std::fs::write(path, text + "\n").map_err(failed)
}
