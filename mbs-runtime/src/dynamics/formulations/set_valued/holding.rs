//! Rows that hold in a linear system: Schur complement of their answers.

use crate::dynamics::formulations::set_valued::shares::Shares;
use crate::dynamics::formulations::set_valued::{column, mask};
use crate::dynamics::integrators::vector::Vector;
use crate::linear_algebra::vectors::dot;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::set_valued::{SetValuedMode, SetValuedRow};
use crate::scalar::number::Real;

/// A system's answers x, λ (N, M) to unit forces of rows that hold, and W of them.
pub(crate) struct Holding<R: Real, const N: usize, const M: usize, const K: usize> {
    answers: [([R; N], [R; M]); K],
    shares: Shares<R, K>,
}

impl<R: Real, const N: usize, const M: usize, const K: usize> Holding<R, N, M, K> {
    /// Those of `rows` that hold in `modes` (K), by the answers of `solve` to forces (N).
    #[inline(always)]
    pub(crate) fn of<S: Dynamic<R, N, M>>(
        rows: &[SetValuedRow<R, N>; K],
        modes: &[SetValuedMode<R>],
        mut solve: impl FnMut(&[R; N]) -> ([R; N], [R; M]),
    ) -> Self {
        let zero = R::constant(0.0);
        let mask: [bool; K] = mask(modes);
        let mut answers = [([zero; N], [zero; M]); K];
        for (index, (answer, _)) in answers.iter_mut().zip(&mask).enumerate().filter(|(_, (_, held))| **held)
        {
            *answer = solve(&column::<S, R, N, M, K>(rows, modes, index));
        }
        let shares = Shares::of(rows, &mask, |row, column| {
            answers.get(column).map_or(zero, |answer| dot(&row.gradient, &answer.0))
        });
        Holding { answers, shares }
    }

    /// A solution x, λ (N, M) of the system with the forces added that make J x = `right` (K) of the rows that hold.
    #[inline(always)]
    pub(crate) fn hold(
        &self,
        rows: &[SetValuedRow<R, N>; K],
        (mut x, mut lambda): ([R; N], [R; M]),
        right: &[R; K],
    ) -> ([R; N], [R; M]) {
        for (share, answer) in self.forces(rows, &x, right).iter().zip(&self.answers) {
            x = x.plus(*share, &[1.0], [&answer.0]);
            lambda = lambda.plus(*share, &[1.0], [&answer.1]);
        }
        (x, lambda)
    }

    /// The forces (K) that [`hold`](Self::hold) adds to a solution x (N).
    #[inline(always)]
    pub(crate) fn forces(&self, rows: &[SetValuedRow<R, N>; K], x: &[R; N], right: &[R; K]) -> [R; K] {
        let mut open = [R::constant(0.0); K];
        for ((open, row), right) in open.iter_mut().zip(rows).zip(right) {
            *open = *right - dot(&row.gradient, x);
        }
        self.shares.solve(&open)
    }

    /// `true` if rows follow from others: their forces are shared.
    pub(crate) fn is_shared(&self) -> bool {
        self.shares.singular
    }
}
