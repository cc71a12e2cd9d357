//! Newton's method for the next position: fast from a good prediction, safe from a bad one.

use crate::block_solvers::convergence::{Diagnosis, Worst, outer_rounding, required};
use crate::block_solvers::gauss_newton;
use crate::block_solvers::levenberg_marquardt::{TRIALS, levenberg_marquardt};
use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::is_regular;
use crate::linear_algebra::orthogonal::minimum_norm;
use crate::linear_algebra::redundant_widths::Widths;
use crate::linear_algebra::vectors::{Each, of_each, select};
use crate::mechanism::block::{Block, BlockSolver};
use crate::mechanism::outcome::Outcome;
use crate::scalar::number::Scalar;
use crate::tolerances::singular;

/// Iterations before the safeguarded method takes over. Quadratic convergence needs 2 to 6; at a change point it
/// is linear, a quarter of the residual a step, and 17 were measured on a four-bar in line.
pub(crate) const ITERATIONS: u32 = 30;

/// Iterations that are granted to fall without question; a residual that does not halve after them is rounding.
const FREE_ITERATIONS: u32 = 3;

/// Iterations in a row that may bring the residual no [`FALL`] below where it last fell so far. Capped steps may rise
/// over a ridge; a cycle of two points, into which they fall from far away, creeps at best.
const FRUITLESS_ITERATIONS: f64 = 4.0;

/// A residual that counts as a fall, over the one before. At half a radian a step an angle 20 rad away has it
/// within four.
const FALL: f64 = 0.9;

/// Largest change of an angle in one step (rad). With it Newton's method adds turns and changes assemblies far
/// less often than without.
const LARGEST_ANGLE_STEP: f64 = 0.5;

/// Newton's method with capped steps, the solver of the next position. It falls back to minimum-norm steps where the Jacobian is
/// singular, and to Levenberg–Marquardt from the original start where it does not converge.
///
/// Success is judged on the residual alone: |rᵢ| ≤ ε (64 ρᵢ + 4 Σⱼ |Jᵢⱼ| |xⱼ|), ρ the row's scale.
/// Lanes that have converged or failed do not change, so a lane's result does not depend on its neighbours.
#[derive(Clone, Copy)]
pub struct Newton<T: Scalar> {
    extent: T,
    diagnosis: Diagnosis<T>,
}

impl<T: Scalar> Newton<T> {
    /// A solver for coordinates of which the largest is `extent` in the reference metric, see
    /// [`extent`](crate::linear_algebra::vectors::extent). It gives the rounding of their sums in a row.
    #[inline(always)]
    pub fn new(extent: T) -> Self {
        Newton { extent, diagnosis: Diagnosis::new() }
    }

    /// Diagnosis of the blocks solved so far.
    #[inline(always)]
    pub fn diagnosis(&self) -> &Diagnosis<T> {
        &self.diagnosis
    }
}

impl<T: Scalar> BlockSolver<T> for Newton<T> {
    #[inline(always)]
    fn solve<const K: usize, F: Factorization<T, K>>(
        &mut self,
        block: &Block<T, K>,
        x: [T; K],
        mut evaluate: impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
    ) -> ([T; K], T::Lanes<Outcome>) {
        match plainly::<T, K, F>(block, x, &mut evaluate) {
            Ok(closed) => {
                let Closed { evaluations, residuals, tolerances, .. } = &closed;
                self.diagnosis.record_plain(*evaluations, block, residuals, tolerances);
                (closed.x, T::per_lane(|_| Outcome::Converged))
            }
            Err(descent) => {
                let (attempt, plain) = carefully::<T, K, F>(descent, block, x, self.extent, &mut evaluate);
                self.diagnosis.record(attempt.evaluations, !plain, attempt.worst, attempt.converged);
                (attempt.x, attempt.outcomes())
            }
        }
    }

    fn solve_redundant<const K: usize, const M: usize>(
        &mut self,
        block: &Block<T, K, M>,
        widths: &Widths<T, M>,
        x: [T; K],
        mut evaluate: impl FnMut(&[T; K]) -> ([T; M], [[T; K]; M]),
        _holds: impl FnMut(&[T; K]) -> T::Mask,
    ) -> ([T; K], T::Lanes<Outcome>) {
        let (settled, plain) = gauss_newton::next((block, widths), x, self.extent, &mut evaluate);
        settled.record(&mut self.diagnosis, plain);
        (settled.attempt.x, settled.outcomes())
    }
}

/// A block that every lane has closed.
struct Closed<T: Scalar, const K: usize> {
    x: [T; K],
    residuals: [T; K],
    tolerances: [T; K],
    evaluations: u32,
}

