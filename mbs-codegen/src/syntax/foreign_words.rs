//! Words and signs of other languages where a statement, a field or an operand begins.

use super::ast::Element;
use super::parser::{GivenUp, Parser, Read};
use super::quotation::{inside, length_of_group, quoted, up_to_comma};
use super::tokens::{Token, TokenKind};

/// Words that begin a declaration elsewhere, and the statement that they mean.
const STATEMENTS_ELSEWHERE: [(&str, &str); 46] = [
    ("parameter", "param"),
    ("parameters", "param"),
    ("constant", "const"),
    ("variable", "coord"),
    ("variables", "coord"),
    ("var", "coord"),
    ("unknown", "coord"),
    ("dof", "coord"),
    ("coordinate", "coord"),
    ("coordinates", "coord"),
    ("output", "out"),
    ("outputs", "out"),
    ("observe", "out"),
    ("measure", "out"),
    ("result", "out"),
    ("signal", "input"),
    ("define", "let"),
    ("def", "let"),
    ("expression", "let"),
    ("equation", "constraint"),
    ("equations", "constraint"),
    ("eq", "constraint"),
    ("closure", "constraint"),
    ("joint", "constraint"),
    ("driver", "drive"),
    ("motor", "drive"),
    ("motion", "drive"),
    ("actuator", "drive"),
    ("assembly", "branch"),
    ("configuration", "branch"),
    ("range", "limit"),
    ("contour", "curve"),
    ("profile", "curve"),
    ("fn", "function"),
    ("func", "function"),
    ("rod", "body"),
    ("link", "body"),
    ("mass", "body"),
    ("moment", "torque"),
    ("couple", "torque"),
    ("initial", "start"),
    ("init", "start"),
    ("hinge", "pin"),
    ("revolute", "pin"),
    ("group", "effect"),
    ("option", "effect"),
];

/// Words that mean one of two statements, and the cure that tells them apart.
const ONE_OF_TWO: [(&str, &str); 8] = [
    ("assert", "write `branch` for the assembly that is meant, or `limit` for a range to be warned of"),
    ("require", "write `branch` for the assembly that is meant, or `limit` for a range to be warned of"),
    ("assume", "write `branch` for the assembly that is meant, or `limit` for a range to be warned of"),
    ("spring", "write `tsda` for a spring between two points, or `rsda` for one of an angle"),
    ("damper", "write `tsda` for a damper between two points, or `rsda` for one of an angle"),
    ("spring_damper", "write `tsda` for one between two points, or `rsda` for one of an angle"),
    ("load", "write `force` for one on a point, or `torque` for one on an angle"),
    ("impact", "write `contact` with its gap and stiffness"),
];

/// Statement that a word means in other languages.
pub fn meant(word: &str) -> Option<&'static str> {
    STATEMENTS_ELSEWHERE.iter().find(|(other, _)| *other == word).map(|(_, meant)| *meant)
}

/// Cure of a word that means one of two statements.
pub fn one_of_two(word: &str) -> Option<&'static str> {
    ONE_OF_TWO.iter().find(|(other, _)| *other == word).map(|(_, cure)| *cure)
}

/// Names of fields elsewhere, and the field that they mean.
const FIELDS: [(&str, &str); 43] = [
    ("m", "mass"),
    ("J", "inertia"),
    ("I", "inertia"),
    ("Izz", "inertia"),
    ("moment", "inertia"),
    ("moment_of_inertia", "inertia"),
    ("cog", "com"),
    ("cg", "com"),
    ("center", "com"),
    ("centre", "com"),
    ("position", "com"),
    ("pos", "com"),
    ("at", "com"),
    ("theta", "angle"),
    ("phi", "angle"),
    ("rotation", "angle"),
    ("g", "acceleration"),
    ("gravity", "acceleration"),
    ("direction", "acceleration"),
    ("k", "stiffness"),
    ("c", "damping"),
    ("d", "damping"),
    ("b", "damping"),
    ("damper", "damping"),
    ("l0", "length"),
    ("L0", "length"),
    ("rest_length", "length"),
    ("free_length", "length"),
    ("rest", "length"),
    ("angle0", "rest"),
    ("phi0", "rest"),
    ("rest_angle", "rest"),
    ("mu", "coefficient"),
    ("friction", "coefficient"),
    ("normal_force", "normal"),
    ("N", "normal"),
    ("v0", "speed"),
    ("v_s", "speed"),
    ("velocity", "speed"),
    ("e", "restitution"),
    ("v0", "approach"),
    ("n", "exponent"),
    ("distance", "gap"),
];

