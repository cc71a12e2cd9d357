//! The whole cross-check of one mechanism, for a test in the crate that declares it.

use core::fmt;

use mbs_runtime::Reveal;

use super::compare::{compare, compare_digits};
use super::{Agreement, DIGITS_STATES, Oracle, STATES, VerifyError, generated_definition};
use crate::erased::erase::erase;
use crate::erased::facade::AnyEquations;

/// Comparison of a mechanism with both oracles.
#[derive(Clone, Debug)]
pub struct Check {
    /// Against CasADi's derivatives, at [`STATES`] random states.
    pub casadi: Agreement,
    /// Against 50-digit arithmetic, at [`DIGITS_STATES`] random states.
    pub digits: Agreement,
}

/// Reason why a mechanism is not confirmed. Its `Debug`, which `unwrap` and a failing test print, is its `Display`.
pub enum CheckError {
    /// An oracle has other values: the report names row, coordinate and state of the largest error.
    Differs(Box<Check>),
    /// No comparison was made: the missing part, with the cure.
    NotMade(VerifyError),
}

/// Compares every function of `mechanism` with CasADi's derivatives of its text and with 50-digit arithmetic.
///
/// The parameters of `mechanism` are taken as nominal. Python 3 is needed; its packages are installed on first use below
/// cargo's target directory.
///
/// # Errors
/// [`CheckError`], with the largest errors or with the missing part.
pub fn check<S: Reveal>(mechanism: S) -> Result<Check, CheckError> {
    check_equations(erase(mechanism).equations_mut())
}

/// [`check`] for a mechanism whose size is hidden.
///
/// # Errors
/// As [`check`].
pub fn check_equations(mechanism: &mut dyn AnyEquations) -> Result<Check, CheckError> {
    let check = made(mechanism).map_err(CheckError::NotMade)?;
    let holds = check.casadi.holds() && check.digits.holds();
    if holds { Ok(check) } else { Err(CheckError::Differs(Box::new(check))) }
}

fn made(mechanism: &mut dyn AnyEquations) -> Result<Check, VerifyError> {
    let definition = generated_definition(mechanism)?;
    let oracle = Oracle::new(&|_| ())?;
    let nominal: Vec<Option<f64>> = (0..mechanism.variables().len()).map(|i| mechanism.get(i)).collect();
    let casadi = compare(mechanism, &oracle, &definition, STATES)?;
    for (index, value) in nominal.into_iter().enumerate() {
        mechanism.set(index, value.unwrap_or(0.0));
    }
    let digits = compare_digits(mechanism, &oracle, &definition, DIGITS_STATES)?;
    Ok(Check { casadi, digits })
}

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}\n{}", self.casadi, self.digits)
    }
}

impl fmt::Display for CheckError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CheckError::Differs(check) => check.fmt(f),
            CheckError::NotMade(error) => error.fmt(f),
        }
    }
}

impl fmt::Debug for CheckError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // On a line of its own: a report has several.
        write!(f, "\n{self}")
    }
}

impl core::error::Error for CheckError {}
