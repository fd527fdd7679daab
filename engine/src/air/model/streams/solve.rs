//! The equation of transfer in a column, for one channel and one Fourier mode in the azimuth, under many suns at once.
//!
//! Directions are those in which one looks. With j half the sum of the light seen upwards and downwards under the same angle and h half the difference,
//! `μ dj/dz = σ h − Jₐ`, `μ dh/dz = σ j − Jₛ`, J the source function's parts that are alike and unlike in both [Schuster 1905; Feautrier 1964]. j stands in the middles
//! of layers and h between them, so that light is kept to the last digit, and where layers are many free paths deep what remains is diffusion.

use super::basis::{Basis, Matrix, STREAMS, Vector, inverse, one_plus, plus, product, times};
use core::f64::consts::PI;

/// A layer of a column, in one channel.
#[derive(Clone, Debug)]
pub struct Slab<const CLASSES: usize> {
    /// Optical depth.
    pub depth: f64,
    /// The same of what each class scatters.
    pub scattered: [f64; CLASSES],
}

/// Kernels of a class of layers.
pub struct Scatterer {
    /// Between streams: alike, unlike.
    pub kernels: [Matrix; 2],
    /// From the beam of each sun: alike, unlike.
    pub of_beam: Vec<[Vector; 2]>,
}

/// Light at the ground, in the middle of each layer, and at the top: half sums and half differences.
pub type Light = Vec<[Vector; 2]>;

/// A column's equations, eliminated from the ground up.
struct Eliminated {
    /// By layer: h above it is what `push` makes of j in it, and so much more by sun; j in it what `from` makes of what is above.
    push: Vec<Matrix>,
    from: Vec<Matrix>,
    /// Unlike scattering's matrix by layer, and over the top half of the ground's.
    unlike: Vec<Matrix>,
    ground: [Matrix; 3],
}

fn by_mu(basis: &Basis, a: &Matrix, factor: f64) -> Matrix {
    a.map(|column| core::array::from_fn(|i| column[i] * factor / basis.mu[i]))
}

fn over_mu(basis: &Basis, x: &Vector) -> Vector {
    core::array::from_fn(|i| x[i] / basis.mu[i])
}

/// Optical depth less what is scattered within a stream's own kind.
fn loss<const C: usize>(slab: &Slab<C>, classes: &[Scatterer], kind: usize) -> Matrix {
    let mut out = [[0.0; STREAMS]; STREAMS];
    for (class, scattered) in classes.iter().zip(slab.scattered) {
        for (column, k) in out.iter_mut().zip(&class.kernels[kind]) {
            *column = plus(column, k, -scattered);
        }
    }
    out.iter_mut().enumerate().for_each(|(i, column)| column[i] += slab.depth);
    out
}

fn half(a: &Matrix, b: &Matrix) -> Matrix {
    core::array::from_fn(|i| plus(&a[i], &b[i], 1.0).map(|x| 0.5 * x))
}

fn eliminate<const C: usize>(basis: &Basis, slabs: &[Slab<C>], classes: &[Scatterer], albedo: f64) -> Eliminated {
    // What the ground sends up of what comes down: alike in all directions.
    let bounce: Matrix = core::array::from_fn(|j| [2.0 * albedo * basis.weight[j] * basis.mu[j]; STREAMS]);
    let kept = one_plus(bounce.map(|column| column.map(|x| -x)));
    let unlike: Vec<Matrix> = slabs.iter().map(|s| loss(s, classes, 1)).collect();
    // h at the ground: divisor⁻¹ (kept (j + …) − bounced).
    let over_half = by_mu(basis, &unlike[0], 0.5);
    let mut divisor = one_plus(product(&kept, &over_half));
    divisor.iter_mut().zip(&bounce).for_each(|(column, b)| *column = plus(column, b, 1.0));
    let at_ground = inverse(divisor);
    let ground = product(&at_ground, &kept);
    let mut below = ground;
    let (mut push, mut from) = (Vec::with_capacity(slabs.len()), Vec::with_capacity(slabs.len()));
    for (i, slab) in slabs.iter().enumerate() {
        let gained = by_mu(basis, &loss(slab, classes, 0), 1.0);
        let here: Matrix = core::array::from_fn(|j| plus(&below[j], &gained[j], 1.0));
        let way = unlike.get(i + 1).map_or_else(|| half(&unlike[i], &[[0.0; STREAMS]; STREAMS]), |above| half(&unlike[i], above));
        // Light comes down into the last layer from nowhere: there j is −h.
        let divisor = if i + 1 < slabs.len() {
            one_plus(product(&by_mu(basis, &way, 1.0), &here))
        } else {
            one_plus(product(&one_plus(by_mu(basis, &way, 1.0)), &here))
        };
        let solved = inverse(divisor);
        below = product(&here, &solved);
        push.push(here);
        from.push(solved);
    }
    Eliminated { push, from, unlike, ground: [at_ground, ground, over_half] }
}

