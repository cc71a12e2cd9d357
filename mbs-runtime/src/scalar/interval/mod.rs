//! Intervals as numbers: emitted code evaluated over all positions of a part of a motion at once.

#[cfg(test)]
mod tests;

use core::ops::Add;
use core::ops::BitAnd;
use core::ops::BitOr;
use core::ops::Div;
use core::ops::Mul;
use core::ops::Neg;
use core::ops::Not;
use core::ops::Sub;

use crate::scalar::number::{Real, Scalar};

/// Widening of a sum, product, quotient or square root, in roundings of the result: correctly rounded they are off by half of one.
const OF_ARITHMETIC: f64 = 1.0;

/// Widening of other functions, in roundings of the result: those of `libm` are off by less than two.
const OF_FUNCTIONS: f64 = 4.0;

/// Widening whatever the result is: products that vanish below the least number of single precision.
const LEAST: f64 = 1e-37;

/// All numbers between two bounds, bounds included; infinite ones where nothing is known, as of values that are no number.
///
/// A function of intervals encloses the function of every number in them. Each operation is rounded outward, and a decision that
/// is not the same for all of them gives the union of both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval<R> {
    low: R,
    high: R,
}

impl<R: Real> Interval<R> {
    /// One number alone.
    #[inline(always)]
    pub fn of(value: R) -> Self {
        Interval { low: value, high: value }.known()
    }

    /// The numbers between `low` and `high`.
    #[inline(always)]
    pub fn between(low: R, high: R) -> Self {
        Interval { low, high }.known()
    }

    /// The lower bound.
    pub fn low(self) -> R {
        self.low
    }

    /// The upper bound.
    pub fn high(self) -> R {
        self.high
    }

    /// Any number.
    fn whole() -> Self {
        Interval { low: R::constant(f64::NEG_INFINITY), high: R::constant(f64::INFINITY) }
    }

    /// Any number where a bound is none, or the bounds are in no order.
    #[inline(always)]
    fn known(self) -> Self {
        if self.low <= self.high { self } else { Self::whole() }
    }

    /// Widened by `roundings` of the bounds.
    fn widened(self, roundings: f64) -> Self {
        let by = |bound: R| R::constant(roundings) * R::EPSILON * bound.abs() + R::constant(LEAST);
        Interval { low: self.low - by(self.low), high: self.high + by(self.high) }.known()
    }

    /// Its common part with another that encloses the same value.
    pub fn and(self, other: Self) -> Self {
        let both = Interval { low: self.low.max(other.low), high: self.high.min(other.high) };
        // Apart by rounding alone: either will do.
        if both.low <= both.high { both } else { self }
    }

    /// The least interval around two.
    pub fn around(self, other: Self) -> Self {
        Interval { low: self.low.min(other.low), high: self.high.max(other.high) }.known()
    }

    fn contains(self, value: f64) -> bool {
        self.low <= R::constant(value) && R::constant(value) <= self.high
    }

    /// Around four values of a function that is largest and least in corners.
    fn of_corners([a, b, c, d]: [R; 4]) -> Self {
        let is_number = |value: R| value.partial_cmp(&value).is_some();
        if !(is_number(a) && is_number(b) && is_number(c) && is_number(d)) {
            return Self::whole();
        }
        Interval { low: a.min(b).min(c.min(d)), high: a.max(b).max(c.max(d)) }
    }

    fn corners(self, other: Self, function: impl Fn(R, R) -> R) -> Self {
        Self::of_corners([
            function(self.low, other.low),
            function(self.low, other.high),
            function(self.high, other.low),
            function(self.high, other.high),
        ])
    }

    /// A function that rises, within where it is defined.
    fn rising(self, defined: (f64, f64), function: impl Fn(R) -> R) -> Self {
        if self.low < R::constant(defined.0) || R::constant(defined.1) < self.high {
            return Self::whole();
        }
        Interval { low: function(self.low), high: function(self.high) }.known().widened(OF_FUNCTIONS)
    }

    /// Periods of `period` from `from` on that begin within: none, or some.
    fn begins(self, from: f64, period: f64) -> bool {
        let roundings = 8.0 * R::EPSILON.to_f64();
        let count = |bound: R, side: f64| {
            let bound = bound.to_f64();
            libm::floor((bound + side * roundings * (1.0 + bound.abs()) - from) / period)
        };
        // Written so that a bound without end begins some.
        count(self.low, -1.0) != count(self.high, 1.0)
    }

