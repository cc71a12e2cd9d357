//! The place where forces are nearest to balance, from any distance.

use crate::dynamics::equilibrium::consistent_start::close;
use crate::dynamics::equilibrium::correction::{
    FAR, HALVINGS, LARGEST_STEP, PROMISED, capped, capped_turn, largest,
};
use crate::dynamics::equilibrium::free_stiffness::Answer;
use crate::dynamics::equilibrium::{answer, no_equilibrium};
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::model::{Counts, Model};
use crate::failure::Failure;
use crate::linear_algebra::vectors::Each;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// Moves of the search: ten turns of a coordinate, or a dozen digits of a place where forces only come near to balance.
const MOST_MOVES: u32 = 120;

/// Halvings of a move that is longer than a step may be otherwise, and doublings of one with a force: as many as there are
/// powers of two between a step and the farthest coordinate that is resolved.
const MOST_DOUBLINGS: u32 = 48;

/// Halvings of a way on which a force turns back: to its rounding in an `f64`.
const MOST_BISECTIONS: u32 = 60;

/// Largest turn (rad) with a force that stays the same: after it a mechanism of angles is where it was.
const WHOLE_TURN: f64 = core::f64::consts::TAU;

/// A position on the rows, and the answer to the forces there.
type Place<S, R, const N: usize, const M: usize> =
    (IntegratorState<R, N, <S as Dynamic<R, N, M>>::States>, Answer<R, N, M>);

/// Moves `y` to where the forces of the free motions are nearest to balance, along the rows.
///
/// # Errors
/// [`FailureKind::NoEquilibrium`](crate::FailureKind::NoEquilibrium) where they do not come to balance there;
/// [`FailureKind::EquilibriumNotConverged`](crate::FailureKind::EquilibriumNotConverged) where moves still come nearer at the end, or lead to no position;
/// [`FailureKind::OffConstraints`](crate::FailureKind::OffConstraints) where the rows cannot be met.
pub(crate) fn approach<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut IntegratorState<R, N, S::States>,
) -> Result<(), Failure> {
    let zero = R::constant(0.0);
    close(model, t, y, &[], &mut Counts::default())?;
    model.settle_states(t, y, &[zero; M])?;
    let mut here = answer(model, t, y)?;
    for _ in 0..MOST_MOVES {
        if !zero.less(here.imbalance) {
            return Ok(());
        }
        let start = Move { model, t, from: y, answer: &here, step: &here.step };
        let found = match start.far_nearer() {
            Some(place) => Some(place),
            None => start.nearer()?,
        };
        let found = found.or_else(|| start.with_the_force());
        let Some(place) = found else { return Err(no_equilibrium(model, t, &here.pull, here.imbalance)) };
        (*y, here) = place;
    }
    if zero.less(here.imbalance) { Err(model.unbalanced(&here.step, t, MOST_MOVES)) } else { Ok(()) }
}

