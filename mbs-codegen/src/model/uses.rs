//! Uses of names in a text, and the names among them that are declared nowhere.

use std::collections::BTreeMap;

use proc_macro2::Span;

use crate::syntax::ast::{Instruction, Operation, Statement};

/// Number of uses of each name, and the first place.
pub type Uses = BTreeMap<String, (usize, Span)>;

/// Uses of all names of values and functions in the expressions of statements.
pub fn uses(statements: &[Statement]) -> Uses {
    let mut found = Uses::new();
    let place = |span: Span| (span.start().line, span.start().column);
    for expression in statements.iter().flat_map(|statement| statement.kind.expressions()) {
        for Instruction { operation, span } in &expression.code {
            if let Operation::Name(name) | Operation::Call { function: name, .. } = operation {
                let (count, first) = found.entry(name.clone()).or_insert((0, *span));
                *count += 1;
                if place(*span) < place(*first) {
                    *first = *span;
                }
            }
        }
    }
    found
}

/// A name that was reported, and the message.
#[derive(Clone, Debug)]
pub struct Undeclared {
    pub name: String,
    pub span: Span,
    pub message: String,
    pub is_function: bool,
}

/// Functions of angles.
pub const OF_ANGLES: [&str; 5] = ["sin", "cos", "tan", "unit", "rot"];
