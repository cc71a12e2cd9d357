//! Faults of a text, each on the user's own token and with its cure.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Span, TokenStream};
use quote::quote_spanned;

/// Largest number of faults that are kept: more are not read, and the compiler takes its time over each.
const MOST: usize = 100;

/// One fault: its message, its token and its cure.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// Message: lower case, no full stop, names in backticks.
    pub message: String,
    /// The cure.
    pub help: String,
    /// The token that the message is about.
    pub span: Span,
}

/// A fault by its place in a text that is kept as a string; lines and columns count from 1, columns in characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Line of its first character.
    pub line: usize,
    /// Column of its first character.
    pub column: usize,
    /// Line of its last character.
    pub end_line: usize,
    /// Column after its last character.
    pub end_column: usize,
    /// Message: lower case, no full stop, names in backticks.
    pub message: String,
    /// The cure.
    pub help: String,
}

impl Fault {
    /// Characters of its token on the first line, at least 1.
    pub fn width(&self) -> usize {
        if self.end_line == self.line { self.end_column.saturating_sub(self.column).max(1) } else { 1 }
    }
}

impl From<Diagnostic> for Fault {
    fn from(Diagnostic { message, help, span }: Diagnostic) -> Self {
        let (start, end) = (span.start(), span.end());
        Fault {
            line: start.line,
            column: start.column + 1,
            end_line: end.line,
            end_column: end.column + 1,
            message,
            help,
        }
    }
}

/// All faults found so far; a stage reports as many as it can before it gives up.
#[derive(Clone, Debug, Default)]
pub struct Diagnostics {
    faults: Vec<Diagnostic>,
    /// Line, column and message of each: a fault that a loop repeats in every round is reported once.
    known: BTreeSet<(usize, usize, String)>,
}

impl Diagnostics {
    /// Records a fault.
    pub fn report(&mut self, span: Span, message: impl Into<String>, help: impl Into<String>) {
        let (message, start) = (message.into(), span.start());
        if self.faults.len() < MOST && self.known.insert((start.line, start.column, message.clone())) {
            self.faults.push(Diagnostic { message, help: help.into(), span });
        }
    }

    /// Records the faults found in scenes, of which there are `number`. A fault of every scene is recorded plainly,
    /// else with the names of the scenes that have it. A text without scenes is one entry without a name.
    pub fn gather(&mut self, scenes: &[(Option<&str>, Diagnostics)], number: usize) {
        let mut found: BTreeMap<(usize, usize, &str), (&Diagnostic, Vec<&str>)> = BTreeMap::new();
        for (scene, diagnostics) in scenes {
            for fault in &diagnostics.faults {
                let start = fault.span.start();
                let key = (start.line, start.column, fault.message.as_str());
                found.entry(key).or_insert_with(|| (fault, Vec::new())).1.extend(scene);
            }
        }
        for (fault, names) in found.into_values() {
            let everywhere = number > 1 && names.len() == number;
            let message = match (names.as_slice(), everywhere) {
                ([], _) | (_, true) => fault.message.clone(),
                ([name], _) => format!("in scene `{name}`: {}", fault.message),
                (names, _) => format!("in scenes `{}`: {}", names.join("`, `"), fault.message),
            };
            self.report(fault.span, message, fault.help.clone());
        }
    }

    /// The first fault, if any.
    pub fn first(&self) -> Option<Diagnostic> {
        self.sorted().into_iter().next()
    }

    /// Takes a fault back; `false` if there is none of this message at this place.
    pub fn withdraw(&mut self, span: Span, message: &str) -> bool {
        let before = self.faults.len();
        self.faults.retain(|fault| !is_at(fault, span, message));
        let start = span.start();
        self.known.remove(&(start.line, start.column, message.to_owned()));
        self.faults.len() < before
    }

    /// `true` if there is a fault of this message at this place.
    pub fn holds(&self, span: Span, message: &str) -> bool {
        self.faults.iter().any(|fault| is_at(fault, span, message))
    }

