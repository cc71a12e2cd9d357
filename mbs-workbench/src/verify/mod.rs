//! Cross-check of emitted code against CasADi, and against 50-digit arithmetic.
//!
//! The text of a mechanism is compiled twice: the macro emits Rust, and [`mbs_codegen::casadi_definition`] prints the bare
//! constraints and outputs. CasADi differentiates these itself; mpmath differentiates them along lines with all digits. Both
//! results are evaluated at random states and compared entry by entry. Python 3 is needed; its environment is made by
//! [`environment`] below cargo's target directory.
//!
//! [`check()`] does all of it for any mechanism, in a test of the crate that declares it.

pub mod agreement;
#[cfg(feature = "program")]
mod cards;
pub mod check;
pub mod compare;
pub mod environment;
mod layout;
pub mod oracle;
mod stand_in;
pub mod states;

use core::fmt;

pub use agreement::{Agreement, BOUND, LargestError, Reference, Summary};
#[cfg(feature = "program")]
pub use cards::{verify, verify_against, verify_digits};
pub use check::{Check, CheckError, check};
pub use environment::EnvironmentError;
pub use oracle::{Oracle, OracleError};
pub use stand_in::{NumberedStandIn, StandIn};

use crate::erased::facade::AnyEquations;

/// Default number of states at which a mechanism is compared.
pub const STATES: usize = 1000;

/// Number of random states for the comparison with CasADi, from the number of coordinates: [`STATES`], fewer above two dozen
/// coordinates. Then as many entries of matrices are compared, and both sides can hold them in memory.
pub fn states_of(coordinates: usize) -> usize {
    const ENTRIES: usize = STATES * 24 * 24;
    (ENTRIES / coordinates.pow(2).max(1)).clamp(1, STATES)
}

/// Default number of states at which a mechanism is compared in 50 digits: each takes thousands of times longer.
pub const DIGITS_STATES: usize = 20;

/// Reason why no comparison was made. A comparison that shows a difference is an [`Agreement`] that does not hold.
#[derive(Debug)]
pub enum VerifyError {
    /// The Python environment could not be made.
    Environment(EnvironmentError),
    /// The text does not print as a CasADi definition.
    Definition {
        /// The mechanism.
        mechanism: String,
        /// Message of the back end.
        reason: String,
    },
    /// CasADi's side failed or answered in another shape.
    Oracle(OracleError),
    /// A file could not be read.
    File {
        /// The file.
        path: String,
        /// Message of the operating system.
        reason: String,
    },
}

/// Compares the emitted code of a mechanism, free to move or not, with CasADi's derivatives of the same text at `states` random
/// states.
///
/// # Errors
/// [`VerifyError`] where the comparison could not be made.
pub fn verify_equations(
    mechanism: &mut dyn AnyEquations,
    oracle: &Oracle,
    states: usize,
) -> Result<Agreement, VerifyError> {
    let definition = generated_definition(mechanism)?;
    Ok(compare::compare(mechanism, oracle, &definition, states)?)
}

/// Compares the emitted code of a mechanism, free to move or not, with 50-digit arithmetic on the same text at `states` random
/// states; masses and forces have no part in it.
///
/// # Errors
/// [`VerifyError`] where the comparison could not be made.
pub fn verify_equations_digits(
    mechanism: &mut dyn AnyEquations,
    oracle: &Oracle,
    states: usize,
) -> Result<Agreement, VerifyError> {
    let definition = generated_definition(mechanism)?;
    Ok(compare::compare_digits(mechanism, oracle, &definition, states)?)
}

/// The CasADi definition that the second back end prints from the mechanism's text.
///
/// # Errors
/// [`VerifyError::Definition`].
pub fn generated_definition(mechanism: &dyn AnyEquations) -> Result<String, VerifyError> {
    mbs_codegen::casadi_definition(mechanism.source(), Some(mechanism.scene()))
        .map_err(|reason| VerifyError::Definition { mechanism: mechanism.full_name(), reason })
}

impl fmt::Display for VerifyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            VerifyError::Environment(error) => error.fmt(f),
            VerifyError::Definition { mechanism, reason } => {
                write!(f, "`{mechanism}` does not print as a CasADi definition: {reason}")
            }
            VerifyError::Oracle(error) => error.fmt(f),
            VerifyError::File { path, reason } => write!(f, "cannot read {path}: {reason}"),
        }
    }
}

impl core::error::Error for VerifyError {}

impl From<EnvironmentError> for VerifyError {
    fn from(error: EnvironmentError) -> Self {
        VerifyError::Environment(error)
    }
}

impl From<OracleError> for VerifyError {
    fn from(error: OracleError) -> Self {
        VerifyError::Oracle(error)
    }
}
