//! Emitted values against CasADi's, entry by entry.

use core::fmt;

use mbs_runtime::OutputValue;

use super::oracle::{Answer, Oracle, OracleError, Values};
use super::states::{Sample, draw};
use crate::facade::{AnyMechanism, Functions};

/// Largest error allowed, as a part of the row's scale: a few hundred roundings of double precision.
pub const BOUND: f64 = 1e-13;

/// How well the emitted code of a mechanism agrees with the oracle.
#[derive(Clone, Debug)]
pub struct Agreement {
    /// Name of the mechanism.
    pub mechanism: &'static str,
    /// Number of states compared.
    pub states: usize,
    /// The largest error of each function.
    pub functions: Vec<LargestError>,
}

/// The largest error of one function over all states.
#[derive(Clone, Debug)]
pub struct LargestError {
    /// The function, as the lecture writes it.
    pub function: &'static str,
    /// The row, and for Φ_q the coordinate; or the output.
    pub entry: String,
    /// Index of the state.
    pub state: usize,
    /// Difference as a part of `scale`; infinite where either side is NaN or only one side has the derivative.
    pub error: f64,
    /// The emitted value.
    pub emitted: Option<f64>,
    /// The oracle's value.
    pub oracle: Option<f64>,
    /// Largest absolute value of the row over the states.
    pub scale: f64,
}

/// A function with its entries grouped in rows of one scale.
struct Layout {
    function: &'static str,
    key: &'static str,
    entries: Vec<String>,
    row_length: usize,
}

impl Agreement {
    /// Whether every error is within [`BOUND`].
    pub fn holds(&self) -> bool {
        self.functions.iter().all(|function| function.error <= BOUND)
    }

    /// The function with the largest error.
    pub fn worst(&self) -> Option<&LargestError> {
        self.functions.iter().max_by(|a, b| a.error.total_cmp(&b.error))
    }
}

/// Compares a mechanism with a definition (Python text) at `states` random states.
///
/// The mechanism's parameters are taken as nominal and left at the last state's.
///
/// # Errors
/// [`OracleError`] where CasADi fails or its answer has another shape.
pub fn compare(
    mechanism: &mut dyn AnyMechanism,
    oracle: &Oracle,
    definition: &str,
    states: usize,
) -> Result<Agreement, OracleError> {
    let samples = draw(mechanism, states);
    let answer = oracle.evaluate(definition, &samples)?;
    check_sizes(mechanism, &answer)?;
    let emitted: Vec<Functions> = samples.iter().map(|sample| emitted(mechanism, sample)).collect();
    let mut functions = Vec::new();
    for layout in layouts(mechanism) {
        let expected = table(&answer, &layout, states)?;
        let found: Vec<Vec<Option<f64>>> = emitted.iter().map(|e| select(e, layout.key)).collect();
        functions.extend(largest_error(&layout, &found, expected));
    }
    Ok(Agreement { mechanism: mechanism.type_name(), states, functions })
}

fn emitted(mechanism: &mut dyn AnyMechanism, sample: &Sample) -> Functions {
    for (index, value) in sample.variables.iter().enumerate() {
        mechanism.set(index, *value);
    }
    mechanism.evaluate(&sample.state)
}

fn layouts(mechanism: &dyn AnyMechanism) -> Vec<Layout> {
    let names =
        |entries: &[mbs_runtime::Entry]| entries.iter().map(|e| e.name.to_string()).collect::<Vec<_>>();
    let (rows, outputs) = (names(mechanism.rows()), names(mechanism.outputs()));
    let columns = mechanism.coordinates();
    let matrix =
        rows.iter().flat_map(|row| columns.iter().map(move |column| format!("{row}, {}", column.name)));
    let vector = |function, key, entries: &[String]| Layout {
        function,
        key,
        entries: entries.to_vec(),
        row_length: 1,
    };
    vec![
        vector("Φ", "phi", &rows),
        Layout {
            function: "Φ_q", key: "phi_q", entries: matrix.collect(), row_length: columns.len().max(1)
        },
        vector("Φ_t", "phi_t", &rows),
        vector("Φ_tt", "phi_tt", &rows),
        vector("Φ_qt q̇", "phi_qt_qd", &rows),
        vector("γ", "gamma", &rows),
        vector("output", "out", &outputs),
        vector("d output/dt", "out_d", &outputs),
        vector("d² output/dt²", "out_dd", &outputs),
    ]
}

