//! The solver of a step with a fixed amount of work: Newton's method, then Levenberg–Marquardt, both cut off.

use crate::block_solvers::budget::Budget;
use crate::block_solvers::convergence::{Diagnosis, Worst, outer_rounding, required};
use crate::block_solvers::gauss_newton::gauss_newton;
use crate::block_solvers::levenberg_marquardt::levenberg_marquardt;
use crate::block_solvers::newton::{all_finite, newton, within};
use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::redundant_widths::Widths;
use crate::mechanism::block::{Block, BlockSolver};
use crate::mechanism::outcome::Outcome;
use crate::scalar::number::Real;

/// As [`Newton`](crate::Newton), with at most [`Budget::evaluations`] in each block; where they do not do, the best
/// of all points met comes back.
#[derive(Clone, Copy)]
pub(crate) struct Budgeted<R: Real> {
    extent: R,
    budget: Budget,
    diagnosis: Diagnosis<R>,
}

impl<R: Real> Budgeted<R> {
    /// A solver for coordinates of which the largest is `extent` in the reference metric.
    pub(crate) fn new(extent: R, budget: Budget) -> Self {
        Budgeted { extent, budget, diagnosis: Diagnosis::new() }
    }

    /// Diagnosis of the blocks solved so far.
    pub(crate) fn diagnosis(&self) -> &Diagnosis<R> {
        &self.diagnosis
    }
}

impl<R: Real> BlockSolver<R> for Budgeted<R> {
    fn solve<const K: usize, F: Factorization<R, K>>(
        &mut self,
        block: &Block<R, K>,
        x: [R; K],
        mut evaluate: impl FnMut(&[R; K]) -> ([R; K], [[R; K]; K]),
    ) -> ([R; K], R::Lanes<Outcome>) {
        let extent = self.extent;
        let mut best = Best { x, worst: Worst::none(), closes: false, any: false };
        let mut watched = |x: &[R; K]| best.meets(block, extent, x, evaluate(x));
        let steps = self.budget.newton.saturating_sub(1);
        let first = newton::<R, K, F>(block, x, true, extent, steps, &mut watched);
        if first.converged {
            self.diagnosis.record(first.evaluations, false, first.worst, true);
            return (first.x, first.outcomes());
        }
        let mut evaluations = first.evaluations;
        // The last point of Newton's method was evaluated, not judged.
        let fallback = !best.closes && self.budget.fallback > 0;
        if fallback {
            let mut watched = |x: &[R; K]| best.meets(block, extent, x, evaluate(x));
            let second = levenberg_marquardt(block, x, true, extent, self.budget.fallback, &mut watched);
            evaluations = evaluations.saturating_add(second.evaluations);
        }
        best.ended(&mut self.diagnosis, evaluations, fallback, first.worst)
    }

    fn solve_redundant<const K: usize, const M: usize>(
        &mut self,
        block: &Block<R, K, M>,
        widths: &Widths<R, M>,
        x: [R; K],
        mut evaluate: impl FnMut(&[R; K]) -> ([R; M], [[R; K]; M]),
        _holds: impl FnMut(&[R; K]) -> bool,
    ) -> ([R; K], R::Lanes<Outcome>) {
        let extent = self.extent;
        let mut best = Best { x, worst: Worst::none(), closes: false, any: false };
        let mut watched = |x: &[R; K]| best.meets(block, extent, x, evaluate(x));
        let steps = self.budget.newton.saturating_sub(1);
        let first = gauss_newton((block, widths), x, true, extent, steps, &mut watched);
        if first.attempt.converged || first.contradicts {
            first.record(&mut self.diagnosis, true);
            return (first.attempt.x, first.outcomes());
        }
        let mut evaluations = first.attempt.evaluations;
        let fallback = !best.closes && self.budget.fallback > 0;
        if fallback {
            let mut watched = |x: &[R; K]| best.meets(block, extent, x, evaluate(x));
            let second = levenberg_marquardt(block, x, true, extent, self.budget.fallback, &mut watched);
            evaluations = evaluations.saturating_add(second.evaluations);
        }
        best.ended(&mut self.diagnosis, evaluations, fallback, first.attempt.worst)
    }
}

/// The point whose worst row is the least.
struct Best<R: Real, const K: usize> {
    x: [R; K],
    worst: Worst<R>,
    /// `true` if its residuals are within rounding.
    closes: bool,
    /// `true` if any point had finite residuals and Jacobian.
    any: bool,
}

