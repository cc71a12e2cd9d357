//! One motion between two dwells.

use core::marker::PhantomData;

use crate::driver::enclosures::{Union, within_periods};
use crate::driver::error::LawError;
use crate::driver::law::{Law, Stretch, enclosure, jet};
use crate::mechanism::function::Function;
use crate::scalar::interval::Interval;
use crate::scalar::number::Scalar;

/// A motion from one height to another by the law `L`; rest before and after.
///
/// `h(x) = from + (to − from) s((x − start)/duration)`.
///
/// ```
/// use mbs_runtime::{Function, driver::{Polynomial4567, Rise}};
///
/// let lift: Rise<Polynomial4567> = Rise::new(0.0, 2.0, 0.0, 0.01)?; // 10 mm within 2 s
/// assert_eq!(lift.jet(3.0), [0.01, 0.0, 0.0, 0.0]);
/// assert_eq!(lift.jet(1.0), [0.005, 0.01 * 35.0 / 32.0]);
/// # Ok::<(), mbs_runtime::driver::LawError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rise<L> {
    start: f64,
    duration: f64,
    from: f64,
    to: f64,
    law: PhantomData<L>,
}

impl<L: Law> Rise<L> {
    /// `start` and `duration` in the argument's unit, `from` and `to` in the function's.
    ///
    /// # Errors
    /// [`LawError::NotFinite`]; [`LawError::NotPositive`] for the duration.
    pub const fn new(start: f64, duration: f64, from: f64, to: f64) -> Result<Self, LawError> {
        if !(start.is_finite() && duration.is_finite() && (start + duration).is_finite()) {
            return Err(LawError::NotFinite("start or duration"));
        }
        if !(from.is_finite() && to.is_finite() && (to - from).is_finite()) {
            return Err(LawError::NotFinite("height"));
        }
        if !(duration > 0.0 && (1.0 / duration).is_finite()) {
            return Err(LawError::NotPositive("duration"));
        }
        Ok(Rise { start, duration, from, to, law: PhantomData })
    }

    fn stretch(&self, x: f64) -> Stretch {
        let rise = self.to - self.from;
        if x < self.start {
            Stretch { origin: x, rate: 0.0, from: self.from, rise: 0.0 }
        } else if self.start + self.duration < x {
            Stretch { origin: x, rate: 0.0, from: self.to, rise: 0.0 }
        } else {
            Stretch { origin: self.start, rate: 1.0 / self.duration, from: self.from, rise }
        }
    }
}

impl<T: Scalar, L: Law> Function<T> for Rise<L> {
    const ORDER: usize = L::ORDER;

    #[inline]
    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        jet::<L, T, K>(x, |x| self.stretch(x))
    }

    fn breakpoint_after(&self, x: f64) -> Option<f64> {
        [self.start, self.start + self.duration].into_iter().find(|place| x < *place)
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        let [from, to] = within_periods([from, to], self.start, None)?;
        let end = self.start + self.duration;
        let mut union = Union::default();
        if from <= self.start {
            union.add(enclosure::<L, K>(self.stretch(f64::NEG_INFINITY), [from, to]));
        }
        if from <= end && self.start <= to {
            let rise = self.to - self.from;
            let moving = Stretch { origin: self.start, rate: 1.0 / self.duration, from: self.from, rise };
            union.add(enclosure::<L, K>(moving, [from.max(self.start), to.min(end)]));
        }
        if end <= to {
            union.add(enclosure::<L, K>(self.stretch(f64::INFINITY), [from, to]));
        }
        union.bounds()
    }
}
