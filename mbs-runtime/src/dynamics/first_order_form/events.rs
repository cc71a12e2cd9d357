//! Events of a text along a run: decided where a step begins, and located within it.

use crate::dynamics::first_order_form::equations::{Equations, Moving};
use crate::dynamics::integrators::event::Dense;
use crate::dynamics::model::{Formulation, Model};
use crate::failure::{Failure, FailureKind};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::motion;

/// Changes of events next to each other from which on they have no end.
const MOST_CHANGES: u32 = 64;

impl<S, F, R, const N: usize, const M: usize> Equations<'_, S, F, R, N, M>
where
    S: Dynamic<R, N, M>,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    /// Begins and ends of events at `y`; `true` if there are any. `anew`: contacts have changed, so that the last rates do not count.
    ///
    /// # Errors
    /// [`FailureKind::Chatter`] where the new values lead back to the condition at once, over and over: the motion slides along it.
    #[inline(never)]
    pub(super) fn switch(&mut self, t: R, y: &Moving<S, R, N, M>, anew: bool) -> Result<bool, Failure> {
        if const { S::EVENTS.is_empty() } || self.model.first_order {
            return Ok(false);
        }
        let rate = if anew { Some(self.solve(t, y)?) } else { None };
        let known = rate.unwrap_or(self.end.solved);
        let switched = self.at(t, &y.phases, |model, formulation, lambda, counts| {
            model.switch(t, &y.y, (Some(&known), false), &mut |model| {
                formulation.solve(model, t, &y.y, lambda, counts)
            })
        })?;
        let Some((parameters, solved)) = switched else { return Ok(false) };
        let of = Model { parameters: &parameters, ..*self.model };
        self.parameters = self.parameters.map(|parameters| of.with_modes_of(parameters));
        (self.lambda, self.end.solved) = (solved.lambda, solved);
        let (last, count) = self.changed;
        let (zone, one) = (motion::NEXT_EVENT.of::<R>(), R::constant(1.0));
        let passed = t - last;
        let next = passed < zone * t.abs().max(one) && passed * self.model.largest(&y.y.qd) < zone;
        self.changed = (t, if next { count.saturating_add(1) } else { 0 });
        match S::EVENTS.first() {
            Some(friction) if MOST_CHANGES < self.changed.1 => {
                Err(FailureKind::Chatter { entry: friction, parts: MOST_CHANGES }.at(t.to_f64()))
            }
            _ => Ok(true),
        }
    }

    /// The first time (s) of a step at which an event begins or ends.
    #[inline(never)]
    pub(super) fn event(
        &mut self,
        step: &impl Dense<R, State = Moving<S, R, N, M>>,
        times: (R, R),
    ) -> Result<Option<R>, Failure> {
        let (model, resolution) = (self.model, self.scrutiny.resolution);
        self.apart(|equations| {
            model.first_event(times, resolution, |t, first, values| {
                let y = step.at(t);
                equations.at(t, &y.phases, |model, formulation, lambda, counts| {
                    let solved = if const { S::EVENTS_USE_ACCELERATIONS } {
                        match formulation.solve(model, t, &y.y, lambda, counts) {
                            Ok(solved) => Some(solved),
                            Err(_) => return values.fill(R::constant(f64::NAN)),
                        }
                    } else {
                        None
                    };
                    model.event_values((t, &y.y), solved.as_ref(), (first, values));
                });
            })
        })
    }
}
