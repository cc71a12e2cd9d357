//! Determinacy of the loads of an instant: unique values, and minimum-norm choices among many.

use mbs_runtime::dynamics::Determinacy;
use mbs_runtime::{Dynamic, DynamicState, Entry, Failure};

use crate::motion::Forces;

/// Marks in `forces` the loads and multipliers that `motion` does not determine at the last instant, which is at `position` and
/// `t` (s).
pub(crate) fn push<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    forces: &mut Forces,
    mechanism: &S,
    (parameters, position): (&S::Parameters, &S::Position),
    t: f64,
    motion: &DynamicState<'_, f64, N, M, S::States>,
) -> Result<(), Failure> {
    let found = Determinacy::of(mechanism, parameters, position, t)?;
    let mut loads = vec![true; S::LOADS.len()];
    if !found.is_whole() {
        found.mark_loads(mechanism, parameters, position, motion, &mut loads);
    }
    forces.push_determinacy(&loads, &found.unique, &found.dependent_rows().collect::<Vec<Entry>>());
    Ok(())
}
