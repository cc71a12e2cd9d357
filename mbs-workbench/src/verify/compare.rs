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
    let mut values = kinematic_values(mechanism, &found);
    values.extend(mass_values(mechanism, &masses));
    let (agreement, missed) = against_casadi(mechanism, &values, &answer, samples.len(), None)?;
    if missed.is_empty() || missed.len() > MOST_DECIDED {
        return Ok(agreement);
    }
    // Conditions of such states are large: CasADi's own rounding may be what differs.
    let chosen: Vec<_> = missed.iter().filter_map(|state| samples.get(*state).cloned()).collect();
    let precise = oracle.evaluate_precisely(definition, &chosen)?;
    let judge = Judge { states: &missed, precise: &precise };
    Ok(against_casadi(mechanism, &values, &answer, samples.len(), Some(&judge))?.0)
}

/// States with values beyond the bound that 50 digits decide at most: a slip shows at many.
const MOST_DECIDED: usize = 20;

/// CasADi's expressions in 50 digits.
struct Judge<'a> {
    /// Their states.
    states: &'a [usize],
    /// Values, one line a state.
    precise: &'a Answer<Precise>,
}

/// Emitted values with their layout and [`CANCELLED`] where it holds.
type Selected = Vec<(Values, Layout, f64)>;

fn kinematic_values(mechanism: &dyn AnyEquations, found: &[Functions]) -> Selected {
    layouts(mechanism).into_iter().map(|layout| (layout.select(found), layout, 0.0)).collect()
}

fn mass_values(mechanism: &dyn AnyEquations, masses: &[Masses]) -> Selected {
    mass_layouts(mechanism)
        .into_iter()
        .map(|layout| (layout.select_mass(masses), layout, CANCELLED))
        .collect()
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

/// Agreement with CasADi, and the states with values beyond the bound.
fn against_casadi(
    mechanism: &dyn AnyEquations,
    values: &Selected,
    answer: &Answer<f64>,
    states: usize,
    judge: Option<&Judge<'_>>,
) -> Result<(Agreement, Vec<usize>), OracleError> {
    let mut agreement = nothing(mechanism, Reference::Casadi, states);
    let mut missed = Vec::new();
    for (values, layout, cancelled) in values {
        let expected = layout.table(answer, states)?;
        let scales = scales(layout, expected, *cancelled);
        let precise = judge.map(|judge| layout.table(judge.precise, judge.states.len())).transpose()?;
        let mut decisions = Vec::new();
        let quantity = layout.compared(values, expected, |(state, entry), emitted, oracle| {
            let (oracle, scale) = (oracle.copied(), scales[layout.row(entry)]);
            let mut error = relative_error(emitted, oracle, scale)?;
            if error > Reference::Casadi.bound() {
                missed.push(state);
                let place = judge.and_then(|judge| judge.states.iter().position(|known| *known == state));
                let exact = place.zip(precise).and_then(|(place, table)| table[place][entry]);
                if let Some((emitted, exact)) = emitted.zip(exact)
                    && let Some(decision) = layout.decision((state, entry), error, emitted, exact)
                {
                    error = decision.share.min(1.0) * Reference::Casadi.bound()
                        + f64::from(decision.share > 1.0) * error;
                    decisions.push(decision);
                }
            }
            Some(Measured { error, oracle, scale })
        });
        agreement.add(quantity);
        agreement.decisions.append(&mut decisions);
    }
    missed.sort_unstable();
    missed.dedup();
    Ok((agreement, missed))
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
        agreement.add(
            layout.compared(&layout.select(found), expected, |_, emitted, oracle| {
                rounding_error(emitted, oracle)
            }),
        );
    }
    Ok(agreement)
}

fn nothing(mechanism: &dyn AnyEquations, reference: Reference, states: usize) -> Agreement {
    Agreement {
        mechanism: mechanism.full_name(),
        reference,
        states,
        values: 0,
        functions: Vec::new(),
        compared: Vec::new(),
        decisions: Vec::new(),
    }
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
