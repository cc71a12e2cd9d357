//! Cross-checks of ready mechanisms.

use std::fs;
use std::path::Path;

use super::{Agreement, Oracle, STATES, VerifyError, compare, verify_equations, verify_equations_digits};
use crate::facade::{AnyEquations, AnyMechanism};
use crate::registry::{self, Card, Mismatch};

/// Compares the emitted code of the mechanism with CasADi's derivatives of the same text at `states` random states.
///
/// # Errors
/// [`VerifyError`] where the comparison could not be made.
pub fn verify(card: &Card, oracle: &Oracle, states: usize) -> Result<Agreement, VerifyError> {
    verify_equations(comparable(card).as_mut(), oracle, states)
}

/// Compares the emitted code of the mechanism with 50-digit arithmetic on the same text at `states` random states.
///
/// # Errors
/// [`VerifyError`] where the comparison could not be made.
pub fn verify_digits(card: &Card, oracle: &Oracle, states: usize) -> Result<Agreement, VerifyError> {
    verify_equations_digits(comparable(card).as_mut(), oracle, states)
}

/// Compares the emitted code of the mechanism called `name` with the definition in a Python file at
/// [`STATES`] random states.
///
/// # Errors
/// [`VerifyError`] where the comparison could not be made.
pub fn verify_against(name: &str, definition: &Path, oracle: &Oracle) -> Result<Agreement, VerifyError> {
    let card = registry::find(name).map_err(VerifyError::Mechanism)?;
    let text = fs::read_to_string(definition).map_err(|error| VerifyError::File {
        path: definition.display().to_string(),
        reason: error.to_string(),
    })?;
    Ok(compare::compare(comparable(card).as_mut(), oracle, &text, STATES)?)
}

/// Makes a mechanism.
type Make = fn() -> Box<dyn AnyMechanism>;

/// Ready mechanisms with functions, each with stand-ins for them.
const WITH_FUNCTIONS: [(&str, Make); 1] = [("cam_law", crate::cam_law::compared)];

/// A new instance of which both sides of a cross-check know everything.
pub fn comparable(card: &Card) -> Box<dyn AnyMechanism> {
    let found = WITH_FUNCTIONS.iter().find(|(name, _)| *name == card.name);
    found.map_or_else(card.make, |(_, make)| make())
}

/// The mechanism called `name`, free to move or not, so that both sides of a cross-check know everything.
///
/// # Errors
/// [`Mismatch::Mechanism`] where there is none; its text lists the known names.
pub fn comparable_by_name(name: &str) -> Result<Box<dyn AnyEquations>, Mismatch> {
    match registry::FREE.iter().find(|card| card.name == name) {
        Some(card) => Ok((card.make)()),
        None => Ok(comparable(registry::find(name)?)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::ALL;

    #[test]
    fn every_mechanism_with_functions_has_stand_ins() {
        for card in ALL {
            let listed = WITH_FUNCTIONS.iter().any(|(name, _)| *name == card.name);
            assert_eq!((card.make)().functions().is_empty(), !listed, "{}", card.name);
        }
    }
}
