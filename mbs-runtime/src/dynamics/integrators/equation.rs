//! The ordinary differential equation that an explicit integrator solves.

use crate::dynamics::integrators::event::Dense;
use crate::dynamics::integrators::vector::Vector;
use crate::failure::{Failure, FailureKind};
use crate::scalar::number::Scalar;

/// ẏ = f(t, y), with the projection of a state once a step is accepted.
pub trait Equation<T: Scalar> {
    /// State vector that is integrated.
    type State: Vector<T>;

    /// f(t, y).
    ///
    /// # Errors
    /// Any that leaves the rate undetermined.
    fn rate(&mut self, t: T, y: &Self::State) -> Result<Self::State, Failure>;

    /// [`rate`](Self::rate) compiled into the place of the call, for a loop of stages: without room for a failure the rate stays in
    /// registers. `None` where it is known by [`rate`](Self::rate) alone.
    #[inline(always)]
    fn rate_of_stage(&mut self, _t: T, _y: &Self::State) -> Option<Self::State> {
        None
    }

    /// Projects a state at the end of a step onto the constraints.
    ///
    /// # Errors
    /// If it cannot be projected.
    fn project(&mut self, _t: T, _y: &mut Self::State) -> Result<(), Failure> {
        Ok(())
    }

    /// The stages of an implicit step by collocation, Radau IIA of order 5.
    ///
    /// # Errors
    /// [`FailureKind::InvalidMethodParameter`] of an equation that does not know its slopes; [`FailureKind::EquilibriumNotConverged`] where the iteration for the
    /// stages does not converge.
    fn collocate(
        &mut self,
        _step: &Collocation<'_, T, Self::State>,
    ) -> Result<Collocated<Self::State>, Failure> {
        Err(FailureKind::InvalidMethodParameter {
            name: "number of slopes for an implicit step",
            value: 0.0,
            most: 0.0,
        }
        .without_time())
    }

    /// [`project`](Self::project), then the rate of the projected state.
    ///
    /// # Errors
    /// Those of both.
    fn settled_rate(&mut self, t: T, y: &mut Self::State) -> Result<Self::State, Failure> {
        self.project(t, y)?;
        self.rate(t, y)
    }
}

/// A step by collocation that is to be solved.
#[derive(Clone, Copy, Debug)]
pub struct Collocation<'a, T, Y> {
    /// Time (s) at its beginning.
    pub t: T,
    /// Its length (s).
    pub h: T,
    /// State at its beginning.
    pub y: &'a Y,
    /// The rate of that state.
    pub rate: &'a Y,
    /// Latest time (s) at which the equation is asked for.
    pub latest: T,
    /// Start values of the stages in their search, less the state at the beginning.
    pub predicted: [Y; 3],
}

impl<'a, T: Scalar, Y: Vector<T>> Collocation<'a, T, Y> {
    /// A step of `h` from `y` at `t` (s), whose rate is known.
    pub fn new(t: T, h: T, y: &'a Y, rate: &'a Y) -> Self {
        Collocation { t, h, y, rate, latest: t + h, predicted: [y.zero(); 3] }
    }
}

/// The stages of a step by collocation.
#[derive(Clone, Copy, Debug)]
pub struct Collocated<Y> {
    /// Stages less the state at the beginning; the last one is at the end.
    pub stages: [Y; 3],
    /// Estimate of the error at the end.
    pub error: Y,
    /// Largest ratio of one correction of the stages to the one before.
    pub contraction: f64,
}

/// An equation with tolerances, for an adaptive integrator.
pub trait ErrorNorm<T: Scalar>: Equation<T> {
    /// `false` where no step of it has a time at which it is not smooth, so that no search for one is compiled.
    const MAY_KINK: bool = true;

    /// Of each of `errors` the largest component over its tolerance, for a step from `before` to `after`: accepted up to 1.
    fn measure<const K: usize>(
        &self,
        before: &Self::State,
        after: &Self::State,
        errors: [&Self::State; K],
    ) -> [T; K];

    /// The least step (s) worth trying from the end of the last one; 0 where the time alone limits it.
    fn least_step(&self) -> T {
        T::constant(0.0)
    }

    /// A step begins at `y` at time `t` (s), which may jump there. `true` if the rate of `y` is to be evaluated anew: another part of the
    /// equation may hold from here.
    ///
    /// # Errors
    /// If no part of the equation holds from here.
    fn begin(&mut self, _t: T, _y: &mut Self::State) -> Result<bool, Failure> {
        Ok(false)
    }

    /// `true` if the equation may not be smooth at a time within the step that has begun, up to time `to` (s).
    fn may_kink(&mut self, _to: T) -> bool {
        false
    }

    /// The first time (s) within a step at which the equation is not smooth, so that steps end there: after it by rounding.
    ///
    /// # Errors
    /// If that cannot be decided.
    fn kink(&mut self, _step: &impl Dense<T, State = Self::State>) -> Result<Option<T>, Failure> {
        Ok(None)
    }

    /// The last step is taken again.
    fn retake(&mut self) {}

    /// Obstacle to every step from the end of the last one, where the equation knows.
    fn obstacle(&self) -> Option<Failure> {
        None
    }
}