fn select(functions: &Functions, key: &str) -> Vec<Option<f64>> {
    let all = |values: &[f64]| values.iter().copied().map(Some).collect();
    let outputs = |pick: fn(&OutputValue<f64>) -> Option<f64>| functions.outputs.iter().map(pick).collect();
    match key {
        "phi" => all(&functions.phi),
        "phi_q" => all(&functions.phi_q),
        "phi_t" => all(&functions.phi_t),
        "phi_tt" => all(&functions.phi_tt),
        "phi_qt_qd" => all(&functions.phi_qt_qd),
        "gamma" => all(&functions.gamma),
        "out" => outputs(|output| Some(output.value)),
        "out_d" => outputs(|output| output.rate),
        _ => outputs(|output| output.acceleration),
    }
}

fn check_sizes(mechanism: &dyn AnyMechanism, answer: &Answer) -> Result<(), OracleError> {
    let (n, v) = (mechanism.coordinates().len(), mechanism.variables().len());
    if (answer.n, answer.v) == (n, v) && answer.name == mechanism.type_name() {
        return Ok(());
    }
    Err(OracleError::Answer {
        reason: format!(
            "`{}` has {n} coordinates and {v} variables, the definition `{}` has {} and {}",
            mechanism.type_name(),
            answer.name,
            answer.n,
            answer.v
        ),
    })
}

fn table<'a>(answer: &'a Answer, layout: &Layout, states: usize) -> Result<&'a Values, OracleError> {
    let wrong = |reason: String| OracleError::Answer { reason };
    let table =
        answer.functions.get(layout.key).ok_or_else(|| wrong(format!("`{}` is missing", layout.key)))?;
    let entries = layout.entries.len();
    if table.len() == states && table.iter().all(|row| row.len() == entries) {
        Ok(table)
    } else {
        Err(wrong(format!("`{}` needs {entries} entries at each of {states} states", layout.key)))
    }
}

/// The entry with the largest error, `None` where neither side has any value.
fn largest_error(layout: &Layout, found: &Values, expected: &Values) -> Option<LargestError> {
    let row = |entry: usize| entry / layout.row_length;
    let mut scales = vec![0.0_f64; layout.entries.len() / layout.row_length];
    for (entry, value) in expected.iter().flat_map(|values| values.iter().enumerate()) {
        scales[row(entry)] = scales[row(entry)].max(value.unwrap_or(0.0).abs());
    }
    let mut largest: Option<LargestError> = None;
    for (state, (found, expected)) in found.iter().zip(expected).enumerate() {
        for (entry, (emitted, oracle)) in found.iter().zip(expected).enumerate() {
            let scale = scales[row(entry)];
            let Some(error) = relative_error(*emitted, *oracle, scale) else { continue };
            if largest.as_ref().is_none_or(|largest| error > largest.error) {
                let (function, name) = (layout.function, layout.entries[entry].clone());
                largest = Some(LargestError {
                    function,
                    entry: name,
                    state,
                    error,
                    emitted: *emitted,
                    oracle: *oracle,
                    scale,
                });
            }
        }
    }
    largest
}

/// `|emitted − oracle| / scale`; infinite where it is no number or only one side has the value.
fn relative_error(emitted: Option<f64>, oracle: Option<f64>, scale: f64) -> Option<f64> {
    let (emitted, oracle) = match (emitted, oracle) {
        (None, None) => return None,
        (Some(emitted), Some(oracle)) => (emitted, oracle),
        _ => return Some(f64::INFINITY),
    };
    if emitted == oracle && emitted.is_finite() {
        return Some(0.0);
    }
    let error = (emitted - oracle).abs() / scale;
    Some(if error.is_nan() { f64::INFINITY } else { error })
}

impl fmt::Display for Agreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} at {} states, largest error as a part of the row's scale:",
            self.mechanism, self.states
        )?;
        for function in &self.functions {
            writeln!(f, "  {function}")?;
        }
        let verdict = if self.holds() { "agrees" } else { "DIFFERS" };
        write!(f, "  {verdict} (bound {BOUND:e})")
    }
}

impl fmt::Display for LargestError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let LargestError { function, entry, state, error, .. } = self;
        if *error == 0.0 {
            return write!(f, "{function:<14}{:>10}", 0);
        }
        write!(f, "{function:<14}{error:>10.2e}  {entry} at state {state}")?;
        if *error > BOUND {
            let value = |value: Option<f64>| value.map_or("none".to_string(), |value| value.to_string());
            write!(f, ": emitted {}, CasADi {}", value(self.emitted), value(self.oracle))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
