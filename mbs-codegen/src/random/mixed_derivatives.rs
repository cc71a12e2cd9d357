//! Mixed derivatives along several directions at once, each with a running bound on its rounding error.
//!
//! A number is a polynomial in directions whose squares vanish, so that the coefficient of a product of directions is the
//! mixed derivative along them. Two directions are the motion, q(t + ε₁ + ε₂), two are variations.

use super::law;
use crate::symbolic::{Binary, Unary};

/// The motion.
pub const MOTION: usize = 0b0001;
/// The motion once more: for accelerations, and for the rates that a text writes.
pub const AGAIN: usize = 0b0010;
/// Virtual displacement.
pub const DISPLACED: usize = 0b0100;
/// Direction that the result is differentiated along.
pub const VARIED: usize = 0b1000;

/// One coefficient a set of directions.
const SETS: usize = 16;

/// Terms of a Taylor series, and one more for the bound: no product of more than four directions is left.
const ORDERS: usize = 6;

/// A polynomial: `v[set]` is the mixed derivative along the set's directions, `b[set]·2⁻⁵³` bounds what rounding does to it.
#[derive(Clone, Copy, Debug)]
pub struct Nilpotent {
    pub v: [f64; SETS],
    pub b: [f64; SETS],
    /// `true` if the value is so near a kink that rounding decides on its side.
    pub torn: bool,
}

impl Nilpotent {
    pub fn constant(value: f64) -> Self {
        Nilpotent::new(&[(0, value)])
    }

    /// Exact coefficients of some sets; a set that comes twice adds up.
    pub fn new(terms: &[(usize, f64)]) -> Self {
        let mut number = Nilpotent { v: [0.0; SETS], b: [0.0; SETS], torn: false };
        for (set, value) in terms {
            number.v[*set] += value;
            number.b[*set] += value.abs();
        }
        number
    }

    /// The derivative along `direction`, a polynomial in the others.
    pub fn along(self, direction: usize) -> Self {
        let mut slope = Nilpotent { torn: self.torn, ..Nilpotent::constant(0.0) };
        for set in (0..SETS).filter(|set| set & direction == 0) {
            (slope.v[set], slope.b[set]) = (self.v[set | direction], self.b[set | direction]);
        }
        slope
    }

    /// The rate that a text writes, along [`AGAIN`]; a polynomial in the other directions, and in none with it.
    pub fn rate(self) -> Self {
        let mut rate = self.along(AGAIN);
        for set in (0..SETS).filter(|set| set & AGAIN != 0) {
            (rate.v[set], rate.b[set]) = (f64::NAN, f64::NAN);
        }
        rate
    }

    pub fn plus(self, other: Self) -> Self {
        let mut sum = Nilpotent { torn: self.torn | other.torn, ..self };
        for set in 0..SETS {
            sum.v[set] += other.v[set];
            sum.b[set] += other.b[set] + sum.v[set].abs();
        }
        sum
    }

    pub fn negated(self) -> Self {
        Nilpotent { v: self.v.map(|v| -v), ..self }
    }

    pub fn minus(self, other: Self) -> Self {
        self.plus(other.negated())
    }

    /// The sets whose coefficients are not exactly 0, and their number: few, mostly.
    fn present(&self) -> ([usize; SETS], usize) {
        let (mut sets, mut count) = ([0; SETS], 0);
        for set in 0..SETS {
            if self.v[set] != 0.0 || self.b[set] != 0.0 {
                sets[count] = set;
                count += 1;
            }
        }
        (sets, count)
    }

    pub fn times(self, other: Self) -> Self {
        let mut product = Nilpotent { torn: self.torn | other.torn, ..Nilpotent::constant(0.0) };
        let ((lefts, left_count), (rights, right_count)) = (self.present(), other.present());
        for left in &lefts[..left_count] {
            for right in &rights[..right_count] {
                if left & right != 0 {
                    continue;
                }
                let (x, y) = (self.v[*left], other.v[*right]);
                product.v[left | right] += x * y;
                product.b[left | right] +=
                    2.0 * (self.b[*left] * y.abs() + x.abs() * other.b[*right] + (x * y).abs());
            }
        }
        product
    }

