//! Several numbers side by side: one emitted text, many mechanisms or many phases of one.

use core::array::from_fn;
use core::ops::Add;
use core::ops::BitAnd;
use core::ops::BitOr;
use core::ops::Div;
use core::ops::Mul;
use core::ops::Neg;
use core::ops::Not;
use core::ops::Sub;
use core::sync::atomic::Ordering;
use core::sync::atomic::compiler_fence;

use crate::scalar::number::{Real, Scalar};

/// Bytes of a vector register of the target.
pub(crate) const REGISTER: usize = if cfg!(target_feature = "avx512f") {
    64
} else if cfg!(target_feature = "avx") {
    32
} else {
    16
};

/// `L` numbers that take part in the same operations; the compiler turns them into vector registers.
///
/// They begin where a vector register of the target may begin, so that no register's worth of them lies in two cache lines.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_feature = "avx512f", repr(C, align(64)))]
#[cfg_attr(all(target_feature = "avx", not(target_feature = "avx512f")), repr(C, align(32)))]
#[cfg_attr(not(any(target_feature = "avx", target_feature = "avx512f")), repr(C, align(16)))]
pub struct Lanes<R, const L: usize>(pub [R; L]);

/// Zeros: inputs of a mechanism in lanes that are not set yet.
impl<R: Real, const L: usize> Default for Lanes<R, L> {
    #[inline]
    fn default() -> Self {
        Lanes([R::constant(0.0); L])
    }
}

/// One truth value a lane, in words as wide as the numbers: comparisons stay in vector registers until they are decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaneMask<R: Real, const L: usize>([R::Word; L]);

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
        self.each(|a| -a)
    }
}

macro_rules! connective {
    ($connective:ident, $method:ident) => {
        impl<R: Real, const L: usize> $connective for LaneMask<R, L> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let mut result = self;
                for (a, b) in result.0.iter_mut().zip(&other.0) {
                    *a = $connective::$method(*a, *b);
                }
                result
            }
        }
    };
}

connective!(BitAnd, bitand);
connective!(BitOr, bitor);

impl<R: Real, const L: usize> Not for LaneMask<R, L> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        let mut result = self;
        for word in &mut result.0 {
            *word = !*word;
        }
        result
    }
}

impl<R: Real, const L: usize> LaneMask<R, L> {
    /// One truth value a lane.
    #[inline(always)]
    pub fn new(truths: [bool; L]) -> Self {
        LaneMask(truths.map(word::<R>))
    }

    /// These with the one of lane `lane`, if there is such a lane.
    pub(crate) fn with(mut self, lane: usize, truth: bool) -> Self {
        if let Some(word) = self.0.get_mut(lane) {
            *word = self::word::<R>(truth);
        }
        self
    }
}

/// A truth value as a word.
#[inline(always)]
fn word<R: Real>(truth: bool) -> R::Word {
    if truth { !R::FALSE } else { R::FALSE }
}

impl<R: Real, const L: usize> Lanes<R, L> {
    #[inline(always)]
    fn each(self, operation: impl Fn(R) -> R) -> Self {
        let mut result = self;
        for number in &mut result.0 {
            *number = operation(*number);
        }
        result
    }
    #[inline(always)]
    fn zip(self, other: Self, operation: impl Fn(R, R) -> R) -> Self {
        let mut result = self;
        for (a, b) in result.0.iter_mut().zip(&other.0) {
            *a = operation(*a, *b);
        }
        result
    }
    #[inline(always)]
    fn test2(self, other: Self, predicate: impl Fn(R, R) -> bool) -> LaneMask<R, L> {
        let mut result = [R::FALSE; L];
        for ((truth, a), b) in result.iter_mut().zip(&self.0).zip(&other.0) {
            *truth = word::<R>(predicate(*a, *b));
        }
        LaneMask(result)
    }
}

/// `numbers` from place `first` on, of which there are fewer than lanes: the last one stands for the others.
#[cold]
#[inline(never)]
fn read_few<R: Real, const L: usize>(numbers: &[R], first: usize) -> Lanes<R, L> {
    let of = |lane: usize| numbers.get(first.saturating_add(lane)).or(numbers.last()).copied();
    Lanes(from_fn(|lane| of(lane).unwrap_or(R::constant(0.0))))
}

