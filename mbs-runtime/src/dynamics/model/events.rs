//! Events of a text: where they begin and end, and the values that they set.

use crate::dynamics::integrators::event::Scrutiny;
use crate::dynamics::integrators::event::group::{Filled, GROUP, first_beyond};
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::{Model, Solved};
use crate::failure::{Failure, FailureKind, checks};
use crate::mechanism::dynamic::{Dynamic, DynamicState};
use crate::mechanism::event::{Condition, Event};
use crate::mechanism::{Entry, Mechanism};
use crate::scalar::number::Real;
use crate::tolerances::motion;

/// Changes of events at one instant, each of them: more switch each other without end.
const CHANGES_OF_AN_EVENT: usize = 2;

/// Parameters after begins and ends of events, with the rates that belong to them.
pub(crate) type Switched<S, R, const N: usize, const M: usize> =
    (<S as Mechanism<R, N, M>>::Parameters, Solved<R, N, M, <S as Dynamic<R, N, M>>::States>);

/// An index as the tables of a text have it.
fn number(index: usize) -> u16 {
    u16::try_from(index).unwrap_or(u16::MAX)
}

impl<R: Real> Condition<R> {
    /// Positive where it holds.
    fn excess(&self) -> R {
        self.larger - self.smaller
    }

    /// Positive as long as it does not hold, by more than rounding.
    fn margin(&self) -> R {
        self.rounding() - self.excess()
    }

    fn rounding(&self) -> R {
        motion::NO_VALUE.of::<R>() * (self.larger.abs() + self.smaller.abs())
    }
}

impl<R: Real> Event<R> {
    /// Positive where it changes: one that rests begins where its condition holds and its end does not.
    fn excess(&self, rests: bool) -> Option<R> {
        let zero = R::constant(0.0);
        match self.ends {
            ends if !rests => ends.map(|ends| ends.excess()),
            Some(ends) if zero < ends.excess() => Some(self.begins.excess().min(zero)),
            _ => Some(self.begins.excess()),
        }
    }

    /// Positive as long as it does not change, by more than rounding.
    fn margin(&self, rests: bool) -> Option<R> {
        match self.ends {
            ends if !rests => ends.map(|ends| ends.margin()),
            Some(ends) if ends.excess().is_finite() => {
                Some(self.begins.margin().max(ends.excess() + ends.rounding()))
            }
            _ => Some(self.begins.margin()),
        }
    }
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Shows `see` the events of a state. `solved`: its rates, which accelerations and multipliers of conditions are those of.
    fn watch(
        &self,
        (t, y): (R, &IntegratorState<R, N, S::States>),
        solved: Option<&Solved<R, N, M, S::States>>,
        see: impl FnOnce(&[Event<R>], &[R]),
    ) {
        let zero = R::constant(0.0);
        let position = self.position(t, y);
        let (qdd, lambda) = solved.map_or(([zero; N], [zero; M]), |solved| (solved.rate.qd, solved.lambda));
        let held = solved.map(|_| self.with_set_valued_forces(&position, y, (&qdd, &lambda)));
        let parameters = held.as_ref().unwrap_or(self.parameters);
        let motion = DynamicState { qd: &y.qd, qdd: &qdd, lambda: &lambda, states: &y.states };
        self.mechanism.events(parameters, &position, &motion, see);
    }

    /// Functions of a state at `t` (s) from `first` on that are positive as long as no event begins or ends.
    pub(crate) fn event_values(
        &self,
        state: (R, &IntegratorState<R, N, S::States>),
        solved: Option<&Solved<R, N, M, S::States>>,
        (first, values): (usize, &mut [R; GROUP]),
    ) {
        let (one, zero) = (R::constant(1.0), R::constant(0.0));
        self.watch(state, solved, |events, _| {
            let events = events.iter().zip(S::remembered(self.parameters)).skip(first);
            for (value, (event, holds)) in values.iter_mut().zip(events) {
                *value = event.margin(*holds == zero).unwrap_or(one);
            }
        });
    }