    /// Σ cₖ nᵏ, with n the part of this number that is not constant, and cₖ = f⁽ᵏ⁾/k! from `f` and the absolute
    /// values of its terms.
    fn chain(self, f: [f64; ORDERS], abs: [f64; ORDERS]) -> Self {
        let mut power = Nilpotent { torn: self.torn, ..Nilpotent::constant(1.0) };
        power.b[0] = 0.0;
        let mut moving = self;
        (moving.v[0], moving.b[0]) = (0.0, 0.0);
        let (mut sum, mut factorial) = (Nilpotent { torn: self.torn, ..Nilpotent::constant(0.0) }, 1.0);
        for order in 0..ORDERS - 1 {
            if power.present().1 == 0 {
                break;
            }
            let mut term = Nilpotent::constant(f[order] / factorial);
            term.b[0] = 2.0 * (abs[order + 1] * self.b[0] + abs[order]) / factorial;
            sum = sum.plus(power.times(term));
            power = power.times(moving);
            factorial *= (order + 1) as f64;
        }
        sum
    }

    /// The chain rule with the value and five derivatives of the outer function, each of one term.
    fn of(self, f: [f64; ORDERS]) -> Self {
        self.chain(f, f.map(f64::abs))
    }

    /// The chain rule from the Taylor coefficients of the outer function's first derivative.
    fn integrated(self, value: f64, slope: [f64; ORDERS]) -> Self {
        let (mut f, mut factorial) = ([value; ORDERS], 1.0);
        for order in 1..ORDERS {
            f[order] = slope[order - 1] * factorial;
            factorial *= order as f64;
        }
        self.of(f)
    }

    fn power(self, n: f64) -> Self {
        let (mut f, mut falling) = ([0.0; ORDERS], 1.0);
        for (order, term) in f.iter_mut().enumerate() {
            *term = if falling == 0.0 { 0.0 } else { falling * self.v[0].powf(n - order as f64) };
            falling *= n - order as f64;
        }
        // Powers may be computed by repeated products, one rounding each.
        let power = self.of(f);
        Nilpotent { b: power.b.map(|bound| bound * (n.abs() + 1.0)), ..power }
    }

    /// The same, torn where its sign is a matter of rounding.
    fn signed(self) -> Self {
        Nilpotent { torn: self.torn | (self.v[0].abs() <= super::ROUNDINGS * self.b[0]), ..self }
    }

    pub fn unary(self, function: Unary) -> Self {
        let x = self.v[0];
        match function {
            Unary::Negate => self.negated(),
            Unary::Sqrt => self.power(0.5),
            Unary::Exp => self.of([x.exp(); ORDERS]),
            Unary::Ln => self.integrated(x.ln(), power_series([x, 1.0, 0.0], -1.0)),
            Unary::Sin => self.of([x.sin(), x.cos(), -x.sin(), -x.cos(), x.sin(), x.cos()]),
            Unary::Cos => self.of([x.cos(), -x.sin(), -x.cos(), x.sin(), x.cos(), -x.sin()]),
            Unary::Tan => self.unary(Unary::Sin).times(self.unary(Unary::Cos).power(-1.0)),
            Unary::Asin => self.integrated(x.asin(), power_series([1.0 - x * x, -2.0 * x, -1.0], -0.5)),
            Unary::Acos => {
                let slope = power_series([1.0 - x * x, -2.0 * x, -1.0], -0.5);
                self.integrated(x.acos(), slope.map(|term| -term))
            }
            Unary::Atan => self.integrated(x.atan(), power_series([1.0 + x * x, 2.0 * x, 1.0], -1.0)),
            Unary::Sinh => self.of([x.sinh(), x.cosh(), x.sinh(), x.cosh(), x.sinh(), x.cosh()]),
            Unary::Cosh => self.of([x.cosh(), x.sinh(), x.cosh(), x.sinh(), x.cosh(), x.sinh()]),
            Unary::Tanh => {
                let t = x.tanh();
                let slopes = tanh_slopes();
                // Saturated, tanh has a slope with the rounding of 1.
                self.chain(slopes.map(|p| value(&p, t)), slopes.map(|p| value(&p.map(f64::abs), t.abs())))
            }
            Unary::Asinh => self.integrated(x.asinh(), power_series([1.0 + x * x, 2.0 * x, 1.0], -0.5)),
            Unary::Acosh => self.integrated(x.acosh(), power_series([x * x - 1.0, 2.0 * x, 1.0], -0.5)),
            Unary::Atanh => self.integrated(x.atanh(), power_series([1.0 - x * x, -2.0 * x, -1.0], -1.0)),
            Unary::Abs if x < 0.0 => self.signed().negated(),
            Unary::Abs => self.signed(),
            Unary::Sign => {
                let sign = if x == 0.0 { 0.0 } else { x.signum() };
                Nilpotent { torn: self.signed().torn, ..Nilpotent::constant(sign) }
            }
        }
    }