    fn sine_cosine(self) -> (Self, Self) {
        const TURN: f64 = 2.0 * core::f64::consts::PI;
        let unit = Self::between(R::constant(-1.0), R::constant(1.0));
        let span = (self.high - self.low).to_f64();
        let is_within_a_turn = span < TURN;
        if !is_within_a_turn {
            return (unit, unit);
        }
        let ([low, high], [left, right]) = R::sin_cos_called([self.low, self.high]);
        let quarter = 0.25 * TURN;
        let of = |ends: [R; 2], largest: f64, least: f64| {
            let [one, other] = ends;
            let slack = R::constant(OF_FUNCTIONS) * R::EPSILON;
            let (mut below, mut above) = (one.min(other) - slack, one.max(other) + slack);
            if self.begins(largest, TURN) {
                above = R::constant(1.0);
            }
            if self.begins(least, TURN) {
                below = R::constant(-1.0);
            }
            Interval { low: below, high: above }.known().and(unit)
        };
        (of([low, high], quarter, -quarter), of([left, right], 0.0, 0.5 * TURN))
    }

    /// A power of a whole number of a base of any sign.
    fn whole_power(self, exponent: R) -> Self {
        let half = 0.5 * exponent.to_f64();
        let (one, other) = (self.low.powf(exponent), self.high.powf(exponent));
        let ends = Self::of_corners([one, other, one, other]);
        let even = libm::floor(half) == half;
        match (self.contains(0.0), even) {
            (true, _) if exponent < R::constant(0.0) => Self::whole(),
            (true, true) => ends.around(Self::of(R::constant(0.0))).widened(OF_FUNCTIONS),
            _ => ends.widened(OF_FUNCTIONS),
        }
    }
}

impl<R: Real> Add for Interval<R> {
    type Output = Self;
    #[inline(never)]
    fn add(self, other: Self) -> Self {
        Interval { low: self.low + other.low, high: self.high + other.high }.widened(OF_ARITHMETIC)
    }
}

impl<R: Real> Sub for Interval<R> {
    type Output = Self;
    #[inline(never)]
    fn sub(self, other: Self) -> Self {
        Interval { low: self.low - other.high, high: self.high - other.low }.widened(OF_ARITHMETIC)
    }
}

impl<R: Real> Mul for Interval<R> {
    type Output = Self;
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        self.corners(other, |a, b| a * b).widened(OF_ARITHMETIC)
    }
}

impl<R: Real> Div for Interval<R> {
    type Output = Self;
    #[inline(never)]
    fn div(self, other: Self) -> Self {
        if other.contains(0.0) {
            return Self::whole();
        }
        self.corners(other, |a, b| a / b).widened(OF_ARITHMETIC)
    }
}

impl<R: Real> Neg for Interval<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Interval { low: -self.high, high: -self.low }
    }
}

/// Truth of a comparison of intervals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Possible {
    /// `true` if it holds for some of their numbers.
    yes: bool,
    /// `true` if it fails for some of their numbers.
    no: bool,
}

impl BitAnd for Possible {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Possible { yes: self.yes && other.yes, no: self.no || other.no }
    }
}

impl BitOr for Possible {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Possible { yes: self.yes || other.yes, no: self.no && other.no }
    }
}

impl Not for Possible {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Possible { yes: self.no, no: self.yes }
    }
}

