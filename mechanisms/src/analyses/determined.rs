//! What of the loads of an instant is determined, and what is one choice of many.

use mbs_runtime::dynamics::Determinacy;
use mbs_runtime::{Dynamic, Entry, Failure, Motion};

use crate::motion::Forces;

/// Adds to `forces`, whose last instant is at `position` and `t` (s), which of its loads and multipliers `motion` does not
/// determine.
pub(crate) fn push<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    forces: &mut Forces,
    mechanism: &S,
    (parameters, position): (&S::Parameters, &S::Position),
    t: f64,
    motion: &Motion<'_, f64, N, M, S::States>,
) -> Result<(), Failure> {
    let found = Determinacy::of(mechanism, parameters, position, t)?;
    let mut loads = vec![true; S::LOADS.len()];
    if !found.is_whole() {
        found.mark_loads(mechanism, parameters, position, motion, &mut loads);
    }
    forces.push_determinacy(&loads, &found.unique, &found.dependent_rows().collect::<Vec<Entry>>());
    Ok(())
}
