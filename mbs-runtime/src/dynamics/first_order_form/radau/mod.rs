//! Radau IIA of order 5: adaptive implicit steps for stiff forces, smoothed friction, control loops with short time constants.

pub(crate) mod newton;
pub(crate) mod shifted;
pub(crate) mod slopes;
pub(crate) mod split;
pub(crate) mod tableau;

use crate::dynamics::first_order_form::radau::newton::Solver;
use crate::dynamics::first_order_form::radau::slopes::Slopes;
use crate::dynamics::integrators::embedded::{Embedded, StepAttempt, StepControl, Taken};
use crate::dynamics::integrators::equation::{Collocated, Collocation, Equation, ErrorNorm};
use crate::dynamics::integrators::fixed_step::FixedStep;
use crate::dynamics::integrators::vector::Vector;
use crate::dynamics::model::metric::Tolerance;
use crate::failure::{Failure, FailureKind};
use crate::scalar::number::{Real, Scalar};
use crate::tolerances::motion;

/// Radau IIA with three stages: order 5, L-stable, stiffly accurate, with an error estimate of order 3 and dense output of order 3.
///
/// The equations of motion have index 1 in it: each stage solves M q̈ + Φ_qᵀ λ = Q, Φ_q q̈ = γ. The formulation projects
/// positions and velocities at the end of the step. The stages are found by simplified Newton iterations on (q, q̇) and the
/// first-order states. Each step has one real and one complex system of N unknowns, from the exact tangents about its start.
/// If they do not converge, as across the kink of smoothed friction, the step is made smaller. A step of fixed size is then
/// taken in parts, and its iteration ends at 1e-10 in the reference metric.
///
/// The factors are on the stack, see [`Radau5::stack`]; N + M above [`Radau5::MOST_UNKNOWNS`] does not compile:
///
/// ```compile_fail
/// use mbs_runtime::dynamics::{Explicit, Projection, Radau5, Simulation};
/// mbs_runtime::mechanism! {
///     pub mechanism Chain;
///     coord p: [m; 61, 2] = 0;
///     for i in 0..61 { body bob { mass: 1, com: p[i] } }
/// }
/// let method = Explicit::new(Radau5, Projection::default());
/// let mut run = Simulation::start_from_text(Chain::default(), method, 0.0_f64).unwrap();
/// run.advance_to(1.0).unwrap();
/// ```
///
/// Source: Hairer & Wanner 1996, §§IV.5, IV.8; Eich 1993 for the projection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Radau5;

/// Ratio of corrections that the next step may be expected to have: it grows with the step.
const CONTRACTION: f64 = 0.5;

/// Largest factor by which a step may grow.
const LARGEST_GROWTH: f64 = 8.0;

/// Ratio of a step of fixed size to its smallest parts, taken where the iteration for its stages does not converge.
const PIECES: u32 = 1 << 20;

/// Parts of one step of fixed size that are tried.
const MOST_TRIALS: u32 = 4096;

/// The tolerance of the iteration in steps of fixed size.
pub(crate) fn of_fixed_steps<R: Real>() -> Tolerance<R> {
    let tolerance = motion::OF_FIXED_STEPS.of();
    Tolerance { relative: tolerance, absolute: tolerance }
}

impl Radau5 {
    /// Most coordinates and rows together: the matrices of a step then take 1.5 MB of stack in double precision.
    pub const MOST_UNKNOWNS: usize = 120;

    /// Bytes of stack for the matrices of a step, for a mechanism `S` of N coordinates and M rows. They are the
    /// slopes of the accelerations, the real and the complex factors.
    pub const fn stack<S, R, const N: usize, const M: usize>() -> usize
    where
        S: crate::mechanism::dynamic::Dynamic<R, N, M>,
        R: Real,
    {
        size_of::<Slopes<S, R, N, M>>() + size_of::<Solver<'_, S, R, N, M>>()
    }
}

impl FixedStep for Radau5 {
    #[inline]
    fn order(&self) -> u32 {
        5
    }

    #[inline]
    fn uses_slopes(&self) -> bool {
        true
    }

