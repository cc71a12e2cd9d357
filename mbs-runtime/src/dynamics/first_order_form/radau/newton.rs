//! The stages of a step: simplified Newton iterations with a real and a complex system.

use crate::dynamics::first_order_form::equations::{Equations, Moving};
use crate::dynamics::first_order_form::radau::shifted::Shifted;
use crate::dynamics::first_order_form::radau::slopes::Slopes;
use crate::dynamics::first_order_form::radau::tableau::{C, COMPLEX, ERROR, REAL, T, T_INVERSE};
use crate::dynamics::integrators::equation::{Collocated, Collocation, Equation, ErrorNorm};
use crate::dynamics::integrators::vector::Vector;
use crate::dynamics::model::Formulation;
use crate::dynamics::model::metric::worse;
use crate::failure::Failure;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::motion;

/// Iterations of a step: two to four where the tangents are good. A step that needs more is better made smaller.
const MOST_ITERATIONS: u32 = 7;

/// Iterations of a step of fixed size, which ends nearer to rounding.
const MOST_FIXED_ITERATIONS: u32 = 14;

/// Part of the tolerance that the iteration may leave, at most: the estimate of the error does not see it.
const OPEN: f64 = 0.03;

/// Part of the tolerance that rounding of the stages may be, at most.
const ROUNDED: f64 = 1.0;

/// Corrections that rounding explains, over the rounding of one position.
const ROUNDINGS: f64 = 4.0;

/// Both factorizations of a step.
pub(in crate::dynamics) struct Solver<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    slopes: &'a Slopes<S, R, N, M>,
    real: Shifted<S, R, N, M, 1>,
    complex: Shifted<S, R, N, M, 2>,
}

impl<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Solver<'a, S, R, N, M> {
    /// Those of a step of `h` (s), in the scales (N) of the coordinates; none where one of them is singular.
    fn of(slopes: &'a Slopes<S, R, N, M>, scales: &[R; N], h: R) -> Option<Self> {
        let real = Shifted::of(slopes, scales, [R::constant(REAL) / h])?;
        let complex = Shifted::of(slopes, scales, COMPLEX.map(|part| R::constant(part) / h))?;
        Some(Solver { slopes, real, complex })
    }

    fn real(&self, right: &Moving<S, R, N, M>) -> Moving<S, R, N, M> {
        let [found] = self.real.solve(self.slopes, [right]);
        found
    }

    fn complex(&self, right: [&Moving<S, R, N, M>; 2]) -> [Moving<S, R, N, M>; 2] {
        self.complex.solve(self.slopes, right)
    }
}

/// The stages of a step and the estimate of its error.
///
/// # Errors
/// [`EquilibriumNotConverged`](crate::FailureKind::EquilibriumNotConverged) where the iteration does not converge; those of the stages.
#[inline(never)]
pub(crate) fn collocate<S, F, R, const N: usize, const M: usize>(
    equations: &mut Equations<'_, S, F, R, N, M>,
    step: &Collocation<'_, R, Moving<S, R, N, M>>,
) -> Result<Collocated<Moving<S, R, N, M>>, Failure>
where
    S: Dynamic<R, N, M>,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    let slopes = equations.slopes(step)?;
    let Some(solver) = Solver::of(&slopes, equations.scales(), step.h) else {
        return Err(equations.unbalanced(step, (step.rate, 0)));
    };
    let fixed = equations.is_fixed();
    let rounds = if fixed { MOST_FIXED_ITERATIONS } else { MOST_ITERATIONS };
    let rounding = rounding(equations, step);
    let mut iteration = Iteration::new(&step.predicted, enough(equations.narrowest()), rounding);
    let mut worst = *step.rate;
    for round in 1..=rounds {
        let (correction, size) = correction(equations, &solver, step, &iteration.transformed)?;
        equations.counts.iterations += 1;
        [worst, ..] = correction;
        match iteration.take(&correction, size, rounds - round) {
            Outcome::Converged => {
                let stages = stages(&iteration.transformed);
                let error = if fixed { step.y.zero() } else { estimate(equations, &solver, step, &stages) };
                let contraction = iteration.contraction.to_f64();
                return Ok(Collocated { stages, error, contraction });
            }
            Outcome::On => {}
            Outcome::Stuck => break,
        }
    }
    Err(equations.unbalanced(step, (&worst, rounds)))
}

/// Error that the iteration may leave, over the tolerance.
fn enough<R: Real>(tolerance: R) -> R {
    let least = motion::OF_STAGES.of::<R>() / tolerance;
    least.max(R::constant(OPEN).min(tolerance.sqrt()))
}

/// Size of corrections over the tolerance that rounding of positions explains: beside stiff springs the last digit of a position
/// moves the velocity by itself over the step, however near the stages are.
fn rounding<S, F, R, const N: usize, const M: usize>(
    equations: &Equations<'_, S, F, R, N, M>,
    step: &Collocation<'_, R, Moving<S, R, N, M>>,
) -> R
where
    S: Dynamic<R, N, M>,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    let mut moved = step.y.zero();
    let (digit, over) = (R::constant(ROUNDINGS) * R::EPSILON, R::constant(REAL) / step.h);
    let sizes = step.y.y.q.iter().zip(equations.scales());
    for ((q, qd), (size, scale)) in moved.y.q.iter_mut().zip(&mut moved.y.qd).zip(sizes) {
        *q = digit * size.abs().max(*scale);
        *qd = over * *q;
    }
    let [size] = equations.measure(step.y, step.y, [&moved]);
    size.min(R::constant(ROUNDED))
}

