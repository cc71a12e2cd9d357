//! Positions at which all rows hold, found numerically while a text is compiled.
//!
//! Parameters, time and inputs vary as coordinates do. So the results hold for every design, and redundant rows agree.

use std::collections::{BTreeMap, BTreeSet};

use crate::symbolic::evaluate::evaluate;
use crate::symbolic::{Graph, Leaf, Node, NodeId, tangents};

/// Most iterations of Newton's method, which doubles the digits in each once it is near.
const ITERATIONS: usize = 30;
/// Largest step of one, in the units of the text: angles beyond a radian are another place.
const LARGEST_STEP: f64 = 1.0;
/// Step size that ends the search: the next change would be rounding.
const SMALLEST_STEP: f64 = 1e-9;
/// Largest residual of a row that counts as closed, in its unit, where lengths and angles are near 1.
const CLOSED: f64 = 1e-11;
/// A row of which less than this share is its own follows from earlier ones.
const DEPENDENT: f64 = 1e-8;

/// A value a leaf.
pub type Point = BTreeMap<Leaf, f64>;

/// The rows of a text with their slopes along all that they depend on.
pub struct Manifold {
    leaves: Vec<Leaf>,
    /// Residuals, then the slopes that are no structural zeros.
    roots: Vec<NodeId>,
    /// Row and leaf of each slope.
    places: Vec<(usize, usize)>,
    rows: usize,
}

impl Manifold {
    /// Before: residuals of rows. After: the data for Newton's method on them.
    pub fn of(g: &mut Graph, residuals: &[NodeId]) -> Self {
        let moves = |id: &NodeId| match g.node(*id) {
            Node::Leaf(leaf @ (Leaf::Position(_) | Leaf::Parameter(_) | Leaf::Input(_) | Leaf::Time)) => {
                Some(leaf)
            }
            _ => None,
        };
        let leaves: BTreeSet<Leaf> =
            g.reachable(residuals.iter().copied()).iter().filter_map(moves).collect();
        let leaves: Vec<Leaf> = leaves.into_iter().collect();
        let slopes = tangents(g, residuals, &leaves);
        let mut roots = residuals.to_vec();
        let mut places = Vec::new();
        for (row, slopes) in slopes.into_iter().enumerate() {
            for (leaf, slope) in slopes {
                roots.push(slope);
                places.push((row, leaf));
            }
        }
        Manifold { leaves, roots, places, rows: residuals.len() }
    }

    /// Multiplications of one search at most.
    pub fn work(&self) -> usize {
        (self.rows * self.rows * self.leaves.len()).saturating_mul(ITERATIONS)
    }

    /// The position that Newton's method finds from `start`, by shortest steps; `None` where it finds none.
    pub fn point(&self, g: &Graph, start: impl Fn(Leaf) -> f64) -> Option<Point> {
        let mut point: Point = self.leaves.iter().map(|leaf| (*leaf, start(*leaf))).collect();
        for _ in 0..ITERATIONS {
            let values =
                evaluate(g, &self.roots, |leaf| point.get(&leaf).copied().unwrap_or_else(|| start(leaf)));
            let residuals = values.get(..self.rows)?;
            if !values.iter().all(|value| value.is_finite()) {
                return None;
            }
            let mut rows = vec![vec![0.0; self.leaves.len()]; self.rows];
            for ((row, leaf), slope) in self.places.iter().zip(values.iter().skip(self.rows)) {
                *rows.get_mut(*row)?.get_mut(*leaf)? = *slope;
            }
            let step = shortest(rows, residuals);
            let length = libm::sqrt(dot(&step, &step));
            let share = if length > LARGEST_STEP { LARGEST_STEP / length } else { 1.0 };
            for (leaf, step) in self.leaves.iter().zip(&step) {
                *point.entry(*leaf).or_default() -= share * step;
            }
            if length < SMALLEST_STEP {
                let closed = residuals.iter().all(|residual| residual.abs() < CLOSED.max(length));
                return closed.then_some(point);
            }
        }
        None
    }
}

