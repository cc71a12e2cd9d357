//! Blocks of more rows than coordinates: Gauss–Newton, which solves them where they agree and says where they do not.

use crate::block_solvers::convergence::{Diagnosis, Worst, outer_rounding, required};
use crate::block_solvers::levenberg_marquardt::{OTHER_STARTS, TRIALS, levenberg_marquardt};
use crate::block_solvers::multistart::displaced;
use crate::block_solvers::newton::{Attempt, ITERATIONS, all_finite, capped, largest_ratio, within};
use crate::linear_algebra::rectangular::Orthogonal;
use crate::linear_algebra::redundant_widths::Widths;
use crate::linear_algebra::vectors::{select, times};
use crate::mechanism::block::Block;
use crate::mechanism::outcome::Outcome;
use crate::scalar::number::Scalar;

/// Result of Gauss–Newton.
#[derive(Clone, Copy)]
pub(crate) struct Settled<T: Scalar, const K: usize> {
    pub attempt: Attempt<T, K>,
    /// Lanes whose least residual is above its tolerance: the rows contradict each other.
    pub contradicts: T::Mask,
}

impl<T: Scalar, const K: usize> Settled<T, K> {
    /// The outcome in each lane, with the worst row where it is no success.
    pub(crate) fn outcomes(&self) -> T::Lanes<Outcome> {
        let plain = self.attempt.outcomes();
        T::per_lane(|lane| match plain.as_ref().get(lane).copied() {
            Some(Outcome::NotConverged { row }) if T::test(self.contradicts, lane) => {
                Outcome::Inconsistent { row }
            }
            Some(outcome) => outcome,
            None => Outcome::Converged,
        })
    }

    /// This result in the lanes of `decided`, `second` elsewhere.
    fn continued_by(self, decided: T::Mask, second: Self) -> Self {
        let (first, next) = (self.attempt, second.attempt);
        Settled {
            attempt: Attempt {
                x: select(decided, &first.x, &next.x),
                converged: (decided & first.converged) | (!decided & next.converged),
                worst: next.worst.replaced(decided, first.worst),
                evaluations: first.evaluations.saturating_add(next.evaluations),
            },
            contradicts: (decided & self.contradicts) | (!decided & second.contradicts),
        }
    }

    /// Takes this up in a solver's diagnosis; `plain` where its first method was enough.
    pub(crate) fn record(&self, diagnosis: &mut Diagnosis<T>, plain: bool) {
        let Attempt { evaluations, worst, converged, .. } = self.attempt;
        diagnosis.record(evaluations, !plain, worst, converged);
    }
}

