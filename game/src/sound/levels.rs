//! Levels: from the readout to how loud and how high each source is. What a pilot hears inside the hull.
//!
//! In a vacuum the engine comes through the structure alone, dull and dim; in air it comes round the hull too. Wind goes
//! with dynamic pressure, its pitch with speed, and it shakes about Mach 1. Not here: samples ([`super::voice`]).

use crate::world::readout::{Readout, Warning};
use engine::space::relative::narrow;

/// Air density at which the engine is heard as on the ground, kg/m³ (sea level).
const FULL_AIR_KG_M3: f64 = 1.225;
/// Dynamic pressure at which wind reaches 1 − 1/e of its full level, Pa.
const WIND_PA: f64 = 9.0e3;
/// Density below which no wind is heard, however fast, kg/m³ (80 km up on Earth).
const NO_WIND_KG_M3: f64 = 1.8e-5;

/// A repeated tone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Beep {
    /// Pitches of even and odd beeps, Hz.
    pub pitch_hz: [f32; 2],
    /// Length of a beep and from one to the next, s.
    pub on_every_s: [f32; 2],
    /// Level, 0 … 1; 0 is no beep.
    pub level: f32,
}

/// What all sources do now; levels are 0 … 1 of each source's own full level.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Levels {
    /// Main engine.
    pub engine: f32,
    /// Cutoff of the engine's rumble, Hz.
    pub engine_cutoff_hz: f32,
    /// Thrusters.
    pub rcs: f32,
    /// Air along the hull.
    pub wind: f32,
    /// Centre of the wind's band, Hz.
    pub wind_pitch_hz: f32,
    /// Buffeting near Mach 1.
    pub buffet: f32,
    /// The worst warning.
    pub warning: Beep,
}

impl Levels {
    /// What a readout sounds like.
    pub fn of(r: &Readout) -> Self {
        let part = |x: f64| if x.is_finite() { x.clamp(0.0, 1.0) } else { 0.0 };
        let throttle = part(r.throttle);
        // Through the hull 0.3, the rest through air; the root because ears hear by ratio.
        let air = part(r.density_kg_m3 / FULL_AIR_KG_M3).sqrt();
        let carried = 0.3 + 0.7 * air;
        let pressure = if r.dynamic_pressure_pa.is_finite() { r.dynamic_pressure_pa.max(0.0) } else { 0.0 };
        let thin = part(r.density_kg_m3 / NO_WIND_KG_M3);
        let mach = if r.mach.is_finite() { r.mach.clamp(0.0, 30.0) } else { 0.0 };
        let off = (mach - 1.0) / 0.15;
        Self {
            engine: narrow(throttle.sqrt() * carried),
            engine_cutoff_hz: narrow(70.0 + 130.0 * throttle + 700.0 * air * throttle),
            rcs: narrow(part(r.rcs) * (0.5 + 0.5 * air)),
            wind: narrow(thin * (1.0 - libm::exp(-pressure / WIND_PA))),
            wind_pitch_hz: narrow(180.0 + 900.0 * (mach / (0.6 + mach))),
            buffet: narrow(part(pressure / 2.0e4) * libm::exp(-off * off)),
            warning: r.warnings.iter().min().map_or(Beep::default(), |w| beep(*w)),
        }
    }
}

/// The tone of a warning: the worse, the higher and faster.
pub fn beep(warning: Warning) -> Beep {
    let (pitch_hz, on_every_s, level) = match warning {
        Warning::Crashed => ([110.0, 104.0], [0.9, 1.8], 0.5),
        Warning::PullUp => ([1175.0, 880.0], [0.11, 0.16], 1.0),
        Warning::Heat => ([988.0, 988.0], [0.12, 0.4], 0.9),
        Warning::Overpressure => ([784.0, 784.0], [0.12, 0.5], 0.9),
        Warning::OverG => ([659.0, 587.0], [0.15, 0.5], 0.8),
        Warning::GearUp => ([523.0, 659.0], [0.18, 0.7], 0.8),
        Warning::Propellant => ([440.0, 440.0], [0.2, 2.5], 0.6),
        Warning::WarpLowered => ([349.0, 330.0], [0.25, 3.0], 0.4),
    };
    Beep { pitch_hz, on_every_s, level }
}

