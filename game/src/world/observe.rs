//! Observing: a [`Readout`] from the World. Nothing here changes a bit of it.

use super::World;
use super::eclipse::{self, Sky};
use super::readout::{EclipseReadout, Markers, NodeReadout, OrbitReadout, Readout, Situation, TargetReadout, Warning};
use super::ship::local::{Local, ground_m};
use super::ship::{Motion, Rigid, aero, attitude, warp};
use crate::command::{Guidance, Target};
use core::f64::consts::{PI, TAU};
use engine::light::occlusion::{Disc, separation_rad, visible_behind_disc};
use engine::orbit::{BodyId, State};
use engine::space::{Centred, sphere};
use engine::units::G0;
use glam::DVec3;

/// Propellant fraction under which the pilot is warned.
const LOW_PROPELLANT: f64 = 0.05;
/// Seconds to the ground, at the present rate, under which the pilot is warned.
const PULL_UP_S: f64 = 20.0;
/// Height above ground under which the gear should be down, m.
const GEAR_HEIGHT_M: f64 = 200.0;

impl World {
    /// Everything that the HUD shows and the sound follows.
    pub fn readout(&self) -> Readout {
        let rigid = self.rigid();
        let local = self.local(&rigid);
        let ship = &self.ship;
        let situation = match ship.motion {
            Motion::Coast(_) => Situation::Coasting,
            Motion::Fly(_) => Situation::Flying,
            Motion::Contact(_) => Situation::Contact,
            Motion::Landed(_) => Situation::Landed,
            Motion::Crashed(_) => Situation::Crashed,
        };
        let q = rigid.icrf_from_hull.0;
        let fixed = local.direction_fixed();
        let (_, up, north) = sphere::east_up_north(fixed);
        let north = local.icrf_from_fixed.raw(north);
        let speed = local.v_surface.length();
        let air = local.air;
        let still = matches!(situation, Situation::Landed | Situation::Crashed);
        let k = aero::sutton_graves_k(air.pressure_pa, air.density_kg_m3, air.temperature_k);
        let (sun_visible, eclipsed_by) = self.sun(&rigid);
        let mut readout = Readout {
            time: self.time,
            warp: self.warp,
            warp_asked: self.warp_asked,
            body: rigid.body,
            situation,
            altitude_m: local.altitude_m,
            ground_m: ground_m(local.body, fixed),
            lat_lon_rad: sphere::lat_lon_of(up),
            orbital_speed_m_s: local.v.length(),
            surface_speed_m_s: if still { 0.0 } else { speed },
            vertical_speed_m_s: if still { 0.0 } else { local.vertical_m_s() },
            orbit: orbit(&local, &rigid.state),
            heading_pitch_roll_rad: heading_pitch_roll(q, local.up, north),
            angular_rate_rad_s: rigid.rate.0,
            icrf_from_hull: q,
            markers: self.markers(&rigid, &local, north),
            density_kg_m3: air.density_kg_m3,
            pressure_pa: air.pressure_pa,
            dynamic_pressure_pa: if still { 0.0 } else { local.dynamic_pressure_pa() },
            mach: if air.speed_of_sound_m_s > 0.0 && !still { speed / air.speed_of_sound_m_s } else { 0.0 },
            heat_flux_w_m2: aero::heat_flux_w_m2(k, air.density_kg_m3, ship.spec.aero.nose_radius_m, if still { 0.0 } else { speed }),
            load_g: if still { local.gravity().length() / G0 } else { ship.effort.felt_m_s2 / G0 },
            throttle: ship.effort.throttle,
            rcs: ship.effort.rcs,
            mass_kg: ship.mass_kg(),
            propellant_kg: (ship.propellant_kg, ship.spec.mass.propellant_kg),
            delta_v_m_s: ship.delta_v_m_s(),
            gear_down: ship.gear_down,
            hold: ship.hold,
            guidance: ship.guidance,
            guidance_phase: self.phase(),
            target: self.target.map(|t| self.target_readout(&local, t)),
            node: self.node_readout(),
            sun_visible,
            eclipsed_by,
            eclipse: self.eclipse(rigid.body),
            warnings: Vec::new(),
            last_contact: ship.last_contact.map(|(speed, at)| (speed, self.time.ticks - at.ticks)),
        };
        readout.warnings = self.warnings(&readout);
        readout
    }