    /// The first time (s) between two times at which an event begins or ends; after it by rounding. `fill` gives
    /// [`event_values`](Self::event_values) at a time.
    ///
    /// # Errors
    /// [`FailureKind::NonFinite`] with the event.
    pub(crate) fn first_event(
        &self,
        times: (R, R),
        resolution: Option<R>,
        fill: impl FnMut(R, usize, &mut [R; GROUP]),
    ) -> Result<Option<R>, Failure> {
        let scrutiny = Scrutiny { resolution, ..Scrutiny::beyond() };
        match first_beyond(&mut Filled { count: S::EVENTS.len(), scrutiny, fill }, times) {
            Ok(found) => Ok(found.map(|(_, t)| t)),
            Err((member, _)) => {
                let Entry { name, line, .. } = checks::entry(S::EVENTS, number(member));
                Err(FailureKind::NonFinite { name, line: *line }.without_time())
            }
        }
    }

    /// The values that events set at a state, where they are not those of the model: of all events whose condition holds the first one
    /// of the text changes, then rates are solved anew. `starts`: every value is latched. `solve` gives the rates.
    ///
    /// # Errors
    /// [`FailureKind::Chatter`] where events switch each other without end; those of `solve`.
    pub(crate) fn switch(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        (known, starts): (Option<&Solved<R, N, M, S::States>>, bool),
        solve: &mut impl FnMut(&Model<'_, S, R, N, M>) -> Result<Solved<R, N, M, S::States>, Failure>,
    ) -> Result<Option<Switched<S, R, N, M>>, Failure> {
        let mut parameters = *self.parameters;
        let mut solved = match known {
            Some(known) => *known,
            None => solve(self)?,
        };
        if starts {
            self.watch((t, y), Some(&solved), |_, latched| {
                let kept = S::remembered_mut(&mut parameters).iter_mut().skip(S::EVENTS.len());
                kept.zip(latched).for_each(|(kept, latched)| *kept = *latched);
            });
            solved = solve(&Model { parameters: &parameters, ..*self })?;
        }
        let mut changed = starts;
        let mut last = 0;
        for _ in 0..=CHANGES_OF_AN_EVENT * S::EVENTS.len() {
            let model = Model { parameters: &parameters, ..*self };
            let mut next = parameters;
            let Some(event) = model.change((t, y), &solved, &mut next)? else {
                return Ok(changed.then_some((parameters, solved)));
            };
            (parameters, changed, last) = (next, true, event);
            solved = solve(&Model { parameters: &parameters, ..*self })?;
        }
        let parts = u32::try_from(CHANGES_OF_AN_EVENT * S::EVENTS.len()).unwrap_or(u32::MAX);
        Err(FailureKind::Chatter { entry: checks::entry(S::EVENTS, number(last)), parts }.at(t.to_f64()))
    }

    /// Before: `next` is as the model's parameters. After: the first event that changes has changed there; its index.
    pub(crate) fn change(
        &self,
        (t, y): (R, &IntegratorState<R, N, S::States>),
        solved: &Solved<R, N, M, S::States>,
        next: &mut S::Parameters,
    ) -> Result<Option<usize>, Failure> {
        let (one, zero) = (R::constant(1.0), R::constant(0.0));
        let (mut found, mut undefined) = (None, None);
        self.watch((t, y), Some(solved), |events, latched| {
            for (index, (event, holds)) in events.iter().zip(S::remembered(self.parameters)).enumerate() {
                let rests = *holds == zero;
                let Some(excess) = event.excess(rests) else { continue };
                if !excess.is_finite() {
                    undefined = Some(index);
                    return;
                }
                if !zero.less(excess) {
                    continue;
                }
                let memory = S::remembered_mut(next);
                memory.iter_mut().skip(index).take(1).for_each(|on| *on = if rests { one } else { zero });
                let kept = memory.iter_mut().skip(S::EVENTS.len()).zip(latched).zip(S::LATCHED_BY);
                for ((kept, latched), _) in kept.filter(|(_, event)| rests && usize::from(**event) == index) {
                    *kept = *latched;
                }
                found = Some(index);
                return;
            }
        });
        match undefined {
            Some(index) => {
                let Entry { name, line, .. } = checks::entry(S::EVENTS, number(index));
                Err(FailureKind::NonFinite { name, line: *line }.at(t.to_f64()))
            }
            None => Ok(found),
        }
    }
}
