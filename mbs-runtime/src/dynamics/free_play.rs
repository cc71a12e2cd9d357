//! Free play: motions to one side of a rest that nothing answers, where the stiffness at the rest is that of the other side.

use super::free_stiffness::{FreeStiffness, SHARE};
use super::model::Model;
use super::vector::{State, Vector};
use crate::{Dynamic, Failure, Real};

/// Distance to both sides of a rest, in √ε of the coordinates in the metric: beside it the side that rounding has put the rest on is
/// nothing, and what a curved motion leaves of the forces, its square, is no more than rounding.
const ASIDE: f64 = 4.0;

/// Work along a play, in [`ASIDE`] ε of the largest force or stiffness, that is none: what the search leaves of a rest's forces, and the square
/// of the distance to the side.
const NOTHING: f64 = 32.0;

/// Free motions up to which sums and differences of two are tried too: a play may be open to none of the motions themselves.
const PAIRED: usize = 6;

/// A play found beside a rest has lost a motion that was answered: ranks are whole numbers.
const HALF: f64 = 0.5;

/// Which coordinates (N) of a rest at `y` may move to one side without any force answering, beside those that are `indifferent` (N) already.
///
/// # Errors
/// Those of [`FreeStiffness::of`] at the rest.
#[inline(never)]
pub(super) fn with_play<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &State<R, N, S::States>,
    lambda: &[R; M],
    mut indifferent: [bool; N],
) -> Result<[bool; N], Failure> {
    let scales = &model.metric.coordinates;
    let here = FreeStiffness::of(model, t, y, lambda)?;
    let beside = Beside { model, t, y, lambda, here: &here, aside: aside(&y.q, scales) };
    for first in 0..here.freedom {
        let seconds = if here.freedom <= PAIRED { first + 1..here.freedom } else { 0..0 };
        let pairs = seconds.flat_map(|second| [Some((second, 1.0)), Some((second, -1.0))]);
        for pair in pairs.chain([None]) {
            let mut probe = beside.motion(first);
            if let Some((second, sign)) = pair {
                probe = probe.plus(R::constant(sign), &[1.0], [&beside.motion(second)]);
            }
            for sign in [1.0, -1.0] {
                beside.mark(&probe.map(|part| R::constant(sign) * part), &mut indifferent);
            }
        }
    }
    Ok(indifferent)
}

/// How far beside `q` (N) is looked, in the metric.
fn aside<R: Real, const N: usize>(q: &[R; N], scales: &[R; N]) -> R {
    let extents = q.iter().zip(scales).map(|(q, scale)| (*q / *scale).abs());
    let extent = extents.fold(R::constant(1.0), |largest, part| largest.max(part));
    R::constant(ASIDE) * R::EPSILON.sqrt() * extent
}

/// A state, and its free stiffness.
type Place<S, R, const N: usize, const M: usize> =
    (State<R, N, <S as Dynamic<R, N, M>>::States>, FreeStiffness<R, N, M>);

/// Positions beside a rest.
struct Beside<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    t: R,
    y: &'a State<R, N, S::States>,
    lambda: &'a [R; M],
    here: &'a FreeStiffness<R, N, M>,
    aside: R,
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Beside<'_, S, R, N, M> {
    /// A free motion (N) of the rest.
    fn motion(&self, index: usize) -> [R; N] {
        self.here.motions.get(index).copied().unwrap_or([R::constant(0.0); N])
    }

    /// Marks the coordinates (N) of motions that nothing answers on the side that `probe` (N) leads to, where more are such than at the rest.
    fn mark(&self, probe: &[R; N], indifferent: &mut [bool; N]) {
        let Some((_, there)) = self.moved(probe) else { return };
        if there.unanswered_motions() < self.here.unanswered_motions() + R::constant(HALF) {
            return;
        }
        self.mark_idle(&there.unanswered(probe, &self.model.metric.coordinates), indifferent);
        for index in 0..there.freedom {
            let idle = there.unanswered_part(index).0;
            self.mark_idle(&idle, indifferent);
            self.mark_idle(&idle.map(|part| -part), indifferent);
        }
    }

    /// Marks the coordinates of `motion` (N) where forces balance along it too.
    fn mark_idle(&self, motion: &[R; N], indifferent: &mut [bool; N]) {
        let zero = R::constant(0.0);
        let Some((y, there)) = self.moved(motion) else { return };
        let position = self.model.position(self.t, &y);
        let imbalance = self.model.imbalance(&position, &y, &[zero; N], (self.lambda, self.lambda));
        let scales = &self.model.metric.coordinates;
        let pull = there.answer(&imbalance, &[zero; M]).pull;
        let mut work = zero;
        for ((pull, part), scale) in pull.iter().zip(motion).zip(scales) {
            work = work + *pull * *part / (*scale * *scale);
        }
        let extent = self.aside / R::EPSILON.sqrt();
        let nothing = R::constant(NOTHING) * R::EPSILON * extent * there.size * self.model.largest(motion);
        // NaN is no balance.
        let balanced = work.abs() <= nothing;
        if !balanced {
            return;
        }
        let share = R::constant(SHARE).max(R::constant(ASIDE) * self.aside) * self.model.largest(motion);
        for ((mark, part), scale) in indifferent.iter_mut().zip(motion).zip(scales) {
            *mark |= share.less((*part / *scale).abs());
        }
    }

    /// The state beside the rest along `motion` (N), and its free stiffness; none where there is no motion, or no stiffness there.
    fn moved(&self, motion: &[R; N]) -> Option<Place<S, R, N, M>> {
        let size = self.model.largest(motion);
        if !R::constant(SHARE).less(size) {
            return None;
        }
        let mut y = *self.y;
        y.q = y.q.plus(self.aside / size, &[1.0], [motion]);
        let there = FreeStiffness::of(self.model, self.t, &y, self.lambda).ok()?;
        Some((y, there))
    }
}
