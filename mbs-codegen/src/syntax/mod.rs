//! Tokens → [`ast`], spans kept, error-tolerant, iterative wherever a text can nest.

pub mod ast;
mod expression;
mod header;
mod parser;
mod source;
mod statement;
mod tokens;

use proc_macro2::TokenStream;

use crate::diagnostics::Diagnostics;
pub use header::Header;
use header::split;
use statement::parse;

/// A text as written.
pub struct Text {
    /// What stands before the statements.
    pub header: Header,
    /// The statements that could be read.
    pub statements: Vec<ast::Statement>,
    /// The whole text as the user laid it out.
    pub source: String,
}

/// Before: any tokens. After: the text as written, every fault of its form reported; `None` where not even the
/// header could be read.
pub fn read(input: TokenStream, diagnostics: &mut Diagnostics) -> Option<Text> {
    // Measures depth and length before anything that recurses sees the text.
    let all = tokens::flatten(input.clone(), diagnostics)?;
    let (header, body) = split(input, diagnostics)?;
    let body = tokens::flatten(body, diagnostics)?;
    let statements = parse(&body, diagnostics);
    Some(Text { header, statements, source: source::layout(without_runtime(&all)) })
}

/// The tokens behind the runtime's path.
fn without_runtime(all: &[tokens::Token]) -> &[tokens::Token] {
    if all.first().is_none_or(|token| token.kind != tokens::Kind::Open('(')) {
        return all;
    }
    let end = all.iter().position(|token| token.kind == tokens::Kind::Close(')'));
    end.and_then(|end| all.get(end + 1..)).unwrap_or(all)
}