/// Field among those that are known which a name means elsewhere.
pub fn meant_field<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let meant = FIELDS.iter().filter(|(other, _)| *other == name).map(|(_, meant)| *meant);
    meant.into_iter().find_map(|meant| known.iter().copied().find(|field| *field == meant))
}

/// Reads the sign between a field and its value; another one than `:` is reported, and taken.
pub fn colon(parser: &mut Parser<'_>, field: &str, help: &str) -> Read<()> {
    let sign = match () {
        () if parser.at_pair(':', '=') => ":=",
        () if parser.at_pair('=', '=') => "==",
        () if matches!(parser.peek(), TokenKind::Punctuation('=', _)) => "=",
        () => return parser.expect(':', help),
    };
    let length = sign.len();
    let (span, value) = (parser.span(), quoted(up_to_comma(parser.rest().get(length..).unwrap_or_default())));
    parser.diagnostics.report(
        span,
        format!("`{sign}` stands between a field and its value"),
        format!("write `{field}: {value}`"),
    );
    parser.skip(length);
    Ok(())
}

/// Reports a point or an angle in front of the fields of an element, where one stands.
pub fn before_fields<T>(parser: &mut Parser<'_>, kind: Element, help: &str) -> Read<T> {
    let span = parser.span();
    let is_sign = matches!(parser.peek(), TokenKind::Punctuation(':' | '=' | ',', _));
    let is_word = matches!(parser.peek(), TokenKind::Identifier(word) if matches!(word.as_str(), "at" | "on" | "with" | "along" | "of"));
    let rest = parser.rest().get(1..).unwrap_or_default();
    let is_brace = |token: &Token| {
        matches!(token.kind, TokenKind::Open('{') | TokenKind::Punctuation(';', _) | TokenKind::End)
    };
    let end = rest.iter().position(is_brace).unwrap_or(0);
    let value = rest.get(..end).unwrap_or_default();
    let has_fields = rest.get(end).is_some_and(|token| token.kind == TokenKind::Open('{'));
    let field = match kind {
        Element::Body => "com",
        Element::Rsda => "angle",
        Element::Friction => "along",
        Element::Contact => "gap",
        Element::Gravity => "acceleration",
        Element::Tsda => return parser.expected("`{`", help),
    };
    if !(is_sign || is_word) || value.is_empty() || !has_fields {
        return parser.expected("`{`", help);
    }
    parser.diagnostics.report(
        span,
        format!("`{field}` is a field, and stands in the braces"),
        format!("write `{{ {field}: {}, … }}`", quoted(value)),
    );
    Err(GivenUp)
}

/// Number of tokens of a quotient that is a derivative elsewhere, and its argument: `dphi/dt`, `d/dt(x)`, `d(x)/dt`.
fn quotient(parser: &Parser<'_>) -> Option<(usize, String)> {
    let rest = parser.rest();
    let word = |index: usize| match rest.get(index).map(|token| &token.kind) {
        Some(TokenKind::Identifier(word)) => Some(word.as_str()),
        _ => None,
    };
    let is_slash = |index: usize| {
        matches!(rest.get(index).map(|token| &token.kind), Some(TokenKind::Punctuation('/', _)))
    };
    let is_open = |index: usize| rest.get(index).is_some_and(|token| token.kind == TokenKind::Open('('));
    let is_time = |index: usize| word(index) == Some("dt") && !parser.declares("dt");
    let above = word(0)?;
    let group = |from: usize| rest.get(from..).map_or(0, length_of_group);
    let inside = |from: usize| {
        let length = group(from);
        rest.get(from + 1..(from + length).saturating_sub(1)).map(quoted).unwrap_or_default()
    };
    if above == "d" && is_open(1) {
        let behind = 1 + group(1);
        return (is_slash(behind) && is_time(behind + 1)).then(|| (behind + 2, inside(1)));
    }
    if !is_slash(1) || !is_time(2) || parser.declares(above) {
        return None;
    }
    if above == "d" {
        return match word(3) {
            _ if is_open(3) => Some((3 + group(3), inside(3))),
            Some(of) => Some((4, of.to_owned())),
            None => None,
        };
    }
    let of = above.strip_prefix('d')?;
    parser.declares(of).then(|| (3, of.to_owned()))
}

