//! Loads of a single state.

use mbs_runtime::Dynamic;
use mbs_runtime::dynamics::{self, Counts, Formulation, Metric, Model, Unstabilized};

use crate::erased::facade::State;
use crate::erased::masses::Loads;

/// Multipliers of `state` from M q̈ + Φ_qᵀ λ = Q with Φ_q q̈ = γ.
pub(super) fn multipliers<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    state: &State,
) -> Result<Loads, String> {
    let array =
        |values: &[f64]| <[f64; N]>::try_from(values).map_err(|_| format!("{N} coordinates are needed"));
    let (q, qd) = (array(&state.q)?, array(&state.qd)?);
    if let Some(unknown) = S::STATES.first().filter(|_| state.t != 0.0) {
        return Err(format!(
            "forces depend on the state `{}`, which is known at its start alone",
            unknown.name
        ));
    }
    let mut mechanism = mechanism.clone();
    mechanism.start_phases(&q, state.t);
    let parameters = mechanism.parameters();
    let metric = Metric::next_to(&mechanism, &parameters, state.t, &q);
    let model = Model::of_states(&mechanism, &parameters, &metric);
    let y = dynamics::IntegratorState { q, qd, states: mechanism.start_states(&parameters), work: 0.0 };
    let solved = Unstabilized.solve(&model, state.t, &y, &[0.0; M], &mut Counts::default());
    let solved = solved.map_err(|failure| failure.to_string())?;
    Ok(Loads { states: y.states.as_ref().to_vec(), lambda: solved.lambda.to_vec() })
}
