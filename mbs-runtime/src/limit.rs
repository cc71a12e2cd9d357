//! Working ranges that a text declares: a warning before, a failure beyond.

use crate::kinematics::entry;
use crate::{Entry, Failure, Kinematic, Mechanism, Real, Scalar, Stepper};

/// A quantity with the range that a `limit` of the text allows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit<T> {
    /// Lower bound, in the limit's unit.
    pub low: T,
    /// The quantity.
    pub value: T,
    /// Upper bound.
    pub high: T,
}

/// A quantity that is next to a bound of its range; see [`Stepper::warnings`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Warning {
    /// The limit.
    pub limit: Entry,
    /// The quantity, in the limit's unit.
    pub value: f64,
    /// The bound that is near.
    pub bound: f64,
    /// What is left to it, as a share of the range: 0 at the bound, at most [`WARNING_SHARE`].
    pub left: f64,
}

/// Share of the range next to each bound in which a quantity is warned of.
///
/// A twentieth at either end leaves nine tenths of the range free of warnings, and a quantity that swings over the
/// whole range as a sine spends a seventh of a half period in the last twentieth: time to react.
pub const WARNING_SHARE: f64 = 0.05;

/// Roundings of the larger bound by which a quantity may pass it: those that a closed position may hold, so that a
/// dead centre that stands on the bound is not beyond it.
const BOUND_ROUNDINGS: f64 = 64.0;

impl<T: Scalar> Limit<T> {
    fn slack(&self) -> T {
        T::constant(BOUND_ROUNDINGS) * T::splat(T::Real::EPSILON) * self.low.abs().max(self.high.abs())
    }

    /// What is left to the lower and to the upper bound: not negative as long as neither is passed.
    pub(crate) fn left(&self) -> [T; 2] {
        let slack = self.slack();
        [self.value - (self.low - slack), self.high + slack - self.value]
    }
}

impl<R: Real> Limit<R> {
    /// The bound that is passed, if any; NaN passes the upper one.
    fn passed(&self) -> Option<R> {
        let slack = self.slack();
        if self.value < self.low - slack {
            return Some(self.low);
        }
        let below = self.value <= self.high + slack;
        (!below).then_some(self.high)
    }

    /// The nearer bound and what is left to it as a share of the range.
    fn nearer(&self) -> (R, R) {
        let range = self.high - self.low;
        let (below, above) = (self.value - self.low, self.high - self.value);
        let (bound, left) = if below < above { (self.low, below) } else { (self.high, above) };
        (bound, (left / range).max(R::constant(0.0)))
    }
}

/// The first limit that is passed, if any.
#[inline(always)]
pub(crate) fn limit_failure<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    position: &S::Position,
    t: R,
) -> Option<Failure> {
    if S::LIMITS.is_empty() {
        return None;
    }
    let limits = mechanism.limits(parameters, position);
    let passed = |(index, limit): (usize, &Limit<R>)| limit.passed().map(|bound| (index, *limit, bound));
    let (index, limit, bound) = limits.as_ref().iter().enumerate().find_map(passed)?;
    Some(passed_failure(S::LIMITS, index, (&limit, bound), t))
}

/// The failure of the limit at `index` whose bound is passed.
pub(crate) fn passed_failure<R: Real>(
    limits: &'static [Entry],
    index: usize,
    (Limit { value, .. }, bound): (&Limit<R>, R),
    t: R,
) -> Failure {
    let limit = entry(limits, u16::try_from(index).unwrap_or(u16::MAX));
    match value.is_finite() {
        true => {
            Failure::BeyondLimit { limit, value: value.to_f64(), bound: bound.to_f64(), time: t.to_f64() }
        }
        false => Failure::NonFinite { name: limit.name, line: limit.line },
    }
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// The working ranges of the text with where the mechanism stands in them.
    pub fn limits(&self) -> S::Limits {
        self.mechanism.limits(&self.parameters, &self.position())
    }

    /// The quantities that are within [`WARNING_SHARE`] of a bound of their range, at the present position. A position
    /// beyond a bound is never the present one: the step that leads there is refused with
    /// [`Failure::BeyondLimit`].
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

#[cfg(test)]
mod tests {
    use super::*;

    fn at(value: f64) -> Limit<f64> {
        Limit { low: -1.0, value, high: 3.0 }
    }

    #[test]
    fn bounds_belong_to_the_range() {
        assert_eq!([-1.0, 0.0, 3.0, 3.0 + 4e-15].map(|value| at(value).passed()), [None; 4]);
        assert_eq!((at(-1.0001).passed(), at(3.0001).passed()), (Some(-1.0), Some(3.0)));
        assert_eq!(at(f64::NAN).passed(), Some(3.0));
    }

    #[test]
    fn what_is_left_is_a_share_of_the_range() {
        assert_eq!((at(-0.8).nearer().0, at(2.0).nearer()), (-1.0, (3.0, 0.25)));
        assert_eq!(at(3.0 + 4e-15).nearer(), (3.0, 0.0));
    }
}
