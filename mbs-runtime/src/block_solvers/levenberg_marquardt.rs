//! Levenberg–Marquardt, the method for far starts: assembly, and the rescue of the next position.

use crate::block_solvers::convergence::{Diagnosis, Worst, outer_rounding, required};
use crate::block_solvers::dyad::{closed, taking};
use crate::block_solvers::gauss_newton;
use crate::block_solvers::multistart::displaced;
use crate::block_solvers::newton::{Attempt, ITERATIONS, all_finite, capped, newton, within};
use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::parts::{diagonal, diagonal_mut, tail, tail_mut};
use crate::linear_algebra::redundant_widths::Widths;
use crate::linear_algebra::vectors::select;
use crate::mechanism::block::{Block, BlockSolver};
use crate::mechanism::outcome::Outcome;
use crate::mechanism::roots::Roots;
use crate::scalar::number::Scalar;
use crate::tolerances::positions;

/// Trial steps a start; one costs as much as a Newton step. From 1000 rad away 52 were measured on a four-bar.
pub(crate) const TRIALS: u32 = 120;

/// Starts of a block besides the given one. Each falls into either assembly of a dyad with odds of about one half, so
/// that 32 miss the declared one in 4e9.
pub(crate) const OTHER_STARTS: u32 = 32;

/// Damping at the start, relative to the mean of diag JᵀJ: close to Gauss–Newton, so that a good guess is not
/// led to another assembly.
const FIRST_DAMPING: f64 = 1e-3;

/// After a step that lowered the residual, and after one that did not.
const DAMPING_FALL: f64 = 0.2;
const DAMPING_RISE: f64 = 4.0;

/// Damping stays above the least, where it no longer changes a step in `f64`. A lane gives up above the largest, where a
/// step no longer changes its coordinates.
const LEAST_DAMPING: f64 = 1e-12;
const LARGEST_DAMPING: f64 = 1e16;

/// Levenberg–Marquardt from any guess, finished by Newton's method: the solver of the assembly.
///
/// Judges success as [`Newton`](crate::Newton) does. A point where the residual is large and can fall no more is
/// no success; its residual is the least from this start.
#[derive(Clone, Copy)]
pub struct AssemblySolver<T: Scalar> {
    extent: T,
    diagnosis: Diagnosis<T>,
    /// `true` after the first block.
    begun: bool,
    apart: bool,
}

impl<T: Scalar> AssemblySolver<T> {
    /// A solver for coordinates of which the largest is `extent` in the reference metric.
    pub fn new(extent: T) -> Self {
        AssemblySolver { extent, diagnosis: Diagnosis::new(), begun: false, apart: false }
    }

    /// Diagnosis of the blocks solved so far.
    pub fn diagnosis(&self) -> &Diagnosis<T> {
        &self.diagnosis
    }

    /// `true` if no start can succeed: the first block that is solved for has no position by its formula. The data of that block,
    /// drives and coordinates that rows give explicitly, are the same from every start.
    pub(crate) fn is_apart(&self) -> bool {
        self.apart
    }
}

impl<T: Scalar> BlockSolver<T> for AssemblySolver<T> {
    fn solve<const K: usize, F: Factorization<T, K>>(
        &mut self,
        block: &Block<T, K>,
        x: [T; K],
        evaluate: impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
    ) -> ([T; K], T::Lanes<Outcome>) {
        self.solve_branched::<K, F>(block, x, evaluate, |_| T::mask(true))
    }

    /// From the start value, then from a fixed list of others until the branches hold. Where they never do, the
    /// first solution comes back, and the caller sees the branch that it violates.
    fn solve_branched<const K: usize, F: Factorization<T, K>>(
        &mut self,
        block: &Block<T, K>,
        x: [T; K],
        mut evaluate: impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
        mut holds: impl FnMut(&[T; K]) -> T::Mask,
    ) -> ([T; K], T::Lanes<Outcome>) {
        self.begun = true;
        let (found, plain) =
            searched::<T, K, F>(block, x, T::mask(true), self.extent, &mut evaluate, &mut holds);
        self.diagnosis.record(found.evaluations, !plain, found.worst, found.converged);
        (found.x, found.outcomes())
    }

