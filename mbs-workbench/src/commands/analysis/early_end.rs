//! Motions that end before their time: where, and why, in one line.

use mbs_runtime::{Failure, FailureKind};

use super::super::summary::significant;

/// Digits of numbers in the line.
const DIGITS: usize = 4;

/// End of a motion before its time.
#[derive(Clone, Debug, PartialEq)]
pub struct EarlyEnd {
    /// Time and reason in one line.
    pub line: String,
    /// The same with a cure, where one is known.
    pub message: String,
}

impl EarlyEnd {
    /// The last instant `t` (s) of a motion, and the failure beyond it.
    pub fn new(t: f64, failure: &Failure) -> Self {
        let line = format!("the motion ends at t = {} s: {}", significant(t, DIGITS), reason(failure));
        EarlyEnd { message: line.clone(), line }
    }

    /// The same with a message of several lines.
    pub fn with_message(self, message: &str) -> Self {
        EarlyEnd { message: shortened(message), ..self }
    }
}

/// Reason of a failure without its time and cure, numbers in four digits.
fn reason(failure: &Failure) -> String {
    if let FailureKind::NotAssemblable { rows, .. } = &failure.kind {
        let how = if rows.rows().nth(1).is_some() { "together" } else { "with what is driven" };
        return format!("beyond, {rows} cannot hold {how}");
    }
    if let FailureKind::Undecided { margin, .. } = &failure.kind {
        let margin = significant(*margin, 2);
        return format!(
            "rounding decides where the motion goes, next to a singular position (margin {margin})"
        );
    }
    let text = failure.to_string();
    let text = match failure.time {
        Some(t) => text.replacen(&format!(" at t = {t} s"), "", 1),
        None => text,
    };
    shortened(text.split(';').next().unwrap_or(&text))
}

/// The text with its decimal numbers in four digits; names such as `closure.1` and whole numbers stay.
fn shortened(text: &str) -> String {
    let mut short = String::with_capacity(text.len());
    let mut rest = text;
    let mut is_quoted = false;
    while let Some(first) = rest.chars().next() {
        is_quoted ^= first == '`';
        let after_name = short.ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == '.');
        let length = if is_quoted || after_name { 0 } else { decimal(rest) };
        match rest[..length].parse::<f64>() {
            Ok(value) if length > 0 => short.push_str(&significant(value, DIGITS)),
            _ => short.push(first),
        }
        rest = &rest[length.max(first.len_utf8())..];
    }
    short
}

/// Length of the decimal number that a text begins with; 0 where it has none, or a whole number.
fn decimal(text: &str) -> usize {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let whole = digits(0);
    if whole == 0 || text.as_bytes().get(whole) != Some(&b'.') {
        return 0;
    }
    let end = whole + 1 + digits(whole + 1);
    if end == whole + 1 {
        return 0;
    }
    let sign = usize::from(text[end..].starts_with("e-") || text[end..].starts_with("e+"));
    if !text[end..].starts_with('e') || digits(end + 1 + sign) == 0 {
        return end;
    }
    end + 1 + sign + digits(end + 1 + sign)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_numbers_have_four_digits_and_names_stay() {
        let text = "row `closure.1` (line 39) is 2.11345e-4 m off, at 0.041774529916765515 s after 46 of 3.";
        let short = "row `closure.1` (line 39) is 0.0002113 m off, at 0.04177 s after 46 of 3.";
        assert_eq!(shortened(text).replace("2.113e-4", "0.0002113"), short);
    }

    #[test]
    fn an_end_is_one_line_without_its_cure() {
        let failure = FailureKind::Undecided { margin: 1.23456e-3, single: false }.at(7.061_234_5);
        let line = EarlyEnd::new(7.061_234_5, &failure).line;
        assert!(
            line.starts_with("the motion ends at t = 7.061 s: rounding decides where the motion goes"),
            "{line}"
        );
        assert!(!line.contains('\n') && !line.contains("7.0612"), "{line}");
    }
}
