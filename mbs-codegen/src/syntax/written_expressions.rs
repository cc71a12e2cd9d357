//! Expressions of a statement, as it is written.

use super::ast::{Bounds, Ends, Expression, Item, Joined, StatementKind};

impl StatementKind {
    /// All expressions of the statement, in the order of the text.
    pub fn expressions(&self) -> Vec<&Expression> {
        match self {
            StatementKind::Const { value, .. } | StatementKind::Let { value, .. } => vec![value],
            StatementKind::Param { kind, value, bounds, .. } => {
                let Bounds { range, tolerance } = bounds;
                let ends = range.iter().flat_map(|(low, high)| [low, high]);
                kind.shape.iter().chain(value).chain(ends).chain(tolerance).collect()
            }
            StatementKind::Coord { kind, guess: value, .. } => kind.shape.iter().chain(value).collect(),
            StatementKind::Input { kind, .. } => kind.shape.iter().collect(),
            StatementKind::Function { signature, .. } => {
                signature.value.shape.iter().chain(&signature.period).collect()
            }
            StatementKind::Curve { centre, turned, functions, .. } => {
                let parts = functions.iter().flat_map(|(call, number)| [Some(call), number.as_ref()]);
                [centre, turned].into_iter().chain(parts.flatten()).collect()
            }
            StatementKind::Constraint { within, items, .. } => {
                within.iter().chain(items.iter().flat_map(Item::expressions)).collect()
            }
            StatementKind::Drive { equation, .. } => vec![&equation.left, &equation.right],
            StatementKind::Branch { larger, smaller, .. } => vec![larger, smaller],
            StatementKind::Limit { first, second, third, .. } => {
                [first, second].into_iter().chain(third).collect()
            }
            StatementKind::Event { begins, ends, .. } => {
                let end = match ends {
                    Ends::When(condition) => Some(condition),
                    Ends::Opposite | Ends::Never => None,
                };
                [begins].into_iter().chain(end).flat_map(|one| [&one.larger, &one.smaller]).collect()
            }
            StatementKind::Out { kind, value, .. } => kind.shape.iter().chain([value]).collect(),
            StatementKind::Latch { kind, value, event, .. } => {
                kind.shape.iter().chain([value]).chain(&event.index).collect()
            }
            StatementKind::Element { fields, .. } => fields
                .iter()
                .flat_map(|field| [&field.value].into_iter().chain(index_of(&field.of)))
                .collect(),
            StatementKind::Pin { bodies, at, .. } => {
                bodies.iter().filter_map(|body| body.index.as_ref()).chain([at]).collect()
            }
            StatementKind::Load { value, on, of, .. } => {
                [value, on].into_iter().chain(index_of(of)).collect()
            }
            StatementKind::Energy { value, .. } => vec![value],
            StatementKind::State { kind, value, .. } => kind.shape.iter().chain(value).collect(),
            StatementKind::Rate { state, rate, .. } => vec![state, rate],
            StatementKind::Start { coordinate, value, rate, .. } => {
                [coordinate, value].into_iter().chain(rate).collect()
            }
            StatementKind::For(head) => vec![&head.low, &head.high],
            StatementKind::Independent { .. }
            | StatementKind::EndFor
            | StatementKind::Effect { .. }
            | StatementKind::EndEffect
            | StatementKind::Release { .. }
            | StatementKind::Scene { .. }
            | StatementKind::EndScene
            | StatementKind::Picture { .. }
            | StatementKind::Faulty { .. } => Vec::new(),
        }
    }
}

/// The number of a body in a loop, where one is given.
fn index_of(body: &Option<Joined>) -> Option<&Expression> {
    body.as_ref()?.index.as_ref()
}

impl Item {
    fn expressions(&self) -> Vec<&Expression> {
        match self {
            Item::Equation(equation) => vec![&equation.left, &equation.right],
            Item::On { point, .. } => vec![point],
            Item::For(head) => vec![&head.low, &head.high],
            Item::EndFor => Vec::new(),
        }
    }
}
