//! Numbers with a first derivative along two directions and the mixed one, and with their rate along the motion.
//!
//! Sums of products and the chain rule alone: no step size, so rounding is the only error.

use core::ops::{Add, Div, Mul, Neg, Sub};

/// v + a ε₁ + b ε₂ + c ε₁ε₂ with ε₁² = ε₂² = 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dual {
    /// Value.
    pub v: f64,
    /// Derivative along the first direction.
    pub a: f64,
    /// Derivative along the second direction: the time.
    pub b: f64,
    /// Mixed second derivative.
    pub c: f64,
}

/// A product in which a derivative of zero counts as none, so that an infinite slope harms nothing that stands still.
fn times(slope: f64, part: f64) -> f64 {
    if part == 0.0 { 0.0 } else { slope * part }
}

impl Dual {
    /// A number that does not move.
    pub const fn still(v: f64) -> Self {
        Dual { v, a: 0.0, b: 0.0, c: 0.0 }
    }

    /// `true` if nothing moves it.
    pub fn is_still(self) -> bool {
        self.a == 0.0 && self.b == 0.0 && self.c == 0.0
    }

    /// f of it, from value, slope and curvature of f.
    fn chain(self, [value, slope, curvature]: [f64; 3]) -> Self {
        let c = times(slope, self.c) + times(curvature, self.a * self.b);
        Dual { v: value, a: times(slope, self.a), b: times(slope, self.b), c }
    }

    fn sin(self) -> Self {
        let (sin, cos) = self.v.sin_cos();
        self.chain([sin, cos, -sin])
    }

    fn cos(self) -> Self {
        let (sin, cos) = self.v.sin_cos();
        self.chain([cos, -sin, -cos])
    }

    fn exp(self) -> Self {
        let exp = self.v.exp();
        self.chain([exp; 3])
    }

    fn ln(self) -> Self {
        self.chain([self.v.ln(), 1.0 / self.v, -1.0 / (self.v * self.v)])
    }

    fn sqrt(self) -> Self {
        let root = self.v.sqrt();
        self.chain([root, 0.5 / root, -0.25 / (root * self.v)])
    }

    fn tanh(self) -> Self {
        let tanh = self.v.tanh();
        let slope = 1.0 - tanh * tanh;
        self.chain([tanh, slope, -2.0 * tanh * slope])
    }

    fn atan(self) -> Self {
        let slope = 1.0 / (1.0 + self.v * self.v);
        self.chain([self.v.atan(), slope, -2.0 * self.v * slope * slope])
    }

    /// The power of a fixed exponent.
    fn power(self, n: f64) -> Self {
        let value = |n: f64| if n == 0.0 { 1.0 } else { self.v.powf(n) };
        let slope = if n == 0.0 { 0.0 } else { n * value(n - 1.0) };
        let curvature = if n == 0.0 || n == 1.0 { 0.0 } else { n * (n - 1.0) * value(n - 2.0) };
        self.chain([value(n), slope, curvature])
    }

    fn sign(self) -> Self {
        Dual::still(if self.v == 0.0 { 0.0 } else { self.v.signum() })
    }
}

impl Add for Dual {
    type Output = Dual;
    fn add(self, o: Dual) -> Dual {
        Dual { v: self.v + o.v, a: self.a + o.a, b: self.b + o.b, c: self.c + o.c }
    }
}

impl Neg for Dual {
    type Output = Dual;
    fn neg(self) -> Dual {
        Dual { v: -self.v, a: -self.a, b: -self.b, c: -self.c }
    }
}

impl Sub for Dual {
    type Output = Dual;
    fn sub(self, o: Dual) -> Dual {
        self + -o
    }
}

impl Mul for Dual {
    type Output = Dual;
    fn mul(self, o: Dual) -> Dual {
        Dual {
            v: self.v * o.v,
            a: times(o.v, self.a) + times(self.v, o.a),
            b: times(o.v, self.b) + times(self.v, o.b),
            c: times(o.v, self.c) + times(self.v, o.c) + self.a * o.b + self.b * o.a,
        }
    }
}

impl Div for Dual {
    type Output = Dual;
    fn div(self, o: Dual) -> Dual {
        let reciprocal = o.chain([1.0 / o.v, -1.0 / (o.v * o.v), 2.0 / (o.v * o.v * o.v)]);
        Dual { v: self.v / o.v, ..self * reciprocal }
    }
}

