//! Warnings about a text without faults: a macro cannot warn, a program can.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Span, TokenStream, TokenTree};

use crate::diagnostics::Diagnostics;
use crate::model::expression::{Expressions, Id, Node};
use crate::model::scene::Scene;
use crate::model::scenes::Scenes;
use crate::model::vanishing::values;
use crate::structure::Structure;
use crate::syntax::Text;
use crate::syntax::ast::{Name, StatementKind};

/// Part of its terms by which a row may be open at the guess: a guess that is meant is nearer.
const FAR: f64 = 0.5;

/// Before: a text without faults, with the structure of its scenes. After: names that nothing uses, assemblies that no branch
/// chooses, guesses that leave rows wide open, events that never begin.
pub fn warnings(text: &Text, scenes: &Scenes, structures: &[(&Scene, Structure)]) -> Diagnostics {
    let mut warnings = Diagnostics::default();
    unused(text, &mut warnings);
    let number = scenes.scenes.len();
    let found: Vec<_> = structures
        .iter()
        .map(|(scene, structure)| {
            let mut warnings = Diagnostics::default();
            unchosen(scene, structure, &mut warnings);
            open(scene, &mut warnings);
            never_begun(scene, &mut warnings);
            (scene.label(), warnings)
        })
        .collect();
    warnings.gather(&found, number);
    warnings
}

/// Names that stand in the text once, where they are declared.
fn unused(text: &Text, warnings: &mut Diagnostics) {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    let mut streams: Vec<TokenStream> = text.source.parse().into_iter().collect();
    while let Some(stream) = streams.pop() {
        for token in stream {
            match token {
                TokenTree::Group(group) => streams.push(group.stream()),
                TokenTree::Ident(word) => {
                    *counts.entry(word.to_string().trim_start_matches("r#").to_owned()).or_default() += 1;
                }
                _ => {}
            }
        }
    }
    // What a foot declares stands at the name of its coordinate, and nowhere in the source.
    let place = |name: &Name| (name.span.start().line, name.span.start().column);
    let feet = text.statements.iter().filter_map(|statement| match &statement.kind {
        StatementKind::Coord { name, .. } => Some(place(name)),
        _ => None,
    });
    let feet: BTreeSet<_> = feet.collect();
    for statement in &text.statements {
        let (word, name): (&str, &Name) = match &statement.kind {
            StatementKind::Let { name, .. } if feet.contains(&place(name)) => continue,
            StatementKind::Const { name, .. } => ("constant", name),
            StatementKind::Param { name, .. } => ("parameter", name),
            StatementKind::Input { name, .. } => ("input", name),
            StatementKind::Let { name, .. } => ("`let`", name),
            StatementKind::Curve { name, .. } => ("curve", name),
            _ => continue,
        };
        if counts.get(&name.text) == Some(&1) {
            let message = format!("{word} `{}` is used nowhere", name.text);
            warnings.report(name.span, message, "remove it, or use it");
        }
    }
}

/// Loops of two assemblies in a scene without a branch.
fn unchosen(scene: &Scene, structure: &Structure, warnings: &mut Diagnostics) {
    let model = &scene.model;
    if !model.branches.is_empty() {
        return;
    }
    for block in structure.blocks.iter().filter(|block| block.dyad.is_some()) {
        let Some(row) = block.rows.first().and_then(|row| model.rows.get(*row)) else { continue };
        let names: Vec<String> = block
            .coordinates
            .iter()
            .filter_map(|index| model.coordinates.get(*index))
            .map(|coordinate| format!("`{}`", coordinate.name))
            .collect();
        let group = row.name.split('.').next().unwrap_or(&row.name);
        // The row e·e = 1 is named after its body; e and −e are one orientation.
        if model.dynamics.iter().flat_map(|dynamics| &dynamics.bodies).any(|body| body.name == group) {
            continue;
        }
        warnings.report(
            row.span,
            format!("`{group}` has two positions of {}, and no branch chooses one", names.join(", ")),
            "the one next to the guess is taken; declare it: `branch open: sin(phi3 - phi2) > 0;`",
        );
    }
}

