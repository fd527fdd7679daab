//! Recurrence: the Taylor coefficients of a ship's path under exactly the forces that count, order by order.
//!
//! In units of time chosen for the step (a power of two, so that scaling never rounds): x″ = Σ of
//! - the host as a point: `−μ x/r³`;
//! - its J₂, J₃, J₄ about the pole p̂: `Jₙ` gives `μJₙRⁿ [P′ₙ₊₁(s) x/rⁿ⁺³ − P′ₙ(s) p̂/rⁿ⁺²]`, s = x·p̂/r, the gradient of its
//!   potential [Montenbruck & Gill 2000, §3.2], written in s² so that only r⁻³ and r⁻² are powers;
//! - its 1PN term `μ/c²r³ [(4μ/r − v²) x + 4 (x·v) v]` [Montenbruck & Gill 2000, eq. 3.146];
//! - third bodies as tides: `μ (d/d³ − p/p³)`, d = p − x, p a polynomial in time. The difference cancels by r/p; what it leaves
//!   is |μ/p²| ε ≈ 1e-18 m/s² for the Sun's pull on the Earth's ships, four orders under the least term that counts;
//! - radiation pressure as so much less pull of the star on the ship (but not on the host) [Burns, Lamy & Soter 1979, eq. 5];
//! - thrust of a fixed direction, with the mass falling linearly.
//!
//! Not here: which of them count ([`crate::orbit::field`]), how long a step is ([`super::step`]).
//! - [Montenbruck & Gill 2000] "Satellite Orbits".
//! - [Burns, Lamy & Soter 1979] "Radiation forces on small particles in the solar system", Icarus 40, 1.

use super::series::{LEN, ORDER, Scalar, Vector, index};
use crate::orbit::integrate::series::{inverse_cube as cube, norm_squared as square, power, product, scaled, square as squared};
use glam::DVec3;

/// Speed of light, m/s (exact).
const LIGHT_M_S: f64 = 299_792_458.0;

/// A third body in one step.
#[derive(Clone, Debug)]
pub struct Third {
    /// Pull on the ship, m³/s²: its GM, less what radiation takes off.
    pub gm_on_ship: f64,
    /// Pull on the host: its GM, m³/s².
    pub gm_on_host: f64,
    /// Its position from the host in the step's unit of time.
    pub position: Vector,
    /// From the ship.
    distance: Vector,
    /// The squares of both, and their powers −3/2.
    squares: [Scalar; 2],
    cubes: [Scalar; 2],
    /// Coefficients of its pull on the host that came out below rounding in a row.
    silent: u32,
    /// Size of the first of them, m⁻².
    loudest: f64,
}

/// So many coefficients of p/p³ in a row below 1e-20 of the first, over eight units of time, end the series.
const SILENCE: u32 = 4;

impl Third {
    /// A body at `position` (polynomial in the step's unit of time, which a step exceeds at most eightfold).
    pub fn new(gm_on_ship: f64, gm_on_host: f64, position: Vector) -> Self {
        let zero = [[0.0; LEN]; 2];
        let (silent, loudest) = (0, 0.0);
        Self { gm_on_ship, gm_on_host, position, distance: [DVec3::ZERO; LEN], squares: zero, cubes: zero, silent, loudest }
    }

    /// k-th coefficient of its tide, less the constant factor of the unit of time. `x` is known up to k.
    fn tide(&mut self, x: &Vector, k: usize) -> DVec3 {
        self.distance[k] = self.position[k] - x[k];
        self.squares[0][k] = square(&self.distance, k);
        self.cubes[0][k] = cube(&self.squares[0], &self.cubes[0], k);
        let direct = scaled(&self.cubes[0], &self.distance, k) * self.gm_on_ship;
        if self.silent >= SILENCE {
            return direct;
        }
        self.squares[1][k] = square(&self.position, k);
        self.cubes[1][k] = cube(&self.squares[1], &self.cubes[1], k);
        let indirect = scaled(&self.cubes[1], &self.position, k);
        let size = indirect.abs().max_element() * EIGHT_TO[k];
        self.loudest = self.loudest.max(size);
        self.silent = if size <= 1e-20 * self.loudest { self.silent + 1 } else { 0 };
        direct - indirect * self.gm_on_host
    }

    /// The squared distance from the ship, m², as a polynomial.
    pub fn distance_squared(&self) -> &Scalar {
        &self.squares[0]
    }
}

/// Powers of eight.
const EIGHT_TO: Scalar = {
    let mut list = [1.0; LEN];
    let mut k = 1;
    while k < LEN {
        list[k] = 8.0 * list[k - 1];
        k += 1;
    }
    list
};