impl<R: Real> Scalar for Interval<R> {
    type Real = R;
    type Mask = Possible;
    type Lanes<X: Copy> = [X; 1];

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::of(R::constant(value))
    }
    #[inline(always)]
    fn splat(value: R) -> Self {
        Self::of(value)
    }
    #[inline(always)]
    fn from_lanes(mut value: impl FnMut(usize) -> R) -> Self {
        Self::of(value(0))
    }
    /// The middle.
    fn lane(self, _: usize) -> R {
        self.low + R::constant(0.5) * (self.high - self.low)
    }
    #[inline(always)]
    fn per_lane<X: Copy>(mut value: impl FnMut(usize) -> X) -> [X; 1] {
        [value(0)]
    }
    #[inline(always)]
    fn mask(value: bool) -> Possible {
        Possible { yes: value, no: !value }
    }
    #[inline(always)]
    fn less(self, than: Self) -> Possible {
        let certain = self.high < than.low;
        Possible { yes: self.low < than.high, no: !certain }
    }
    #[inline(always)]
    fn is_finite(self) -> Possible {
        let certain = self.low.is_finite() && self.high.is_finite();
        Possible { yes: true, no: !certain }
    }
    #[inline(always)]
    fn all(mask: Possible) -> bool {
        !mask.no
    }
    #[inline(always)]
    fn test(mask: Possible, _: usize) -> bool {
        !mask.no
    }
    #[inline(always)]
    fn select(mask: Possible, yes: Self, no: Self) -> Self {
        match mask {
            Possible { no: false, .. } => yes,
            Possible { yes: false, .. } => no,
            _ => yes.around(no),
        }
    }

    #[inline(never)]
    fn sin_cos<const K: usize>(angles: [Self; K]) -> ([Self; K], [Self; K]) {
        let (mut sines, mut cosines) = (angles, angles);
        for ((sine, cosine), angle) in sines.iter_mut().zip(&mut cosines).zip(angles) {
            (*sine, *cosine) = angle.sine_cosine();
        }
        (sines, cosines)
    }
    fn sqrt(self) -> Self {
        self.rising((0.0, f64::INFINITY), R::sqrt)
    }
    fn exp(self) -> Self {
        self.rising((f64::NEG_INFINITY, f64::INFINITY), R::exp)
    }
    fn ln(self) -> Self {
        self.rising((0.0, f64::INFINITY), R::ln)
    }
    fn tan(self) -> Self {
        const HALF_TURN: f64 = core::f64::consts::PI;
        if self.begins(0.5 * HALF_TURN, HALF_TURN) || !(self.high - self.low).less(R::constant(HALF_TURN)) {
            return Self::whole();
        }
        self.rising((f64::NEG_INFINITY, f64::INFINITY), R::tan)
    }
    fn asin(self) -> Self {
        self.rising((-1.0, 1.0), R::asin)
    }
    fn acos(self) -> Self {
        let one = R::constant(1.0);
        if self.low < -one || one < self.high {
            return Self::whole();
        }
        Interval { low: self.high.acos(), high: self.low.acos() }.known().widened(OF_FUNCTIONS)
    }
    fn atan(self) -> Self {
        self.rising((f64::NEG_INFINITY, f64::INFINITY), R::atan)
    }
    fn atan2(self, x: Self) -> Self {
        let zero = R::constant(0.0);
        // The angle jumps across the negative axis, and is any at the origin.
        if x.low <= zero && self.contains(0.0) {
            let half_turn = R::constant(core::f64::consts::PI);
            return Interval { low: -half_turn, high: half_turn }.widened(OF_FUNCTIONS);
        }
        self.corners(x, R::atan2).widened(OF_FUNCTIONS)
    }
    fn sinh(self) -> Self {
        self.rising((f64::NEG_INFINITY, f64::INFINITY), R::sinh)
    }
    fn cosh(self) -> Self {
        self.abs().rising((0.0, f64::INFINITY), R::cosh)
    }
    fn tanh(self) -> Self {
        self.rising((f64::NEG_INFINITY, f64::INFINITY), R::tanh)
    }
    fn asinh(self) -> Self {
        self.rising((f64::NEG_INFINITY, f64::INFINITY), R::asinh)
    }
    fn acosh(self) -> Self {
        self.rising((1.0, f64::INFINITY), R::acosh)
    }
    fn atanh(self) -> Self {
        self.rising((-1.0, 1.0), R::atanh)
    }
    #[inline(never)]
    fn powf(self, exponent: Self) -> Self {
        let zero = R::constant(0.0);
        if zero < self.low || self.low == zero && zero < exponent.low {
            return self.corners(exponent, R::powf).widened(OF_FUNCTIONS);
        }
        let value = exponent.low.to_f64();
        if exponent.low == exponent.high && libm::floor(value) == value {
            return self.whole_power(exponent.low);
        }
        Self::whole()
    }
    fn hypot(self, other: Self) -> Self {
        let (one, other) = (self.abs(), other.abs());
        let (low, high) = (one.low.hypot(other.low), one.high.hypot(other.high));
        Interval { low, high }.known().widened(OF_FUNCTIONS)
    }

    #[inline(never)]
    fn abs(self) -> Self {
        let (one, other) = (self.low.abs(), self.high.abs());
        let low = if self.contains(0.0) { R::constant(0.0) } else { one.min(other) };
        Interval { low, high: one.max(other) }
    }
    fn sign(self) -> Self {
        Interval { low: self.low.sign(), high: self.high.sign() }
    }
    fn min(self, other: Self) -> Self {
        Interval { low: self.low.min(other.low), high: self.high.min(other.high) }
    }
    fn max(self, other: Self) -> Self {
        Interval { low: self.low.max(other.low), high: self.high.max(other.high) }
    }
}
