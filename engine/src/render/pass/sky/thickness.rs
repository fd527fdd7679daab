//! How the model `thickness` draws: `shaders/lib/thickness.wgsl`, from its settings alone. It has no tables.
//!
//! A bank of fog within another's air was preceded by the whole of that air; what of it lies before the bank is laid over it
//! (`held` of the shader).

use super::{Draw, FRONT_RATE, Painter, PainterKind, Parts, no_settings};
use crate::air::model::Thickness as Settings;
use crate::air::model::thickness::ShadowShape;
use crate::air::{Air, Model};
use crate::gpu::Gpu;
use crate::gpu::texture::Texture;
use crate::render::RenderError;
use crate::render::pipeline::{PipelineKind, loaded_entry};
use crate::render::shared::FrameContext;
use crate::render::targets::HDR;
use crate::scene::gpu_data::{SkySettings, vec4};
use crate::scene::{Body, Surface};
use crate::space::relative::narrow;
use wgpu::{BindGroupEntry, BindingResource};

/// Compiles it.
pub fn make(parts: &Parts<'_>) -> Result<Box<dyn Painter>, RenderError> {
    let kind = PainterKind::new(parts, "pass/sky_thickness.wgsl", &[0, 1].map(|i| loaded_entry(i, wgpu::TextureViewDimension::D2)))?;
    let groups = [&parts.shared.frame_layout, &parts.shared.light_layout, parts.picture, &kind.own_layout];
    let held = [0.0, 1.0].map(|lit| {
        let constants = &[("IN_AIR", lit)];
        PipelineKind { entry: "held", constants, ..PipelineKind::full_screen("sky", &kind.module, &groups, HDR) }.make(parts.gpu)
    });
    let dark = Texture::new(&parts.gpu.device, "no air", [1, 1], HDR, wgpu::TextureUsages::TEXTURE_BINDING);
    let none = group(parts.gpu, &kind.own_layout, [&dark.view; 2]);
    Ok(Box::new(Thickness { kind, held, none, front: None }))
}

fn group(gpu: &Gpu, layout: &wgpu::BindGroupLayout, views: [&wgpu::TextureView; 2]) -> wgpu::BindGroup {
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("group 3: thickness"),
        layout,
        entries: &[0, 1].map(|i| BindGroupEntry { binding: [0, 1][i], resource: BindingResource::TextureView(views[i]) }),
    })
}

/// The painter.
struct Thickness {
    kind: PainterKind,
    /// Draw a bank within another's air: one of which no tables tell what it lets through, and one of which they do.
    held: [wgpu::RenderPipeline; 2],
    /// Group 3 where nothing is read from it.
    none: wgpu::BindGroup,
    /// Group 3 for the bank that is being drawn, and which of [`Thickness::held`] draws it.
    front: Option<(wgpu::BindGroup, usize)>,
}

impl Painter for Thickness {
    fn kind(&self) -> &PainterKind {
        &self.kind
    }
    fn settings(&self, body: &Body, air: &Air) -> SkySettings {
        let Model::Thickness(model) = &air.model else { return no_settings() };
        settings(model, air, matches!(body.surface, Surface::Nothing))
    }
    fn before(&mut self, f: &mut FrameContext<'_>, draw: &Draw<'_>) {
        let views = f.targets.sky_at(FRONT_RATE).light.each_ref().map(|t| &t.view);
        self.front = draw.held.then(|| (group(f.gpu, &self.kind.own_layout, views), usize::from(draw.lit)));
    }
    fn pipeline(&self) -> &wgpu::RenderPipeline {
        self.front.as_ref().map_or(&self.kind.pipeline, |front| &self.held[front.1])
    }
    fn group(&self, _id: u16) -> &wgpu::BindGroup {
        self.front.as_ref().map_or(&self.none, |front| &front.0)
    }
}

