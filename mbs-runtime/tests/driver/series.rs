//! Truncated power series: derivatives of any formula, written once more.

use core::ops::{Add, Mul, Sub};

/// Terms kept: value and seven derivatives.
pub const TERMS: usize = 8;

/// Σ aⱼ εʲ, the formula at x + ε.
#[derive(Clone, Copy, Debug)]
pub struct Series(pub [f64; TERMS]);

impl Series {
    pub fn variable(x: f64) -> Self {
        let mut terms = [0.0; TERMS];
        (terms[0], terms[1]) = (x, 1.0);
        Series(terms)
    }

    pub fn number(value: f64) -> Self {
        let mut terms = [0.0; TERMS];
        terms[0] = value;
        Series(terms)
    }

    pub fn power(self, exponent: usize) -> Self {
        (0..exponent).fold(Self::number(1.0), |product, _| product * self)
    }

    /// Sine, by s′ = c u′ and c′ = −s u′ term by term.
    pub fn sin(self) -> Self {
        let (mut sine, mut cosine) = ([0.0; TERMS], [0.0; TERMS]);
        (sine[0], cosine[0]) = self.0[0].sin_cos();
        for n in 1..TERMS {
            for k in 1..=n {
                let slope = k as f64 * self.0[k] / n as f64;
                sine[n] += slope * cosine[n - k];
                cosine[n] -= slope * sine[n - k];
            }
        }
        Series(sine)
    }

    pub fn derivatives(self) -> [f64; TERMS] {
        let mut factorial = 1.0;
        core::array::from_fn(|n| {
            factorial *= n.max(1) as f64;
            factorial * self.0[n]
        })
    }
}

impl Add for Series {
    type Output = Series;
    fn add(self, other: Series) -> Series {
        Series(core::array::from_fn(|n| self.0[n] + other.0[n]))
    }
}

impl Sub for Series {
    type Output = Series;
    fn sub(self, other: Series) -> Series {
        Series(core::array::from_fn(|n| self.0[n] - other.0[n]))
    }
}

impl Mul for Series {
    type Output = Series;
    fn mul(self, other: Series) -> Series {
        Series(core::array::from_fn(|n| (0..=n).map(|k| self.0[k] * other.0[n - k]).sum()))
    }
}

impl Mul<f64> for Series {
    type Output = Series;
    fn mul(self, factor: f64) -> Series {
        Series(self.0.map(|term| term * factor))
    }
}