/// Reports a derivative that is written as a quotient, which is at the cursor; `None` where there is none.
pub fn derivative<T>(parser: &mut Parser<'_>) -> Option<Read<T>> {
    let (length, of) = quotient(parser)?;
    let begins = |token: &Token| {
        matches!(token.kind, TokenKind::Punctuation(';', _) | TokenKind::Open('{') | TokenKind::Close('}'))
    };
    let before = parser.before();
    let start = before.iter().rposition(begins).map_or(0, |index| index + 1);
    let is_drive = before.get(start).is_some_and(|token| token.kind == TokenKind::Identifier("drive".into()));
    let help = match is_drive {
        true => format!("write the rate that a drive prescribes as `rate({of}) == …`"),
        false => format!("write a rate as `der({of})`, an acceleration as `der2({of})`"),
    };
    parser.diagnostics.report(parser.span(), "a derivative is no quotient", help);
    parser.skip(length);
    Some(Err(GivenUp))
}

/// Reports `|x|`, whose first bar is at the cursor.
pub fn bars<T>(parser: &mut Parser<'_>) -> Read<T> {
    let inside = parser.rest().get(1..).unwrap_or_default();
    let is_bar = |token: &Token| matches!(token.kind, TokenKind::Punctuation('|', _));
    let is_end = |token: &Token| matches!(token.kind, TokenKind::Punctuation(';', _) | TokenKind::End);
    let length = inside.iter().take_while(|token| !is_bar(token) && !is_end(token)).count();
    let argument = quoted(inside.get(..length).unwrap_or_default());
    parser.diagnostics.report(
        parser.span(),
        "bars enclose no absolute value",
        format!("write `abs({argument})`, of a vector `norm({argument})`"),
    );
    Err(GivenUp)
}

/// Reports braces around the components of a vector, the first of which is at the cursor; `None` where there are no components.
pub fn braces<T>(parser: &mut Parser<'_>) -> Option<Read<T>> {
    let group = parser.rest().get(..length_of_group(parser.rest())).unwrap_or_default();
    let inside = group.get(1..group.len().saturating_sub(1)).unwrap_or_default();
    let is_comma = |token: &Token| matches!(token.kind, TokenKind::Punctuation(',', _));
    if !inside.iter().any(is_comma) {
        return None;
    }
    parser.diagnostics.report(
        parser.span(),
        "braces enclose no vector",
        format!("write it in square brackets: `[{}]`", quoted(inside)),
    );
    Some(Err(GivenUp))
}

/// Reports a comma in parentheses, which is at the cursor: the parentheses are those of a vector.
pub fn parentheses(parser: &mut Parser<'_>) {
    let before = parser.before();
    let mut depth = 0_usize;
    let open = before.iter().rposition(|token| match token.kind {
        TokenKind::Close(_) => {
            depth += 1;
            false
        }
        TokenKind::Open(_) if depth == 0 => true,
        TokenKind::Open(_) => {
            depth -= 1;
            false
        }
        _ => false,
    });
    let Some(open) = open else { return };
    let first = before.get(open + 1..).unwrap_or_default();
    let span = before.get(open).map_or_else(|| parser.span(), |token| token.span);
    let rest = inside(parser.rest());
    let tokens = [first, rest].concat();
    parser.diagnostics.report(
        span,
        "parentheses enclose no vector",
        format!("write it in square brackets: `[{}]`", quoted(&tokens)),
    );
}
