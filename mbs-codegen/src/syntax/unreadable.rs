//! Texts that are no tokens of Rust: the character or bracket at which reading ends, and its cure.
//!
//! In a Rust source the compiler's lexer reports these before a macro sees them; texts kept as strings are explained here.

use proc_macro2::{Span, TokenStream};

/// Place of a fault, with message and cure; line and column count from 1.
#[derive(Debug, PartialEq)]
pub struct Unreadable {
    pub line: usize,
    pub column: usize,
    pub message: String,
    pub help: String,
}

/// Characters that are none of Rust's, and what stands in their place.
const CHARACTERS: [(&str, &str); 17] = [
    ("×⋅∙∗", "write a product with `*`"),
    ("÷", "write a quotient with `/`"),
    ("−–—", "write a minus sign with `-`"),
    ("≠", "write `<` or `>`, which tell two assemblies apart"),
    ("≤", "write `<=`"),
    ("≥", "write `<=` and the larger side behind it"),
    ("≡", "write `==`"),
    ("±", "write a tolerance behind a comma: `, tolerance 0.1mm`"),
    ("⁰¹⁴⁵⁶⁷⁸⁹⁻", "write a power with `^`: `x^4`"),
    ("₀₁₂₃₄₅₆₇₈₉", "write an index as digits of the name: `phi1`"),
    ("“”„«»", "write straight quotes: `\"`"),
    ("\\", "write a quotient with `/`"),
    ("²", "write a square as `^2`"),
    ("³", "write a cube as `^3`"),
    ("√", "write a root as `sqrt(x)`"),
    ("½¼¾", "write a fraction as a number: `0.5`"),
    ("´’′‘`˙", "write a rate as `der(x)`, an acceleration as `der2(x)`"),
];

/// The first fault of a text that the lexer refuses; `None` where it is none of those that are known.
pub fn unreadable(source: &str) -> Option<Unreadable> {
    scan(source, false)
}

/// The first fault of a call of `mechanism!` in a Rust source that the lexer refuses, at its place in the source; `None` where the
/// source is at fault elsewhere.
pub fn unreadable_call(rust: &str) -> Option<Unreadable> {
    const CALL: &str = "mechanism!";
    rust.match_indices(CALL).find_map(|(at, _)| {
        let begin = at + CALL.len();
        let behind = rust.get(begin..)?;
        let is_call = behind.trim_start().starts_with(['{', '(', '[']);
        let before = rust.get(..begin)?;
        // A line comment, or a name that ends alike.
        let line = before.rsplit('\n').next().unwrap_or_default();
        let is_word = line.strip_suffix(CALL)?.ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let fault =
            if is_call && !is_word && !line.contains("//") { scan(behind, true)? } else { return None };
        let column = if fault.line == 1 { fault.column + line.chars().count() } else { fault.column };
        Some(Unreadable { line: fault.line + before.matches('\n').count(), column, ..fault })
    })
}

/// Columns that a line begins with blank.
#[derive(Default)]
struct Indentation {
    columns: usize,
    /// `true` at the first character of the line that is not blank.
    is_first: bool,
    is_inside: bool,
}

impl Indentation {
    fn see(&mut self, character: char, column: usize) {
        if character == '\n' {
            *self = Indentation::default();
            return;
        }
        self.is_first = !self.is_inside && !character.is_whitespace();
        if self.is_first {
            (self.columns, self.is_inside) = (column - 1, true);
        }
    }
}

