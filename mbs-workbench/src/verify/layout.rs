//! The functions of a mechanism as tables: an entry a component, a line a state.

use mbs_runtime::{Entry, OutputValue};

use super::agreement::LargestError;
use super::oracle::{Answer, OracleError, Table, Values};
use super::states::Sample;
use crate::erased::facade::{AnyEquations, Functions};
use crate::erased::masses::Masses;

/// A function with its entries grouped in rows.
pub struct Layout {
    function: &'static str,
    key: &'static str,
    entries: Vec<String>,
    row_length: usize,
}

/// One value compared with the oracle's.
pub struct Measured {
    /// Difference as a part of `scale`.
    pub error: f64,
    /// The oracle's value.
    pub oracle: Option<f64>,
    /// Scale of the difference.
    pub scale: f64,
}

/// Every function that is compared.
pub fn layouts(mechanism: &dyn AnyEquations) -> Vec<Layout> {
    let names = |entries: &[Entry]| entries.iter().map(|e| e.name.to_string()).collect::<Vec<_>>();
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

/// Every function of masses and forces that is compared; none where the text has none.
pub fn mass_layouts(mechanism: &dyn AnyEquations) -> Vec<Layout> {
    let Some(tables) = mechanism.tables() else { return Vec::new() };
    let names = |entries: &[Entry]| entries.iter().map(|e| e.name.to_string()).collect::<Vec<_>>();
    let columns = names(mechanism.coordinates());
    let matrix = |function, key| Layout {
        function,
        key,
        entries: columns.iter().flat_map(|i| columns.iter().map(move |j| format!("{i}, {j}"))).collect(),
        row_length: columns.len().max(1),
    };
    let vector = |function, key, entries: Vec<String>| Layout { function, key, entries, row_length: 1 };
    let energies = ["kinetic", "potential"].map(String::from).to_vec();
    vec![
        matrix("M", "mass"),
        vector("M q̈", "mass_times", columns.clone()),
        vector("Q", "force", columns.clone()),
        matrix("∂Q/∂q", "force_q"),
        matrix("∂Q/∂q̇", "force_qd"),
        matrix("(M q̈)_q", "mass_times_q"),
        vector("Φ_qᵀ λ", "reaction", columns.clone()),
        matrix("(Φ_qᵀ λ)_q", "reaction_q"),
        vector("energy", "energy", energies),
        vector("power", "powers", names(tables.forces)),
        vector("d state/dt", "state_rates", names(tables.states)),
        vector("load", "loads", names(tables.loads)),
    ]
}

impl Layout {
    /// Row of Φ, or output, that an entry belongs to.
    pub fn row(&self, entry: usize) -> usize {
        entry / self.row_length
    }

    /// Number of rows or outputs.
    pub fn rows(&self) -> usize {
        self.entries.len() / self.row_length
    }

    /// The emitted values of this function.
    pub fn select(&self, emitted: &[Functions]) -> Values {
        emitted.iter().map(|functions| select(functions, self.key)).collect()
    }

    /// The emitted values of this function of masses and forces.
    pub fn select_mass(&self, emitted: &[Masses]) -> Values {
        let all = |values: &[f64]| values.iter().copied().map(Some).collect();
        emitted.iter().map(|masses| all(mass_values(masses, self.key))).collect()
    }

    /// The oracle's values of this function.
    ///
    /// # Errors
    /// [`OracleError::Answer`] where they are missing or of another number.
    pub fn table<'a, E>(&self, answer: &'a Answer<E>, states: usize) -> Result<&'a Table<E>, OracleError> {
        let wrong = |reason: String| OracleError::Answer { reason };
        let table =
            answer.functions.get(self.key).ok_or_else(|| wrong(format!("`{}` is missing", self.key)))?;
        let entries = self.entries.len();
        if table.len() == states && table.iter().all(|row| row.len() == entries) {
            Ok(table)
        } else {
            Err(wrong(format!("`{}` needs {entries} entries at each of {states} states", self.key)))
        }
    }

    /// The entry with the largest error and the number of values compared. `measure` gives the difference between an emitted
    /// value and the oracle's, `None` if there is nothing to compare.
    pub fn largest_error<E>(
        &self,
        found: &Values,
        expected: &Table<E>,
        mut measure: impl FnMut(usize, Option<f64>, Option<&E>) -> Option<Measured>,
    ) -> (Option<LargestError>, usize) {
        let (mut largest, mut compared): (Option<LargestError>, usize) = (None, 0);
        for (state, (found, expected)) in found.iter().zip(expected).enumerate() {
            for (entry, (emitted, expected)) in found.iter().zip(expected).enumerate() {
                // An output of a margin, which definitions have no word for; a ratio next to a singular state.
                if matches!(self.key, "out" | "loads") && expected.is_none() {
                    continue;
                }
                let Some(measured) = measure(entry, *emitted, expected.as_ref()) else { continue };
                compared += 1;
                let Measured { error, oracle, scale } = measured;
                if largest.as_ref().is_none_or(|largest| error > largest.error) {
                    let (function, name) = (self.function, self.entries[entry].clone());
                    let (emitted, entry) = (*emitted, name);
                    largest = Some(LargestError { function, entry, state, error, emitted, oracle, scale });
                }
            }
        }
        (largest, compared)
    }
}

/// The emitted functions at a sample.
pub fn emitted(mechanism: &mut dyn AnyEquations, sample: &Sample) -> Functions {
    for (index, value) in sample.variables.iter().enumerate() {
        mechanism.set(index, *value);
    }
    mechanism.evaluate(&sample.state)
}

/// The emitted functions of masses and forces at a sample.
pub fn emitted_masses(mechanism: &mut dyn AnyEquations, sample: &Sample) -> Option<Masses> {
    for (index, value) in sample.variables.iter().enumerate() {
        mechanism.set(index, *value);
    }
    mechanism.masses(&sample.state, &sample.loads)
}

fn mass_values<'a>(masses: &'a Masses, key: &str) -> &'a [f64] {
    match key {
        "mass" => &masses.mass,
        "mass_times" => &masses.mass_times,
        "force" => &masses.force,
        "force_q" => &masses.force_q,
        "force_qd" => &masses.force_qd,
        "mass_times_q" => &masses.mass_times_q,
        "reaction" => &masses.reaction,
        "reaction_q" => &masses.reaction_q,
        "energy" => &masses.energy,
        "powers" => &masses.powers,
        "state_rates" => &masses.state_rates,
        _ => &masses.loads,
    }
}

/// Fails if the answer is not about this mechanism.
///
/// # Errors
/// [`OracleError::Answer`] with both sizes where it is not.
pub fn check_sizes<E>(mechanism: &dyn AnyEquations, answer: &Answer<E>) -> Result<(), OracleError> {
    let sizes = (mechanism.coordinates().len(), mechanism.rows().len(), mechanism.variables().len());
    if (answer.n, answer.m, answer.v) == sizes && answer.name == mechanism.full_name() {
        return Ok(());
    }
    let (n, m, v) = sizes;
    Err(OracleError::Answer {
        reason: format!(
            "`{}` has {n} coordinates, {m} rows and {v} variables, the definition `{}` has {}, {} and {}",
            mechanism.full_name(),
            answer.name,
            answer.n,
            answer.m,
            answer.v
        ),
    })
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
