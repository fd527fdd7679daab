//! Deep air against closed forms: the solution in streams by itself, and through the tables and shaders that draw it.
//!
//! H of even scattering without loss, and what deep slabs let through: [Chandrasekhar 1950, "Radiative Transfer", table XI], [van de Hulst 1980,
//! "Multiple Light Scattering", chapters 5 and 8].

use engine::air::model::orders::{ALTITUDES, Plan, SUNS, SunMap, VIEWS, view_cosine};
use engine::air::{Layer, Medium, Phase, Profile};
use engine::gpu::{BackendChoice, Gpu, ShaderLibrary};
use engine::render::pass::sky_probe::{ProbeOptions, ProbeRay, Prober};
use engine::space::relative::narrow;
use glam::Vec3;
use std::f64::consts::PI;

const TOP_M: f64 = 120e3;
/// Of √(3)/4 H in the depth of a slab: where light would fall to nothing, beyond its edge.
const BEYOND: f64 = 1.4209;

/// Air of a scale height of 8 km over a planet of this size; optical depths by channel, of which a share is scattered.
fn air(bottom_radius_m: f64, depth: [f32; 3], kept: f32, phase: Phase, albedo: f32) -> Medium {
    let extinction = Vec3::from(depth) / 8000.0;
    Medium {
        bottom_radius_m,
        top_altitude_m: TOP_M,
        ground_albedo: Vec3::splat(albedo),
        layers: vec![Layer {
            scattering_per_m: extinction * kept,
            absorption_per_m: extinction * (1.0 - kept),
            profile: Profile::Exponential { scale_height_m: 8000.0 },
            phase,
        }],
    }
}

/// So large that its air is level.
const LEVEL_M: f64 = 1e10;

/// The solution by suns: zenith cosine; by channel the mean source at the top and what the sky lets fall on the ground.
fn solved(medium: &Medium) -> Vec<(f64, [[f64; 2]; 3])> {
    let plan = Plan::new(medium);
    assert!(plan.rows.iter().flatten().all(|x| x.is_finite()));
    let rows = &plan.rows[plan.deep.expect("it is deep") as usize + 1..];
    let map = SunMap::new(medium);
    (0..SUNS)
        .map(|k| {
            let values = core::array::from_fn(|c| {
                let at = |view: usize| (view_cosine(view), f64::from(rows[(((ALTITUDES - 1) * VIEWS + view) * SUNS + k) * 3 + c][0]));
                let mean = (1..VIEWS).map(|v| 0.25 * (at(v).0 - at(v - 1).0) * (at(v).1 + at(v - 1).1)).sum();
                [mean, f64::from(rows[ALTITUDES * VIEWS * SUNS * 3 + k][c])]
            });
            (map.mu((0.0, 1.0), k), values)
        })
        .collect()
}

/// H at a zenith cosine, between the values of the table.
fn h(mu: f64) -> f64 {
    let table = [1.0, 1.2474, 1.4503, 1.6425, 1.8293, 2.0128, 2.1941, 2.3740, 2.5527, 2.7306, 2.9078, 2.9078];
    let x = (10.0 * mu).clamp(0.0, 10.0);
    table.windows(2).zip(0..).map(|(w, i)| (w[1] - w[0]) * (x - f64::from(i)).clamp(0.0, 1.0)).sum::<f64>() + table[0]
}

#[test]
fn even_scattering_without_loss_is_chandrasekhar_s() {
    // At the top of bottomless air the source is H(μ₀)/4π, the first order's 1/4π among it; through deep air over black ground comes μ₀ H(μ₀) / √3 / (τ + 1.4209).
    let depths = [6.0, 20.0, 200.0];
    let found = solved(&air(LEVEL_M, depths, 1.0, Phase::Isotropic, 0.0));
    let high: Vec<_> = found.into_iter().filter(|(mu, _)| *mu > 0.2).collect();
    assert!(high.len() > 4);
    for (mu, found) in high {
        let top = 1.0 + 4.0 * PI * found[2][0];
        assert!((top / h(mu) - 1.0).abs() < 0.015, "sun {mu}: {top} not {}", h(mu));
        for (c, depth) in depths.into_iter().map(f64::from).enumerate() {
            let lit = found[c][1] + mu * libm::exp(-depth / mu);
            let truth = mu * h(mu) / 3.0_f64.sqrt() / (depth + BEYOND);
            assert!((lit / truth - 1.0).abs() < 0.015, "depth {depth}, sun {mu}: {lit} not {truth}");
        }
    }
}

#[test]
fn all_that_deep_air_takes_in_lights_ground_that_reflects_all() {
    // Without loss nothing flows anywhere: light is alike in all directions below the skin, and √3/4 μ₀ H(μ₀) falls onto the ground at any depth.
    for (phase, near) in [(Phase::Isotropic, 0.02), (Phase::Rayleigh, 0.03), (Phase::HenyeyGreenstein { g: 0.75 }, 0.1)] {
        for (mu, found) in solved(&air(LEVEL_M, [50.0, 100.0, 200.0], 1.0, phase.clone(), 1.0)) {
            for [_, lit] in found {
                let truth = 3.0_f64.sqrt() / 4.0 * mu * h(mu);
                assert!(mu < 0.2 || (lit / truth - 1.0).abs() < near, "{phase:?}, sun {mu}: {lit} not {truth}");
            }
        }
    }
}