/// A value and its rate along the motion, both with their derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Number {
    /// Value.
    pub value: Dual,
    /// Rate along the motion.
    pub rate: Dual,
}

impl Number {
    /// A number that does not move.
    pub const fn still(value: f64) -> Self {
        Number { value: Dual::still(value), rate: Dual::still(0.0) }
    }

    /// `true` if nothing moves it.
    pub fn is_still(self) -> bool {
        self.value.is_still() && self.rate == Dual::default()
    }

    /// Its rate as a value, whose own rate is not known.
    pub fn der(self) -> Self {
        let unknown = if self.rate == Dual::default() { Dual::default() } else { Dual::still(f64::NAN) };
        Number { value: self.rate, rate: unknown }
    }

    fn of(self, value: Dual, slope: impl FnOnce(Dual) -> Dual) -> Self {
        let moves = self.rate != Dual::default();
        Number { value, rate: if moves { slope(self.value) * self.rate } else { Dual::default() } }
    }

    /// A function of it, from its value and its first three derivatives.
    pub fn through(self, [value, first, second, third]: [f64; 4]) -> Self {
        self.of(self.value.chain([value, first, second]), |x| x.chain([first, second, third]))
    }

    /// A function of one argument by its name; `None` where there is none.
    pub fn function(self, name: &str) -> Option<Self> {
        let one = Dual::still(1.0);
        let x = self.value;
        Some(match name {
            "sin" => self.of(x.sin(), Dual::cos),
            "cos" => self.of(x.cos(), |x| -x.sin()),
            "tan" => {
                let tan = x.sin() / x.cos();
                self.of(tan, |_| one + tan * tan)
            }
            "asin" => self.of((x / (one - x * x).sqrt()).atan(), |x| one / (one - x * x).sqrt()),
            "acos" => {
                let asin = self.function("asin")?;
                Number::still(core::f64::consts::FRAC_PI_2) - asin
            }
            "atan" => self.of(x.atan(), |x| one / (one + x * x)),
            "exp" => self.of(x.exp(), Dual::exp),
            "ln" => self.of(x.ln(), |x| one / x),
            "sqrt" => self.of(x.sqrt(), |x| Dual::still(0.5) / x.sqrt()),
            "tanh" => self.of(x.tanh(), |x| one - x.tanh() * x.tanh()),
            "sinh" => (self.function("exp")? - (-self).function("exp")?) * Number::still(0.5),
            "cosh" => (self.function("exp")? + (-self).function("exp")?) * Number::still(0.5),
            "asinh" => (self + (self * self + Number::still(1.0)).function("sqrt")?).function("ln")?,
            "acosh" => (self + (self * self - Number::still(1.0)).function("sqrt")?).function("ln")?,
            "atanh" => {
                let ratio = (Number::still(1.0) + self) / (Number::still(1.0) - self);
                ratio.function("ln")? * Number::still(0.5)
            }
            "abs" => self.of(Dual { v: x.v.abs(), ..x * x.sign() }, Dual::sign),
            "sign" => self.of(x.sign(), |_| Dual::default()),
            _ => return None,
        })
    }

    /// The angle of (x, `self`).
    pub fn atan2(self, x: Self) -> Self {
        // The angle from the direction at the point itself, whose tangent is 0 there.
        let (y0, x0) = (Number::still(self.value.v), Number::still(x.value.v));
        let ratio = (x0 * self - y0 * x) / (x0 * x + y0 * self);
        let turned = ratio.function("atan").unwrap_or(ratio);
        turned + Number::still(self.value.v.atan2(x.value.v))
    }

    /// √(x² + y²).
    pub fn hypot(self, other: Self) -> Self {
        let square = self * self + other * other;
        square.function("sqrt").unwrap_or(square)
    }

    /// A power; of an exponent that moves by logarithms.
    pub fn power(self, exponent: Self) -> Option<Self> {
        if exponent.is_still() {
            let n = exponent.value.v;
            return Some(self.of(self.value.power(n), |x| Dual::still(n) * x.power(n - 1.0)));
        }
        (exponent * self.function("ln")?).function("exp")
    }
}

impl Add for Number {
    type Output = Number;
    fn add(self, o: Number) -> Number {
        Number { value: self.value + o.value, rate: self.rate + o.rate }
    }
}

impl Neg for Number {
    type Output = Number;
    fn neg(self) -> Number {
        Number { value: -self.value, rate: -self.rate }
    }
}

