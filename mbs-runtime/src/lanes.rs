//! Several numbers side by side: one emitted text, many mechanisms or many phases of one.

use core::array::from_fn;
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use crate::{Real, Scalar};

/// `L` numbers that take part in the same operations; the compiler turns them into vector registers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct Lanes<R, const L: usize>(pub [R; L]);

/// One truth value a lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaneMask<const L: usize>(pub [bool; L]);

macro_rules! operation {
    ($operation:ident, $method:ident) => {
        impl<R: Real, const L: usize> $operation for Lanes<R, L> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| $operation::$method(a, b))
            }
        }
    };
}

operation!(Add, add);
operation!(Sub, sub);
operation!(Mul, mul);
operation!(Div, div);

impl<R: Real, const L: usize> Neg for Lanes<R, L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Lanes(self.0.map(|a| -a))
    }
}

impl<const L: usize> BitAnd for LaneMask<L> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        let mut both = self.0;
        both.iter_mut().zip(other.0).for_each(|(a, b)| *a &= b);
        LaneMask(both)
    }
}

impl<const L: usize> BitOr for LaneMask<L> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        let mut either = self.0;
        either.iter_mut().zip(other.0).for_each(|(a, b)| *a |= b);
        LaneMask(either)
    }
}

impl<const L: usize> Not for LaneMask<L> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        LaneMask(self.0.map(|a| !a))
    }
}

impl<R: Real, const L: usize> Lanes<R, L> {
    #[inline(always)]
    fn zip(self, other: Self, operation: impl Fn(R, R) -> R) -> Self {
        let mut result = self.0;
        result.iter_mut().zip(other.0).for_each(|(a, b)| *a = operation(*a, b));
        Lanes(result)
    }
    #[inline(always)]
    fn test2(self, other: Self, predicate: impl Fn(R, R) -> bool) -> LaneMask<L> {
        let mut result = [false; L];
        result.iter_mut().zip(self.0.into_iter().zip(other.0)).for_each(|(m, (a, b))| *m = predicate(a, b));
        LaneMask(result)
    }
}

impl<R: Real, const L: usize> Scalar for Lanes<R, L> {
    type Real = R;
    type Mask = LaneMask<L>;
    type Lanes<X: Copy> = [X; L];

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Lanes([R::constant(value); L])
    }
    #[inline(always)]
    fn splat(value: R) -> Self {
        Lanes([value; L])
    }
    #[inline(always)]
    fn from_lanes(value: impl FnMut(usize) -> R) -> Self {
        Lanes(from_fn(value))
    }
    #[inline(always)]
    fn lane(self, lane: usize) -> R {
        self.0.get(lane).or(self.0.last()).copied().unwrap_or(R::constant(0.0))
    }
    #[inline(always)]
    fn per_lane<X: Copy>(value: impl FnMut(usize) -> X) -> [X; L] {
        from_fn(value)
    }
    #[inline(always)]
    fn mask(value: bool) -> LaneMask<L> {
        LaneMask([value; L])
    }
    #[inline(always)]
    fn less(self, than: Self) -> LaneMask<L> {
        self.test2(than, |a, b| a < b)
    }
    #[inline(always)]
    fn is_finite(self) -> LaneMask<L> {
        LaneMask(self.0.map(Scalar::is_finite))
    }
    #[inline(always)]
    fn all(mask: LaneMask<L>) -> bool {
        mask.0.into_iter().fold(true, |all, lane| all & lane)
    }
    #[inline(always)]
    fn test(mask: LaneMask<L>, lane: usize) -> bool {
        mask.0.get(lane).or(mask.0.last()).copied().unwrap_or(false)
    }
    #[inline(always)]
    fn select(mask: LaneMask<L>, yes: Self, no: Self) -> Self {
        let mut result = no.0;
        result.iter_mut().zip(yes.0).zip(mask.0).for_each(|((r, y), m)| *r = if m { y } else { *r });
        Lanes(result)
    }
    #[inline(always)]
    fn sin_cos<const K: usize>(angles: [Self; K]) -> ([Self; K], [Self; K]) {
        let (mut sines, mut cosines) = (angles, angles);
        for ((sine, cosine), angle) in sines.iter_mut().zip(&mut cosines).zip(angles) {
            (sine.0, cosine.0) = R::sin_cos(angle.0);
        }
        (sines, cosines)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Lanes(self.0.map(R::sqrt))
    }
    #[inline(always)]
    fn exp(self) -> Self {
        Lanes(self.0.map(R::exp))
    }
    #[inline(always)]
    fn ln(self) -> Self {
        Lanes(self.0.map(R::ln))
    }
    #[inline(always)]
    fn tan(self) -> Self {
        Lanes(self.0.map(R::tan))
    }
    #[inline(always)]
    fn asin(self) -> Self {
        Lanes(self.0.map(R::asin))
    }
    #[inline(always)]
    fn acos(self) -> Self {
        Lanes(self.0.map(R::acos))
    }
    #[inline(always)]
    fn atan(self) -> Self {
        Lanes(self.0.map(R::atan))
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        self.zip(x, R::atan2)
    }
    #[inline(always)]
    fn sinh(self) -> Self {
        Lanes(self.0.map(R::sinh))
    }
    #[inline(always)]
    fn cosh(self) -> Self {
        Lanes(self.0.map(R::cosh))
    }
    #[inline(always)]
    fn tanh(self) -> Self {
        Lanes(self.0.map(R::tanh))
    }
    #[inline(always)]
    fn powf(self, exponent: Self) -> Self {
        self.zip(exponent, R::powf)
    }
    #[inline(always)]
    fn hypot(self, other: Self) -> Self {
        self.zip(other, R::hypot)
    }
}
