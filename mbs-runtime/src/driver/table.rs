//! Tables of polynomials between knots.

use core::array::from_fn;

use crate::driver::enclosures::{Union, of_polynomial, within_periods};
use crate::driver::piecewise::{distance, each, floor, taylor};
use crate::linear_algebra::parts::at;
use crate::mechanism::function::Function;
use crate::scalar::interval::Interval;
use crate::scalar::number::{Real, Scalar};

/// Polynomials of `C` coefficients between knots, `C` − 2 times continuously differentiable: a spline.
///
/// A view of numbers stored elsewhere: in flash, in a [`CubicSpline`](crate::driver::cubic_spline::CubicSpline), on a heap. Piece
/// j is Σ cᵢ (x − knotⱼ)ⁱ from its knot to the next one. Evenly spaced knots are found at once, others by halving.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table<'a, const C: usize> {
    pub(super) knots: &'a [f64],
    pub(super) pieces: &'a [[f64; C]],
    pub(super) period: Option<f64>,
    /// 1 over the length of the table, which is that of the period or of all intervals.
    pub(super) rate: f64,
}

impl<'a, const C: usize> Table<'a, C> {
    /// As many pieces as knots; the last one holds beyond the last knot.
    ///
    /// Before the first knot the first piece goes on without its highest power. So value, slope and curvature of a cubic
    /// spline are continued: a straight line where it ends naturally, a parabola elsewhere.
    pub const fn open(knots: &'a [f64], pieces: &'a [[f64; C]]) -> Self {
        Table { knots, pieces, period: None, rate: rate(knots, None) }
    }

    /// As many pieces as knots; the last one holds until the first knot of the next period.
    pub const fn periodic(knots: &'a [f64], pieces: &'a [[f64; C]], period: f64) -> Self {
        Table { knots, pieces, period: Some(period), rate: rate(knots, Some(period)) }
    }

    /// Value and the first three derivatives at `x`; derivatives beyond `ORDER` are those of the piece that begins at `x`.
    #[inline]
    pub fn derivatives<T: Scalar>(&self, x: T) -> [T; 4] {
        self.jet(x)
    }

    /// Number of whole periods before `x`, as an argument; 0 where there is none.
    #[inline]
    fn shift(&self, x: f64) -> f64 {
        let (Some(period), Some(first)) = (self.period, self.knots.first()) else { return 0.0 };
        floor((x - first) * self.rate) * period
    }

    /// The piece at `x`.
    #[inline(always)]
    fn place(&self, x: f64) -> Place<'a, C> {
        let first = self.knots.first().copied().unwrap_or(f64::NAN);
        // In lengths of the table.
        let place = (x - first) * self.rate;
        let (turns, shift, intervals) = match self.period {
            Some(period) => {
                let turns = floor(place);
                (turns, turns * period, self.knots.len())
            }
            None => (0.0, 0.0, self.knots.len().saturating_sub(1)),
        };
        let local = x - shift;
        // The piece there of evenly spaced knots; 0 for NaN, and for what is negative.
        let guess = ((place - turns) * intervals as f64) as u32 as usize;
        if let (Some(knot), Some(coefficients)) = (self.knots.get(guess), self.pieces.get(guess)) {
            let end = match (self.knots.get(guess.saturating_add(1)), self.period) {
                (Some(next), _) => *next,
                (None, Some(period)) => first + period,
                (None, None) => f64::INFINITY,
            };
            if *knot <= local && local < end {
                return Place { origin: shift + knot, coefficients, is_before: false };
            }
        }
        // By its parts, which are in registers, and seldom.
        searched_piece(self.knots, self.pieces, self.period, (local, shift))
    }
}

/// A piece where it is stored: copied as a whole it would have to reach the memory before its first number is read.
#[derive(Clone, Copy)]
struct Place<'a, const C: usize> {
    origin: f64,
    coefficients: &'a [f64; C],
    /// `true` before the first knot, where the highest power is left out.
    is_before: bool,
}