/// Strength of a touchdown's thump at a speed (m/s), 0 … 1: a crash is as loud as it gets.
pub fn thump(speed_m_s: f64) -> f32 {
    if speed_m_s.is_finite() { narrow((speed_m_s.abs() / 6.0).clamp(0.0, 1.0).sqrt()) } else { 1.0 }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::command::{Guidance, Hold};
    use crate::world::readout::{Markers, OrbitReadout, Situation};
    use engine::orbit::BodyId;
    use engine::time::SimTime;
    use glam::{DQuat, DVec3};

    /// A coasting ship with everything off, in a vacuum.
    pub(crate) fn quiet() -> Readout {
        Readout {
            time: SimTime::default(),
            warp: 2,
            warp_asked: 2,
            body: BodyId(0),
            situation: Situation::Coasting,
            altitude_m: 4e5,
            ground_m: 0.0,
            lat_lon_rad: (0.0, 0.0),
            orbital_speed_m_s: 7.7e3,
            surface_speed_m_s: 7.3e3,
            vertical_speed_m_s: 0.0,
            orbit: OrbitReadout::default(),
            heading_pitch_roll_rad: [0.0; 3],
            angular_rate_rad_s: DVec3::ZERO,
            icrf_from_hull: DQuat::IDENTITY,
            markers: Markers::default(),
            density_kg_m3: 0.0,
            pressure_pa: 0.0,
            dynamic_pressure_pa: 0.0,
            mach: 0.0,
            heat_flux_w_m2: 0.0,
            load_g: 0.0,
            throttle: 0.0,
            rcs: 0.0,
            mass_kg: 1e5,
            propellant_kg: (1e4, 1e4),
            delta_v_m_s: 1e4,
            gear_down: false,
            hold: Hold::Rate,
            guidance: Guidance::Manual,
            guidance_phase: "",
            target: None,
            node: None,
            sun_visible: 1.0,
            eclipsed_by: None,
            eclipse: None,
            warnings: Vec::new(),
            last_contact: None,
        }
    }

    #[test]
    fn nothing_is_heard_of_wind_in_a_vacuum_and_more_with_pressure() {
        assert_eq!(Levels::of(&quiet()).wind, 0.0);
        let at = |density: f64, v: f64| {
            let dynamic_pressure_pa = 0.5 * density * v * v;
            Levels::of(&Readout { density_kg_m3: density, dynamic_pressure_pa, mach: v / 340.0, ..quiet() })
        };
        assert!(at(1.2, 200.0).wind > at(1.2, 100.0).wind && at(1.2, 100.0).wind > 0.3);
        assert!(at(1e-7, 7800.0).wind < 0.01);
        assert!(at(1.0, 340.0).buffet > 10.0 * at(1.0, 500.0).buffet);
        assert!(at(1.0, 300.0).wind_pitch_hz > at(1.0, 50.0).wind_pitch_hz);
    }

    #[test]
    fn the_worst_warning_is_the_one_heard() {
        let both = Readout { warnings: vec![Warning::Propellant, Warning::PullUp], ..quiet() };
        assert_eq!(Levels::of(&both).warning, beep(Warning::PullUp));
    }

    #[test]
    fn nonsense_in_the_readout_stays_within_bounds() {
        let mad =
            Readout { throttle: f64::NAN, density_kg_m3: f64::INFINITY, dynamic_pressure_pa: f64::NAN, mach: 1e300, rcs: -4.0, ..quiet() };
        let l = Levels::of(&mad);
        for x in [l.engine, l.rcs, l.wind, l.buffet] {
            assert!((0.0..=1.0).contains(&x), "{l:?}");
        }
        assert!(l.wind_pitch_hz < 1100.0 && l.engine_cutoff_hz < 1000.0);
        assert!((0.0..=1.0).contains(&thump(f64::NAN)));
    }
}
