//! Token trees → one flat list with measured depth.

use proc_macro2::{Delimiter, Group, Spacing, Span, TokenStream, TokenTree};

use crate::diagnostics::Diagnostics;

/// Deepest nesting that is read; `syn` and `rustc` itself overflow their stacks somewhat beyond twice this.
pub const DEEPEST: usize = 256;
/// Longest text that is read, in tokens.
pub const LONGEST: usize = 200_000;

/// Most characters of a token that a message quotes.
const LONGEST_QUOTE: usize = 40;

/// A token of the flat list.
#[derive(Clone, Debug)]
pub struct Token {
    pub kind: TokenKind,
    pub span: Span,
    /// `true` if an identifier was written `r#so`.
    pub raw: bool,
}

/// Kind of a [`Token`].
#[derive(Clone, Debug, PartialEq)]
pub enum TokenKind {
    /// Without the `r#` of a raw identifier.
    Identifier(String),
    Literal(String),
    /// `true` if another punctuation character follows at once.
    Punctuation(char, bool),
    Open(char),
    Close(char),
    /// After the last token.
    End,
}

impl Token {
    /// Quotation in a message, which is one line.
    pub fn describe(&self) -> String {
        match &self.kind {
            TokenKind::Identifier(text) | TokenKind::Literal(text) => {
                let shown: String =
                    text.chars().take_while(|c| !c.is_control()).take(LONGEST_QUOTE).collect();
                let rest = if shown.len() < text.len() { "…" } else { "" };
                format!("`{shown}{rest}`")
            }
            TokenKind::Punctuation(character, _)
            | TokenKind::Open(character)
            | TokenKind::Close(character) => {
                format!("`{character}`")
            }
            TokenKind::End => "the end of the text".into(),
        }
    }
}