impl<const C: usize> Place<'_, C> {
    #[inline(always)]
    fn coefficient(&self, j: usize) -> f64 {
        if self.is_before && C == j + 1 { 0.0 } else { at(self.coefficients, j) }
    }
}

/// The piece at `x`, by halving; `shift`: the whole periods that `x` is less by.
#[inline(never)]
fn searched_piece<'a, const C: usize>(
    knots: &'a [f64],
    pieces: &'a [[f64; C]],
    period: Option<f64>,
    (x, shift): (f64, f64),
) -> Place<'a, C> {
    let index = searched(knots, x);
    // So many periods away that the rest after them has no digit left.
    let first = knots.first().copied().unwrap_or(f64::NAN);
    let kept = period.is_none_or(|period| (x - first).abs() <= 2.0 * period);
    match (knots.get(index), pieces.get(index)) {
        (Some(knot), Some(coefficients)) if kept => {
            let is_before = period.is_none() && x < *knot;
            Place { origin: shift + knot, coefficients, is_before }
        }
        _ => Place { origin: f64::NAN, coefficients: &const { [f64::NAN; C] }, is_before: false },
    }
}

/// Number of the last knot that is not above `x`, by halving.
fn searched(knots: &[f64], x: f64) -> usize {
    knots.partition_point(|knot| *knot <= x).saturating_sub(1)
}

const fn rate(knots: &[f64], period: Option<f64>) -> f64 {
    match (knots, period) {
        (_, Some(period)) => 1.0 / period,
        ([first, .., last], None) => 1.0 / (*last - *first),
        _ => f64::NAN,
    }
}

impl<T: Scalar, const C: usize> Function<T> for Table<'_, C> {
    const ORDER: usize = C.saturating_sub(2);

    #[inline]
    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        let places = T::per_lane(|lane| self.place(x.lane(lane).to_f64()));
        let distance = distance(x, &places, |place: &Place<'_, C>| place.origin);
        taylor::<T, C, K>(from_fn(|j| each(&places, |place: &Place<'_, C>| place.coefficient(j))), distance)
    }

    fn breakpoint_after(&self, x: f64) -> Option<f64> {
        let here = self.shift(x);
        let period = self.period.unwrap_or(0.0);
        // The turn before too: rounding may have put `x` into the next one.
        [here - period, here, here + period].into_iter().find_map(|shift| {
            let passed = self.knots.partition_point(|knot| knot + shift <= x);
            self.knots.get(passed).map(|knot| knot + shift).filter(|place| x < *place)
        })
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        let first = self.knots.first().copied()?;
        let [from, to] = within_periods([from, to], first, self.period)?;
        let mut union = Union::default();
        if let (None, true, Some(piece)) = (self.period, from < first, self.pieces.first()) {
            let without_highest = from_fn(|j| if C == j + 1 { 0.0 } else { at(piece, j) });
            union.add(of_polynomial::<C, K>(
                &without_highest,
                Interval::between(from - first, to.min(first) - first),
            ));
        }
        let begun = searched(self.knots, from);
        for offset in [0.0, self.period.unwrap_or(0.0)] {
            let skipped = if offset > 0.0 { 0 } else { begun };
            for (j, (knot, piece)) in self.knots.iter().zip(self.pieces).enumerate().skip(skipped) {
                let end = match (self.knots.get(j.saturating_add(1)), self.period) {
                    (Some(next), _) => *next,
                    (None, Some(period)) => first + period,
                    (None, None) => f64::INFINITY,
                };
                // Rounding of the places is within the margin of `from` and `to`.
                let [start, end] = [knot + offset, end + offset];
                if start <= to && from <= end {
                    let local = Interval::between(from.max(start) - start, to.min(end) - start);
                    union.add(of_polynomial::<C, K>(piece, local));
                }
            }
            if self.period.is_none() {
                break;
            }
        }
        union.bounds()
    }
}
