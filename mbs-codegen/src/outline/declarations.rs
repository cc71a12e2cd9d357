//! Statements that declare the names of a text, quoted from it.

use proc_macro2::{Delimiter, Span, TokenStream, TokenTree};

use crate::model::Model;
use crate::syntax::Text;
use crate::syntax::ast::{Name, StatementKind};

/// A name with the statement that declares it; a row with the equation that it is of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Declaration {
    /// Name, with its number for a row or a component.
    pub name: String,
    /// Line of the text, from 1: of the name, of a row that of its `==`.
    pub line: usize,
    /// The statement on one line, up to its `;` or its braces; doc comments left out.
    pub text: String,
}

/// Before: a text without faults of its form, in tokens and statements, and the model of a scene. After: the declarations of the model,
/// behind them those of all statements.
pub(crate) fn declarations(source: &str, text: &Text, model: &Model) -> Vec<Declaration> {
    let of_model = model
        .rows
        .iter()
        .map(|row| (row.name.as_str(), row.span))
        .chain(model.coordinates.iter().map(|entry| (entry.name.as_str(), entry.span)))
        .chain(model.variables.iter().map(|entry| (entry.name.as_str(), entry.span)))
        .chain(model.branches.iter().map(|entry| (entry.name.as_str(), entry.span)))
        .chain(model.limits.iter().map(|entry| (entry.name.as_str(), entry.span)))
        .chain(model.outputs.iter().map(|entry| (entry.name.as_str(), entry.span)));
    let of_text = text.statements.iter().filter_map(|statement| named(&statement.kind));
    let named: Vec<(&str, Span)> =
        of_model.chain(of_text.map(|name| (name.text.as_str(), name.span))).collect();
    let quotations = Quotations::of(source);
    let declaration = |(name, span): &(&str, Span)| {
        let (name, line) = ((*name).to_owned(), span.start().line);
        Some(Declaration { name, line, text: quotations.around(*span)? })
    };
    named.iter().filter_map(declaration).collect()
}

/// Name that a statement declares; none of a statement that could not be read to its end.
fn named(kind: &StatementKind) -> Option<&Name> {
    let is_faulty = matches!(kind, StatementKind::Faulty { .. });
    kind.declared().filter(|_| !is_faulty).map(|(_, name)| name)
}

/// Statements of a text as places in it, those in braces each by itself.
struct Quotations<'a> {
    source: &'a str,
    /// First byte and the byte behind the last one; inner statements behind those around them.
    places: Vec<(usize, usize)>,
}

impl<'a> Quotations<'a> {
    fn of(source: &'a str) -> Self {
        let mut places = Vec::new();
        let tokens: TokenStream = source.parse().unwrap_or_default();
        let mut blocks = vec![tokens];
        while let Some(block) = blocks.pop() {
            let mut start: Option<usize> = None;
            let mut end = 0;
            let mut is_attribute = false;
            for token in block {
                let place = token.span().byte_range();
                match &token {
                    // Doc comments and attributes in front of a statement.
                    TokenTree::Punct(mark) if mark.as_char() == '#' && start.is_none() => {
                        is_attribute = true;
                        continue;
                    }
                    TokenTree::Group(_) if is_attribute => {
                        is_attribute = false;
                        continue;
                    }
                    TokenTree::Punct(mark) if mark.as_char() == ';' => {
                        places.extend(start.take().map(|start| (start, place.end)));
                    }
                    TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => {
                        places.extend(start.take().map(|start| (start, end)));
                        blocks.push(group.stream());
                    }
                    _ => {
                        start = start.or(Some(place.start));
                        end = place.end;
                    }
                }
            }
        }
        Quotations { source, places }
    }

    /// The statement with the token at `span`, its blanks as one.
    fn around(&self, span: Span) -> Option<String> {
        let at = span.byte_range().start;
        let place = self.places.iter().rfind(|(start, end)| (*start..*end).contains(&at))?;
        let text = self.source.get(place.0..place.1)?;
        let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
        Some(lines.flat_map(str::split_whitespace).collect::<Vec<_>>().join(" "))
    }
}
