//! Bounds of functions of the state over a part of a step.

use super::interpolant::{Interpolant, NODES};
use super::{BLURRED, GROUP};
use crate::dynamics::vector::State;
use crate::{Dynamic, Interval, Real, Scalar};

/// All values of a function within a part of a step, and all of its rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure<R> {
    /// Values.
    pub value: Interval<R>,
    /// Time derivatives.
    pub rate: Interval<R>,
    /// Width of the values that roundings of the coordinates may make.
    pub noise: R,
}

/// Roundings of a coordinate that its enclosure may be wide by: those of its coefficients, sixteen of which are in a rate, and a
/// lever of the function that is not one.
const NOISE: f64 = 131_072.0;

/// Share of its width that an enclosure keeps in half of a part where it tells nothing more.
const KEPT: f64 = 0.75;

impl<R: Real> Enclosure<R> {
    /// From the values in the middle of a part of `width` (s), those of the whole part, and the rates there, by the mean value theorem.
    pub fn of(
        middle: Interval<R>,
        (value, rate): (Interval<R>, Interval<R>),
        (width, noise): (R, R),
    ) -> Self {
        let half = R::constant(0.5) * width;
        let aside = Interval::between(-half, half);
        Enclosure { value: (middle + rate * aside).and(value), rate, noise }
    }

    /// Width of the values.
    pub(super) fn width(&self) -> R {
        self.value.high() - self.value.low()
    }

    /// Whether a smaller part tells nothing more: its width is one of roundings, and is what it was of twice the part.
    pub(super) fn is_exhausted(&self, of_twice: Option<R>) -> bool {
        let width = self.width();
        width <= self.noise && of_twice.is_some_and(|twice| R::constant(KEPT) * twice < width)
    }

    /// The least absolute value.
    pub(super) fn least(&self) -> R {
        let zero = R::constant(0.0);
        self.value.low().max(-self.value.high()).max(zero)
    }

    /// Whether the function stays on `side` of zero.
    pub(super) fn stays(&self, side: R) -> bool {
        let zero = R::constant(0.0);
        if zero < side { zero < self.value.low() } else { self.value.high() < zero }
    }

    /// Whether it changes in one direction alone.
    pub(super) fn is_monotone(&self) -> bool {
        let zero = R::constant(0.0);
        zero < self.rate.low() || self.rate.high() < zero
    }
}

/// What is made of a mechanism in intervals.
pub trait WithIntervals<T: Scalar, const N: usize, const M: usize> {
    /// That.
    type Output;

    /// Sees the mechanism, with its parameters and inputs as they are.
    fn at<S: Dynamic<Interval<T::Real>, N, M>>(self, mechanism: &S) -> Self::Output;
}

/// The states of a part of a step as intervals.
pub struct Part<R, const N: usize> {
    /// Time (s) that inputs are known at.
    pub from: R,
    /// Times (s) at its beginning and end.
    pub times: (R, R),
    /// Coordinates in its middle: N.
    middle: [Interval<R>; N],
    /// Those of all of it: N.
    q: [Interval<R>; N],
    /// Their time derivatives: N.
    qd: [Interval<R>; N],
}

impl<R: Real, const N: usize> Part<R, N> {
    /// The coordinates between two times (s) as polynomials of degree 8 through nine states.
    pub fn of<Z>(from: R, times: (R, R), at: impl Fn(R) -> State<R, N, Z>) -> Option<Self> {
        let (start, end) = times;
        let mut rows = [[R::constant(0.0); N]; NODES];
        for (index, row) in rows.iter_mut().enumerate() {
            *row = at(Interpolant::instant(start, end, index)).q;
        }
        let none = Interval::of(R::constant(0.0));
        let mut part = Part { from, times, middle: [none; N], q: [none; N], qd: [none; N] };
        let all = part.middle.iter_mut().zip(&mut part.q).zip(&mut part.qd).enumerate();
        for (coordinate, ((middle, q), qd)) in all {
            let mut index = 0;
            let mut column = |_| {
                let value = rows.get(index).and_then(|row| row.get(coordinate)).copied();
                index += 1;
                value.unwrap_or(R::constant(f64::NAN))
            };
            let column = Interpolant::through(&mut column, start, end).ok()?;
            let slack = R::constant(BLURRED) * R::EPSILON * column.largest();
            (*middle, *q, *qd) = column.enclosures(slack);
        }
        Some(part)
    }

    /// The width (s), and what roundings may make of a value.
    pub fn width(&self) -> (R, R) {
        let largest = |largest: R, q: &Interval<R>| largest.max(q.low().abs()).max(q.high().abs());
        let largest = self.q.iter().fold(R::constant(0.0), largest);
        (self.times.1 - self.times.0, R::constant(NOISE) * R::EPSILON * largest)
    }

    /// Calls `see` with the mechanism, coordinates, velocities and time in the middle, then with those of all of the part. Velocities in
    /// the middle are those of all of it.
    pub fn each<S: Dynamic<Interval<R>, N, M>, const M: usize>(
        &self,
        mechanism: &S,
        mut see: impl FnMut(&S, &S::Parameters, &S::Position, &[Interval<R>; N], bool),
    ) {
        let (start, end) = self.times;
        let middle = start + R::constant(0.5) * (end - start);
        let times = [Interval::of(middle), Interval::between(start, end)];
        for ((t, q), whole) in times.into_iter().zip([&self.middle, &self.q]).zip([false, true]) {
            let mut moved = mechanism.clone();
            moved.carry_signals(mechanism, t - Interval::of(self.from));
            let parameters = moved.parameters();
            let position = moved.position(&parameters, q, t);
            see(&moved, &parameters, &position, &self.qd, whole);
        }
    }
}

/// Enclosures of a group of functions.
pub type Enclosures<R> = [Option<Enclosure<R>>; GROUP];
