//! Working ranges of a moving mechanism: where it is in them, and warnings near a bound.

use crate::mechanism::Kinematic;
use crate::mechanism::limit::{WARNING_SHARE, Warning};
use crate::scalar::number::Real;
use crate::stepper::Stepper;

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// The working ranges of the text, each with its quantity at the present position.
    pub fn limits(&self) -> S::Limits {
        self.mechanism.limits(&self.parameters, &self.position())
    }

    /// The quantities that are within [`WARNING_SHARE`] of a bound of their range, at the present position. A position
    /// beyond a bound is never the present one: the step that leads there is refused with
    /// [`BeyondLimit`](crate::FailureKind::BeyondLimit).
    pub fn warnings(&self) -> impl Iterator<Item = Warning> {
        let limits = self.limits();
        let count = limits.as_ref().len();
        (0..count).filter_map(move |index| {
            let limit = limits.as_ref().get(index)?;
            let (bound, left) = limit.nearer();
            let entry = S::LIMITS.get(index).copied()?;
            (left < R::constant(WARNING_SHARE)).then(|| Warning {
                limit: entry,
                value: limit.value.to_f64(),
                bound: bound.to_f64(),
                left: left.to_f64(),
            })
        })
    }
}
