//! Rows that keep Euler parameters e of an orientation at the length 1.

use std::collections::BTreeMap;

use proc_macro2::Span;

use super::ConstraintRow;
use super::element_fields::ORIENTATION;
use super::expression::{Expressions, Id, Node};
use super::initialiser::initialiser;
use super::resolver::Resolver;
use super::rotation::{join, parameters};
use super::units::Dimension;
use super::value::{Fault, Reach, Scalar};
use super::vanishing::vanish;
use crate::symbolic::Binary;
use crate::syntax::ast::{Field, Name};

impl Resolver<'_> {
    /// Before: a body as written. After: if its orientation consists of coordinates, the row e·e − 1 = 0 of the body's name
    /// is in the model; bodies that share their parameters share the row of the first.
    ///
    /// Parameters that are expressions, `[cos(phi/2), 0, 0, sin(phi/2)]`, are of length 1 by their definition.
    pub(super) fn normalisation(&mut self, name: &Name, fields: &[Field]) -> Result<(), Fault> {
        let Some(field) = fields.iter().find(|field| field.name.text == ORIENTATION) else { return Ok(()) };
        let value = self.elaborate(Reach::Position, |work| {
            let value = work.value(&field.value)?;
            let value = initialiser(work, value, Dimension::NUMBER)?;
            parameters(work, &value, "`orientation`").map(|_| value)
        })?;
        let coordinate = |item: &Scalar| match self.model.expressions.node(item.id) {
            Node::Coordinate(index) => Some(index),
            _ => None,
        };
        let coordinates: Vec<Option<usize>> = value.items.iter().map(coordinate).collect();
        let shared = self.oriented.contains_key(&coordinates);
        if shared || coordinates.iter().all(Option::is_none) {
            return Ok(());
        }
        let group = self.group(name, "constraint")?;
        let residual = self.elaborate(Reach::Position, |work| {
            let pairs = value.items.iter().map(|item| (*item, *item));
            let square = work.sum_of_products(pairs, value.span)?;
            let one = work.number_literal(1.0, value.span);
            join(work, Binary::Subtract, square, one, value.span)
        })?;
        if coordinates.iter().all(Option::is_some) {
            self.oriented.insert(coordinates, (name.text.clone(), self.model.rows.len()));
        }
        self.push_row(group, normalised(residual.id, name.span));
        Ok(())
    }

    /// Before: all rows. After: rows of the text that hold wherever e·e = 1 does, and add no other condition, are reported.
    ///
    /// They are recognised by their leaves, the parameters of bodies alone, and by their values at unit vectors, not by how they
    /// are written.
    pub(super) fn check_normalisations(&mut self) {
        if self.oriented.is_empty() {
            return;
        }
        let model = &*self.model;
        let bodies: Vec<(&String, usize)> = self.oriented.values().map(|(body, row)| (body, *row)).collect();
        let mut places = BTreeMap::new();
        let mut shared = Vec::new();
        for (body, coordinates) in self.oriented.keys().enumerate() {
            for (place, coordinate) in coordinates.iter().flatten().enumerate() {
                shared.extend(places.insert(*coordinate, (body, place)).map(|_| *coordinate));
            }
        }
        // Two lengths of 1 over the same coordinates are no free choice of unit vectors.
        places.retain(|coordinate, _| !shared.contains(coordinate));
        let parts = parts(&model.expressions, &places);
        let vanish = vanish(&model.expressions, &places);
        for (index, row) in model.rows.iter().enumerate() {
            let is_own = bodies.iter().any(|(_, own)| *own == index);
            if is_own || vanish.get(row.residual.index()) != Some(&true) {
                continue;
            }
            let (message, help) = match parts.get(row.residual.index()) {
                Some(ParameterUse::Of(body)) => {
                    let Some((body, own)) = bodies.get(*body) else { continue };
                    let own = model.rows.get(*own).map_or(body.as_str(), |row| row.name.as_str());
                    (
                        format!("the row `{}` repeats that of `{body}`", row.name),
                        format!(
                            "remove it: Euler parameters of a body bring their row e·e = 1, its multiplier is `lambda({own})`"
                        ),
                    )
                }
                Some(ParameterUse::OfSeveral) => (
                    format!("the row `{}` follows from the lengths of Euler parameters", row.name),
                    "remove it: Euler parameters of each body bring their row e·e = 1".to_owned(),
                ),
                _ => continue,
            };
            self.diagnostics.report(row.span, message, help);
        }
    }
}

/// Euler parameters that an expression depends on.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ParameterUse {
    /// Numbers alone.
    Number,
    /// Those of one body, by its index.
    Of(usize),
    /// Those of several bodies.
    OfSeveral,
    /// Anything else.
    Other,
}

/// Before: the body and the place in its parameters of each coordinate that is one. After: the parameters that each
/// expression depends on.
fn parts(expressions: &Expressions, places: &BTreeMap<usize, (usize, usize)>) -> Vec<ParameterUse> {
    let mut parts: Vec<ParameterUse> = Vec::with_capacity(expressions.len());
    for (_, node) in expressions.iter() {
        let below = |id: Id| parts.get(id.index()).copied().unwrap_or(ParameterUse::Other);
        let part = match node {
            Node::Number(_) => ParameterUse::Number,
            Node::Coordinate(index) => {
                places.get(&index).map_or(ParameterUse::Other, |(body, _)| ParameterUse::Of(*body))
            }
            Node::Unary(_, a) => below(a),
            Node::Binary(_, a, b) => match (below(a), below(b)) {
                (ParameterUse::Number, part) | (part, ParameterUse::Number) => part,
                (a, b) if a == b => a,
                (ParameterUse::Other, _) | (_, ParameterUse::Other) => ParameterUse::Other,
                _ => ParameterUse::OfSeveral,
            },
            _ => ParameterUse::Other,
        };
        parts.push(part);
    }
    parts
}

fn normalised(residual: Id, span: Span) -> ConstraintRow {
    let (name, driven, reversed, redundant) = (String::new(), false, false, false);
    ConstraintRow {
        name,
        dimension: Dimension::NUMBER,
        residual,
        driven,
        reversed,
        redundant,
        within: None,
        span,
    }
}
