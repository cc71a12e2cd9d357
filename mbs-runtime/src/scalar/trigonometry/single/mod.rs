//! The kernel of single precision: operations of single precision alone, the only ones of small processors.

#[cfg(test)]
mod tests;

use core::f32::consts::FRAC_2_PI;

use crate::scalar::trigonometry::{Angle, Arithmetic, by_bits};

/// Largest |x| (rad) of the fast path: n, the number of quarter turns, has 7 bits there.
pub(super) const LARGEST_ANGLE: f32 = 128.0;

/// 3/2 · 2²³: added and taken off, it rounds to an integer, which stands in the low bits meanwhile.
const ROUNDER: f32 = 12_582_912.0;

/// π/2 in three parts. The first two have 17 bits, so that their products with n are exact; together they are π/2 to
/// 1e-18, where no number up to 128 but 0 is nearer than 1e-8 to a multiple of π/2.
const HALF_PI: [f32; 3] = [1.5707855e+00, 1.0804273e-05, 6.0771006e-11];

/// Minimax polynomials on |r| ≤ π/4: sin r = r + r³ (S₁ + S₂ r² + S₃ r⁴) to 2^-27.9 of it, cos r = 1 − r²/2 + r⁴ (C₁ + C₂ r²
/// + C₃ r⁴) to 2^-33. Source: Remez's exchange, coefficient after coefficient rounded and the others fitted again.
const SINE: [f32; 3] = [-0.166_666_55, 0.008_332_189, -0.000_195_182_9];
const COSINE: [f32; 3] = [0.041_666_646, -0.001_388_731_2, 2.443_276_6e-5];

impl Angle for f32 {
    #[inline(always)]
    fn is_near(self) -> bool {
        self.abs() <= LARGEST_ANGLE
    }

    #[inline(always)]
    fn sin_cos<A: Arithmetic<f32>, const FEW: bool>(self) -> (f32, f32) {
        reduced::<A, FEW>(self)
    }

    #[inline(always)]
    fn of_library(self) -> (f32, f32) {
        libm::sincosf(self)
    }

    /// Those of double precision, rounded.
    #[inline(always)]
    fn far<const K: usize>(angles: [f32; K], near: ([f32; K], [f32; K])) -> ([f32; K], [f32; K]) {
        let (mut sines, mut cosines) = near;
        let (far_sines, far_cosines) = crate::scalar::trigonometry::sin_cos(angles.map(f64::from));
        for ((sine, far), angle) in sines.iter_mut().zip(far_sines).zip(angles) {
            *sine = if angle.is_near() { *sine } else { far as f32 };
        }
        for ((cosine, far), angle) in cosines.iter_mut().zip(far_cosines).zip(angles) {
            *cosine = if angle.is_near() { *cosine } else { far as f32 };
        }
        (sines, cosines)
    }
}

/// Sine and cosine for |x| ≤ [`LARGEST_ANGLE`]; `FEW` as in double precision.
#[inline(always)]
fn reduced<A: Arithmetic<f32>, const FEW: bool>(x: f32) -> (f32, f32) {
    let shifted = A::multiply_add(x, FRAC_2_PI, ROUNDER);
    let (quadrant, n) = (shifted.to_bits(), shifted - ROUNDER);
    let (r, excess) = remainder::<A>(x, n);
    let (sine, cosine) = polynomials::<A>(r, excess);
    turned::<FEW>(quadrant, (sine, cosine))
}

/// r and excess with r − excess = x − n π/2. Source: Cody & Waite 1980, with the rounding of each difference kept in
/// the excess.
#[inline(always)]
fn remainder<A: Arithmetic<f32>>(x: f32, n: f32) -> (f32, f32) {
    let [first, second, third] = HALF_PI;
    let (a, b) = (A::multiply_add(-n, first, x), n * second);
    let r = a - b;
    (r, A::multiply_add(n, third, b - (a - r)))
}

/// Sine and cosine of r − excess, |r| ≤ π/4, |excess| far below it.
#[inline(always)]
fn polynomials<A: Arithmetic<f32>>(r: f32, excess: f32) -> (f32, f32) {
    let square = r * r;
    let (cube, fourth, half) = (square * r, square * square, 0.5 * square);
    let w = 1.0 - half;
    // The signs are such that −0 stays −0.
    let sine = r - A::multiply_add(excess, w, -(cube * series::<A>(SINE, square, fourth)));
    let rest = A::multiply_add(fourth, series::<A>(COSINE, square, fourth), r * excess);
    (sine, w + (((1.0 - w) - half) + rest))
}

/// a + b r² + c r⁴.
#[inline(always)]
fn series<A: Arithmetic<f32>>([a, b, c]: [f32; 3], square: f32, fourth: f32) -> f32 {
    A::multiply_add(fourth, c, A::multiply_add(square, b, a))
}

by_bits!(f32, u32, i32);
