//! The ordinary differential equation that an explicit integrator solves.

use super::event::Dense;
use super::vector::Vector;
use crate::{Failure, Scalar};

/// ẏ = f(t, y), with what is done to a state once a step is accepted.
pub trait Equation<T: Scalar> {
    /// What is integrated.
    type State: Vector<T>;

    /// f(t, y).
    ///
    /// # Errors
    /// Whatever leaves the rate undetermined.
    fn rate(&mut self, t: T, y: &Self::State) -> Result<Self::State, Failure>;

    /// Puts a state that a step ended in back where it belongs: onto the constraints.
    ///
    /// # Errors
    /// Where it cannot be put back.
    fn settle(&mut self, _t: T, _y: &mut Self::State) -> Result<(), Failure> {
        Ok(())
    }

    /// The stages of an implicit step by collocation, Radau IIA of order 5.
    ///
    /// # Errors
    /// [`Failure::Unsuitable`] of an equation that does not know its slopes; [`Failure::Unbalanced`] where the iteration for the
    /// stages does not converge.
    fn collocate(
        &mut self,
        _step: &Collocation<'_, T, Self::State>,
    ) -> Result<Collocated<Self::State>, Failure> {
        Err(Failure::Unsuitable { name: "number of slopes for an implicit step", value: 0.0, most: 0.0 })
    }

    /// [`settle`](Self::settle), then the rate of what came of it.
    ///
    /// # Errors
    /// Those of both.
    fn settled_rate(&mut self, t: T, y: &mut Self::State) -> Result<Self::State, Failure> {
        self.settle(t, y)?;
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
    /// Where the search for the stages starts, less the state at the beginning.
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

/// An equation with tolerances: what an adaptive integrator needs.
pub trait Measured<T: Scalar>: Equation<T> {
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

    /// A step begins at `y` at time `t` (s). Whether the rate of `y` is to be evaluated anew: another part of the equation may hold from here.
    fn begin(&mut self, _t: T, _y: &Self::State) -> bool {
        false
    }

    /// Whether the equation may not be smooth at a time within the step that has begun, up to time `to` (s).
    fn may_kink(&mut self, _to: T) -> bool {
        false
    }

    /// The first time (s) within a step at which the equation is not smooth, so that steps end there: behind it by rounding.
    ///
    /// # Errors
    /// Where that cannot be told.
    fn kink(&mut self, _step: &impl Dense<T, State = Self::State>) -> Result<Option<T>, Failure> {
        Ok(None)
    }

    /// The last step is taken again.
    fn retake(&mut self) {}

    /// Why no step from the end of the last one is accurate enough, where the equation knows.
    fn obstacle(&self) -> Option<Failure> {
        None
    }
}
