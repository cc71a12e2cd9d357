//! The numbers that emitted code computes with: `f32`, `f64`, [lanes](crate::Lanes), your own.

use core::fmt::Debug;
use core::ops::Add;
use core::ops::BitAnd;
use core::ops::BitOr;
use core::ops::Div;
use core::ops::Mul;
use core::ops::Neg;
use core::ops::Not;
use core::ops::Sub;

use crate::scalar::lanes::{Lanes, REGISTER};
use crate::scalar::lengths;
use crate::scalar::trigonometry;

/// A number as emitted code sees it; open to implementations outside this crate.
///
/// Deliberately not `PartialOrd`: comparing gives a mask and branching is [`select`](Scalar::select), so
/// that one text serves a single number and many lanes alike. Decisions are taken lane by lane on
/// [`Real`](Scalar::Real).
pub trait Scalar:
    Copy
    + Debug
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The number in one lane.
    type Real: Real;
    /// One truth value a lane.
    type Mask: Copy
        + Debug
        + BitAnd<Output = Self::Mask>
        + BitOr<Output = Self::Mask>
        + Not<Output = Self::Mask>;
    /// One `X` a lane.
    type Lanes<X: Copy>: AsRef<[X]> + Copy;
    /// Number of lanes.
    const LANES: usize = 1;

    /// The same number in every lane, rounded from `f64`.
    fn constant(value: f64) -> Self;
    /// The same number in every lane.
    fn splat(value: Self::Real) -> Self;
    /// One number a lane.
    fn from_lanes(value: impl FnMut(usize) -> Self::Real) -> Self;
    /// The number in lane `lane`; of the last lane where there are fewer.
    fn lane(self, lane: usize) -> Self::Real;
    /// One `X` a lane, made in the order of the lanes.
    fn per_lane<X: Copy>(value: impl FnMut(usize) -> X) -> Self::Lanes<X>;

    /// The numbers of as many lanes as `P` has, from lane `first` on.
    #[inline(always)]
    fn part<P: Scalar<Real = Self::Real>>(self, first: usize) -> P {
        P::from_lanes(|lane| self.lane(first.saturating_add(lane)))
    }
    /// `numbers` from place `first` on, one a lane; the last one where there are fewer, 0 where there is none.
    #[inline(always)]
    fn read(numbers: &[Self::Real], first: usize) -> Self {
        let of = |lane: usize| numbers.get(first.saturating_add(lane)).or(numbers.last()).copied();
        Self::from_lanes(|lane| of(lane).unwrap_or(Self::Real::constant(0.0)))
    }
    /// Writes the number of each lane to `numbers`, from place `first` on; those that have no place are left out.
    #[inline(always)]
    fn write(self, numbers: &mut [Self::Real], first: usize) {
        for (lane, place) in numbers.iter_mut().skip(first).take(Self::LANES).enumerate() {
            *place = self.lane(lane);
        }
    }

    /// Fence after a number in a loop over many: nothing here, while lanes keep the compiler from taking the numbers apart.
    #[inline(always)]
    fn side_by_side() {}

    /// The same truth in every lane.
    fn mask(value: bool) -> Self::Mask;
    /// `self < than`, false where either is NaN.
    fn less(self, than: Self) -> Self::Mask;
    /// Neither NaN nor infinite.
    fn is_finite(self) -> Self::Mask;
    /// True in every lane.
    fn all(mask: Self::Mask) -> bool;
    /// True in lane `lane`; of the last lane where there are fewer.
    fn test(mask: Self::Mask, lane: usize) -> bool;
    /// `yes` where the mask is true, `no` elsewhere; the other side may be anything, NaN included.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Sines and cosines of angles (rad) that are known together.
    fn sin_cos<const K: usize>(angles: [Self; K]) -> ([Self; K], [Self; K]);
    /// As [`sin_cos`](Scalar::sin_cos), to the same bits, compiled once for all callers: for long code.
    #[inline(never)]
    fn sin_cos_called<const K: usize>(angles: [Self; K]) -> ([Self; K], [Self; K]) {
        Self::sin_cos(angles)
    }
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// e to the power of `self`.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Tangent of an angle (rad).
    fn tan(self) -> Self;
    /// Arc sine (rad).
    fn asin(self) -> Self;
    /// Arc cosine (rad).
    fn acos(self) -> Self;
    /// Arc tangent (rad).
    fn atan(self) -> Self;
    /// Angle (rad) of the point `(x, self)` in (−π, π].
    fn atan2(self, x: Self) -> Self;
    /// Hyperbolic sine.
    fn sinh(self) -> Self;
    /// Hyperbolic cosine.
    fn cosh(self) -> Self;
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
    /// Inverse hyperbolic sine.
    fn asinh(self) -> Self;
    /// Inverse hyperbolic cosine, not negative; NaN below 1.
    fn acosh(self) -> Self;
    /// Inverse hyperbolic tangent; NaN outside of [−1, 1].
    fn atanh(self) -> Self;
    /// `self` to the power of `exponent`.
    fn powf(self, exponent: Self) -> Self;
    /// `√(self² + other²)` without undue overflow.
    fn hypot(self, other: Self) -> Self;

    /// Absolute value.
    #[inline(always)]
    fn abs(self) -> Self {
        Self::select(self.less(Self::constant(0.0)), -self, self)
    }
    /// −1, 0 or 1; NaN stays.
    #[inline(always)]
    fn sign(self) -> Self {
        let zero = Self::constant(0.0);
        Self::select(
            self.less(zero),
            Self::constant(-1.0),
            Self::select(zero.less(self), Self::constant(1.0), self),
        )
    }
    /// The smaller one; `other` at a tie.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.less(other), self, other)
    }
    /// The larger one; `self` at a tie.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(self.less(other), other, self)
    }
}