    /// From both positions that the formula gives: the one in which the branches hold, the nearer one where both do.
    /// If it has none: the least residual, from where it is nearest to closing, at once.
    fn solve_closed<const K: usize, F: Factorization<T, K>>(
        &mut self,
        block: &Block<T, K>,
        x: [T; K],
        mut evaluate: impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
        mut holds: impl FnMut(&[T; K]) -> T::Mask,
        roots: impl FnOnce(&[T; K]) -> Roots<T, K>,
    ) -> ([T; K], T::Lanes<Outcome>) {
        let (extent, roots) = (self.extent, roots(&x));
        let (mut found, missed) = closed::<T, K, F>(block, &x, extent, &mut evaluate, &mut holds, &roots);
        // What did not close and was not missed has no position.
        self.apart |= !self.begun && T::all(!missed & !found.converged);
        self.begun = true;
        let formula = T::all(!missed);
        if !formula {
            let (search, _) = searched::<T, K, F>(block, x, missed, extent, &mut evaluate, &mut holds);
            found = taking(found, missed, &search);
        }
        self.diagnosis.record(found.evaluations, !formula, found.worst, found.converged);
        (found.x, found.outcomes())
    }

    /// As [`solve_branched`](BlockSolver::solve_branched), each start finished and judged by Gauss–Newton.
    fn solve_redundant<const K: usize, const M: usize>(
        &mut self,
        block: &Block<T, K, M>,
        widths: &Widths<T, M>,
        x: [T; K],
        mut evaluate: impl FnMut(&[T; K]) -> ([T; M], [[T; K]; M]),
        mut holds: impl FnMut(&[T; K]) -> T::Mask,
    ) -> ([T; K], T::Lanes<Outcome>) {
        let (found, plain) = gauss_newton::search((block, widths), x, self.extent, &mut evaluate, &mut holds);
        found.record(&mut self.diagnosis, plain);
        (found.attempt.x, found.outcomes())
    }
}

/// The search of [`AssemblySolver`] in the lanes of `active`, with `true` if its first start was enough.
fn searched<T: Scalar, const K: usize, F: Factorization<T, K>>(
    block: &Block<T, K>,
    x: [T; K],
    active: T::Mask,
    extent: T,
    evaluate: &mut impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
    holds: &mut impl FnMut(&[T; K]) -> T::Mask,
) -> (Attempt<T, K>, bool) {
    let (mut found, plain) = attempt::<T, K, F>(block, x, active, extent, evaluate);
    let mut done = !active | (found.converged & holds(&found.x));
    let plain = plain && T::all(done);
    for start in 1..=OTHER_STARTS {
        if T::all(done) {
            break;
        }
        // A solution of another assembly is a better centre than a poor guess.
        let centre = select(found.converged, &found.x, &x);
        let from = displaced(&centre, &block.angles, &block.coordinate_scales, start, OTHER_STARTS);
        let (next, _) = attempt::<T, K, F>(block, from, !done, extent, evaluate);
        let right = next.converged & holds(&next.x) & !done;
        let nearer = !next.converged & !found.converged & next.worst.ratio.less(found.worst.ratio);
        let taken = right | (!done & !found.converged & (next.converged | nearer));
        found = Attempt {
            x: select(taken, &next.x, &found.x),
            converged: found.converged | next.converged,
            worst: found.worst.replaced(taken, next.worst),
            evaluations: found.evaluations.saturating_add(next.evaluations),
        };
        done = done | right;
    }
    (found, plain)
}

/// One start in the lanes of `active`, with `true` if Levenberg–Marquardt alone was enough.
#[inline(never)]
pub(crate) fn attempt<T: Scalar, const K: usize, F: Factorization<T, K>>(
    block: &Block<T, K>,
    start: [T; K],
    active: T::Mask,
    extent: T,
    evaluate: &mut impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
) -> (Attempt<T, K>, bool) {
    let attempt = levenberg_marquardt(block, start, active, extent, TRIALS, evaluate);
    let left = active & !attempt.converged;
    if T::all(!left) {
        return (attempt, true);
    }
    // Newton's method may close what the damping held back; else the least residual stands.
    let finish = newton::<T, K, F>(block, attempt.x, left, extent, ITERATIONS, evaluate);
    let closed = finish.converged & left;
    let attempt = Attempt {
        x: select(closed, &finish.x, &attempt.x),
        converged: attempt.converged | closed,
        worst: attempt.worst.replaced(closed, finish.worst),
        evaluations: attempt.evaluations.saturating_add(finish.evaluations),
    };
    (attempt, false)
}

