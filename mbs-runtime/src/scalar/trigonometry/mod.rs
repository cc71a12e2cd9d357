//! Sine and cosine of many angles at once, and the angle of a point, inlined.
//!
//! `libm::sincos` takes one angle after the other, by branches on its size. Here |x| ≤ 1e5 rad (128 rad in single precision)
//! goes without a branch. So the angles of a mechanism, or its lanes, share vector registers. With AVX2 eight lanes take a
//! third of libm's time, the four angles of a four-bar three quarters, whatever the quadrants. (For a single awaited angle
//! whose quadrant the processor foresees, libm is as fast or faster.)
//!
//! No multiplication is fused with an addition, so that all targets give the same bits. The feature `fma` trades that
//! for a shorter kernel on targets that have the instruction. The feature `libm` takes the library's functions instead.

mod direction;
pub(crate) mod double;
pub(crate) mod single;
#[cfg(test)]
mod tests;

use core::ops::Add;
use core::ops::Mul;

pub(crate) use direction::atan2;

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

/// `true` if registers have no instruction that chooses numbers by a mask: then bits are exchanged in fewer operations.
const BY_BITS: bool = cfg!(all(target_feature = "sse2", not(target_feature = "sse4.1")));

/// As [`WIDE`], in single precision.
const WIDE_SINGLE: usize = if cfg!(target_feature = "avx") { 8 } else { NARROW_SINGLE };

/// As [`NARROW`], in single precision.
const NARROW_SINGLE: usize = if cfg!(any(target_feature = "sse2", target_feature = "neon")) { 4 } else { 1 };

/// An angle (rad) as a number that the processor has.
trait Angle: Copy + Default + Mul<Output = Self> + Add<Output = Self> {
    /// `true` if the angle is on the fast path; false for NaN.
    fn is_near(self) -> bool;
    /// Sine and cosine of an angle on the fast path; of any other angle the result has no meaning.
    ///
    /// `FEW`: one angle or two, which are waited for.
    fn sin_cos<A: Arithmetic<Self>, const FEW: bool>(self) -> (Self, Self);
    /// Those of the library.
    fn of_library(self) -> (Self, Self);
    /// `near` with the values of angles that are not on the fast path replaced.
    fn far<const K: usize>(angles: [Self; K], near: ([Self; K], [Self; K])) -> ([Self; K], [Self; K]);
}

/// End of a kernel, by the bits of its numbers.
macro_rules! by_bits {
    ($number:ty, $bits:ty, $signed:ty) => {
        /// Sine and cosine of an angle from those of its remainder: odd quadrants exchange them, the second bit of n and of n + 1 is
        /// the sign.
        #[inline(always)]
        fn turned<const FEW: bool>(
            quadrant: $bits,
            (sine, cosine): ($number, $number),
        ) -> ($number, $number) {
            let (sine, cosine) = (sine.to_bits(), cosine.to_bits());
            let (first, second) = if FEW {
                let last = <$bits>::BITS - 1;
                let odd = (((quadrant << last) as $signed) >> last) as $bits;
                let exchanged = (sine ^ cosine) & odd;
                (sine ^ exchanged, cosine ^ exchanged)
            } else {
                let odd = quadrant & 1 == 1;
                if odd { (cosine, sine) } else { (sine, cosine) }
            };
            (signed(first, quadrant), signed(second, quadrant.wrapping_add(1)))
        }

        /// The number of the bits `value` with the sign that bit 1 of `quadrant` stands for.
        #[inline(always)]
        fn signed(value: $bits, quadrant: $bits) -> $number {
            <$number>::from_bits(value ^ ((quadrant & 2) << (<$bits>::BITS - 2)))
        }
    };
}

use by_bits;

/// Product and sum a b + c: fused, or each rounded.
trait Arithmetic<T> {
    /// `true` if the product is not rounded.
    const FUSED: bool;
    /// a b + c.
    fn multiply_add(a: T, b: T, c: T) -> T;
}

/// Product and sum, each rounded.
struct Separate;

impl<T: Mul<Output = T> + Add<Output = T>> Arithmetic<T> for Separate {
    const FUSED: bool = false;
    #[inline(always)]
    fn multiply_add(a: T, b: T, c: T) -> T {
        a * b + c
    }
}