/// Newton's method as long as it runs as it should next to the solution: the residual falls, the Jacobian is regular, no
/// step is long. It equals [`Descent`] without its safeguards; at any other event
/// that goes on from here.
#[inline(always)]
fn plainly<T: Scalar, const K: usize, F: Factorization<T, K>>(
    block: &Block<T, K>,
    start: [T; K],
    evaluate: &mut impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
) -> Result<Closed<T, K>, Descent<T, K>> {
    let (mut x, mut converged) = (start, T::mask(false));
    // Residuals and tolerances of the iterate before.
    let mut last = ([T::constant(1.0); K], [T::constant(1.0); K]);
    let mut evaluations = 0;
    loop {
        let (residuals, jacobian) = evaluate(&x);
        evaluations += 1;
        let tolerances = required(&block.row_scales, &x, &jacobian);
        let closes = converged | closed(&residuals, &tolerances);
        if T::all(closes) {
            return Ok(Closed { x, residuals, tolerances, evaluations });
        }
        let toward = residuals.each(|r| -r);
        let (step, regular) = F::solve_once(&jacobian, &toward, &block.row_scales, &block.coordinate_scales);
        let mut plain = regular & !beyond(block, &step);
        if evaluations > 1 {
            let limit = T::constant(FALL) * largest_ratio(&last.0, &last.1);
            plain = plain & largest_ratio(&residuals, &tolerances).less(limit);
        }
        if !T::all(closes | plain) || evaluations > FREE_ITERATIONS {
            let first = evaluations == 1;
            let last = largest_ratio(&last.0, &last.1);
            return Err(Descent {
                x,
                residuals,
                jacobian,
                evaluations,
                converged,
                open: !converged,
                last_ratio: last,
                least_ratio: if first { T::constant(f64::MAX) } else { last },
                fruitless: T::constant(0.0),
            });
        }
        let mut next = x;
        for (component, change) in next.iter_mut().zip(&step) {
            *component = *component + *change;
        }
        x = select(closes, &x, &next);
        (converged, last) = (closes, (residuals, tolerances));
    }
}

/// `true` if every residual is within its tolerance, and neither the residual nor the Jacobian is NaN or infinite.
#[inline(always)]
fn closed<T: Scalar, const K: usize>(residuals: &[T; K], tolerances: &[T; K]) -> T::Mask {
    let mut closed = T::mask(true);
    for (r, tolerance) in residuals.iter().zip(tolerances) {
        closed = closed & r.abs().less(*tolerance) & tolerance.is_finite();
    }
    closed
}

/// Newton's method from the present iterate; the lanes that do not converge once more from their `start` by
/// Levenberg–Marquardt. Returns `true` if Newton's method was enough.
#[cold]
#[inline(never)]
fn carefully<T: Scalar, const K: usize, F: Factorization<T, K>>(
    mut descent: Descent<T, K>,
    block: &Block<T, K>,
    start: [T; K],
    extent: T,
    evaluate: &mut impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
) -> (Attempt<T, K>, bool) {
    while descent.goes_on::<F>(block, extent, ITERATIONS) {
        descent.met(evaluate(&descent.x));
    }
    let attempt = descent.ended(block);
    if T::all(attempt.converged) {
        return (attempt, true);
    }
    let second = levenberg_marquardt(block, start, !attempt.converged, extent, TRIALS, evaluate);
    (attempt.continued_by(second), false)
}

/// Result of one method in its active lanes.
#[derive(Clone, Copy)]
pub(crate) struct Attempt<T: Scalar, const K: usize> {
    pub x: [T; K],
    pub converged: T::Mask,
    pub worst: Worst<T>,
    pub evaluations: u32,
}

impl<T: Scalar, const K: usize> Attempt<T, K> {
    /// This attempt where it converged, `second` elsewhere.
    pub(crate) fn continued_by(self, second: Self) -> Self {
        Attempt {
            x: select(self.converged, &self.x, &second.x),
            converged: self.converged | second.converged,
            worst: second.worst.replaced(self.converged, self.worst),
            evaluations: self.evaluations.saturating_add(second.evaluations),
        }
    }

    /// The outcome in each lane, with the worst row where it is no success.
    #[inline(always)]
    pub(crate) fn outcomes(&self) -> T::Lanes<Outcome> {
        let finite = self.worst.ratio.is_finite();
        T::per_lane(|lane| {
            let row = self.worst.row(lane);
            match (T::test(self.converged, lane), T::test(finite, lane)) {
                (true, _) => Outcome::Converged,
                (false, true) => Outcome::NotConverged { row },
                (false, false) => Outcome::NonFinite { row },
            }
        })
    }
}

