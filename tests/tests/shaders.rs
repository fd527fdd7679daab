//! Every shader is valid WGSL by naga's word, and every Rust struct that is copied to the GPU has the layout of its WGSL twin,
//! field by field. A new mirrored struct is one more line in [`mirrored_structs_have_the_layout_of_their_twins`].

use engine::gpu::ShaderLibrary;
use engine::render::pass::sky_probe::{ProbeLight, ProbeRay};
use engine::scene::gpu_data as rust;
use engine::scene::gpu_terrain as ground;
use wgpu::naga::{AddressSpace, Expression, Function, Module, ShaderStage, TypeInner, valid};

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

/// What is a shader only together with the file that includes it, and there is checked.
const PARTS: [&str; 1] = ["pass/sky.wgsl"];

fn whole() -> impl Iterator<Item = &'static str> {
    ShaderLibrary::names().filter(|name| !PARTS.contains(name))
}

#[test]
fn every_shader_is_valid() {
    let mut errors = Vec::new();
    let mut count = 0;
    for name in whole() {
        count += 1;
        if let Err(e) = library().check(name) {
            errors.push(e.to_string());
        }
    }
    assert!(count > 10, "{count} shaders are embedded");
    assert!(errors.is_empty(), "{}", errors.join("\n"));
    for part in PARTS {
        let asked = format!("#include \"{part}\"");
        let askers = whole().filter(|name| std::fs::read_to_string(format!("../shaders/{name}")).is_ok_and(|text| text.contains(&asked)));
        assert!(askers.count() > 0, "nothing includes shaders/{part}");
    }
}

/// Uniforms that the frame binds before any others: group 0.
const EARLY: usize = 3;
/// Later ones that compute shaders may read all the same: a list that is asked by an index, and one on which no branch hangs.
const LATE: [&str; 2] = ["airs", "meter"];

/// True where the function asks element so and so of the global array's struct by a number in its text.
fn asks_at_a_fixed_place(function: &Function, module: &Module, name: &str) -> bool {
    let list = |e| match &function.expressions[e] {
        Expression::AccessIndex { base, .. } => {
            matches!(&function.expressions[*base], Expression::GlobalVariable(v) if module.global_variables[*v].name.as_deref() == Some(name))
        }
        _ => false,
    };
    function.expressions.iter().any(|(_, e)| matches!(e, Expression::AccessIndex { base, .. } if list(*base)))
}

#[test]
fn branches_of_compute_shaders_hang_on_early_uniforms_only() {
    // Why: `compute_pipeline` in engine/src/render/pipeline.rs.
    let mut count = 0;
    for file in whole() {
        let (_, module) = library().check(file).unwrap_or_else(|e| panic!("{e}"));
        let info = valid::Validator::new(valid::ValidationFlags::all(), valid::Capabilities::empty()).validate(&module).expect("checked");
        for (i, entry) in module.entry_points.iter().enumerate().filter(|(_, e)| e.stage == ShaderStage::Compute) {
            count += 1;
            let used = info.get_entry_point(i);
            let uniforms = module.global_variables.iter().filter(|(v, g)| g.space == AddressSpace::Uniform && !used[*v].is_empty());
            for (_, global) in uniforms.filter(|(_, g)| g.binding.as_ref().is_some_and(|b| b.group > 0 || b.binding as usize > EARLY)) {
                let name = global.name.as_deref().unwrap_or_default();
                let what = format!("`{}` of shaders/{file} reads the uniform `{name}`", entry.name);
                assert!(LATE.contains(&name), "{what}: make it a storage buffer, or say in this test why no branch hangs on it");
            }
        }
        let functions = module.functions.iter().map(|(_, f)| f).chain(module.entry_points.iter().map(|e| &e.function));
        assert!(!functions.into_iter().any(|f| asks_at_a_fixed_place(f, &module, "airs")), "shaders/{file} asks `airs` at a fixed place");
    }
    assert!(count > 10, "{count} entries");
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
                sheets,
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
                rings,
                forward,
                cap,
                aureole,
                levels,
                level_steps,
                tilt,
                ring_parts,
                pad
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