/// Minimises ‖W r‖² from `start` in the lanes of `active` with at most `trials` steps from (JᵀJ + μ D²) Δ = −Jᵀr.
///
/// In the metric: W divides rows by their scale, D⁻¹ multiplies columns by theirs. μ = λ · min(1, ‖W r‖) times the
/// mean of diag JᵀJ vanishes with the residual, so that convergence is quadratic at the end.
/// Source: Levenberg 1944, Marquardt 1963; Yamashita & Fukushima 2001 for μ.
#[inline(never)]
pub(crate) fn levenberg_marquardt<T: Scalar, const K: usize, const M: usize>(
    block: &Block<T, K, M>,
    start: [T; K],
    active: T::Mask,
    extent: T,
    trials: u32,
    evaluate: &mut impl FnMut(&[T; K]) -> ([T; M], [[T; K]; M]),
) -> Attempt<T, K> {
    let mut descent = Damped::of(block, start, active, evaluate(&start));
    while let Some(trial) = descent.trial(block, trials) {
        let (residuals, jacobian) = evaluate(&trial);
        descent.judge(block, &trial, &residuals, &jacobian);
    }
    descent.ended(block, extent)
}

/// Levenberg–Marquardt between two evaluations.
///
/// The evaluation is not part of it: so all blocks of a size share the code.
struct Damped<T: Scalar, const K: usize, const M: usize> {
    x: [T; K],
    residuals: [T; M],
    jacobian: [[T; K]; M],
    evaluations: u32,
    converged: T::Mask,
    /// Lanes that are still moving.
    open: T::Mask,
    /// Lanes in which the start is finite.
    usable: T::Mask,
    system: NormalEquations<T, K>,
    damping: T,
}

impl<T: Scalar, const K: usize, const M: usize> Damped<T, K, M> {
    /// At the start, in the lanes of `active`.
    #[inline(never)]
    fn of(
        block: &Block<T, K, M>,
        x: [T; K],
        active: T::Mask,
        (residuals, jacobian): ([T; M], [[T; K]; M]),
    ) -> Self {
        let open = active & all_finite(&residuals, &jacobian);
        let system = NormalEquations::of(block, &residuals, &jacobian);
        let damping = T::constant(FIRST_DAMPING);
        let (evaluations, converged) = (1, T::mask(false));
        Damped { x, residuals, jacobian, evaluations, converged, open, usable: open, system, damping }
    }

    /// The next point to be looked at; none where every lane has ended, or `trials` have been.
    #[inline(never)]
    fn trial(&mut self, block: &Block<T, K, M>, trials: u32) -> Option<[T; K]> {
        if self.evaluations > trials {
            return None;
        }
        let tolerances = required(&block.row_scales, &self.x, &self.jacobian);
        let none = [T::constant(0.0); M];
        self.converged = self.converged | (self.open & within(&self.residuals, &tolerances, &none));
        let damped = self.damping.less(T::constant(LARGEST_DAMPING));
        self.open = self.open & !self.converged & !self.system.is_stationary() & damped;
        if T::all(!self.open) {
            return None;
        }
        let mut trial = self.x;
        let step = capped(block, self.system.step(block, self.damping));
        trial.iter_mut().zip(step).for_each(|(component, change)| *component = *component + change);
        Some(select(self.open, &trial, &self.x))
    }

    /// Goes to the point in the lanes in which it is better.
    #[inline(never)]
    fn judge(&mut self, block: &Block<T, K, M>, trial: &[T; K], residuals: &[T; M], jacobian: &[[T; K]; M]) {
        self.evaluations += 1;
        let system = NormalEquations::of(block, residuals, jacobian);
        let better = self.open & system.cost.less(self.system.cost) & all_finite(residuals, jacobian);
        self.x = select(better, trial, &self.x);
        self.residuals = select(better, residuals, &self.residuals);
        self.jacobian.iter_mut().zip(jacobian).for_each(|(row, trial)| *row = select(better, trial, row));
        self.system = self.system.replaced(better, &system);
        let eased = (self.damping * T::constant(DAMPING_FALL)).max(T::constant(LEAST_DAMPING));
        self.damping = T::select(better, eased, self.damping * T::constant(DAMPING_RISE));
    }

