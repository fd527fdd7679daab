//! Readouts for tests: an ordinary one and extreme ones.

use crate::command::{Guidance, Hold};
use crate::world::readout::{Markers, OrbitReadout, Readout, Situation};
use engine::orbit::BodyId;
use engine::time::SimTime;
use glam::{DQuat, DVec3};

/// A ship in a low orbit.
pub fn readout() -> Readout {
    Readout {
        time: SimTime::from_jd_tdb(2_461_265.2),
        warp: crate::command::WARP_ONE,
        warp_asked: crate::command::WARP_ONE,
        body: BodyId(0),
        situation: Situation::Coasting,
        altitude_m: 420_000.0,
        ground_m: 0.0,
        lat_lon_rad: (0.7, -0.2),
        orbital_speed_m_s: 7_660.0,
        surface_speed_m_s: 7_300.0,
        vertical_speed_m_s: -1.5,
        orbit: OrbitReadout {
            apoapsis_m: 422_000.0,
            periapsis_m: 418_000.0,
            period_s: 5_570.0,
            eccentricity: 0.000_3,
            inclination_rad: 0.9,
            to_apoapsis_s: 900.0,
            to_periapsis_s: 3_700.0,
        },
        heading_pitch_roll_rad: [1.2, 0.1, 0.0],
        angular_rate_rad_s: DVec3::ZERO,
        icrf_from_hull: DQuat::IDENTITY,
        markers: Markers {
            prograde: DVec3::NEG_Z,
            surface_prograde: DVec3::new(0.05, 0.0, -1.0).normalize(),
            normal: DVec3::NEG_X,
            radial_out: DVec3::Y,
            zenith: DVec3::Y,
            north: DVec3::new(-0.6, 0.0, -0.8),
            target: DVec3::ZERO,
            sun: DVec3::new(0.3, 0.8, 0.2).normalize(),
        },
        density_kg_m3: 0.0,
        pressure_pa: 0.0,
        dynamic_pressure_pa: 0.0,
        mach: 0.0,
        heat_flux_w_m2: 0.0,
        load_g: 0.0,
        throttle: 0.0,
        rcs: 0.0,
        mass_kg: 60_000.0,
        propellant_kg: (20_000.0, 40_000.0),
        delta_v_m_s: 21_000.0,
        gear_down: false,
        hold: Hold::Rate,
        guidance: Guidance::Manual,
        guidance_phase: "",
        target: None,
        sun_visible: 1.0,
        eclipsed_by: None,
        warnings: Vec::new(),
        last_contact: None,
    }
}
