//! Sine and cosine of many angles at once, inlined.
//!
//! `libm::sincos` takes one angle after the other, by branches on its size. Here |x| ≤ 1e5 rad goes without a
//! branch, so that the angles of a mechanism, or its lanes, share vector registers: with AVX2 eight lanes take a
//! third of libm's time, the four angles of a four-bar three quarters, whatever the quadrants. (Waiting for a
//! single angle whose quadrant the processor foresees, libm is as fast or faster.)
//!
//! No multiplication is fused with an addition, so that all targets give the same bits; the feature `fma` trades that
//! for a shorter kernel on targets that have the instruction.

use core::f64::consts::FRAC_2_PI;

/// Largest |x| (rad) of the fast path: n, the number of quarter turns, has 16 bits there.
const LARGEST_ANGLE: f64 = 1e5;

/// 3/2 · 2⁵²: added and taken off, it rounds to an integer, which stands in the low bits meanwhile.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// π/2 in three parts. The first two have 37 bits, so that their products with n are exact; together they are π/2
/// to 6e-40.
const HALF_PI: [f64; 3] = [1.5707963267923333, 2.5633441515839558e-12, 1.0562999066987428e-23];

/// π/2 to 1.5e-33 for the fused kernel: n times the first part, taken off x without rounding in between, is exact.
const FUSED_HALF_PI: [f64; 2] = [core::f64::consts::FRAC_PI_2, 6.123233995736766e-17];

/// Angles that go side by side, in one wide register or two narrow ones.
const WIDE: usize = if cfg!(target_feature = "avx") { 8 } else { NARROW };

/// Angles that share a narrow register; one where the target has none for numbers side by side.
const NARROW: usize = if cfg!(target_feature = "avx") {
    4
} else if cfg!(any(target_feature = "sse2", target_feature = "neon")) {
    2
} else {
    1
};

/// How a product and a sum are put together.
trait Arithmetic {
    /// Whether the product is not rounded.
    const FUSED: bool;
    /// a b + c.
    fn multiply_add(a: f64, b: f64, c: f64) -> f64;
}

/// Product and sum, each rounded.
struct Separate;

impl Arithmetic for Separate {
    const FUSED: bool = false;
    #[inline(always)]
    fn multiply_add(a: f64, b: f64, c: f64) -> f64 {
        a * b + c
    }
}

/// The instruction of the target, which core does not offer; in tests on other targets a slow replacement.
#[cfg(any(test, all(feature = "fma", any(target_feature = "fma", target_arch = "aarch64"))))]
struct Fused;

#[cfg(any(test, all(feature = "fma", any(target_feature = "fma", target_arch = "aarch64"))))]
impl Arithmetic for Fused {
    const FUSED: bool = true;
    #[inline(always)]
    fn multiply_add(a: f64, b: f64, c: f64) -> f64 {
        extern crate std;
        f64::mul_add(a, b, c)
    }
}

#[cfg(all(feature = "fma", any(target_feature = "fma", target_arch = "aarch64")))]
type Best = Fused;
#[cfg(not(all(feature = "fma", any(target_feature = "fma", target_arch = "aarch64"))))]
type Best = Separate;

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

/// Sines and cosines of `angles` (rad): K each, within 0.8 units in the last place up to 1e5 rad; with fused operations
/// within 1.6 up to half a turn, and 1.8e-16 up to 1e5 rad.
///
/// Each component depends on its own angle alone. Beyond 1e5 rad, and for NaN and infinity, it is libm's.
#[inline(always)]
pub(crate) fn sin_cos<const K: usize>(angles: [f64; K]) -> ([f64; K], [f64; K]) {
    sin_cos_by::<Best, K>(angles)
}

#[inline(always)]
fn sin_cos_by<A: Arithmetic, const K: usize>(angles: [f64; K]) -> ([f64; K], [f64; K]) {
    let (mut sines, mut cosines) = (angles, angles);
    let mut fast = true;
    if K == 1 {
        // It has nothing to go beside it.
        fast = reduce::<A, K, true>(&mut sines, &mut cosines, angles);
    } else {
        let packs = sines.chunks_mut(WIDE).zip(cosines.chunks_mut(WIDE)).zip(angles.chunks(WIDE));
        for ((sines, cosines), angles) in packs {
            fast &= if angles.len() <= NARROW {
                if K <= 2 {
                    padded::<A, NARROW, true>(sines, cosines, angles)
                } else {
                    padded::<A, NARROW, false>(sines, cosines, angles)
                }
            } else {
                padded::<A, WIDE, false>(sines, cosines, angles)
            };
        }
    }
    if !fast {
        // Assigned, not returned: what a function returns is in memory, and the fast path would go through there too.
        let (replaced_sines, replaced_cosines) = replaced(angles, sines, cosines);
        (sines, cosines) = (replaced_sines, replaced_cosines);
    }
    (sines, cosines)
}

/// Sines and cosines of W angles side by side; whether all are on the fast path.
#[inline(always)]
fn reduce<A: Arithmetic, const W: usize, const FEW: bool>(
    sines: &mut [f64; W],
    cosines: &mut [f64; W],
    angles: [f64; W],
) -> bool {
    let mut fast = true;
    for ((sine, cosine), angle) in sines.iter_mut().zip(cosines).zip(angles) {
        (*sine, *cosine) = reduced::<A, FEW>(angle);
        fast &= angle.abs() <= LARGEST_ANGLE;
    }
    fast
}

