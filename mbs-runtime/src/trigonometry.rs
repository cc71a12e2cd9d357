//! Sine and cosine of many angles at once, inlined, the same bits on every target.
//!
//! `libm::sincos` takes one angle after the other, by branches on its size. Here |x| ≤ 1e5 rad goes without a
//! branch, so that the angles of a mechanism, or its lanes, share vector registers: with AVX2 eight lanes take a
//! third of libm's time, the four angles of a four-bar three quarters, whatever the quadrants. (Waiting for a
//! single angle whose quadrant the processor foresees, libm is as fast or faster.) No multiplication is fused with an
//! addition, so that targets with and without that instruction agree.

use core::f64::consts::FRAC_2_PI;

/// Largest |x| (rad) of the fast path: n, the number of quarter turns, has 16 bits there.
const LARGEST_ANGLE: f64 = 1e5;

/// 3/2 · 2⁵²: added and taken off, it rounds to an integer, which stands in the low bits meanwhile.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// π/2 in three parts. The first two have 37 bits, so that their products with n are exact; together they are π/2
/// to 6e-40.
const HALF_PI: [f64; 3] = [1.5707963267923333, 2.5633441515839558e-12, 1.0562999066987428e-23];

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

/// Sines and cosines of `angles` (rad): K each, within 0.8 units in the last place up to 1e5 rad.
///
/// Each component depends on its own angle alone. Beyond 1e5 rad, and for NaN and infinity, it is libm's.
#[inline(always)]
pub(crate) fn sin_cos<const K: usize>(angles: [f64; K]) -> ([f64; K], [f64; K]) {
    let (mut sines, mut cosines) = (angles, angles);
    let mut fast = true;
    for ((sine, cosine), angle) in sines.iter_mut().zip(&mut cosines).zip(angles) {
        (*sine, *cosine) = reduced(angle);
        fast &= angle.abs() <= LARGEST_ANGLE;
    }
    if fast { (sines, cosines) } else { replaced(angles, sines, cosines) }
}

/// Sines and cosines of `angles` (rad) in single precision: libm's, which computes in double precision.
#[inline(always)]
pub(crate) fn sin_cos_single<const K: usize>(angles: [f32; K]) -> ([f32; K], [f32; K]) {
    let (mut sines, mut cosines) = (angles, angles);
    for ((sine, cosine), angle) in sines.iter_mut().zip(&mut cosines).zip(angles) {
        (*sine, *cosine) = libm::sincosf(angle);
    }
    (sines, cosines)
}

/// libm's values in place of those beyond the fast path.
#[cold]
#[inline(never)]
fn replaced<const K: usize>(
    angles: [f64; K],
    mut sines: [f64; K],
    mut cosines: [f64; K],
) -> ([f64; K], [f64; K]) {
    for ((sine, cosine), angle) in sines.iter_mut().zip(&mut cosines).zip(angles) {
        let fast = angle.abs() <= LARGEST_ANGLE; // false for NaN
        if !fast {
            (*sine, *cosine) = libm::sincos(angle);
        }
    }
    (sines, cosines)
}

/// Sine and cosine for |x| ≤ [`LARGEST_ANGLE`].
#[inline(always)]
fn reduced(x: f64) -> (f64, f64) {
    let shifted = x * FRAC_2_PI + ROUNDER;
    let (quadrant, n) = (shifted.to_bits(), shifted - ROUNDER);

    // r − excess = x − n π/2. Source: Cody & Waite 1980, with the rounding of each difference kept in the excess.
    let [first, second, third] = HALF_PI;
    let (a, b, c) = (x - n * first, n * second, n * third);
    let r = a - b;
    let excess = c + (b - (a - r));

    let (sine, cosine) = polynomials(r, excess);
    // sin and cos of n π/2 + …: odd quadrants exchange them, the second bit of n and of n + 1 is the sign.
    let odd = quadrant & 1 == 1;
    let (first, second) = if odd { (cosine, sine) } else { (sine, cosine) };
    (signed(first, quadrant), signed(second, quadrant.wrapping_add(1)))
}

/// Sine and cosine of r − excess, |r| ≤ π/4, |excess| far below it.
#[inline(always)]
fn polynomials(r: f64, excess: f64) -> (f64, f64) {
    // Pairs of terms are summed side by side: the time is that of the longest chain of operations.
    let square = r * r;
    let (cube, fourth) = (square * r, square * square);
    let half = 0.5 * square;
    let w = 1.0 - half;
    let [s1, s2, s3, s4, s5, s6] = SINE;
    let p = (s1 + square * s2) + fourth * ((s3 + square * s4) + fourth * (s5 + square * s6));
    // The signs are such that −0 stays −0.
    let sine = r - (excess * w - cube * p);
    let [c1, c2, c3, c4, c5, c6] = COSINE;
    let p = (c1 + square * c2) + fourth * ((c3 + square * c4) + fourth * (c5 + square * c6));
    let cosine = w + (((1.0 - w) - half) + (fourth * p + r * excess));
    (sine, cosine)
}

/// `value` with the sign that bit 1 of `quadrant` stands for.
#[inline(always)]
fn signed(value: f64, quadrant: u64) -> f64 {
    f64::from_bits(value.to_bits() ^ ((quadrant & 2) << 62))
}

#[cfg(test)]
mod tests;
