//! Agreement of emitted values with an oracle's.

use core::fmt;

/// Largest error allowed against CasADi, as a part of the row's scale: a few hundred roundings of double precision.
pub const BOUND: f64 = 1e-13;

/// Roundings allowed for each one that is counted in the comparison with 50 digits. A library function may lose a few units in
/// the last place, and a derivative is a longer expression than the one that is counted.
pub const ROUNDINGS: f64 = 64.0;

/// Oracle that emitted values are compared with, and measure of the error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// CasADi in double precision; errors are parts of the row's largest value.
    Casadi,
    /// mpmath in 50 digits; errors are parts of [`ROUNDINGS`]·2⁻⁵³·B, where B sums the absolute values that were
    /// rounded on the way.
    Digits,
}

/// Agreement of a mechanism's emitted code with the oracle.
#[derive(Clone, Debug)]
pub struct Agreement {
    /// Name of the mechanism, its scene included.
    pub mechanism: String,
    /// The oracle.
    pub reference: Reference,
    /// Number of states compared.
    pub states: usize,
    /// Number of values compared.
    pub values: usize,
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
    /// Against CasADi the largest absolute value of the row over the states, against 50 digits the bound of rounding errors.
    pub scale: f64,
}

/// Several mechanisms compared with one oracle, in one sentence.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    agreements: Vec<Agreement>,
}

impl Reference {
    /// Largest error allowed.
    pub fn bound(self) -> f64 {
        match self {
            Reference::Casadi => BOUND,
            Reference::Digits => 1.0,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Reference::Casadi => "CasADi",
            Reference::Digits => "50 digits",
        }
    }

    fn measure(self) -> &'static str {
        match self {
            Reference::Casadi => "the row's scale",
            Reference::Digits => "64 roundings for each operation",
        }
    }
}

impl Agreement {
    /// `true` if every error is within [`Reference::bound`].
    pub fn holds(&self) -> bool {
        self.functions.iter().all(|function| function.error <= self.reference.bound())
    }

    /// The function with the largest error.
    pub fn worst(&self) -> Option<&LargestError> {
        self.functions.iter().max_by(|a, b| a.error.total_cmp(&b.error))
    }
}

impl Summary {
    /// Adds a mechanism.
    pub fn add(&mut self, agreement: Agreement) {
        self.agreements.push(agreement);
    }

    /// Names of the mechanisms that the oracle does not confirm.
    pub fn differing(&self) -> Vec<&str> {
        self.agreements.iter().filter(|agreement| !agreement.holds()).map(|a| a.mechanism.as_str()).collect()
    }

    /// Number of values compared.
    pub fn values(&self) -> usize {
        self.agreements.iter().map(|agreement| agreement.values).sum()
    }
}

impl fmt::Display for Agreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Agreement { mechanism, reference, states, values, functions } = self;
        let (name, measure) = (reference.name(), reference.measure());
        writeln!(
            f,
            "{mechanism} at {states} states beside {name}, {values} values; largest error as a part of {measure}:"
        )?;
        for function in functions {
            function.write(f, *reference)?;
        }
        let verdict = if self.holds() { "agrees" } else { "DIFFERS" };
        write!(f, "  {verdict} (bound {})", bound(*reference))
    }
}

impl LargestError {
    fn write(&self, f: &mut fmt::Formatter<'_>, reference: Reference) -> fmt::Result {
        let LargestError { function, entry, state, error, .. } = self;
        if *error == 0.0 {
            return writeln!(f, "  {function:<14}{:>10}", 0);
        }
        write!(f, "  {function:<14}{error:>10.2e}  {entry} at state {state}")?;
        if *error > reference.bound() {
            let value = |value: Option<f64>| value.map_or("none".to_string(), |value| value.to_string());
            write!(f, ": emitted {}, {} {}", value(self.emitted), reference.name(), value(self.oracle))?;
        }
        writeln!(f)
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let worst = self.agreements.iter().filter_map(|a| Some((a, a.worst()?)));
        let worst = worst.max_by(|(_, a), (_, b)| a.error.total_cmp(&b.error));
        let Some((agreement, error)) = worst else { return write!(f, "nothing compared") };
        let reference = agreement.reference;
        let functions = self.agreements.iter().map(|a| a.functions.len()).max().unwrap_or(0);
        write!(
            f,
            "{} mechanisms × {} states × {functions} functions beside {}, {} values; largest error {:.2e} of {}: \
             {} {} of {} at state {} (bound {})",
            self.agreements.len(),
            agreement.states,
            reference.name(),
            self.values(),
            error.error,
            reference.measure(),
            error.function,
            error.entry,
            agreement.mechanism,
            error.state,
            bound(reference)
        )
    }
}

fn bound(reference: Reference) -> String {
    match reference {
        Reference::Casadi => format!("{BOUND:e}"),
        Reference::Digits => "1".into(),
    }
}
