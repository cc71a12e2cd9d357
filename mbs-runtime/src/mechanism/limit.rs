//! Working ranges that a text declares: a warning before, a failure beyond.

use crate::mechanism::Entry;
use crate::scalar::number::{Real, Scalar};
use crate::tolerances::positions;

/// A quantity with the range that a `limit` of the text allows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit<T> {
    /// Lower bound, in the limit's unit; −[`OPEN`] where the text gives an upper one alone.
    pub low: T,
    /// The quantity.
    pub value: T,
    /// Upper bound; [`OPEN`] where the text gives a lower one alone.
    pub high: T,
}

/// A quantity that is next to a bound of its range; see [`Stepper::warnings`](crate::Stepper::warnings).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Warning {
    /// The limit.
    pub limit: Entry,
    /// The quantity, in the limit's unit.
    pub value: f64,
    /// The bound that is near.
    pub bound: f64,
    /// Distance to it as a share of the range: 0 at the bound, at most [`WARNING_SHARE`]. Where the range has one bound
    /// alone, a share of that bound.
    pub left: f64,
}

/// Share of the range next to each bound in which a quantity is warned of.
///
/// A twentieth at either end leaves nine tenths of the range free of warnings. A quantity that swings over the
/// whole range as a sine spends a seventh of a half period in the last twentieth: time to react.
pub const WARNING_SHARE: f64 = 0.05;

/// Magnitude of the bound on the side that a limit leaves open: larger than any quantity, and finite in single precision.
pub const OPEN: f64 = 1e30;

impl<T: Scalar> Limit<T> {
    /// Distance by which a quantity of coordinates of at most `size` may exceed `bound`: roundings of both, but of no more than
    /// the larger bound. So a bound of 1e300, written for no bound, does not widen the other one.
    fn slack(&self, bound: T, size: T) -> T {
        let largest = self.low.abs().max(self.high.abs()).min(bound.abs().max(size));
        positions::OF_BOUND.of::<T>() * largest
    }

    /// Distances to the lower and to the upper bound: not negative as long as neither is passed. `size`: that of the coordinates.
    pub(crate) fn left(&self, size: T) -> [T; 2] {
        let (low, high) = (self.slack(self.low, size), self.slack(self.high, size));
        [self.value - (self.low - low), self.high + high - self.value]
    }
}

impl<R: Real> Limit<R> {
    /// The bound that is passed, if any; NaN passes the upper one. `size`: that of the coordinates.
    pub(crate) fn passed(&self, size: impl FnOnce() -> R) -> Option<R> {
        if self.low <= self.value && self.value <= self.high {
            return None;
        }
        let [low, high] = self.left(size());
        let zero = R::constant(0.0);
        if low < zero {
            return Some(self.low);
        }
        let below = zero <= high;
        (!below).then_some(self.high)
    }

    /// The nearer bound and the distance to it as a share of the range; of one bound alone as a share of that bound.
    pub(crate) fn nearer(&self) -> (R, R) {
        let open = R::constant(OPEN);
        let range = match (self.low <= -open, open <= self.high) {
            (true, false) => self.high.abs(),
            (false, true) => self.low.abs(),
            _ => self.high - self.low,
        };
        let (below, above) = (self.value - self.low, self.high - self.value);
        let (bound, left) = if below < above { (self.low, below) } else { (self.high, above) };
        // A bound of 0 alone has no share: 0 at it, without end off it.
        let zero = R::constant(0.0);
        (bound, if left <= zero { zero } else { left / range })
    }
}

/// Largest coordinate of `q` (N), or scale of one.
pub(crate) fn size<R: Real, const N: usize>(scales: &[R; N], q: &[R; N]) -> R {
    let larger = |largest: R, (scale, q): (&R, &R)| largest.max(*scale).max(q.abs());
    scales.iter().zip(q).fold(R::constant(0.0), larger)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(value: f64) -> Limit<f64> {
        Limit { low: -1.0, value, high: 3.0 }
    }

    #[test]
    fn bounds_belong_to_the_range() {
        let passed = |value: f64| at(value).passed(|| 1.0);
        assert_eq!([-1.0, 0.0, 3.0, 3.0 + 4e-15].map(passed), [None; 4]);
        assert_eq!((passed(-1.0001), passed(3.0001)), (Some(-1.0), Some(3.0)));
        assert_eq!(passed(f64::NAN), Some(3.0));
    }

    #[test]
    fn one_bound_is_passed_on_its_side_alone() {
        let [above, below] =
            [-2.0, 0.0].map(|low| move |value| Limit { low, value, high: OPEN }.passed(|| 1.0));
        assert_eq!([-2.0, 0.0, 1e9].map(above), [None; 3]);
        assert_eq!([above(-2.1), above(f64::NAN)], [Some(-2.0), Some(OPEN)]);
        assert_eq!([0.0, 1.0].map(below), [None; 2]);
        let narrow = |value: f32| Limit { low: -OPEN as f32, value, high: 3.0 }.passed(|| 1.0);
        assert_eq!([narrow(-1e20), narrow(3.0), narrow(3.1)], [None, None, Some(3.0)]);
    }

    #[test]
    fn distances_from_a_single_bound_are_shares_of_it() {
        let left = |low: f64, value| Limit { low, value, high: OPEN }.nearer();
        assert_eq!((left(-2.0, -1.5), left(2.0, 2.0)), ((-2.0, 0.25), (2.0, 0.0)));
        assert_eq!((left(0.0, 0.0).1, left(0.0, 1e-9).1), (0.0, f64::INFINITY));
    }

    #[test]
    fn distances_from_bounds_are_shares_of_the_range() {
        assert_eq!((at(-0.8).nearer().0, at(2.0).nearer()), (-1.0, (3.0, 0.25)));
        assert_eq!(at(3.0 + 4e-15).nearer(), (3.0, 0.0));
    }
}
