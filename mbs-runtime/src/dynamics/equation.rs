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

    /// [`settle`](Self::settle), then the rate of what came of it.
    ///
    /// # Errors
    /// Those of both.
    fn settled_rate(&mut self, t: T, y: &mut Self::State) -> Result<Self::State, Failure> {
        self.settle(t, y)?;
        self.rate(t, y)
    }
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

    /// Whether the equation may not be smooth at a time within a step from `y` at time `from` to time `to` (s).
    fn may_kink(&mut self, _from: T, _y: &Self::State, _to: T) -> bool {
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
