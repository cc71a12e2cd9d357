//! Rank of the constraints at the present position, and the rows that follow from others.

use crate::linear_algebra::vectors::dot;
use crate::mechanism::{Entry, Kinematic};
use crate::scalar::number::Real;
use crate::stepper::Stepper;
use crate::tolerances::singular;

/// The rank of Φ_q at a position and the rows that follow from the others there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Redundancy<const M: usize> {
    entries: &'static [Entry],
    dependent: [bool; M],
    /// Rank of Φ_q in the reference metric, drives included.
    pub rank: usize,
}

impl<const M: usize> Redundancy<M> {
    /// The dependent rows in the order of Φ. Of rows that follow from each other it is the later one, a row of a constraint
    /// marked `redundant` before any other.
    pub fn rows(&self) -> impl Iterator<Item = Entry> + '_ {
        let rows = self.entries.iter().zip(&self.dependent);
        rows.filter(|(_, dependent)| **dependent).map(|(entry, _)| *entry)
    }
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// Rows that follow from the others at the present position, to be asked once after the assembly.
    ///
    /// A row counts as dependent if less than √ε of its length in the reference metric is outside the span of the rows before
    /// it. Marked rows are compared with all others and earlier marked ones. A dead centre makes rows dependent too, so ask
    /// at a regular position.
    pub fn redundancy(&self) -> Redundancy<M> {
        let phi_q = self.mechanism.phi_q(&self.parameters, &self.position());
        let scales = self.mechanism.coordinate_scales(&self.parameters);
        let mut basis = [[R::constant(0.0); N]; N];
        let (mut dependent, mut rank) = ([false; M], 0);
        for marked in [false, true] {
            for (index, (row, dependent)) in phi_q.iter().zip(&mut dependent).enumerate() {
                if S::REDUNDANT.get(index).copied().unwrap_or(false) != marked {
                    continue;
                }
                let mut scaled = *row;
                scaled.iter_mut().zip(&scales).for_each(|(entry, scale)| *entry = *entry * *scale);
                match (remainder(scaled, &basis), basis.get_mut(rank)) {
                    (Some(direction), Some(slot)) => {
                        *slot = direction;
                        rank += 1;
                    }
                    _ => *dependent = true,
                }
            }
        }
        Redundancy { entries: S::ROWS, dependent, rank }
    }
}

/// The unit vector along the part of `row` outside the span of `basis`; `None` where that is rounding.
///
/// Source: Golub & Van Loan 2013, §5.2.8 (modified Gram–Schmidt), done twice.
fn remainder<R: Real, const N: usize>(row: [R; N], basis: &[[R; N]; N]) -> Option<[R; N]> {
    let mut rest = unit(row, R::constant(0.0))?;
    for _ in 0..2 {
        for direction in basis {
            let part = dot(&rest, direction);
            rest.iter_mut().zip(direction).for_each(|(entry, along)| *entry = *entry - part * *along);
        }
    }
    unit(rest, singular::HALF_THE_DIGITS.of())
}

/// `vector` made of length 1; `None` where it is no longer than `least`.
pub(crate) fn unit<R: Real, const N: usize>(vector: [R; N], least: R) -> Option<[R; N]> {
    let length = dot(&vector, &vector).sqrt();
    (length > least && length.is_finite()).then(|| vector.map(|entry| entry / length))
}
