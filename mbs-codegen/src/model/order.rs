//! The order in which definitions that use each other can be elaborated.

use std::collections::BTreeMap;

use crate::diagnostics::Diagnostics;
use crate::syntax::ast::{Expression, Name, Operation};

/// Before: named definitions in any order. After: their indices, each after those it uses; circular definitions are
/// reported and left out.
pub fn order(definitions: &[(&Name, &Expression)], diagnostics: &mut Diagnostics) -> Vec<usize> {
    let index: BTreeMap<&str, usize> =
        definitions.iter().enumerate().rev().map(|(i, (name, _))| (name.text.as_str(), i)).collect();
    let uses: Vec<Vec<usize>> = definitions
        .iter()
        .map(|(_, expression)| {
            let names = expression.code.iter().filter_map(|instruction| match &instruction.operation {
                Operation::Name(name) => index.get(name.as_str()).copied(),
                _ => None,
            });
            names.collect()
        })
        .collect();
    let mut sorted = Vec::new();
    let mut state = vec![Visit::New; definitions.len()];
    for root in 0..definitions.len() {
        visit(root, &uses, &mut state, &mut sorted, |cycle| {
            let names: Vec<&str> = cycle
                .iter()
                .filter_map(|i| definitions.get(*i))
                .map(|(name, _)| name.text.as_str())
                .collect();
            if let Some((name, _)) = cycle.first().and_then(|first| definitions.get(*first)) {
                diagnostics.report(
                    name.span,
                    format!("`{}` is defined by itself: {} → {}", name.text, names.join(" → "), name.text),
                    "break the circle; unknowns are declared with `coord`",
                );
            }
        });
    }
    sorted
}

/// State of a definition in the search.
#[derive(Clone, Copy, PartialEq)]
pub enum Visit {
    /// Not yet met.
    New,
    /// Met, its uses are being visited.
    Open,
    /// Behind all that it uses.
    Done,
    /// Part of a circle.
    Circular,
}

/// Depth-first search on an explicit stack: `root` behind all that it uses; members of each circle are reported.
pub fn visit(
    root: usize,
    uses: &[Vec<usize>],
    state: &mut [Visit],
    sorted: &mut Vec<usize>,
    mut report: impl FnMut(&[usize]),
) {
    let mut path: Vec<(usize, usize)> = vec![(root, 0)];
    while let Some(&(node, next)) = path.last() {
        let here = state.get(node).copied().unwrap_or(Visit::Done);
        if here == Visit::Done || here == Visit::Circular {
            path.pop();
            continue;
        }
        set(state, node, Visit::Open);
        let Some(&used) = uses.get(node).and_then(|uses| uses.get(next)) else {
            set(state, node, Visit::Done);
            sorted.push(node);
            path.pop();
            continue;
        };
        if let Some(top) = path.last_mut() {
            top.1 += 1;
        }
        match state.get(used) {
            Some(Visit::New) => path.push((used, 0)),
            Some(Visit::Open) => {
                let cycle: Vec<usize> = path.iter().map(|(i, _)| *i).skip_while(|i| *i != used).collect();
                report(&cycle);
                for member in cycle {
                    set(state, member, Visit::Circular);
                }
            }
            _ => {}
        }
    }
}

fn set(state: &mut [Visit], node: usize, to: Visit) {
    if let Some(slot) = state.get_mut(node) {
        *slot = to;
    }
}