/// Newton's method from `start` in the lanes of `active`; the others stay. At most `iterations` steps, with one
/// evaluation more.
#[inline(never)]
pub(crate) fn newton<T: Scalar, const K: usize, F: Factorization<T, K>>(
    block: &Block<T, K>,
    start: [T; K],
    active: T::Mask,
    extent: T,
    iterations: u32,
    evaluate: &mut impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
) -> Attempt<T, K> {
    let (residuals, jacobian) = evaluate(&start);
    let mut descent = Descent {
        x: start,
        residuals,
        jacobian,
        evaluations: 1,
        converged: T::mask(false),
        open: active,
        last_ratio: T::constant(1.0),
        least_ratio: T::constant(f64::MAX),
        fruitless: T::constant(0.0),
    };
    while descent.goes_on::<F>(block, extent, iterations) {
        descent.met(evaluate(&descent.x));
    }
    descent.ended(block)
}

/// Newton's method at an iterate that was evaluated, not judged.
///
/// The evaluation is not part of it: so all blocks of a size share the code.
struct Descent<T: Scalar, const K: usize> {
    x: [T; K],
    residuals: [T; K],
    jacobian: [[T; K]; K],
    evaluations: u32,
    converged: T::Mask,
    /// Lanes that are still moving.
    open: T::Mask,
    /// Largest |residual| over its tolerance at the iterate before.
    last_ratio: T,
    /// The same where it last fell.
    least_ratio: T,
    /// Iterations since.
    fruitless: T,
}

impl<T: Scalar, const K: usize> Descent<T, K> {
    /// Judges the iterate; `true` if `x` is another one, to be evaluated. Not when every lane has converged or failed, or
    /// `iterations` steps are done since the first iterate.
    #[inline(never)]
    fn goes_on<F: Factorization<T, K>>(&mut self, block: &Block<T, K>, extent: T, iterations: u32) -> bool {
        if self.evaluations > iterations {
            return false;
        }
        let tolerances = required(&block.row_scales, &self.x, &self.jacobian);
        self.judge(block, extent, &tolerances);
        if T::all(!self.open) {
            return false;
        }
        let step = self.step::<F>(block);
        let mut next = self.x;
        next.iter_mut().zip(step).for_each(|(component, change)| *component = *component + change);
        self.x = select(self.open, &next, &self.x);
        true
    }

    /// Takes up residuals and Jacobian of the iterate.
    #[inline(always)]
    fn met(&mut self, evaluated: ([T; K], [[T; K]; K])) {
        (self.residuals, self.jacobian) = evaluated;
        self.evaluations += 1;
    }

    /// Result of the iterations.
    #[inline(never)]
    fn ended(&self, block: &Block<T, K>) -> Attempt<T, K> {
        let tolerances = required(&block.row_scales, &self.x, &self.jacobian);
        let worst = Worst::of_block(block, &self.residuals, &tolerances);
        Attempt { x: self.x, converged: self.converged, worst, evaluations: self.evaluations }
    }

    /// Which lanes have converged, and which of the others are worth another step.
    #[inline(always)]
    fn judge(&mut self, block: &Block<T, K>, extent: T, tolerances: &[T; K]) {
        let one = T::constant(1.0);
        let finite = all_finite(&self.residuals, &self.jacobian);
        let ratio = largest_ratio(&self.residuals, tolerances);
        self.converged = self.converged | (self.open & finite & !one.less(ratio));
        if self.evaluations > FREE_ITERATIONS + 1 {
            let allowance = outer_rounding(extent, &block.coordinate_scales, &self.jacobian);
            let stalled = !(ratio + ratio).less(self.last_ratio);
            let rounding = within(&self.residuals, tolerances, &allowance);
            self.converged = self.converged | (self.open & finite & stalled & rounding);
        }
        self.last_ratio = ratio;
        let fell = ratio.less(T::constant(FALL) * self.least_ratio);
        self.least_ratio = T::select(fell, ratio, self.least_ratio);
        self.fruitless = T::select(fell, T::constant(0.0), self.fruitless + one);
        let fruitless = T::constant(FRUITLESS_ITERATIONS).less(self.fruitless);
        self.open = self.open & finite & !self.converged & !fruitless;
    }