/// As [`sin_cos`], of K angles in L lanes each: one loop over all of them, which the compiler makes one of registers.
#[inline(always)]
pub(crate) fn sin_cos_of_lanes<const L: usize, const K: usize>(
    angles: [[f64; L]; K],
) -> ([[f64; L]; K], [[f64; L]; K]) {
    let (mut sines, mut cosines) = ([[0.0; L]; K], [[0.0; L]; K]);
    let mut fast = true;
    let places = sines.as_flattened_mut().iter_mut().zip(cosines.as_flattened_mut());
    for ((sine, cosine), angle) in places.zip(angles.as_flattened()) {
        (*sine, *cosine) = reduced::<Best, false>(*angle);
        fast &= angle.abs() <= LARGEST_ANGLE;
    }
    if !fast {
        // As in `sin_cos_by`.
        let (replaced_sines, replaced_cosines) = replaced_lanes(angles, sines, cosines);
        (sines, cosines) = (replaced_sines, replaced_cosines);
    }
    (sines, cosines)
}

/// As [`replaced`], of K angles in L lanes each.
#[cold]
#[inline(never)]
fn replaced_lanes<const L: usize, const K: usize>(
    angles: [[f64; L]; K],
    mut sines: [[f64; L]; K],
    mut cosines: [[f64; L]; K],
) -> ([[f64; L]; K], [[f64; L]; K]) {
    for ((sines, cosines), angles) in sines.iter_mut().zip(&mut cosines).zip(angles) {
        (*sines, *cosines) = replaced(angles, *sines, *cosines);
    }
    (sines, cosines)
}

/// As [`reduce`], for at most W angles; zeros take the other places.
#[inline(always)]
fn padded<A: Arithmetic, const W: usize, const FEW: bool>(
    sines: &mut [f64],
    cosines: &mut [f64],
    angles: &[f64],
) -> bool {
    let mut pack = [0.0; W];
    pack.iter_mut().zip(angles).for_each(|(place, angle)| *place = *angle);
    let (mut pack_sines, mut pack_cosines) = (pack, pack);
    let fast = reduce::<A, W, FEW>(&mut pack_sines, &mut pack_cosines, pack);
    sines.iter_mut().zip(pack_sines).for_each(|(place, sine)| *place = sine);
    cosines.iter_mut().zip(pack_cosines).for_each(|(place, cosine)| *place = cosine);
    fast
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

/// Sines and cosines of the lanes of `angles` (rad) in single precision: those of double precision, rounded.
#[inline(always)]
pub(crate) fn sin_cos_of_lanes_single<const L: usize, const K: usize>(
    angles: [[f32; L]; K],
) -> ([[f32; L]; K], [[f32; L]; K]) {
    let (sines, cosines) = sin_cos_of_lanes(angles.map(|lanes| lanes.map(f64::from)));
    let rounded = |values: [[f64; L]; K]| values.map(|lanes| lanes.map(|value| value as f32));
    (rounded(sines), rounded(cosines))
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
///
/// `FEW`: one angle or two, which are waited for. They are exchanged by bits, for a choice would go through the registers of
/// masks, which takes longer; in a full register it is the choice that takes fewer operations.
#[inline(always)]
fn reduced<A: Arithmetic, const FEW: bool>(x: f64) -> (f64, f64) {
    let shifted = A::multiply_add(x, FRAC_2_PI, ROUNDER);
    let (quadrant, n) = (shifted.to_bits(), shifted - ROUNDER);
    let (sine, cosine) = if A::FUSED {
        brief::<A>(remainder_fused::<A>(x, n))
    } else {
        let (r, excess) = remainder(x, n);
        polynomials(r, excess)
    };
    // sin and cos of n π/2 + …: odd quadrants exchange them, the second bit of n and of n + 1 is the sign.
    let (sine, cosine) = (sine.to_bits(), cosine.to_bits());
    let (first, second) = if FEW {
        let odd = (((quadrant << 63) as i64) >> 63) as u64;
        let exchanged = (sine ^ cosine) & odd;
        (sine ^ exchanged, cosine ^ exchanged)
    } else {
        let odd = quadrant & 1 == 1;
        if odd { (cosine, sine) } else { (sine, cosine) }
    };
    (signed(first, quadrant), signed(second, quadrant.wrapping_add(1)))
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
fn remainder_fused<A: Arithmetic>(x: f64, n: f64) -> f64 {
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
fn brief<A: Arithmetic>(r: f64) -> (f64, f64) {
    let square = r * r;
    let (cube, fourth) = (square * r, square * square);
    let sine = A::multiply_add(cube, series::<A>(SINE, square, fourth), r);
    let w = A::multiply_add(-0.5, square, 1.0);
    (sine, A::multiply_add(fourth, series::<A>(COSINE, square, fourth), w))
}

/// a + b r² + c r⁴ + …; pairs of terms are summed side by side: the time is that of the longest chain of operations.
#[inline(always)]
fn series<A: Arithmetic>([a, b, c, d, e, f]: [f64; 6], square: f64, fourth: f64) -> f64 {
    let low = A::multiply_add(square, b, a);
    let middle = A::multiply_add(square, d, c);
    let high = A::multiply_add(square, f, e);
    A::multiply_add(fourth, A::multiply_add(fourth, high, middle), low)
}

/// The number of the bits `value` with the sign that bit 1 of `quadrant` stands for.
#[inline(always)]
fn signed(value: u64, quadrant: u64) -> f64 {
    f64::from_bits(value ^ ((quadrant & 2) << 62))
}

#[cfg(test)]
mod tests;