    pub fn binary(self, function: Binary, y: Self) -> Self {
        let is_constant = (1..SETS).all(|set| y.v[set] == 0.0);
        match function {
            Binary::Add => self.plus(y),
            Binary::Subtract => self.minus(y),
            Binary::Multiply => self.times(y),
            Binary::Divide => self.times(y.power(-1.0)),
            Binary::Power if is_constant => self.power(y.v[0]),
            Binary::Power => y.times(self.unary(Unary::Ln)).unary(Unary::Exp),
            Binary::Atan2 => {
                let mut angle = self.times(y.power(-1.0)).unary(Unary::Atan);
                angle.v[0] = self.v[0].atan2(y.v[0]);
                angle
            }
            Binary::Min | Binary::Max => {
                let takes_first = (self.v[0] < y.v[0]) == (function == Binary::Min);
                let picked = if takes_first { self } else { y };
                Nilpotent { torn: self.minus(y).signed().torn, ..picked }
            }
            Binary::Hypot => self.times(self).plus(y.times(y)).unary(Unary::Sqrt),
        }
    }

    /// A declared function's derivative of some order.
    pub fn call(self, function: u32, order: u8) -> Self {
        let orders = [0, 1, 2, 3, 4, 5].map(|more| order + more);
        self.chain(
            orders.map(|order| law::derivative(function, order, self.v[0])),
            orders.map(|order| law::magnitude(function, order)),
        )
    }
}

/// Taylor coefficients of (a + b s + c s²)ⁿ in s.
///
/// Source: Knuth 1997, §4.7 (powers of series, by Euler's recurrence).
fn power_series([a, b, c]: [f64; 3], n: f64) -> [f64; ORDERS] {
    let mut series = [0.0; ORDERS];
    series[0] = a.powf(n);
    for k in 1..ORDERS {
        let order = k as f64;
        let before = if k > 1 { series[k - 2] } else { 0.0 };
        let first = (n - order + 1.0) * b * series[k - 1];
        let second = (2.0 * n - order + 2.0) * c * before;
        series[k] = (first + second) / (order * a);
    }
    series
}

/// tanh and its derivatives as polynomials in tanh: each the last one's slope times 1 − t².
fn tanh_slopes() -> [[f64; ORDERS + 1]; ORDERS] {
    let mut slopes = [[0.0; ORDERS + 1]; ORDERS];
    slopes[0][1] = 1.0;
    for order in 1..ORDERS {
        for power in 1..=ORDERS {
            let slope = power as f64 * slopes[order - 1][power];
            slopes[order][power - 1] += slope;
            if power < ORDERS {
                slopes[order][power + 1] -= slope;
            }
        }
    }
    slopes
}

fn value(polynomial: &[f64], x: f64) -> f64 {
    polynomial.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Difference quotients of the lower derivatives, by a fourth-order formula.
    #[test]
    fn each_coefficient_is_the_slope_of_the_one_below() {
        const STEP: f64 = 1e-3;
        let all = [
            Unary::Sqrt,
            Unary::Exp,
            Unary::Ln,
            Unary::Sin,
            Unary::Cos,
            Unary::Tan,
            Unary::Asin,
            Unary::Acos,
            Unary::Atan,
            Unary::Sinh,
            Unary::Cosh,
            Unary::Tanh,
            Unary::Asinh,
            Unary::Atanh,
        ];
        for function in all {
            let at = |x: f64| {
                let argument =
                    Nilpotent::new(&[(0, x), (MOTION, 1.0), (AGAIN, 1.0), (DISPLACED, 1.0), (VARIED, 1.0)]);
                argument.unary(function).v
            };
            let x = 0.4;
            for (below, above) in [(0, MOTION), (MOTION, 0b0011), (0b0011, 0b0111), (0b0111, 0b1111)] {
                let near = at(x + STEP)[below] - at(x - STEP)[below];
                let far = at(x + 2.0 * STEP)[below] - at(x - 2.0 * STEP)[below];
                let slope = (8.0 * near - far) / (12.0 * STEP);
                let expected = at(x)[above];
                // The formula errs by h⁴/30 of the fifth derivative above, a few thousand at most here.
                assert!((slope - expected).abs() < 1e-8 * (1.0 + expected.abs()), "{function:?} {above:b}");
            }
        }
    }
}