    #[inline(never)]
    fn step<T: Scalar, E: Equation<T>>(
        &self,
        equation: &mut E,
        t: T,
        h: T,
        y: &E::State,
        rate: &E::State,
    ) -> Result<E::State, Failure> {
        let (mut y, mut rate, mut done, mut piece) = (*y, *rate, 0, PIECES);
        let mut failure = FailureKind::StepTooSmall { step: 0.0 }.at(0.0);
        for _ in 0..MOST_TRIALS {
            let at = |place: u32| t + h * T::constant(f64::from(place) / f64::from(PIECES));
            let (start, end) = (at(done), at(done + piece));
            match equation.collocate(&Collocation::new(start, end - start, &y, &rate)) {
                Ok(Collocated { stages: [_, _, change], .. }) => {
                    y = y.plus(T::constant(1.0), &[1.0], [&change]);
                    done += piece;
                    if done == PIECES {
                        return Ok(y);
                    }
                    rate = equation.rate(at(done), &y)?;
                    // Twice as long again where two of a size are through.
                    piece = if done.is_multiple_of(2 * piece) { 2 * piece } else { piece };
                }
                Err(unbalanced @ Failure { kind: FailureKind::EquilibriumNotConverged { .. }, .. })
                    if piece > 1 =>
                {
                    (failure, piece) = (unbalanced, piece / 2);
                }
                Err(other) => return Err(other),
            }
        }
        Err(failure)
    }
}

impl Embedded for Radau5 {
    type Memory<R: Copy, Y: Copy> = Option<Past<R, Y>>;
    type Stages<Y: Copy> = Collocated<Y>;
    type Dense<Y: Copy> = [Y; 4];

    #[inline]
    fn control(&self) -> StepControl {
        StepControl { retry: 0.5, ..StepControl::of(4, LARGEST_GROWTH) }
    }

    #[inline(never)]
    fn trial<T: Scalar, E: Equation<T>>(
        &self,
        equation: &mut E,
        (t, h): (T, T),
        (y, rate): (&E::State, &E::State),
        memory: &Option<Past<T, E::State>>,
    ) -> Result<StepAttempt<E::State, Collocated<E::State>>, Failure> {
        let mut step = Collocation::new(t, h, y, rate);
        if let Some(past) = memory {
            step.predicted = past.predicted(h);
        }
        let stages = equation.collocate(&step)?;
        let [_, _, change] = &stages.stages;
        Ok(StepAttempt { y: y.plus(T::constant(1.0), &[1.0], [change]), stages })
    }

    fn error<R: Real, E: ErrorNorm<R>>(
        equation: &E,
        _: R,
        y: &E::State,
        _: &E::State,
        trial: &StepAttempt<E::State, Collocated<E::State>>,
    ) -> R {
        let [error] = equation.measure(y, &trial.y, [&trial.stages.error]);
        error
    }

    fn growth<Y: Copy>(&self, stages: &Collocated<Y>) -> f64 {
        (CONTRACTION / stages.contraction).clamp(1.0, LARGEST_GROWTH)
    }

    fn remember<R: Real, Y: Vector<R>>(step: &Taken<'_, R, Y, Collocated<Y>>) -> Option<Past<R, Y>> {
        Some(Past { h: step.h, course: course(step) })
    }

    /// The cubic through the beginning of the step, two stages and the settled end.
    fn dense<R: Real, E: Equation<R>>(
        _: &mut E,
        step: &Taken<'_, R, E::State, Collocated<E::State>>,
    ) -> Result<[E::State; 4], Failure> {
        Ok(course(step))
    }

    fn interpolate<T: Scalar, Y: Vector<T>>([start, linear, quadratic, cubic]: &[Y; 4], theta: T) -> Y {
        let bend = quadratic.plus(theta, &[1.0], [cubic]);
        let slope = linear.plus(theta, &[1.0], [&bend]);
        start.plus(theta, &[1.0], [&slope])
    }
}

/// The cubic of a step that was accepted.
#[derive(Clone, Copy, Debug)]
pub struct Past<R, Y> {
    /// Length of the step (s).
    h: R,
    course: [Y; 4],
}

impl<T: Scalar, Y: Vector<T>> Past<T, Y> {
    /// Stages of a next step of `h` (s) less the state at its beginning, by the cubic.
    fn predicted(&self, h: T) -> [Y; 3] {
        let (one, ratio) = (T::constant(1.0), h / self.h);
        let at = |theta: T| Radau5::interpolate(&self.course, theta);
        let end = at(one);
        tableau::C.map(|c| at(one + T::constant(c) * ratio).plus(-one, &[1.0], [&end]))
    }
}

/// The cubic of a step: a state and the terms in θ, θ², θ³.
fn course<R: Real, Y: Vector<R>>(step: &Taken<'_, R, Y, Collocated<Y>>) -> [Y; 4] {
    let (start, end) = (step.start.0, step.end.0);
    let change = end.plus(R::constant(-1.0), &[1.0], [start]);
    let [first, second, _] = &step.stages.stages;
    let term = |weights: &[f64; 3]| start.zero().plus(R::constant(1.0), weights, [first, second, &change]);
    let [linear, quadratic, cubic] = &tableau::DENSE;
    [*start, term(linear), term(quadratic), term(cubic)]
}