/// Writes those of `lanes` that have a place among `numbers` from place `first` on.
#[cold]
#[inline(never)]
fn write_few<R: Real>(lanes: &[R], numbers: &mut [R], first: usize) {
    numbers.iter_mut().skip(first).zip(lanes).for_each(|(place, number)| *place = *number);
}

/// Functions of the numbers of each lane, by `each` or `zip`.
macro_rules! lane_by_lane {
    ($by:ident, $($name:ident $(($other:ident))?),*) => {
        $(
            #[inline(always)]
            fn $name(self $(, $other: Self)?) -> Self {
                self.$by($($other,)? R::$name)
            }
        )*
    };
}

impl<R: Real, const L: usize> Scalar for Lanes<R, L> {
    type Real = R;
    type Mask = LaneMask<R, L>;
    type Lanes<X: Copy> = [X; L];
    const LANES: usize = L;

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
    fn part<P: Scalar<Real = R>>(self, first: usize) -> P {
        P::read(&self.0, first)
    }
    #[inline(always)]
    fn read(numbers: &[R], first: usize) -> Self {
        match numbers.get(first..).and_then(|rest| rest.first_chunk::<L>()) {
            Some(numbers) => Lanes(*numbers),
            None => read_few(numbers, first),
        }
    }
    #[inline(always)]
    fn write(self, numbers: &mut [R], first: usize) {
        match numbers.get_mut(first..).and_then(|rest| rest.first_chunk_mut::<L>()) {
            Some(numbers) => *numbers = self.0,
            None => write_few(&self.0, numbers, first),
        }
    }
    /// A loop over numbers of many lanes each looks to the compiler like one over numbers that lie far apart. It would
    /// gather one lane of several numbers into a register, and scatter the results. Nothing may be moved over this
    /// fence, which is no instruction, so each number's lanes are taken together.
    #[inline(always)]
    fn side_by_side() {
        compiler_fence(Ordering::AcqRel);
    }
    #[inline(always)]
    fn mask(value: bool) -> LaneMask<R, L> {
        LaneMask([word::<R>(value); L])
    }
    #[inline(always)]
    fn less(self, than: Self) -> LaneMask<R, L> {
        self.test2(than, |a, b| a < b)
    }
    #[inline(always)]
    fn is_finite(self) -> LaneMask<R, L> {
        self.test2(self, |number, _| number.is_finite())
    }
    #[inline(always)]
    fn all(mask: LaneMask<R, L>) -> bool {
        mask.0.iter().fold(true, |all, word| all & (*word != R::FALSE))
    }
    #[inline(always)]
    fn test(mask: LaneMask<R, L>, lane: usize) -> bool {
        mask.0.get(lane).or(mask.0.last()).copied().unwrap_or(R::FALSE) != R::FALSE
    }
    #[inline(always)]
    fn select(mask: LaneMask<R, L>, yes: Self, no: Self) -> Self {
        let mut result = no;
        for ((place, yes), word) in result.0.iter_mut().zip(&yes.0).zip(&mask.0) {
            // Both are read, so that the choice is between numbers and not between addresses.
            let (yes, no) = (*yes, *place);
            *place = if *word != R::FALSE { yes } else { no };
        }
        result
    }
    #[inline(always)]
    fn sin_cos<const K: usize>(angles: [Self; K]) -> ([Self; K], [Self; K]) {
        let zero = Lanes([R::constant(0.0); L]);
        let (mut sines, mut cosines, mut numbers) = ([zero; K], [zero; K], [zero.0; K]);
        for (numbers, angle) in numbers.iter_mut().zip(&angles) {
            *numbers = angle.0;
        }
        let (found_sines, found_cosines) = R::sin_cos_of_lanes(numbers);
        for ((sine, cosine), found) in
            sines.iter_mut().zip(&mut cosines).zip(found_sines.iter().zip(&found_cosines))
        {
            (sine.0, cosine.0) = (*found.0, *found.1);
        }
        (sines, cosines)
    }
    lane_by_lane!(each, abs, sqrt, exp, ln, tan, asin, acos, atan, sinh, cosh, tanh, asinh, acosh, atanh);
    lane_by_lane!(zip, atan2(x), powf(exponent));
    #[inline(always)]
    fn hypot(self, other: Self) -> Self {
        Lanes(R::hypot_of_lanes(self.0, other.0))
    }
}
