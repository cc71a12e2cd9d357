//! Truncated Taylor series over the cam angle: value and three derivatives, exact to rounding.
//!
//! Source: Griewank & Walther 2008, Evaluating Derivatives, ch. 13 (arithmetic of truncated series).

use core::array::from_fn;
use core::ops::{Add, Div, Mul, Neg, Sub};

use mbs_runtime::Scalar;

/// Taylor coefficients f⁽ᵏ⁾/k!, k = 0 … 3.
///
/// A coefficient that is not known is NaN. It spoils none of a lower order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet<T>(pub [T; 4]);

/// A point or a direction of the plane, as a complex number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane<T> {
    /// Real part.
    pub x: Jet<T>,
    /// Imaginary part.
    pub y: Jet<T>,
}

impl<T: Scalar> Jet<T> {
    /// A number that does not vary.
    pub fn constant(value: f64) -> Self {
        Jet([value, 0.0, 0.0, 0.0].map(T::constant))
    }

    /// The variable itself at `value`.
    pub fn variable(value: T) -> Self {
        let [zero, one] = [0.0, 1.0].map(T::constant);
        Jet([value, one, zero, zero])
    }

    /// From a value and three derivatives.
    pub fn of_derivatives([value, first, second, third]: [T; 4]) -> Self {
        Jet([value, first, second / T::constant(2.0), third / T::constant(6.0)])
    }

    /// Value and three derivatives.
    pub fn derivatives(self) -> [T; 4] {
        let [value, first, second, third] = self.0;
        [value, first, second * T::constant(2.0), third * T::constant(6.0)]
    }

    /// The value.
    pub fn value(self) -> T {
        self.0[0]
    }

    /// The derivative; its third one is not known.
    pub fn rate(self) -> Self {
        let [_, first, second, third] = self.0;
        Jet([first, second * T::constant(2.0), third * T::constant(3.0), T::constant(f64::NAN)])
    }

    /// The series that begins with `value` and has this derivative.
    fn integral(self, value: T) -> Self {
        let [first, second, third, _] = self.0;
        Jet([value, first, second / T::constant(2.0), third / T::constant(3.0)])
    }

    /// The product with a number.
    pub fn scaled(self, factor: f64) -> Self {
        Jet(self.0.map(|term| term * T::constant(factor)))
    }

    /// The square.
    pub fn square(self) -> Self {
        self * self
    }

    /// The quotient, term by term.
    fn over(self, other: Self) -> Self {
        let mut quotient = [T::constant(f64::NAN); 4];
        for k in 0..4 {
            let rest = (0..k).fold(self.0[k], |rest, j| rest - quotient[j] * other.0[k - j]);
            quotient[k] = rest / other.0[0];
        }
        Jet(quotient)
    }

    /// The square root of a series with a positive value.
    pub fn sqrt(self) -> Self {
        let [a, b, c, d] = self.0;
        let first = a.sqrt();
        let twice = first + first;
        let second = b / twice;
        let third = (c - second * second) / twice;
        Jet([first, second, third, (d - second * third * T::constant(2.0)) / twice])
    }

    /// Sine and cosine.
    pub fn sin_cos(self) -> (Self, Self) {
        let ([s], [c]) = T::sin_cos([self.0[0]]);
        let rate = self.rate();
        // Each pass of s' = c a', c' = −s a' gains an order.
        let (mut sine, mut cosine) = (Jet::constant(0.0), Jet::constant(0.0));
        (sine.0[0], cosine.0[0]) = (s, c);
        for _ in 0..3 {
            (sine, cosine) = ((cosine * rate).integral(s), (-(sine * rate)).integral(c));
        }
        (sine, cosine)
    }

    /// Arc sine of a series with a value within (−1, 1).
    pub fn asin(self) -> Self {
        let rest = (Jet::constant(1.0) - self) * (Jet::constant(1.0) + self);
        (self.rate() / rest.sqrt()).integral(self.value().asin())
    }

    /// Arc cosine of a series with a value within (−1, 1).
    pub fn acos(self) -> Self {
        let rest = (Jet::constant(1.0) - self) * (Jet::constant(1.0) + self);
        (-(self.rate() / rest.sqrt())).integral(self.value().acos())
    }
}

impl<T: Scalar> Plane<T> {
    /// A point that does not move.
    pub fn constant([x, y]: [f64; 2]) -> Self {
        Plane { x: Jet::constant(x), y: Jet::constant(y) }
    }

    /// e^{i angle}.
    pub fn direction(angle: Jet<T>) -> Self {
        let (y, x) = angle.sin_cos();
        Plane { x, y }
    }

    /// The derivative.
    pub fn rate(self) -> Self {
        Plane { x: self.x.rate(), y: self.y.rate() }
    }

    /// The product with i: a quarter of a turn.
    pub fn turned(self) -> Self {
        Plane { x: -self.y, y: self.x }
    }

    /// The product with a real series.
    pub fn times(self, factor: Jet<T>) -> Self {
        Plane { x: self.x * factor, y: self.y * factor }
    }