/// Gauss–Newton from `start` in the lanes of `active`; the others stay. At most `iterations` steps.
///
/// A step is the minimum-norm least-squares solution of all rows in the reference metric, where rows with a width yield to the
/// others. The least residual is reached
/// where the next step would close no more than every row's tolerance: the rest is rounding or within the widths, or
/// the rows contradict each other. So contradicting rows are told from a method that ran out of iterations.
/// Source: Nocedal & Wright 2006, §10.3.
#[inline(never)]
pub(crate) fn gauss_newton<T: Scalar, const K: usize, const M: usize>(
    (block, widths): (&Block<T, K, M>, &Widths<T, M>),
    start: [T; K],
    active: T::Mask,
    extent: T,
    iterations: u32,
    evaluate: &mut impl FnMut(&[T; K]) -> ([T; M], [[T; K]; M]),
) -> Settled<T, K> {
    let one = T::constant(1.0);
    let (none, granted) = ([T::constant(0.0); M], widths.granted(&block.row_scales));
    let mut x = start;
    let (mut residuals, mut jacobian) = evaluate(&x);
    let mut evaluations = 1;
    let (mut converged, mut contradicts, mut open) = (T::mask(false), T::mask(false), active);
    let mut tolerances = required(&block.row_scales, &x, &jacobian);
    for _ in 0..iterations {
        open = open & all_finite(&residuals, &jacobian);
        converged = converged | (open & !one.less(largest_ratio(&residuals, &tolerances)));
        open = open & !converged;
        if T::all(!open) {
            break;
        }
        let factors = Orthogonal::yielding(&jacobian, &block.row_scales, &block.coordinate_scales, widths);
        let step = factors.solve(&residuals.map(|r| -r));
        let change = times(&jacobian, &step);
        let mut allowances = outer_rounding(extent, &block.coordinate_scales, &jacobian);
        allowances.iter_mut().zip(&granted).for_each(|(allowed, granted)| *allowed = *allowed + *granted);
        let settled = open & within(&change, &tolerances, &none);
        let mut rest = residuals;
        rest.iter_mut().zip(&change).for_each(|(rest, change)| *rest = *rest + *change);
        converged = converged | (settled & within(&residuals, &tolerances, &allowances));
        contradicts = contradicts | (settled & !converged & !within(&rest, &tolerances, &allowances));
        open = open & !converged & !contradicts;
        if T::all(!open) {
            break;
        }
        let mut next = x;
        let step = capped(block, step);
        next.iter_mut().zip(step).for_each(|(component, change)| *component = *component + change);
        x = select(open, &next, &x);
        (residuals, jacobian) = evaluate(&x);
        tolerances = required(&block.row_scales, &x, &jacobian);
        evaluations += 1;
    }
    tolerances.iter_mut().zip(&granted).for_each(|(tolerance, granted)| *tolerance = *tolerance + *granted);
    let worst = Worst::of_block(block, &residuals, &tolerances);
    Settled { attempt: Attempt { x, converged, worst, evaluations }, contradicts }
}

/// The next position: Gauss–Newton, then Levenberg–Marquardt from the same start. Returns `true` if the first was enough.
pub(crate) fn next<T: Scalar, const K: usize, const M: usize>(
    (block, widths): (&Block<T, K, M>, &Widths<T, M>),
    x: [T; K],
    extent: T,
    evaluate: &mut impl FnMut(&[T; K]) -> ([T; M], [[T; K]; M]),
) -> (Settled<T, K>, bool) {
    let first = gauss_newton((block, widths), x, T::mask(true), extent, ITERATIONS, evaluate);
    let decided = first.attempt.converged | first.contradicts;
    if T::all(decided) {
        return (first, true);
    }
    (first.continued_by(decided, from_far((block, widths), x, !decided, extent, evaluate)), false)
}

/// Levenberg–Marquardt from `start` in the lanes of `active`, finished by Gauss–Newton, which judges the end.
pub(crate) fn from_far<T: Scalar, const K: usize, const M: usize>(
    (block, widths): (&Block<T, K, M>, &Widths<T, M>),
    start: [T; K],
    active: T::Mask,
    extent: T,
    evaluate: &mut impl FnMut(&[T; K]) -> ([T; M], [[T; K]; M]),
) -> Settled<T, K> {
    let attempt = levenberg_marquardt(block, start, active, extent, TRIALS, evaluate);
    let first = Settled { attempt, contradicts: T::mask(false) };
    let left = active & !attempt.converged;
    if T::all(!left) {
        return first;
    }
    first.continued_by(!left, gauss_newton((block, widths), attempt.x, left, extent, ITERATIONS, evaluate))
}