/// As the head of the shader says; `bare` where there is no ground to end a ray.
fn settings(model: &Settings, air: &Air, bare: bool) -> SkySettings {
    let mut rows = no_settings();
    let flag = |on: bool| if on { 1.0 } else { 0.0 };
    rows[0] = vec4(model.colour * (model.brightness * core::f32::consts::FRAC_1_PI), model.shadow_share);
    rows[1] = [narrow(1.0 / model.unit_m(&air.medium)), model.opacity, flag(model.shadow == ShadowShape::Cone), flag(bare)];
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::air::{Layer, Medium, Phase, Profile};
    use crate::gpu::BackendChoice;
    use crate::render::tests::empty_scene;
    use crate::render::{OffscreenImage, Renderer, RendererOptions, Target};
    use crate::scene::{AutoOr, Snapshot};
    use glam::{Quat, Vec3};

    const RADIUS_M: f32 = 6.371e6;
    const LX: f32 = 1.28e5;

    fn body(id: u16, centre_m: Vec3, radius_m: f32, surface: Surface, air: Air, sun: Vec3) -> Body {
        Body {
            id,
            centre_m,
            radius_m,
            icrf_from_fixed: Quat::IDENTITY,
            camera_altitude_m: centre_m.length() - radius_m,
            camera_up: -centre_m.normalize_or(Vec3::NEG_Y),
            sun_direction: sun,
            sun_angular_radius_rad: 0.00465,
            sun_illuminance_lx: Vec3::splat(LX),
            occluders: Vec::new(),
            albedo: Vec3::splat(0.2),
            surface,
            air: Some(air),
        }
    }

    /// On the ground of a planet like the Earth, the sun behind the camera; before it a white bank of fog, or none.
    fn scene(sun_deg: f32, ev100: f32, with_bank: bool) -> Snapshot {
        let (sine, cosine) = sun_deg.to_radians().sin_cos();
        let sun = Vec3::new(0.0, sine, cosine);
        let gas = Layer {
            scattering_per_m: Vec3::new(5.8e-6, 13.6e-6, 33.1e-6),
            absorption_per_m: Vec3::ZERO,
            profile: Profile::Exponential { scale_height_m: 8000.0 },
            phase: Phase::Rayleigh,
        };
        let medium =
            Medium { bottom_radius_m: f64::from(RADIUS_M), top_altitude_m: 1e5, ground_albedo: Vec3::splat(0.2), layers: vec![gas] };
        let mut scene = Snapshot { exposure: AutoOr::Ev100(ev100), ..empty_scene([48, 48]) };
        scene.star.centre_m = sun * 1.496e11;
        let mut planet = body(3, Vec3::NEG_Y * (RADIUS_M + 2.0), RADIUS_M, Surface::Smooth, medium.into(), sun);
        planet.camera_altitude_m = 2.0;
        scene.bodies.push(planet);
        if with_bank {
            let fog = Settings { colour: Vec3::ONE, opacity: 8.0, ..Settings::default() }.ball(300.0);
            let mut bank = body(900, Vec3::new(0.0, 320.0, -1500.0), 1e-3, Surface::Nothing, fog, sun);
            bank.occluders.push(crate::scene::Occluder { id: 3, centre_m: scene.bodies[0].centre_m, radius_m: RADIUS_M });
            scene.bodies.insert(0, bank);
        }
        scene
    }

    #[test]
    fn a_bank_of_fog_is_lit_by_what_the_air_about_it_lets_through() {
        let gpu = Gpu::headless(BackendChoice::Auto).unwrap_or_else(|e| panic!("this test draws: {e}"));
        let mut renderer = Renderer::new(&gpu, RendererOptions::default()).unwrap();
        let image = OffscreenImage::new(&gpu, [48, 48]);
        let mut seen = |sun_deg, ev100| {
            let [with, without] = [true, false].map(|bank| {
                renderer.render(&gpu, &scene(sun_deg, ev100, bank), Target::Image(&image), None).unwrap();
                let hdr = renderer.read_hdr(&gpu).unwrap();
                assert!(hdr.rgba.iter().all(|v| v.is_finite()));
                // The bank's middle stands 12° high.
                let at = 4 * (12 * 48 + 24);
                Vec3::new(hdr.rgba[at], hdr.rgba[at + 1], hdr.rgba[at + 2])
            });
            with - without
        };
        // Its brightness is told for a face-on white surface, 1/π; at noon the air takes a part of the sun's light and its sky gives some back.
        let white = Settings::default().brightness * LX * core::f32::consts::FRAC_1_PI;
        let noon = seen(60.0, 15.0);
        assert!((0.7..1.4).contains(&(noon.y / white)) && noon.max_element() < 1.3 * noon.min_element(), "{noon}, white {white}");
        let low = seen(1.0, 10.0);
        assert!(low.x > 1.8 * low.z && low.y < 0.5 * noon.y && low.y > 0.01 * noon.y, "{low}");
        let dusk = seen(-6.0, 3.0);
        assert!(dusk.y < 3e-4 * noon.y, "{dusk}");
        let night = seen(-25.0, -4.0);
        assert!(night.y < 1e-6 * noon.y, "{night}");
    }
}