/// Thrust over a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Thrust {
    /// Acceleration at the start of the step, ICRF axes, m/s².
    pub acceleration: DVec3,
    /// Its relative growth per second then: mass flow over mass, 1/s.
    pub growth_per_s: f64,
}

/// What acts on the ship in one step.
#[derive(Clone, Debug, Default)]
pub struct Forces {
    /// GM of the host (less what radiation takes off, where it is the star), m³/s².
    pub gm: f64,
    /// `μ Jₙ Rⁿ` for n = 2, 3, 4; what does not count is zero.
    pub zonal: [f64; 3],
    /// The host's pole at the start of the step (unit vector, ICRF axes) and its rate, 1/s.
    pub pole: [DVec3; 2],
    /// The host's 1PN term counts.
    pub relativity: bool,
    /// Bodies whose tides count.
    pub thirds: Vec<Third>,
    /// Thrust, if any.
    pub thrust: Option<Thrust>,
}

/// Series of the host's field that the coefficients are made of.
struct Host {
    gm: f64,
    zonal: [f64; 3],
    pole: [DVec3; 2],
    /// c² in the step's unit of time; none where 1PN does not count.
    light_squared: Option<f64>,
    /// r⁻³.
    cube: Scalar,
    // Of zonals: z = x·p̂, r⁻², z², s², s⁴ …
    z: Scalar,
    inverse: Scalar,
    z_squared: Scalar,
    s_squared: Scalar,
    s_fourth: Scalar,
    /// r⁻⁵ and r⁻⁷.
    fifth: Scalar,
    seventh: Scalar,
    /// P′₃ and P′₄/s, P′₅ as polynomials of s².
    legendre: [Scalar; 3],
    /// r⁻⁵P′₃, z r⁻⁷, along the pole.
    even: Scalar,
    odd: Scalar,
    along_pole: Scalar,
    // Of 1PN: v, 4μ/r − v², x·v/r³.
    velocity: Vector,
    speed: Scalar,
    climb: Scalar,
    fall: Scalar,
    /// What multiplies x.
    along_x: Scalar,
}

/// The path's coefficients from `x[0]` and `x[1]` on: position in powers of the time since the start of the step in units of
/// `unit_s`, and r² likewise.
pub fn coefficients(forces: &mut Forces, unit_s: f64, x: &mut Vector, r_squared: &mut Scalar) {
    let u2 = unit_s * unit_s;
    let zero = [0.0; LEN];
    let [z, inverse, z_squared, s_squared, s_fourth, fifth, seventh, even, odd, along_pole, speed, climb, fall, along_x] = [zero; 14];
    let mut host = Host {
        gm: forces.gm,
        zonal: forces.zonal,
        pole: [forces.pole[0], forces.pole[1] * unit_s],
        light_squared: forces.relativity.then_some(LIGHT_M_S * LIGHT_M_S * u2),
        cube: zero,
        z,
        inverse,
        z_squared,
        s_squared,
        s_fourth,
        fifth,
        seventh,
        legendre: [zero; 3],
        even,
        odd,
        along_pole,
        velocity: [DVec3::ZERO; LEN],
        speed,
        climb,
        fall,
        along_x,
    };
    let mut thrust = forces.thrust.map_or(DVec3::ZERO, |t| t.acceleration);
    let growth = forces.thrust.map_or(0.0, |t| t.growth_per_s * unit_s);
    for k in 0..ORDER - 1 {
        r_squared[k] = square(x, k);
        let mut a = host.acceleration(x, r_squared, u2, k);
        for third in &mut forces.thirds {
            a += third.tide(x, k);
        }
        // a/(1 − growth t) as its geometric series.
        a += thrust;
        thrust *= growth;
        x[k + 2] = a * u2 / (index(k + 1) * index(k + 2));
    }
    for k in ORDER - 1..LEN {
        r_squared[k] = square(x, k);
        for third in &mut forces.thirds {
            third.distance[k] = third.position[k] - x[k];
            third.squares[0][k] = square(&third.distance, k);
        }
    }
}

impl Host {
    /// k-th coefficient of the host's pull.
    fn acceleration(&mut self, x: &Vector, r2: &Scalar, u2: f64, k: usize) -> DVec3 {
        self.cube[k] = cube(r2, &self.cube, k);
        self.along_x[k] = -self.gm * self.cube[k];
        let mut a = DVec3::ZERO;
        if self.zonal != [0.0; 3] {
            a += self.flattening(x, r2, k);
        }
        if let Some(c2) = self.light_squared {
            a += self.relativity(x, r2, c2, u2, k);
        }
        a + scaled(&self.along_x, x, k)
    }