/// Rows made orthogonal and of length 1; those that follow from earlier ones are left out.
#[derive(Default)]
pub struct Orthogonal(Vec<Vec<f64>>);

impl Orthogonal {
    /// Before: a row. After: it is among them, unless it follows; returns its components along the earlier ones, and the
    /// length of the rest, 0 where it follows.
    pub fn add(&mut self, mut row: Vec<f64>) -> (Vec<f64>, f64) {
        let before = libm::sqrt(dot(&row, &row));
        let shares = self.take_from(&mut row);
        let rest = libm::sqrt(dot(&row, &row));
        if rest <= DEPENDENT * before {
            return (shares, 0.0);
        }
        row.iter_mut().for_each(|entry| *entry /= rest);
        self.0.push(row);
        (shares, rest)
    }

    /// Number of these rows.
    pub fn rank(&self) -> usize {
        self.0.len()
    }

    /// Subtracts from a row its components along these, twice for the last digits; returns the components.
    pub fn take_from(&self, row: &mut [f64]) -> Vec<f64> {
        let mut shares = vec![0.0; self.0.len()];
        for _ in 0..2 {
            for (known, total) in self.0.iter().zip(&mut shares) {
                let share = dot(known, row);
                *total += share;
                row.iter_mut().zip(known).for_each(|(entry, known)| *entry -= share * known);
            }
        }
        shares
    }
}

/// The shortest x with A x = b, of the rows of A that do not follow from earlier ones.
fn shortest(rows: Vec<Vec<f64>>, b: &[f64]) -> Vec<f64> {
    let mut x = vec![0.0; rows.first().map_or(0, Vec::len)];
    let mut orthogonal = Orthogonal::default();
    // Component of x along each, by forward substitution.
    let mut along: Vec<f64> = Vec::new();
    for (row, b) in rows.into_iter().zip(b) {
        let (shares, rest) = orthogonal.add(row);
        if rest > 0.0 {
            along.push((b - dot(&shares, &along)) / rest);
        }
    }
    for (row, along) in orthogonal.0.iter().zip(&along) {
        x.iter_mut().zip(row).for_each(|(x, entry)| *x += along * entry);
    }
    x
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of which `share` is its own, next to a first one.
    fn nearly(share: f64) -> (Orthogonal, Vec<f64>) {
        let mut rows = Orthogonal::default();
        rows.add(vec![3.0, 4.0, 0.0]);
        (rows, vec![3.0, 4.0, 5.0 * share])
    }

    #[test]
    fn rows_follow_from_earlier_ones_below_the_threshold_and_not_above() {
        for (share, rank) in [(0.0, 1), (1e-10, 1), (0.8e-8, 1), (1.25e-8, 2), (1e-6, 2)] {
            let (mut rows, row) = nearly(share);
            let (shares, rest) = rows.add(row);
            assert_eq!(rows.rank(), rank, "{share:e}");
            assert!((shares[0] - 5.0).abs() < 1e-14);
            let own = if rank == 2 { 5.0 * share } else { 0.0 };
            assert!((rest - own).abs() <= 1e-15, "{share:e}: {rest:e}");
        }
    }

    /// The unit of a row does not matter.
    #[test]
    fn the_threshold_is_a_share_of_the_row() {
        for scale in [1e-12, 1e12] {
            for (share, rank) in [(0.8e-8, 1), (1.25e-8, 2)] {
                let (mut rows, row) = nearly(share);
                rows.add(row.iter().map(|entry| scale * entry).collect());
                assert_eq!(rows.rank(), rank, "{scale:e} {share:e}");
            }
        }
    }

    #[test]
    fn the_shortest_step_leaves_out_rows_that_follow() {
        let step = |share: f64| shortest(vec![vec![3.0, 4.0, 0.0], vec![3.0, 4.0, 5.0 * share]], &[5.0, 5.0]);
        let shortest = step(0.8e-8);
        assert!((shortest[0] - 0.6).abs() < 1e-15 && shortest[2] == 0.0);
        // With a row of its own, the same right side requires no step along that row's own direction.
        assert!(step(1.25e-8)[2].abs() < 1e-6);
    }
}
