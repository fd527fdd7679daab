//! Compositions: symplectic, time-reversible methods of fixed step, as lists of kicks and drifts, and the one loop that runs them.
//!
//! For forces that depend on positions alone. Their energy error stays bounded for as long as one cares to run; their position
//! error grows with t. A step must resolve the fastest orbit: some 20 evaluations a revolution at least. Not here: adaptive
//! methods (`gauss_radau`, `dormand_prince`), those that know Kepler's orbits (`wisdom_holman`).
//! - [Yoshida 1990] "Construction of higher order symplectic integrators", Phys. Lett. A 150, 262 (orders 4, 6, 8).
//! - [Suzuki 1990] "Fractal decomposition of exponential operators", Phys. Lett. A 146, 319 (order 4, five stages).
//! - [Kahan & Li 1997] "Composition constants for raising the orders of unconventional schemes", Math. Comp. 66, 1089 (orders 6 and 8).
//! - [Blanes & Moan 2002] "Practical symplectic partitioned Runge–Kutta and Runge–Kutta–Nyström methods", J. Comp. Appl. Math. 142, 313.

#[cfg(test)]
mod tests;

use super::sums::{Carry, carry};
use super::{Force, Points, Step, Work};
use glam::DVec3;

/// A scheme of N leapfrogs of the given sizes.
macro_rules! from_leapfrogs {
    ($name:literal, $order:literal, $count:literal, $sizes:expr) => {
        Scheme {
            name: $name,
            order: $order,
            kicks: {
                const KICKS: [f64; $count + 1] = kicks::<$count, { $count + 1 }>($sizes);
                &KICKS
            },
            drifts: {
                const DRIFTS: [f64; $count] = $sizes;
                &DRIFTS
            },
        }
    };
}

/// A method: kick, drift, kick, … kick. Lists are palindromes and each adds up to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scheme {
    /// Name in reports.
    pub name: &'static str,
    /// Order of convergence.
    pub order: u32,
    /// Kicks in steps: one more than drifts.
    pub kicks: &'static [f64],
    /// Drifts in steps: as many as evaluations of the force in a step.
    pub drifts: &'static [f64],
}

/// All schemes, by order and then by cost.
pub const SCHEMES: [Scheme; 9] = [LEAPFROG, YOSHIDA4, SUZUKI4, YOSHIDA6, KAHAN_LI6, BLANES_MOAN6, YOSHIDA8, KAHAN_LI8_15, KAHAN_LI8_17];

/// Velocity Verlet.
pub const LEAPFROG: Scheme = Scheme { name: "leapfrog", order: 2, kicks: &[0.5, 0.5], drifts: &[1.0] };

/// 1/(2 − 2^{1/3}) [Yoshida 1990, eq. 4.4; first found by Forest & Ruth].
const Y4: f64 = 1.351_207_191_959_657_5;
/// Three leapfrogs.
pub const YOSHIDA4: Scheme = from_leapfrogs!("yoshida4", 4, 3, [Y4, 1.0 - 2.0 * Y4, Y4]);

/// 1/(4 − 4^{1/3}) [Suzuki 1990, eq. 19].
const S4: f64 = 0.414_490_771_794_375_77;
/// Five leapfrogs, none backwards by more than two thirds of a step: 25 times more exact than [`YOSHIDA4`] for 5/3 of the cost.
pub const SUZUKI4: Scheme = from_leapfrogs!("suzuki4", 4, 5, [S4, S4, 1.0 - 4.0 * S4, S4, S4]);

/// Seven leapfrogs [Yoshida 1990, table 1, solution A].
pub const YOSHIDA6: Scheme =
    from_leapfrogs!("yoshida6", 6, 7, mirrored([0.784_513_610_477_56, 0.235_573_213_359_357, -1.177_679_984_178_87]));

/// Nine leapfrogs [Kahan & Li 1997, s9odr6a].
pub const KAHAN_LI6: Scheme = from_leapfrogs!(
    "kahan_li6",
    6,
    9,
    mirrored([0.392_161_444_007_314_1, 0.332_599_136_789_359_43, -0.706_246_172_557_639_3, 0.082_213_596_293_550_8])
);

