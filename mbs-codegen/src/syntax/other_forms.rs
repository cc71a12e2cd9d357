//! Statements in the forms of other languages: a name that is left out, a range in brackets, a rate behind a guess, fields in
//! parentheses. Each is one fault, whose cure is the statement in the user's own words.

use super::foreign_words;
use super::keywords::STATEMENTS;
use super::number_notations::is_declared;
use super::parser::{GivenUp, Parser, Read};
use super::quotation::{inside, length_of_group, operand_before, quoted, until_end, up_to_comma};
use super::tokens::{Token, TokenKind};
use crate::diagnostics::nearest;

fn is_word(token: &Token, word: &str) -> bool {
    matches!(&token.kind, TokenKind::Identifier(text) if text == word)
}

fn is_mark(token: &Token, mark: char) -> bool {
    matches!(token.kind, TokenKind::Punctuation(found, _) if found == mark)
}

/// Index of the first token outside of brackets that `is` wanted.
fn outermost(tokens: &[Token], is: impl Fn(&Token) -> bool) -> Option<usize> {
    let mut depth = 0_usize;
    tokens.iter().position(|token| {
        match token.kind {
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) => depth = depth.saturating_sub(1),
            _ if depth == 0 => return is(token),
            _ => {}
        }
        false
    })
}

/// Reports a statement whose name is left out, `drive phi == omega*t;`: `before` are the tokens behind its word, the cursor not past
/// its end. `None` where a name stands.
pub fn nameless<T>(parser: &mut Parser<'_>, word: &str, example: &str, begin: &[Token]) -> Option<Read<T>> {
    let first = begin.first()?;
    let read = begin.len().saturating_sub(parser.rest().len());
    let is_expression = match (read, parser.peek()) {
        (0, TokenKind::Literal(_) | TokenKind::Open('(')) | (1, TokenKind::Open('(')) => true,
        (0, TokenKind::Punctuation(sign, _)) => *sign == '-',
        (1, TokenKind::Punctuation(sign, _)) => {
            matches!(sign, '+' | '-' | '*' | '/' | '^' | '<' | '>' | '=') && !parser.at_pair('=', '>')
        }
        _ => false,
    };
    if !is_expression {
        return None;
    }
    let span = first.span;
    let statement = quoted(begin.get(..read + until_end(parser).len()).unwrap_or_default());
    parser.diagnostics.report(
        span,
        format!("a `{word}` has a name in front of its condition or equation"),
        format!("write `{word} {example}: {statement};`"),
    );
    Some(Err(GivenUp))
}

/// Reports `drive phi: omega*t;`, whose motion begins at the cursor; `None` where there is an equation.
pub fn drive_of_a_coordinate<T>(parser: &mut Parser<'_>, name: &str) -> Option<Read<T>> {
    let motion = until_end(parser);
    let has_equals = motion.iter().skip(1).any(|token| is_mark(token, '='));
    if has_equals || motion.is_empty() || !is_declared(parser, name) {
        return None;
    }
    let motion = quoted(match motion {
        [sign, rest @ ..] if is_mark(sign, '=') => rest,
        motion => motion,
    });
    parser.diagnostics.report(
        parser.span(),
        "a drive has a name of its own in front of its equation",
        format!("write `drive motor: {name} == {motion};`"),
    );
    Some(Err(GivenUp))
}

/// Reports a row without an equation, whose end is at the cursor; `begin` are the tokens from its left side on.
pub fn one_side<T>(parser: &mut Parser<'_>, begin: &[Token]) -> Read<T> {
    let left = quoted(begin.get(..begin.len().saturating_sub(parser.rest().len())).unwrap_or_default());
    parser.diagnostics.report(
        parser.span(),
        "an equation has two sides",
        format!("write what the left one equals: `{left} == 0;`"),
    );
    Err(GivenUp)
}

/// Reports a second `==`, which is at the cursor; `middle` are the tokens between both.
pub fn second_equals<T>(parser: &mut Parser<'_>, middle: &[Token]) -> Read<T> {
    let span = parser.span();
    parser.skip(2);
    let last = quoted(until_end(parser));
    parser.diagnostics.report(
        span,
        "an equation has one `==`",
        format!("leave out one side, or write two equations, the second as `{} == {last};`", quoted(middle)),
    );
    Err(GivenUp)
}

/// Reports a colon in place of the braces of a constraint, which is at the cursor.
pub fn rows_without_braces<T>(parser: &mut Parser<'_>, name: &str) -> Read<T> {
    let span = parser.span();
    let rows = quoted(parser.rest().get(1..).map_or(&[], |rest| up_to_comma(rest)));
    parser.diagnostics.report(
        span,
        "the equations of a constraint stand in braces",
        format!("write `constraint {name} {{ {rows}; }}`"),
    );
    Err(GivenUp)
}