    /// What J₂ … J₄ add to the factor of x; returned is the part along the pole.
    fn flattening(&mut self, x: &Vector, r2: &Scalar, k: usize) -> DVec3 {
        let before = |s: &Vector| if k > 0 { s[k - 1] } else { DVec3::ZERO };
        self.z[k] = x[k].dot(self.pole[0]) + before(x).dot(self.pole[1]);
        self.inverse[k] = if k == 0 { 1.0 / r2[0] } else { power(r2, &self.inverse, -1.0, k) };
        self.z_squared[k] = squared(&self.z, k);
        self.s_squared[k] = product(&self.z_squared, &self.inverse, k);
        self.fifth[k] = product(&self.cube, &self.inverse, k);
        let one = if k == 0 { 1.0 } else { 0.0 };
        self.legendre[0][k] = 7.5 * self.s_squared[k] - 1.5 * one;
        self.even[k] = product(&self.fifth, &self.legendre[0], k);
        let [j2, j3, j4] = self.zonal;
        self.along_x[k] += j2 * self.even[k];
        let mut pole = -3.0 * j2 * product(&self.z, &self.fifth, k);
        if j3 != 0.0 || j4 != 0.0 {
            self.seventh[k] = product(&self.fifth, &self.inverse, k);
            self.s_fourth[k] = squared(&self.s_squared, k);
            self.odd[k] = product(&self.z, &self.seventh, k);
            self.legendre[1][k] = 17.5 * self.s_squared[k] - 7.5 * one;
            self.legendre[2][k] = 39.375 * self.s_fourth[k] - 26.25 * self.s_squared[k] + 1.875 * one;
            let odd = product(&self.odd, &self.legendre[1], k);
            self.along_x[k] += j3 * odd + j4 * product(&self.seventh, &self.legendre[2], k);
            pole -= j3 * self.even[k] + j4 * odd;
        }
        self.along_pole[k] = pole;
        let late = if k > 0 { self.along_pole[k - 1] } else { 0.0 };
        self.pole[0] * pole + self.pole[1] * late
    }

    /// What 1PN adds to the factor of x; returned is the part along v.
    fn relativity(&mut self, x: &Vector, r2: &Scalar, c2: f64, u2: f64, k: usize) -> DVec3 {
        let n = index(k + 1);
        self.velocity[k] = x[k + 1] * n;
        // In units of the step: μ becomes μu².
        let gm = self.gm * u2;
        self.speed[k] = 4.0 * gm * product(r2, &self.cube, k) - square(&self.velocity, k);
        // x·v = ½ d(r²)/dt, whose next coefficient needs x up to k + 1 only.
        self.climb[k] = 0.5 * n * square(x, k + 1);
        self.fall[k] = product(&self.cube, &self.climb, k);
        let scale = self.gm / c2;
        self.along_x[k] += scale * product(&self.cube, &self.speed, k);
        scaled(&self.fall, &self.velocity, k) * (4.0 * scale)
    }
}

#[cfg(test)]
mod tests {
    use super::super::series::value;
    use super::*;
    use crate::orbit::gravity;
    use crate::space::{Centred, Position};

    const GM: f64 = 3.986_004_355_07e14;
    const RADIUS: f64 = 6.378_136_3e6;

    /// Acceleration of the polynomial at `t` units, and place and velocity there.
    fn at(x: &Vector, unit_s: f64, t: f64) -> (DVec3, DVec3, DVec3) {
        let derivative =
            |x: &Vector| -> Vector { core::array::from_fn(|k| if k < ORDER { x[k + 1] * (index(k + 1) / unit_s) } else { DVec3::ZERO }) };
        let v = derivative(x);
        (value(&derivative(&v), 0, t), value(x, 0, t), value(&v, 0, t))
    }

    fn run(forces: &mut Forces) -> (Vector, f64) {
        let unit_s = 512.0;
        let mut x = [DVec3::ZERO; LEN];
        (x[0], x[1]) = (DVec3::new(6.6e6, -1.9e6, 1.2e6), DVec3::new(1.4e3, 6.1e3, 4.3e3) * unit_s);
        coefficients(forces, unit_s, &mut x, &mut [0.0; LEN]);
        (x, unit_s)
    }

    fn point(x: DVec3) -> DVec3 {
        gravity::point_mass(GM, Position::<Centred>::new(x)).0
    }

