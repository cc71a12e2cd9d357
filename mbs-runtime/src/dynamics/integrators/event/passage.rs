//! The first passage of a polynomial through zero, isolated by halving its Bernstein coefficients: no value of the function is needed.
//!
//! Source: Lane & Riesenfeld 1981, BIT 21, 112 (bounds and subdivision).

use crate::dynamics::integrators::event::interpolant::NODES;
use crate::scalar::number::Real;

/// Halvings of a part at most.
const DEPTH: usize = 12;

/// Parts that are looked at: a passage takes less than twenty.
const MOST_PARTS: u32 = 64;

/// Steps of the secant rule and of halving within a part that the polynomial falls in.
const MOST_STEPS: u32 = 24;

/// Bernstein coefficients.
type Coefficients<R> = [R; NODES];

/// Verdict of a polynomial on a function that is at most `off` away from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Passage<R> {
    /// It stays on its side.
    None,
    /// It passes zero once between both shares of the part, first of all, and about at the share in the middle.
    Between(R, R, R),
    /// Both are open.
    Unknown,
}

/// A polynomial between two shares of a part.
#[derive(Clone, Copy)]
struct Stretch<R> {
    from: R,
    to: R,
    coefficients: Coefficients<R>,
}

impl<R: Real> Stretch<R> {
    fn halves(&self) -> (Self, Self) {
        let (left, right) = halves(&self.coefficients);
        let middle = R::constant(0.5) * (self.from + self.to);
        (
            Stretch { to: middle, coefficients: left, ..*self },
            Stretch { from: middle, coefficients: right, ..*self },
        )
    }
}

/// The first passage of a polynomial that begins positive. `at_zero`: its beginning is zero but for rounding, and counts for nothing.
pub fn first<R: Real>(coefficients: Coefficients<R>, off: R, at_zero: bool) -> Passage<R> {
    let (zero, one) = (R::constant(0.0), R::constant(1.0));
    let mut now = Stretch { from: zero, to: one, coefficients };
    let mut later = [now; DEPTH];
    let mut depth = 0;
    for _ in 0..MOST_PARTS {
        let skipped = usize::from(at_zero && now.from == zero);
        let mut counted = now.coefficients.iter().skip(skipped);
        if counted.all(|coefficient| off < *coefficient) {
            if depth == 0 {
                return Passage::None;
            }
            depth -= 1;
            let Some(next) = later.get(depth) else { return Passage::Unknown };
            now = *next;
        } else if passes_once(&now.coefficients, off) {
            let middle = now.from + (now.to - now.from) * root(&now.coefficients, off);
            return Passage::Between(now.from, middle, now.to);
        } else {
            let (left, right) = now.halves();
            let Some(place) = later.get_mut(depth) else { return Passage::Unknown };
            *place = right;
            depth += 1;
            now = left;
        }
    }
    Passage::Unknown
}

/// `true` if the polynomial falls throughout, from above `off` to below −`off`.
fn passes_once<R: Real>(coefficients: &Coefficients<R>, off: R) -> bool {
    let [first, .., last] = coefficients;
    let falls = coefficients.iter().zip(coefficients.iter().skip(1)).all(|(one, next)| *next < *one);
    falls && off < *first && off < -*last
}

/// The polynomials of both halves: de Casteljau's scheme.
fn halves<R: Real>(coefficients: &Coefficients<R>) -> (Coefficients<R>, Coefficients<R>) {
    let half = R::constant(0.5);
    let (mut left, mut row) = (*coefficients, *coefficients);
    for (index, place) in left.iter_mut().enumerate() {
        let [first, ..] = row;
        *place = first;
        let next = row;
        let pairs = row.iter_mut().zip(next.iter().skip(1)).take(NODES - 1 - index);
        pairs.for_each(|(one, other)| *one = half * (*one + *other));
    }
    (left, row)
}

/// Share at which a polynomial that falls through zero is zero, to `off`.
fn root<R: Real>(coefficients: &Coefficients<R>, off: R) -> R {
    let (zero, one, half) = (R::constant(0.0), R::constant(1.0), R::constant(0.5));
    let [first, .., last] = *coefficients;
    let (mut left, mut right) = ((zero, first), (one, last));
    for step in 0..MOST_STEPS {
        let secant = left.0 + (right.0 - left.0) * left.1 / (left.1 - right.1);
        let share = if step % 3 == 2 { half * (left.0 + right.0) } else { secant };
        let value = value(coefficients, share);
        if value.abs() <= off {
            return share;
        }
        if zero < value { left = (share, value) } else { right = (share, value) }
    }
    left.0 + (right.0 - left.0) * left.1 / (left.1 - right.1)
}

/// Value of the polynomial at a share of its part.
fn value<R: Real>(coefficients: &Coefficients<R>, share: R) -> R {
    let left = R::constant(1.0) - share;
    let mut row = *coefficients;
    for order in 1..NODES {
        let next = row;
        let pairs = row.iter_mut().zip(next.iter().skip(1)).take(NODES - order);
        pairs.for_each(|(one, other)| *one = left * *one + share * *other);
    }
    let [first, ..] = row;
    first
}
