//! Twin: the heights that the GPU computes for tiles against `engine::terrain::Relief`, sample by sample: an earthlike body with maps
//! and coasts, and a cratered one; at corners and edges of the cube, at the poles, at coarse and at the finest level.

use engine::gpu::{BackendChoice, Gpu, ShaderLibrary, readback};
use engine::render::pass::tile_heights::{SLOT, TileHeights};
use engine::space::sphere::{direction_of, direction_of_lat_lon, face_of};
use engine::terrain::map::CubeMap;
use engine::terrain::spec::{CraterSpec, NoiseSpec, ProvinceSpec};
use engine::terrain::tile::STORED;
use engine::terrain::{Maps, Relief, ReliefSpec, TileKey};
use glam::DVec3;
use std::sync::Arc;

fn made(n: usize, f: impl Fn(DVec3) -> f64) -> Arc<CubeMap> {
    let at = |k: usize| 2.0 * k as f64 / n as f64 - 1.0;
    let mut nodes = Vec::new();
    for face in 0..6 {
        for y in 0..=n {
            for x in 0..=n {
                nodes.push(f(direction_of(face, at(x), at(y))).round() as i16);
            }
        }
    }
    Arc::new(CubeMap::from_nodes(n, 1.0, 0.0, &nodes, [0; 32]).unwrap())
}

fn earthlike() -> Relief {
    let wave = |d: DVec3| (9.0 * d.x).sin() * (11.0 * d.y + 2.0).cos() + (23.0 * d.z + 5.0 * d.x).sin();
    let spec = ReliefSpec {
        water: true,
        map: Some("made".to_owned()),
        coast: Some("made".to_owned()),
        noise: Some(NoiseSpec { wavelength_m: 2e4, amplitude_m: 750.0, plain_amplitude_m: 14.0, gain: 0.47, ridged: 0.6, seed: 11 }),
        ..ReliefSpec::default()
    };
    let maps = Maps { height: Some(made(64, |d| 2800.0 * wave(d))), coast: Some(made(128, |d| 20_000.0 * wave(d))), ..Maps::default() };
    Relief::new(6.371e6, spec, maps).unwrap()
}

fn cratered() -> Relief {
    let spec = ReliefSpec {
        noise: Some(NoiseSpec { wavelength_m: 1.5e5, amplitude_m: 700.0, plain_amplitude_m: 60.0, gain: 0.47, ridged: 0.1, seed: 3 }),
        craters: Some(CraterSpec {
            largest_radius_m: 6e4,
            smallest_radius_m: 1.0,
            density: 0.9,
            depth_ratio: 0.2,
            complex_radius_m: 7500.0,
            seed: 4,
        }),
        provinces: Some(ProvinceSpec { wavelength_m: 2e6, depth_m: 1200.0, share: 0.35, albedo_ratio: 0.5, seed: 6 }),
        ..ReliefSpec::default()
    };
    Relief::new(1.7374e6, spec, Maps::default()).unwrap()
}

fn holding(d: DVec3, level: u8) -> TileKey {
    let (face, u, v) = face_of(d);
    let cells = f64::from(1_u32 << level);
    let at = |t: f64| ((0.5 * (t + 1.0) * cells) as u32).min((1 << level) - 1);
    TileKey { level, face, x: at(u), y: at(v) }
}

fn worst(gpu: &Gpu, relief: &Relief, level: u8) -> f64 {
    let last = (1_u32 << level) - 1;
    let mut keys: Vec<_> = (0..9).map(|i| holding(direction_of_lat_lon(0.35 * f64::from(i) - 1.3, 0.8 * f64::from(i)), level)).collect();
    keys.extend([0, 2, 4, 5].map(|face| TileKey { level, face, x: last / 2, y: last / 2 }));
    keys.extend([1, 3, 4].map(|face| TileKey { level, face, x: last, y: 0 }));
    keys.push(TileKey { level, face: 5, x: 0, y: last / 3 });
    let make: Vec<_> = keys.iter().copied().zip(0..).collect();
    let pass = TileHeights::new(gpu, &ShaderLibrary::checkout()).unwrap();
    let mut store = pass.store(gpu, relief, 32);
    let mut encoder = gpu.encoder("heights");
    pass.record(gpu, &mut encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default()), &mut store, relief, &make);
    gpu.submit(encoder);
    let bytes = readback::buffer(gpu, &store.heights).unwrap();
    let found: &[[f32; 2]] = bytemuck::cast_slice(&bytes);
    let mut worst = 0.0_f64;
    for (key, slot) in make {
        // The border is for normals only; inside, every seventh sample and the edges.
        for k in (0..65 * 65).filter(|k| k % 7 == 0 || k % 65 == 0 || k % 65 == 64) {
            let (i, j) = (k % 65, k / 65);
            let at = slot as usize * SLOT as usize + ((j + 1) * STORED as usize + i + 1);
            let truth = relief.height_at_level(key.sample_direction(i as i32, j as i32), level);
            let error = (f64::from(found[at][0]) - truth).abs();
            assert!(error.is_finite(), "{key:?} sample {i}, {j}: {} instead of {truth}", found[at][0]);
            worst = worst.max(error);
        }
    }
    worst
}

#[test]
fn heights_on_the_gpu_are_those_of_the_cpu() {
    let gpu = Gpu::headless(BackendChoice::Auto).unwrap();
    for (name, relief) in [("earthlike", earthlike()), ("cratered", cratered())] {
        let finest = relief.max_level();
        // Coarse levels sample waves of hundreds of kilometres from tiles of thousands: f32 keeps them to a centimetre or two.
        for (level, bound_m) in [(1, 0.04), (4, 0.04), (8, 0.03), (13, 0.01), (finest, 0.01)] {
            let error = worst(&gpu, &relief, level);
            println!("{name}, level {level}: worst {:.3} mm", 1e3 * error);
            assert!(error <= bound_m, "{name}, level {level}: {error} m, expected at most {bound_m} m");
        }
    }
}
