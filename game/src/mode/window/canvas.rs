//! The canvas: window, device, surface, and egui's painter as the frame's overlay.

use crate::settings::Video;
use engine::gpu::{BackendChoice, Gpu, GpuError};
use engine::render::{OffscreenImage, Overlay};
use std::sync::Arc;
use winit::event::WindowEvent;
use winit::window::{Fullscreen, Window};

/// Window, device and surface.
pub struct Canvas {
    /// The window.
    pub window: Arc<Window>,
    /// The device; shared with the thread that builds pipelines.
    pub gpu: Arc<Gpu>,
    /// egui's context.
    pub ctx: egui::Context,
    /// What paints egui's shapes.
    pub painter: Painter,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    events: egui_winit::State,
    scaled: Option<(OffscreenImage, egui::TextureId)>,
    pressed: Vec<egui::Key>,
    ui_scale: f32,
}

/// Points that panels and menus need side by side and one above the other; in a smaller window all of them shrink.
const LEAST_POINTS: [f32; 2] = [1000.0, 700.0];

/// Zoom of the HUD: the player's, less where a window of so many pixels at so many pixels a point is too small for the panels.
fn zoom(size_px: [u32; 2], native: f32, ui_scale: f32) -> f32 {
    let points = size_px.map(|n| n as f32 / native);
    let fits = (points[0] / LEAST_POINTS[0]).min(points[1] / LEAST_POINTS[1]);
    ui_scale * fits.clamp(0.25, 1.0)
}

/// egui's painter.
pub struct Painter {
    renderer: egui_wgpu::Renderer,
    jobs: Vec<egui::ClippedPrimitive>,
    leaving: Vec<egui::TextureId>,
    pixels_per_point: f32,
    /// Clear the target first: nothing else is drawn in this frame.
    pub alone: bool,
}

/// What came of asking for the next picture to draw into.
pub enum Next {
    /// Draw into this.
    Picture(wgpu::SurfaceTexture),
    /// Nothing to draw into now (hidden, resized, timed out): try with the next frame.
    Skip,
}

impl Canvas {
    /// Opens a device for a window.
    ///
    /// # Errors
    /// [`GpuError::NoDevice`] with each backend's reason.
    pub fn open(window: Arc<Window>, backend: BackendChoice, video: &Video) -> Result<Self, GpuError> {
        let (gpu, surface) = Gpu::for_window(backend, window.clone())?;
        let size = window.inner_size();
        let config = configuration(&gpu, &surface, [size.width, size.height], video.vsync);
        surface.configure(&gpu.device, &config);
        let ctx = egui::Context::default();
        crate::hud::style::apply(&ctx);
        let most = usize::try_from(gpu.device.limits().max_texture_dimension_2d).ok();
        let native = engine::space::relative::narrow(window.scale_factor());
        let events = egui_winit::State::new(ctx.clone(), egui::ViewportId::ROOT, &window, Some(native), window.theme(), most);
        let renderer = egui_wgpu::Renderer::new(&gpu.device, config.format, egui_wgpu::RendererOptions::default());
        let painter = Painter { renderer, jobs: Vec::new(), leaving: Vec::new(), pixels_per_point: native, alone: true };
        let (gpu, ui_scale) = (Arc::new(gpu), video.ui_scale);
        let canvas = Self { window, gpu, ctx, painter, surface, config, events, scaled: None, pressed: Vec::new(), ui_scale };
        canvas.set_zoom();
        Ok(canvas)
    }

    /// Size of the picture, pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }
    /// Format of the picture.
    pub fn format(&self) -> wgpu::TextureFormat {
        self.config.format
    }

    /// Gives an event to egui; true when it keeps it for itself.
    pub fn event(&mut self, event: &WindowEvent) -> bool {
        self.events.on_window_event(&self.window, event).consumed
    }

    /// Presses a key for egui, as if on a keyboard: a pad's way through menus.
    pub fn press(&mut self, key: egui::Key) {
        self.pressed.push(key);
    }