/// Light in a column that has been scattered at least once, under each sun. `beam` is the sunlight in each layer, by sun, and `on_ground` what of it
/// falls on level ground; both per unit of what falls onto the air across its beams.
pub fn light<const C: usize>(
    basis: &Basis,
    slabs: &[Slab<C>],
    classes: &[Scatterer],
    albedo: f64,
    beam: &[Vec<f64>],
    on_ground: &[f64],
) -> Vec<Light> {
    let all = eliminate(basis, slabs, classes, if basis.mode == 0 { albedo } else { 0.0 });
    let bounced = if basis.mode == 0 { albedo / PI } else { 0.0 };
    beam.iter().zip(on_ground).enumerate().map(|(sun, (beam, lit))| under(basis, slabs, classes, &all, sun, beam, bounced * lit)).collect()
}

fn under<const C: usize>(
    basis: &Basis,
    slabs: &[Slab<C>],
    classes: &[Scatterer],
    all: &Eliminated,
    sun: usize,
    beam: &[f64],
    bounced: f64,
) -> Light {
    let n = slabs.len();
    if beam.iter().all(|light| *light <= 0.0) {
        return vec![[[0.0; STREAMS]; 2]; n + 2];
    }
    let source = |i: usize, kind: usize| -> Vector {
        let mut q = [0.0; STREAMS];
        for (class, scattered) in classes.iter().zip(slabs[i].scattered) {
            q = plus(&q, &class.of_beam[sun][kind], scattered * beam[i]);
        }
        over_mu(basis, &q)
    };
    let unlike: Vec<Vector> = (0..n).map(|i| source(i, 1)).collect();
    let [at_ground, ground, over_half] = &all.ground;
    // From the ground up: h under layer i is `below` + a matrix by j in it.
    let mut below = plus(&times(ground, &unlike[0].map(|p| 0.5 * p)), &times(at_ground, &[bounced; STREAMS]), -1.0);
    let first = below;
    let mut steps = Vec::with_capacity(n);
    for i in 0..n {
        let here = plus(&below, &source(i, 0), -1.0);
        let last = i + 1 == n;
        let push = if last { unlike[i].map(|p| 0.5 * p) } else { plus(&unlike[i], &unlike[i + 1], 1.0).map(|p| 0.5 * p) };
        let above = all.unlike.get(i + 1);
        let mut way = times(&all.unlike[i], &here);
        if let Some(above) = above {
            way = plus(&way, &times(above, &here), 1.0);
        }
        let mut rest = plus(&push, &over_mu(basis, &way), -0.5);
        if last {
            rest = plus(&rest, &here, -1.0);
        }
        let j = times(&all.from[i], &rest);
        below = plus(&here, &times(&all.push[i], &j), 1.0);
        steps.push((here, j));
    }
    // And down again.
    let mut out = vec![[[0.0; STREAMS]; 2]; n + 2];
    let mut from_above = [0.0; STREAMS];
    let mut over = [0.0; STREAMS];
    for i in (0..n).rev() {
        let (here, rest) = &steps[i];
        let j = plus(rest, &times(&all.from[i], &from_above), 1.0);
        let h = plus(here, &times(&all.push[i], &j), 1.0);
        if i + 1 == n {
            out[n + 1] = [h.map(|h| -h), h];
        } else {
            out[i + 2][1] = plus(&[0.0; STREAMS], &plus(&h, &over, 1.0), 0.5);
        }
        out[i + 1][0] = j;
        (from_above, over) = (j, h);
    }
    let j = from_above;
    let h = plus(&first, &times(ground, &j), 1.0);
    out[1][1] = plus(&[0.0; STREAMS], &plus(&h, &over, 1.0), 0.5);
    out[0] = [plus(&plus(&j, &times(over_half, &h), -1.0), &unlike[0], 0.5), h];
    out
}
