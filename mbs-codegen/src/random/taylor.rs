//! Value, first and second derivative along a line, each with a running bound on its rounding error.

use crate::symbolic::{Binary, Unary};

/// A quantity along a line: `v[k]` is its k-th derivative, `b[k]·2⁻⁵³` bounds what rounding does to it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Jet {
    pub v: [f64; 3],
    pub b: [f64; 3],
    /// `true` if the value is so near a kink that rounding decides on its side.
    pub torn: bool,
}

impl Jet {
    /// Exact data.
    pub fn new(v: [f64; 3]) -> Self {
        Jet { v, b: v.map(f64::abs), torn: false }
    }

    pub fn constant(value: f64) -> Self {
        Jet::new([value, 0.0, 0.0])
    }

    fn plus(self, other: Jet, sign: f64) -> Self {
        let mut sum = Jet { torn: self.torn | other.torn, ..self };
        for k in 0..3 {
            sum.v[k] += sign * other.v[k];
            sum.b[k] += other.b[k] + sum.v[k].abs();
        }
        sum
    }

    fn times(self, y: Jet) -> Self {
        let x = self;
        // Each term a·b with its bound.
        let term = |i: usize, j: usize| {
            (x.v[i] * y.v[j], x.b[i] * y.v[j].abs() + x.v[i].abs() * y.b[j] + (x.v[i] * y.v[j]).abs())
        };
        let (a, b, c) = (term(0, 0), term(1, 0), term(0, 1));
        let (d, e, f) = (term(2, 0), term(1, 1), term(0, 2));
        Jet {
            v: [a.0, b.0 + c.0, d.0 + 2.0 * e.0 + f.0],
            b: [a.1 * 2.0, (b.1 + c.1) * 2.0, (d.1 + 2.0 * e.1 + f.1) * 2.0],
            torn: x.torn | y.torn,
        }
    }

    /// The chain rule from the outer function's value and first three derivatives.
    pub fn chain(self, f: [f64; 4]) -> Self {
        self.chain_of_terms(f, f.map(f64::abs))
    }

    /// The same where a derivative is a sum of larger terms; `abs` sums their absolute values.
    pub fn chain_of_terms(self, f: [f64; 4], abs: [f64; 4]) -> Self {
        let [_, x1, x2] = self.v;
        let [b0, b1, b2] = self.b;
        Jet {
            v: [f[0], f[1] * x1, f[2] * x1 * x1 + f[1] * x2],
            b: [
                abs[1] * b0 + abs[0],
                abs[2] * b0 * x1.abs() + abs[1] * b1 + (abs[1] + abs[2]) * x1.abs(),
                abs[3] * b0 * x1 * x1
                    + 2.0 * abs[2] * x1.abs() * b1
                    + abs[2] * b0 * x2.abs()
                    + abs[1] * b2
                    + (abs[2] + abs[3]) * x1 * x1
                    + (abs[1] + abs[2]) * x2.abs(),
            ]
            .map(|bound| 2.0 * bound),
            torn: self.torn,
        }
    }

    /// The same, torn where its sign is a matter of rounding.
    fn signed(self) -> Self {
        Jet { torn: self.torn | (self.v[0].abs() <= super::ROUNDINGS * self.b[0]), ..self }
    }

