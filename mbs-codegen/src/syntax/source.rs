//! The text as the user laid it out, rebuilt from the tokens' positions.

use super::tokens::{Token, TokenKind};

/// Lines and indentation of `tokens` as in the source file, comments left out, the left margin removed.
///
/// Parsing the result gives the same tokens again.
pub fn layout(tokens: &[Token]) -> String {
    let margin = first_columns(tokens).min().unwrap_or(0);
    let mut text = String::new();
    let mut line = tokens.first().map_or(1, |token| token.span.start().line);
    let mut previous: Option<&Token> = None;
    let mut rest = tokens;
    let mut behind_comment = false;
    while let Some((token, behind)) = rest.split_first() {
        let start = token.span.start();
        if start.line > line {
            // Several blank lines become one: they often held comments, which are not tokens.
            text += if start.line > line + 1 { "\n\n" } else { "\n" };
            text.extend(std::iter::repeat_n(' ', start.column.saturating_sub(margin)));
        } else if behind_comment {
            text.push('\n');
        } else if previous.is_some_and(|previous| needs_space(previous, token)) {
            text.push(' ');
        }
        let comment = doc_comment(rest);
        behind_comment = comment.is_some();
        let (written, length) = comment.unwrap_or_else(|| (written(token), 1));
        text += &written;
        line = line.max(token.span.end().line);
        rest = rest.get(length..).unwrap_or(behind);
        previous = Some(token);
    }
    text
}

/// Column of the first token of each line.
fn first_columns(tokens: &[Token]) -> impl Iterator<Item = usize> + '_ {
    let mut line = 0;
    tokens.iter().filter(|token| token.kind != TokenKind::End).filter_map(move |token| {
        let start = token.span.start();
        let first = start.line > line;
        line = line.max(start.line);
        first.then_some(start.column)
    })
}

fn needs_space(previous: &Token, token: &Token) -> bool {
    let is_word = |token: &Token| matches!(token.kind, TokenKind::Identifier(_) | TokenKind::Literal(_));
    if is_word(previous) && is_word(token) {
        // Tokens of different files may seem to touch.
        return true;
    }
    let joint = matches!(previous.kind, TokenKind::Punctuation(_, true));
    let (end, start) = (previous.span.end(), token.span.start());
    !joint && token.kind != TokenKind::End && (end.line, end.column) != (start.line, start.column)
}

/// `/// text` where the tokens are the attribute that the compiler replaces it by, and the number of these tokens.
fn doc_comment(tokens: &[Token]) -> Option<(String, usize)> {
    let text = super::parser::doc_attribute(tokens)?;
    let [mark, bracket, ..] = tokens else { return None };
    let (mark, bracket) = (mark.span.start(), bracket.span.start());
    let is_comment = (mark.line, mark.column) == (bracket.line, bracket.column) && !text.contains('\n');
    is_comment.then(|| (format!("///{text}"), super::parser::DOC_ATTRIBUTE))
}

fn written(token: &Token) -> String {
    match &token.kind {
        TokenKind::Identifier(text) if token.raw => format!("r#{text}"),
        TokenKind::Identifier(text) | TokenKind::Literal(text) => text.clone(),
        TokenKind::Punctuation(character, _) | TokenKind::Open(character) | TokenKind::Close(character) => {
            character.to_string()
        }
        TokenKind::End => String::new(),
    }
}
