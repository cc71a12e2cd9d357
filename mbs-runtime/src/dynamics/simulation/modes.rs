//! Modes of frictions with stiction and of rigid contacts in a motion: decided where it starts, after changes, and between the parts of fixed steps.

use crate::dynamics::formulations::projection::Projection;
use crate::dynamics::formulations::set_valued::impact::Struck;
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::method::Method;
use crate::dynamics::model::{Counts, Formulation, Model};
use crate::dynamics::simulation::{Simulation, events};
use crate::failure::{Failure, FailureKind};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// Parts that frictions and contacts may cut a step of fixed size into, each of them, and at least.
const PARTS_OF_A_FRICTION: u32 = 16;
const LEAST_PARTS: u32 = 256;

/// Parameters with the modes of a state of which nothing but its position and velocity is known.
pub(super) fn anew<S, X, R, const N: usize, const M: usize>(
    method: &X,
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    counts: &mut Counts,
) -> Result<S::Parameters, Failure>
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    if const { S::SET_VALUED.is_empty() } {
        return Ok(*model.parameters);
    }
    let none = [R::constant(0.0); M];
    let decided = model.decide(t, y, None, &mut |model| method.solve(model, t, y, &none, counts))?;
    Ok(decided.map_or(*model.parameters, |(parameters, _)| parameters))
}

impl<S, X, R, const N: usize, const M: usize> Simulation<S, X, R, N, M>
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    /// Number of parts that frictions cut a step of fixed size into at most; 0 of a text without.
    pub(super) fn most_slips() -> u32 {
        let count = u32::try_from(S::SET_VALUED.len() + S::EVENTS.len()).unwrap_or(u32::MAX);
        if count == 0 { 0 } else { count.saturating_mul(PARTS_OF_A_FRICTION).max(LEAST_PARTS) }
    }

    /// Modes where parameters or inputs have changed.
    pub(super) fn decide_modes_anew(&mut self) -> Result<(), Failure> {
        if const { !S::HAS_MODES } || !self.stale {
            return Ok(());
        }
        if let Some(failure) = self.fault {
            return Err(failure);
        }
        let (t, mut y, mut counts) = (self.now.t, self.now.y, self.counts);
        let model = self.model();
        Projection::default().project(&model, t, &mut y, &mut counts)?;
        let parameters = events::anew(&self.method, &model, (t, &y), (&mut counts, false))?;
        let model = Model { parameters: &parameters, ..model };
        let parameters = match self.method.steps_over_modes() {
            true => model.released(t, &y)?,
            false => anew(&self.method, &model, (t, &y), &mut counts)?,
        };
        (self.parameters, self.counts) = (parameters, counts);
        Ok(())
    }

    /// Takes the modes of the last step.
    pub(super) fn take_modes(&mut self, parameters: Option<&S::Parameters>) {
        if const { S::HAS_MODES }
            && let Some(parameters) = parameters
        {
            self.parameters = Model { parameters, ..self.model() }.with_modes_of(self.parameters);
        }
    }

    /// Modes from the present instant on.
    pub(super) fn decide_modes(&mut self) -> Result<(), Failure> {
        if const { !S::HAS_MODES } {
            return Ok(());
        }
        self.decide_modes_anew()?;
        if self.stale {
            return Ok(());
        }
        if self.method.steps_over_modes() {
            return self.switch();
        }
        self.strike()?;
        self.switch()?;
        if const { S::SET_VALUED.is_empty() } {
            return Ok(());
        }
        let (t, y, solved, mut counts) = (self.now.t, self.now.y, self.now.solved, self.counts);
        let (method, model) = (&self.method, self.model());
        let decided = model.decide(t, &y, Some(&solved), &mut |model| {
            method.solve(model, t, &y, &solved.lambda, &mut counts)
        })?;
        if let Some((parameters, solved)) = decided {
            self.parameters = parameters;
            self.now.solved = solved;
            self.now.carried = solved.rate.qd;
        }
        self.counts = counts;
        Ok(())
    }

    /// The impacts of contacts that close at the present instant.
    fn strike(&mut self) -> Result<(), Failure> {
        if const { !S::HAS_RIGID_CONTACTS } {
            return Ok(());
        }
        let (t, y, lambda, mut counts) = (self.now.t, self.now.y, self.now.solved.lambda, self.counts);
        let method = &self.method;
        let struck = self
            .model()
            .impact(t, &y, &mut counts, |model, y, counts| method.solve(model, t, y, &lambda, counts))?;
        let Some(Struck { y, parameters, gained }) = struck else { return Ok(()) };
        let model = Model { parameters: &parameters, ..self.model() };
        let solved = method.solve(&model, t, &y, &lambda, &mut counts)?;
        (self.now.y, self.now.solved, self.now.carried) = (y, solved, solved.rate.qd);
        (self.parameters, self.counts, self.reference) = (parameters, counts, self.reference + gained);
        Ok(())
    }

    /// Fails where the last part of a step would go over changes of modes.
    pub(super) fn require_parts(&self, part: u32) -> Result<(), Failure> {
        match S::SET_VALUED.first().or(S::EVENTS.first()) {
            Some(friction) if Self::most_slips() <= part => {
                Err(FailureKind::Chatter { entry: friction, parts: part }.at(self.now.t.to_f64()))
            }
            _ => Ok(()),
        }
    }
}
