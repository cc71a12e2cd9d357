//! Constraints that effects release: `release pin;`.
//!
//! A scene with such an effect has none of their rows. Their names keep a meaning: a row that is not there carries no force.

use super::dynamics::Action;
use super::expression::Id;
use super::names::Rows;
use super::resolver::Resolver;
use super::springs::{SpringDamper, Turn};
use super::value::Fault;
use crate::diagnostics::{Diagnostics, nearest};
use crate::syntax::ast::{Declares, Element, Item, Name, Statement, StatementKind};

/// Most names that a cure lists.
const LISTED: usize = 6;

/// Before: the statements of a text, each with its effect, and the names of the effects. After: the effects with the constraints
/// that each one releases; releases of anything else are reported.
pub fn releases<'a>(
    parts: &[(Option<usize>, &'a Statement)],
    effects: &[&'a Name],
    diagnostics: &mut Diagnostics,
) -> Vec<(usize, &'a Name)> {
    let mut found: Vec<(usize, &'a Name)> = Vec::new();
    for (effect, statement) in parts {
        let (Some(effect), StatementKind::Release { names }) = (effect, &statement.kind) else { continue };
        for name in names {
            let known = found.iter().any(|(other, known)| other == effect && known.text == name.text);
            if known {
                let effect = effects.get(*effect).map_or("", |effect| effect.text.as_str());
                let message = format!("effect `{effect}` releases `{}` twice", name.text);
                diagnostics.report(name.span, message, "remove one of them");
            } else if is_of_base(parts, effects, name, diagnostics) {
                found.push((*effect, name));
            }
        }
    }
    found
}

/// `true` if the name is that of a constraint outside of all effects; otherwise reported.
fn is_of_base(
    parts: &[(Option<usize>, &Statement)],
    effects: &[&Name],
    name: &Name,
    diagnostics: &mut Diagnostics,
) -> bool {
    let of_name = || {
        parts.iter().filter(|(_, statement)| match &statement.kind {
            StatementKind::Faulty { name: known, .. } => known.text == name.text,
            kind => kind.declared().is_some_and(|(_, known)| known.text == name.text),
        })
    };
    let is_row = |kind: &StatementKind| matches!(kind, StatementKind::Constraint { .. });
    let is_faulty = |kind: &StatementKind| {
        matches!(kind, StatementKind::Faulty { declares: Declares::Rows | Declares::Value, .. })
    };
    if of_name().any(|(effect, statement)| effect.is_none() && is_row(&statement.kind)) {
        return true;
    }
    if of_name().any(|(_, statement)| is_faulty(&statement.kind)) {
        return false;
    }
    let mut known: Vec<&str> = Vec::new();
    for (effect, statement) in parts {
        if let (None, StatementKind::Constraint { name, .. }) = (effect, &statement.kind)
            && !known.contains(&name.text.as_str())
        {
            known.push(&name.text);
        }
    }
    let listed = || match known.as_slice() {
        [] => "a release takes out a constraint that stands outside of all effects, and the text has none"
            .into(),
        known => {
            let names: Vec<String> = known.iter().take(LISTED).map(|name| format!("`{name}`")).collect();
            format!("constraints outside of all effects are {}", names.join(", "))
        }
    };
    let (message, help) = match of_name().find(|(_, statement)| is_row(&statement.kind)) {
        Some((Some(effect), _)) => {
            let effect = effects.get(*effect).map_or("", |effect| effect.text.as_str());
            (
                format!("`{}` is a constraint of effect `{effect}`", name.text),
                format!(
                    "move the constraint out of the effect to release it, or leave `{effect}` out of the scene"
                ),
            )
        }
        _ => match of_name().next() {
            Some((_, statement)) => {
                let (kind, help) = match &statement.kind {
                    StatementKind::Drive { .. } => (
                        "a drive",
                        "write the drive in an effect of its own, and leave that out of the scene".into(),
                    ),
                    StatementKind::Coord { .. } => ("a coordinate", listed()),
                    StatementKind::Element { kind: Element::Body, .. } => ("a body", listed()),
                    StatementKind::Branch { .. } => ("a branch", listed()),
                    StatementKind::Limit { .. } => ("a limit", listed()),
                    StatementKind::Pin { .. } => ("a pin", listed()),
                    StatementKind::Out { .. } => ("an output", listed()),
                    StatementKind::Param { .. } => ("a parameter", listed()),
                    _ => ("something else", listed()),
                };
                (format!("`{}` is {kind} and no constraint", name.text), help)
            }
            None => {
                let help = match nearest(&name.text, known.iter().copied()) {
                    Some(meant) => format!("did you mean `{meant}`?"),
                    None => listed(),
                };
                (format!("there is no constraint `{}` to release", name.text), help)
            }
        },
    };
    diagnostics.report(name.span, message, help);
    false
}

impl Resolver<'_> {
    /// A force without the parts that are those of rows which are not there; `None` where nothing is left.
    pub(super) fn present(&self, action: Action) -> Option<Action> {
        let expressions = &self.model.expressions;
        let given = |part: Option<Id>| part.filter(|id| !expressions.is_absent(*id));
        match action {
            Action::Work(pairs) => {
                let is_there =
                    pairs.is_empty() || pairs.iter().any(|(force, _)| given(Some(*force)).is_some());
                is_there.then_some(Action::Work(pairs))
            }
            Action::Dissipation(power) => given(Some(power)).map(Action::Dissipation),
            Action::Line(line) => Some(Action::Line(SpringDamper {
                stiffness: given(line.stiffness),
                length: given(line.length),
                damping: given(line.damping),
                actuator: given(line.actuator),
                ..line
            })),
            Action::Turn(turn) => Some(Action::Turn(Turn {
                stiffness: given(turn.stiffness),
                rest: given(turn.rest),
                damping: given(turn.damping),
                torque: given(turn.torque),
                ..turn
            })),
        }
    }

    /// Before: a constraint that an effect of the scene releases. After: its name has as many rows without force; the model is as it
    /// was.
    pub(super) fn released(&mut self, name: &Name, items: &[Item]) -> Result<(), Fault> {
        let (rows, mark) = (self.model.rows.len(), self.model.expressions.mark());
        let read = self.constraint_rows((name, "released"), items);
        let gone = self.model.rows.split_off(rows.min(self.model.rows.len()));
        self.model.expressions.restore(mark);
        self.released_rows = self.released_rows.saturating_add(gone.len());
        let mut known = self.names.rows(&name.text).cloned().unwrap_or(Rows {
            rows: Vec::new(),
            driven: false,
            released: true,
        });
        known.rows.extend(gone.iter().map(|row| (usize::MAX, row.dimension)));
        self.names.define_rows(&name.text, known);
        read
    }
}