    pub fn unary(self, function: Unary) -> Self {
        let x = self.v[0];
        match function {
            Unary::Negate => Jet { v: self.v.map(|v| -v), ..self },
            Unary::Sqrt => {
                let r = x.sqrt();
                self.chain([r, 0.5 / r, -0.25 / (x * r), 0.375 / (x * x * r)])
            }
            Unary::Exp => self.chain([x.exp(); 4]),
            Unary::Ln => self.chain([x.ln(), 1.0 / x, -1.0 / (x * x), 2.0 / (x * x * x)]),
            Unary::Sin => self.chain([x.sin(), x.cos(), -x.sin(), -x.cos()]),
            Unary::Cos => self.chain([x.cos(), -x.sin(), -x.cos(), x.sin()]),
            Unary::Tan => {
                let (t, s) = (x.tan(), 1.0 + x.tan() * x.tan());
                self.chain([t, s, 2.0 * t * s, 2.0 * s * s + 4.0 * t * t * s])
            }
            Unary::Asin => {
                let w = 1.0 / (1.0 - x * x);
                let r = w.sqrt();
                self.chain([x.asin(), r, x * w * r, (1.0 + 2.0 * x * x) * w * w * r])
            }
            Unary::Acos => {
                let w = 1.0 / (1.0 - x * x);
                let r = w.sqrt();
                self.chain([x.acos(), -r, -x * w * r, -(1.0 + 2.0 * x * x) * w * w * r])
            }
            Unary::Atan => {
                let w = 1.0 / (1.0 + x * x);
                self.chain([x.atan(), w, -2.0 * x * w * w, (6.0 * x * x - 2.0) * w * w * w])
            }
            Unary::Sinh => self.chain([x.sinh(), x.cosh(), x.sinh(), x.cosh()]),
            Unary::Cosh => self.chain([x.cosh(), x.sinh(), x.cosh(), x.sinh()]),
            Unary::Tanh => {
                // Saturated, tanh has a slope with the rounding of 1.
                let (t, square) = (x.tanh(), x.tanh() * x.tanh());
                let derivatives =
                    |s: f64, sign: f64| [t, s, 2.0 * sign * t * s, (2.0 * sign * s + 4.0 * square) * s];
                self.chain_of_terms(
                    derivatives(1.0 - square, -1.0),
                    derivatives(1.0 + square, 1.0).map(f64::abs),
                )
            }
            Unary::Asinh => {
                let w = 1.0 / (1.0 + x * x);
                let r = w.sqrt();
                self.chain([x.asinh(), r, -x * w * r, (2.0 * x * x - 1.0) * w * w * r])
            }
            Unary::Acosh => {
                let w = 1.0 / (x * x - 1.0);
                let r = w.sqrt();
                self.chain([x.acosh(), r, -x * w * r, (2.0 * x * x + 1.0) * w * w * r])
            }
            Unary::Atanh => {
                let w = 1.0 / (1.0 - x * x);
                self.chain([x.atanh(), w, 2.0 * x * w * w, (6.0 * x * x + 2.0) * w * w * w])
            }
            Unary::Abs if x < 0.0 => self.signed().unary(Unary::Negate),
            Unary::Abs => self.signed(),
            Unary::Sign => {
                let sign = if x == 0.0 { 0.0 } else { x.signum() };
                Jet { torn: self.signed().torn, ..Jet::constant(sign) }
            }
        }
    }

    pub fn binary(self, function: Binary, y: Jet) -> Self {
        match function {
            Binary::Add => self.plus(y, 1.0),
            Binary::Subtract => self.plus(y, -1.0),
            Binary::Multiply => self.times(y),
            Binary::Divide => self.times(y.inverse()),
            Binary::Power if y.v[1] == 0.0 && y.v[2] == 0.0 => {
                let (x, n) = (self.v[0], y.v[0]);
                let falling = [1.0, n, n * (n - 1.0), n * (n - 1.0) * (n - 2.0)];
                let mut order = 0.0;
                self.chain(falling.map(|factor| {
                    let term = if factor == 0.0 { 0.0 } else { factor * x.powf(n - order) };
                    order += 1.0;
                    term
                }))
                .widened(n.abs() + 1.0)
            }
            Binary::Power => y.times(self.unary(Unary::Ln)).unary(Unary::Exp),
            Binary::Atan2 => {
                let mut angle = self.times(y.inverse()).unary(Unary::Atan);
                angle.v[0] = self.v[0].atan2(y.v[0]);
                angle
            }
            Binary::Min | Binary::Max => {
                let takes_first = (self.v[0] < y.v[0]) == (function == Binary::Min);
                let picked = if takes_first { self } else { y };
                Jet { torn: self.plus(y, -1.0).signed().torn, ..picked }
            }
            Binary::Hypot => self.times(self).plus(y.times(y), 1.0).unary(Unary::Sqrt),
        }
    }

    fn inverse(self) -> Self {
        let x = self.v[0];
        self.chain([1.0 / x, -1.0 / (x * x), 2.0 / (x * x * x), -6.0 / (x * x * x * x)])
    }

    /// Powers may be computed by repeated products, one rounding each.
    fn widened(self, factor: f64) -> Self {
        Jet { b: self.b.map(|bound| bound * factor), ..self }
    }
}
