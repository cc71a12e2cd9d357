//! A step of fixed size next to a singular position, taken in parts whose error is estimated.
//!
//! A stage is about h²/8 of an acceleration off the constraints. At a distance s from a singular position that makes h²/(8 s²) of
//! an acceleration. So a step of about s has errors of the first order in h there, and may end too far off the rows, or on
//! another branch. Parts of an embedded pair are as small as the passage needs.
//!
//! Rounding of ε in the rows turns a mechanism aside within √ε of a reference length, as a small error of its dimensions does. In
//! single precision that is a motion which the parts follow, with its energy kept. So a passage is refused there unless it keeps
//! velocity and energy.

use crate::dynamics::first_order_form::equations::{Equations, Moving};
use crate::dynamics::formulations::singular::branch::{ASIDE, is_coarse};
use crate::dynamics::formulations::singular::limit_rows::passes_within;
use crate::dynamics::formulations::singular::passage::near;
use crate::dynamics::integrators::dormand_prince8::DormandPrince8;
use crate::dynamics::integrators::step_control::{Adaptive, Point};
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::metric::Tolerance;
use crate::dynamics::model::{Formulation, Model};
use crate::failure::{Failure, FailureKind};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{motion, singular};

/// Steps between a singular position and a step that is next to it: a four-bar of 60 J keeps its energy to 1e-7 J then, and to 2e-3 J
/// where only steps over the position are taken in parts.
const STEPS: f64 = 3.0;

/// Rows of a text whose steps are taken in parts at most: an evaluation next to a singular position factorizes several times, at a cost of
/// the third order in them. Ten seconds of forty loops, 81 rows, took more than eight minutes in tests, 20 s without parts.
pub(crate) const MOST_ROWS: usize = 32;

/// Parts that a step may be taken in: the smallest ones in the zone of a singular position, 1e-7 of a reference length, lead a
/// thousandth of it far.
const MOST_PARTS: u32 = 10_000;

/// Distance of a step in the metric over the sum of the margins at its ends from which on it may have led over a singular position: a
/// margin grows by the distance from there at most.
const TWICE: f64 = 2.0;

/// `true` if a step of `h` (s) that begins with `from` comes next to a singular position.
#[cold]
#[inline(never)]
pub(crate) fn is_next_to_singular_position<S, R, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    from: &Instant<R, N, M, S::States>,
    h: R,
) -> bool
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    passes_within(model, (from.t, &from.y), (R::constant(STEPS) * h, near()))
}

impl<S, F, R, const N: usize, const M: usize> Equations<'_, S, F, R, N, M>
where
    S: Dynamic<R, N, M>,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    /// The end, at `until` (s), of a step from `start` that is taken in parts.
    #[cold]
    #[inline(never)]
    pub(crate) fn in_parts(
        &mut self,
        start: Point<R, Moving<S, R, N, M>>,
        until: R,
    ) -> Result<Instant<R, N, M, S::States>, Failure> {
        let mut failed = None;
        for law in motion::OF_PARTS {
            let tolerance = law.of();
            self.divide(Tolerance { relative: tolerance, absolute: tolerance });
            let mut parts = 0;
            let run = Adaptive::default().run(
                DormandPrince8,
                self,
                start,
                until,
                |_| None,
                |equations, part| {
                    parts += 1;
                    let end = &part.end;
                    equations.require_lasting((end.t, &end.y.y.qd, &end.rate.y.qd))?;
                    let step = (part.end.t - part.start.t).to_f64();
                    let time = part.end.t.to_f64();
                    if parts < MOST_PARTS {
                        Ok(true)
                    } else {
                        Err(FailureKind::StepTooSmall { step }.at(time))
                    }
                },
            );
            match run.and_then(|end| Ok((end, self.solve(until, &end.y)?))) {
                Ok((end, solved)) => {
                    let solved = self.with_margin_of_rows(until, &end.y, solved);
                    let next = Instant { t: until, y: end.y.y, solved, carried: solved.rate.qd };
                    return Ok(next);
                }
                Err(failure) => failed = failed.or(Some(failure)),
            }
        }
        Err(failed.unwrap_or(FailureKind::StepTooSmall { step: 0.0 }.at(until.to_f64())))
    }

    /// The rate of a state, by all that the formulation solves for.
    #[inline(never)]
    pub(super) fn rate_solved(
        &mut self,
        t: R,
        y: &Moving<S, R, N, M>,
    ) -> Result<Moving<S, R, N, M>, Failure> {
        match &self.solve(t, y) {
            Ok(solved) => Ok(self.phased(t, solved.rate)),
            Err(failure) => self.rate_as_it_is(t, y, failure),
        }
    }

    /// The rate of a state that has none on the constraints, with the `failure` of that: where no step can be made smaller, as it is.
    #[cold]
    #[inline(never)]
    pub(super) fn rate_as_it_is(
        &mut self,
        t: R,
        y: &Moving<S, R, N, M>,
        failure: &Failure,
    ) -> Result<Moving<S, R, N, M>, Failure> {
        if !self.is_fixed() {
            return Err(*failure);
        }
        self.model.require_bounded(t, &self.end, &y.y.q)?;
        if !matches!(failure, Failure { kind: FailureKind::OffConstraints { .. }, .. }) {
            return Err(*failure);
        }
        let solved = self.at(t, &y.phases, |model, formulation, lambda, counts| {
            let solved = formulation.solve_as_it_is(model, t, &y.y, lambda, counts)?;
            *lambda = solved.lambda;
            Ok(solved)
        })?;
        Ok(self.phased(t, solved.rate))
    }

    /// Fails where a step that can be made smaller may have left the branch of its motion, in numbers so coarse that the accelerations do
    /// not tell. `entered`: its end is next to a singular position. Steps of fixed size and their parts are judged as a whole.
    #[inline(always)]
    pub(crate) fn require_branch_of_step(
        &self,
        next: &Instant<R, N, M, S::States>,
        entered: bool,
    ) -> Result<(), Failure> {
        let is_exact = !is_coarse::<R>();
        if is_exact || self.is_fixed() || self.model.first_order {
            Ok(())
        } else {
            self.require_branch_of_coarse_step(next, entered)
        }
    }

    #[cold]
    #[inline(never)]
    fn require_branch_of_coarse_step(
        &self,
        next: &Instant<R, N, M, S::States>,
        entered: bool,
    ) -> Result<(), Failure> {
        let from = self.end;
        let h = next.t - from.t;
        let (before, after) = (from.solved.margin, next.solved.margin);
        self.model.moved(self.start, from.t, |model| {
            // A step may be longer than the way on which the margin tells of the position.
            let over = before + after < R::constant(TWICE) * h * model.largest(&from.y.qd);
            let near = before.min(after) < near();
            if entered || over || near && is_next_to_singular_position(model, &from, h) {
                model.require_one_branch(&from, next, self.narrowest())?;
                return self.require_lasting((next.t, &next.y.qd, &next.solved.rate.qd));
            }
            Ok(())
        })
    }

    /// Fails where the velocity at the end of a part does not last over the distance within which rounding turns it.
    fn require_lasting(&self, (t, qd, qdd): (R, &[R; N], &[R; N])) -> Result<(), Failure> {
        let (speed, change) = (self.model.largest(qd), self.model.largest(qdd));
        let turned = singular::TURNED.of::<R>() * change;
        // Written so that NaN does not last.
        if !is_coarse::<R>() || turned.less(R::constant(ASIDE) * speed * speed) {
            return Ok(());
        }
        Err(FailureKind::undecided(self.end.solved.margin).at(t.to_f64()))
    }
}