impl<R: Real, const K: usize> Best<R, K> {
    /// The end of a block that cost `evaluations`; `last` is the worst row where no point was finite.
    fn ended(
        self,
        diagnosis: &mut Diagnosis<R>,
        evaluations: u32,
        fallback: bool,
        last: Worst<R>,
    ) -> ([R; K], R::Lanes<Outcome>) {
        let worst = if self.any { self.worst } else { last };
        let row = worst.row(0);
        let outcome = match (self.any, self.closes) {
            (true, true) => Outcome::Converged,
            (true, false) => Outcome::NotConverged { row },
            (false, _) => Outcome::NonFinite { row },
        };
        diagnosis.record(evaluations, fallback, worst, self.closes);
        (self.x, R::per_lane(|_| outcome))
    }

    /// Takes up the point `x` with its residuals and Jacobian, and returns these.
    fn meets<const M: usize>(
        &mut self,
        block: &Block<R, K, M>,
        extent: R,
        x: &[R; K],
        (residuals, jacobian): ([R; M], [[R; K]; M]),
    ) -> ([R; M], [[R; K]; M]) {
        if all_finite(&residuals, &jacobian) {
            let tolerances = required(&block.row_scales, x, &jacobian);
            let worst = Worst::of_block(block, &residuals, &tolerances);
            if !self.any || worst.ratio < self.worst.ratio {
                let allowances = outer_rounding(extent, &block.coordinate_scales, &jacobian);
                let closes = within(&residuals, &tolerances, &allowances);
                *self = Best { x: *x, worst, closes, any: true };
            }
        }
        (residuals, jacobian)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear_algebra::direct1::Direct1;

    const BLOCK: Block<f64, 1> =
        Block { rows: [3], coordinates: [0], angles: [false], row_scales: [1.0], coordinate_scales: [1.0] };

    #[test]
    fn no_block_is_evaluated_more_often_than_the_budget_says() {
        // Slow for Newton's method (a double root), without a root, with one, and not a number.
        let functions: [fn(f64) -> (f64, f64); 4] = [
            |x| ((x - 1.0) * (x - 1.0), 2.0 * (x - 1.0)),
            |x| (x * x + 1.0, 2.0 * x),
            |x| (x * x - 2.0, 2.0 * x),
            |_| (f64::NAN, 1.0),
        ];
        for function in functions {
            for (newton, fallback) in [(0, 0), (1, 0), (0, 1), (1, 1), (3, 0), (2, 5), (40, 200)] {
                let budget = Budget { newton, fallback };
                let mut count = 0;
                let mut solver = Budgeted::new(1.0, budget);
                let evaluate = |x: &[f64; 1]| {
                    count += 1;
                    let (residual, slope) = function(x[0]);
                    ([residual], [[slope]])
                };
                let (x, outcome) = solver.solve::<1, Direct1<f64>>(&BLOCK, [3.0], evaluate);
                assert!(
                    count <= budget.evaluations() && count == solver.diagnosis().evaluations,
                    "{budget:?}"
                );
                assert!(x[0].is_finite());
                let residual = function(x[0]).0.abs();
                match outcome {
                    [Outcome::Converged] => assert!(residual < 1e-13),
                    [Outcome::NotConverged { row: 3 }] => assert!(residual <= function(3.0).0),
                    [Outcome::NonFinite { row: 3 }] => assert!(residual.is_nan()),
                    other => panic!("{other:?}"),
                }
            }
        }
    }

    #[test]
    fn the_last_evaluation_of_the_budget_counts() {
        let mut solver = Budgeted::new(1.0, Budget { newton: 2, fallback: 0 });
        let line = |x: &[f64; 1]| ([2.0 * x[0] - 1.0], [[2.0]]);
        let (x, outcome) = solver.solve::<1, Direct1<f64>>(&BLOCK, [3.0], line);
        assert_eq!((x, outcome), ([0.5], [Outcome::Converged]));
    }

    #[test]
    fn the_best_point_is_kept_where_newtons_method_runs_away() {
        // atan from beyond its radius of convergence: each step of Newton's method leads farther away.
        let mut solver = Budgeted::new(1.0, Budget { newton: 4, fallback: 0 });
        let away = |x: &[f64; 1]| ([libm::atan(x[0])], [[1.0 / (1.0 + x[0] * x[0])]]);
        let (x, outcome) = solver.solve::<1, Direct1<f64>>(&BLOCK, [1.5], away);
        assert_eq!((x, outcome), ([1.5], [Outcome::NotConverged { row: 3 }]));
        let mut solver = Budgeted::new(1.0, Budget { newton: 4, fallback: 20 });
        let (x, outcome) = solver.solve::<1, Direct1<f64>>(&BLOCK, [1.5], away);
        assert!(outcome == [Outcome::Converged] && x[0].abs() < 1e-13);
    }
}