impl Sub for Number {
    type Output = Number;
    fn sub(self, o: Number) -> Number {
        self + -o
    }
}

impl Mul for Number {
    type Output = Number;
    fn mul(self, o: Number) -> Number {
        Number { value: self.value * o.value, rate: self.rate * o.value + self.value * o.rate }
    }
}

impl Div for Number {
    type Output = Number;
    fn div(self, o: Number) -> Number {
        let value = self.value / o.value;
        let moves = self.rate != Dual::default() || o.rate != Dual::default();
        Number { value, rate: if moves { (self.rate - value * o.rate) / o.value } else { Dual::default() } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number x(s, t) = 0.3 + 0.7 s + 0.2 t + 0.5 s t with its rate 0.2 + 0.5 s + 0.4 t.
    fn moving() -> Number {
        Number {
            value: Dual { v: 0.3, a: 0.7, b: 0.2, c: 0.5 },
            rate: Dual { v: 0.2, a: 0.5, b: 0.4, c: 0.0 },
        }
    }

    /// A function with its first three derivatives at 0.3.
    type Known = (&'static str, fn(f64) -> f64);

    #[test]
    fn functions_have_the_derivatives_of_differences() {
        let known: [Known; 17] = [
            ("sin", f64::sin),
            ("cos", f64::cos),
            ("tan", f64::tan),
            ("asin", f64::asin),
            ("acos", f64::acos),
            ("atan", f64::atan),
            ("exp", f64::exp),
            ("ln", f64::ln),
            ("sqrt", f64::sqrt),
            ("tanh", f64::tanh),
            ("sinh", f64::sinh),
            ("cosh", f64::cosh),
            ("asinh", f64::asinh),
            ("atanh", f64::atanh),
            ("abs", f64::abs),
            ("sign", f64::signum),
            ("acosh", |x| (x + 2.0).acosh()),
        ];
        let h = 1e-3;
        for (name, f) in known {
            let shift = if name == "acosh" { Number::still(2.0) } else { Number::still(0.0) };
            let found = (moving() + shift).function(name).expect("a function");
            let slope =
                |x: f64| (8.0 * (f(x + h) - f(x - h)) - (f(x + 2.0 * h) - f(x - 2.0 * h))) / (12.0 * h);
            let curvature = |x: f64| (f(x + h) - 2.0 * f(x) + f(x - h)) / (h * h);
            let x = moving().value;
            let (first, second) = (slope(0.3), curvature(0.3));
            let close = |a: f64, b: f64, within: f64| assert!((a - b).abs() < within, "{name}: {a} {b}");
            close(found.value.v, f(0.3), 1e-15);
            close(found.value.a, first * x.a, 1e-8);
            close(found.value.b, first * x.b, 1e-8);
            close(found.value.c, first * x.c + second * x.a * x.b, 2e-5);
            close(found.rate.v, first * 0.2, 1e-8);
            close(found.rate.a, first * 0.5 + second * x.a * 0.2, 2e-5);
            close(found.rate.b, first * 0.4 + second * x.b * 0.2, 2e-5);
        }
    }

    #[test]
    fn products_powers_and_angles_agree_with_each_other() {
        let (x, y) = (moving(), moving() * moving() + Number::still(0.4));
        let apart = |a: Number, b: Number| {
            let parts = |n: Number| [n.value, n.rate].map(|d| [d.v, d.a, d.b, d.c]);
            let pairs = parts(a).into_iter().flatten().zip(parts(b).into_iter().flatten());
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let cube = x.power(Number::still(3.0)).expect("a power");
        assert!(apart(cube, x * x * x) < 1e-15);
        assert!(apart(x / y * y, x) < 1e-14);
        assert!(apart(y.atan2(x).function("tan").expect("a function"), y / x) < 1e-12);
        let by_logarithm = y.power(x).expect("a power").function("ln").expect("a function");
        assert!(apart(by_logarithm, x * y.function("ln").expect("a function")) < 1e-13);
        assert!(
            x.hypot(y).power(Number::still(2.0)).is_some_and(|square| apart(square, x * x + y * y) < 1e-14)
        );
    }

    #[test]
    fn a_constant_argument_survives_an_infinite_slope() {
        let root = Number::still(0.0).function("sqrt").expect("a function");
        assert_eq!((root.value, root.rate), (Dual::default(), Dual::default()));
        assert!(Number::still(2.0).der().is_still());
        assert!(moving().der().rate.v.is_nan());
    }
}
