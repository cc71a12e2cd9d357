//! Names that expressions refer to, and the `let`s that are known after the forces.

use std::collections::{BTreeMap, BTreeSet};

use crate::syntax::OF_FORCES;
use crate::syntax::ast::{Expression, Instruction, Operation, Statement, StatementKind};

/// A name that statements refer to: a force, or a `let` of forces.
pub(super) type Referred<'a> = (bool, &'a str);

/// Names in an expression: of forces, and of values.
pub(super) fn referred(expression: &Expression) -> impl Iterator<Item = Referred<'_>> {
    expression.code.iter().flat_map(|Instruction { operation, .. }| {
        let (value, forces) = match operation {
            Operation::Name(name) => (Some((false, name.as_str())), &[][..]),
            Operation::Reference { function, targets } if OF_FORCES.contains(&function.as_str()) => {
                (None, targets.as_slice())
            }
            _ => (None, &[][..]),
        };
        value.into_iter().chain(forces.iter().map(|target| (true, target.name.text.as_str())))
    })
}

/// Before: the statements outside loops. After: the names of each `let` that refers to a force, by itself or by another.
pub(super) fn late_lets(statements: &[&Statement]) -> BTreeSet<String> {
    let mut users: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    let mut waiting = Vec::new();
    for statement in statements {
        let StatementKind::Let { name, value, .. } = &statement.kind else { continue };
        for (is_force, used) in referred(value) {
            match is_force {
                true => waiting.push(name.text.as_str()),
                false => users.entry(used).or_default().push(&name.text),
            }
        }
    }
    let mut late = BTreeSet::new();
    while let Some(name) = waiting.pop() {
        if late.insert(name.to_owned()) {
            waiting.extend(users.get(name).into_iter().flatten());
        }
    }
    late
}
