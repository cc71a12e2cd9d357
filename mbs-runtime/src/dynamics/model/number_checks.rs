//! Checks of states, and of what is solved from them, for what is no number.

use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::Model;
use crate::failure::{Failure, checks};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Fails where a coordinate, velocity or state is no number, or a coordinate is not resolved.
    #[inline]
    pub(crate) fn check(&self, t: R, y: &IntegratorState<R, N, S::States>) -> Result<(), Failure> {
        let finite = |values: &[R]| values.iter().fold(true, |all, value| all & value.is_finite());
        let resolved = checks::are_resolved(&y.q, &self.metric.coordinates);
        if t.is_finite() & resolved & finite(&y.qd) & finite(y.states.as_ref()) {
            return Ok(());
        }
        self.failure_of(t, y)
    }

    /// The failure of a state that [`check`](Self::check) does not pass.
    #[cold]
    #[inline(never)]
    fn failure_of(&self, t: R, y: &IntegratorState<R, N, S::States>) -> Result<(), Failure> {
        let bad = checks::time_failure(t)
            .or_else(|| checks::coordinate_failure::<S, R, N, M>(&y.q, &self.metric.coordinates, t))
            .or_else(|| checks::non_finite(&y.qd, S::COORDINATES))
            .or_else(|| checks::non_finite_among(y.states.as_ref(), S::STATES));
        bad.map_or(Ok(()), Err)
    }

    /// Fails with the name of the acceleration, multiplier or force that is no number.
    #[inline(always)]
    pub(crate) fn check_solved(
        &self,
        qdd: &[R; N],
        lambda: &[R; M],
        force: &[R; N],
        gamma: &[R; M],
    ) -> Result<(), Failure> {
        let finite = |values: &[R]| values.iter().fold(true, |all, value| all & value.is_finite());
        if finite(qdd) && finite(lambda) {
            return Ok(());
        }
        let bad = checks::non_finite(force, S::COORDINATES)
            .or_else(|| checks::non_finite(gamma, S::ROWS))
            .or_else(|| checks::non_finite(qdd, S::COORDINATES))
            .or_else(|| checks::non_finite(lambda, S::ROWS));
        bad.map_or(Ok(()), Err)
    }
}
