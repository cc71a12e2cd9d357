//! Order of the statements of forces where some refer to others by name.

use std::collections::{BTreeMap, BTreeSet};

use super::forces_by_name::Declared;
use super::initialiser::definition;
use super::late_lets::{Referred, referred};
use super::names::{Names, Symbol};
use super::order::{Visit, visit};
use super::resolve::behind_loop;
use super::resolver::Resolver;
use super::seen::{CIRCLE, word};
use super::value::{Fault, Reach};
use crate::syntax::ast::{Expression, Name, Statement, StatementKind, Unit};

impl Names {
    /// `true` if an expression refers to a force, by itself or by a `let`.
    pub(super) fn is_late(&self, expression: &Expression) -> bool {
        let is_later = |name: &str| matches!(self.get(name), Some(Symbol::Later));
        referred(expression).any(|(is_force, name)| is_force || is_later(name))
    }
}

/// A statement outside of loops, or a whole loop: what it declares with its token, and what it refers to.
struct Part<'a> {
    statements: &'a [Statement],
    declared: Vec<(Referred<'a>, &'a Name)>,
    used: Vec<Referred<'a>>,
}

impl<'a> Part<'a> {
    fn of(statements: &'a [Statement], late: &BTreeSet<String>) -> Self {
        let names = statements.iter().filter_map(|statement| match &statement.kind {
            StatementKind::Let { name, .. } if late.contains(&name.text) => Some((false, name)),
            kind => word(kind).map(|(name, _)| (true, name)),
        });
        let declared = names.map(|(is_force, name)| ((is_force, name.text.as_str()), name)).collect();
        let expressions = statements.iter().flat_map(|statement| statement.kind.expressions());
        Part { statements, declared, used: expressions.flat_map(referred).collect() }
    }
}

impl Resolver<'_> {
    /// Notes the statements that have a name without a value.
    fn note_declared(&mut self, statements: &[Statement]) {
        let mut depth = 0_usize;
        for statement in statements {
            match &statement.kind {
                StatementKind::For(_) => depth += 1,
                StatementKind::EndFor => depth = depth.saturating_sub(1),
                kind => {
                    if let Some((name, word)) = word(kind) {
                        let declared = Declared { word, repeated: depth > 0 };
                        self.names.seen.declared.entry(name.text.clone()).or_insert(declared);
                    }
                }
            }
        }
    }

    /// Before: statements whose rows are known. After: the same with each force, and each `let` of forces, in front of what refers
    /// to it, otherwise in their order; `None` where nothing does. Circles are reported and left out.
    pub(super) fn arranged(&mut self, statements: &[Statement]) -> Option<Vec<Statement>> {
        let mut expressions = statements.iter().flat_map(|statement| statement.kind.expressions());
        if !expressions.any(|expression| referred(expression).any(|(is_force, _)| is_force)) {
            return None;
        }
        self.note_declared(statements);
        let parts = self.parts(statements);
        let declared = parts
            .iter()
            .enumerate()
            .rev()
            .flat_map(|(index, part)| part.declared.iter().map(move |(referred, _)| (*referred, index)));
        let declared: BTreeMap<Referred<'_>, usize> = declared.collect();
        let uses: Vec<Vec<usize>> = parts
            .iter()
            .enumerate()
            .map(|(index, part)| {
                let used = part.used.iter().filter_map(|referred| declared.get(referred).copied());
                used.filter(|used| *used != index).collect()
            })
            .collect();
        let mut state = vec![Visit::New; parts.len()];
        let (mut order, mut circles) = (Vec::new(), Vec::new());
        for root in 0..parts.len() {
            visit(root, &uses, &mut state, &mut order, |circle| circles.push(circle.to_vec()));
        }
        for circle in circles {
            self.report_circle(circle.iter().filter_map(|index| parts.get(*index)));
        }
        let ordered = order.into_iter().filter_map(|index| parts.get(index));
        Some(ordered.flat_map(|part| part.statements).cloned().collect())
    }

    fn parts<'a>(&self, statements: &'a [Statement]) -> Vec<Part<'a>> {
        let is_for = |statement: &Statement| matches!(statement.kind, StatementKind::For(_));
        let is_end = |statement: &Statement| matches!(statement.kind, StatementKind::EndFor);
        let (mut parts, mut begin) = (Vec::new(), 0);
        while let Some(first) = statements.get(begin) {
            let end = match is_for(first) {
                true => behind_loop(statements, begin + 1, is_for, is_end),
                false => begin + 1,
            };
            let part = statements.get(begin..end).unwrap_or_default();
            parts.push(Part::of(part, &self.names.seen.late));
            begin = end;
        }
        parts
    }

    /// Reports that the names of a circle need each other, and marks them, so that their uses are not reported too.
    fn report_circle<'a>(&mut self, circle: impl Iterator<Item = &'a Part<'a>>) {
        let circle: Vec<&Part<'_>> = circle.collect();
        let first = |part: &&Part<'a>| part.declared.first().map(|(_, name)| *name);
        let names: Vec<&Name> = circle.iter().filter_map(first).collect();
        if let Some(name) = names.first() {
            let way: Vec<&str> = names.iter().map(|name| name.text.as_str()).collect();
            let message = format!("`{}` depends on itself: {} → {}", name.text, way.join(" → "), name.text);
            let help = match circle.iter().any(|part| part.statements.len() > 1) {
                true => {
                    "make two loops where one only holds both names; break a true circle by a state, `der(z) == …;`"
                }
                false => CIRCLE,
            };
            self.diagnostics.report(name.span, message, help);
        }
        for ((is_force, name), _) in circle.iter().flat_map(|part| &part.declared) {
            match is_force {
                true => self.names.mark_faulty_element(name),
                false => self.names.settle(name, Symbol::Faulty),
            }
        }
    }

    /// A `let` of forces, outside of loops.
    pub(super) fn late_let(
        &mut self,
        name: &Name,
        unit: Option<&Unit>,
        value: &Expression,
    ) -> Result<(), Fault> {
        if !matches!(self.names.get(&name.text), Some(Symbol::Later)) {
            return Ok(());
        }
        let defined = self.elaborate(Reach::Let, |work| definition(work, &name.text, unit, value));
        let needs = defined.as_ref().map_or(Reach::Position, |(_, needs)| *needs);
        self.names.define_needs(&name.text, needs);
        self.names.settle(&name.text, defined.map_or(Symbol::Faulty, |(value, _)| Symbol::Value(value)));
        Ok(())
    }
}
