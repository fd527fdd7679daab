//! Aerodynamics: a simple, stated model, the same at every Mach number.
//!
//! With q = ½ρV², α the angle of attack, β the sideslip (angles of the air's approach in hull axes):
//! - attached flow: CL = a·sin α·cos α, CD = k·CL² (with CD0 the drag polar CD = CD0 + k·CL²);
//! - separated flow: the hull is a plate that is pushed along its normal, C_belly·sin α·|sin α|;
//! - the two blend over [`STALL_WIDTH_DEG`] above the stall angle; CD0 acts along the flow at all angles;
//! - sideways the hull is a plate too: C_side·sin β·|sin β|;
//! - moments: weathercock −C·sin α and −C·sin β, rate damping −C·ωc/2V, controls up to C_control, all times q S c.
//!
//! Heating: Sutton & Graves 1971 (NASA TR R-376), q̇ = k·√(ρ/r_n)·V³ with k by gas.
//! Not here: wind (air turns with the body), ground effect, Mach effects.

use super::spec::Aero;
use engine::units::DEG;
use glam::DVec3;

/// The stall goes from attached to separated flow over this many degrees.
pub const STALL_WIDTH_DEG: f64 = 12.0;

/// Force and moment of the air, in hull axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AirLoad {
    /// Force, N.
    pub force: DVec3,
    /// Moment about the centre of mass, controls left out, N·m.
    pub moment: DVec3,
    /// Moment that full control surfaces add about each axis, N·m.
    pub control: f64,
}

/// The load on a hull that moves at `velocity` (hull axes, m/s) through air of `density` (kg/m³), turning at `rate` (rad/s).
pub fn load(spec: &Aero, density: f64, velocity: DVec3, rate: DVec3) -> AirLoad {
    let speed2 = velocity.length_squared();
    if density <= 0.0 || speed2 < 1e-6 {
        return AirLoad::default();
    }
    let speed = speed2.sqrt();
    let along = velocity / speed;
    let qs = 0.5 * density * speed2 * spec.reference_area_m2;
    let qsc = qs * spec.reference_length_m;
    // Sine of the angle of attack (belly towards the flow positive) and of the sideslip (flow from the right positive).
    let (sin_a, sin_b) = (-along.y, along.x);
    let cos_a = -along.z;
    let alpha = libm::atan2(sin_a.abs(), cos_a.abs());
    let separated = smooth((alpha / DEG - spec.stall_deg) / STALL_WIDTH_DEG);
    let cl = spec.lift_slope_per_rad * sin_a * cos_a;
    let lift_axis = (DVec3::Y - along * along.y).normalize_or(DVec3::ZERO);
    let attached = lift_axis * cl - along * (spec.induced_drag * cl * cl);
    let plate = DVec3::Y * (spec.belly_drag * sin_a * sin_a.abs());
    let side = DVec3::X * (-spec.side_drag * sin_b * sin_b.abs());
    let force = (attached.lerp(plate, separated) + side - along * spec.cd0) * qs;
    let weathercock = DVec3::new(-spec.pitch_stability_per_rad * sin_a, -spec.yaw_stability_per_rad * sin_b, 0.0);
    let damping = rate * (-spec.damping * spec.reference_length_m / (2.0 * speed));
    AirLoad { force, moment: (weathercock + damping) * qsc, control: spec.control * qsc }
}

/// 0 below 0, 1 above 1, 3x² − 2x³ between.
fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Sutton–Graves constant of an atmosphere, kg^½/m: by the mean molar mass that its gas law shows, air (Earth,
/// 1.7415e-4) or carbon dioxide (Mars and Venus, 1.9027e-4).
pub fn sutton_graves_k(pressure_pa: f64, density: f64, temperature_k: f64) -> f64 {
    const GAS_CONSTANT: f64 = 8.314_462_618;
    let molar_mass = if pressure_pa > 0.0 { density * GAS_CONSTANT * temperature_k / pressure_pa } else { 0.0 };
    if molar_mass > 0.036 { 1.9027e-4 } else { 1.7415e-4 }
}

/// Convective heat flux at the stagnation point, W/m².
pub fn heat_flux_w_m2(k: f64, density: f64, nose_radius_m: f64, speed: f64) -> f64 {
    if density <= 0.0 { 0.0 } else { k * (density / nose_radius_m).sqrt() * speed * speed * speed }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::ship::spec::tests::torch;

    #[test]
    fn nose_first_is_pure_drag_and_belly_first_is_a_plate() {
        let spec = torch().aero;
        let (rho, v) = (0.5, 200.0);
        let q_s = 0.5 * rho * v * v * spec.reference_area_m2;
        let nose = load(&spec, rho, DVec3::NEG_Z * v, DVec3::ZERO);
        assert!((nose.force - DVec3::Z * (spec.cd0 * q_s)).length() < 1e-9 * q_s);
        let belly = load(&spec, rho, DVec3::NEG_Y * v, DVec3::ZERO);
        assert!((belly.force - DVec3::Y * ((spec.cd0 + spec.belly_drag) * q_s)).length() < 1e-9 * q_s);
        let side = load(&spec, rho, DVec3::X * v, DVec3::ZERO);
        assert!((side.force + DVec3::X * ((spec.cd0 + spec.side_drag) * q_s)).length() < 1e-9 * q_s);
    }

    #[test]
    fn lift_points_up_and_the_moment_restores() {
        let spec = torch().aero;
        // Moving forward and a little down: positive angle of attack.
        let l = load(&spec, 1.0, DVec3::new(3.0, -10.0, -100.0), DVec3::ZERO);
        assert!(l.force.y > 0.0, "lift");
        assert!(l.moment.x < 0.0, "nose down");
        assert!(l.moment.y < 0.0, "nose towards the flow from the right");
        assert!(l.force.x < 0.0, "side force against the slip");
        let slope = load(&spec, 1.0, DVec3::new(0.0, -1e-3, -100.0), DVec3::ZERO).force.y / 1e-5 / (5000.0 * spec.reference_area_m2);
        // dCL/dα at 0 (the body-axis force also holds the tilted drag).
        assert!((slope - spec.lift_slope_per_rad - spec.cd0).abs() < 1e-3, "{slope}");
    }

    #[test]
    fn shuttle_entry_heating_is_of_the_published_size() {
        // Sutton–Graves, Earth: 7.0 km/s at 70 km (ρ = 8.28e-5), r_n = 1 m: 1.7415e-4·√8.28e-5·3.43e11 = 5.43e5 W/m².
        let flux = heat_flux_w_m2(sutton_graves_k(5.22, 8.28e-5, 219.6), 8.28e-5, 1.0, 7000.0);
        assert!((flux - 5.435e5).abs() < 2e3, "{flux}");
        assert!((sutton_graves_k(610.0, 0.0145, 220.0) - 1.9027e-4).abs() < 1e-9, "Mars is CO₂");
    }
}
