//! Emitted values against an oracle's, entry by entry.

use super::agreement::{Agreement, ROUNDINGS, Reference};
use super::layout::{Layout, Measured, check_sizes, emitted, emitted_masses, layouts, mass_layouts};
use super::oracle::{Answer, Oracle, OracleError, Precise, Values};
use super::states::draw;
use crate::erased::facade::{AnyEquations, Functions};
use crate::erased::masses::Masses;

/// Compares a mechanism with a definition (Python text) that CasADi differentiates, at `states` random states.
///
/// The mechanism's parameters are taken as nominal and left at the last state's.
///
/// # Errors
/// [`OracleError`] where CasADi fails or its answer has another shape.
pub fn compare(
    mechanism: &mut dyn AnyEquations,
    oracle: &Oracle,
    definition: &str,
    states: usize,
) -> Result<Agreement, OracleError> {
    let samples = draw(mechanism, states);
    let answer = oracle.evaluate(definition, &samples)?;
    check_sizes(mechanism, &answer)?;
    let found: Vec<Functions> = samples.iter().map(|sample| emitted(mechanism, sample)).collect();
    let masses: Vec<Masses> = samples.iter().filter_map(|sample| emitted_masses(mechanism, sample)).collect();
    against_casadi(mechanism, &found, &masses, &answer)
}

/// Compares a mechanism with a definition (Python text) that is evaluated in 50 digits, at `states` random states.
///
/// Values for which rounding decides on the side of a kink are left out. The mechanism's parameters are taken as nominal
/// and left at the last state's.
///
/// # Errors
/// [`OracleError`] where mpmath fails or its answer has another shape.
pub fn compare_digits(
    mechanism: &mut dyn AnyEquations,
    oracle: &Oracle,
    definition: &str,
    states: usize,
) -> Result<Agreement, OracleError> {
    let samples = draw(mechanism, states);
    let answer = oracle.evaluate_digits(definition, &samples)?;
    check_sizes(mechanism, &answer)?;
    let found: Vec<Functions> = samples.iter().map(|sample| emitted(mechanism, sample)).collect();
    against_digits(mechanism, &found, &answer)
}

fn against_casadi(
    mechanism: &dyn AnyEquations,
    found: &[Functions],
    masses: &[Masses],
    answer: &Answer<f64>,
) -> Result<Agreement, OracleError> {
    let mut agreement = nothing(mechanism, Reference::Casadi, found.len());
    let kinematics = layouts(mechanism).into_iter().map(|layout| (layout.select(found), layout, 0.0));
    let dynamics =
        mass_layouts(mechanism).into_iter().map(|layout| (layout.select_mass(masses), layout, CANCELLED));
    for (values, layout, cancelled) in kinematics.chain(dynamics) {
        let expected = layout.table(answer, found.len())?;
        let scales = scales(&layout, expected, cancelled);
        let (largest, compared) = layout.largest_error(&values, expected, |entry, emitted, oracle| {
            let (oracle, scale) = (oracle.copied(), scales[layout.row(entry)]);
            Some(Measured { error: relative_error(emitted, oracle, scale)?, oracle, scale })
        });
        agreement.functions.extend(largest);
        agreement.values += compared;
    }
    Ok(agreement)
}

/// Differences of emitted functions from the oracle's 50 digits at the same states.
///
/// # Errors
/// [`OracleError::Answer`] where the answer has another shape.
pub fn against_digits(
    mechanism: &dyn AnyEquations,
    found: &[Functions],
    answer: &Answer<Precise>,
) -> Result<Agreement, OracleError> {
    let mut agreement = nothing(mechanism, Reference::Digits, found.len());
    for layout in layouts(mechanism) {
        let expected = layout.table(answer, found.len())?;
        let (largest, compared) =
            layout.largest_error(&layout.select(found), expected, |_, emitted, oracle| {
                rounding_error(emitted, oracle)
            });
        agreement.functions.extend(largest);
        agreement.values += compared;
    }
    Ok(agreement)
}

fn nothing(mechanism: &dyn AnyEquations, reference: Reference, states: usize) -> Agreement {
    Agreement { mechanism: mechanism.full_name(), reference, states, values: 0, functions: Vec::new() }
}

/// Part of a function's largest value below which a whole row is a rounding residue of terms that cancel. Example: inertia forces
/// of a body that rotates about a fixed point cancel along its angle, and CasADi's row is not 0 either.
const CANCELLED: f64 = 64.0 * f64::EPSILON;

/// Largest absolute value of each row over the states; of the whole function where all of the row has cancelled.
fn scales(layout: &Layout, expected: &Values, cancelled: f64) -> Vec<f64> {
    let mut scales = vec![0.0_f64; layout.rows()];
    for (entry, value) in expected.iter().flat_map(|values| values.iter().enumerate()) {
        let scale = &mut scales[layout.row(entry)];
        *scale = scale.max(value.unwrap_or(0.0).abs());
    }
    let largest = scales.iter().copied().fold(0.0, f64::max);
    let measured = |scale: f64| if scale < cancelled * largest { largest } else { scale };
    scales.into_iter().map(measured).collect()
}

/// `|emitted − oracle| / scale`; infinite if it is NaN or only one side has the value.
fn relative_error(emitted: Option<f64>, oracle: Option<f64>, scale: f64) -> Option<f64> {
    let (emitted, oracle) = match (emitted, oracle) {
        (None, None) => return None,
        (Some(emitted), Some(oracle)) => (emitted, oracle),
        _ => return Some(f64::INFINITY),
    };
    if emitted == oracle && emitted.is_finite() {
        return Some(0.0);
    }
    Some(part((emitted - oracle).abs(), scale))
}

/// The difference over the bound of rounding errors; infinite if it is NaN or only one side has the value.
fn rounding_error(emitted: Option<f64>, oracle: Option<&Precise>) -> Option<Measured> {
    let (emitted, precise) = match (emitted, oracle) {
        (None, None) => return None,
        (Some(emitted), Some(precise)) => (emitted, precise),
        (_, oracle) => {
            let oracle = oracle.map(|precise| precise.value);
            return Some(Measured { error: f64::INFINITY, oracle, scale: 0.0 });
        }
    };
    let scale = ROUNDINGS * f64::EPSILON / 2.0 * precise.bound?;
    // The first difference is exact where the values are near each other.
    let difference = ((emitted - precise.value) - precise.rest).abs();
    let error = if difference == 0.0 { 0.0 } else { part(difference, scale) };
    Some(Measured { error, oracle: Some(precise.value), scale })
}

fn part(difference: f64, scale: f64) -> f64 {
    let error = difference / scale;
    if error.is_nan() { f64::INFINITY } else { error }
}

#[cfg(test)]
mod tests;