/// From the start value, then from a fixed list of others until the rows close and the branches hold. Also returns `true` if
/// the start value was enough.
///
/// If they never do, the first solution comes back, and the caller sees the branch that it violates. Without any
/// solution it is the end with the least residual, so that rows contradict each other at their best, not at their first.
pub(crate) fn search<T: Scalar, const K: usize, const M: usize>(
    (block, widths): (&Block<T, K, M>, &Widths<T, M>),
    x: [T; K],
    extent: T,
    evaluate: &mut impl FnMut(&[T; K]) -> ([T; M], [[T; K]; M]),
    holds: &mut impl FnMut(&[T; K]) -> T::Mask,
) -> (Settled<T, K>, bool) {
    let mut found = from_far((block, widths), x, T::mask(true), extent, evaluate);
    let mut done = found.attempt.converged & holds(&found.attempt.x);
    let plain = T::all(done);
    for start in 1..=OTHER_STARTS {
        if T::all(done) {
            break;
        }
        let Attempt { x: near, converged, worst, .. } = found.attempt;
        // A solution of another assembly is a better centre than a poor guess.
        let centre = select(converged, &near, &x);
        let from = displaced(&centre, &block.angles, &block.coordinate_scales, start, OTHER_STARTS);
        let next = from_far((block, widths), from, !done, extent, evaluate);
        let right = next.attempt.converged & holds(&next.attempt.x) & !done;
        let nearer = !next.attempt.converged & next.attempt.worst.ratio.less(worst.ratio);
        let taken = right | (!done & !converged & (next.attempt.converged | nearer));
        found = found.continued_by(!taken, next);
        done = done | right;
    }
    (found, plain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block_solvers::levenberg_marquardt::AssemblySolver;
    use crate::block_solvers::newton::Newton;
    use crate::mechanism::block::BlockSolver;
    use crate::scalar::lanes::Lanes;

    fn block<T: Scalar, const K: usize, const M: usize>() -> Block<T, K, M> {
        Block {
            rows: core::array::from_fn(|k| 3 + k as u16),
            coordinates: core::array::from_fn(|k| k as u16),
            angles: [false; K],
            row_scales: [T::constant(1.0); M],
            coordinate_scales: [T::constant(1.0); K],
        }
    }

    /// Two circles and a third through the same point (1, 2), whose radius is longer by `error`.
    fn circles<T: Scalar>(error: T) -> impl Fn(&[T; 2]) -> ([T; 3], [[T; 2]; 3]) {
        let c = T::constant;
        move |x| {
            let centres =
                [([c(0.0), c(0.0)], c(5.0)), ([c(4.0), c(0.0)], c(13.0)), ([c(1.0), c(5.0)], c(9.0) + error)];
            let row = |([a, b], square): ([T; 2], T)| {
                let (u, v) = (x[0] - a, x[1] - b);
                (u * u + v * v - square, [c(2.0) * u, c(2.0) * v])
            };
            (centres.map(|circle| row(circle).0), centres.map(|circle| row(circle).1))
        }
    }

    #[test]
    fn rows_that_agree_are_solved_and_rows_that_do_not_are_inconsistent() {
        for (error, outcome) in [(0.0, Outcome::Converged), (1e-9, Outcome::Inconsistent { row: 5 })] {
            for solver in 0..2 {
                let circles = circles(error);
                let (x, [found]) = match solver {
                    0 => Newton::new(1.0).solve_redundant::<2, 3>(
                        &block(),
                        &Widths::none(),
                        [1.2, 1.9],
                        &circles,
                        |_| true,
                    ),
                    _ => AssemblySolver::new(1.0).solve_redundant::<2, 3>(
                        &block(),
                        &Widths::none(),
                        [3.0, 7.0],
                        &circles,
                        |_| true,
                    ),
                };
                assert_eq!(core::mem::discriminant(&found), core::mem::discriminant(&outcome), "{found:?}");
                assert!((x[0] - 1.0).abs() < 1e-8 && (x[1] - 2.0).abs() < 1e-8, "{x:?}");
            }
        }
    }

    #[test]
    fn a_lane_that_contradicts_itself_leaves_its_neighbour_alone() {
        let circles = circles(Lanes([0.0, 1e-3]));
        let start = [Lanes([1.2, 1.2]), Lanes([1.9, 1.9])];
        let mut newton = Newton::new(Lanes::constant(1.0));
        let (x, outcome) = newton.solve_redundant::<2, 3>(&block(), &Widths::none(), start, &circles, |_| {
            Lanes::<f64, 2>::mask(true)
        });
        assert!(matches!(outcome, [Outcome::Converged, Outcome::Inconsistent { .. }]), "{outcome:?}");
        assert!((x[0].0[0] - 1.0).abs() < 1e-14 && (x[1].0[0] - 2.0).abs() < 1e-14);
    }
}
