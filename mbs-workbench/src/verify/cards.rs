//! Cross-checks of the mechanisms of a list.

use std::fs;
use std::path::Path;

use super::{Agreement, Oracle, STATES, VerifyError, compare, verify_equations, verify_equations_digits};
use crate::card::Card;

/// Compares the emitted code of the mechanism with CasADi's derivatives of the same text at `states` random states.
///
/// # Errors
/// [`VerifyError`] where the comparison could not be made.
pub fn verify(card: &Card, oracle: &Oracle, states: usize) -> Result<Agreement, VerifyError> {
    verify_equations(card.comparable().as_mut(), oracle, states)
}

/// Compares the emitted code of the mechanism with 50-digit arithmetic on the same text at `states` random states.
///
/// # Errors
/// [`VerifyError`] where the comparison could not be made.
pub fn verify_digits(card: &Card, oracle: &Oracle, states: usize) -> Result<Agreement, VerifyError> {
    verify_equations_digits(card.comparable().as_mut(), oracle, states)
}

/// Compares the emitted code of the mechanism with the definition in a Python file at [`STATES`] random states.
///
/// # Errors
/// [`VerifyError`] where the comparison could not be made.
pub fn verify_against(card: &Card, definition: &Path, oracle: &Oracle) -> Result<Agreement, VerifyError> {
    let text = fs::read_to_string(definition).map_err(|error| VerifyError::File {
        path: definition.display().to_string(),
        reason: error.to_string(),
    })?;
    Ok(compare::compare(card.comparable().as_mut(), oracle, &text, STATES)?)
}
