//! Cross-check of emitted code against CasADi, and against 50-digit arithmetic.
//!
//! The text of a mechanism goes two ways: the macro emits Rust, [`mbs_codegen::casadi_definition`] prints the bare
//! constraints and outputs for CasADi, which differentiates them itself, and for mpmath, which follows them along
//! lines with all digits. Both ways are evaluated at random states and compared entry by entry. Python 3 is needed; its
//! environment is made by [`environment`] below cargo's target directory.
//!
//! [`check()`] does all of it for any mechanism, in a test of the crate that declares it.

pub mod agreement;
#[cfg(feature = "ready")]
mod cards;
pub mod check;
pub mod compare;
pub mod environment;
mod in_lanes;
mod layout;
pub mod oracle;
mod stand_in;
pub mod states;

use core::fmt;

pub use agreement::{Agreement, BOUND, LargestError, Reference, Summary};
#[cfg(feature = "ready")]
pub use cards::{comparable, comparable_by_name, verify, verify_against, verify_digits};
pub use check::{Check, CheckError, check};
pub use environment::EnvironmentError;
pub use in_lanes::InLanes;
pub use oracle::{Oracle, OracleError};
pub use stand_in::StandIn;

use crate::facade::AnyEquations;
#[cfg(feature = "ready")]
use crate::registry::Mismatch;

/// States a mechanism is compared at unless told otherwise.
pub const STATES: usize = 1000;

/// Random states beside CasADi for a mechanism of so many coordinates: [`STATES`], and of more than two dozen coordinates fewer, so
/// that as many entries of matrices are compared and both sides can hold them.
pub fn states_of(coordinates: usize) -> usize {
    const ENTRIES: usize = STATES * 24 * 24;
    (ENTRIES / coordinates.pow(2).max(1)).clamp(1, STATES)
}

/// States a mechanism is compared at in 50 digits unless told otherwise: each takes thousands of times longer.
pub const DIGITS_STATES: usize = 20;

/// Why no comparison was made. A comparison that shows a difference is an [`Agreement`] that does not hold.
#[derive(Debug)]
pub enum VerifyError {
    /// No ready mechanism of this name.
    #[cfg(feature = "ready")]
    Mechanism(Mismatch),
    /// The Python environment could not be made.
    Environment(EnvironmentError),
    /// The text does not print as a CasADi definition.
    Definition {
        /// The mechanism.
        mechanism: String,
        /// What the back end says.
        reason: String,
    },
    /// CasADi's side failed or answered in another shape.
    Oracle(OracleError),
    /// A file could not be read.
    File {
        /// The file.
        path: String,
        /// What the system says.
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
            #[cfg(feature = "ready")]
            VerifyError::Mechanism(mismatch) => mismatch.fmt(f),
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