/// Reports fields in parentheses, the first of which is at the cursor; `None` where there are no fields.
pub fn fields_in_parentheses<T>(parser: &mut Parser<'_>, name: &str) -> Option<Read<T>> {
    let fields = match parser.rest() {
        [open, field, sign, ..] if open.kind == TokenKind::Open('(') => match (&field.kind, &sign.kind) {
            (TokenKind::Identifier(_), TokenKind::Punctuation(':' | '=', _)) => {
                inside(parser.rest().get(1..)?)
            }
            _ => return None,
        },
        _ => return None,
    };
    let colon = |token: &Token| match token.kind {
        TokenKind::Punctuation('=', joint) => {
            Token { kind: TokenKind::Punctuation(':', joint), ..token.clone() }
        }
        _ => token.clone(),
    };
    let fields = quoted(&fields.iter().map(colon).collect::<Vec<_>>()).replace(" : ", ": ");
    parser.diagnostics.report(
        parser.span(),
        "fields stand in braces",
        format!("write `{name} {{ {fields} }}`, without a `;` behind"),
    );
    Some(Err(GivenUp))
}

/// Reports a value behind the declaration of an input, whose `=` is at the cursor.
pub fn value_of_an_input<T>(parser: &mut Parser<'_>, name: &str, unit: &str) -> Read<T> {
    let span = parser.span();
    let rest = parser.rest().get(1..).unwrap_or_default();
    let value = up_to_comma(rest);
    let has_rates = until_end(parser).iter().any(|token| is_word(token, "rates"));
    let help = match has_rates {
        true => format!("write `input {name}: {unit}, rates;`"),
        false => format!(
            "write `input {name}: {unit};`, or declare a value of the text: `param {name}: {unit} = {};`",
            quoted(value)
        ),
    };
    parser.diagnostics.report(span, "an input has no value: the program sets it before each step", help);
    Err(GivenUp)
}

/// Reports `rate …` behind the guess of a coordinate, which is at the cursor.
pub fn rate_of_a_guess<T>(parser: &mut Parser<'_>, name: &str) -> Read<T> {
    let value = quoted(operand_before(parser));
    let rate = quoted(parser.rest().get(1..).map_or(&[], |rest| up_to_comma(rest)));
    parser.diagnostics.report(
        parser.span(),
        "a guess has no rate",
        format!(
            "write how the motion begins in a statement of its own: `start {name} = {value} rate {rate};`"
        ),
    );
    Err(GivenUp)
}

/// Reports `rate …` behind the value of a state, which is at the cursor.
pub fn rate_of_a_state<T>(parser: &mut Parser<'_>, name: &str) -> Read<T> {
    let rate = quoted(parser.rest().get(1..).map_or(&[], |rest| up_to_comma(rest)));
    parser.diagnostics.report(
        parser.span(),
        "the rate of a state has a statement of its own",
        format!("write `der({name}) == {rate};` behind the state"),
    );
    Err(GivenUp)
}

/// Reports `start phi: 0.4, rate: 2;`, whose colon is at the cursor; `coordinate` are the tokens before it.
pub fn start_with_a_colon<T>(parser: &mut Parser<'_>, coordinate: &[Token]) -> Read<T> {
    let span = parser.span();
    let rest = until_end(parser).get(1..).unwrap_or_default();
    let value = up_to_comma(rest);
    let at = outermost(rest, |token| is_word(token, "rate"));
    let rate = at.and_then(|at| rest.get(at + 1..)).unwrap_or_default();
    let rate = match rest.get(at.map_or(0, |at| at + 1)) {
        Some(sign) if at.is_some() && (is_mark(sign, ':') || is_mark(sign, '=')) => {
            rate.get(1..).unwrap_or_default()
        }
        _ => rate,
    };
    let value = match at {
        Some(at) if at < value.len() => value.get(..at).unwrap_or_default(),
        _ => value,
    };
    let rate = if rate.is_empty() { String::new() } else { format!(" rate {}", quoted(rate)) };
    parser.diagnostics.report(
        span,
        "a start sets its value with `=`",
        format!("write `start {} = {}{rate};`", quoted(coordinate), quoted(value)),
    );
    Err(GivenUp)
}

/// Reports `start der(phi) = 2;`, whose function is at the cursor; `None` where a coordinate stands.
pub fn start_of_a_rate<T>(parser: &mut Parser<'_>) -> Option<Read<T>> {
    let is_rate =
        matches!(parser.peek(), TokenKind::Identifier(word) if matches!(word.as_str(), "der" | "rate"));
    if !is_rate || *parser.peek_at(1) != TokenKind::Open('(') {
        return None;
    }
    let length = length_of_group(parser.rest().get(1..)?);
    let coordinate = quoted(parser.rest().get(2..length)?);
    let behind = parser.rest().get(length + 1..)?;
    let value = match behind {
        [sign, value @ ..] if is_mark(sign, '=') => up_to_comma(value),
        _ => &[],
    };
    parser.diagnostics.report(
        parser.span(),
        "a start names its coordinate, and the rate behind the value",
        format!("write `start {coordinate} = … rate {};`", quoted(value)),
    );
    Some(Err(GivenUp))
}