    /// The window has another size; nothing happens while it is minimised.
    pub fn resize(&mut self, width: u32, height: u32) {
        if width > 0 && height > 0 && [width, height] != self.size() {
            (self.config.width, self.config.height) = self.fit(width, height);
            self.surface.configure(&self.gpu.device, &self.config);
        }
        self.set_zoom();
    }

    fn set_zoom(&self) {
        let native = engine::space::relative::narrow(self.window.scale_factor()).max(0.1);
        self.ctx.set_zoom_factor(zoom(self.size(), native, self.ui_scale));
    }

    fn fit(&self, width: u32, height: u32) -> (u32, u32) {
        let most = self.gpu.device.limits().max_texture_dimension_2d;
        (width.min(most), height.min(most))
    }

    /// Puts settings in force.
    pub fn apply(&mut self, video: &Video) {
        self.ui_scale = video.ui_scale;
        self.set_zoom();
        let mode = present_mode(video.vsync);
        if self.config.present_mode != mode {
            self.config.present_mode = mode;
            self.surface.configure(&self.gpu.device, &self.config);
        }
        let wanted = video.fullscreen;
        if wanted != self.window.fullscreen().is_some() {
            self.window.set_fullscreen(wanted.then_some(Fullscreen::Borderless(None)));
        }
    }

    /// The next picture to draw into; a surface that is outdated or lost is set up again.
    pub fn acquire(&mut self) -> Next {
        use wgpu::CurrentSurfaceTexture as Now;
        if self.window.is_minimized() == Some(true) {
            return Next::Skip;
        }
        match self.surface.get_current_texture() {
            Now::Success(texture) | Now::Suboptimal(texture) => return Next::Picture(texture),
            Now::Timeout | Now::Occluded | Now::Validation => {}
            Now::Outdated => self.surface.configure(&self.gpu.device, &self.config),
            Now::Lost => match self.gpu.instance.create_surface(self.window.clone()) {
                Ok(surface) => {
                    self.surface = surface;
                    self.surface.configure(&self.gpu.device, &self.config);
                }
                Err(e) => tracing::error!("the window's surface was lost and cannot be made again: {e}"),
            },
        }
        Next::Skip
    }

    /// Runs the HUD for a frame and takes over what it painted.
    pub fn paint(&mut self, mut show: impl FnMut(&egui::Context)) {
        let mut input = self.events.take_egui_input(&self.window);
        for key in self.pressed.drain(..) {
            for pressed in [true, false] {
                let modifiers = egui::Modifiers::NONE;
                input.events.push(egui::Event::Key { key, physical_key: None, pressed, repeat: false, modifiers });
            }
        }
        let mut output = self.ctx.run_ui(input, |ui| show(ui.ctx()));
        self.events.handle_platform_output(&self.window, std::mem::take(&mut output.platform_output));
        let set = std::mem::take(&mut output.textures_delta.set);
        let free = std::mem::take(&mut output.textures_delta.free);
        for (id, deltas) in &set {
            for delta in deltas {
                self.painter.renderer.update_texture(&self.gpu.device, &self.gpu.queue, *id, delta);
            }
        }
        // What goes is still painted in this frame: it is freed before the next.
        for id in std::mem::replace(&mut self.painter.leaving, free.into_iter().collect()) {
            self.painter.renderer.free_texture(&id);
        }
        self.painter.pixels_per_point = output.pixels_per_point;
        self.painter.jobs = self.ctx.tessellate(std::mem::take(&mut output.shapes), output.pixels_per_point);
        output.drop_without_applying_deltas();
    }

