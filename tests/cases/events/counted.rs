//! A number of double precision that counts its operations.

use std::cell::Cell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use mbs_runtime::{Real, Scalar};

thread_local! {
    static OPERATIONS: Cell<u64> = const { Cell::new(0) };
}

/// Operations of what is done, in this thread.
pub fn operations<X>(work: impl FnOnce() -> X) -> (X, u64) {
    let before = OPERATIONS.get();
    let result = work();
    (result, OPERATIONS.get() - before)
}

#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Counted(pub f64);

fn count(value: f64) -> Counted {
    OPERATIONS.set(OPERATIONS.get() + 1);
    Counted(value)
}

impl Add for Counted {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        count(self.0 + other.0)
    }
}
impl Sub for Counted {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        count(self.0 - other.0)
    }
}
impl Mul for Counted {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        count(self.0 * other.0)
    }
}
impl Div for Counted {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        count(self.0 / other.0)
    }
}
impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        count(-self.0)
    }
}

macro_rules! functions {
    ($($name:ident),*) => {
        $(fn $name(self) -> Self {
            count(Scalar::$name(self.0))
        })*
    };
}

impl Scalar for Counted {
    type Real = Self;
    type Mask = bool;
    type Lanes<X: Copy> = [X; 1];

    fn constant(value: f64) -> Self {
        Counted(value)
    }
    fn splat(value: Self) -> Self {
        value
    }
    fn from_lanes(mut value: impl FnMut(usize) -> Self) -> Self {
        value(0)
    }
    fn lane(self, _: usize) -> Self {
        self
    }
    fn per_lane<X: Copy>(mut value: impl FnMut(usize) -> X) -> [X; 1] {
        [value(0)]
    }
    fn mask(value: bool) -> bool {
        value
    }
    fn less(self, than: Self) -> bool {
        count(self.0);
        self.0 < than.0
    }
    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
    fn all(mask: bool) -> bool {
        mask
    }
    fn test(mask: bool, _: usize) -> bool {
        mask
    }
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    fn sin_cos<const K: usize>(angles: [Self; K]) -> ([Self; K], [Self; K]) {
        (angles.map(|angle| count(angle.0.sin())), angles.map(|angle| count(angle.0.cos())))
    }
    functions!(sqrt, exp, ln, tan, asin, acos, atan, sinh, cosh, tanh, abs);
    fn atan2(self, x: Self) -> Self {
        count(self.0.atan2(x.0))
    }
    fn powf(self, exponent: Self) -> Self {
        count(self.0.powf(exponent.0))
    }
    fn hypot(self, other: Self) -> Self {
        count(self.0.hypot(other.0))
    }
}

impl Real for Counted {
    type Word = u64;
    const EPSILON: Self = Counted(f64::EPSILON);
    const FALSE: u64 = 0;
    fn to_f64(self) -> f64 {
        self.0
    }
}
