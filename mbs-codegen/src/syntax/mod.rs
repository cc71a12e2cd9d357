//! Tokens → [`ast`], spans kept, error-tolerant, iterative for all nested texts.

#[allow(missing_docs, reason = "fields are named as the grammar names them")]
pub mod ast;
mod branch_and_limit;
mod constraint;
mod curve;
mod declaration;
mod declared_names;
mod dot_suffix;
mod dynamics;
mod event;
mod expression;
#[cfg(test)]
mod expression_tests;
mod foot;
mod for_loop;
mod foreign;
mod foreign_words;
mod header;
mod keywords;
mod missing;
mod number;
mod number_notations;
mod other_forms;
mod parser;
pub mod picture;
mod quotation;
mod references;
pub mod rust_identifiers;
mod scene;
mod source;
mod statement;
mod statement_end;
pub mod tokens;
mod unit;
pub mod unit_symbols;
pub mod unreadable;
mod written_expressions;

use proc_macro2::{Ident, Span, TokenStream};

use crate::diagnostics::Diagnostics;
#[cfg(test)]
pub use foreign::CALLED;
pub use foreign::NUMBER_TYPES;
use foreign::without_comments;
pub use foreign_words::meant_field;
pub use header::{Header, OWN};
pub use keywords::{LATER, STATEMENTS};
pub use references::{OF_FORCES, REFERRING};
pub use scene::NAMELESS;
use statement::parse;

/// A text as written.
pub struct Text {
    /// Head of the text, before its statements.
    pub header: Header,
    /// The statements that could be read, without those of the picture: code is emitted for them.
    pub statements: Vec<ast::Statement>,
    /// All statements, where some are of the picture; else none.
    pub pictured: Vec<ast::Statement>,
    /// The whole text as the user laid it out.
    pub source: String,
}

/// Before: any tokens. After: the text as written, every fault of its form reported; `None` where not even the
/// header could be read.
pub fn read(input: TokenStream, diagnostics: &mut Diagnostics) -> Option<Text> {
    let (runtime, first, body) = header::split(input);
    // Measures depth and length before anything that recurses sees the text.
    let mut all = tokens::flatten(first.clone(), diagnostics);
    if !diagnostics.is_empty() {
        return None;
    }
    let (mut header, rest) = header::read(first, runtime, diagnostics)?;
    if let Some(fault) = header.name_fault() {
        diagnostics.report(header.name.span(), fault, "give the mechanism another name");
        // The statements may have faults too.
        header.name = Ident::new("Mechanism", header.name.span());
    }
    let body = tokens::flatten(rest.into_iter().chain(body).collect(), diagnostics);
    let body = without_comments(body, diagnostics);
    let mut statements = parse(&body, diagnostics);
    let pictured = picture::take(&mut statements);
    if !statements.iter().any(declares_coordinate) {
        if diagnostics.is_empty() {
            diagnostics.report(
                header.name.span(),
                format!("`{}` has no coordinate", header.label()),
                "declare what is sought: `coord phi: rad = 0.5;`",
            );
        }
        statements.push(stand_in(header.name.span()));
    }
    all.pop();
    all.extend(body);
    Some(Text { header, statements, pictured, source: source::layout(&all) })
}

/// Before: any tokens. After: the expression that they are, all of them; `None` where a fault is reported.
pub fn expression_of(input: TokenStream, diagnostics: &mut Diagnostics) -> Option<ast::Expression> {
    whole(input, diagnostics, expression::expression)
}

/// Before: any tokens. After: the unit that they are, all of them; `None` where a fault is reported.
pub fn unit_of(input: TokenStream, diagnostics: &mut Diagnostics) -> Option<ast::Unit> {
    whole(input, diagnostics, unit::unit)
}

fn whole<T>(
    input: TokenStream,
    diagnostics: &mut Diagnostics,
    read: impl FnOnce(&mut parser::Parser<'_>) -> parser::Read<T>,
) -> Option<T> {
    let tokens = tokens::flatten(input, diagnostics);
    let mut parser = parser::Parser::new(&tokens, diagnostics);
    let found = read(&mut parser).ok()?;
    if *parser.peek() != tokens::TokenKind::End {
        let _reported: parser::Read<()> = parser.expected("the end of the value", "write one value");
    }
    diagnostics.is_empty().then_some(found)
}

/// `true` if the statement declares a coordinate, even a faulty one.
pub fn declares_coordinate(statement: &ast::Statement) -> bool {
    matches!(
        statement.kind,
        ast::StatementKind::Coord { .. } | ast::StatementKind::Faulty { declares: ast::Declares::Coord, .. }
    )
}

/// `true` if the statement declares a scene.
pub fn declares_scene(statement: &ast::Statement) -> bool {
    matches!(statement.kind, ast::StatementKind::Scene { .. })
}

/// A coordinate where there is none, which is reported: no stage behind meets a text without one.
pub fn stand_in(span: Span) -> ast::Statement {
    let name = ast::Name { text: "coordinate".into(), span };
    let kind = ast::StatementKind::Faulty { name, declares: ast::Declares::Coord, kind: None };
    ast::Statement { docs: Vec::new(), kind }
}
