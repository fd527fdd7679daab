//! THE FRAME: the passes in their order. Each is preceded by the reason for which it may be skipped; textures are values.
//!
//! Exposure: HDR is stored pre-exposed with the exposure of the frame before. A still (`adapt_s: None`), or a first frame, has
//! none: its light is drawn twice, first small and with a middling exposure ([`STARTING_PRE`]) to take the histogram, then for good.

use super::pass::Passes;
use super::report::FrameReport;
use super::shared::FrameContext;
use super::targets::Targets;
use super::{Overlay, RenderError, Renderer, Target};
use crate::gpu::Gpu;
use crate::scene::gpu_data::ExposureUniform;
use crate::scene::{AutoOr, Snapshot, second_light};

/// Pre-exposure before anything is known: half floats then hold luminances from 1e-5 to 6e6 cd/m².
pub const STARTING_PRE: f32 = 0.01;

/// Draws one frame and submits it.
pub fn draw(
    renderer: &mut Renderer,
    gpu: &Gpu,
    scene: &Snapshot,
    target: Target<'_>,
    overlay: Option<&mut dyn Overlay>,
) -> Result<FrameReport, RenderError> {
    let (view, format, size) = target.parts();
    if size.contains(&0) {
        return Ok(FrameReport::default());
    }
    if renderer.targets.as_ref().is_none_or(|t| t.size != size) {
        renderer.targets = Some(Targets::new(gpu, size));
    }
    let still = scene.adapt_s.is_none();
    let unexposed = still || !renderer.exposed;
    let mut metered = FrameReport::default();
    match scene.exposure {
        AutoOr::Ev100(ev) => renderer.shared.write_exposure(gpu, &ExposureUniform::fixed(ev)),
        AutoOr::Auto { .. } if unexposed => {
            renderer.shared.write_exposure(gpu, &ExposureUniform::starting(STARTING_PRE));
            let (small, meter_targets) = metering(gpu, scene, size);
            let (mut f, passes) = renderer.begin(gpu, &small, Some(&meter_targets))?;
            let lit = light(&mut f, passes)?;
            passes.exposure.record(&mut f, &lit);
            f.keep_exposure();
            metered = f.submit();
        }
        AutoOr::Auto { .. } => {}
    }

    let (mut f, passes) = renderer.begin(gpu, scene, None)?;
    let lit = light(&mut f, passes)?;

    let skip = passes.exposure.skip(scene, unexposed);
    if f.runs("exposure", skip) && !unexposed {
        passes.exposure.record(&mut f, &lit);
    }

    f.runs("bloom", None);
    let glare = passes.bloom.record(&mut f, &lit);

    f.runs("tonemap", None);
    passes.tonemap.record(&mut f, &lit, &glare, view, format);

    let skip = overlay.is_none().then(|| "nothing is painted over the picture".to_owned());
    if let (true, Some(overlay)) = (f.runs("overlay", skip), overlay) {
        overlay.record(gpu, &mut f.encoder, view, format, size);
    }

    f.keep_exposure();
    let mut report = f.submit();
    report.add_earlier_round(&metered);
    renderer.end(gpu, report, still)
}

/// The scene and targets for taking the first histogram: half the picture each way tells as much of its light.
fn metering(gpu: &Gpu, scene: &Snapshot, size: [u32; 2]) -> (Snapshot, Targets) {
    let mut small = scene.clone();
    let size = if size.iter().all(|n| *n >= 256) { size.map(|n| n / 2) } else { size };
    small.camera.size_px = size;
    (small, Targets::new(gpu, size))
}

/// Everything that shines, in this order: air tables, light bent into shadows, eclipsed surroundings, tables of the airs' models, tile heights, shadow, smooth bodies, terrain, ships, stars and the sun's
/// disc, sky (which lays every air over `opaque` and its depth). The value is the finished light: the HDR texture that the picture is made of.
fn light(f: &mut FrameContext<'_>, passes: &mut Passes) -> Result<wgpu::TextureView, RenderError> {
    f.clear_opaque();

    let skip = passes.air_tables.skip(f.scene);
    let air = if f.runs("air_tables", skip) { passes.air_tables.record(f) } else { passes.air_tables.values() };

    let skip = passes.refracted.skip();
    let refracted = if f.runs("refracted", skip) { passes.refracted.record(f) } else { passes.refracted.table() };

    let skip = passes.eclipse_rings.skip();
    let sheets = if f.runs("eclipse_rings", skip) { passes.eclipse_rings.record(f, &air) } else { passes.eclipse_rings.sheets() };

    // No pass of its own: where a world shines on another, what that other shows is lit twice.
    f.runs("second_light", second_light::skip(f.scene));

    let skip = passes.sky.plan(f, &passes.air_tables);
    if f.runs("sky_tables", skip) {
        passes.sky.record_tables(f);
    }

    let skip = passes.sky.skip_daylight(f);
    if f.runs("sky_daylight", skip) {
        passes.sky.record_daylight(f, passes.air_tables.textures());
    }

    let skip = passes.terrain.plan(f.gpu, f.scene, f.maps);
    if f.runs("tile_heights", skip) {
        passes.terrain.record_heights(f);
    }

    let skip = passes.shadow.skip(f.scene);
    let shadow = if f.runs("shadow", skip) { passes.shadow.record(f, &mut passes.ship_geometry) } else { passes.no_shadow.clone() };

    let light = f.shared.light_group(f.gpu, &air, &refracted, &sheets, passes.sky.mirror(f.scene), &shadow);

    let skip = passes.smooth_body.skip(f.scene);
    if f.runs("smooth_body", skip) {
        passes.smooth_body.record(f, &light);
    }

    let skip = passes.terrain.skip(f.scene);
    if f.runs("terrain", skip) {
        passes.terrain.record(f, &light);
    }

    let skip = passes.ships.skip(f.scene);
    if f.runs("ships", skip) {
        passes.ships.record(f, &mut passes.ship_geometry, &light);
    }

    let skip = passes.sun_disc.skip(f.scene);
    if f.runs("sun_disc", skip) {
        passes.sun_disc.record(f);
    }

    let skip = passes.stars.skip(f.scene);
    if f.runs("stars", skip) {
        passes.stars.record(f);
    }

    let skip = passes.sky.skip(f.scene);
    Ok(if f.runs("sky", skip) { passes.sky.record(f, &light) } else { f.targets.opaque.view.clone() })
}