/// The instruction of the target, which core does not offer; in tests on other targets a slow replacement.
#[cfg(any(test, all(feature = "fma", any(target_feature = "fma", target_arch = "aarch64"))))]
struct Fused;

#[cfg(any(test, all(feature = "fma", any(target_feature = "fma", target_arch = "aarch64"))))]
impl Arithmetic<f64> for Fused {
    const FUSED: bool = true;
    #[inline(always)]
    fn multiply_add(a: f64, b: f64, c: f64) -> f64 {
        extern crate std;
        f64::mul_add(a, b, c)
    }
}

#[cfg(any(test, all(feature = "fma", any(target_feature = "fma", target_arch = "aarch64"))))]
impl Arithmetic<f32> for Fused {
    const FUSED: bool = true;
    #[inline(always)]
    fn multiply_add(a: f32, b: f32, c: f32) -> f32 {
        extern crate std;
        f32::mul_add(a, b, c)
    }
}

#[cfg(all(feature = "fma", any(target_feature = "fma", target_arch = "aarch64")))]
type Best = Fused;
#[cfg(not(all(feature = "fma", any(target_feature = "fma", target_arch = "aarch64"))))]
type Best = Separate;

/// Sines and cosines of `angles` (rad): K each, within 0.8 units in the last place up to 1e5 rad; with fused operations
/// within 1.6 up to half a turn, and 1.8e-16 up to 1e5 rad.
///
/// Each component depends on its own angle alone. Beyond 1e5 rad, and for NaN and infinity, it is libm's; everywhere with the
/// feature `libm`.
#[inline(always)]
pub(crate) fn sin_cos<const K: usize>(angles: [f64; K]) -> ([f64; K], [f64; K]) {
    in_use::<f64, K, WIDE, NARROW>(angles)
}

/// As [`sin_cos`], in single precision: within 0.9 units in the last place. Up to 128 rad all operations are of single precision;
/// beyond, the values of double precision are rounded.
#[inline(always)]
pub(crate) fn sin_cos_single<const K: usize>(angles: [f32; K]) -> ([f32; K], [f32; K]) {
    in_use::<f32, K, WIDE_SINGLE, NARROW_SINGLE>(angles)
}

/// As [`sin_cos`], of K angles in L lanes each.
#[inline(always)]
pub(crate) fn sin_cos_of_lanes<const L: usize, const K: usize>(
    angles: [[f64; L]; K],
) -> ([[f64; L]; K], [[f64; L]; K]) {
    of_lanes(angles)
}

/// As [`sin_cos_single`], of K angles in L lanes each.
#[inline(always)]
pub(crate) fn sin_cos_of_lanes_single<const L: usize, const K: usize>(
    angles: [[f32; L]; K],
) -> ([[f32; L]; K], [[f32; L]; K]) {
    of_lanes(angles)
}

/// Sines and cosines as the features choose: the library's with `libm`, else the packed ones.
#[inline(always)]
fn in_use<T: Angle, const K: usize, const WIDE: usize, const NARROW: usize>(
    angles: [T; K],
) -> ([T; K], [T; K])
where
    Best: Arithmetic<T>,
{
    if cfg!(feature = "libm") { of_library(angles) } else { packed::<T, Best, K, WIDE, NARROW>(angles) }
}

/// One angle after the other.
#[inline(always)]
fn of_library<T: Angle, const K: usize>(angles: [T; K]) -> ([T; K], [T; K]) {
    let (mut sines, mut cosines) = (angles, angles);
    for ((sine, cosine), angle) in sines.iter_mut().zip(&mut cosines).zip(angles) {
        (*sine, *cosine) = angle.of_library();
    }
    (sines, cosines)
}

