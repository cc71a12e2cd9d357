//! Statements of a text as they are written, for programs that evaluate a text by themselves.
//!
//! Of this crate an independent check uses this module alone: no names are resolved, no units checked, nothing is derived.

use crate::diagnostics::Diagnostics;
use crate::syntax;
pub use crate::syntax::ast::{
    Element, Energy, Equation, Expression, Field, Instruction, Item, Load, Loop, Operation, Operator,
    Statement, StatementKind, Target, Type, Unit,
};
pub use crate::syntax::unit_symbols::SUFFIXES;

/// The statements of a text that is kept as a string, in its order.
///
/// # Errors
/// The faults of its form, two lines each: `line:column: message` and `help: cure`.
pub fn statements(source: &str) -> Result<Vec<Statement>, String> {
    let mut diagnostics = Diagnostics::default();
    let tokens = source.parse().map_err(|fault| format!("the text is no token stream: {fault}"))?;
    let text = syntax::read(tokens, &mut diagnostics);
    match text {
        Some(text) if diagnostics.is_empty() => Ok(text.statements),
        _ => Err(diagnostics.to_text()),
    }
}
