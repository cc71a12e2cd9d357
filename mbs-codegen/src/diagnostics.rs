//! Faults of a text, each on the user's own token and with its cure.

use proc_macro2::{Span, TokenStream};
use quote::quote_spanned;

/// One fault: what is wrong, where, and what to do.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// What is wrong: lower case, no full stop, names in backticks.
    pub message: String,
    /// The cure.
    pub help: String,
    /// The token that the message is about.
    pub span: Span,
}

/// All faults found so far; a stage reports as many as it can before it gives up.
#[derive(Debug, Default)]
pub struct Diagnostics(Vec<Diagnostic>);

impl Diagnostics {
    /// Records a fault.
    pub fn report(&mut self, span: Span, message: impl Into<String>, help: impl Into<String>) {
        self.0.push(Diagnostic { message: message.into(), help: help.into(), span });
    }

    /// Whether nothing is wrong so far.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The faults in the order of the text.
    pub fn sorted(&self) -> Vec<Diagnostic> {
        let mut faults = self.0.clone();
        faults.sort_by_key(|fault| {
            let start = fault.span.start();
            (start.line, start.column)
        });
        faults
    }

    /// One `compile_error!` a fault, spanned at the user's token.
    pub fn to_tokens(&self) -> TokenStream {
        self.sorted()
            .into_iter()
            .map(|fault| {
                let text = format!("{}\n  help: {}", fault.message, fault.help);
                quote_spanned!(fault.span=> ::core::compile_error! { #text })
            })
            .collect()
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

/// The known name nearest to `name`, if it is near enough to be a slip of the hand.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let limit = (name.chars().count() / 3).max(1);
    known
        .into_iter()
        .map(|candidate| (edit_distance(name, candidate), candidate))
        .filter(|&(distance, _)| distance <= limit)
        .min()
        .map(|(_, candidate)| candidate)
}

/// Number of characters to insert, delete or replace to get from `a` to `b`.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().take(64).collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().take(64).enumerate() {
        let mut diagonal = i;
        let mut left = i + 1;
        for (cell, to) in row.iter_mut().skip(1).zip(&b) {
            let here = (diagonal + usize::from(from != *to)).min(*cell + 1).min(left + 1);
            diagonal = *cell;
            *cell = here;
            left = here;
        }
        if let Some(first) = row.first_mut() {
            *first = i + 1;
        }
    }
    row.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_finds_slips_and_leaves_strangers() {
        assert_eq!(nearest("ph1", ["phi1", "omega"]), Some("phi1"));
        assert_eq!(nearest("omgea", ["phi1", "omega"]), None);
        assert_eq!(nearest("omeg", ["phi1", "omega"]), Some("omega"));
        assert_eq!(nearest("zebra", ["phi1", "omega"]), None);
    }
}
