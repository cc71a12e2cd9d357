//! Periodic cam laws: rises, returns and dwells, one after the other.

use core::marker::PhantomData;

use crate::driver::enclosures::{Union, within_periods};
use crate::driver::error::LawError;
use crate::driver::law::{Law, Stretch, enclosure, jet};
use crate::driver::piecewise::turns;
use crate::mechanism::function::Function;
use crate::scalar::interval::Interval;
use crate::scalar::number::Scalar;

/// A part of a cam law that ends at an argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    until: f64,
    /// NaN in a dwell.
    height: f64,
    moves: bool,
}

impl Segment {
    /// To `height` (function's unit), reached at `until` (argument's unit).
    pub const fn to(height: f64, until: f64) -> Self {
        Segment { until, height, moves: true }
    }

    /// At the height of the segment before, until `until` (argument's unit).
    pub const fn dwell(until: f64) -> Self {
        Segment { until, height: f64::NAN, moves: false }
    }
}

/// A periodic law of `S` segments that all move by the law `L`.
///
/// It closes by construction: the first segment begins at the height that the last one ends at. A rise may be
/// followed by a return without a dwell between, with the same continuity.
///
/// ```
/// use core::f64::consts::{PI, TAU};
/// use mbs_runtime::{Function, driver::{Polynomial345, Segment, Segments}};
///
/// // Rise by 8 mm within a third of a turn, dwell, return, dwell.
/// const PARTS: [Segment; 4] =
///     [Segment::to(0.008, TAU / 3.0), Segment::dwell(PI), Segment::to(0.0, 5.0), Segment::dwell(TAU)];
/// let lift: Segments<Polynomial345, 4> = Segments::new(0.0, PARTS)?;
/// assert_eq!(lift.jet(3.0 - TAU), [0.008, 0.0, 0.0]);
/// # Ok::<(), mbs_runtime::driver::LawError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segments<L, const S: usize> {
    start: f64,
    period: f64,
    stretches: [Stretch; S],
    law: PhantomData<L>,
}

impl<L: Law, const S: usize> Segments<L, S> {
    /// Segments from `start` on; the period is their total length.
    ///
    /// # Errors
    /// [`LawError::SegmentNotFinite`], [`LawError::SegmentEmpty`] with the segment's index; [`LawError::NoHeight`].
    pub const fn new(start: f64, segments: [Segment; S]) -> Result<Self, LawError> {
        const { assert!(S > 0, "a law has at least one segment") };
        if !start.is_finite() {
            return Err(LawError::NotFinite("start"));
        }
        let Some(mut height) = last_height(&segments) else { return Err(LawError::NoHeight) };
        let nothing = Stretch { origin: start, rate: 0.0, from: height, rise: 0.0 };
        let (mut stretches, mut origin, mut index) = ([nothing; S], start, 0);
        let (mut rest, mut open): (&[Segment], &mut [Stretch]) = (&segments, &mut stretches);
        while let ([segment, others @ ..], [stretch, behind @ ..]) = (rest, open) {
            let to = if segment.moves { segment.height } else { height };
            if !(segment.until.is_finite() && to.is_finite() && (to - height).is_finite()) {
                return Err(LawError::SegmentNotFinite(index));
            }
            let duration = segment.until - origin;
            if !(duration > 0.0 && (1.0 / duration).is_finite()) {
                return Err(LawError::SegmentEmpty(index));
            }
            *stretch = Stretch { origin, rate: 1.0 / duration, from: height, rise: to - height };
            (height, origin, index) = (to, segment.until, index + 1);
            (rest, open) = (others, behind);
        }
        Ok(Segments { start, period: origin - start, stretches, law: PhantomData })
    }

    /// Total length of the segments, in the argument's unit.
    pub const fn period(&self) -> f64 {
        self.period
    }

    fn stretch(&self, x: f64) -> Stretch {
        let shift = turns(x, self.start, self.period) * self.period;
        let local = x - shift;
        let begun = self.stretches.partition_point(|stretch| stretch.origin <= local);
        let rest = Stretch { origin: x, rate: 0.0, from: f64::NAN, rise: 0.0 };
        let found = self.stretches.get(begun.saturating_sub(1)).copied().unwrap_or(rest);
        Stretch { origin: shift + found.origin, ..found }
    }
}

/// The height at which the last segment ends.
const fn last_height<const S: usize>(segments: &[Segment; S]) -> Option<f64> {
    let (mut height, mut rest): (_, &[Segment]) = (None, segments);
    while let [segment, others @ ..] = rest {
        if segment.moves {
            height = Some(segment.height);
        }
        rest = others;
    }
    height
}

impl<T: Scalar, L: Law, const S: usize> Function<T> for Segments<L, S> {
    const ORDER: usize = L::ORDER;

    #[inline]
    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        jet::<L, T, K>(x, |x| self.stretch(x))
    }

    fn breakpoint_after(&self, x: f64) -> Option<f64> {
        // The turn before too: rounding may have put `x` into the next one.
        let turn = turns(x, self.start, self.period);
        let places =
            |turn: f64| self.stretches.iter().map(move |stretch| stretch.origin + turn * self.period);
        [turn - 1.0, turn, turn + 1.0].into_iter().flat_map(places).find(|place| x < *place)
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        let [from, to] = within_periods([from, to], self.start, Some(self.period))?;
        let mut union = Union::default();
        for offset in [0.0, self.period] {
            for (j, stretch) in self.stretches.iter().enumerate() {
                let next = self.stretches.get(j.saturating_add(1)).map(|next| next.origin);
                let end = next.unwrap_or(self.start + self.period) + offset;
                let origin = stretch.origin + offset;
                if origin <= to && from <= end {
                    let moved = Stretch { origin, ..*stretch };
                    union.add(enclosure::<L, K>(moved, [from.max(origin), to.min(end)]));
                }
            }
        }
        union.bounds()
    }
}
