//! Lengths of the pieces of the homotopy: limited by movement, by the margin and by where a determinant is 0.

use crate::kinematics::homotopy::walk::{Spot, Walk};
use crate::kinematics::homotopy::{LARGEST_PIECE, leads};
use crate::mechanism::Kinematic;
use crate::scalar::number::Real;
use crate::tolerances::{positions, singular};

/// A piece over the one before. Drivers may come round again within a long one, and look as if they had not moved.
pub(super) const LARGEST_GROWTH: f64 = 4.0;

/// Largest movement of a piece whose end is moved, over the longest: a forecast is not proportional to its length.
const LARGEST_AIM: f64 = 0.9;

/// Largest movement in the reference metric of a piece that begins at this margin; twice that is still tried.
fn largest_movement<R: Real>(margin: R) -> R {
    R::constant(LARGEST_PIECE).min(margin.abs().sqrt())
}

/// Longest piece from a spot of this margin whose end may be moved, over one that moves by `first`.
pub(super) fn reach<R: Real>(margin: R, first: R) -> R {
    R::constant(2.0 * LARGEST_AIM) * largest_movement(margin) / first
}

/// `true` if the determinant changes its sign between two spots of which one is too far from its zero.
pub(super) fn is_far<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    at: &Spot<S, R, N, M>,
    next: &Spot<S, R, N, M>,
) -> bool {
    at.orientation != next.orientation && singular::PASSES.of::<R>() < at.margin.max(next.margin)
}

/// Fall of the margin in a piece, through 0 where the determinant changes its sign.
fn fall<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    at: &Spot<S, R, N, M>,
    next: &Spot<S, R, N, M>,
) -> R {
    if at.orientation != next.orientation { at.margin + next.margin } else { at.margin - next.margin }
}

/// Part of a piece from `at` to `next` after which to end behind the zero of the determinant that is in it, or follows.
pub(super) fn beyond<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    at: &Spot<S, R, N, M>,
    next: &Spot<S, R, N, M>,
) -> R {
    (at.margin + R::constant(0.5) * singular::PASSES.of::<R>()) / fall(at, next)
}

/// Part of a piece from `at` to `next` after which to end instead, if one of them is too far from the zero of the determinant, or
/// an end on the path so near that nothing leads on from there. The new end is next to that zero: before it if the piece begins
/// farther away, else after it.
pub(super) fn aimed<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    at: &Spot<S, R, N, M>,
    next: &Spot<S, R, N, M>,
    aims: u32,
) -> Option<R> {
    let next_to = R::constant(0.5) * singular::PASSES.of::<R>();
    let passage = at.orientation != next.orientation;
    let fall = fall(at, next);
    let near = next.share < R::constant(1.0)
        && !leads(next.margin + next.margin)
        && (passage || leads(at.margin + at.margin));
    if !(is_far(at, next) || near && R::constant(0.0) < fall) {
        return None;
    }
    // Where it does not end well behind, the next one begins nearer.
    let before = singular::PASSES.of::<R>() < at.margin || aims % 2 == 1 && leads(at.margin);
    let way = if before { at.margin - next_to } else { at.margin + next_to };
    let most = if before { R::constant(0.9) } else { R::constant(LARGEST_GROWTH) };
    Some((way / fall).min(most).max(R::constant(0.02)))
}

/// The length to try instead of `length` if a forecast moves by more than twice the limit of a piece; a `first` that is NaN is
/// too much.
pub(super) fn shortened<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    at: &Spot<S, R, N, M>,
    first: R,
    length: R,
) -> Option<R> {
    let most = largest_movement(at.margin);
    if first <= most + most {
        return None;
    }
    let (shorter, half) = (length * most / first, R::constant(0.5) * length);
    Some(if shorter <= half { shorter.max(length * R::constant(1e-3)) } else { half })
}

/// Length of the piece after one from `at` to `next`, which moved by `first`: limited by the margin and by `growth`.
pub(super) fn next_piece<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    at: &Spot<S, R, N, M>,
    next: &Spot<S, R, N, M>,
    first: R,
    length: R,
    growth: R,
) -> R {
    let most = largest_movement(next.margin);
    let piece = length * (most / first.max(positions::SHORTEST_PIECE.of())).min(growth);
    if next.orientation == at.orientation && next.margin < singular::PASSES.of() && next.margin < at.margin {
        // Next to where the determinant is 0 if its margin falls as it did: just beyond.
        let slope = (at.margin - next.margin) / length;
        return piece.min((next.margin + R::constant(0.5) * singular::PASSES.of()) / slope);
    }
    piece
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Walk<'_, '_, S, R, N, M> {
    /// Length of the first piece, from the slope over a short one.
    pub(super) fn first_piece(&mut self, at: &Spot<S, R, N, M>) -> R {
        self.evaluations = self.evaluations.saturating_add(1);
        let (slope, _) = self.slope(at, singular::BALANCE.of());
        let most = largest_movement(at.margin);
        let piece = most / self.size(&slope).max(most);
        if piece.is_finite() { piece } else { singular::BALANCE.of() }
    }
}
