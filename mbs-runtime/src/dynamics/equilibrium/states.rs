//! First-order states at rest.

use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::linear_systems::integrals::{is_held, is_solved};
use crate::dynamics::linear_systems::states::eliminate;
use crate::dynamics::model::Model;
use crate::dynamics::model::method::require_slopes_at_rest;
use crate::dynamics::model::metric::Metric;
use crate::failure::Failure;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// First-order states (of the text) in equilibrium with the coordinates `q` (N) at rest at time `t` (s): ż = 0. `lambda` (M): the
/// multipliers, where rates depend on them. A state whose rate does not depend on it stays at its start value. Its value at an
/// equilibrium of forces is given by [`equilibrium_with_states`](crate::dynamics::equilibrium::equilibrium_with_states).
///
/// # Errors
/// [`NonFinite`](crate::FailureKind::NonFinite); [`NoStateEquilibrium`](crate::FailureKind::NoStateEquilibrium) with a state that has no rest: its rate does not vanish, or does not depend on it;
/// [`NotSmooth`](crate::FailureKind::NotSmooth).
pub fn states_at_rest<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    q: &[R; N],
    lambda: &[R; M],
) -> Result<S::States, Failure> {
    if const { !S::STATES.is_empty() } {
        require_slopes_at_rest::<S, R, N, M>()?;
    }
    let (zero, parameters) = (R::constant(0.0), mechanism.parameters());
    let metric = Metric::next_to(mechanism, &parameters, t, q);
    let model = Model::of_states(mechanism, &parameters, &metric);
    let mut y =
        IntegratorState { q: *q, qd: [zero; N], states: mechanism.start_states(&parameters), work: zero };
    model.check(t, &y)?;
    model.settle_states(t, &mut y, lambda)?;
    model.require_integrated(t, &y, lambda)?;
    Ok(y.states)
}

/// Of each first-order state 1 where its rate is 0 at rest whatever it and the coordinates are, so that it stays as it is; 0 of the others.
pub(crate) fn resting_anywhere<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
    lambda: &[R; M],
) -> S::States {
    let (mechanism, position) = (model.mechanism, model.position(t, y));
    let mut resting = y.states;
    resting.as_mut().iter_mut().for_each(|resting| *resting = R::constant(0.0));
    let slopes = mechanism.state_slopes(model.parameters, &position, &y.qd, &y.states, lambda);
    let Some(text) = slopes else { return resting };
    let (mut slopes, mut rates) = (text, resting);
    let column_of = eliminate(&mut slopes, &mut rates);
    let held = slopes.as_ref().iter().zip(text.as_ref()).map(|(row, text)| is_held(row, text));
    let places = resting.as_mut().iter_mut().zip(held.zip(column_of.as_ref())).enumerate();
    for (place, (resting, (held, column))) in places {
        if held && *column < R::constant(0.0) && !is_solved(place, &column_of) {
            *resting = R::constant(1.0);
        }
    }
    resting
}
