//! A step in a fixed amount of work, for a control loop with a deadline.

use crate::block_solvers::bounded_newton::Budgeted;
use crate::block_solvers::budget::Budget;
use crate::block_solvers::convergence::Statistics;
use crate::failure::checks::{entry, time_failure};
use crate::failure::{Failure, FailureKind};
use crate::kinematics::least_squares_assembly::contradiction;
use crate::kinematics::position::position_failure;
use crate::linear_algebra::vectors::{extent, largest_difference};
use crate::mechanism::{Entry, Kinematic};
use crate::scalar::number::Real;
use crate::stepper::Stepper;
use crate::stepper::instant::SolvedPosition;

/// Result of [`Stepper::step`].
#[must_use = "a refused step leaves the stepper at the time before"]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// The position is within its tolerance.
    Done(Statistics),
    /// The budget ran out next to the position. The best one found is the state; the next step repairs it.
    Degraded {
        /// The largest residual against its tolerance, in the unit of its row.
        residual: f64,
        /// That row.
        row: Entry,
        /// Effort spent; its `residual`, over the tolerance, is above 1.
        statistics: Statistics,
    },
    /// There is no position that could be kept. The state is bit for bit as before.
    Refused(Failure),
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// Moves on by `h` (s) in a fixed amount of work; 0 solves anew, negative goes back.
    ///
    /// Predicts as [`advance_to`](Self::advance_to), then spends at most [`Budget::evaluations`] a block. If they
    /// do not reach the tolerance, the best position found becomes the state, with rates from it. Newton's next
    /// step from there must be at most a quarter of the margin to singularity: so near, it converges, and to the same
    /// assembly. That step is made at the beginning of the next call, whatever its budget. So a loop with one
    /// evaluation a period still follows the motion.
    ///
    /// [`Step::Refused`] with [`FailureKind::NonFinite`], [`FailureKind::NotConverged`] (too far from any position for the
    /// budget, or there is none); [`FailureKind::OverBudget`] (the next step goes on where the budget ended);
    /// [`FailureKind::NotFollowed`], [`FailureKind::Discontinuous`], [`FailureKind::Singular`], [`FailureKind::WrongBranch`],
    /// [`FailureKind::BeyondLimit`].
    #[inline]
    pub fn step(&mut self, h: R, budget: Budget) -> Step {
        self.turning(h, |stepper, t, rest| stepper.within(t, rest, budget)).unwrap_or_else(Step::Refused)
    }

    /// Moves on by `periods` periods of `period` (s) after missed deadlines, in a step a period; 0 counts as 1.
    ///
    /// Steps as long as those of the loop keep the assembly where one long step could lose it. The time is that
    /// without the misses. Costs at most `periods` times the cost of [`step`](Self::step). All or
    /// nothing: if one step is refused, the state is bit for bit as before the call. A degraded step is
    /// repaired by the next one, so [`Step::Degraded`] describes the last one alone; `statistics` are those of the
    /// last step, but `evaluations` sums all.
    ///
    /// Inputs jump to their present value in the first step. Where they have moved far in the time missed, change
    /// them in parts, with a [`step`](Self::step) after each.
    pub fn skip(&mut self, period: R, periods: u32, budget: Budget) -> Step {
        let before =
            (self.state, self.changed, self.turns, self.mechanism.clone(), self.anchor, self.led, self.piece);
        let periods = periods.max(1);
        let mut evaluations = 0_u32;
        let mut step = Step::Refused(FailureKind::NonFinite { name: "t", line: 0 }.without_time());
        for k in 1..=periods {
            step = match (S::TURNS, S::PHASES) {
                ([], []) => self.step_to(before.0.t + period * R::constant(f64::from(k)), budget),
                _ => self.step(period, budget),
            };
            let (Step::Done(statistics) | Step::Degraded { statistics, .. }) = &mut step else {
                (self.state, self.changed, self.turns, self.mechanism, self.anchor, self.led, self.piece) =
                    before;
                return step;
            };
            evaluations = evaluations.saturating_add(statistics.evaluations);
            statistics.evaluations = evaluations;
        }
        step
    }

    /// `true` if the position does not close, because the last step was [`Step::Degraded`].
    pub fn is_degraded(&self) -> bool {
        self.state.repair.is_some()
    }

    /// Time (s) until the margin is zero if it goes on falling as in the last step; `None` if it did not fall.
    ///
    /// Linear, from the margins of the last two positions at different times, and in the direction of increasing
    /// time. Next to a position where the mechanism locks up, the margin falls like a square root, and half
    /// of that time is left.
    pub fn time_to_singular(&self) -> Option<R> {
        let rate = self.state.drift.rate();
        let time = self.state.margin / -rate;
        (rate < R::constant(0.0) && time.is_finite()).then_some(time)
    }

    #[inline]
    fn step_to(&mut self, t: R, budget: Budget) -> Step {
        self.within(t, R::constant(0.0), budget).unwrap_or_else(Step::Refused)
    }

    #[inline]
    fn within(&mut self, t: R, rest: R, budget: Budget) -> Result<Step, Failure> {
        if let Some(failure) = self.fault.or(time_failure(t)) {
            return Err(failure);
        }
        self.with_phases((t, rest), |stepper, phases| stepper.within_budget(t, phases, budget))
    }

    #[inline]
    fn within_budget(&mut self, t: R, phases: S::Phases, budget: Budget) -> Result<Step, Failure> {
        let most = budget.evaluations();
        if !self.is_ready() {
            return self.along_the_way(t, phases, 0, most).map(Step::Done);
        }
        let prediction = self.predicted(t);
        let start = prediction.q;
        let scales = self.mechanism.coordinate_scales(&self.parameters);
        let mut solver = Budgeted::new(extent(&start, &scales), budget);
        let mut q = start;
        let (outcome, position) =
            self.mechanism.solve_with_position(&self.parameters, &mut q, t, &mut solver);
        let open = position_failure::<S, R, N, _>(outcome, solver.diagnosis(), t);
        let mut statistics = Statistics::of(solver.diagnosis());
        statistics.correction = largest_difference(&q, &start, &scales).to_f64();
        if let Some(
            failure @ (Failure { kind: FailureKind::NonFinite { .. }, .. }
            | Failure { kind: FailureKind::Inconsistent { .. }, .. }),
        ) = open
        {
            return Err(contradiction(&self.mechanism, &self.parameters, &q, t, failure));
        }
        if !self.is_taken(SolvedPosition { t, q, position, statistics, open }, &prediction, phases)? {
            let left = most.saturating_sub(statistics.evaluations);
            let done = self.along_the_way(t, phases, statistics.evaluations, left);
            return match (done, open) {
                (
                    Err(
                        Failure { kind: FailureKind::NotFollowed { .. }, .. }
                        | Failure { kind: FailureKind::OverBudget { .. }, .. },
                    ),
                    Some(failure),
                ) => Err(failure),
                (done, _) => done.map(Step::Done),
            };
        }
        let statistics = self.statistics();
        Ok(match open {
            None => Step::Done(statistics),
            Some(_) => Step::Degraded {
                residual: solver.diagnosis().worst.residual.to_f64(),
                row: *entry(S::ROWS, statistics.row),
                statistics,
            },
        })
    }
}