    /// Result of the iterations.
    #[inline(never)]
    fn ended(&self, block: &Block<T, K, M>, extent: T) -> Attempt<T, K> {
        let Damped { x, residuals, jacobian, evaluations, converged, usable, .. } = self;
        // Nothing lowers these residuals any more: those that the rounding of q explains are as good as zero.
        let tolerances = required(&block.row_scales, x, jacobian);
        let allowances = outer_rounding(extent, &block.coordinate_scales, jacobian);
        let converged = *converged | (*usable & within(residuals, &tolerances, &allowances));
        let worst = Worst::of_block(block, residuals, &tolerances);
        Attempt { x: *x, converged, worst, evaluations: *evaluations }
    }
}

/// JᵀJ and Jᵀr in the reference metric.
#[derive(Clone, Copy)]
struct NormalEquations<T, const K: usize> {
    matrix: [[T; K]; K],
    gradient: [T; K],
    /// ‖W r‖².
    cost: T,
}

impl<T: Scalar, const K: usize> NormalEquations<T, K> {
    fn of<const M: usize>(block: &Block<T, K, M>, residuals: &[T; M], jacobian: &[[T; K]; M]) -> Self {
        let zero = T::constant(0.0);
        let mut system = NormalEquations { matrix: [[zero; K]; K], gradient: [zero; K], cost: zero };
        for ((row, residual), row_scale) in jacobian.iter().zip(residuals).zip(block.row_scales) {
            let weight = T::constant(1.0) / row_scale;
            let residual = *residual * weight;
            let mut scaled = *row;
            scaled
                .iter_mut()
                .zip(block.coordinate_scales)
                .for_each(|(entry, s)| *entry = *entry * s * weight);
            system.cost = system.cost + residual * residual;
            for ((line, component), a) in system.matrix.iter_mut().zip(&mut system.gradient).zip(scaled) {
                *component = *component + a * residual;
                line.iter_mut().zip(scaled).for_each(|(entry, b)| *entry = *entry + a * b);
            }
        }
        system
    }

    fn trace(&self) -> T {
        diagonal(&self.matrix).fold(T::constant(0.0), |sum, entry| sum + *entry)
    }

    /// `true` if the gradient is zero within rounding.
    fn is_stationary(&self) -> T::Mask {
        let gradient = self.gradient.iter().fold(T::constant(0.0), |sum, g| sum + *g * *g);
        let bound = positions::STATIONARY.of::<T>() * self.trace() * self.cost;
        !bound.less(gradient)
    }

    /// The damped step, in the units of the coordinates.
    fn step<const M: usize>(&self, block: &Block<T, K, M>, damping: T) -> [T; K] {
        let (zero, one) = (T::constant(0.0), T::constant(1.0));
        let mean = self.trace() / T::constant(K as f64);
        let added = damping * self.cost.sqrt().min(one) * mean;
        let mut matrix = self.matrix;
        diagonal_mut(&mut matrix).for_each(|entry| *entry = *entry + added);
        // Cholesky without square roots, L D Lᵀ in place; a pivot lost to rounding is replaced by the damping.
        let mut x = self.gradient.map(|g| -g);
        for k in 0..K {
            // Row k and component k, of K; then those below.
            let ([upper, below @ ..], [known, open @ ..]) = (tail_mut(&mut matrix, k), tail_mut(&mut x, k))
            else {
                break;
            };
            let [pivot, upper @ ..] = tail_mut(upper, k) else { break };
            let floor = T::select(zero.less(added), added, one);
            *pivot = T::select(zero.less(*pivot), *pivot, floor);
            for ((lower, component), entry) in below.iter_mut().zip(open).zip(&*upper) {
                let multiplier = *entry / *pivot;
                for (lower, upper) in tail_mut(lower, k + 1).iter_mut().zip(&*upper) {
                    *lower = *lower - multiplier * *upper;
                }
                *component = *component - multiplier * *known;
            }
        }
        for (k, row) in matrix.iter().enumerate().rev() {
            let ([pivot, upper @ ..], [component, known @ ..]) = (tail(row, k), tail_mut(&mut x, k)) else {
                break;
            };
            for (entry, known) in upper.iter().zip(known) {
                *component = *component - *entry * *known;
            }
            *component = *component / *pivot;
        }
        x.iter_mut()
            .zip(block.coordinate_scales)
            .for_each(|(component, scale)| *component = *component * scale);
        x
    }

