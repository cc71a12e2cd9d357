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
    /// The largest error of each function of which a value was compared.
    pub functions: Vec<LargestError>,
    /// Number of values compared of each function that the mechanism has, and the reason where it is 0.
    pub compared: Vec<(&'static str, usize, Option<Absence>)>,
    /// Values beyond the bound that 50 digits decided.
    pub decisions: Vec<Decision>,
}

/// Comparison of one function.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// The function, as the lecture writes it.
    pub function: &'static str,
    /// Number of values compared.
    pub compared: usize,
    /// Reason why none was, where the mechanism has the function.
    pub absence: Option<Absence>,
    /// The largest error.
    pub largest: Option<LargestError>,
}

/// Reason why no value of a function was compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Absence {
    /// The oracle has no word for it, as for a margin.
    NoWord,
    /// A declared function lacks a derivative that it needs.
    NotEmitted,
    /// The definitions of all outputs use up their derivatives.
    NoDerivative,
    /// There is none: the mechanism is not confirmed.
    Unexplained,
}

/// A value off CasADi's by more than the bound, against CasADi's own expression in 50 digits.
#[derive(Clone, Debug)]
pub struct Decision {
    /// The function.
    pub function: &'static str,
    /// Row, coordinate or output.
    pub entry: String,
    /// Index of the state.
    pub state: usize,
    /// Error against CasADi in double precision, as a part of the row's scale.
    pub error: f64,
    /// Error against 50 digits over 4 ε times the condition: at most 1 where rounding explains it.
    pub share: f64,
    /// Sum of the absolute values that CasADi's expression rounds on the way.
    pub condition: f64,
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
        let compared = self.compared.iter().all(|(.., absence)| *absence != Some(Absence::Unexplained));
        compared && self.functions.iter().all(|function| function.error <= self.reference.bound())
    }

    /// Adds the comparison of a function.
    pub(super) fn add(&mut self, quantity: Quantity) {
        let Quantity { function, compared, absence, largest } = quantity;
        if compared > 0 || absence.is_some() {
            self.compared.push((function, compared, absence));
        }
        self.values += compared;
        self.functions.extend(largest);
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
        let Agreement { mechanism, reference, states, values, functions, compared, decisions } = self;
        let (name, measure) = (reference.name(), reference.measure());
        writeln!(
            f,
            "{mechanism} at {states} states beside {name}, {values} values; largest error as a part of {measure}:"
        )?;
        for (name, values, absence) in compared {
            match (functions.iter().find(|found| found.function == *name), absence) {
                (Some(function), _) => function.write(f, *values, *reference)?,
                (None, Some(absence)) => writeln!(f, "  {name:<14}{:>9} {absence}", 0)?,
                (None, None) => {}
            }
        }
        for Decision { function, entry, state, error, share, condition } in decisions {
            writeln!(
                f,
                "  {function} {entry} at state {state} is off by {error:.2e}: by CasADi's expression in 50 digits {share:.2e} of 4 ε × {condition:.2e}"
            )?;
        }
        let verdict = if self.holds() { "agrees" } else { "DIFFERS" };
        write!(f, "  {verdict} (bound {})", bound(*reference))
    }
}

impl LargestError {
    fn write(&self, f: &mut fmt::Formatter<'_>, values: usize, reference: Reference) -> fmt::Result {
        let LargestError { function, entry, state, error, .. } = self;
        if *error == 0.0 {
            return writeln!(f, "  {function:<14}{values:>9} values {:>9}", 0);
        }
        write!(f, "  {function:<14}{values:>9} values {error:>9.2e}  {entry} at state {state}")?;
        if *error > reference.bound() {
            let value = |value: Option<f64>| value.map_or("none".to_string(), |value| value.to_string());
            write!(f, ": emitted {}, {} {}", value(self.emitted), reference.name(), value(self.oracle))?;
        }
        writeln!(f)
    }
}

impl fmt::Display for Absence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Absence::NoWord => "values: a definition has no word for it",
            Absence::NotEmitted => "values: a declared function lacks a derivative for it",
            Absence::NoDerivative => "values: the outputs use up their derivatives",
            Absence::Unexplained => "values: NOT COMPARED",
        })
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