    /// The smaller image that the 3-D picture is drawn into at a render scale below 1, and its texture for egui.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub fn scaled(&mut self, scale: f32) -> Option<(OffscreenImage, egui::TextureId)> {
        if scale > 0.99 {
            if let Some((_, id)) = self.scaled.take() {
                self.painter.renderer.free_texture(&id);
            }
            return None;
        }
        let size = self.size().map(|n| ((n as f32 * scale).round() as u32).max(1));
        if self.scaled.as_ref().is_none_or(|(image, _)| image.size != size) {
            if let Some((_, id)) = self.scaled.take() {
                self.painter.renderer.free_texture(&id);
            }
            let image = OffscreenImage::new(&self.gpu, size);
            let id = self.painter.renderer.register_native_texture(&self.gpu.device, &image.colour.view, wgpu::FilterMode::Linear);
            self.scaled = Some((image, id));
        }
        self.scaled.clone()
    }

    /// Draws only what egui painted.
    pub fn draw_alone(&mut self, view: &wgpu::TextureView) {
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("menu") });
        self.painter.alone = true;
        let (format, size) = (self.config.format, self.size());
        self.painter.record(&self.gpu, &mut encoder, view, format, size);
        self.gpu.queue.submit([encoder.finish()]);
    }
}

impl Overlay for Painter {
    fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        _format: wgpu::TextureFormat,
        size_px: [u32; 2],
    ) {
        let screen = egui_wgpu::ScreenDescriptor { size_in_pixels: size_px, pixels_per_point: self.pixels_per_point };
        let more = self.renderer.update_buffers(&gpu.device, &gpu.queue, encoder, &self.jobs, &screen);
        gpu.queue.submit(more);
        let load = if self.alone { wgpu::LoadOp::Clear(wgpu::Color::BLACK) } else { wgpu::LoadOp::Load };
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("hud"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        self.renderer.render(&mut pass.forget_lifetime(), &self.jobs, &screen);
    }
}

const fn present_mode(vsync: bool) -> wgpu::PresentMode {
    if vsync { wgpu::PresentMode::AutoVsync } else { wgpu::PresentMode::AutoNoVsync }
}

fn configuration(gpu: &Gpu, surface: &wgpu::Surface<'_>, size: [u32; 2], vsync: bool) -> wgpu::SurfaceConfiguration {
    let most = gpu.device.limits().max_texture_dimension_2d;
    let [width, height] = size.map(|n| n.clamp(1, most));
    let formats = surface.get_capabilities(&gpu.adapter).formats;
    // Tone mapping and egui both write display values themselves: a format that encodes once more is the second choice.
    let plain = |f: &&wgpu::TextureFormat| matches!(f, wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Rgba8Unorm);
    let format = formats.iter().find(plain).or(formats.first()).copied().unwrap_or(wgpu::TextureFormat::Bgra8Unorm);
    let mut config = surface.get_default_config(&gpu.adapter, width, height).unwrap_or(wgpu::SurfaceConfiguration {
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        format,
        width,
        height,
        present_mode: present_mode(vsync),
        desired_maximum_frame_latency: 2,
        alpha_mode: wgpu::CompositeAlphaMode::Auto,
        view_formats: Vec::new(),
        color_space: Default::default(),
    });
    config.format = format;
    config.present_mode = present_mode(vsync);
    if gpu.info.device_type == wgpu::DeviceType::Cpu {
        // Frames that take long are not queued on top of each other: what is pressed would show several of them later.
        config.desired_maximum_frame_latency = 1;
    }
    config
}

#[cfg(test)]
mod tests {
    use super::zoom;

    #[test]
    fn the_hud_fits_small_windows_and_keeps_the_player_s_size_in_large_ones() {
        for (size_px, native, ui_scale, expected) in [
            ([1280, 720], 1.0, 1.0, 1.0),
            ([2560, 1440], 2.0, 1.25, 1.25),
            ([1280, 720], 2.0, 1.0, 360.0 / 700.0),
            ([800, 1200], 1.0, 1.0, 0.8),
            ([1, 1], 1.0, 1.0, 0.25),
        ] {
            let found = zoom(size_px, native, ui_scale);
            assert!((found - expected).abs() < 1e-6, "{size_px:?} at {native}: {found}, expected {expected}");
        }
    }
}