/// A single number, on which decisions are taken: `f32` or `f64`.
pub trait Real: Scalar<Real = Self, Mask = bool> + PartialOrd {
    /// A truth value as wide as the number, so that those of several lanes share a vector register: no bit set, or all.
    type Word: Copy
        + Debug
        + Eq
        + BitAnd<Output = Self::Word>
        + BitOr<Output = Self::Word>
        + Not<Output = Self::Word>;
    /// As many such numbers as fill a vector register of the target, or the number itself where registers are of no use.
    type Register: Scalar<Real = Self>;

    /// Distance from 1 to the next number.
    const EPSILON: Self;
    /// No bit set.
    const FALSE: Self::Word;
    /// The same value, for reports.
    fn to_f64(self) -> f64;
    /// As [`hypot`](Scalar::hypot), to the same bits, of L lanes.
    #[inline(always)]
    fn hypot_of_lanes<const L: usize>(x: [Self; L], y: [Self; L]) -> [Self; L] {
        lengths::each(x, y)
    }
    /// As [`sin_cos`](Scalar::sin_cos), of K angles in L lanes each.
    #[inline(always)]
    fn sin_cos_of_lanes<const L: usize, const K: usize>(
        angles: [[Self; L]; K],
    ) -> ([[Self; L]; K], [[Self; L]; K]) {
        let (mut sines, mut cosines) = (angles, angles);
        for ((sines, cosines), angles) in sines.iter_mut().zip(&mut cosines).zip(angles) {
            (*sines, *cosines) = Self::sin_cos(angles);
        }
        (sines, cosines)
    }
}

/// A floating-point type: the bits of a truth value, sines and cosines, and functions of the library `libm`.
macro_rules! real {
    ($real:ident, $word:ident, $sincos:path, $lanes:path, $hypot:path, $hypots:path, $atan2:path, { $($name:ident($($other:ident)?) = $function:ident,)* }) => {
        impl Scalar for $real {
            type Real = $real;
            type Mask = bool;
            type Lanes<X: Copy> = [X; 1];

            #[inline(always)]
            fn constant(value: f64) -> Self {
                value as $real
            }
            #[inline(always)]
            fn splat(value: $real) -> Self {
                value
            }
            #[inline(always)]
            fn from_lanes(mut value: impl FnMut(usize) -> $real) -> Self {
                value(0)
            }
            #[inline(always)]
            fn lane(self, _: usize) -> $real {
                self
            }
            #[inline(always)]
            fn per_lane<X: Copy>(mut value: impl FnMut(usize) -> X) -> [X; 1] {
                [value(0)]
            }
            #[inline(always)]
            fn mask(value: bool) -> bool {
                value
            }
            #[inline(always)]
            fn less(self, than: Self) -> bool {
                self < than
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                // As numbers: the standard library's test goes through the bits, out of the registers that the values are in.
                <$real>::abs(self) <= $real::MAX
            }
            #[inline(always)]
            fn all(mask: bool) -> bool {
                mask
            }
            #[inline(always)]
            fn test(mask: bool, _: usize) -> bool {
                mask
            }
            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
            #[inline(always)]
            fn sin_cos<const K: usize>(angles: [Self; K]) -> ([Self; K], [Self; K]) {
                $sincos(angles)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$real>::abs(self)
            }
            #[inline(always)]
            fn hypot(self, other: Self) -> Self {
                $hypot(self, other)
            }
            #[inline(always)]
            fn atan2(self, x: Self) -> Self {
                $atan2(self, x)
            }
            $(
                #[inline(always)]
                fn $name(self $(, $other: Self)?) -> Self {
                    libm::$function(self $(, $other)?)
                }
            )*
        }

        impl Real for $real {
            type Word = $word;
            type Register = Lanes<$real, { REGISTER / size_of::<$real>() }>;

            const EPSILON: Self = $real::EPSILON;
            const FALSE: $word = 0;
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn hypot_of_lanes<const L: usize>(x: [Self; L], y: [Self; L]) -> [Self; L] {
                $hypots(x, y)
            }
            #[inline(always)]
            fn sin_cos_of_lanes<const L: usize, const K: usize>(
                angles: [[Self; L]; K],
            ) -> ([[Self; L]; K], [[Self; L]; K]) {
                $lanes(angles)
            }
        }
    };
}

real!(f64, u64, trigonometry::sin_cos, trigonometry::sin_cos_of_lanes, lengths::hypot, lengths::hypot_of_lanes, trigonometry::atan2, {
    sqrt() = sqrt, exp() = exp, ln() = log, tan() = tan, asin() = asin, acos() = acos,
    atan() = atan, sinh() = sinh, cosh() = cosh, tanh() = tanh, asinh() = asinh,
    acosh() = acosh, atanh() = atanh, powf(exponent) = pow,
});
real!(f32, u32, trigonometry::sin_cos_single, trigonometry::sin_cos_of_lanes_single, libm::hypotf, lengths::each, libm::atan2f, {
    sqrt() = sqrtf, exp() = expf, ln() = logf, tan() = tanf, asin() = asinf, acos() = acosf,
    atan() = atanf, sinh() = sinhf, cosh() = coshf, tanh() = tanhf,
    asinh() = asinhf, acosh() = acoshf, atanh() = atanhf, powf(exponent) = powf,
});

/// An index that a number carries, of lane `lane`; the cast saturates.
#[inline(always)]
pub(crate) fn index<T: Scalar>(number: T, lane: usize) -> u16 {
    number.lane(lane).to_f64() as u16
}