    /// The product with a number.
    pub fn scaled(self, factor: f64) -> Self {
        Plane { x: self.x.scaled(factor), y: self.y.scaled(factor) }
    }

    /// The scalar product.
    pub fn dot(self, other: Self) -> Jet<T> {
        self.x * other.x + self.y * other.y
    }

    /// The vector product.
    pub fn cross(self, other: Self) -> Jet<T> {
        self.x * other.y - self.y * other.x
    }

    /// The length.
    pub fn length(self) -> Jet<T> {
        self.dot(self).sqrt()
    }

    /// The angle, in (−π, π].
    pub fn angle(self) -> Jet<T> {
        let rate = self.cross(self.rate()) / self.dot(self);
        rate.integral(self.y.value().atan2(self.x.value()))
    }

    /// Both values.
    pub fn value(self) -> [T; 2] {
        [self.x.value(), self.y.value()]
    }
}

impl<T: Scalar> Add for Jet<T> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Jet(from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl<T: Scalar> Sub for Jet<T> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Jet(from_fn(|k| self.0[k] - other.0[k]))
    }
}

impl<T: Scalar> Neg for Jet<T> {
    type Output = Self;

    fn neg(self) -> Self {
        Jet(self.0.map(|term| -term))
    }
}

impl<T: Scalar> Mul for Jet<T> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let term = |k: usize| {
            let first = self.0[0] * other.0[k];
            (1..=k).fold(first, |sum, j| sum + self.0[j] * other.0[k - j])
        };
        Jet(from_fn(term))
    }
}

impl<T: Scalar> Div for Jet<T> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        self.over(other)
    }
}

impl<T: Scalar> Add for Plane<T> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Plane { x: self.x + other.x, y: self.y + other.y }
    }
}

impl<T: Scalar> Sub for Plane<T> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Plane { x: self.x - other.x, y: self.y - other.y }
    }
}

impl<T: Scalar> Mul for Plane<T> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Plane { x: self.x * other.x - self.y * other.y, y: self.x * other.y + self.y * other.x }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::double_double::DoubleDouble;

    /// Central differences of values in 32 digits, extrapolated three times: an oracle that knows no rule of differentiation.
    fn differences(f: impl Fn(DoubleDouble) -> DoubleDouble, x: f64) -> [f64; 4] {
        let of = DoubleDouble::new;
        let at = |h: f64, k: f64| f(of(x) + of(h * k));
        let estimate = |h: f64, order: usize| match order {
            1 => (at(h, 1.0) - at(h, -1.0)) / of(2.0 * h),
            2 => (at(h, 1.0) - at(h, 0.0) - at(h, 0.0) + at(h, -1.0)) / of(h * h),
            _ => {
                let inner = at(h, 1.0) - at(h, -1.0);
                (at(h, 2.0) - at(h, -2.0) - inner - inner) / of(2.0 * h * h * h)
            }
        };
        let derivative = |order: usize| {
            let h = 2_f64.powi(-9);
            let mut row: Vec<DoubleDouble> = (0..4).map(|k| estimate(h * 0.5_f64.powi(k), order)).collect();
            for level in 1..4 {
                let weight = of(4_f64.powi(level));
                row = row.windows(2).map(|w| (w[1] * weight - w[0]) / (weight - of(1.0))).collect();
            }
            row[0].high
        };
        [f(of(x)).high, derivative(1), derivative(2), derivative(3)]
    }

    #[test]
    fn every_rule_agrees_with_differences_of_32_digits() {
        type Rule = (&'static str, fn(Jet<DoubleDouble>) -> Jet<DoubleDouble>);
        let rules: [Rule; 8] = [
            ("product", |x| x * x.square()),
            ("quotient", |x| x / (Jet::constant(2.0) + x.square())),
            ("root", |x| (Jet::constant(2.0) + x).sqrt()),
            ("sine", |x| x.square().sin_cos().0),
            ("cosine", |x| x.square().sin_cos().1),
            ("arc sine", |x| x.square().asin()),
            ("arc cosine", |x| x.square().acos()),
            ("angle", |x| Plane { x: x + Jet::constant(1.0), y: x.square() }.angle()),
        ];
        for (name, rule) in rules {
            let found = rule(Jet::variable(DoubleDouble::new(0.7))).derivatives();
            let expected = differences(|x| rule(Jet::variable(x)).value(), 0.7);
            for (found, expected) in found.into_iter().zip(expected) {
                assert!(
                    (found.high - expected).abs() < 1e-14 * (1.0 + expected.abs()),
                    "{name}: {found:?} {expected}"
                );
            }
        }
    }

    #[test]
    fn an_unknown_coefficient_spoils_higher_orders_alone() {
        let known = Jet::variable(0.5_f64).square().rate().sin_cos().0;
        assert!(known.0[..3].iter().all(|term| term.is_finite()) && known.0[3].is_nan(), "{known:?}");
        let product = known * Jet::variable(1.0) / known.sqrt();
        assert!(product.0[..3].iter().all(|term| term.is_finite()) && product.0[3].is_nan(), "{product:?}");
    }
}
