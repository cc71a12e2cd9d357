//! The kernel of double precision.

use core::f64::consts::FRAC_2_PI;

use crate::scalar::trigonometry::{Angle, Arithmetic, Separate, by_bits};

/// Largest |x| (rad) of the fast path: n, the number of quarter turns, has 16 bits there.
pub(super) const LARGEST_ANGLE: f64 = 1e5;

/// 3/2 · 2⁵²: added and taken off, it rounds to an integer, which stands in the low bits meanwhile.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// π/2 in three parts. The first two have 37 bits, so that their products with n are exact; together they are π/2
/// to 6e-40.
const HALF_PI: [f64; 3] = [1.5707963267923333, 2.5633441515839558e-12, 1.0562999066987428e-23];

/// π/2 to 1.5e-33 for the fused kernel: n times the first part, taken off x without rounding in between, is exact.
const FUSED_HALF_PI: [f64; 2] = [core::f64::consts::FRAC_PI_2, 6.123233995736766e-17];

/// Minimax polynomials on |r| ≤ π/4: sin r = r + r³ (S₁ + S₂ r² + …), cos r = 1 − r²/2 + r⁴ (C₁ + C₂ r² + …).
/// Source: FreeBSD, msun, `k_sin.c` and `k_cos.c`, Copyright (C) 1993 by Sun Microsystems, Inc.
const SINE: [f64; 6] = [
    -0.16666666666666632,
    0.00833333333332249,
    -0.0001984126982985795,
    2.7557313707070068e-06,
    -2.5050760253406863e-08,
    1.58969099521155e-10,
];
const COSINE: [f64; 6] = [
    0.0416666666666666,
    -0.001388888888887411,
    2.480158728947673e-05,
    -2.7557314351390663e-07,
    2.087572321298175e-09,
    -1.1359647557788195e-11,
];

impl Angle for f64 {
    #[inline(always)]
    fn is_near(self) -> bool {
        self.abs() <= LARGEST_ANGLE
    }

    #[inline(always)]
    fn sin_cos<A: Arithmetic<f64>, const FEW: bool>(self) -> (f64, f64) {
        reduced::<A, FEW>(self)
    }

    #[inline(always)]
    fn of_library(self) -> (f64, f64) {
        libm::sincos(self)
    }

    #[inline(always)]
    fn far<const K: usize>(angles: [f64; K], near: ([f64; K], [f64; K])) -> ([f64; K], [f64; K]) {
        let (mut sines, mut cosines) = near;
        for ((sine, cosine), angle) in sines.iter_mut().zip(&mut cosines).zip(angles) {
            if !angle.is_near() {
                (*sine, *cosine) = libm::sincos(angle);
            }
        }
        (sines, cosines)
    }
}

/// Sine and cosine for |x| ≤ [`LARGEST_ANGLE`].
///
/// `FEW`: one angle or two, which are waited for. They are exchanged by bits, for a choice would go through the registers of
/// masks, which takes longer; in a full register it is the choice that takes fewer operations.
#[inline(always)]
fn reduced<A: Arithmetic<f64>, const FEW: bool>(x: f64) -> (f64, f64) {
    let shifted = A::multiply_add(x, FRAC_2_PI, ROUNDER);
    let (quadrant, n) = (shifted.to_bits(), shifted - ROUNDER);
    let (sine, cosine) = if A::FUSED {
        brief::<A>(remainder_fused::<A>(x, n))
    } else {
        let (r, excess) = remainder(x, n);
        polynomials(r, excess)
    };
    turned::<FEW>(quadrant, (sine, cosine))
}

/// r and excess with r − excess = x − n π/2. Source: Cody & Waite 1980, with the rounding of each difference kept in
/// the excess.
#[inline(always)]
fn remainder(x: f64, n: f64) -> (f64, f64) {
    let [first, second, third] = HALF_PI;
    let (a, b, c) = (x - n * first, n * second, n * third);
    let r = a - b;
    (r, c + (b - (a - r)))
}

/// x − n π/2, rounded once.
#[inline(always)]
fn remainder_fused<A: Arithmetic<f64>>(x: f64, n: f64) -> f64 {
    let [first, second] = FUSED_HALF_PI;
    A::multiply_add(-n, second, A::multiply_add(-n, first, x))
}

/// Sine and cosine of r − excess, |r| ≤ π/4, |excess| far below it.
#[inline(always)]
fn polynomials(r: f64, excess: f64) -> (f64, f64) {
    let square = r * r;
    let (cube, fourth, half) = (square * r, square * square, 0.5 * square);
    let w = 1.0 - half;
    // The signs are such that −0 stays −0.
    let sine = r - (excess * w - cube * series::<Separate>(SINE, square, fourth));
    let rest = fourth * series::<Separate>(COSINE, square, fourth) + r * excess;
    (sine, w + (((1.0 - w) - half) + rest))
}

/// Sine and cosine of r, |r| ≤ π/4, without the corrections that the last third of a unit costs.
#[inline(always)]
fn brief<A: Arithmetic<f64>>(r: f64) -> (f64, f64) {
    let square = r * r;
    let (cube, fourth) = (square * r, square * square);
    let sine = A::multiply_add(cube, series::<A>(SINE, square, fourth), r);
    let w = A::multiply_add(-0.5, square, 1.0);
    (sine, A::multiply_add(fourth, series::<A>(COSINE, square, fourth), w))
}

/// a + b r² + c r⁴ + …; pairs of terms are summed side by side: the time is that of the longest chain of operations.
#[inline(always)]
fn series<A: Arithmetic<f64>>([a, b, c, d, e, f]: [f64; 6], square: f64, fourth: f64) -> f64 {
    let low = A::multiply_add(square, b, a);
    let middle = A::multiply_add(square, d, c);
    let high = A::multiply_add(square, f, e);
    A::multiply_add(fourth, A::multiply_add(fourth, high, middle), low)
}

by_bits!(f64, u64, i64);
