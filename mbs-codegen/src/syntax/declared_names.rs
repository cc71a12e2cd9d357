//! Names that statements declare.

use super::ast::{Declares, Name, StatementKind};

impl StatementKind {
    /// `true` if the statement declares an event or a latched value.
    pub fn is_of_events(&self) -> bool {
        matches!(self, StatementKind::Event { .. } | StatementKind::Latch { .. })
    }

    /// Name that the statement declares, after the kind of names that it must differ from.
    pub fn declared(&self) -> Option<(&'static str, &Name)> {
        Some(match self {
            StatementKind::Const { name, .. }
            | StatementKind::Param { name, .. }
            | StatementKind::Input { name, .. }
            | StatementKind::Coord { name, .. }
            | StatementKind::Let { name, .. }
            | StatementKind::Function { name, .. }
            | StatementKind::Curve { name, .. }
            | StatementKind::Event { name, .. }
            | StatementKind::Latch { name, .. }
            | StatementKind::State { name, .. } => ("value", name),
            StatementKind::Faulty { name, declares: Declares::Element, .. } => ("load", name),
            StatementKind::Faulty { declares: Declares::Rows | Declares::Rate, .. } => return None,
            StatementKind::Faulty { name, .. } => ("value", name),
            StatementKind::Constraint { name, .. } | StatementKind::Drive { name, .. } => ("rows", name),
            StatementKind::Branch { name, .. } => ("branch", name),
            StatementKind::Limit { name, .. } => ("limit", name),
            StatementKind::Out { name, .. } => ("output", name),
            StatementKind::Element { name, .. }
            | StatementKind::Load { name, .. }
            | StatementKind::Energy { name, .. }
            | StatementKind::Pin { name, .. } => ("load", name),
            StatementKind::Independent { .. }
            | StatementKind::Rate { .. }
            | StatementKind::Start { .. }
            | StatementKind::For(_)
            | StatementKind::EndFor
            | StatementKind::Effect { .. }
            | StatementKind::EndEffect
            | StatementKind::Release { .. }
            | StatementKind::Scene { .. }
            | StatementKind::EndScene
            | StatementKind::Picture { .. } => return None,
        })
    }
}
