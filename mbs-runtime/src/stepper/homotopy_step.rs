//! One step along the homotopy from the last position that leads on.

use crate::block_solvers::bounded_newton::Budgeted;
use crate::block_solvers::budget::Budget;
use crate::block_solvers::convergence::Statistics;
use crate::failure::checks::entry;
use crate::failure::{Failure, FailureKind};
use crate::kinematics::homotopy::{Anchor, EVALUATIONS, Followed, Homotopy, LEAST_EVALUATIONS, leads};
use crate::kinematics::position::{next_position, position_failure, solve_with_position};
use crate::linear_algebra::vectors::extent;
use crate::mechanism::Kinematic;
use crate::scalar::number::Real;
use crate::stepper::Stepper;
use crate::stepper::instant::{Predecessor, Rates, SolvedPosition};
use crate::stepper::state::StepperState;

/// Work in addition to the homotopy at the end of a path that is followed in bounded work: Newton's method then closes within two
/// evaluations.
pub(crate) const FINAL: Budget = Budget { newton: 3, fallback: 0 };

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// Takes the state at which the homotopy ends, in `limit` evaluations in addition to the `first`.
    #[cold]
    #[inline(never)]
    pub(crate) fn along_the_way(
        &mut self,
        t: R,
        phases: S::Phases,
        first: u32,
        limit: u32,
    ) -> Result<Statistics, Failure> {
        let required = LEAST_EVALUATIONS + FINAL.newton;
        if limit < required {
            return Err(FailureKind::OverBudget { part: 0.0, evaluations: limit, required }.at(t.to_f64()));
        }
        let from = self.last_leading(phases);
        let values = self.mechanism.values();
        let piece = if self.led { self.piece } else { R::constant(1.0) };
        let mut way = Homotopy { from: &from, mechanism: &mut self.mechanism, values, t };
        let bounded = limit < EVALUATIONS;
        let end = way.followed(piece, if bounded { limit - FINAL.newton } else { limit });
        let place = way.place(end.leading.share);
        if end.share < R::constant(1.0) {
            if bounded && end.spent {
                // The next step goes on from there.
                let (values, now) = place;
                (self.anchor, self.led) = (Anchor { t: now, q: end.leading.q, values }, true);
                self.piece = end.leading.piece;
                let part = end.leading.share.to_f64();
                return Err(FailureKind::OverBudget { part, evaluations: limit, required }.at(t.to_f64()));
            }
            return Err(self.not_followed(&end, t, limit));
        }
        let (q, position, second) = if bounded {
            self.closed(&end.q, t)?
        } else {
            solve_with_position(&self.mechanism, &self.parameters, &end.q, t)?
        };
        let evaluations = first.saturating_add(end.evaluations).saturating_add(second.evaluations);
        let statistics = Statistics { evaluations, fallback: true, ..second };
        let mut found = SolvedPosition { t, q, position, statistics, open: None };
        let mut rates = Rates::none();
        let before = Predecessor::State(&self.state);
        if let Some(failure) = rates.solve(&self.mechanism, &self.parameters, &mut found, before) {
            return Err(failure);
        }
        self.move_on(found, rates, Some(from));
        Ok(self.state.statistics)
    }

    /// The position at the end of a way, to rounding, in bounded work.
    fn closed(&self, end: &[R; N], t: R) -> Result<([R; N], S::Position, Statistics), Failure> {
        let scales = self.mechanism.coordinate_scales(&self.parameters);
        let mut solver = Budgeted::new(extent(end, &scales), FINAL);
        let mut q = *end;
        let (outcome, position) =
            self.mechanism.solve_with_position(&self.parameters, &mut q, t, &mut solver);
        let open = position_failure::<S, R, N, M>(outcome, solver.diagnosis(), t);
        open.map_or(Ok((q, position, Statistics::of(solver.diagnosis()))), Err)
    }

    /// Obstacle to the path to `t` (s): no position there, a singular one, a jump, or none of these in `limit` evaluations.
    #[cold]
    #[inline(never)]
    fn not_followed(&self, end: &Followed<R, N>, t: R, limit: u32) -> Failure {
        let (part, time) = (end.share.to_f64(), t.to_f64());
        if let Some(row) = end.jump {
            return FailureKind::Discontinuous { row: entry(S::ROWS, row), part }.at(time);
        }
        let doubtful = FailureKind::not_followed(part, end.margin).at(time);
        if limit < EVALUATIONS {
            return doubtful;
        }
        let mut q = end.q;
        let (position, statistics, failure) = next_position(&self.mechanism, &self.parameters, &mut q, t);
        let mut found = SolvedPosition { t, q, position, statistics, open: None };
        let rates = || {
            Rates::none().solve(
                &self.mechanism,
                &self.parameters,
                &mut found,
                Predecessor::State(&self.state),
            )
        };
        failure.or_else(rates).unwrap_or(doubtful)
    }

    /// The last position that leads on, with its values; `phases` are those before the step.
    pub(super) fn last_leading(&mut self, phases: S::Phases) -> Anchor<S::Values, R, N> {
        if self.led || !leads(self.state.margin) {
            return self.anchor;
        }
        let StepperState { t, q, .. } = self.state;
        if self.changed {
            return Anchor { t, q, values: self.anchor.values };
        }
        let moved = self.mechanism.phases();
        self.mechanism.set_phases(phases);
        let values = self.mechanism.values();
        self.mechanism.set_phases(moved);
        Anchor { t, q, values }
    }

    /// Becomes the state at the position that follows, found along a way from an anchor or next to its prediction.
    pub(super) fn move_on(
        &mut self,
        found: SolvedPosition<S, R, N, M>,
        rates: Rates<R, N>,
        from: Option<Anchor<S::Values, R, N>>,
    ) {
        self.state.move_on(found, rates);
        (self.changed, self.led) = (false, false);
        if let Some(anchor) = from.filter(|_| !leads(self.state.margin)) {
            self.anchor = anchor;
        }
    }
}