    fn replaced(&self, mask: T::Mask, other: &Self) -> Self {
        let mut matrix = self.matrix;
        matrix.iter_mut().zip(&other.matrix).for_each(|(row, new)| *row = select(mask, new, row));
        NormalEquations {
            matrix,
            gradient: select(mask, &other.gradient, &self.gradient),
            cost: T::select(mask, other.cost, self.cost),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear_algebra::direct1::Direct1;
    use crate::linear_algebra::direct2::Direct2;
    use crate::scalar::lanes::Lanes;

    fn block<T: Scalar, const K: usize>() -> Block<T, K> {
        let rows = core::array::from_fn(|k| k as u16);
        let ones = [T::constant(1.0); K];
        Block { rows, coordinates: rows, angles: [false; K], row_scales: ones, coordinate_scales: ones }
    }

    #[test]
    fn a_stationary_point_that_does_not_close_has_the_least_residual() {
        // x² + 1 is least at 0, and there it is 1.
        let mut solver = AssemblySolver::new(1.0);
        let parabola = |x: &[f64; 1]| ([x[0] * x[0] + 1.0], [[2.0 * x[0]]]);
        let (x, outcome) = solver.solve::<1, Direct1<f64>>(&block(), [3.0], parabola);
        assert_eq!(outcome, [Outcome::NotConverged { row: 0 }]);
        assert!(x[0].abs() < 1e-4 && (solver.diagnosis().worst.residual - 1.0).abs() < 1e-8);
        // From the start value and from all others.
        let (evaluations, starts) = (solver.diagnosis().evaluations, 1 + OTHER_STARTS);
        assert!(evaluations < 160 * starts, "{evaluations}");
    }

    #[test]
    fn the_branch_decides_between_two_roots_from_any_start_value() {
        // x² = 4: the start value is next to −2, the branch asks for +2.
        let square = |x: &[f64; 1]| ([x[0] * x[0] - 4.0], [[2.0 * x[0]]]);
        for start in [-30.0, -2.1, -0.1, 0.1, 2.1, 30.0] {
            for side in [-1.0, 1.0] {
                let mut solver = AssemblySolver::new(4.0);
                let holds = |x: &[f64; 1]| side * x[0] > 0.0;
                let block = Block { coordinate_scales: [4.0], ..block() };
                let (x, outcome) = solver.solve_branched::<1, Direct1<f64>>(&block, [start], square, holds);
                let near = start.abs() < 5.0;
                assert!(
                    !near || (outcome == [Outcome::Converged] && (x[0] - 2.0 * side).abs() < 1e-12),
                    "{start}"
                );
            }
        }
        let (x, outcome) =
            AssemblySolver::new(4.0).solve_branched::<1, Direct1<f64>>(&block(), [-1.0], square, |_| false);
        assert!(
            outcome == [Outcome::Converged] && (x[0] + 2.0).abs() < 1e-12,
            "the first solution, for the caller to judge"
        );
    }

    #[test]
    fn a_double_root_is_found_to_the_root_of_the_tolerance() {
        let mut solver = AssemblySolver::new(1.0);
        let double = |x: &[f64; 1]| ([(x[0] - 1.0) * (x[0] - 1.0)], [[2.0 * (x[0] - 1.0)]]);
        let (x, outcome) = solver.solve::<1, Direct1<f64>>(&block(), [3.0], double);
        assert_eq!(outcome, [Outcome::Converged]);
        assert!((x[0] - 1.0).abs() < 2e-7);
    }

    #[test]
    fn rosenbrock_valley_is_followed_to_its_end_in_every_lane() {
        let evaluate = |x: &[Lanes<f64, 2>; 2]| {
            let c = Lanes::constant;
            let residuals = [c(10.0) * (x[1] - x[0] * x[0]), c(1.0) - x[0]];
            (residuals, [[c(-20.0) * x[0], c(10.0)], [c(-1.0), c(0.0)]])
        };
        let mut solver = AssemblySolver::new(Lanes::constant(1.0));
        let start = [Lanes([-1.2, 5.0]), Lanes([1.0, -7.0])];
        let (x, outcome) = solver.solve::<2, Direct2<Lanes<f64, 2>>>(&block(), start, evaluate);
        assert_eq!(outcome, [Outcome::Converged; 2]);
        assert!(x.iter().flat_map(|x| x.0).all(|x| (x - 1.0).abs() < 1e-13));
    }
}
