//! Token trees → one flat list with measured depth.

use proc_macro2::{Delimiter, Spacing, Span, TokenStream, TokenTree};

use crate::diagnostics::Diagnostics;

/// Deepest nesting that is read; `syn` and `rustc` itself overflow their stacks somewhat beyond twice this.
pub const DEEPEST: usize = 256;
/// Longest text that is read, in tokens.
pub const LONGEST: usize = 200_000;

/// A token of the flat list.
#[derive(Clone, Debug)]
pub struct Token {
    pub kind: Kind,
    pub span: Span,
    /// Whether an identifier was written `r#so`.
    pub raw: bool,
}

/// What a [`Token`] is.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// Without the `r#` of a raw identifier.
    Identifier(String),
    Literal(String),
    /// Whether another punctuation character follows at once.
    Punctuation(char, bool),
    Open(char),
    Close(char),
    /// Behind the last token.
    End,
}

impl Token {
    /// As it would be quoted in a message.
    pub fn describe(&self) -> String {
        match &self.kind {
            Kind::Identifier(text) | Kind::Literal(text) => format!("`{text}`"),
            Kind::Punctuation(character, _) | Kind::Open(character) | Kind::Close(character) => {
                format!("`{character}`")
            }
            Kind::End => "the end of the text".into(),
        }
    }
}

/// Before: any token stream. After: one list, groups as `Open` and `Close`, groups without delimiters looked
/// through, `End` last; nothing nests deeper than [`DEEPEST`].
///
/// Returns `None`, with the fault reported, where the text is too deep or too long.
pub fn flatten(stream: TokenStream, diagnostics: &mut Diagnostics) -> Option<Vec<Token>> {
    let mut tokens = Vec::new();
    let mut end = Span::call_site();
    let mut open = vec![(stream.into_iter(), None)];
    while let Some((rest, close)) = open.last_mut() {
        let Some(tree) = rest.next() else {
            if let Some((character, span)) = close.take() {
                tokens.push(Token { kind: Kind::Close(character), span, raw: false });
            }
            open.pop();
            continue;
        };
        end = tree.span();
        if tokens.len() >= LONGEST {
            diagnostics.report(
                end,
                format!("the text is longer than {LONGEST} tokens"),
                "split the mechanism, or write repeated parts with `for`",
            );
            return None;
        }
        match tree {
            TokenTree::Group(group) => {
                let (from, to) = match group.delimiter() {
                    Delimiter::Parenthesis => ('(', ')'),
                    Delimiter::Bracket => ('[', ']'),
                    Delimiter::Brace => ('{', '}'),
                    Delimiter::None => {
                        open.push((group.stream().into_iter(), None));
                        continue;
                    }
                };
                if open.len() > DEEPEST {
                    diagnostics.report(
                        group.span_open(),
                        format!("brackets nest deeper than {DEEPEST} levels here"),
                        "name a part of the expression with `let` and use the name",
                    );
                    return None;
                }
                tokens.push(Token { kind: Kind::Open(from), span: group.span_open(), raw: false });
                open.push((group.stream().into_iter(), Some((to, group.span_close()))));
            }
            TokenTree::Ident(identifier) => {
                let text = identifier.to_string();
                let (text, raw) = match text.strip_prefix("r#") {
                    Some(name) => (name.to_owned(), true),
                    None => (text, false),
                };
                tokens.push(Token { kind: Kind::Identifier(text), span: identifier.span(), raw });
            }
            TokenTree::Punct(mark) => tokens.push(Token {
                kind: Kind::Punctuation(mark.as_char(), mark.spacing() == Spacing::Joint),
                span: mark.span(),
                raw: false,
            }),
            TokenTree::Literal(literal) => {
                let (kind, span) = (Kind::Literal(literal.to_string()), literal.span());
                tokens.push(Token { kind, span, raw: false });
            }
        }
    }
    tokens.push(Token { kind: Kind::End, span: end, raw: false });
    Some(tokens)
}