/// As many angles side by side as fill registers.
#[inline(always)]
fn packed<T: Angle, A: Arithmetic<T>, const K: usize, const WIDE: usize, const NARROW: usize>(
    angles: [T; K],
) -> ([T; K], [T; K]) {
    let (mut sines, mut cosines) = (angles, angles);
    let mut near = true;
    if K == 1 {
        // It has nothing to go beside it.
        near = reduce::<T, A, K, true>(&mut sines, &mut cosines, angles);
    } else {
        // No zipped chunks: their number is a division by their size, which cold callers keep apart with a path for zero.
        let mut start = 0;
        while start < K {
            let all = start..K.min(start + WIDE);
            let parts = (sines.get_mut(all.clone()), cosines.get_mut(all.clone()), angles.get(all));
            start += WIDE;
            let (Some(sines), Some(cosines), Some(angles)) = parts else { break };
            near &= if angles.len() <= NARROW {
                if K <= 2 {
                    padded::<T, A, NARROW, true>(sines, cosines, angles)
                } else {
                    padded::<T, A, NARROW, false>(sines, cosines, angles)
                }
            } else {
                padded::<T, A, WIDE, false>(sines, cosines, angles)
            };
        }
    }
    if !near {
        // Assigned, not returned: what a function returns is in memory, and the fast path would go through there too.
        let (replaced_sines, replaced_cosines) = replaced(angles, sines, cosines);
        (sines, cosines) = (replaced_sines, replaced_cosines);
    }
    (sines, cosines)
}

/// Sines and cosines of W angles side by side; with `true` if all are on the fast path.
#[inline(always)]
fn reduce<T: Angle, A: Arithmetic<T>, const W: usize, const FEW: bool>(
    sines: &mut [T; W],
    cosines: &mut [T; W],
    angles: [T; W],
) -> bool {
    let mut near = true;
    for ((sine, cosine), angle) in sines.iter_mut().zip(cosines).zip(angles) {
        (*sine, *cosine) = angle.sin_cos::<A, FEW>();
        near &= angle.is_near();
    }
    near
}

/// As [`reduce`], for at most W angles; zeros take the other places.
#[inline(always)]
fn padded<T: Angle, A: Arithmetic<T>, const W: usize, const FEW: bool>(
    sines: &mut [T],
    cosines: &mut [T],
    angles: &[T],
) -> bool {
    let mut pack = [T::default(); W];
    pack.iter_mut().zip(angles).for_each(|(place, angle)| *place = *angle);
    let (mut pack_sines, mut pack_cosines) = (pack, pack);
    let near = reduce::<T, A, W, FEW>(&mut pack_sines, &mut pack_cosines, pack);
    sines.iter_mut().zip(pack_sines).for_each(|(place, sine)| *place = sine);
    cosines.iter_mut().zip(pack_cosines).for_each(|(place, cosine)| *place = cosine);
    near
}

/// One loop over all lanes of all angles, which the compiler makes one of registers.
#[inline(always)]
fn of_lanes<T: Angle, const L: usize, const K: usize>(angles: [[T; L]; K]) -> ([[T; L]; K], [[T; L]; K])
where
    Best: Arithmetic<T>,
{
    let (mut sines, mut cosines) = ([[T::default(); L]; K], [[T::default(); L]; K]);
    let mut near = true;
    let places = sines.as_flattened_mut().iter_mut().zip(cosines.as_flattened_mut());
    for ((sine, cosine), angle) in places.zip(angles.as_flattened()) {
        if cfg!(feature = "libm") {
            (*sine, *cosine) = angle.of_library();
        } else {
            (*sine, *cosine) = angle.sin_cos::<Best, BY_BITS>();
            near &= angle.is_near();
        }
    }
    if !near {
        // As in `packed`.
        let (replaced_sines, replaced_cosines) = replaced_lanes(angles, sines, cosines);
        (sines, cosines) = (replaced_sines, replaced_cosines);
    }
    (sines, cosines)
}

/// Other values in place of those beyond the fast path.
#[cold]
#[inline(never)]
fn replaced<T: Angle, const K: usize>(angles: [T; K], sines: [T; K], cosines: [T; K]) -> ([T; K], [T; K]) {
    T::far(angles, (sines, cosines))
}

/// As [`replaced`], of K angles in L lanes each.
#[cold]
#[inline(never)]
fn replaced_lanes<T: Angle, const L: usize, const K: usize>(
    angles: [[T; L]; K],
    mut sines: [[T; L]; K],
    mut cosines: [[T; L]; K],
) -> ([[T; L]; K], [[T; L]; K]) {
    for ((sines, cosines), angles) in sines.iter_mut().zip(&mut cosines).zip(angles) {
        (*sines, *cosines) = replaced(angles, *sines, *cosines);
    }
    (sines, cosines)
}