    /// The next step: Newton's, capped, or the shortest where the Jacobian is singular.
    #[inline(always)]
    fn step<F: Factorization<T, K>>(&self, block: &Block<T, K>) -> [T; K] {
        let (factors, margin) = F::factorize(&self.jacobian, &block.row_scales, &block.coordinate_scales);
        let mut step = factors.solve(&self.residuals.each(|r| -r));
        let singular = self.open & !is_regular(margin);
        if !T::all(!singular) {
            step = shortest_steps(singular, step, &self.residuals, &self.jacobian, block);
        }
        capped(block, step)
    }
}

/// Minimum-norm steps in the lanes of `singular`, the given steps elsewhere.
#[cold]
#[inline(never)]
fn shortest_steps<T: Scalar, const K: usize>(
    singular: T::Mask,
    steps: [T; K],
    residuals: &[T; K],
    jacobian: &[[T; K]; K],
    block: &Block<T, K>,
) -> [T; K] {
    let shortest: T::Lanes<[T::Real; K]> = T::per_lane(|lane| {
        if !T::test(singular, lane) {
            return of_each(&steps, |step| step.lane(lane));
        }
        let mut a = [[T::Real::constant(0.0); K]; K];
        for (row, of_lanes) in a.iter_mut().zip(jacobian) {
            *row = of_each(of_lanes, |entry| entry.lane(lane));
        }
        let b = of_each(residuals, |r| -r.lane(lane));
        let row_scales = of_each(&block.row_scales, |scale| scale.lane(lane));
        let coordinate_scales = of_each(&block.coordinate_scales, |scale| scale.lane(lane));
        minimum_norm(&a, &b, &row_scales, &coordinate_scales, singular::HALF_THE_DIGITS.of()).0
    });
    let component = |lane: usize, k: usize| shortest.as_ref().get(lane).and_then(|x| x.get(k)).copied();
    core::array::from_fn(|k| T::from_lanes(|lane| component(lane, k).unwrap_or(T::Real::constant(0.0))))
}

/// The step shortened as a whole so that no angle changes by more than [`LARGEST_ANGLE_STEP`].
#[inline(always)]
pub(crate) fn capped<T: Scalar, const K: usize, const M: usize>(
    block: &Block<T, K, M>,
    step: [T; K],
) -> [T; K] {
    let (limit, largest) = (T::constant(LARGEST_ANGLE_STEP), largest_turn(block, &step));
    let beyond = limit.less(largest);
    if T::all(!beyond) {
        return step;
    }
    let factor = limit / T::select(beyond, largest, limit);
    step.each(|change| change * factor)
}

/// `true` if an angle changes by more than [`LARGEST_ANGLE_STEP`].
#[inline(always)]
fn beyond<T: Scalar, const K: usize>(block: &Block<T, K>, step: &[T; K]) -> T::Mask {
    T::constant(LARGEST_ANGLE_STEP).less(largest_turn(block, step))
}

/// Largest change of an angle.
#[inline(always)]
fn largest_turn<T: Scalar, const K: usize, const M: usize>(block: &Block<T, K, M>, step: &[T; K]) -> T {
    let mut largest = T::constant(0.0);
    for (change, is_angle) in step.iter().zip(block.angles) {
        if is_angle {
            largest = largest.max(change.abs());
        }
    }
    largest
}

/// `true` if residuals and Jacobian are finite.
#[inline(always)]
pub(crate) fn all_finite<T: Scalar, const K: usize, const M: usize>(
    residuals: &[T; M],
    jacobian: &[[T; K]; M],
) -> T::Mask {
    let mut finite = T::mask(true);
    for (residual, row) in residuals.iter().zip(jacobian) {
        finite = finite & residual.is_finite();
        for entry in row {
            finite = finite & entry.is_finite();
        }
    }
    finite
}

/// Largest |residual| over its tolerance.
#[inline(always)]
pub(crate) fn largest_ratio<T: Scalar, const K: usize>(residuals: &[T; K], tolerances: &[T; K]) -> T {
    let mut largest = T::constant(0.0);
    for (r, tolerance) in residuals.iter().zip(tolerances) {
        largest = largest.max(r.abs() / *tolerance);
    }
    largest
}

/// `true` if every residual is within its tolerance plus its allowance.
#[inline(always)]
pub(crate) fn within<T: Scalar, const K: usize>(
    residuals: &[T; K],
    tolerances: &[T; K],
    allowances: &[T; K],
) -> T::Mask {
    let mut all = T::mask(true);
    for ((r, tolerance), allowance) in residuals.iter().zip(tolerances).zip(allowances) {
        all = all & !(*tolerance + *allowance).less(r.abs());
    }
    all
}
