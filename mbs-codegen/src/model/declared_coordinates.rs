//! Declarations of coordinates and of first-order states.

use super::bare_angles::is_of_angles;
use super::declarations::Declarations;
use super::declared_types::component_names;
use super::dynamics::FirstOrderState;
use super::expression::{Id, Node};
use super::initialiser::{filling, initialiser};
use super::turns::turning;
use super::unit_faults::Place;
use super::value::Fault;
use super::{Coordinate, CoordinateField};
use crate::syntax::ast::{Expression, Name, Type};

impl Declarations<'_> {
    pub(super) fn coordinate(
        &mut self,
        name: &Name,
        docs: Vec<String>,
        kind: &Type,
        guess: Option<&Expression>,
    ) {
        let (kind, turns) = turning(kind);
        let kind = kind.as_ref();
        let declared = self.declared(kind);
        if !self.owns(name) {
            return;
        }
        let (dimension, size) = (declared.dimension, declared.size);
        let known = self.model.expressions.len();
        let guesses = guess.filter(|_| !declared.faulty).map(|expression| {
            self.elaborate(|work| {
                if is_of_angles(&kind.unit) {
                    work.bare_angles(&expression.code)?;
                }
                let value = work.value(expression)?;
                let place = Place::Value(name.text.clone());
                let value =
                    work.concerning(place, (expression, None), |work| initialiser(work, value, dimension))?;
                filling(work, value, &declared.shape)
            })
        });
        let guesses: Vec<Option<Id>> = match guesses {
            Some(Ok(value)) => {
                self.name_lengths(&value, known, &format!("guess of {}", name.text), name.span);
                value.items.iter().map(|item| Some(item.id)).collect()
            }
            Some(Err(Fault)) => vec![Some(self.model.expressions.push(Node::Number(0.0))); size],
            None => vec![None; size],
        };
        let first = self.model.coordinates.len();
        let unit = kind.unit.text.clone();
        for (component, guess) in component_names(&name.text, &declared.shape).zip(guesses) {
            let unit = unit.clone();
            self.model.coordinates.push(Coordinate {
                name: component,
                unit,
                dimension,
                turns,
                guess,
                span: name.span,
            });
        }
        let ids = (first..first + size).map(|i| self.model.expressions.push(Node::Coordinate(i))).collect();
        self.define(name, &declared, ids);
        let shape = declared.shape;
        self.model.coordinate_fields.push(CoordinateField { name: name.clone(), docs, unit, shape, first });
    }

    pub(super) fn state(&mut self, name: &Name, kind: &Type, start: Option<&Expression>) {
        let declared = self.declared(kind);
        if !self.owns(name) {
            return;
        }
        let (dimension, size) = (declared.dimension, declared.size);
        let starts = start.filter(|_| !declared.faulty).map(|expression| {
            self.elaborate(|work| {
                let value = work.value(expression)?;
                let place = Place::Value(name.text.clone());
                let value =
                    work.concerning(place, (expression, None), |work| initialiser(work, value, dimension))?;
                let value = filling(work, value, &declared.shape)?;
                Ok::<_, Fault>(value.items.iter().map(|item| item.id).collect::<Vec<Id>>())
            })
        });
        let starts = starts.and_then(Result::ok).unwrap_or_default();
        let states = &mut self.model.dynamics.get_or_insert_default().states;
        let first = states.len();
        for (index, component) in component_names(&name.text, &declared.shape).enumerate() {
            states.push(FirstOrderState {
                name: component,
                unit: kind.unit.text.clone(),
                start: starts.get(index).copied(),
                rate: None,
                span: name.span,
            });
        }
        let ids = (first..first + size).map(|i| self.model.expressions.push(Node::State(i))).collect();
        self.define(name, &declared, ids);
    }
}