    #[test]
    fn zonals_are_the_gradient_of_their_potential_along_the_whole_step() {
        let pole = DVec3::new(0.1, -0.2, 1.0).normalize();
        let j = [1.082_6e-3, -2.5e-5, -1.6e-5];
        let zonal = [0, 1, 2].map(|k| j[k] * GM * libm::pow(RADIUS, k as f64 + 2.0));
        let mut forces = Forces { gm: GM, zonal, pole: [pole, DVec3::ZERO], ..Forces::default() };
        let (x, unit_s) = run(&mut forces);
        let potential = |p: DVec3| {
            let (r, s) = (p.length(), p.dot(pole) / p.length());
            let legendre = [0.5 * (3.0 * s * s - 1.0), 0.5 * s * (5.0 * s * s - 3.0), (s * s * (35.0 * s * s - 30.0) + 3.0) / 8.0];
            (0..3).map(|k| -GM / r * j[k] * libm::pow(RADIUS / r, k as f64 + 2.0) * legendre[k]).sum::<f64>()
        };
        for t in [0.0, 0.2, 0.5] {
            let (a, p, _) = at(&x, unit_s, t);
            let d = 20.0;
            let slope = [DVec3::X, DVec3::Y, DVec3::Z].map(|e| {
                (8.0 * (potential(p + e * d) - potential(p - e * d)) - (potential(p + e * 2.0 * d) - potential(p - e * 2.0 * d)))
                    / (12.0 * d)
            });
            let expected = point(p) + DVec3::from_array(slope);
            // J₄ alone is 2e-4 of 1e-2 m/s².
            assert!((a - expected).length() < 3e-10, "{t}: {}", (a - expected).length());
        }
        // J₂ by the closed form that powered flight uses.
        forces.zonal = [zonal[0], 0.0, 0.0];
        let (x, unit_s) = run(&mut forces);
        let (a, p, _) = at(&x, unit_s, 0.5);
        assert!((a - point(p) - gravity::j2(GM, j[0], RADIUS, pole, Position::<Centred>::new(p)).0).length() < 1e-14 * 20.0);
    }

    #[test]
    fn a_turning_pole_is_followed() {
        let pole = [DVec3::Z, DVec3::new(1e-5, 0.0, 0.0)];
        let mut forces = Forces { gm: GM, zonal: [1.08e-3 * GM * RADIUS * RADIUS, 0.0, 0.0], pole, ..Forces::default() };
        let (x, unit_s) = run(&mut forces);
        let (a, p, _) = at(&x, unit_s, 0.5);
        let now = pole[0] + pole[1] * (0.5 * unit_s);
        // Not renormalised: (1e-5 × 256)²/2 of J₂.
        let expected = point(p) + gravity::j2(GM, 1.08e-3, RADIUS, now, Position::<Centred>::new(p)).0;
        assert!((a - expected).length() < 1e-2 * 4e-6, "{}", (a - expected).length());
    }

    #[test]
    fn tides_are_those_of_battins_form() {
        let (gm, place, drift) = (4.902_8e12, DVec3::new(3.1e8, 2.2e8, -0.7e8), DVec3::new(-500.0, 800.0, 10.0));
        let mut position = [DVec3::ZERO; LEN];
        (position[0], position[1]) = (place, drift * 512.0);
        let mut forces = Forces { gm: GM, thirds: vec![Third::new(gm, gm, position)], ..Forces::default() };
        let (x, unit_s) = run(&mut forces);
        for t in [0.0, 0.5] {
            let (a, p, _) = at(&x, unit_s, t);
            let moon = Position::<Centred>::new(place + drift * (t * unit_s));
            let tide = gravity::tide(gm, moon, Position::new(p)).0;
            assert!((a - point(p) - tide).length() < 1e-14, "{t}: {}", (a - point(p) - tide).length());
            let gap = (moon.0 - p).length_squared();
            let told = forces.thirds[0].distance_squared().iter().rev().fold(0.0, |s, c| s * t + c);
            assert!((told / gap - 1.0).abs() < 1e-15 * 8.0);
        }
    }

    #[test]
    fn relativity_is_schwarzschilds_and_moves_the_perihelion() {
        let mut forces = Forces { gm: GM, relativity: true, ..Forces::default() };
        let (x, unit_s) = run(&mut forces);
        for t in [0.0, 0.5] {
            let (a, p, v) = at(&x, unit_s, t);
            let (r, c2) = (p.length(), LIGHT_M_S * LIGHT_M_S);
            let expected = (p * (4.0 * GM / r - v.length_squared()) + v * (4.0 * p.dot(v))) * (GM / (c2 * r * r * r));
            assert!((a - point(p) - expected).length() < 1e-6 * expected.length(), "{t}");
        }
    }

    #[test]
    fn thrust_grows_as_the_mass_falls() {
        let thrust = Thrust { acceleration: DVec3::new(0.0, 0.0, 2.0), growth_per_s: 2e-4 };
        let mut forces = Forces { gm: GM, thrust: Some(thrust), ..Forces::default() };
        let (x, unit_s) = run(&mut forces);
        let (a, p, _) = at(&x, unit_s, 0.5);
        let expected = thrust.acceleration / (1.0 - 2e-4 * 0.5 * unit_s);
        assert!((a - point(p) - expected).length() < 1e-13 * 20.0);
    }
}