/// The changes to the stages of which `transformed` are in the basis of both systems.
fn stages<R: Real, Y: Vector<R>>([a, b, c]: &[Y; 3]) -> [Y; 3] {
    T.map(|row| a.zero().plus(R::constant(1.0), &row, [a, b, c]))
}

/// The next correction, in the basis of both systems, and its size over the tolerance.
fn correction<S, F, R, const N: usize, const M: usize>(
    equations: &mut Equations<'_, S, F, R, N, M>,
    solver: &Solver<'_, S, R, N, M>,
    step: &Collocation<'_, R, Moving<S, R, N, M>>,
    transformed: &[Moving<S, R, N, M>; 3],
) -> Result<([Moving<S, R, N, M>; 3], R), Failure>
where
    S: Dynamic<R, N, M>,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    let (one, y) = (R::constant(1.0), step.y);
    let mut rates = stages(transformed);
    for (stage, c) in rates.iter_mut().zip(C) {
        let t = (step.t + R::constant(c) * step.h).min(step.latest);
        *stage = equations.rate(t, &y.plus(one, &[1.0], [&*stage]))?;
    }
    let [first, second, third] = &rates;
    let open = T_INVERSE.map(|row| y.zero().plus(one, &row, [first, second, third]));
    let ([w, re, im], [a, b]) = (transformed, COMPLEX);
    let [real, left, right] = &open;
    let over = one / step.h;
    let real = solver.real(&real.plus(-over, &[REAL], [w]));
    let (left, right) = (left.plus(-over, &[a, -b], [re, im]), right.plus(-over, &[a, b], [im, re]));
    let [left, right] = solver.complex([&left, &right]);
    let sizes = equations.measure(y, y, [&real, &left, &right]);
    let size = sizes.iter().fold(R::constant(0.0), |size, other| worse(size, *other));
    Ok(([real, left, right], size))
}

/// The error of a step, filtered by the real system so that stiff parts do not count, and a second time where it seems too large.
fn estimate<S, F, R, const N: usize, const M: usize>(
    equations: &mut Equations<'_, S, F, R, N, M>,
    solver: &Solver<'_, S, R, N, M>,
    step: &Collocation<'_, R, Moving<S, R, N, M>>,
    stages: &[Moving<S, R, N, M>; 3],
) -> Moving<S, R, N, M>
where
    S: Dynamic<R, N, M>,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    let (one, over) = (R::constant(1.0), R::constant(1.0) / step.h);
    let [first, second, third] = stages;
    let seen = first.zero().plus(over, &ERROR, [first, second, third]);
    let error = solver.real(&seen.plus(one, &[1.0], [step.rate]));
    let [size] = equations.measure(step.y, &step.y.plus(one, &[1.0], [third]), [&error]);
    if size < one {
        return error;
    }
    match equations.rate(step.t, &step.y.plus(one, &[1.0], [&error])) {
        Ok(rate) => solver.real(&seen.plus(one, &[1.0], [&rate])),
        Err(_) => error,
    }
}

/// The outcome of a round.
enum Outcome {
    Converged,
    On,
    Stuck,
}

/// Changes to the stages on their way.
struct Iteration<R, Y> {
    /// In the basis of both systems.
    transformed: [Y; 3],
    /// Size of the last correction over the tolerance; none before the first.
    size: Option<R>,
    /// Error that may be left, over the tolerance.
    enough: R,
    /// Size of corrections over the tolerance that rounding explains.
    rounding: R,
    /// Largest ratio of one correction to the one before.
    contraction: R,
}

impl<R: Real, Y: Vector<R>> Iteration<R, Y> {
    fn new([a, b, c]: &[Y; 3], enough: R, rounding: R) -> Self {
        let transformed = T_INVERSE.map(|row| a.zero().plus(R::constant(1.0), &row, [a, b, c]));
        Iteration { transformed, size: None, enough, rounding, contraction: R::constant(0.0) }
    }

    /// Adds a correction of `size` over the tolerance; stuck where it does not fall, or not fast enough for the rounds that are `left`.
    /// A correction that rounding explains does not fall any further.
    ///
    /// Source: Hairer & Wanner 1996, §IV.8 (stopping criterion).
    fn take(&mut self, correction: &[Y; 3], size: R, left: u32) -> Outcome {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let rate = self.size.map(|before| size / before);
        // Written so that NaN is stuck.
        let falls = rate.is_none_or(|rate| rate < one);
        let is_rounding = size <= self.rounding;
        if !size.is_finite() || !falls && !is_rounding {
            return Outcome::Stuck;
        }
        let parts = self.transformed.iter_mut().zip(correction);
        parts.for_each(|(sum, part)| *sum = sum.plus(one, &[1.0], [part]));
        self.size = Some(size);
        if size == zero {
            return Outcome::Converged;
        }
        let Some(rate) = rate else { return Outcome::On };
        if !falls {
            return Outcome::Converged;
        }
        self.contraction = self.contraction.max(rate);
        let open = rate / (one - rate) * size;
        if open < self.enough {
            return Outcome::Converged;
        }
        let hopeless = self.enough < rate.powf(R::constant(f64::from(left))) * open;
        match hopeless {
            true if is_rounding => Outcome::Converged,
            true => Outcome::Stuck,
            false => Outcome::On,
        }
    }
}
