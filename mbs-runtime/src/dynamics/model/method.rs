//! Contract of a method of integration for mechanisms.

use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::forward::forward;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::{Counts, MethodWarning, Model, Solved};
use crate::failure::{Failure, FailureKind};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// Fails where a text has functions that are not smooth enough for a [`Tangent`].
///
/// # Errors
/// [`FailureKind::NotSmooth`].
pub(crate) fn require_smooth<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>()
-> Result<(), Failure> {
    S::MISSING_SLOPE.map_or(Ok(()), |missing| Err(FailureKind::NotSmooth { missing }.without_time()))
}

/// Fails where a text has friction with stiction or events: outside a motion that knows whether it sticks or slides, and what has begun.
///
/// # Errors
/// [`FailureKind::SetValuedForce`], [`FailureKind::EventOfMotion`].
pub(crate) fn require_no_stiction<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>()
-> Result<(), Failure> {
    match (S::SET_VALUED.first(), S::EVENTS.first()) {
        (Some(friction), _) => Err(FailureKind::SetValuedForce { row: friction }.without_time()),
        (None, Some(event)) => Err(FailureKind::EventOfMotion { event }.without_time()),
        (None, None) => Ok(()),
    }
}

/// [`require_smooth_at_rest`] of an analysis that knows no modes.
///
/// # Errors
/// [`FailureKind::NotSmooth`], [`FailureKind::SetValuedForce`], [`FailureKind::EventOfMotion`].
pub(crate) fn require_slopes_at_rest<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>()
-> Result<(), Failure> {
    require_no_stiction::<S, R, N, M>()?;
    require_smooth_at_rest::<S, R, N, M>()
}

/// [`require_smooth`] of a position of rest: ∂Q/∂q̇ has no part in it.
///
/// # Errors
/// [`FailureKind::NotSmooth`].
pub(crate) fn require_smooth_at_rest<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>()
-> Result<(), Failure> {
    let missing = S::MISSING_SLOPE.filter(|missing| missing.acts_at_rest);
    missing.map_or(Ok(()), |missing| Err(FailureKind::NotSmooth { missing }.without_time()))
}

/// A step that has gone over impacts and changes of modes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteppedInModes<R, P, const N: usize, const M: usize, Z> {
    /// The instant at its end.
    pub next: Instant<R, N, M, Z>,
    /// Parameters with the modes at its end; `None` where they are those of its start.
    pub parameters: Option<P>,
    /// Energy (J) that impacts brought in: none, or less.
    pub gained: R,
}

/// A way to move on: integrator and formulation in one.
pub trait Method<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    /// Accelerations and multipliers at a state.
    ///
    /// # Errors
    /// Those of [`Formulation::solve`](crate::dynamics::Formulation::solve).
    fn solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure>;

    /// One step of `h` (s), positive.
    ///
    /// # Errors
    /// Those of [`Formulation::solve`](crate::dynamics::Formulation::solve) and [`Formulation::project`](crate::dynamics::Formulation::project); [`FailureKind::EquilibriumNotConverged`] of implicit methods.
    fn step(
        &self,
        model: &Model<'_, S, R, N, M>,
        from: &Instant<R, N, M, S::States>,
        h: R,
        counts: &mut Counts,
    ) -> Result<Instant<R, N, M, S::States>, Failure>;

    /// `true` of a method whose steps go over impacts and changes of modes, by [`step_in_modes`](Self::step_in_modes). Other methods end a step
    /// where one is.
    fn steps_over_modes(&self) -> bool {
        false
    }

    /// [`step`](Self::step) with the modes in which it ends, where [`steps_over_modes`](Self::steps_over_modes).
    ///
    /// # Errors
    /// Those of [`step`](Self::step); [`FailureKind::ImpactUndecided`], [`FailureKind::ContactUndecided`] and
    /// [`FailureKind::StickingUndecided`] where no forces of contacts and frictions are found.
    fn step_in_modes(
        &self,
        model: &Model<'_, S, R, N, M>,
        from: &Instant<R, N, M, S::States>,
        h: R,
        counts: &mut Counts,
    ) -> Result<SteppedInModes<R, S::Parameters, N, M, S::States>, Failure> {
        let next = self.step(model, from, h, counts)?;
        Ok(SteppedInModes { next, parameters: None, gained: R::constant(0.0) })
    }

    /// The phases of drives that prescribe a rate after a step of `h` from `t` (s); none where they are those of
    /// [`Mechanism::advance_phases`](crate::Mechanism::advance_phases).
    ///
    /// # Errors
    /// None but those of its calls.
    fn phases_after(
        &self,
        _model: &Model<'_, S, R, N, M>,
        _t: R,
        _h: R,
    ) -> Result<Option<S::Phases>, Failure> {
        Ok(None)
    }

    /// See [`Formulation::require_suitable`](crate::dynamics::Formulation::require_suitable).
    ///
    /// # Errors
    /// [`FailureKind::InvalidMethodParameter`]; [`FailureKind::NotSmooth`] of a method that needs derivatives of the forces.
    fn require_suitable(&self) -> Result<(), Failure> {
        Ok(())
    }

    /// See [`Formulation::check_step`](crate::dynamics::Formulation::check_step).
    ///
    /// # Errors
    /// [`FailureKind::StepTooLong`].
    fn check_step(&self, _h: R, _t: R) -> Result<(), Failure> {
        Ok(())
    }

    /// See [`Formulation::leaves_constraints`](crate::dynamics::Formulation::leaves_constraints).
    fn leaves_constraints(&self) -> bool {
        false
    }

    /// See [`Formulation::doubt`](crate::dynamics::Formulation::doubt).
    fn doubt(&self, _h: R, _span: R) -> Option<MethodWarning> {
        None
    }
}

/// A reference has the behaviour of its target, which may be known at run time only.
impl<S, R, X, const N: usize, const M: usize> Method<S, R, N, M> for &X
where
    S: Dynamic<R, N, M>,
    R: Real,
    X: Method<S, R, N, M> + ?Sized,
{
    forward! { |it| **it => solve, step, steps_over_modes, step_in_modes, phases_after, require_suitable, check_step, leaves_constraints, doubt }
}
