//! The ship's specification: what its asset file says (`assets/ships/*.toml`), every key with its unit.
//!
//! Plain data and range checks only: the file is read and its errors are shown by [`crate::assets`].

use crate::world::system::System;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Everything that an asset file says of a ship. Hull axes: +X right, +Y up, −Z forward, origin at the centre of mass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShipSpec {
    /// File name without its ending: `torch`.
    pub key: String,
    /// Display name.
    pub name: String,
    /// One line for the menu.
    pub description: String,
    /// Masses and inertia.
    pub mass: Mass,
    /// Main engine.
    pub main_engine: MainEngine,
    /// Reaction control thrusters, for translation.
    pub rcs: Rcs,
    /// Turning.
    pub attitude: Attitude,
    /// How air acts on the hull.
    pub aero: Aero,
    /// The hull as a box.
    pub hull: Hull,
    /// Landing gear.
    pub gear: Gear,
    /// What hull and crew bear.
    pub limits: Limits,
    /// How sunlight pushes it; none: not at all.
    #[serde(default)]
    pub sunlight: Option<Sunlight>,
}

/// Masses and inertia.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mass {
    /// Mass without propellant, kg.
    pub dry_kg: f64,
    /// Capacity of the tanks, kg.
    pub propellant_kg: f64,
    /// Moments of inertia about X, Y, Z with full tanks, kg·m²; they scale with the mass.
    pub inertia_kg_m2: DVec3,
}

/// Main engine; its nozzles swing between aft and down.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MainEngine {
    /// Thrust at full throttle, N (no loss in air is modelled).
    pub thrust_n: f64,
    /// Effective exhaust velocity, m/s.
    pub exhaust_velocity_m_s: f64,
    /// How fast the nozzles swing, °/s.
    pub swivel_deg_s: f64,
}

/// Reaction control thrusters, for translation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rcs {
    /// Force along each of the six directions, N.
    pub thrust_n: f64,
    /// Effective exhaust velocity, m/s.
    pub exhaust_velocity_m_s: f64,
}

/// Turning: wheels and thrusters together; they use no propellant (stated simplification).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Attitude {
    /// Torque limits about X, Y, Z, N·m.
    pub torque_n_m: DVec3,
    /// Turn rates that full stick commands about X, Y, Z, °/s.
    pub max_rate_deg_s: DVec3,
}

/// How air acts on the hull; the model is stated in [`super::aero`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Aero {
    /// Reference area S, m².
    pub reference_area_m2: f64,
    /// Reference length c, m.
    pub reference_length_m: f64,
    /// Radius of the stagnation region, m (heating).
    pub nose_radius_m: f64,
    /// Drag coefficient at zero lift, nose first.
    pub cd0: f64,
    /// k of the drag polar CD = CD0 + k CL².
    pub induced_drag: f64,
    /// dCL/dα before the stall, per rad.
    pub lift_slope_per_rad: f64,
    /// Angle of attack at which the flow begins to separate, °.
    pub stall_deg: f64,
    /// Drag coefficient belly or roof first.
    pub belly_drag: f64,
    /// Drag coefficient side first.
    pub side_drag: f64,
    /// Restoring pitch moment coefficient per rad of angle of attack.
    pub pitch_stability_per_rad: f64,
    /// Restoring yaw moment coefficient per rad of sideslip.
    pub yaw_stability_per_rad: f64,
    /// Rate damping coefficient (moment per q S c · ωc/2V).
    pub damping: f64,
    /// Moment coefficient of full control surfaces.
    pub control: f64,
}

/// The hull as a box.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hull {
    /// Width (X), height (Y), length (Z), m; centred on the centre of mass.
    pub size_m: DVec3,
}

/// Landing gear: each leg is a spring and damper along the hull's −Y.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gear {
    /// Feet with the gear down and the suspension at full length, hull axes, m.
    pub feet_m: Vec<DVec3>,
    /// Travel of the suspension, m.
    pub stroke_m: f64,
    /// Spring of one leg, N/m.
    pub stiffness_n_m: f64,
    /// Damper of one leg, N·s/m.
    pub damping_n_s_m: f64,
    /// Coulomb friction of a foot on the ground.
    pub friction: f64,
}

/// What hull and crew bear.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Heat flux at which the pilot is warned, W/m².
    pub heat_flux_w_m2: f64,
    /// Dynamic pressure at which the pilot is warned, Pa.
    pub dynamic_pressure_pa: f64,
    /// Felt acceleration at which the pilot is warned, g₀.
    pub load_g: f64,
    /// Speed of impact that the gear bears, m/s.
    pub gear_impact_m_s: f64,
    /// Speed of impact that the bare hull bears, m/s.
    pub hull_impact_m_s: f64,
}

/// How sunlight pushes the ship while it coasts: as a sphere, whatever its attitude and whether or not a world stands before the
/// star (stated simplifications).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sunlight {
    /// Cross section, m².
    pub area_m2: f64,
    /// Radiation pressure coefficient: 1 black, 2 a mirror that faces the star.
    pub reflectivity: f64,
}

