//! A number that counts what is done with it.

use core::cell::Cell;
use core::cmp::Ordering;
use core::ops::{Add, Div, Mul, Neg, Sub};

use mbs_runtime::{Operations, Real, Scalar};

thread_local! {
    static DONE: Cell<Operations> = const { Cell::new(Operations::NONE) };
}

/// The operations on [`Counted`] numbers that `work` does.
pub fn counted<X>(work: impl FnOnce() -> X) -> (X, Operations) {
    DONE.set(Operations::NONE);
    let result = work();
    (result, DONE.get())
}

fn done(operations: Operations) {
    DONE.set(DONE.get().and(operations));
}

fn select(count: u64) {
    done(Operations { selections: count, ..Operations::NONE });
}

fn compare() {
    done(Operations { comparisons: 1, ..Operations::NONE });
}

fn add(value: f64) -> Counted {
    done(Operations { additions: 1, ..Operations::NONE });
    Counted(value)
}

fn function(value: f64) -> Counted {
    done(Operations { functions: 1, ..Operations::NONE });
    Counted(value)
}

/// An `f64` of which every operation is counted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counted(pub f64);

impl PartialEq for Counted {
    fn eq(&self, other: &Self) -> bool {
        compare();
        self.0 == other.0
    }
}

impl PartialOrd for Counted {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        compare();
        self.0.partial_cmp(&other.0)
    }
}

impl Add for Counted {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        add(self.0 + other.0)
    }
}

impl Sub for Counted {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        add(self.0 - other.0)
    }
}

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        add(-self.0)
    }
}

impl Mul for Counted {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        done(Operations { multiplications: 1, ..Operations::NONE });
        Counted(self.0 * other.0)
    }
}

impl Div for Counted {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        done(Operations { divisions: 1, ..Operations::NONE });
        Counted(self.0 / other.0)
    }
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
        compare();
        self.0 < than.0
    }
    fn is_finite(self) -> bool {
        compare();
        self.0.is_finite()
    }
    fn all(mask: bool) -> bool {
        mask
    }
    fn test(mask: bool, _: usize) -> bool {
        mask
    }
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        select(1);
        if mask { yes } else { no }
    }
    fn sin_cos<const K: usize>(angles: [Self; K]) -> ([Self; K], [Self; K]) {
        done(Operations { sine_cosines: K as u64, ..Operations::NONE });
        let (sines, cosines) = <f64 as Scalar>::sin_cos(angles.map(|angle| angle.0));
        (sines.map(Counted), cosines.map(Counted))
    }
    fn sqrt(self) -> Self {
        function(self.0.sqrt())
    }
    fn exp(self) -> Self {
        function(self.0.exp())
    }
    fn ln(self) -> Self {
        function(self.0.ln())
    }
    fn tan(self) -> Self {
        function(self.0.tan())
    }
    fn asin(self) -> Self {
        function(self.0.asin())
    }
    fn acos(self) -> Self {
        function(self.0.acos())
    }
    fn atan(self) -> Self {
        function(self.0.atan())
    }
    fn atan2(self, x: Self) -> Self {
        function(self.0.atan2(x.0))
    }
    fn sinh(self) -> Self {
        function(self.0.sinh())
    }
    fn cosh(self) -> Self {
        function(self.0.cosh())
    }
    fn tanh(self) -> Self {
        function(self.0.tanh())
    }
    fn asinh(self) -> Self {
        function(self.0.asinh())
    }
    fn acosh(self) -> Self {
        function(self.0.acosh())
    }
    fn atanh(self) -> Self {
        function(self.0.atanh())
    }
    fn powf(self, exponent: Self) -> Self {
        function(self.0.powf(exponent.0))
    }
    fn hypot(self, other: Self) -> Self {
        function(self.0.hypot(other.0))
    }
    fn abs(self) -> Self {
        select(1);
        Counted(self.0.abs())
    }
    fn sign(self) -> Self {
        select(1);
        Counted(Scalar::sign(self.0))
    }
    fn min(self, other: Self) -> Self {
        select(1);
        Counted(Scalar::min(self.0, other.0))
    }
    fn max(self, other: Self) -> Self {
        select(1);
        Counted(Scalar::max(self.0, other.0))
    }
}

impl Real for Counted {
    type Word = u64;
    type Register = Self;

    const EPSILON: Self = Counted(f64::EPSILON);
    const FALSE: u64 = 0;
    fn to_f64(self) -> f64 {
        self.0
    }
}