/// Marks and words that divide the ends of a range elsewhere.
fn divides(token: &Token) -> bool {
    ["to", "until", "and", "bis"].iter().any(|word| is_word(token, word))
        || [',', ';', ':', '-'].iter().any(|mark| is_mark(token, *mark))
}

/// Reports a range that is not written `low..high`, which begins at the cursor behind its `in`; `None` where one is.
pub fn range_of_two<T>(parser: &mut Parser<'_>) -> Option<Read<T>> {
    let all = until_end(parser);
    let tolerance = all
        .windows(2)
        .position(|pair| matches!(pair, [comma, word] if is_mark(comma, ',') && is_word(word, "tolerance")));
    let mut range = all.get(..tolerance.unwrap_or(all.len()))?;
    if let Some(TokenKind::Open('[' | '(')) = range.first().map(|token| &token.kind)
        && length_of_group(range) == range.len()
    {
        range = range.get(1..range.len() - 1)?;
    }
    let has_dots = range.windows(2).any(|pair| pair.iter().all(|token| is_mark(token, '.')));
    // The sign of the first end divides nothing.
    let sign = usize::from(range.first().is_some_and(|token| is_mark(token, '-')));
    let at = match has_dots {
        true if range.len() == all.get(..tolerance.unwrap_or(all.len()))?.len() => return None,
        true => range.windows(2).position(|pair| pair.iter().all(|token| is_mark(token, '.')))?,
        false => sign + outermost(range.get(sign..)?, divides)?,
    };
    let low = quoted(range.get(..at)?);
    let high = quoted(range.get(at + if has_dots { 2 } else { 1 }..)?);
    let span = if has_dots { parser.span() } else { range.get(at)?.span };
    parser.diagnostics.report(
        span,
        "a range has two dots between its ends",
        format!("write `in {low}..{high}`"),
    );
    Some(Err(GivenUp))
}

/// Reports a tolerance without its comma, or with a sign behind its word, and reads on at its value; `false` where none stands.
pub fn takes_tolerance(parser: &mut Parser<'_>) -> bool {
    let comma = usize::from(matches!(parser.peek(), TokenKind::Punctuation(',', _)));
    if !matches!(parser.peek_at(comma), TokenKind::Identifier(word) if word == "tolerance") {
        return false;
    }
    let value = |from: usize| quoted(parser.rest().get(from..).map_or(&[], |rest| up_to_comma(rest)));
    let sign = matches!(parser.peek_at(comma + 1), TokenKind::Punctuation(':' | '=', _));
    let value = value(comma + 1 + usize::from(sign));
    if comma == 0 {
        parser.diagnostics.report(
            parser.span(),
            "a comma is missing in front of `tolerance`",
            format!("write `, tolerance {value}`"),
        );
    } else if sign {
        let span = parser.rest().get(comma + 1).map_or_else(|| parser.span(), |token| token.span);
        parser.diagnostics.report(
            span,
            "the value of a tolerance stands behind its word",
            format!("write `, tolerance {value}`"),
        );
    }
    parser.skip(comma);
    parser.take_word("tolerance");
    parser.skip(usize::from(sign));
    true
}

/// Reports `limit stroke: x in 0.1..0.3;`, whose `in` is at the cursor behind the quantity.
pub fn limit_as_a_range<T>(parser: &mut Parser<'_>, name: &str, quantity: &[Token]) -> Read<T> {
    let rest = until_end(parser).get(1..).unwrap_or_default();
    let dots = rest.windows(2).position(|pair| pair.iter().all(|token| is_mark(token, '.')));
    let quantity = quoted(quantity);
    let help = match dots {
        Some(at) => format!(
            "write `limit {name}: {} <= {quantity} <= {};`",
            quoted(rest.get(..at).unwrap_or_default()),
            quoted(rest.get(at + 2..).unwrap_or_default())
        ),
        None => format!("write `limit {name}: … <= {quantity} <= …;`"),
    };
    parser.diagnostics.report(parser.span(), "a limit is written with `<=`", help);
    Err(GivenUp)
}