/// Rows that the guess does not nearly meet, at time 0 with the defaults.
fn open(scene: &Scene, warnings: &mut Diagnostics) {
    let model = &scene.model;
    let variable = |index: usize| model.variables.get(index).map(|variable| variable.default);
    let of_design = |node: Node| match node {
        Node::Variable(index) => variable(index),
        _ => None,
    };
    let guesses = values(&model.expressions, of_design, |_, _, _| None);
    let guess = |index: usize| {
        let guess = model.coordinates.get(index)?.guess?;
        guesses.get(guess.index()).copied().flatten().map(|(value, _)| value)
    };
    let at_guess = |node: Node| match node {
        Node::Coordinate(index) => guess(index),
        Node::Variable(index) => variable(index),
        _ => Some(0.0),
    };
    let found = values(&model.expressions, at_guess, |_, _, _| None);
    let mut told: Vec<&str> = Vec::new();
    for row in model.rows.iter().filter(|row| !row.driven) {
        let Some((value, size)) = found.get(row.residual.index()).copied().flatten() else { continue };
        let group = row.name.split('.').next().unwrap_or(&row.name);
        if value.abs() > FAR * size && !told.contains(&group) {
            told.push(group);
            let message =
                format!("the guess leaves `{}` open by {}", row.name, amount(value.abs(), &row.unit(model)));
            report(warnings, row.span, message);
        }
    }
}

/// Events whose end holds wherever their begin does: with one side of both conditions alike, and numbers on the other.
fn never_begun(scene: &Scene, warnings: &mut Diagnostics) {
    let model = &scene.model;
    let Some(dynamics) = model.dynamics.as_ref().filter(|dynamics| !dynamics.events.is_empty()) else {
        return;
    };
    let variable = |node: Node| match node {
        Node::Variable(index) => model.variables.get(index).map(|variable| variable.default),
        _ => None,
    };
    let known = values(&model.expressions, variable, |_, _, _| None);
    let kinds = kinds(&model.expressions);
    let mut told: Vec<&str> = Vec::new();
    for event in &dynamics.events {
        let (Some([larger, smaller]), Some([end_larger, end_smaller])) = (event.begins, event.ends) else {
            continue;
        };
        let number = |id: Id| known.get(id.index()).copied().flatten().map(|(value, _)| value);
        let alike = |a: Id, b: Id| kinds.get(a.index()) == kinds.get(b.index());
        // Numbers `least` and `most` with least ≤ most where the end follows from the begin.
        let above = alike(larger, end_larger).then(|| number(end_smaller).zip(number(smaller))).flatten();
        let below = alike(smaller, end_smaller).then(|| number(larger).zip(number(end_larger))).flatten();
        let group = event.name.split('.').next().unwrap_or(&event.name);
        if [above, below].into_iter().flatten().any(|(least, most)| least <= most) && !told.contains(&group) {
            told.push(group);
            warnings.report(
                event.span,
                format!("`{group}` never begins: the condition of its end holds wherever that of its begin does"),
                "write an end that holds elsewhere, as `until y > 0.5m` behind `y < 0`; without `until` it ends where it holds no more",
            );
        }
    }
}

/// A number for each expression, the same for those that are written alike.
fn kinds(expressions: &Expressions) -> Vec<usize> {
    let mut known: BTreeMap<String, usize> = BTreeMap::new();
    let mut kinds: Vec<usize> = Vec::with_capacity(expressions.len());
    for (_, node) in expressions.iter() {
        let of = |id: Id| kinds.get(id.index()).copied().unwrap_or(usize::MAX);
        let key = match node {
            Node::Unary(function, a) => format!("{function:?} {}", of(a)),
            Node::Binary(function, a, b) => format!("{function:?} {} {}", of(a), of(b)),
            Node::Rate(a, order) => format!("rate {} {order}", of(a)),
            Node::Call { function, order, argument } => format!("call {function} {order} {}", of(argument)),
            Node::Ratio(a, row) => format!("ratio {} {row}", of(a)),
            leaf => format!("{leaf:?}"),
        };
        let next = known.len();
        kinds.push(*known.entry(key).or_insert(next));
    }
    kinds
}

fn report(warnings: &mut Diagnostics, span: Span, message: String) {
    warnings.report(span, message, "write guesses, the values behind `coord`, near an assembly");
}

/// A number in three digits with its unit.
fn amount(value: f64, unit: &str) -> String {
    let digits = format!("{value:.2e}").parse::<f64>().unwrap_or(value);
    if unit == "1" { digits.to_string() } else { format!("{digits} {unit}") }
}
