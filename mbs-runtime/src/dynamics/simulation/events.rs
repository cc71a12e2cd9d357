//! Events of a text in a motion: decided where it starts, after changes, and between the parts of fixed steps.

use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::method::Method;
use crate::dynamics::model::{Counts, Model};
use crate::dynamics::simulation::Simulation;
use crate::dynamics::simulation::fixed_run::AheadOf;
use crate::failure::Failure;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// Parameters with the values that events set at a state of which nothing but its position and velocity is known. `starts`: every value
/// is latched.
pub(super) fn anew<S, X, R, const N: usize, const M: usize>(
    method: &X,
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    (counts, starts): (&mut Counts, bool),
) -> Result<S::Parameters, Failure>
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    if const { S::EVENTS.is_empty() } {
        return Ok(*model.parameters);
    }
    let none = [R::constant(0.0); M];
    let switched =
        model.switch(t, y, (None, starts), &mut |model| method.solve(model, t, y, &none, counts))?;
    Ok(switched.map_or(*model.parameters, |(parameters, _)| parameters))
}

impl<S, X, R, const N: usize, const M: usize> Simulation<S, X, R, N, M>
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    /// Begins and ends of events at the present instant.
    pub(super) fn switch(&mut self) -> Result<(), Failure> {
        if const { S::EVENTS.is_empty() } {
            return Ok(());
        }
        let (t, y, solved, mut counts) = (self.now.t, self.now.y, self.now.solved, self.counts);
        let (method, model) = (&self.method, self.model());
        let switched = model.switch(t, &y, (Some(&solved), false), &mut |model| {
            method.solve(model, t, &y, &solved.lambda, &mut counts)
        })?;
        if let Some((parameters, solved)) = switched {
            self.parameters = parameters;
            (self.now.solved, self.now.carried) = (solved, solved.rate.qd);
        }
        self.counts = counts;
        Ok(())
    }

    /// The first time (s) of a step, up to `end` (s), at which an event begins or ends.
    #[inline(never)]
    pub(super) fn event(
        &self,
        model: &Model<'_, S, R, N, M>,
        ahead: &AheadOf<S, R, N, M>,
        end: R,
    ) -> Result<Option<R>, Failure> {
        let (start, from) = (ahead.times().0, &ahead.from.instant);
        let lambda = from.solved.lambda;
        model.first_event((start, end), self.scrutiny.resolution, |t, first, values| {
            let y = ahead.at(t);
            model.moved(start, t, |model| {
                let solved = match S::EVENTS_USE_ACCELERATIONS {
                    true => self.method.solve(model, t, &y, &lambda, &mut Counts::default()).map(Some),
                    false => Ok(None),
                };
                match solved {
                    Ok(solved) => model.event_values((t, &y), solved.as_ref(), (first, values)),
                    Err(_) => values.fill(R::constant(f64::NAN)),
                }
            });
        })
    }
}
