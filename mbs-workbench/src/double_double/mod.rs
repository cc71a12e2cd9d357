//! Numbers of twice the digits of `f64`: unevaluated sums of two of them, for reference solutions.
//!
//! Sources: Dekker 1971 for exact products and quotients, Knuth 1969 for exact sums, Joldes, Muller & Popescu 2017 for errors of the
//! operations. The errors are at most 10 u² of a result, u = 2⁻⁵³. The functions are within 32 u² of the larger of result and 1
//! (`cargo test -p mbs-workbench --lib double_double`).

use core::cmp::Ordering;
use core::ops::{Add, Div, Mul, Neg, Sub};

use mbs_runtime::{Real, Scalar};

mod elementary;

/// The unevaluated sum of two numbers, the second at most half a unit in the last place of the first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DoubleDouble {
    /// The sum, rounded.
    pub high: f64,
    /// The part that rounding took off.
    pub low: f64,
}

impl DoubleDouble {
    /// A number of `f64`.
    pub const fn new(value: f64) -> Self {
        DoubleDouble { high: value, low: 0.0 }
    }

    /// The sum of two parts, the first at least as large as the second.
    fn sum(large: f64, small: f64) -> Self {
        let high = large + small;
        // An infinite sum leaves no rest.
        let low = if high.is_finite() { small - (high - large) } else { 0.0 };
        DoubleDouble { high, low }
    }

    /// The product with a power of two, which is exact.
    pub fn scaled(self, power: f64) -> Self {
        DoubleDouble { high: self.high * power, low: self.low * power }
    }

    /// The product with itself.
    fn square(self) -> Self {
        self * self
    }
}

/// Sum and rounding error of any two numbers.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// Two parts of a number with 26 bits each.
fn split(a: f64) -> (f64, f64) {
    /// 2²⁷ + 1.
    const SPLITTER: f64 = 134_217_729.0;
    /// From here on the product with the splitter overflows.
    const LARGE: f64 = 6.696_928_794_914_17e299;
    let (shrunk, grown) = if a.abs() > LARGE { (2.0_f64.powi(-28), 2.0_f64.powi(28)) } else { (1.0, 1.0) };
    let a = a * shrunk;
    let part = SPLITTER * a;
    let high = part - (part - a);
    (high * grown, (a - high) * grown)
}

/// Product and rounding error of two numbers.
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((a1, a2), (b1, b2)) = (split(a), split(b));
    (product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2)
}

impl Add for DoubleDouble {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, error) = two_sum(self.high, other.high);
        if !high.is_finite() {
            return DoubleDouble::new(high);
        }
        let (low, rest) = two_sum(self.low, other.low);
        let sum = DoubleDouble::sum(high, error + low);
        DoubleDouble::sum(sum.high, rest + sum.low)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    fn neg(self) -> Self {
        DoubleDouble { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let (high, error) = two_product(self.high, other.high);
        if !high.is_finite() {
            return DoubleDouble::new(high);
        }
        DoubleDouble::sum(high, error + (self.high * other.low + self.low * other.high))
    }
}

impl Div for DoubleDouble {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        if !first.is_finite() || !other.high.is_finite() {
            return DoubleDouble::new(first);
        }
        let rest = self - other * DoubleDouble::new(first);
        let second = rest.high / other.high;
        let rest = rest - other * DoubleDouble::new(second);
        let third = rest.high / other.high;
        DoubleDouble::sum(first, second) + DoubleDouble::new(third)
    }
}

impl PartialOrd for DoubleDouble {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        match self.high.partial_cmp(&other.high)? {
            Ordering::Equal => self.low.partial_cmp(&other.low),
            order => Some(order),
        }
    }
}

impl Scalar for DoubleDouble {
    type Real = Self;
    type Mask = bool;
    type Lanes<X: Copy> = [X; 1];

    fn constant(value: f64) -> Self {
        DoubleDouble::new(value)
    }
    fn splat(value: Self) -> Self {
        value
    }
    fn from_lanes(mut value: impl FnMut(usize) -> Self) -> Self {
        value(0)
    }
    fn lane(self, _: usize) -> Self {
        self
    }
    fn per_lane<X: Copy>(mut value: impl FnMut(usize) -> X) -> [X; 1] {
        [value(0)]
    }
    fn mask(value: bool) -> bool {
        value
    }
    fn less(self, than: Self) -> bool {
        self < than
    }
    fn is_finite(self) -> bool {
        self.high.is_finite() && self.low.is_finite()
    }
    fn all(mask: bool) -> bool {
        mask
    }
    fn test(mask: bool, _: usize) -> bool {
        mask
    }
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    fn sin_cos<const K: usize>(angles: [Self; K]) -> ([Self; K], [Self; K]) {
        let found = angles.map(elementary::sin_cos);
        (found.map(|(sine, _)| sine), found.map(|(_, cosine)| cosine))
    }
    fn sqrt(self) -> Self {
        elementary::sqrt(self)
    }
    fn exp(self) -> Self {
        elementary::exp(self)
    }
    fn ln(self) -> Self {
        elementary::ln(self)
    }
    fn tan(self) -> Self {
        let (sine, cosine) = elementary::sin_cos(self);
        sine / cosine
    }
    fn asin(self) -> Self {
        let one = DoubleDouble::new(1.0);
        elementary::atan2(self, elementary::sqrt((one - self) * (one + self)))
    }
    fn acos(self) -> Self {
        let one = DoubleDouble::new(1.0);
        elementary::atan2(elementary::sqrt((one - self) * (one + self)), self)
    }
    fn atan(self) -> Self {
        elementary::atan2(self, DoubleDouble::new(1.0))
    }
    fn atan2(self, x: Self) -> Self {
        elementary::atan2(self, x)
    }
    fn sinh(self) -> Self {
        elementary::sinh(self)
    }
    fn cosh(self) -> Self {
        elementary::cosh(self)
    }
    fn tanh(self) -> Self {
        elementary::tanh(self)
    }
    fn asinh(self) -> Self {
        elementary::asinh(self)
    }
    fn acosh(self) -> Self {
        elementary::acosh(self)
    }
    fn atanh(self) -> Self {
        elementary::atanh(self)
    }
    fn powf(self, exponent: Self) -> Self {
        elementary::powf(self, exponent)
    }
    fn hypot(self, other: Self) -> Self {
        elementary::hypot(self, other)
    }
}

impl Real for DoubleDouble {
    type Word = u64;
    type Register = Self;

    /// 2⁻¹⁰⁴: twice the unit roundoff u², with a bit to spare for the errors of the operations.
    const EPSILON: Self = DoubleDouble::new(4.930_380_657_631_324e-32);
    const FALSE: u64 = 0;

    fn to_f64(self) -> f64 {
        self.high
    }
}

#[cfg(test)]
mod tests;
