//! Modes of frictions with stiction and of rigid contacts along a run: decided where a step begins, and ended where one changes.

use crate::dynamics::first_order_form::equations::{Equations, Moving};
use crate::dynamics::formulations::set_valued::impact::Struck;
use crate::dynamics::integrators::event::Dense;
use crate::dynamics::model::{Formulation, Model};
use crate::failure::Failure;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

impl<S, F, R, const N: usize, const M: usize> Equations<'_, S, F, R, N, M>
where
    S: Dynamic<R, N, M>,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    /// Evaluates all contacts, as at an instant by itself.
    pub(crate) fn with_all_contacts(&mut self) {
        if const { !S::CONTACTS.is_empty() } {
            let all = *self.model.parameters;
            let with_modes_of = |parameters| Model { parameters, ..*self.model }.with_modes_of(all);
            self.parameters = self.parameters.as_ref().map(with_modes_of);
        }
    }

    /// The parameters of the last step, where they may change.
    pub(crate) fn parameters(&self) -> Option<S::Parameters> {
        self.parameters
    }

    /// Impacts, events and modes of frictions where a step begins, in this order; `true` if anything changes. `anew`: contacts have changed.
    pub(super) fn settle_modes(
        &mut self,
        t: R,
        y: &mut Moving<S, R, N, M>,
        anew: bool,
    ) -> Result<bool, Failure> {
        let struck = anew | self.strike(t, y)?;
        let switched = struck | self.switch(t, y, struck)?;
        Ok(switched | self.decide(t, y, switched)?)
    }

    /// The first time (s) of a step, before `first` where that is known, at which an event begins or ends or a friction changes its mode.
    pub(super) fn change_of_modes(
        &mut self,
        step: &impl Dense<R, State = Moving<S, R, N, M>>,
        (start, end): (R, R),
        first: Option<R>,
    ) -> Result<Option<R>, Failure> {
        let mut first = first;
        if const { !S::EVENTS.is_empty() } {
            first = self.event(step, (start, end))?.or(first);
        }
        if const { S::SET_VALUED.is_empty() } {
            return Ok(first);
        }
        Ok(self.slip(step, (start, first.unwrap_or(end)))?.or(first))
    }

    /// `true` if a contact closes at `y`.
    pub(crate) fn strikes(&mut self, t: R, y: &Moving<S, R, N, M>) -> bool {
        if const { !S::HAS_RIGID_CONTACTS } || self.model.first_order {
            return false;
        }
        self.at(t, &y.phases, |model, _, _, _| model.strikes(t, &y.y))
    }

    /// The impacts of contacts that close at `y`; `true` if there are any.
    #[inline(never)]
    fn strike(&mut self, t: R, y: &mut Moving<S, R, N, M>) -> Result<bool, Failure> {
        if const { !S::HAS_RIGID_CONTACTS } || self.model.first_order {
            return Ok(false);
        }
        let struck = self.at(t, &y.phases, |model, formulation, lambda, counts| {
            model.impact(t, &y.y, counts, |model, y, counts| formulation.solve(model, t, y, lambda, counts))
        })?;
        let Some(Struck { y: next, parameters, gained }) = struck else { return Ok(false) };
        let of = Model { parameters: &parameters, ..*self.model };
        self.parameters = self.parameters.map(|parameters| of.with_modes_of(parameters));
        (y.y, self.end.y, self.gained) = (next, next, self.gained + gained);
        Ok(true)
    }

    /// Modes of the frictions from `y` on; `true` if they change. `anew`: contacts have changed, so that the last rates do not count. The
    /// parts of a step of fixed size keep its modes.
    #[inline(never)]
    fn decide(&mut self, t: R, y: &Moving<S, R, N, M>, anew: bool) -> Result<bool, Failure> {
        if const { S::SET_VALUED.is_empty() } || self.model.first_order {
            return Ok(false);
        }
        let rate = if anew { Some(self.solve(t, y)?) } else { None };
        let known = rate.unwrap_or(self.end.solved);
        let decided = self.at(t, &y.phases, |model, formulation, lambda, counts| {
            model
                .decide(t, &y.y, Some(&known), &mut |model| formulation.solve(model, t, &y.y, lambda, counts))
        })?;
        let Some((modes, solved)) = decided else { return Ok(false) };
        let of = Model { parameters: &modes, ..*self.model };
        self.parameters = self.parameters.map(|parameters| of.with_modes_of(parameters));
        self.lambda = solved.lambda;
        self.end.solved = solved;
        Ok(true)
    }

    /// The first time (s) of a step at which a friction changes its mode.
    #[inline(never)]
    fn slip(
        &mut self,
        step: &impl Dense<R, State = Moving<S, R, N, M>>,
        times: (R, R),
    ) -> Result<Option<R>, Failure> {
        let (model, resolution) = (self.model, self.scrutiny.resolution);
        self.apart(|equations| {
            model.first_slip(times, resolution, |t, first, values| {
                let y = step.at(t);
                equations.at(t, &y.phases, |model, formulation, lambda, counts| {
                    let solved = if model.sticks() {
                        match formulation.solve(model, t, &y.y, lambda, counts) {
                            Ok(solved) => Some(solved),
                            Err(_) => return values.fill(R::constant(f64::NAN)),
                        }
                    } else {
                        None
                    };
                    model.slip_values((t, &y.y), solved.as_ref(), (first, values));
                });
            })
        })
    }
}
