//! Every shader is valid WGSL by naga's word, and every Rust struct that is copied to the GPU has the layout of its WGSL twin,
//! field by field. A new mirrored struct is one more line in [`mirrored_structs_have_the_layout_of_their_twins`].

use engine::gpu::ShaderLibrary;
use engine::render::pass::sky_probe::{ProbeLight, ProbeRay};
use engine::scene::gpu_data as rust;
use engine::scene::gpu_terrain as ground;
use wgpu::naga::{Module, TypeInner};

/// Name, offset, size.
type Fields = Vec<(String, usize, usize)>;

/// The fields of a Rust struct with the names given (which must be all: their sizes have to add up).
macro_rules! fields {
    ($type:ty { $($field:ident),+ $(,)? }) => {{
        let zero = <$type as bytemuck::Zeroable>::zeroed();
        let fields: Fields = vec![$((stringify!($field).to_owned(), core::mem::offset_of!($type, $field), size_of_val(&zero.$field))),+];
        (fields, size_of::<$type>())
    }};
}

fn library() -> ShaderLibrary {
    ShaderLibrary::checkout()
}

/// The members of a WGSL struct and its span.
fn reflected(file: &str, name: &str) -> (Fields, usize) {
    let (_, module) = library().check(file).unwrap_or_else(|e| panic!("{e}"));
    let (members, span) = module
        .types
        .iter()
        .find_map(|(_, t)| match &t.inner {
            TypeInner::Struct { members, span } if t.name.as_deref() == Some(name) => Some((members.clone(), *span)),
            _ => None,
        })
        .unwrap_or_else(|| panic!("shaders/{file} has no struct {name}"));
    let size = |m: &Module, t| m.types[t].inner.size(m.to_ctx()) as usize;
    let fields = members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize, size(&module, m.ty))).collect();
    (fields, span as usize)
}

#[test]
fn every_shader_is_valid() {
    let mut errors = Vec::new();
    let mut count = 0;
    for name in ShaderLibrary::names() {
        count += 1;
        if let Err(e) = library().check(name) {
            errors.push(e.to_string());
        }
    }
    assert!(count > 10, "{count} shaders are embedded");
    assert!(errors.is_empty(), "{}", errors.join("\n"));
}

#[test]
fn mirrored_structs_have_the_layout_of_their_twins() {
    let twins = [
        ("lib/frame.wgsl", "Frame", fields!(rust::FrameUniform { clip_from_icrf, right, up, forward, size, star, intensity, counts })),
        (
            "lib/frame.wgsl",
            "Body",
            fields!(rust::BodyUniform {
                centre,
                fixed_x,
                fixed_y,
                fixed_z,
                up,
                sun,
                illuminance,
                albedo,
                ids,
                lights,
                second,
                second_illuminance,
                casters,
                occluders
            }),
        ),
        ("lib/frame.wgsl", "Bodies", fields!(rust::BodiesUniform { list })),
        ("lib/frame.wgsl", "Exposure", fields!(rust::ExposureUniform { pre, final_, average, settled })),
        (
            "lib/medium.wgsl",
            "Air",
            fields!(rust::AirUniform {
                shape,
                albedo,
                scattering,
                extinction,
                inverse_height,
                tent_bottom,
                tent_rise,
                tent_top,
                tent_fall,
                phases,
                jumps_low,
                jumps_high,
                orders,
                bands,
                rings
            }),
        ),
        ("lib/phase.wgsl", "Phases", fields!(rust::PhasesUniform { g, x, y, z })),
        ("lib/medium.wgsl", "Airs", fields!(rust::AirsUniform { list })),
        ("lib/sky_pixel.wgsl", "Sky", fields!(rust::SkyUniform { ids, settings })),
        ("lib/sky_pixel.wgsl", "ProbeRay", fields!(ProbeRay { up, ray, sun })),
        ("lib/sky_pixel.wgsl", "ProbeLight", fields!(ProbeLight { radiance, transmittance })),
        (
            "lib/view_table.wgsl",
            "ViewTable",
            fields!(rust::ViewTableUniform { rgb, alpha, rgb_phase, alpha_phase, tint, inverse, counts, ids }),
        ),
        ("lib/shadow.wgsl", "Shadow", fields!(rust::ShadowUniform { map_from_icrf, shape })),
        ("lib/ship.wgsl", "Ship", fields!(rust::ShipInstance { centre, hull_x, hull_y, hull_z, state })),
        ("lib/height.wgsl", "Octave", fields!(ground::OctaveUniform { cell_m, weight, flat_floor, density, seed, pad0, pad1, pad2 })),
        ("lib/height.wgsl", "MapShape", fields!(ground::MapShapeUniform { bits, scale, offset, pad })),
        (
            "pass/tile_heights.wgsl",
            "ReliefParams",
            fields!(ground::ReliefParamsUniform { counts, noise, province, height_map, coast_map, octaves }),
        ),
        ("lib/tile.wgsl", "TileFrame", fields!(ground::TileFrameUniform { centre, tangent })),
        ("pass/tile_heights.wgsl", "Job", fields!(ground::JobUniform { key, place, frame })),
        ("pass/tile_heights.wgsl", "Lattice", fields!(ground::LatticeUniform { cell, fade, fraction, fade_coarse })),
        (
            "pass/terrain.wgsl",
            "Tile",
            fields!(ground::TileUniform { frame, centre, key, morph, near_cell, near_fraction, far_cell, far_fraction }),
        ),
        ("lib/ground.wgsl", "Paint", fields!(ground::PaintUniform { kind, province, shifts, seeds })),
        ("pass/exposure.wgsl", "Meter", fields!(rust::MeterUniform { range, trim, limit })),
    ];
    for (file, name, (fields, size)) in twins {
        let (theirs, span) = reflected(file, name);
        assert_eq!(fields, theirs, "{name} of shaders/{file} (name, offset, size)");
        assert_eq!(size, span, "size of {name} of shaders/{file}");
        let sum: usize = fields.iter().map(|f| f.2).sum();
        assert_eq!(sum, size, "fields of {name} are missing from the list in this test");
    }
}