    fn phase(&self) -> &'static str {
        match self.ship.guidance {
            Guidance::Manual => "",
            Guidance::Hover => "Hovering",
            Guidance::VerticalSpeed { .. } => "Holding vertical speed",
            Guidance::Node => self.ship.burn.as_ref().map_or("Planning the burn", |b| b.phase.describe()),
            Guidance::Land => self.ship.landing.as_ref().map_or("Planning the landing", |l| l.phase.describe()),
        }
    }

    fn markers(&self, rigid: &Rigid, local: &Local, north: DVec3) -> Markers {
        let hull = |v: DVec3| (rigid.icrf_from_hull.0.conjugate() * v).normalize_or(DVec3::ZERO);
        let normal = local.r.cross(local.v);
        Markers {
            prograde: hull(local.v),
            // Under a millimetre per second a direction is noise.
            surface_prograde: if local.v_surface.length() > 1e-3 { hull(local.v_surface) } else { DVec3::ZERO },
            normal: hull(normal),
            radial_out: hull(local.v.cross(normal)),
            zenith: hull(local.up),
            north: hull(north),
            target: self.target.map_or(DVec3::ZERO, |t| hull(attitude::target_offset(&self.system, local, self.time, t))),
            node: self.ship.burn.as_ref().map_or(DVec3::ZERO, |b| hull(b.aim)),
            sun: hull(attitude::offset_of_body(&self.system, rigid.body, BodyId(0), self.time) - local.r),
        }
    }

    fn node_readout(&self) -> Option<NodeReadout> {
        let ship = &self.ship;
        let node = ship.nodes.first()?;
        let left_m_s = ship.burn.as_ref().map_or(node.size_m_s(), |b| b.to_gain.length());
        Some(NodeReadout {
            count: ship.nodes.len(),
            to_node_s: node.at.since(self.time),
            to_burn_s: ship.burn_start(node).since(self.time),
            burn_s: ship.burn_s(left_m_s),
            dv_m_s: node.size_m_s(),
            left_m_s,
        })
    }

    fn target_readout(&self, local: &Local, target: Target) -> TargetReadout {
        let offset = attitude::target_offset(&self.system, local, self.time, target);
        let distance_m = offset.length();
        let mut velocity = self.system.ephemeris.relative(target.body, local.id, self.time).velocity.0 - local.v;
        let mut ground_distance_m = None;
        if let Some(spot) = target.spot {
            let b = self.system.body(target.body);
            let fixed = attitude::spot_direction(spot);
            let arm = b.spin.icrf_from_fixed(self.time).raw(fixed * b.radius_m);
            velocity += b.spin.angular_velocity(self.time).0.cross(arm);
            if target.body == local.id {
                let (here, cross) = (local.direction_fixed(), local.direction_fixed().cross(fixed));
                ground_distance_m = Some(b.radius_m * libm::atan2(cross.length(), here.dot(fixed)));
            }
        }
        TargetReadout { target, distance_m, closing_m_s: velocity.dot(offset.normalize_or(DVec3::ZERO)), ground_distance_m }
    }

    /// The free fraction of the star's disc at the ship, and the body that hides most of it. The dominating body hides it
    /// too: at night that is not called an eclipse on the ground, but from orbit it is.
    fn sun(&self, rigid: &Rigid) -> (f64, Option<BodyId>) {
        let sky = Sky::at(&self.system, self.time);
        let here = sky.position(rigid.body) + engine::space::Vector::new(rigid.state.position.0);
        let disc = |id: BodyId| Disc::of_sphere((sky.position(id) - here).0, self.system.body(id).radius_m);
        let sun = disc(BodyId(0));
        let mut visible = 1.0;
        let mut worst = (1.0, None);
        for id in eclipse::casters(&self.system, &sky, here, 0.0, None) {
            let caster = disc(id);
            let free = visible_behind_disc(sun.radius_rad, caster.radius_rad, separation_rad(sun.direction, caster.direction));
            visible *= free;
            if free < worst.0 {
                worst = (free, Some(id));
            }
        }
        (visible, worst.1)
    }

    fn eclipse(&self, body: BodyId) -> Option<EclipseReadout> {
        let event = self.system.next_event(body, self.time)?;
        let until = |t: engine::time::Moment| t.since(self.time.into());
        let [first, last] = event.eclipse.penumbra;
        Some(EclipseReadout { event, to_first_s: until(first), to_greatest_s: until(event.eclipse.greatest), to_last_s: until(last) })
    }

    fn warnings(&self, r: &Readout) -> Vec<Warning> {
        let limits = &self.ship.spec.limits;
        let height = r.altitude_m - r.ground_m - self.ship.spec.standing_height_m();
        let flying = matches!(r.situation, Situation::Flying | Situation::Contact);
        let sinking = -r.vertical_speed_m_s;
        // What full thrust could take off on the way down, were the roof up.
        let lift = self.ship.spec.main_engine.thrust_n / r.mass_kg - self.local(&self.rigid()).gravity().length();
        let stops_m = if lift > 0.0 { sinking * sinking / (2.0 * lift) } else { f64::INFINITY };
        let guided = self.ship.guidance != Guidance::Manual;
        let checks = [
            (r.situation == Situation::Crashed, Warning::Crashed),
            (
                flying
                    && !guided
                    && sinking > limits.gear_impact_m_s
                    && (height < PULL_UP_S * sinking && height < 2.0 * stops_m + 5.0 * sinking),
                Warning::PullUp,
            ),
            (r.heat_flux_w_m2 > limits.heat_flux_w_m2, Warning::Heat),
            (r.dynamic_pressure_pa > limits.dynamic_pressure_pa, Warning::Overpressure),
            (r.load_g > limits.load_g, Warning::OverG),
            (flying && !r.gear_down && height < GEAR_HEIGHT_M && sinking > 0.5, Warning::GearUp),
            (r.propellant_kg.0 < LOW_PROPELLANT * r.propellant_kg.1, Warning::Propellant),
            (r.warp < r.warp_asked, Warning::WarpLowered),
        ];
        checks.into_iter().filter(|c| c.0).map(|c| c.1).collect()
    }
}