/// Before: any token stream. After: one list, groups as `Open` and `Close`, `End` last. Tokens nested deeper than
/// [`DEEPEST`] or beyond [`LONGEST`] are reported and left out.
///
/// Groups without delimiters are dissolved. One next to an operator is put in parentheses, because `2*$e` of a
/// `macro_rules!` means twice the whole of `$e`.
pub fn flatten(stream: TokenStream, diagnostics: &mut Diagnostics) -> Vec<Token> {
    let mut tokens: Vec<Token> = Vec::new();
    // Tokens up to the end of the last whole statement.
    let mut whole = 0;
    let mut end = Span::call_site();
    let mut too_deep = false;
    let mut open = vec![(stream.into_iter().peekable(), None)];
    loop {
        let depth = open.len();
        let Some((rest, close)) = open.last_mut() else { break };
        let Some(tree) = rest.next() else {
            if let Some((character, span)) = close.take() {
                tokens.push(Token { kind: TokenKind::Close(character), span, raw: false });
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
            tokens.truncate(whole);
            break;
        }
        match tree {
            TokenTree::Group(group) if depth > DEEPEST => {
                // A zero fits in place of any expression, so that no further fault follows.
                tokens.push(Token {
                    kind: TokenKind::Literal("0".into()),
                    span: group.span_open(),
                    raw: false,
                });
                if !too_deep {
                    diagnostics.report(
                        group.span_open(),
                        format!("brackets nest deeper than {DEEPEST} levels here"),
                        "name a part of the expression with `let` and use the name",
                    );
                }
                too_deep = true;
            }
            TokenTree::Group(group) => {
                let delimiters = match group.delimiter() {
                    Delimiter::Parenthesis => Some(('(', ')')),
                    Delimiter::Bracket => Some(('[', ']')),
                    Delimiter::Brace => Some(('{', '}')),
                    Delimiter::None => binds(tokens.last(), &group, rest.peek()).then_some(('(', ')')),
                };
                let inner = group.stream().into_iter().peekable();
                let close = delimiters.map(|(from, to)| {
                    tokens.push(Token { kind: TokenKind::Open(from), span: group.span_open(), raw: false });
                    (to, group.span_close())
                });
                open.push((inner, close));
            }
            TokenTree::Ident(identifier) => {
                let text = identifier.to_string();
                let (text, raw) = match text.strip_prefix("r#") {
                    Some(name) => (name.to_owned(), true),
                    None => (text, false),
                };
                tokens.push(Token { kind: TokenKind::Identifier(text), span: identifier.span(), raw });
            }
            TokenTree::Punct(mark) => {
                tokens.push(Token {
                    kind: TokenKind::Punctuation(mark.as_char(), mark.spacing() == Spacing::Joint),
                    span: mark.span(),
                    raw: false,
                });
                if mark.as_char() == ';' && depth == 1 {
                    whole = tokens.len();
                }
            }
            TokenTree::Literal(literal) => {
                let (kind, span) = (TokenKind::Literal(literal.to_string()), literal.span());
                tokens.push(Token { kind, span, raw: false });
            }
        }
    }
    tokens.push(Token { kind: TokenKind::End, span: end, raw: false });
    tokens
}

/// `true` if an operator next to a group without delimiters would take it apart.
///
/// `$e^2` with `4m` for `$e` has one reading, where the text `4m^2` has two. The number `-4` may have its unit after it.
fn binds(previous: Option<&Token>, group: &Group, next: Option<&TokenTree>) -> bool {
    let content: Vec<TokenTree> = group.stream().into_iter().take(3).collect();
    let (is_literal, is_number, is_one_token) = match content.as_slice() {
        [TokenTree::Literal(_)] => (true, true, true),
        [TokenTree::Punct(minus), TokenTree::Literal(_)] => (false, minus.as_char() == '-', false),
        [TokenTree::Group(_)] => (false, false, false),
        [_] | [] => (false, false, true),
        _ => (false, false, false),
    };
    let behind = previous
        .is_some_and(|token| matches!(token.kind, TokenKind::Punctuation('+' | '-' | '*' | '/' | '^', _)));
    let before = match next {
        Some(TokenTree::Punct(mark)) => match mark.as_char() {
            '^' if is_literal => return true,
            '.' => mark.spacing() == Spacing::Alone,
            character => matches!(character, '+' | '-' | '*' | '/' | '^'),
        },
        Some(TokenTree::Group(index)) if index.delimiter() == Delimiter::Bracket => {
            if is_number {
                return false;
            }
            true
        }
        _ => false,
    };
    !is_one_token && (behind || before)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(stream: TokenStream) -> String {
        let tokens = flatten(stream, &mut Diagnostics::default());
        let words = tokens.iter().filter(|token| token.kind != TokenKind::End).map(Token::describe);
        words.collect::<String>().replace('`', "")
    }

    fn undelimited(text: &str) -> TokenTree {
        Group::new(Delimiter::None, text.parse().expect("tokens")).into()
    }

    #[test]
    fn an_expression_of_a_macro_is_one_operand() {
        let mut text: TokenStream = "2*".parse().expect("tokens");
        text.extend([undelimited("a + b")]);
        assert_eq!(words(text.clone()), "2*(a+b)");
        let nested = TokenTree::from(Group::new(Delimiter::None, text));
        let power = "^2".parse::<TokenStream>().expect("tokens");
        assert_eq!(words(std::iter::once(nested).chain(power).collect()), "(2*(a+b))^2");
    }

    #[test]
    fn a_number_of_a_macro_is_one_operand() {
        for (number, behind, read) in [
            ("4m", "^2", "(4m)^2"),
            ("4", "[m^2]", "4[m^2]"),
            ("-4", "[m^2]", "-4[m^2]"),
            ("-4", "^2", "(-4)^2"),
        ] {
            let behind = behind.parse::<TokenStream>().expect("tokens");
            assert_eq!(words(std::iter::once(undelimited(number)).chain(behind).collect()), read);
        }
    }

    #[test]
    fn groups_without_delimiters_are_looked_through_elsewhere() {
        let text = ["x", "=="].map(|word| word.parse::<TokenStream>().expect("tokens"));
        let mut text: TokenStream = text.into_iter().collect();
        text.extend([undelimited("a + b")]);
        text.extend(";".parse::<TokenStream>().expect("tokens"));
        text.extend([undelimited("const L: m = 1;")]);
        assert_eq!(words(text), "x==a+b;constL:m=1;");
    }

    #[test]
    fn groups_without_delimiters_count_as_nesting() {
        let mut stream: TokenStream = "x".parse().expect("tokens");
        for _ in 0..10_000 {
            stream = TokenTree::from(Group::new(Delimiter::None, stream)).into();
        }
        let mut diagnostics = Diagnostics::default();
        assert!(flatten(stream, &mut diagnostics).len() < DEEPEST);
        assert!(diagnostics.to_text().contains("nest deeper"));
    }
}
