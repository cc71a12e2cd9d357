//! Homotopy in time, inputs and parameters from the last regular position, in pieces so small that they keep the assembly.

mod corrector;
mod discontinuity;
mod predictor;
mod response;
mod step_length;
mod walk;

use core::f64::consts::TAU;

use crate::kinematics::homotopy::walk::Walk;
use crate::mechanism::Kinematic;
use crate::scalar::number::{Real, Scalar};
use crate::tolerances::singular;

/// Largest second-order term of a prediction (rad, or reference lengths) from which a step is certain in one piece.
///
/// The third-order term, by which the prediction is off, is less than a tenth of it where coordinates move by some tenths:
/// far less than a quarter of any margin outside the singular zone.
pub(crate) const LARGEST_SECOND_ORDER_TERM: f64 = 0.01;

/// Largest way from a point to the solution that it leads to, in the reference metric, over the margin there.
///
/// By Kantorovich's theorem a Newton step η converges where β κ η ≤ 1/2, and to a point not farther than 2η. Links turn
/// with curvature κ ≤ 1 in the metric and the inverse β is about 2/margin, so that a quarter is the limit: the point is
/// nearer to the solution that it leads to than to where the assemblies meet.
pub(crate) const LARGEST_APPROACH: f64 = 0.25;

/// Largest movement of a coordinate in a piece (rad, or reference lengths): its third-order term is below 1e-2.
pub(crate) const LARGEST_PIECE: f64 = 0.35;

/// Largest second-order term of a piece over the margin at its end.
const LARGEST_BEND: f64 = 0.5;

/// Evaluations before the way is given up: a turn takes some twenty pieces of four, a singular position six. Past a place of margin μ where
/// two assemblies do not meet a coordinate turns by half a turn, by ∛μ a piece: a thousand at 1e-6, and as many that are shortened.
pub(crate) const EVALUATIONS: u32 = 30_000;

/// Those of one piece: where the way begins, how long the piece is, its forecast (two), a correction and its end.
pub(crate) const LEAST_EVALUATIONS: u32 = 6;

/// Part of a way over which its tangent is taken.
const TANGENT: f64 = 0.25;

/// `true` if a position of such a margin leads to the next one. Every change of inputs asks: products take the place of roots, and no
/// margin is below 0.
#[inline(always)]
pub(crate) fn leads<R: Real>(margin: R) -> bool {
    let square = margin * margin;
    singular::LEADS_TO_THE_FOURTH.of::<R>() <= square * square
}

/// `true` if a point at `distance` (in the reference metric) from a solution of `margin` leads to that solution for certain.
#[inline(always)]
pub(crate) fn is_near<R: Real>(distance: R, margin: R) -> bool {
    distance <= R::constant(LARGEST_APPROACH) * margin
}

/// The largest difference of those values that `angles` are the indices of.
#[inline(always)]
pub(crate) fn largest_change<T: Scalar, V: AsRef<[T]>>(angles: &[u16], old: &V, new: &V) -> T {
    let (old, new) = (old.as_ref(), new.as_ref());
    let pairs =
        angles.iter().filter_map(|index| old.get(usize::from(*index)).zip(new.get(usize::from(*index))));
    pairs.fold(T::constant(0.0), |largest, (old, new)| (*new - *old).abs().max(largest))
}

/// `true` if one of those values that `indices` name is another one in a lane, bit for bit: where a change is seen not to touch them,
/// the compiler compares nothing.
#[inline(always)]
pub(crate) fn differ<T: Scalar>(indices: &[u16], old: &[T], new: &[T], lane: usize) -> bool {
    let bits = |value: &T| value.lane(lane).to_f64().to_bits();
    let pairs =
        indices.iter().filter_map(|index| old.get(usize::from(*index)).zip(new.get(usize::from(*index))));
    pairs.fold(false, |any, (old, new)| any | (bits(old) != bits(new)))
}

/// Puts those `kept` values that `turning` are the indices of on by as many whole turns as the short way from `before` to `now` goes
/// round: the way of their numbers is then the short one. A value before that is no number counts as the kept one.
pub(crate) fn put_short_way_round<R: Real>(turning: &[u16], kept: &mut [R], before: &[R], now: &[R]) {
    for index in turning.iter().map(|index| usize::from(*index)) {
        let (Some(kept), Some(before), Some(now)) = (kept.get_mut(index), before.get(index), now.get(index))
        else {
            continue;
        };
        let [old, from, to] = [*kept, *before, *now].map(R::to_f64);
        let from = if from.is_finite() { from } else { old };
        let turns = libm::rint((to - from) / TAU);
        if turns.is_finite() && turns != 0.0 {
            *kept = R::constant(old + turns * TAU);
        }
    }
}

/// Margin of a position, and the signs of its determinants.
#[derive(Clone, Copy)]
struct Turned<R> {
    margin: R,
    orientation: u64,
}