/// Fifteen leapfrogs [Yoshida 1990, table 2, solution D].
pub const YOSHIDA8: Scheme = from_leapfrogs!(
    "yoshida8",
    8,
    15,
    mirrored([
        0.914_844_246_229_74,
        0.253_693_336_566_229,
        -1.444_852_236_860_48,
        -0.158_240_635_368_243,
        1.938_139_137_622_76,
        -1.960_610_232_975_49,
        0.102_799_849_391_985
    ])
);

/// Fifteen leapfrogs, better ones [Kahan & Li 1997, s15odr8].
pub const KAHAN_LI8_15: Scheme = from_leapfrogs!(
    "kahan_li8_15",
    8,
    15,
    mirrored([
        0.741_670_364_350_613,
        -0.409_100_825_800_031_6,
        0.190_754_710_296_238_4,
        -0.573_862_471_116_082_2,
        0.299_064_181_303_655_9,
        0.334_624_918_245_298_16,
        0.315_293_092_396_766_6
    ])
);

/// Seventeen leapfrogs [Kahan & Li 1997, s17odr8a].
pub const KAHAN_LI8_17: Scheme = from_leapfrogs!(
    "kahan_li8_17",
    8,
    17,
    mirrored([
        0.130_202_483_088_890_1,
        0.561_162_981_775_108_4,
        -0.389_474_962_644_847_27,
        0.158_841_906_555_155_6,
        -0.395_903_894_133_237_57,
        0.184_539_640_978_315_7,
        0.258_374_387_686_322_04,
        0.295_011_723_609_310_3
    ])
);

/// Eleven evaluations, made for y″ = f(y) and not of leapfrogs: the best of order 6 [Blanes & Moan 2002, SRKN₁₁ᵇ, table 3].
pub const BLANES_MOAN6: Scheme = Scheme { name: "blanes_moan6", order: 6, kicks: &BM6_KICKS, drifts: &BM6_DRIFTS };
const BM6_B: [f64; 5] =
    [0.041_464_998_518_262_4, 0.198_128_671_918_067, -0.040_006_192_104_153_3, 0.075_253_984_301_580_7, -0.011_511_387_420_687_9];
const BM6_A: [f64; 5] =
    [0.123_229_775_946_271, 0.290_553_797_799_558, -0.127_049_212_625_417, -0.246_331_761_062_075, 0.357_208_872_795_928];
const BM6_KICKS: [f64; 12] = {
    let b = BM6_B;
    let middle = 0.5 - (b[0] + b[1] + b[2] + b[3] + b[4]);
    [b[0], b[1], b[2], b[3], b[4], middle, middle, b[4], b[3], b[2], b[1], b[0]]
};
const BM6_DRIFTS: [f64; 11] = mirrored(BM6_A);

/// w₁ … w_m, then what makes the sum 1, then w_m … w₁.
const fn mirrored<const M: usize, const N: usize>(half: [f64; M]) -> [f64; N] {
    let mut all = [0.0; N];
    let mut sum = 0.0;
    let mut i = 0;
    while i < M {
        all[i] = half[i];
        all[N - 1 - i] = half[i];
        sum += half[i];
        i += 1;
    }
    all[M] = 1.0 - 2.0 * sum;
    all
}

/// The kicks of leapfrogs one after the other: half of each of two neighbours.
const fn kicks<const N: usize, const K: usize>(steps: [f64; N]) -> [f64; K] {
    let mut all = [0.0; K];
    all[0] = 0.5 * steps[0];
    all[N] = 0.5 * steps[N - 1];
    let mut i = 1;
    while i < N {
        all[i] = 0.5 * (steps[i - 1] + steps[i]);
        i += 1;
    }
    all
}

/// The loop: a scheme, a step, and what rounding drops where that is asked for.
#[derive(Clone, Debug)]
pub struct Composition {
    scheme: Scheme,
    dt: f64,
    compensated: bool,
    low: Carry,
    a: Vec<DVec3>,
    /// True when `a` is that of the points as the last step left them.
    fresh: bool,
    work: Work,
}

