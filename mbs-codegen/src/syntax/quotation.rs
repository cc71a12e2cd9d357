//! Parts of the text as messages quote them: the operand before the cursor, the one behind it, the rest of a statement.

use super::parser::Parser;
use super::source::layout;
use super::tokens::{Token, TokenKind};

/// Tokens of the operand that ends just before the cursor: a number, a name with indices, a call, a bracket.
pub fn operand_before<'a>(parser: &Parser<'a>) -> &'a [Token] {
    operand_at_end(parser.before())
}

/// Tokens of the operand that ends these.
pub fn operand_at_end(before: &[Token]) -> &[Token] {
    let mut from = before.len();
    while let Some(last) = from.checked_sub(1).and_then(|index| before.get(index)) {
        let is_index = |at: usize| {
            at.checked_sub(1)
                .and_then(|dot| before.get(dot))
                .is_some_and(|token| matches!(token.kind, TokenKind::Punctuation('.', _)))
        };
        match last.kind {
            TokenKind::Close(_) => {
                let Some(open) = matching_open(before, from - 1) else { break };
                from = open;
                // A call or an index has its name before the bracket.
                let name = from.checked_sub(1).and_then(|index| before.get(index));
                match name.map(|token| &token.kind) {
                    Some(TokenKind::Identifier(_)) => from -= 1,
                    Some(TokenKind::Close(')' | ']')) => continue,
                    _ => {}
                }
                break;
            }
            TokenKind::Literal(_) if is_index(from - 1) => from -= 2,
            TokenKind::Literal(_) | TokenKind::Identifier(_) => {
                from -= 1;
                break;
            }
            _ => break,
        }
    }
    before.get(from..).unwrap_or_default()
}

/// Index of the bracket that the one at `close` closes.
fn matching_open(tokens: &[Token], close: usize) -> Option<usize> {
    let mut depth = 0_usize;
    for index in (0..=close).rev() {
        match tokens.get(index)?.kind {
            TokenKind::Close(_) => depth += 1,
            TokenKind::Open(_) => depth = depth.checked_sub(1)?,
            _ => {}
        }
        if depth == 0 {
            return Some(index);
        }
    }
    None
}

/// Tokens of the operand that begins at the cursor.
pub fn operand_behind<'a>(parser: &Parser<'a>) -> &'a [Token] {
    let rest = parser.rest();
    let kind = |index: usize| rest.get(index).map(|token| &token.kind);
    let mut to = usize::from(matches!(kind(0), Some(TokenKind::Identifier(_) | TokenKind::Literal(_))));
    loop {
        match (kind(to), kind(to + 1)) {
            (Some(TokenKind::Open('(' | '[')), _) => {
                to += length_of_group(rest.get(to..).unwrap_or_default())
            }
            (Some(TokenKind::Punctuation('.', _)), Some(TokenKind::Literal(_))) => to += 2,
            _ => return rest.get(..to).unwrap_or_default(),
        }
    }
}

/// Number of tokens of the bracket that begins here.
pub fn length_of_group(tokens: &[Token]) -> usize {
    let mut depth = 0_usize;
    for (index, token) in tokens.iter().enumerate() {
        match token.kind {
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) => depth = depth.saturating_sub(1),
            TokenKind::End => return index,
            _ => {}
        }
        if depth == 0 {
            return index + 1;
        }
    }
    tokens.len()
}

/// Most characters of a part of the text that a cure quotes.
const LONGEST: usize = 60;

/// Part of the text as written, in one line; `…` where it is long.
pub fn quoted(tokens: &[Token]) -> String {
    let text = layout(tokens).split_whitespace().collect::<Vec<_>>().join(" ");
    if text.chars().count() > LONGEST { "…".into() } else { text }
}

/// Tokens up to a comma or `;` outside of brackets, or the bracket that closes around them.
pub fn up_to_comma(tokens: &[Token]) -> &[Token] {
    up_to(tokens, |mark| matches!(mark, ',' | ';'))
}

/// Tokens up to the bracket that closes around them.
pub fn inside(tokens: &[Token]) -> &[Token] {
    up_to(tokens, |_| false)
}

/// Tokens up to a mark outside of brackets, or the bracket that closes around them.
fn up_to(tokens: &[Token], is_end: impl Fn(char) -> bool) -> &[Token] {
    let mut depth = 0_usize;
    let inside = tokens.iter().take_while(|token| {
        match token.kind {
            TokenKind::End => return false,
            TokenKind::Punctuation(mark, _) if depth == 0 && is_end(mark) => return false,
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) if depth == 0 => return false,
            TokenKind::Close(_) => depth -= 1,
            _ => {}
        }
        true
    });
    let length = inside.count();
    tokens.get(..length).unwrap_or_default()
}

/// Tokens up to the end of the statement, outside of brackets.
pub fn until_end<'a>(parser: &Parser<'a>) -> &'a [Token] {
    up_to(parser.rest(), |mark| mark == ';')
}