/// A position as one before it foresees it.
pub(crate) struct Prediction<R, const N: usize> {
    pub q: [R; N],
    /// Movement by the first-order term, in the reference metric.
    pub first: R,
    /// The second-order term.
    pub second: R,
}

impl<R: Real, const N: usize> Prediction<R, N> {
    /// `true` if a solution of `margin` near the prediction can be in no other assembly.
    pub fn is_certain(&self, margin: R) -> bool {
        let most = R::constant(2.0 * LARGEST_PIECE);
        self.first <= most && self.second <= R::constant(LARGEST_BEND) * margin
    }
}

/// A position with all that it belongs to: time, parameters, inputs and phases.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Anchor<V, R, const N: usize> {
    /// Time (s).
    pub t: R,
    pub q: [R; N],
    /// Values of parameters, inputs and phases.
    pub values: V,
}

/// Homotopy from a regular position to time and inputs of the one that is sought.
pub(crate) struct Homotopy<'a, S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> {
    pub from: &'a Anchor<S::Values, R, N>,
    /// Its values change as the path is followed, and are those of the end before and afterwards.
    pub mechanism: &'a mut S,
    /// Values of the position that is sought.
    pub values: S::Values,
    /// Time (s) at the end.
    pub t: R,
}

/// End of a path as far as it was followed.
pub(crate) struct Followed<R, const N: usize> {
    /// The last position: the end where `share` is 1.
    pub q: [R; N],
    /// Part of the path.
    pub share: R,
    /// Margin there.
    pub margin: R,
    /// Evaluations of rows and Jacobian.
    pub evaluations: u32,
    /// The row that jumps beyond it, if one does.
    pub jump: Option<u16>,
    /// `true` if the evaluations ended before the path did.
    pub spent: bool,
    /// The last position from which the next one can be predicted.
    pub leading: Leading<R, N>,
}

/// A position from which a path may be continued.
#[derive(Clone, Copy)]
pub(crate) struct Leading<R, const N: usize> {
    pub q: [R; N],
    /// Part of the way.
    pub share: R,
    /// Part of the rest to try next.
    pub piece: R,
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Homotopy<'_, S, R, N, M> {
    /// Follows the path for at most `limit` evaluations; its first piece has at most the length `piece`.
    ///
    /// Solves Φ(q, θ(σ), p(σ), phases(σ), t(σ)) = (1 − σ) Φ(q₀, σ = 0) from σ = 0 to 1. Parameters, inputs, phases and time go
    /// straight from their values at q₀ to the present ones. The right-hand side is rounding, unless the caller has replaced a
    /// function. Source of the method: Allgower & Georg 2003, Introduction to Numerical Continuation Methods, ch. 2 and 6.
    ///
    /// A piece counts if it ends so near to its prediction, and with such a slope, that it can be no other assembly;
    /// else it is shortened. A determinant may change its sign only in a piece that begins and ends next to its zero. So two
    /// assemblies that do not meet there are told from two that do.
    #[cold]
    #[inline(never)]
    pub fn followed(&mut self, piece: R, limit: u32) -> Followed<R, N> {
        let (values, start) = (self.values, self.from.q);
        let mut walk = Walk { way: self, open: [R::constant(0.0); M], evaluations: 0, limit };
        let station = walk.station(R::constant(0.0));
        walk.open = walk.residuals(&station, &start);
        let followed = walk.followed(start, piece);
        self.mechanism.set_values(values);
        followed
    }

    /// Tangent of the path at its start: movement of the coordinates over the whole path at that rate.
    pub fn tangent(&mut self) -> [R; N] {
        let (values, start) = (self.values, self.from.q);
        let mut walk = Walk { way: self, open: [R::constant(0.0); M], evaluations: 0, limit: 0 };
        let station = walk.station(R::constant(0.0));
        walk.open = walk.residuals(&station, &start);
        let at = walk.spot(start, R::constant(0.0));
        let (slope, _) = walk.slope(&at, R::constant(TANGENT));
        self.mechanism.set_values(values);
        slope
    }

    /// Values and time (s) at a `share` of the way.
    pub fn place(&self, share: R) -> (S::Values, R) {
        let mut values = self.values;
        if R::constant(1.0) <= share {
            return (values, self.t);
        }
        for (value, old) in values.as_mut().iter_mut().zip(self.from.values.as_ref()) {
            *value = *old + share * (*value - *old);
        }
        (values, self.from.t + share * (self.t - self.from.t))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nan_is_not_near() {
        let nan = f64::NAN;
        assert!(is_near(0.01, 0.1) && !is_near(0.03, 0.1));
        assert!(
            !is_near(nan, 0.1) && !is_near(0.01, nan) && !is_near(nan, nan) && !is_near(f64::INFINITY, 1.0)
        );
    }
}
