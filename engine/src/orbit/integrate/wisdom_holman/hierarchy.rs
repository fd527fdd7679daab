//! Hierarchy: who goes around whom, as a tree of pairs; and the coordinates that belong to it.
//!
//! Bodies are leaves; a join is a pair of bodies or of joins before it. Its coordinate is the vector from the first's centre of mass to the
//! second's: Jacobi's coordinates for a chain, and for moons about planets about a star those in which all orbits are nearly Kepler's
//! [Beust 2003, §2]. Not here: how they move (`wisdom_holman`).

use glam::DVec3;

/// A tree of pairs over n bodies. Body i is node i; join k is node n + k.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hierarchy {
    joins: Vec<(usize, usize)>,
}

impl Hierarchy {
    /// Jacobi's coordinates in the order of the bodies: each goes around the centre of mass of all before it.
    pub fn chain(bodies: usize) -> Self {
        Self { joins: (1..bodies).map(|i| (if i == 1 { 0 } else { bodies + i - 2 }, i)).collect() }
    }

    /// From the body that each goes around (`None` for the root, which is taken once). Satellites of one body are listed inner first;
    /// a body's own satellites are joined to it before it is to its parent. `None` where that is no tree.
    pub fn from_parents(parents: &[Option<usize>]) -> Option<Self> {
        let n = parents.len();
        let root = parents.iter().position(Option::is_none)?;
        // Depths settle in n rounds unless there is a ring.
        let depth = |mut i: usize| {
            let mut depth = 0;
            while let Some(parent) = *parents.get(i)? {
                (i, depth) = (parent, depth + 1);
                if depth > n {
                    return None;
                }
            }
            (i == root).then_some(depth)
        };
        let depths = (0..n).map(depth).collect::<Option<Vec<_>>>()?;
        let mut node: Vec<usize> = (0..n).collect();
        let mut joins = Vec::new();
        for level in (1..=depths.iter().copied().max()?).rev() {
            for i in (0..n).filter(|i| depths[*i] == level) {
                let parent = parents[i]?;
                joins.push((node[parent], node[i]));
                node[parent] = n + joins.len() - 1;
            }
        }
        Some(Self { joins })
    }

    /// Found by osculating periods: of all pairs of what is left, the one that goes around fastest is joined first; pairs that are not
    /// bound come last, nearest first. `gm`, `q` and `v` are of one length.
    pub fn by_period(gm: &[f64], q: &[DVec3], v: &[DVec3]) -> Self {
        let n = gm.len();
        let mut open: Vec<(usize, f64, DVec3, DVec3)> = (0..n).map(|i| (i, gm[i], q[i], v[i])).collect();
        let mut joins = Vec::new();
        while open.len() > 1 {
            let mut best = (2, f64::INFINITY, 0, 1);
            for b in 1..open.len() {
                for a in 0..b {
                    let (mu, r) = (open[a].1 + open[b].1, (open[b].2 - open[a].2).length());
                    let beta = 2.0 * mu / r - (open[b].3 - open[a].3).length_squared();
                    // mu/beta is the semi-major axis; its cube over mu goes with the period squared.
                    let key = if mu > 0.0 && beta > 0.0 { (0, mu * mu / (beta * beta * beta)) } else { (1, r) };
                    if (key.0, key.1) < (best.0, best.1) {
                        best = (key.0, key.1, a, b);
                    }
                }
            }
            let (_, _, a, b) = best;
            let second = open.remove(b);
            let first = open[a];
            // The heavier first: its satellite's vector points to the satellite.
            let (first, second) = if second.1 > first.1 { (second, first) } else { (first, second) };
            joins.push((first.0, second.0));
            let mass = first.1 + second.1;
            let share = if mass > 0.0 { second.1 / mass } else { 0.0 };
            open[a] = (n + joins.len() - 1, mass, first.2 + (second.2 - first.2) * share, first.3 + (second.3 - first.3) * share);
        }
        Self { joins }
    }

    /// Pairs of nodes, each after those that it joins.
    pub fn joins(&self) -> &[(usize, usize)] {
        &self.joins
    }
}

/// A join with what its bodies weigh.
#[derive(Clone, Debug)]
pub(super) struct Join {
    /// Gravitational parameter of both together.
    pub gm: f64,
    /// The second's part of that.
    pub share: f64,
    /// The nodes that it joins.
    pub nodes: (usize, usize),
    /// Bodies of the first and of the second, each with its part of its side.
    pub first: Vec<(usize, f64)>,
    /// See `first`.
    pub second: Vec<(usize, f64)>,
}

/// All joins of a hierarchy over bodies of `gm`.
pub(super) fn weigh(hierarchy: &Hierarchy, gm: &[f64]) -> Vec<Join> {
    // Of each node: its parameter and its bodies with their parts.
    let mut nodes: Vec<(f64, Vec<(usize, f64)>)> = gm.iter().enumerate().map(|(i, gm)| (*gm, vec![(i, 1.0)])).collect();
    let mut joins = Vec::new();
    for (a, b) in &hierarchy.joins {
        let ((gm_a, first), (gm_b, second)) = (nodes[*a].clone(), nodes[*b].clone());
        let total = gm_a + gm_b;
        let share = if total > 0.0 { gm_b / total } else { 0.0 };
        let all =
            first.iter().map(|(i, part)| (*i, part * (1.0 - share))).chain(second.iter().map(|(i, part)| (*i, part * share))).collect();
        nodes.push((total, all));
        joins.push(Join { gm: total, share, nodes: (*a, *b), first, second });
    }
    joins
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parents_become_a_tree_with_moons_first() {
        // Sun, Mercury, Earth, Moon, Mars: the Moon joins the Earth before that joins the Sun with Mercury.
        let tree = Hierarchy::from_parents(&[None, Some(0), Some(0), Some(2), Some(0)]).unwrap();
        assert_eq!(tree.joins(), [(2, 3), (0, 1), (6, 5), (7, 4)]);
        assert_eq!(Hierarchy::chain(4).joins(), [(0, 1), (4, 2), (5, 3)]);
        assert_eq!(Hierarchy::from_parents(&[None, Some(0), Some(0), Some(0)]), Some(Hierarchy::chain(4)));
        for bad in [vec![Some(0)], vec![None, None], vec![None, Some(2), Some(1)], vec![None, Some(9)], vec![]] {
            assert_eq!(Hierarchy::from_parents(&bad), None, "{bad:?}");
        }
    }

    #[test]
    fn periods_find_the_same_tree() {
        // Sun, Moon, Earth, Mercury in AU and days, roughly; the order of the list does not matter.
        let gm = [2.96e-4, 1.09e-11, 8.89e-10, 4.9e-11];
        let q = [DVec3::ZERO, DVec3::new(1.00257, 0.0, 0.0), DVec3::X, DVec3::Y * 0.387];
        let v = [DVec3::ZERO, DVec3::Y * 0.01778, DVec3::Y * 0.0172, DVec3::X * -0.0276];
        assert_eq!(Hierarchy::by_period(&gm, &q, &v).joins(), [(2, 1), (0, 3), (5, 4)]);
    }
}
