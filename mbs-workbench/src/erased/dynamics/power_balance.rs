//! The powers that forces, drives and the time supply in one instant.

use mbs_runtime::{Dynamic, DynamicState};

use crate::motion::Forces;
use crate::motion::power_balance::{PowerCurve, PowerSource};

/// Name and power (W) of each force, of each row, λ Φ_t, and of the time, if it supplies any. Their sum is the rate of kinetic
/// and potential energy.
pub(super) fn powers<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    (parameters, position): (&S::Parameters, &S::Position),
    motion: &DynamicState<'_, f64, N, M, S::States>,
) -> Vec<(&'static str, PowerSource, f64)> {
    let DynamicState { qd, qdd, lambda, states } = *motion;
    let powers = mechanism.powers(parameters, position, qd, states, lambda);
    let moving = mechanism.phi_t(parameters, position);
    let carried = mechanism.carried(parameters, position, qd, qdd);
    let of_forces = S::FORCES.iter().zip(powers.as_ref());
    let of_forces = of_forces.map(|(force, power)| (force.name, PowerSource::Force, *power));
    let of_rows = S::ROWS.iter().zip(lambda.iter().zip(&moving));
    let of_rows = of_rows.map(|(row, (lambda, rate))| (row.name, PowerSource::Drive, lambda * rate));
    let of_time = carried.map(|power| ("the time", PowerSource::Time, power));
    of_forces.chain(of_rows).chain(of_time).collect()
}

/// `true` for each of them that has power in some motion from the position `q`: no row whose Φ_t vanishes whatever the time.
pub(super) fn may_act<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    q: &[f64; N],
) -> Vec<bool> {
    // What depends on the time is no number where the time is none.
    let parameters = mechanism.parameters();
    let position = mechanism.position(&parameters, q, f64::NAN);
    let moving = mechanism.phi_t(&parameters, &position);
    let may_move = S::HAS_SIGNALS || !S::PHASES.is_empty();
    let rows = moving.iter().map(|rate| may_move || *rate != 0.0);
    S::FORCES.iter().map(|_| true).chain(rows).collect()
}

/// Adds the powers of an instant to `forces`.
pub(crate) fn push<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    forces: &mut Forces,
    mechanism: &S,
    at: (&S::Parameters, &S::Position),
    motion: &DynamicState<'_, f64, N, M, S::States>,
) {
    forces.push_powers(powers(mechanism, at, motion).into_iter());
}

/// Distinguishes rows of constraints that depend on the time from those of drives, by the text, if a row does work.
///
/// Before: every row counts as a drive. After: it has the kind that the text declares.
pub(crate) fn name_rows<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(forces: &mut Forces) {
    let acts = |supply: &PowerCurve| supply.by == PowerSource::Drive && !supply.is_idle();
    if !forces.supplies.iter().any(acts) {
        return;
    }
    let Ok(report) = mbs_codegen::structure_of(S::SOURCE, Some(S::SCENE)) else { return };
    let rows = forces.supplies.iter_mut().skip(S::FORCES.len());
    for (supply, _) in rows.zip(report.rows).filter(|(_, row)| !row.driven) {
        supply.by = PowerSource::Constraint;
    }
}
