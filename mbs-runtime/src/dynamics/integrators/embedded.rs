//! Embedded pairs: a step, an estimate of its error, and a polynomial through it.

use crate::dynamics::integrators::equation::{Equation, ErrorNorm};
use crate::dynamics::integrators::fixed_step::FixedStep;
use crate::dynamics::integrators::vector::Vector;
use crate::failure::Failure;
use crate::scalar::number::{Real, Scalar};

/// An explicit Runge–Kutta method that estimates its own error and gives the solution between its steps.
pub trait Embedded: FixedStep {
    /// Data that a step leaves for the next one.
    type Memory<R: Copy, Y: Copy>: Copy + Default;
    /// Rates that later calls use again.
    type Stages<Y: Copy>: Copy;
    /// The polynomial of a step.
    type Dense<Y: Copy>: Copy;

    /// Numbers of the control of its steps.
    fn control(&self) -> StepControl;

    /// A step from `start`, a state and its rate, after the one that left `memory`; `span`: its beginning and its length (s).
    ///
    /// # Errors
    /// Those of the equation.
    fn trial<T: Scalar, E: Equation<T>>(
        &self,
        equation: &mut E,
        span: (T, T),
        start: (&E::State, &E::State),
        memory: &Self::Memory<T, E::State>,
    ) -> Result<AttemptOf<Self, E::State>, Failure>;

    /// The error of a trial over its tolerance.
    fn error<R: Real, E: ErrorNorm<R>>(
        equation: &E,
        h: R,
        y: &E::State,
        rate: &E::State,
        trial: &AttemptOf<Self, E::State>,
    ) -> R;

    /// The largest factor by which the next step may grow.
    #[inline]
    fn growth<Y: Copy>(&self, _stages: &Self::Stages<Y>) -> f64 {
        self.control().largest_growth
    }

    /// Data that an accepted step leaves for the next one.
    fn remember<R: Real, Y: Vector<R>>(step: &Taken<'_, R, Y, Self::Stages<Y>>) -> Self::Memory<R, Y>;

    /// The polynomial of an accepted step. `end` is the settled state and its rate, so that the polynomial meets the start of
    /// the next step.
    ///
    /// # Errors
    /// Those of the equation, where the polynomial needs stages of its own.
    fn dense<R: Real, E: Equation<R>>(
        equation: &mut E,
        step: &Taken<'_, R, E::State, Self::Stages<E::State>>,
    ) -> Result<Self::Dense<E::State>, Failure>;

    /// The polynomial at `theta`, 0 at the beginning of the step, 1 at its end.
    fn interpolate<T: Scalar, Y: Vector<T>>(dense: &Self::Dense<Y>, theta: T) -> Y;
}

/// Numbers by which the size of a method's steps is controlled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepControl {
    /// Exponent of the step size in the error estimate.
    pub error_order: u32,
    /// Largest factor by which a step may grow.
    pub largest_growth: f64,
    /// The same once steps are in tune with the motion, where the estimate may be small by chance.
    pub largest_growth_in_tune: f64,
    /// Share of the last step's error in the choice of the next, β of the controller.
    pub memory: f64,
    /// Factor by which a step that failed is tried again.
    pub retry: f64,
}

impl StepControl {
    /// Of an estimate of `error_order`: steps grow by `largest_growth` at most, without memory, and failed ones are tried with a fifth.
    #[inline]
    pub const fn of(error_order: u32, largest_growth: f64) -> Self {
        StepControl {
            error_order,
            largest_growth,
            largest_growth_in_tune: largest_growth,
            memory: 0.0,
            retry: 0.2,
        }
    }
}

/// Result of a trial step of method `X`.
pub type AttemptOf<X, Y> = StepAttempt<Y, <X as Embedded>::Stages<Y>>;

/// A step that is still to be judged.
#[derive(Clone, Copy, Debug)]
pub struct StepAttempt<Y, K> {
    /// The state that it leads to, not settled.
    pub y: Y,
    /// Its rates.
    pub stages: K,
}

/// A step that was accepted and settled.
#[derive(Clone, Copy, Debug)]
pub struct Taken<'a, R, Y, K> {
    /// Time (s) at its beginning.
    pub t: R,
    /// Its length (s).
    pub h: R,
    /// State and rate at its beginning.
    pub start: (&'a Y, &'a Y),
    /// State and rate at its end.
    pub end: (&'a Y, &'a Y),
    /// Its rates in between.
    pub stages: &'a K,
}

impl<'a, R: Copy, Y, K> Taken<'a, R, Y, K> {
    /// The same step with `stages`.
    pub(crate) fn with<L>(&self, stages: &'a L) -> Taken<'a, R, Y, L> {
        Taken { t: self.t, h: self.h, start: self.start, end: self.end, stages }
    }
}

/// Terms of [`nested`] that `start` and `end` of a step of `h` (s) fix, each a state and its rate: the cubic of Hermite.
#[inline]
pub(crate) fn hermite<R: Real, Y: Vector<R>>(h: R, (y, rate): (&Y, &Y), (end, end_rate): (&Y, &Y)) -> [Y; 3] {
    let one = R::constant(1.0);
    let change = end.plus(-one, &[1.0], [y]);
    let bend = change.zero().plus(h, &[1.0], [rate]).plus(-one, &[1.0], [&change]);
    let twist = change.plus(-h, &[1.0], [end_rate]).plus(-one, &[1.0], [&bend]);
    [change, bend, twist]
}

/// y + θ (a + (1 − θ) (b + θ (c + (1 − θ) (…)))) with the terms a, b, c, …
///
/// Source: Hairer, Nørsett & Wanner 1993, §II.6.
#[inline]
pub(crate) fn nested<T: Scalar, Y: Vector<T>, const K: usize>(
    y: &Y,
    (terms, last): (&[Y; K], &Y),
    theta: T,
) -> Y {
    let left = T::constant(1.0) - theta;
    let mut inner = *last;
    for (index, term) in terms.iter().enumerate().rev() {
        inner = term.plus(if index % 2 == 0 { left } else { theta }, &[1.0], [&inner]);
    }
    y.plus(theta, &[1.0], [&inner])
}