    /// Number of faults.
    pub fn number(&self) -> usize {
        self.faults.len()
    }

    /// `true` if there is no fault so far.
    pub fn is_empty(&self) -> bool {
        self.faults.is_empty()
    }

    /// The faults in the order of the text.
    pub fn sorted(&self) -> Vec<Diagnostic> {
        let mut faults = self.faults.clone();
        faults.sort_by_key(|fault| {
            let start = fault.span.start();
            (start.line, start.column)
        });
        faults
    }

    /// One `compile_error!` a fault, spanned at the user's token: all but the first as items, and the first as an expression.
    pub fn to_tokens(&self) -> (TokenStream, TokenStream) {
        let mut faults = self.sorted().into_iter().map(|fault| {
            let text = format!("{}\n  help: {}", fault.message, fault.help);
            quote_spanned!(fault.span=> ::core::compile_error! { #text })
        });
        let first = faults.next().unwrap_or_default();
        (faults.collect(), first)
    }

    /// `line:column: message` and `help: cure`, two lines a fault; lines from 1, columns from 1.
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        for fault in self.sorted() {
            let start = fault.span.start();
            text +=
                &format!("{}:{}: {}\n  help: {}\n", start.line, start.column + 1, fault.message, fault.help);
        }
        text
    }
}

/// `true` if a fault has this message and this place.
fn is_at(fault: &Diagnostic, span: Span, message: &str) -> bool {
    let (own, other) = (fault.span.start(), span.start());
    (own.line, own.column) == (other.line, other.column) && fault.message == message
}

/// The known name nearest to `name`, if it is near enough to be a typing error; of several the one that begins most like it.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let letters: Vec<char> = name.chars().take(LONGEST_NAME).collect();
    let limit = (letters.len() / 3).max(1);
    known
        .into_iter()
        .filter_map(|candidate| {
            let other: Vec<char> = candidate.chars().take(LONGEST_NAME).collect();
            let distance = match name.eq_ignore_ascii_case(candidate) {
                true => 0,
                false => edit_distance(&letters, &other),
            };
            let common = letters.iter().zip(&other).take_while(|(a, b)| a == b).count();
            // A name of one letter would be replaced completely.
            (distance <= limit && distance < letters.len()).then_some((
                distance,
                std::cmp::Reverse(common),
                candidate,
            ))
        })
        .min()
        .map(|(.., candidate)| candidate)
}

/// Letters of a name that are compared.
const LONGEST_NAME: usize = 64;

/// Number of letters to insert, delete, replace or swap with the next to get from `a` to `b`.
fn edit_distance(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, to) in b.iter().enumerate() {
            let at = |row: &[usize], column: usize| row.get(column).copied().unwrap_or(usize::MAX / 2);
            let replaced = at(&above, j) + usize::from(from != to);
            let mut best = replaced.min(at(&above, j + 1) + 1).min(at(&row, j) + 1);
            let swaps = i > 0 && j > 0 && a.get(i - 1) == Some(to) && b.get(j - 1) == Some(from);
            if swaps {
                best = best.min(at(&before, j - 1) + 1);
            }
            row.push(best);
        }
        before = std::mem::replace(&mut above, row);
    }
    above.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_finds_slips_and_leaves_strangers() {
        assert_eq!(nearest("ph1", ["phi1", "omega"]), Some("phi1"));
        assert_eq!(nearest("omgea", ["phi1", "omega"]), Some("omega"));
        assert_eq!(nearest("ph", ["p", "phi"]), Some("phi"));
        assert_eq!(nearest("R", ["L", "p"]), None);
        assert_eq!(nearest("l", ["L", "p"]), Some("L"));
        assert_eq!(nearest("omeg", ["phi1", "omega"]), Some("omega"));
        assert_eq!(nearest("zebra", ["phi1", "omega"]), None);
    }
}
