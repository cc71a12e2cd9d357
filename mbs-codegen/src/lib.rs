//! Tokens of a mechanism in, tokens of exact straight-line code out: the library behind `mechanism!`.
//!
//! Data flows one way, and no folder uses one to its right:
//! tokens → `syntax` → `model` → `symbolic` → `equations` → `structure` → `program` → `emit` → tokens.

// A text may be anything; the compiler of a user must not see us panic.
#![cfg_attr(
    not(test),
    deny(
        clippy::expect_used,
        clippy::indexing_slicing,
        clippy::panic,
        clippy::string_slice,
        clippy::unreachable,
        clippy::unwrap_used
    )
)]

mod diagnostics;
mod emit;
mod equations;
mod model;
mod program;
#[cfg(test)]
mod random;
mod structure;
mod symbolic;
mod syntax;

use diagnostics::Diagnostics;
pub use emit::formula::Formulas;
use emit::notation::Notation;
pub use emit::report::{BlockReport, CoordinateReport, EntryKind, RowReport, StructureReport};
use proc_macro2::TokenStream;

/// Expands the text of a mechanism, led by the runtime's path in parentheses (without it `::mbs_runtime`).
///
/// A faulty text gives one `compile_error!` a fault, each on its token, and a stub beside them.
pub fn expand(input: TokenStream) -> TokenStream {
    let mut diagnostics = Diagnostics::default();
    let Some(text) = syntax::read(input, &mut diagnostics) else { return diagnostics.to_tokens() };
    let model = model::resolve(&text.statements, &mut diagnostics);
    match translate(&text, &model, &mut diagnostics) {
        Some(items) => items,
        None => {
            let mut items = diagnostics.to_tokens();
            items.extend(emit::stub(&text, &model));
            items
        }
    }
}

/// The stages behind the front end; `None` where a fault is known.
fn translate(
    text: &syntax::Text,
    model: &model::Model,
    diagnostics: &mut Diagnostics,
) -> Option<TokenStream> {
    if !diagnostics.is_empty() {
        return None;
    }
    let mut equations = equations::derive(model);
    let structure = structure::analyse(model, &mut equations, diagnostics)?;
    let program = program::order(&equations, &structure);
    Some(emit::rust(text, model, &equations, &structure, &program))
}

/// Expands a text that is kept as a string, a mechanism's `SOURCE` for instance.
///
/// # Errors
/// The faults, two lines each: `line:column: message` and `help: cure`.
pub fn expand_source(source: &str) -> Result<TokenStream, String> {
    let mut diagnostics = Diagnostics::default();
    let items = read_source(source, &mut diagnostics)
        .and_then(|(text, model)| translate(&text, &model, &mut diagnostics));
    items.ok_or_else(|| diagnostics.to_text())
}

/// A text that is kept as a string as a CasADi definition: a Python module with `define(ca, q, v, t, der)`.
///
/// # Errors
/// The faults, two lines each: `line:column: message` and `help: cure`.
pub fn casadi_definition(source: &str) -> Result<String, String> {
    let mut diagnostics = Diagnostics::default();
    match read_source(source, &mut diagnostics) {
        Some((text, model)) if diagnostics.is_empty() => {
            Ok(emit::casadi::definition(&model, &text.header.name.to_string()))
        }
        _ => Err(diagnostics.to_text()),
    }
}

/// Φ and its derivatives as plain text, of a text that is kept as a string; need not be square.
///
/// # Errors
/// The faults, two lines each: `line:column: message` and `help: cure`.
pub fn formulas(source: &str) -> Result<Formulas, String> {
    formulas_in(source, Notation::Text)
}

/// [`formulas`] for LaTeX's mathematical mode; needs the package `amsmath`.
///
/// # Errors
/// The faults, two lines each: `line:column: message` and `help: cure`.
pub fn latex_formulas(source: &str) -> Result<Formulas, String> {
    formulas_in(source, Notation::Latex)
}

fn formulas_in(source: &str, notation: Notation) -> Result<Formulas, String> {
    let mut diagnostics = Diagnostics::default();
    match read_source(source, &mut diagnostics) {
        Some((text, model)) if diagnostics.is_empty() => {
            let equations = equations::derive(&model);
            Ok(emit::formula::formulas(&model, &equations, &text.header.name.to_string(), notation))
        }
        _ => Err(diagnostics.to_text()),
    }
}

/// Sparsity, matching and block-triangular order of a text that is kept as a string.
///
/// # Errors
/// The faults, two lines each: `line:column: message` and `help: cure`.
pub fn structure_of(source: &str) -> Result<StructureReport, String> {
    let mut diagnostics = Diagnostics::default();
    let report = read_source(source, &mut diagnostics)
        .and_then(|(text, model)| structured(&text, &model, &mut diagnostics));
    report.ok_or_else(|| diagnostics.to_text())
}

/// The stages up to the report; `None` where a fault is known.
fn structured(
    text: &syntax::Text,
    model: &model::Model,
    diagnostics: &mut Diagnostics,
) -> Option<StructureReport> {
    if !diagnostics.is_empty() {
        return None;
    }
    let mut equations = equations::derive(model);
    let structure = structure::analyse(model, &mut equations, diagnostics)?;
    let program = program::order(&equations, &structure);
    let name = text.header.name.to_string();
    Some(emit::report::report(model, &equations, &structure, &program, &name))
}

fn read_source(source: &str, diagnostics: &mut Diagnostics) -> Option<(syntax::Text, model::Model)> {
    let input = match source.parse::<TokenStream>() {
        Ok(input) => input,
        Err(fault) => {
            diagnostics.report(
                fault.span(),
                format!("the text is no Rust token stream: {fault}"),
                "close every bracket and quote",
            );
            return None;
        }
    };
    let text = syntax::read(input, diagnostics)?;
    let model = model::resolve(&text.statements, diagnostics);
    Some((text, model))
}