impl ShipSpec {
    /// Mass with full tanks, kg.
    pub fn full_mass_kg(&self) -> f64 {
        self.mass.dry_kg + self.mass.propellant_kg
    }
    /// What the star's light takes off its pull on the ship of this mass, m³/s²: C_R (A/m) times the force of the light on a
    /// square metre times the square of the distance (see [`engine::orbit::gravity::radiation`]).
    pub fn light_m3_s2(&self, mass_kg: f64, system: &System) -> f64 {
        self.sunlight.map_or(0.0, |s| s.reflectivity * s.area_m2 / mass_kg * system.light_n)
    }
    /// Height of the centre of mass above level ground with the gear down and unloaded, m.
    pub fn standing_height_m(&self) -> f64 {
        self.gear.feet_m.iter().map(|f| -f.y).fold(0.5 * self.hull.size_m.y, f64::max)
    }
    /// Every value that is out of range, as `(key, what is wrong)`; empty when the ship can fly.
    pub fn faults(&self) -> Vec<(&'static str, String)> {
        let mut faults = Vec::new();
        let mut positive = |key: &'static str, x: f64, zero_ok: bool| {
            if !(x.is_finite() && (x > 0.0 || (zero_ok && x == 0.0))) {
                let wanted = if zero_ok { "zero or more" } else { "more than zero" };
                faults.push((key, format!("{x} is out of range: expected a finite number, {wanted}")));
            }
        };
        positive("mass.dry_kg", self.mass.dry_kg, false);
        positive("mass.propellant_kg", self.mass.propellant_kg, true);
        positive("mass.inertia_kg_m2", self.mass.inertia_kg_m2.min_element(), false);
        positive("mass.inertia_kg_m2", self.mass.inertia_kg_m2.max_element(), false);
        positive("main_engine.thrust_n", self.main_engine.thrust_n, false);
        positive("main_engine.exhaust_velocity_m_s", self.main_engine.exhaust_velocity_m_s, false);
        positive("main_engine.swivel_deg_s", self.main_engine.swivel_deg_s, false);
        positive("rcs.thrust_n", self.rcs.thrust_n, true);
        positive("rcs.exhaust_velocity_m_s", self.rcs.exhaust_velocity_m_s, false);
        positive("attitude.torque_n_m", self.attitude.torque_n_m.min_element(), false);
        positive("attitude.torque_n_m", self.attitude.torque_n_m.max_element(), false);
        positive("attitude.max_rate_deg_s", self.attitude.max_rate_deg_s.min_element(), false);
        positive("attitude.max_rate_deg_s", self.attitude.max_rate_deg_s.max_element(), false);
        positive("aero.reference_area_m2", self.aero.reference_area_m2, false);
        positive("aero.reference_length_m", self.aero.reference_length_m, false);
        positive("aero.nose_radius_m", self.aero.nose_radius_m, false);
        positive("aero.cd0", self.aero.cd0, false);
        positive("aero.induced_drag", self.aero.induced_drag, true);
        positive("aero.lift_slope_per_rad", self.aero.lift_slope_per_rad, true);
        positive("aero.stall_deg", self.aero.stall_deg, false);
        positive("aero.belly_drag", self.aero.belly_drag, false);
        positive("aero.side_drag", self.aero.side_drag, false);
        positive("aero.pitch_stability_per_rad", self.aero.pitch_stability_per_rad, true);
        positive("aero.yaw_stability_per_rad", self.aero.yaw_stability_per_rad, true);
        positive("aero.damping", self.aero.damping, true);
        positive("aero.control", self.aero.control, true);
        positive("hull.size_m", self.hull.size_m.min_element(), false);
        positive("hull.size_m", self.hull.size_m.max_element(), false);
        positive("gear.stroke_m", self.gear.stroke_m, false);
        positive("gear.stiffness_n_m", self.gear.stiffness_n_m, false);
        positive("gear.damping_n_s_m", self.gear.damping_n_s_m, true);
        positive("gear.friction", self.gear.friction, true);
        positive("limits.heat_flux_w_m2", self.limits.heat_flux_w_m2, false);
        positive("limits.dynamic_pressure_pa", self.limits.dynamic_pressure_pa, false);
        positive("limits.load_g", self.limits.load_g, false);
        positive("limits.gear_impact_m_s", self.limits.gear_impact_m_s, false);
        positive("limits.hull_impact_m_s", self.limits.hull_impact_m_s, false);
        if let Some(light) = self.sunlight {
            positive("sunlight.area_m2", light.area_m2, true);
            if !(0.0..=2.0).contains(&light.reflectivity) {
                faults.push(("sunlight.reflectivity", format!("{} is out of range: expected 0 … 2", light.reflectivity)));
            }
        }
        if self.gear.feet_m.len() < 3 || self.gear.feet_m.iter().any(|f| !f.is_finite() || f.y >= 0.0) {
            faults.push(("gear.feet_m", "expected at least three feet, each below the centre of mass (negative y)".to_owned()));
        }
        faults
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The torch ship, as shipped.
    pub(crate) fn torch() -> ShipSpec {
        toml::from_str(include_str!("../../../../assets/ships/torch.toml")).unwrap()
    }

    #[test]
    fn shipped_ships_are_in_range() {
        let capsule: ShipSpec = toml::from_str(include_str!("../../../../assets/ships/capsule.toml")).unwrap();
        for spec in [torch(), capsule] {
            assert_eq!(spec.faults(), Vec::new(), "{}", spec.key);
        }
        let dv = torch().main_engine.exhaust_velocity_m_s * libm::log(torch().full_mass_kg() / torch().mass.dry_kg);
        assert!(dv > 60_000.0, "a sandbox ship lands anywhere: {dv} m/s");
    }

    #[test]
    fn faults_name_the_key() {
        let mut bad = torch();
        bad.aero.cd0 = f64::NAN;
        bad.mass.dry_kg = -1.0;
        let keys: Vec<_> = bad.faults().iter().map(|f| f.0).collect();
        assert_eq!(keys, ["mass.dry_kg", "aero.cd0"]);
    }
}