impl Composition {
    /// For `n` points and steps of `dt` (its sign is that of the way). `compensated` carries along what rounding drops of positions
    /// and velocities: the energy's random walk shrinks, at some 10 operations a coordinate.
    pub fn new(scheme: Scheme, n: usize, dt: f64, compensated: bool) -> Self {
        let mut low = Carry::default();
        low.fit(n);
        Self { scheme, dt: dt.abs(), compensated, low, a: vec![DVec3::ZERO; n], fresh: false, work: Work::default() }
    }

    /// What must be saved beside the points for a restart with the same bits.
    pub fn memory(&self) -> &Carry {
        &self.low
    }

    /// Goes on where `memory` was saved, with the points of that moment.
    pub fn resume(&mut self, memory: Carry) {
        self.low = memory;
        self.fresh = false;
    }

    /// What all steps so far have cost.
    pub fn work(&self) -> Work {
        self.work
    }

    /// Steps to `t_end`. All are of the same size but the last, where the span is no multiple of the step: cutting often ruins
    /// what a symplectic method is for.
    pub fn run<F: Force>(&mut self, force: &F, points: &mut Points, t_end: f64) -> Work {
        let before = self.work;
        while self.step(force, points, t_end) == Step::Made {}
        Work { steps: self.work.steps - before.steps, rejected: 0, evaluations: self.work.evaluations - before.evaluations }
    }

    /// One step towards `t_end`, cut so that it never passes it. The points must be as the last step left them.
    pub fn step<F: Force>(&mut self, force: &F, points: &mut Points, t_end: f64) -> Step {
        const { assert!(!F::USES_VELOCITY, "a kick that depends on the velocity is neither symplectic nor of the scheme's order") };
        let left = self.low.left(points, t_end);
        if left == 0.0 {
            return Step::Arrived;
        }
        let n = points.q.len();
        if self.a.len() != n || points.v.len() != n {
            self.low.fit(n);
            self.a.resize(n, DVec3::ZERO);
            points.v.resize(n, DVec3::ZERO);
            self.fresh = false;
        }
        // A last step that is longer by rounding alone is a whole one.
        let dt = if self.dt < left.abs() * (1.0 - 1e-9) { self.dt.copysign(left) } else { left };
        if !dt.is_finite() || dt == 0.0 {
            return Step::Stalled;
        }
        if !self.fresh {
            self.evaluate(force, points.t, points);
        }
        let start = points.t;
        self.low.pass(points, dt);
        let (mut at, count) = (0.0, self.scheme.drifts.len());
        for (i, (kick, drift)) in self.scheme.kicks.iter().zip(self.scheme.drifts).enumerate() {
            self.kick(points, kick * dt);
            self.drift(points, drift * dt);
            at += drift;
            // The last is at the end to the bit, so that a restart finds the same.
            self.evaluate(force, if i + 1 == count { points.t } else { start + at * dt }, points);
        }
        self.kick(points, self.scheme.kicks[count] * dt);
        self.fresh = true;
        self.work.steps += 1;
        Step::Made
    }

    fn evaluate<F: Force>(&mut self, force: &F, t: f64, points: &Points) {
        force.accelerations(t, &points.q, &points.v, &mut self.a);
        self.work.evaluations += 1;
    }

    fn kick(&mut self, points: &mut Points, dt: f64) {
        add(self.compensated, &mut points.v, &mut self.low.v, &self.a, dt);
    }

    fn drift(&mut self, points: &mut Points, dt: f64) {
        add(self.compensated, &mut points.q, &mut self.low.q, &points.v, dt);
    }
}

/// sums += rates·dt.
fn add(compensated: bool, sums: &mut [DVec3], low: &mut [f64], rates: &[DVec3], dt: f64) {
    if compensated {
        let flat: &mut [f64] = bytemuck::cast_slice_mut(sums);
        for ((sum, low), rate) in flat.iter_mut().zip(low).zip(bytemuck::cast_slice::<_, f64>(rates)) {
            carry(sum, low, rate * dt);
        }
    } else {
        for (sum, rate) in sums.iter_mut().zip(rates) {
            *sum += *rate * dt;
        }
    }
}
