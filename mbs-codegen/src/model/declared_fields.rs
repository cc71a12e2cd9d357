//! Declarations of the fields of a mechanism: parameters and inputs.

use super::bare_angles::is_of_angles;
use super::declarations::Declarations;
use super::declared_types::{DeclaredType, component_names};
use super::expression::Node;
use super::initialiser::{filling, initialiser, numbers};
use super::turns::turning;
use super::unit_faults::Place;
use super::units::Dimension;
use super::{Field, Role, Variable, VariableKind};
use crate::syntax::ast::{Bounds, Expression, Name, Type};

/// Range of a parameter about which the text says nothing.
pub(super) const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

impl Declarations<'_> {
    pub(super) fn parameter(
        &mut self,
        name: &Name,
        docs: Vec<String>,
        kind: &Type,
        (value, bounds): (Option<&Expression>, &Bounds),
    ) {
        let declared = self.declared(kind);
        if !self.owns(name) {
            return;
        }
        let defaults = match value {
            None => {
                self.diagnostics.report(
                    name.span,
                    format!("parameter `{}` has no default", name.text),
                    format!(
                        "write `param {}: {} = …;`, or `input` for what is set before each step",
                        name.text, kind.unit.text
                    ),
                );
                None
            }
            Some(_) if declared.faulty => None,
            Some(expression) => self
                .elaborate(|work| {
                    if is_of_angles(&kind.unit) {
                        work.bare_angles(&expression.code)?;
                    }
                    let value = work.value(expression)?;
                    let place = Place::Value(name.text.clone());
                    let value = work.concerning(place, (expression, None), |work| {
                        initialiser(work, value, declared.dimension)
                    })?;
                    let value = filling(work, value, &declared.shape)?;
                    numbers(work, expression, &value, "a default")
                })
                .ok(),
        };
        let dimension = (!declared.faulty).then_some(declared.dimension);
        let known = defaults.clone();
        let defaults = defaults.unwrap_or_else(|| vec![0.0; declared.size]);
        let first = self.model.variables.len();
        self.parameter_field(name, docs, kind, declared, defaults);
        if let Some(dimension) = dimension {
            self.bound(name, first, (dimension, bounds), known.as_deref());
        }
    }

    pub(super) fn parameter_field(
        &mut self,
        name: &Name,
        docs: Vec<String>,
        kind: &Type,
        declared: DeclaredType,
        defaults: Vec<f64>,
    ) {
        let first = self.model.variables.len();
        let items = first..first + declared.size;
        for (component, default) in component_names(&name.text, &declared.shape).zip(defaults) {
            self.variable(component, kind, declared.dimension, default, VariableKind::Parameter, name);
        }
        self.field(name, docs, kind, declared, items.collect(), Role::Parameter);
    }

    pub(super) fn input(&mut self, name: &Name, docs: Vec<String>, kind: &Type, rates: bool) {
        let (kind, turns) = turning(kind);
        let kind = kind.as_ref();
        let declared = self.declared(kind);
        if !self.owns(name) {
            return;
        }
        let dimension = declared.dimension;
        let mut items = Vec::new();
        for component in component_names(&name.text, &declared.shape) {
            items.push(self.model.variables.len());
            if !rates {
                self.variable(component, kind, dimension, 0.0, VariableKind::Input, name);
                continue;
            }
            self.variable(component.clone(), kind, dimension, 0.0, VariableKind::InputWithRates, name);
            for (suffix, order) in [("rate", 1), ("acceleration", 2)] {
                let seconds = Dimension::SECOND.power(f64::from(order)).unwrap_or_default();
                self.model.variables.push(Variable {
                    name: format!("{component}.{suffix}"),
                    unit: format!("{}/s{}", kind.unit.text, if order == 1 { "" } else { "^2" }),
                    dimension: dimension.over(seconds),
                    default: 0.0,
                    range: ANY,
                    tolerance: None,
                    turns: false,
                    kind: VariableKind::InputRate,
                    span: name.span,
                });
            }
        }
        for item in &items {
            if let Some(variable) = self.model.variables.get_mut(*item) {
                variable.turns = turns;
            }
        }
        let role = if rates { Role::InputWithRates } else { Role::Input };
        self.field(name, docs, kind, declared, items, role);
    }

    fn variable(
        &mut self,
        component: String,
        kind: &Type,
        dimension: Dimension,
        default: f64,
        what: VariableKind,
        name: &Name,
    ) {
        self.model.variables.push(Variable {
            name: component,
            unit: kind.unit.text.clone(),
            dimension,
            default,
            range: ANY,
            tolerance: None,
            turns: false,
            kind: what,
            span: name.span,
        });
    }

    /// Declares the field and defines its name as the variables `items`.
    pub(super) fn field(
        &mut self,
        name: &Name,
        docs: Vec<String>,
        kind: &Type,
        declared: DeclaredType,
        items: Vec<usize>,
        role: Role,
    ) {
        let unit = kind.unit.text.clone();
        let first = items.first().copied().unwrap_or(0);
        let ids = items.into_iter().map(|index| self.model.expressions.push(Node::Variable(index))).collect();
        self.define(name, &declared, ids);
        self.model.fields.push(Field { name: name.clone(), docs, unit, shape: declared.shape, first, role });
    }
}
