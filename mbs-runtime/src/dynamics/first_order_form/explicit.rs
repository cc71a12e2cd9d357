//! A formulation with an integrator: methods that are explicit in the accelerations.

use crate::dynamics::first_order_form::crossing::{MOST_ROWS, is_next_to_singular_position};
use crate::dynamics::first_order_form::equations::{Equations, Moving};
use crate::dynamics::first_order_form::phases::{ORDER_OF_INTEGRALS, Phased, stepped, unmoved};
use crate::dynamics::formulations::singular::passage::near;
use crate::dynamics::integrators::fixed_step::FixedStep;
use crate::dynamics::integrators::step_control::Point;
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::forward::forward;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::method::{Method, require_smooth};
use crate::dynamics::model::{Counts, Formulation, MethodWarning, Model, Solved};
use crate::failure::Failure;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// An integrator `I` of equations that are explicit in the accelerations, with the formulation `F` that solves for these.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Explicit<I, F> {
    /// The integrator.
    pub integrator: I,
    /// Formulation that gives the accelerations of a state.
    pub formulation: F,
}

impl<I, F> Explicit<I, F> {
    /// Both parts.
    pub fn new(integrator: I, formulation: F) -> Self {
        Explicit { integrator, formulation }
    }
}

impl<S, R, I, F, const N: usize, const M: usize> Method<S, R, N, M> for Explicit<I, F>
where
    S: Dynamic<R, N, M>,
    R: Real,
    I: FixedStep,
    F: Formulation<S, R, N, M>,
{
    forward! { |it| it.formulation => solve, check_step, leaves_constraints, doubt }

    fn step(
        &self,
        model: &Model<'_, S, R, N, M>,
        from: &Instant<R, N, M, S::States>,
        h: R,
        counts: &mut Counts,
    ) -> Result<Instant<R, N, M, S::States>, Failure> {
        let mut motion = Equations::new(model, &self.formulation, from, *counts);
        motion.keep_steps(self.integrator.order());
        let t = from.t + h;
        let start = beginning(model.mechanism, from);
        let ended = match &mut self.integrator.step(&mut motion, from.t, h, &start.y, &start.rate) {
            // Once, and by reference: what a step is made of is long.
            Ok(end) => match &motion.project_and_solve(t, end) {
                Ok(solved) => {
                    let next = Instant { t, y: end.y, solved: *solved, carried: solved.rate.qd };
                    let is_near = solved.margin.min(from.solved.margin) < near();
                    // Nearly all steps end here, where their result is written.
                    if !is_near && motion.counts.singular == counts.singular {
                        *counts = motion.counts;
                        return Ok(next);
                    }
                    Ok(next)
                }
                Err(failure) => model.require_bounded(t, from, &end.y.q).and(Err(*failure)),
            },
            Err(failure) => Err(*failure),
        };
        let margin = ended.as_ref().map_or(from.solved.margin, |next| next.solved.margin);
        let entered = motion.counts.singular != counts.singular;
        if entered || margin.min(from.solved.margin) < near() {
            let keeps = !(self.integrator.uses_slopes() || self.formulation.leaves_constraints());
            if keeps && (entered || is_next_to_singular_position(model, from, h)) {
                let next = if const { M <= MOST_ROWS } {
                    // What the step itself failed with says more than its parts do.
                    motion.in_parts(start, t).map_err(|failure| ended.err().unwrap_or(failure))?
                } else {
                    ended?
                };
                model.require_one_branch(from, &next, R::constant(0.0))?;
                *counts = motion.counts;
                return Ok(next);
            }
        }
        if ended.is_ok() {
            *counts = motion.counts;
        }
        ended
    }

    fn phases_after(&self, model: &Model<'_, S, R, N, M>, t: R, h: R) -> Result<Option<S::Phases>, Failure> {
        if const { S::PHASES.is_empty() } || self.integrator.order() <= ORDER_OF_INTEGRALS {
            return Ok(None);
        }
        stepped(&self.integrator, model.mechanism, t, h).map(Some)
    }

    fn require_suitable(&self) -> Result<(), Failure> {
        if self.integrator.uses_slopes() {
            require_smooth::<S, R, N, M>()?;
        }
        self.formulation.require_suitable()
    }
}

/// Initial point of a run of `mechanism` that continues `from`.
pub(crate) fn beginning<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    from: &Instant<R, N, M, S::States>,
) -> Point<R, Moving<S, R, N, M>> {
    let y = Phased { y: from.y, phases: unmoved(mechanism.phases()) };
    let rate = Phased { y: from.solved.rate, phases: mechanism.phase_rates(from.t) };
    Point { t: from.t, y, rate }
}
