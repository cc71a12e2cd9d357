//! Frictions that stick and closed contacts in implicit steps: rows of the positions at a step's end, beside the constraints.

use crate::dynamics::formulations::set_valued::holding::Holding;
use crate::dynamics::formulations::unstabilized::Unstabilized;
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::failure::Failure;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::set_valued::{SetValuedRow, WithSetValuedRows};
use crate::scalar::number::Real;

/// Values that a solution has along rows that hold.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Along {
    /// 0: of a unit of force.
    Nothing,
    /// The distance from where each holds: of a correction that is subtracted.
    Places,
    /// γ: of accelerations.
    Accelerations,
}

/// Coordinates (N) and multipliers (M) of a linear system.
type Solution<R, const N: usize, const M: usize> = ([R; N], [R; M]);

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Parameters with the forces of rows that hold, for accelerations and multipliers (N, M) of an iteration; `None` of a text without
    /// such rows.
    #[inline(always)]
    pub(super) fn forces_of_modes(
        &self,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        rates: (&[R; N], &[R; M]),
    ) -> Option<S::Parameters> {
        if const { S::SET_VALUED.is_empty() } {
            return None;
        }
        Some(self.with_set_valued_forces(position, y, rates))
    }

    /// The solution `found` of a linear system with the forces added that lead it `along` the rows that hold. `solve` gives the system's
    /// answer to a force (N).
    #[inline(always)]
    pub(super) fn held_along(
        &self,
        along: Along,
        (position, y): (&S::Position, &IntegratorState<R, N, S::States>),
        found: Solution<R, N, M>,
        solve: impl FnMut(&[R; N]) -> Solution<R, N, M>,
    ) -> Solution<R, N, M> {
        if const { S::SET_VALUED.is_empty() } || self.springs.is_some() || !self.sticks() {
            return found;
        }
        let rows = HeldAlong { model: self, along, found, solve };
        let none = [R::constant(0.0); M];
        self.mechanism.set_valued_rows(self.parameters, position, &y.qd, &y.states, &none, rows)
    }

    /// The end of a step of a text with modes: velocities that keep what holds, and the accelerations and multipliers of that state.
    /// Searches for the next change of a mode look at those.
    #[inline(always)]
    pub(super) fn settled_in_modes(
        &self,
        next: Instant<R, N, M, S::States>,
        counts: &mut Counts,
    ) -> Result<Instant<R, N, M, S::States>, Failure> {
        if const { !S::HAS_MODES } {
            return Ok(next);
        }
        let Instant { t, mut y, solved, carried } = next;
        if const { !S::SET_VALUED.is_empty() } {
            self.settle(&Unstabilized, t, &mut y, counts)?;
        }
        let margin = solved.margin;
        let solved = Unstabilized.solve(self, t, &y, &solved.lambda, counts)?;
        Ok(Instant { t, y, solved: Solved { margin, ..solved }, carried })
    }
}

struct HeldAlong<'a, S: Dynamic<R, N, M>, R: Real, F, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    along: Along,
    found: Solution<R, N, M>,
    solve: F,
}

impl<S, R, F, const N: usize, const M: usize> WithSetValuedRows<R, N> for HeldAlong<'_, S, R, F, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
    F: FnMut(&[R; N]) -> Solution<R, N, M>,
{
    type Output = Solution<R, N, M>;

    fn at<const K: usize>(self, rows: &[SetValuedRow<R, N>; K]) -> Self::Output {
        let modes = S::set_valued_modes(self.model.parameters);
        let mut right = [R::constant(0.0); K];
        for ((right, row), mode) in right.iter_mut().zip(rows).zip(modes) {
            *right = match self.along {
                Along::Nothing => *right,
                Along::Places => row.place - mode.place,
                Along::Accelerations => row.gamma,
            };
        }
        Holding::of::<S>(rows, modes, self.solve).hold(rows, self.found, &right)
    }
}
