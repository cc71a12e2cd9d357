//! The fields and functions that all scenes share.

use std::collections::{BTreeMap, BTreeSet};

use super::scene::Scene;
use super::{Field, Function, Model, Role, Variable};
use crate::diagnostics::Diagnostics;
use crate::syntax::ast::{Name, Statement, StatementKind};

/// Before: the models of all scenes. After: the fields and functions of all of them, those outside effects first, then
/// effect after effect, in the order of the text. A name with two different meanings is reported.
///
/// Effects that no declared scene selects are those of the whole text, which is given where there are any, or where a fault is known.
pub fn merge(
    statements: &[Statement],
    (scenes, whole): (&[Scene], Option<&Scene>),
    diagnostics: &mut Diagnostics,
) -> Model {
    let known: Vec<BTreeMap<&str, &Field>> = scenes
        .iter()
        .map(|scene| scene.model.fields.iter().map(|field| (field.name.text.as_str(), field)).collect())
        .collect();
    let mut shared = Model::default();
    let mut done = BTreeSet::new();
    // Other fields: the phase of a drive that prescribes a rate, or the name of a faulty statement.
    let others = scenes.iter().flat_map(|scene| &scene.model.fields).map(|field| field.name.text.as_str());
    let of_whole = whole.into_iter().flat_map(|scene| scene.model.fields.iter());
    let unselected: BTreeMap<&str, &Field> =
        of_whole.map(|field| (field.name.text.as_str(), field)).collect();
    for name in declared(statements).chain(others).filter(|name| done.insert(*name)) {
        let alone = || Some((whole?, *unselected.get(name)?));
        let mut found = scenes.iter().zip(&known).filter_map(|(scene, known)| {
            known.get(name).map(|field| (scene, *field, variables(&scene.model, field)))
        });
        let first = found.next().or_else(|| {
            let (whole, field) = alone()?;
            Some((whole, field, variables(&whole.model, field)))
        });
        let Some((_, field, variables)) = first else { continue };
        for (scene, other, others) in found {
            if !is_same(field, variables, other, others) {
                report((&field.name, &other.name, "field"), scene.label().unwrap_or_default(), diagnostics);
            }
        }
        let first = shared.variables.len();
        shared.fields.push(Field { first, ..field.clone() });
        shared.variables.extend(variables.iter().cloned());
    }
    let scenes: Vec<&Scene> = scenes.iter().chain(whole).collect();
    shared.functions = functions(statements, &scenes, &shared.fields, diagnostics);
    shared
}

/// The functions of all scenes, of an array the first one; none has the name of a field.
fn functions(
    statements: &[Statement],
    scenes: &[&Scene],
    fields: &[Field],
    diagnostics: &mut Diagnostics,
) -> Vec<Function> {
    let all = || scenes.iter().flat_map(|scene| scene.model.functions.iter().map(move |f| (scene, f)));
    let mut done = BTreeSet::new();
    let others = all().map(|(_, function)| function.name.text.as_str());
    let names = declared(statements).chain(others).filter(|name| done.insert(*name));
    let mut shared = Vec::new();
    for name in names {
        let mut found = all().filter(|(_, function)| function.name.text == name);
        let Some((scene, first)) = found.next() else { continue };
        if let Some(field) = fields.iter().find(|field| field.name.text == name) {
            report((&field.name, &first.name, "field"), scene.label().unwrap_or_default(), diagnostics);
            continue;
        }
        let is_first = |other: &Function| other.array.is_none_or(|array| array.index == 0);
        for (scene, other) in found.filter(|(_, other)| is_first(other) && !is_same_function(first, other)) {
            let what = if first.shape() == other.shape() { "function" } else { "array of functions" };
            report((&first.name, &other.name, what), scene.label().unwrap_or_default(), diagnostics);
        }
        shared.push(first.clone());
    }
    shared
}

fn is_same_function(a: &Function, b: &Function) -> bool {
    let terms = |f: &Function| (f.dimensions, f.continuity, f.period.map(f64::to_bits), f.shape());
    terms(a) == terms(b)
}

/// Names of fields and functions: first those outside effects.
fn declared(statements: &[Statement]) -> impl Iterator<Item = &str> {
    let mut inside = false;
    let (mut common, mut special) = (Vec::new(), Vec::new());
    for statement in statements {
        match &statement.kind {
            StatementKind::Effect { .. } => inside = true,
            StatementKind::EndEffect => inside = false,
            StatementKind::Param { name, .. }
            | StatementKind::Input { name, .. }
            | StatementKind::Function { name, .. } => {
                (if inside { &mut special } else { &mut common }).push(name.text.as_str());
            }
            _ => {}
        }
    }
    common.into_iter().chain(special)
}

/// The variables of a field.
fn variables<'a>(model: &'a Model, field: &Field) -> &'a [Variable] {
    let each = if matches!(field.role, Role::InputWithRates | Role::Phase) { 3 } else { 1 };
    let size = field.shape.iter().product::<usize>().saturating_mul(each);
    model.variables.get(field.first..field.first.saturating_add(size)).unwrap_or_default()
}

fn is_same(a: &Field, of_a: &[Variable], b: &Field, of_b: &[Variable]) -> bool {
    let pairs = of_a.iter().zip(of_b);
    let values = pairs.fold(true, |same, (a, b)| {
        same && a.default.to_bits() == b.default.to_bits() && a.dimension == b.dimension
    });
    values && a.role == b.role && a.shape == b.shape
}

fn report((first, other, what): (&Name, &Name, &str), scene: &str, diagnostics: &mut Diagnostics) {
    let (shared, terms) = match what {
        "field" => ("fields", "unit, shape and default"),
        "function" => ("functions", "units, continuity and period"),
        _ => ("functions", "length, units, continuity and period"),
    };
    diagnostics.report(
        other.span,
        format!("`{}` is another {what} in scene `{scene}` than before", other.text),
        format!(
            "all scenes share their {shared}: declare it as in line {}, same {terms}, or rename it",
            first.span.start().line
        ),
    );
}
