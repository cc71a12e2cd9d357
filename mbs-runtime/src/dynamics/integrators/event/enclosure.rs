//! Bounds of functions of the state over a part of a step.

use crate::dynamics::integrators::event::group::GROUP;
use crate::dynamics::integrators::event::interpolant::{Interpolant, NODES};
use crate::dynamics::integrators::vector::IntegratorState;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::enclosure::{Enclosure, WithIntervals};
use crate::scalar::interval::Interval;
use crate::scalar::number::{Real, Scalar};
use crate::tolerances::motion;

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

    /// `true` if a smaller part gives no new information: its width is one of roundings, and is what it was of twice the part.
    pub(super) fn is_exhausted(&self, of_twice: Option<R>) -> bool {
        let width = self.width();
        width <= self.noise && of_twice.is_some_and(|twice| R::constant(KEPT) * twice < width)
    }

    /// The least absolute value.
    pub(super) fn least(&self) -> R {
        let zero = R::constant(0.0);
        self.value.low().max(-self.value.high()).max(zero)
    }

    /// `true` if the function stays on `side` of zero.
    pub(super) fn stays(&self, side: R) -> bool {
        let zero = R::constant(0.0);
        if zero < side { zero < self.value.low() } else { self.value.high() < zero }
    }

    /// `true` if the function changes in one direction alone.
    pub(super) fn is_monotone(&self) -> bool {
        let zero = R::constant(0.0);
        zero < self.rate.low() || self.rate.high() < zero
    }
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
    pub fn of<Z>(from: R, times: (R, R), at: impl Fn(R) -> IntegratorState<R, N, Z>) -> Option<Self> {
        let (start, end) = times;
        let mut rows = [[R::constant(0.0); N]; NODES];
        for (index, row) in rows.iter_mut().enumerate() {
            *row = at(Interpolant::instant(start, end, index)).q;
        }
        let none = Interval::of(R::constant(0.0));
        let mut part = Part { from, times, middle: [none; N], q: [none; N], qd: [none; N] };
        let all = part.middle.iter_mut().zip(&mut part.q).zip(&mut part.qd).enumerate();
        for (coordinate, ((middle, q), qd)) in all {
            let mut values = [R::constant(f64::NAN); NODES];
            for (value, row) in values.iter_mut().zip(&rows) {
                row.get(coordinate).into_iter().for_each(|q| *value = *q);
            }
            let column = Interpolant::through_values(values, start, end).ok()?;
            let slack = motion::BLURRED.of::<R>() * column.largest();
            (*middle, *q, *qd) = column.enclosures(slack);
        }
        Some(part)
    }

    /// The width (s), and the rounding of a value.
    fn width(&self) -> (R, R) {
        let largest = |largest: R, q: &Interval<R>| largest.max(q.low().abs()).max(q.high().abs());
        let largest = self.q.iter().fold(R::constant(0.0), largest);
        (self.times.1 - self.times.0, motion::OF_ENCLOSURE.of::<R>() * largest)
    }

    /// Calls `see` with the mechanism, coordinates, velocities and time in the middle, then with those of all of the part. Velocities in
    /// the middle are those of all of it.
    fn each<S: Dynamic<Interval<R>, N, M>, const M: usize>(
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

/// Functions of the state in an order, each with its time derivative.
pub trait Functions<R: Real> {
    /// Calls `see` with each function and its rate at a position with velocities `qd` (N).
    fn show<S: Dynamic<Interval<R>, N, M>, const N: usize, const M: usize>(
        &self,
        mechanism: &S,
        parameters: &S::Parameters,
        position: &S::Position,
        qd: &[Interval<R>; N],
        see: impl FnMut(Interval<R>, Interval<R>),
    );
}

/// A group of functions over a part of a step.
pub struct GroupOver<F, R, const N: usize> {
    pub part: Part<R, N>,
    /// Index of the first function.
    pub first: usize,
    pub functions: F,
}

impl<T, F, R, const N: usize, const M: usize> WithIntervals<T, N, M> for GroupOver<F, R, N>
where
    T: Scalar<Real = R>,
    F: Functions<R>,
    R: Real,
{
    type Output = Enclosures<R>;

    fn at<S: Dynamic<Interval<R>, N, M>>(self, mechanism: &S) -> Self::Output {
        let (none, width) = (Interval::of(R::constant(0.0)), self.part.width());
        let mut middles = [none; GROUP];
        let mut enclosures = [None; GROUP];
        self.part.each(mechanism, |mechanism, parameters, position, qd, is_whole| {
            let mut places = middles.iter_mut().zip(&mut enclosures);
            let mut index = 0;
            self.functions.show(mechanism, parameters, position, qd, |value, rate| {
                index += 1;
                if index <= self.first {
                    return;
                }
                let Some((middle, enclosure)) = places.next() else { return };
                if is_whole {
                    *enclosure = Some(Enclosure::of(*middle, (value, rate), width));
                } else {
                    *middle = value;
                }
            });
        });
        enclosures
    }
}

/// Asks a mechanism for intervals, and nothing else.
struct Asked;

impl<T: Scalar, const N: usize, const M: usize> WithIntervals<T, N, M> for Asked {
    type Output = ();

    fn at<S: Dynamic<Interval<T::Real>, N, M>>(self, _: &S) {}
}

/// `true` if parts of a motion of `mechanism` can be enclosed.
#[inline(always)]
pub fn can_be_enclosed<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(mechanism: &S) -> bool {
    mechanism.enclosed(Asked).is_some()
}

/// Enclosures of a group of functions.
pub type Enclosures<R> = [Option<Enclosure<R>>; GROUP];