/// A move from a position on the rows.
struct Move<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    t: R,
    from: &'a IntegratorState<R, N, S::States>,
    /// That to the forces there.
    answer: &'a Answer<R, N, M>,
    /// The negative of the move: N.
    step: &'a [R; N],
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Move<'_, S, R, N, M> {
    /// The position on the rows after `share` of the move.
    fn after(&self, share: R) -> Result<Place<S, R, N, M>, Failure> {
        let mut trial = *self.from;
        trial.q = self.from.q.plus(-share, &[1.0], [self.step]);
        self.model.check(self.t, &trial)?;
        close(self.model, self.t, &mut trial, &[], &mut Counts::default())?;
        self.model.settle_states(self.t, &mut trial, &[R::constant(0.0); M])?;
        let there = answer(self.model, self.t, &trial)?;
        Ok((trial, there))
    }

    /// `true` if forces are nearer to balance at `place`, by `part` of all that `share` of the move promises.
    fn comes_nearer(&self, place: &Place<S, R, N, M>, (share, part): (R, f64)) -> bool {
        let promised = self.answer.imbalance * (R::constant(1.0) - R::constant(part) * share);
        place.1.imbalance.less(promised)
    }

    /// The longest move of lengths beyond a step that comes much nearer, halved until one does.
    fn far_nearer(&self) -> Option<Place<S, R, N, M>> {
        let whole = capped(self.step, &self.model.metric.coordinates);
        let mut share = capped_turn::<S, R, N, M>(self.step);
        for _ in 0..MOST_DOUBLINGS {
            if share <= whole {
                break;
            }
            let place = self.after(share).ok().filter(|place| self.comes_nearer(place, (share, FAR)));
            if place.is_some() {
                return place;
            }
            share = share * R::constant(0.5);
        }
        None
    }

    /// The longest move within a step that comes nearer, halved until one does.
    ///
    /// # Errors
    /// [`FailureKind::EquilibriumNotConverged`](crate::FailureKind::EquilibriumNotConverged) where the shortest one leads to no position.
    fn nearer(&self) -> Result<Option<Place<S, R, N, M>>, Failure> {
        let mut share = capped(self.step, &self.model.metric.coordinates);
        let mut leads_on = true;
        for _ in 0..HALVINGS {
            let place = self.after(share);
            leads_on = place.is_ok();
            let nearer = place.ok().filter(|place| self.comes_nearer(place, (share, PROMISED)));
            if nearer.is_some() {
                return Ok(nearer);
            }
            share = share * R::constant(0.5);
        }
        if leads_on { Ok(None) } else { Err(self.model.unbalanced(self.step, self.t, MOST_MOVES)) }
    }

    /// The position after a move with the force that no stiffness answers, twice as long again until forces are much nearer to balance
    /// or push back.
    #[cold]
    #[inline(never)]
    fn with_the_force(&self) -> Option<Place<S, R, N, M>> {
        let (zero, two) = (R::constant(0.0), R::constant(2.0));
        let size = largest(&self.answer.unanswered, &self.model.metric.coordinates);
        if !zero.less(self.answer.push) || !zero.less(size) {
            return None;
        }
        let unit = self.answer.unanswered.each(|part| part * (R::constant(LARGEST_STEP) / size));
        let along = Move { step: &unit, ..*self };
        let (mut share, mut nearest) = (R::constant(1.0), None);
        for _ in 0..MOST_DOUBLINGS {
            if along.only_turns() && R::constant(WHOLE_TURN) < share * R::constant(LARGEST_STEP) {
                break;
            }
            let Ok(place) = along.after(share) else { break };
            if along.comes_nearer(&place, (R::constant(1.0), FAR)) {
                return Some(place);
            }
            if along.pushes_back(&place) {
                return nearest.or_else(|| along.between(R::constant(0.5) * share, share));
            }
            nearest = Some(place).filter(|place| along.comes_nearer(place, (R::constant(1.0), PROMISED)));
            share = two * share;
        }
        nearest
    }

    /// `true` if angles alone move.
    fn only_turns(&self) -> bool {
        let mut lengths = self.step.iter().zip(S::COORDINATES).filter(|(_, entry)| !entry.is_angle());
        lengths.all(|(part, _)| *part == R::constant(0.0))
    }

    /// `true` if the forces at `place` push against the move.
    fn pushes_back(&self, place: &Place<S, R, N, M>) -> bool {
        let parts = place.1.pull.iter().zip(self.step).zip(&self.model.metric.coordinates);
        let sum = parts
            .fold(R::constant(0.0), |sum, ((pull, step), scale)| sum + (*pull / *scale) * (*step / *scale));
        sum < R::constant(0.0)
    }

    /// A position nearer to balance between two shares of the move, where forces push with it and against it.
    fn between(&self, mut with: R, mut against: R) -> Option<Place<S, R, N, M>> {
        for _ in 0..MOST_BISECTIONS {
            let share = with + R::constant(0.5) * (against - with);
            let place = self.after(share).ok()?;
            if self.comes_nearer(&place, (R::constant(1.0), PROMISED)) {
                return Some(place);
            }
            (with, against) = if self.pushes_back(&place) { (with, share) } else { (share, against) };
        }
        None
    }
}