/// `is_call`: the text stands in brackets, behind which the scan ends.
fn scan(source: &str, is_call: bool) -> Option<Unreadable> {
    let mut open: Vec<(char, usize, usize, usize)> = Vec::new();
    let (mut line, mut column) = (1, 0);
    let mut characters = source.chars().peekable();
    // First character of the word that the previous one ends, and the last word or number.
    let (mut previous, mut first) = (' ', ' ');
    let mut word = String::new();
    // Indentation of the line, and the first brace whose own line is indented deeper than the one that closes it.
    let mut indentation = Indentation::default();
    let mut doubtful = None;
    let fault = |line, column, message: String, help: &str| {
        Some(Unreadable { line, column, message, help: help.into() })
    };
    while let Some(character) = characters.next() {
        column += 1;
        indentation.see(character, column);
        match character {
            '\n' => (line, column) = (line + 1, 0),
            '/' if characters.peek() == Some(&'/') => {
                while characters.peek().is_some_and(|next| *next != '\n') {
                    characters.next();
                }
            }
            '/' if characters.peek() == Some(&'*') => {
                characters.next();
                column += 1;
                let mut last = ' ';
                for next in characters.by_ref() {
                    column += 1;
                    if next == '\n' {
                        (line, column) = (line + 1, 0);
                    }
                    if (last, next) == ('*', '/') {
                        break;
                    }
                    last = next;
                }
            }
            '"' if first.is_ascii_digit() => {
                return fault(line, column, "a quote is no unit".into(), "write inches as a unit: `2inch`");
            }
            '"' => {
                let begin = (line, column);
                let mut is_closed = false;
                let mut escaped = false;
                for next in characters.by_ref() {
                    column += 1;
                    if next == '\n' {
                        (line, column) = (line + 1, 0);
                    }
                    is_closed = next == '"' && !escaped;
                    escaped = next == '\\' && !escaped;
                    if is_closed {
                        break;
                    }
                }
                if !is_closed {
                    return fault(
                        begin.0,
                        begin.1,
                        "this quote is never closed".into(),
                        "close it with `\"`",
                    );
                }
            }
            '\'' if first.is_ascii_digit() => {
                let help =
                    "write thousands without a sign, `1000`, and feet or minutes of arc in another unit";
                return fault(line, column, "a tick stands behind a number".into(), help);
            }
            '\'' if previous.is_alphanumeric() || matches!(previous, '_' | ')' | ']') => {
                let of = if previous == '_' || previous.is_alphanumeric() { word.as_str() } else { "x" };
                let help = match characters.peek() {
                    Some('\'') => format!("write an acceleration as `der2({of})`"),
                    _ => format!("write a rate as `der({of})`, an acceleration as `der2({of})`"),
                };
                return fault(line, column, "a tick is no derivative".into(), &help);
            }
            '°' | 'º' => {
                let number = if word.parse::<f64>().is_ok() { word.as_str() } else { "50" };
                let help = format!("write degrees as a unit: `{number}deg`");
                return fault(line, column, format!("`{character}` is no character of a text"), &help);
            }
            '(' | '[' | '{' => open.push((character, line, column, indentation.columns)),
            ')' | ']' | '}' => match open.pop() {
                None => {
                    let message = format!("`{character}` closes no bracket");
                    return fault(line, column, message, "remove it, or open the bracket that it closes");
                }
                Some((bracket, at, place, columns)) if closing(bracket) == character => {
                    if indentation.is_first && indentation.columns < columns && at < line {
                        doubtful = doubtful.or(Some((bracket, at, place)));
                    }
                    if is_call && open.is_empty() {
                        return None;
                    }
                }
                Some(_) if !open.iter().any(|(outer, ..)| closing(*outer) == character) => {
                    let message = format!("`{character}` closes no bracket");
                    return fault(line, column, message, "remove it, or open the bracket that it closes");
                }
                Some((bracket, line, column, _)) => {
                    let (message, help) = (
                        format!("`{bracket}` is never closed"),
                        format!("close it with `{}`", closing(bracket)),
                    );
                    return fault(line, column, message, &help);
                }
            },
            _ => {
                if let Some((_, help)) = CHARACTERS.iter().find(|(known, _)| known.contains(character)) {
                    return fault(line, column, format!("`{character}` is no character of a text"), help);
                }
                let is_of_a_name = character.is_alphanumeric();
                if !character.is_ascii() && !character.is_whitespace() && !is_of_a_name {
                    let help = "names consist of letters, digits and `_`, signs are those of the keyboard";
                    return fault(line, column, format!("`{character}` is no character of a text"), help);
                }
            }
        }
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        first = match (is_word(previous), is_word(character)) {
            (true, true) => first,
            (false, true) => character,
            _ => ' ',
        };
        let is_number = word.starts_with(|c: char| c.is_ascii_digit());
        let is_point = character == '.' && previous.is_ascii_digit() && is_number;
        if is_word(character) || is_point {
            if !(is_word(previous) || previous == '.' && word.ends_with('.')) {
                word.clear();
            }
            word.push(character);
        }
        previous = character;
    }
    let (bracket, line, column, _) = open.pop()?;
    let (bracket, line, column) = doubtful.unwrap_or((bracket, line, column));
    if bracket == '{'
        && let Some(header) = header_before(source, line, column)
    {
        let help = format!("end the header with a `;` in its place: `{header};`");
        return fault(line, column, "the statements of a text stand in no braces".into(), &help);
    }
    fault(
        line,
        column,
        format!("`{bracket}` is never closed"),
        &format!("close it with `{}`", closing(bracket)),
    )
}

