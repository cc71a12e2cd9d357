//! Second reading of a text with faults: one sign of a vector that reads in two ways.

use proc_macro2::{Delimiter, Group, Literal, Punct, Spacing, Span, TokenStream, TokenTree};

use crate::diagnostics::{Diagnostic, Diagnostics};

/// Signs that are tried, those first in the text: each trial reads it once more.
const MOST: usize = 4;

/// Deepest brackets that are looked into.
const DEEPEST: usize = 32;

/// Before: a text with faults. After: where one sign, read in another way, leaves fewer, it is the fault in place of those that followed.
///
/// `faults` reads a text.
pub fn explain(
    input: &TokenStream,
    diagnostics: &mut Diagnostics,
    faults: impl Fn(TokenStream) -> Diagnostics,
) {
    // Someone who writes decimal commas writes them throughout.
    for wanted in (0..MOST).map(Some).chain([None]) {
        let mut reading = Reading { wanted, seen: 0, slip: None };
        let changed = reading.read(input.clone(), false, DEEPEST);
        let Some(Diagnostic { message, help, span }) = reading.slip else { continue };
        let mut left = faults(changed);
        if left.number() < diagnostics.number() {
            left.report(span, message, help);
            *diagnostics = left;
            return;
        }
    }
}

/// A text in which the sign number `wanted` is read in another way; without a number all commas that may be decimal.
struct Reading {
    wanted: Option<usize>,
    seen: usize,
    /// The fault that the sign is then.
    slip: Option<Diagnostic>,
}

impl Reading {
    /// The tokens as they are then; `is_vector`: they stand in square brackets.
    fn read(&mut self, stream: TokenStream, is_vector: bool, depth: usize) -> TokenStream {
        let trees: Vec<TokenTree> = stream.into_iter().collect();
        let mut changed: Vec<TokenTree> = Vec::with_capacity(trees.len());
        let mut next = 0;
        while let Some(tree) = trees.get(next) {
            let before = next.checked_sub(1).and_then(|before| trees.get(before));
            let slip = match (tree, before, trees.get(next + 1)) {
                (TokenTree::Punct(sign), Some(before), Some(behind)) if is_vector => {
                    decimal_comma(sign, before, behind).or_else(|| missing_comma(sign, before, behind))
                }
                _ => None,
            };
            if let Some((slip, tokens, is_number)) = slip {
                self.seen += 1;
                if self.wanted.map_or(is_number, |wanted| self.seen == wanted + 1) {
                    self.slip.get_or_insert(slip);
                    if is_number {
                        changed.pop();
                        next += 1;
                    }
                    changed.extend(tokens);
                    next += 1;
                    continue;
                }
            }
            changed.push(match tree {
                TokenTree::Group(group) if depth > 0 => {
                    let inner = self.read(group.stream(), group.delimiter() == Delimiter::Bracket, depth - 1);
                    let mut read = Group::new(group.delimiter(), inner);
                    read.set_span(group.span());
                    read.into()
                }
                tree => tree.clone(),
            });
            next += 1;
        }
        changed.into_iter().collect()
    }
}

/// A slip, the tokens that stand for it, `true` if they stand for the neighbours of the sign too.
type Slip = (Diagnostic, Vec<TokenTree>, bool);

/// `9,81` without a blank: a decimal comma.
fn decimal_comma(sign: &Punct, before: &TokenTree, behind: &TokenTree) -> Option<Slip> {
    let (TokenTree::Literal(whole), TokenTree::Literal(part)) = (before, behind) else { return None };
    let (digits, decimals) = (whole.to_string(), part.to_string());
    let is_whole = digits.bytes().all(|digit| digit.is_ascii_digit());
    let is_part = decimals.starts_with(|first: char| first.is_ascii_digit());
    if sign.as_char() != ',' || !is_whole || !is_part {
        return None;
    }
    if !touch(before.span(), sign.span()) || !touch(sign.span(), behind.span()) {
        return None;
    }
    let text = format!("{digits}.{decimals}");
    let mut number = text.parse::<Literal>().ok()?;
    number.set_span(whole.span());
    let slip = Diagnostic {
        message: "a comma stands in a number".into(),
        help: format!("write the decimal point: `{text}`"),
        span: sign.span(),
    };
    Some((slip, vec![number.into()], true))
}

/// `0 -9.81` with a blank in front of the sign alone: two components.
fn missing_comma(sign: &Punct, before: &TokenTree, behind: &TokenTree) -> Option<Slip> {
    let is_operand = !matches!(before, TokenTree::Punct(_));
    if sign.as_char() != '-' || !is_operand {
        return None;
    }
    if touch(before.span(), sign.span()) || !touch(sign.span(), behind.span()) {
        return None;
    }
    let mut comma = Punct::new(',', Spacing::Alone);
    comma.set_span(sign.span());
    let quoted = |tree: &TokenTree| match tree {
        TokenTree::Group(_) => "…".to_owned(),
        tree => tree.to_string(),
    };
    let (left, right) = (quoted(before), quoted(behind));
    let slip = Diagnostic {
        message: format!("a comma is missing between `{left}` and `-{right}`"),
        help: format!("write `{left}, -{right}` for two components"),
        span: sign.span(),
    };
    Some((slip, vec![comma.into(), sign.clone().into()], false))
}

fn touch(a: Span, b: Span) -> bool {
    let (end, start) = (a.end(), b.start());
    (end.line, end.column) == (start.line, start.column)
}