#[test]
fn nothing_is_below_night_or_beyond_numbers() {
    for g in [-0.99, -0.5, 0.0, 0.9, 0.99] {
        for (kept, albedo) in [(1.0, 1.0), (0.5, 0.5), (0.999, 0.0)] {
            for (mu, found) in solved(&air(LEVEL_M, [1e-3, 50.0, 2000.0], kept, Phase::HenyeyGreenstein { g }, albedo)) {
                let all = found.as_flattened();
                assert!(all.iter().all(|x| *x < 2.0), "{g} {kept} {albedo} {mu}: {found:?}");
                assert!(mu > -0.02 || all.iter().all(|x| x.abs() < 1e-3), "{g} {mu}: {found:?}");
            }
        }
    }
}

#[test]
fn only_transport_depth_makes_air_deep() {
    let share_of = |depth: f32, phase| {
        let plan = Plan::new(&air(LEVEL_M, [0.1, 0.2, depth], 1.0, phase, 0.1));
        assert!(plan.orders > 0);
        plan.deep.map_or([0.0; 4], |at| plan.rows[at as usize])
    };
    let forward = || Phase::HenyeyGreenstein { g: 0.8 };
    assert_eq!([share_of(1.4, Phase::Rayleigh), share_of(7.0, forward())], [[0.0; 4]; 2]);
    assert_eq!([share_of(3.1, Phase::Rayleigh), share_of(16.0, forward())], [[0.0, 0.0, 1.0, 0.0]; 2]);
    let between = share_of(2.2, Phase::Rayleigh)[2];
    assert!((0.3..0.7).contains(&between), "{between}");
    // All of it deep: no orders, and nothing that they need.
    let plan = Plan::new(&air(LEVEL_M, [4.0; 3], 1.0, Phase::Rayleigh, 0.1));
    assert!(plan.orders == 0 && plan.deep == Some(0));
}

/// Radiance as it is drawn, per unit of the sun's illuminance, sun 60° from the zenith and the view across its azimuth: altitude and zenith cosine of the view.
fn drawn(medium: &Medium, views: &[(f64, f64)]) -> Vec<[f64; 4]> {
    let gpu = Gpu::headless(BackendChoice::Auto).expect("these tests draw");
    let prober = Prober::new(&gpu, &ShaderLibrary::checkout(), &medium.clone().into()).expect("its tables are made");
    let ray = |(altitude_m, mu): &(f64, f64)| ProbeRay {
        up: [0.0, 0.0, 1.0, narrow(*altitude_m)],
        ray: [0.0, narrow((1.0 - mu * mu).sqrt()), narrow(*mu), 0.0],
        sun: [0.75_f32.sqrt(), 0.0, 0.5, 0.0047],
    };
    let rays: Vec<_> = views.iter().map(ray).collect();
    let found = prober.ask(&gpu, &rays, &ProbeOptions::default()).expect("it marches");
    assert_eq!(gpu.take_error(), None);
    found.into_iter().map(|light| light.radiance.map(f64::from)).collect()
}

#[test]
fn deep_air_is_drawn_as_chandrasekhar_s_and_van_de_hulst_s() {
    let depths = [8.0, 12.0, 20.0];
    let medium = air(6.4e7, depths, 1.0, Phase::Isotropic, 0.0);
    let out = [-1.0, -0.9, -0.5];
    let up = [1.0, 0.5, 0.2, 0.1];
    let views: Vec<_> = out.map(|mu| (TOP_M + 10.0, mu)).into_iter().chain(up.map(|mu| (1.0, mu))).collect();
    let escape = |mu: f64| 3.0_f64.sqrt() / 4.0 * h(mu);
    for ((altitude_m, mu), light) in views.iter().zip(drawn(&medium, &views)) {
        for (light, depth) in light.into_iter().zip(depths.map(f64::from)) {
            let through = 0.5 * escape(0.5) * escape(mu.abs()) * 4.0 / (3.0 * (depth + BEYOND)) / PI;
            let mirrored = h(0.5) * h(mu.abs()) * 0.5 / (4.0 * PI * (0.5 + mu.abs())) - through;
            // Sixteen rows of altitude are few for the free paths next to the ground: at depth 20 a view 6° above the
            // horizon is a fifth too bright, at depth 50 one of 12° a third.
            let near = if mu.abs() < 0.15 { 0.25 } else { 0.1 };
            let (truth, near) = if *altitude_m > TOP_M { (mirrored, 0.03) } else { (through, near) };
            assert!((light / truth - 1.0).abs() < near, "depth {depth}, view {mu} from {altitude_m} m: {light} not {truth}");
        }
    }
}

#[test]
fn nothing_steps_where_air_becomes_deep() {
    // Depth by depth through the range in which the solution takes the place of the orders: no light changes by more than depth itself accounts for.
    let views = [(1.0, 0.8), (1.0, 0.1), (8e3, -0.5), (TOP_M + 10.0, -0.9), (TOP_M + 10.0, -0.3)];
    let at = |depth: f32| drawn(&air(6.4e6, [depth; 3], 1.0, Phase::Rayleigh, 0.2), &views);
    let mut last = at(1.3);
    for i in 1..=5 {
        let here = at(1.3 + 0.4 * i as f32);
        for ((view, a), b) in views.iter().zip(&last).zip(&here) {
            let change = libm::log(b[2] / a[2]).abs();
            assert!(change < 0.28, "from depth {}, view {view:?}: {a:?} {b:?}", 0.9 + 0.4 * i as f32);
        }
        last = here;
    }
}