/// `pub mechanism Name` in front of a bracket.
fn header_before(source: &str, line: usize, column: usize) -> Option<&str> {
    let line = source.lines().nth(line.checked_sub(1)?)?;
    let end = line.char_indices().nth(column.checked_sub(1)?)?.0;
    let header = line.get(..end)?.trim();
    let words: Vec<&str> = header.split_whitespace().collect();
    matches!(words.as_slice(), ["mechanism", _] | [.., "pub", "mechanism", _]).then_some(header)
}

fn closing(bracket: char) -> char {
    match bracket {
        '(' => ')',
        '[' => ']',
        _ => '}',
    }
}

/// A token's span at a place, in a text of blanks.
pub fn span_at(line: usize, column: usize) -> Span {
    let blanks = format!("{}{}x", "\n".repeat(line.saturating_sub(1)), " ".repeat(column.saturating_sub(1)));
    let token = blanks.parse::<TokenStream>().ok().and_then(|tokens| tokens.into_iter().next());
    token.map_or_else(Span::call_site, |token| token.span())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_is_that_of_the_character_or_of_the_open_bracket() {
        let place = |text: &str| unreadable(text).map(|fault| (fault.line, fault.column));
        assert_eq!(place("a\n  50°;"), Some((2, 5)));
        assert_eq!(place("out w: rad/s = phi';"), Some((1, 19)));
        assert_eq!(place("{ [a, (b; }"), Some((1, 7)));
        assert_eq!(place("{ (a) // [\n"), Some((1, 1)));
        assert_eq!(place("a)"), Some((1, 2)));
        let message = |text: &str| unreadable(text).map(|fault| fault.message).unwrap_or_default();
        assert_eq!(message("L1 == 5'"), "a tick stands behind a number");
        assert_eq!(message("L1 == phi1'"), "a tick is no derivative");
        assert_eq!(message("L1 == 2\""), "a quote is no unit");
        assert_eq!(place("title \"a°b\"; (c)"), None);
        let help = |text: &str| unreadable(text).map(|fault| fault.help).unwrap_or_default();
        assert_eq!(help("a = sin(phi + 22.5°)"), "write degrees as a unit: `22.5deg`");
        assert_eq!(help("a = 90 °"), "write degrees as a unit: `90deg`");
        assert_eq!(help("w = theta''"), "write an acceleration as `der2(theta)`");
        assert_eq!(help("w = (a + b)'"), "write a rate as `der(x)`, an acceleration as `der2(x)`");
        // The brace whose block ends at a line that is indented less.
        assert_eq!(place("m {\n    a {\n        b;\n    c {\n        d;\n    }\n}\n"), Some((2, 7)));
        assert_eq!(place("m {\n    a { b; }\n"), Some((1, 3)));
        let span = span_at(3, 7).start();
        assert_eq!((span.line, span.column), (3, 6));
    }

    #[test]
    fn a_call_in_a_rust_source_has_the_places_of_the_source() {
        let place = |text: &str| unreadable_call(text).map(|fault| (fault.line, fault.column));
        assert_eq!(place("//! No mechanism! here.\nfn f() {}\n\nmechanism! {\n  a = 5°;\n}\n"), Some((5, 8)));
        assert_eq!(place("mbs_runtime::mechanism! { phi' }"), Some((1, 30)));
        assert_eq!(place("mechanism! {\n  m { a;\n}\nfn g() {}\n"), Some((2, 5)));
        assert_eq!(place("mechanism! { a }\nfn g() { '"), None);
        assert_eq!(place("fn g() { ° }"), None);
    }
}