/// Words of other languages that a text has no statement for, and its cure.
const NO_STATEMENTS: [(&[&str], &str, &str); 6] = [
    (
        &["use", "import", "include", "from"],
        "a text is complete in itself",
        "remove the line: `PI` and `TAU` are known, functions of the caller are declared with `function`",
    ),
    (
        &["print", "println", "plot", "show", "display", "disp", "log", "return", "monitor"],
        "a text computes nothing in order",
        "name what is to be seen as an output, `out speed: m/s = der(x);`: `mbs` prints and draws outputs",
    ),
    (&["redundant"], "the mark stands behind the name", "write `constraint closure redundant { … }`"),
    (
        &["while", "loop", "repeat"],
        "a text repeats statements a fixed number of times",
        "write `for i in 0..3 { … }`",
    ),
    (
        &["end", "endif", "endfor", "begin", "endmodel"],
        "a text ends with its last statement",
        "remove the word: loops, effects and constraints end with `}`",
    ),
    (
        &["solve", "simulate", "integrate", "run", "solver", "step", "dt"],
        "a text says nothing of its solution",
        "choose times, steps and methods where the mechanism runs: `mbs run FILE --until 2 --steps 500`",
    ),
];

/// Message and cure at a word that begins no statement, where it is one that other languages have.
pub fn no_statement(word: &str) -> Option<(String, &'static str)> {
    NO_STATEMENTS
        .iter()
        .find(|(words, ..)| words.contains(&word))
        .map(|(_, reason, help)| (format!("`{word}` begins no statement: {reason}"), *help))
}

/// Keyword and name of a statement without a blank between them, `coordphi`, at the cursor. A word that is near to a keyword
/// may be a slip, `limits`, unless the text uses the name.
pub fn glued<'a>(parser: &Parser<'_>, word: &'a str) -> Option<(&'static str, &'a str)> {
    let sign = matches!(parser.peek_at(1), TokenKind::Punctuation(':' | '=', _) | TokenKind::Open('{'));
    let means_another = foreign_words::meant(word).is_some() || foreign_words::one_of_two(word).is_some();
    if !sign || means_another {
        return None;
    }
    let split = |keyword: &&'static str| {
        let name = word.strip_prefix(*keyword)?;
        name.starts_with(|first: char| first.is_alphabetic()).then_some((*keyword, name))
    };
    let (keyword, name) = STATEMENTS.iter().find_map(split)?;
    let is_used = parser.before().iter().chain(parser.rest()).any(|token| is_word(token, name));
    (is_used || nearest(word, STATEMENTS).is_none()).then_some((keyword, name))
}

/// `true` at a `,`, `:` or `.` in place of the `;` that ends a statement: the next line begins another one.
pub fn at_wrong_end(parser: &Parser<'_>) -> bool {
    let [sign, behind, ..] = parser.rest() else { return false };
    let is_sign = [',', ':', '.'].iter().any(|mark| is_mark(sign, *mark));
    let is_behind = matches!(&behind.kind, TokenKind::Identifier(word) if STATEMENTS.contains(&word.as_str()))
        && behind.span.start().line > sign.span.start().line;
    is_sign && (is_behind || behind.kind == TokenKind::End)
}

/// Takes such a sign, which is reported; `true` if there was any.
pub fn takes_wrong_end(parser: &mut Parser<'_>) -> bool {
    let is_wrong = at_wrong_end(parser);
    if is_wrong {
        let sign = parser.rest().first().map_or_else(String::new, Token::describe);
        let message = format!("a statement ends with `;`, not with {sign}");
        parser.diagnostics.report(parser.span(), message, "write `;` in its place");
        parser.skip(1);
    }
    is_wrong
}

/// Reports `coord phi: rad[3]`, whose bracket is at the cursor behind the unit; `None` where there is none.
pub fn shape_behind_a_unit<T>(parser: &mut Parser<'_>, unit: &str) -> Option<Read<T>> {
    if *parser.peek() != TokenKind::Open('[') {
        return None;
    }
    let lengths = quoted(inside(parser.rest().get(1..)?));
    parser.diagnostics.report(
        parser.span(),
        "the lengths of an array stand in one bracket with its unit",
        format!("write `[{unit}; {lengths}]`"),
    );
    Some(Err(GivenUp))
}

/// The inverse of a function that `sin^-1` means, which is at the end of the tokens before the cursor.
pub fn inverse(before: &[Token]) -> Option<&'static str> {
    let [.., function, power, minus, one] = before else { return None };
    let is_one = matches!(&one.kind, TokenKind::Literal(text) if text == "1");
    let TokenKind::Identifier(name) = &function.kind else { return None };
    let inverses = [
        ("sin", "asin"),
        ("cos", "acos"),
        ("tan", "atan"),
        ("sinh", "asinh"),
        ("cosh", "acosh"),
        ("tanh", "atanh"),
    ];
    let inverse = inverses.iter().find(|(known, _)| known == name)?.1;
    (is_one && is_mark(power, '^') && is_mark(minus, '-')).then_some(inverse)
}
