//! Where a function of the solution passes zero within a step.

use super::adaptive::{Accepted, Polynomial};
use super::embedded::Embedded;
use super::vector::Vector;
use crate::Real;

/// Parts of a step in which a change of sign is looked for: two passages in one part cancel and are not seen.
const PARTS: u32 = 8;

/// Halvings are at most this many: more than the digits of an `f64`.
const MOST_ITERATIONS: u32 = 80;

/// Which passages through zero count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// Both.
    #[default]
    Any,
    /// From negative to positive.
    Rising,
    /// From positive to negative.
    Falling,
}

impl Direction {
    /// Whether a change from `before` to `after` counts. A value of 0 before has been passed already.
    fn counts<R: Real>(self, before: R, after: R) -> bool {
        let zero = R::constant(0.0);
        let rising = before < zero && zero <= after;
        let falling = zero < before && after <= zero;
        match self {
            Direction::Any => rising || falling,
            Direction::Rising => rising,
            Direction::Falling => falling,
        }
    }
}

/// The time (s) of the first passage of `function` through zero within a step; `None` where there is none.
///
/// Bracketed on the polynomial, then by the Illinois variant of the secant rule, which never leaves the bracket. The
/// time returned is the end of the bracket where the sign has changed.
/// Source: Dowell & Jarratt 1971.
pub fn passage<M: Embedded, R: Real, Y: Vector<R>>(
    step: &Accepted<M, R, Y>,
    polynomial: &Polynomial<M, R, Y>,
    direction: Direction,
    mut function: impl FnMut(R, &Y) -> R,
) -> Option<R> {
    let (start, end) = (&step.start, &step.end);
    let mut left = (start.t, function(start.t, &start.y));
    for part in 1..=PARTS {
        let right = if part == PARTS {
            (end.t, function(end.t, &end.y))
        } else {
            let t = start.t + (end.t - start.t) * R::constant(f64::from(part) / f64::from(PARTS));
            (t, function(t, &polynomial.at(t)))
        };
        if direction.counts(left.1, right.1) {
            return Some(root(left, right, |t| function(t, &polynomial.at(t))));
        }
        left = right;
    }
    None
}

/// The far side of the passage between `left` and `right`, each a time and a value.
fn root<R: Real>(mut left: (R, R), mut right: (R, R), mut function: impl FnMut(R) -> R) -> R {
    let (zero, half) = (R::constant(0.0), R::constant(0.5));
    let rising = left.1 < zero;
    let mut last_passed = None;
    for iteration in 0..MOST_ITERATIONS {
        let width = right.0 - left.0;
        let resolution = R::EPSILON * (left.0.abs() + right.0.abs());
        if width <= resolution || right.1 == zero {
            break;
        }
        let secant = left.0 - left.1 * width / (right.1 - left.1);
        let inside = left.0 < secant && secant < right.0 && iteration % 4 != 3;
        let t = if inside { secant } else { left.0 + half * width };
        let value = function(t);
        let passed = if rising { zero <= value } else { value <= zero };
        if passed {
            right = (t, value);
            left.1 = if last_passed == Some(true) { half * left.1 } else { left.1 };
        } else {
            left = (t, value);
            right.1 = if last_passed == Some(false) { half * right.1 } else { right.1 };
        }
        last_passed = Some(passed);
    }
    right.0
}