/// Heading (clockwise from north), pitch and roll (right wing down positive) against the horizon, rad.
fn heading_pitch_roll(q: glam::DQuat, up: DVec3, north: DVec3) -> [f64; 3] {
    let east = north.cross(up);
    let (nose, roof, right) = (q * DVec3::NEG_Z, q * DVec3::Y, q * DVec3::X);
    let heading = libm::atan2(nose.dot(east), nose.dot(north));
    let pitch = libm::atan2(nose.dot(up), libm::hypot(nose.dot(east), nose.dot(north)));
    let roll = libm::atan2(-right.dot(up), roof.dot(up));
    [if heading < 0.0 { heading + TAU } else { heading }, pitch, roll]
}

/// The osculating orbit [Vallado, Fundamentals of Astrodynamics, §2.5].
fn orbit(local: &Local, state: &State<Centred>) -> OrbitReadout {
    let gm = local.body.gm_m3_s2;
    let (r, v) = (state.position.0, state.velocity.0);
    let (periapsis, apoapsis) = warp::apsides(gm, state);
    let h = r.cross(v);
    let pole = local.icrf_from_fixed.raw(DVec3::Z);
    let eccentricity_vector = v.cross(h) / gm - r / r.length().max(1.0);
    let e = eccentricity_vector.length();
    let a = 1.0 / (2.0 / r.length().max(1.0) - v.length_squared() / gm);
    let rv = r.dot(v);
    let (period_s, to_periapsis_s) = if a > 0.0 && e < 1.0 {
        let motion = (gm / (a * a * a)).sqrt();
        let anomaly = libm::atan2(rv / (gm * a).sqrt(), 1.0 - r.length() / a);
        let mean = anomaly - e * libm::sin(anomaly);
        let to = if mean > 0.0 { TAU - mean } else { -mean };
        (TAU / motion, to / motion)
    } else {
        let motion = (gm / (-a * a * a).abs().max(1e-300)).sqrt();
        let sinh = rv / (e.max(1e-9) * (gm * a.abs()).sqrt());
        let anomaly = libm::asinh(sinh);
        (f64::INFINITY, -(e * sinh - anomaly) / motion)
    };
    OrbitReadout {
        apoapsis_m: apoapsis - local.body.radius_m,
        periapsis_m: periapsis - local.body.radius_m,
        period_s,
        eccentricity: e,
        inclination_rad: libm::atan2(h.cross(pole).length(), h.dot(pole)).clamp(0.0, PI),
        to_apoapsis_s: if period_s.is_finite() { (to_periapsis_s + 0.5 * period_s) % period_s } else { f64::INFINITY },
        to_periapsis_s,
    }
}
