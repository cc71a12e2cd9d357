//! Declarations: constants, parameters, inputs, coordinates and `let`s.

use super::elaborate::{Elaborator, Fault, Quantity, Scalar, Value};
use super::expression::{Id, Node};
use super::names::Names;
use super::order::order;
use super::units::Dimension;
use super::{Coordinate, CoordinateField, Field, Model, Role, Variable, VariableKind};
use crate::diagnostics::Diagnostics;
use crate::syntax::ast::{Expression, Name, Statement, StatementKind, Type, Unit};

/// Most components of one declaration.
const MOST: usize = 10_000;

/// Before: statements in any order. After: all declarations outside loops are in `model` and `names`.
pub fn declare(
    statements: &[Statement],
    model: &mut Model,
    names: &mut Names,
    diagnostics: &mut Diagnostics,
) {
    let mut work = Declarations { model, names, diagnostics };
    let top: Vec<&Statement> = outside_loops(statements).collect();
    for statement in &top {
        if let Some(name) = declared_name(statement) {
            work.names.declare(name, work.diagnostics);
        }
    }
    work.constants(&top);
    work.give_up(&top, |kind| matches!(kind, StatementKind::Const { .. }));
    for statement in &top {
        let docs = statement.docs.clone();
        match &statement.kind {
            StatementKind::Param { name, kind, value } => work.parameter(name, docs, kind, value.as_ref()),
            StatementKind::Input { name, kind, rates } => work.input(name, docs, kind, *rates),
            _ => {}
        }
    }
    work.give_up(&top, |kind| matches!(kind, StatementKind::Param { .. } | StatementKind::Input { .. }));
    for statement in &top {
        if let StatementKind::Coord { name, kind, guess } = &statement.kind {
            work.coordinate(name, statement.docs.clone(), kind, guess.as_ref());
        }
    }
    work.give_up(&top, |kind| matches!(kind, StatementKind::Coord { .. }));
    work.lets(&top);
    work.give_up(&top, |_| true);
}

/// The statements that stand in no loop.
fn outside_loops(statements: &[Statement]) -> impl Iterator<Item = &Statement> {
    let mut depth = 0_usize;
    statements.iter().filter(move |statement| {
        match statement.kind {
            StatementKind::For(_) => depth += 1,
            StatementKind::EndFor => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0
    })
}

fn declared_name(statement: &Statement) -> Option<&Name> {
    match &statement.kind {
        StatementKind::Const { name, .. }
        | StatementKind::Param { name, .. }
        | StatementKind::Input { name, .. }
        | StatementKind::Coord { name, .. }
        | StatementKind::Let { name, .. } => Some(name),
        _ => None,
    }
}

struct Declarations<'a> {
    model: &'a mut Model,
    names: &'a mut Names,
    diagnostics: &'a mut Diagnostics,
}

impl Declarations<'_> {
    fn elaborate<T>(&mut self, run: impl FnOnce(&mut Elaborator<'_>) -> T) -> T {
        let mut work = Elaborator {
            expressions: &mut self.model.expressions,
            names: self.names,
            diagnostics: self.diagnostics,
            rates: false,
            longest: self.model.longest,
        };
        let result = run(&mut work);
        self.model.longest = work.longest;
        result
    }

    /// Marks names of a kind that got no value.
    fn give_up(&mut self, top: &[&Statement], kind: impl Fn(&StatementKind) -> bool) {
        for name in top.iter().filter(|statement| kind(&statement.kind)).filter_map(|s| declared_name(s)) {
            self.names.give_up(&name.text);
        }
    }

    fn constants(&mut self, top: &[&Statement]) {
        let constants: Vec<(&Name, &Unit, &Expression)> = top
            .iter()
            .filter_map(|statement| match &statement.kind {
                StatementKind::Const { name, unit, value } => Some((name, unit, value)),
                _ => None,
            })
            .filter(|(name, ..)| self.owns(name))
            .collect();
        let definitions: Vec<_> = constants.iter().map(|(name, _, value)| (*name, *value)).collect();
        for index in order(&definitions, self.diagnostics) {
            let Some((name, unit, expression)) = constants.get(index) else { continue };
            let dimension = Dimension::of(unit, self.diagnostics);
            let value = self.elaborate(|work| {
                let value = work.value(expression)?;
                let value = initialiser(work, value, dimension)?;
                numbers(work, &value, "a constant")?;
                Ok::<_, Fault>(value)
            });
            if let Ok(value) = value {
                self.note_lengths(&value);
                self.names.define(&name.text, value);
            }
        }
    }

    /// Whether this declaration, not an earlier one of the same name, stands behind the name.
    fn owns(&self, name: &Name) -> bool {
        self.names.declared_at(&name.text).is_some_and(|span| same_place(span, name.span))
    }

    fn note_lengths(&mut self, value: &Value) {
        for item in &value.items {
            if item.quantity == Quantity::Known(Dimension::METRE)
                && let Node::Number(length) = self.model.expressions.node(item.id)
            {
                self.model.longest = self.model.longest.max(length.abs());
            }
        }
    }

    fn shape(&mut self, kind: &Type) -> Option<(Vec<usize>, usize)> {
        let shape = self.elaborate(|work| {
            kind.shape
                .iter()
                .map(|length| {
                    let value = work.value(length)?;
                    match work.count(&value)? {
                        0 => Err(work.fault(
                            value.span,
                            "an array needs at least one component",
                            "write a positive length",
                        )),
                        length => Ok(length),
                    }
                })
                .collect::<Result<Vec<_>, Fault>>()
        });
        let shape = shape.ok()?;
        let size = shape.iter().try_fold(1_usize, |size, length| size.checked_mul(*length));
        match size.filter(|size| *size <= MOST) {
            Some(size) => Some((shape, size)),
            None => {
                let message = format!("the array has more than {MOST} components");
                self.diagnostics.report(kind.unit.span, message, "split it");
                None
            }
        }
    }

    fn parameter(&mut self, name: &Name, docs: Vec<String>, kind: &Type, value: Option<&Expression>) {
        let dimension = Dimension::of(&kind.unit, self.diagnostics);
        let Some((shape, size)) = self.shape(kind) else { return };
        if !self.owns(name) {
            return;
        }
        let Some(expression) = value else {
            self.diagnostics.report(
                name.span,
                format!("parameter `{}` has no default", name.text),
                format!(
                    "write `param {}: {} = …;`, or `input` for what is set before each step",
                    name.text, kind.unit.text
                ),
            );
            return;
        };
        let defaults = self.elaborate(|work| {
            let value = work.value(expression)?;
            let value = initialiser(work, value, dimension)?;
            fits_shape(work, &value, &shape)?;
            numbers(work, &value, "a default")
        });
        let defaults = defaults.unwrap_or_else(|_| vec![0.0; size]);
        let first = self.model.variables.len();
        for (component, default) in component_names(&name.text, &shape).zip(defaults) {
            self.variable(component, kind, dimension, default, VariableKind::Parameter, name);
        }
        let (items, role) = (first..first + size, Role::Parameter);
        self.field(name, docs, kind, shape, items.collect(), role);
    }

    fn input(&mut self, name: &Name, docs: Vec<String>, kind: &Type, rates: bool) {
        let dimension = Dimension::of(&kind.unit, self.diagnostics);
        let Some((shape, _)) = self.shape(kind) else { return };
        if !self.owns(name) {
            return;
        }
        let mut items = Vec::new();
        for component in component_names(&name.text, &shape) {
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
                    kind: VariableKind::InputRate,
                    span: name.span,
                });
            }
        }
        let role = if rates { Role::InputWithRates } else { Role::Input };
        self.field(name, docs, kind, shape, items, role);
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
            kind: what,
            span: name.span,
        });
    }

    /// Declares the field and defines its name as the variables `items`.
    fn field(
        &mut self,
        name: &Name,
        docs: Vec<String>,
        kind: &Type,
        shape: Vec<usize>,
        items: Vec<usize>,
        role: Role,
    ) {
        let unit = kind.unit.text.clone();
        let first = items.first().copied().unwrap_or(0);
        let dimension =
            self.model.variables.get(first).map_or(Dimension::NUMBER, |variable| variable.dimension);
        let ids = items.into_iter().map(|index| self.model.expressions.push(Node::Variable(index))).collect();
        let value = leaves(ids, &shape, dimension, name);
        self.model.fields.push(Field { name: name.clone(), docs, unit, shape, first, role });
        self.names.define(&name.text, value);
    }

    fn coordinate(&mut self, name: &Name, docs: Vec<String>, kind: &Type, guess: Option<&Expression>) {
        let dimension = Dimension::of(&kind.unit, self.diagnostics);
        let Some((shape, size)) = self.shape(kind) else { return };
        if !self.owns(name) {
            return;
        }
        let guesses = guess.map(|expression| {
            self.elaborate(|work| {
                let value = work.value(expression)?;
                let value = initialiser(work, value, dimension)?;
                fits_shape(work, &value, &shape)?;
                Ok::<_, Fault>(value)
            })
        });
        let guesses: Vec<Option<Id>> = match guesses {
            Some(Ok(value)) => {
                self.note_lengths(&value);
                value.items.iter().map(|item| Some(item.id)).collect()
            }
            Some(Err(_)) => vec![Some(self.model.expressions.push(Node::Number(0.0))); size],
            None => vec![None; size],
        };
        let first = self.model.coordinates.len();
        let unit = kind.unit.text.clone();
        for (component, guess) in component_names(&name.text, &shape).zip(guesses) {
            let unit = unit.clone();
            self.model.coordinates.push(Coordinate {
                name: component,
                unit,
                dimension,
                guess,
                span: name.span,
            });
        }
        let ids = (first..first + size).map(|i| self.model.expressions.push(Node::Coordinate(i))).collect();
        let value = leaves(ids, &shape, dimension, name);
        self.model.coordinate_fields.push(CoordinateField { name: name.clone(), docs, unit, shape, first });
        self.names.define(&name.text, value);
    }

    fn lets(&mut self, top: &[&Statement]) {
        let lets: Vec<(&Name, Option<&Unit>, &Expression)> = top
            .iter()
            .filter_map(|statement| match &statement.kind {
                StatementKind::Let { name, unit, value } => Some((name, unit.as_ref(), value)),
                _ => None,
            })
            .filter(|(name, ..)| self.owns(name))
            .collect();
        let definitions: Vec<_> = lets.iter().map(|(name, _, value)| (*name, *value)).collect();
        for index in order(&definitions, self.diagnostics) {
            let Some((name, unit, expression)) = lets.get(index) else { continue };
            if let Ok(value) = self.elaborate(|work| named(work, *unit, expression)) {
                self.names.define(&name.text, value);
            }
        }
    }
}

/// The value of a `let`, in its unit where one is declared.
pub fn named(
    work: &mut Elaborator<'_>,
    unit: Option<&Unit>,
    expression: &Expression,
) -> Result<Value, Fault> {
    let value = work.value(expression)?;
    match unit {
        None => Ok(value),
        Some(unit) => {
            let dimension = Dimension::of(unit, work.diagnostics);
            initialiser(work, value, dimension)
        }
    }
}

/// Before: the value behind a `=`. After: the same in the declared unit: bare numbers take it on, others must
/// have it.
pub fn initialiser(work: &mut Elaborator<'_>, value: Value, declared: Dimension) -> Result<Value, Fault> {
    let mut items = Vec::new();
    for item in &value.items {
        if !item.bare && item.quantity != Quantity::Any {
            let expected = Scalar { quantity: Quantity::Known(declared), ..*item };
            work.agree(expected, *item, value.span)?;
        }
        items.push(Scalar { quantity: Quantity::Known(declared), bare: false, ..*item });
    }
    Ok(Value { items, ..value })
}

/// The shape that was declared.
pub fn fits_shape(work: &mut Elaborator<'_>, value: &Value, shape: &[usize]) -> Result<(), Fault> {
    if value.shape == shape {
        return Ok(());
    }
    let declared = Value { shape: shape.to_vec(), items: Vec::new(), span: value.span }.describe();
    let message = format!("{} is declared, {} is given", declared, value.describe());
    Err(work.fault(value.span, message, "declare the shape as `[m; 2]`, give the components as `[x, y]`"))
}

fn numbers(work: &mut Elaborator<'_>, value: &Value, what: &str) -> Result<Vec<f64>, Fault> {
    let found: Option<Vec<f64>> = value
        .items
        .iter()
        .map(|item| match work.expressions.node(item.id) {
            Node::Number(number) => Some(number),
            _ => None,
        })
        .collect();
    found.ok_or_else(|| {
        work.fault(value.span, format!("{what} must be a number"), "use numbers and constants alone")
    })
}

fn leaves(ids: Vec<Id>, shape: &[usize], dimension: Dimension, name: &Name) -> Value {
    let quantity = Quantity::Known(dimension);
    let items = ids.into_iter().map(|id| Scalar { id, quantity, bare: false }).collect();
    Value { shape: shape.to_vec(), items, span: name.span }
}

/// `p`, or `p.0`, `p.1`, …, or `p.0.0`, … for the components of an array.
pub fn component_names<'a>(name: &'a str, shape: &'a [usize]) -> impl Iterator<Item = String> + 'a {
    (0..shape.iter().product()).map(move |flat| {
        let mut suffix = String::new();
        let mut rest = flat;
        for length in shape.iter().rev() {
            suffix = format!(".{}{suffix}", rest % length.max(&1));
            rest /= length.max(&1);
        }
        format!("{name}{suffix}")
    })
}

fn same_place(a: proc_macro2::Span, b: proc_macro2::Span) -> bool {
    let (a, b) = (a.start(), b.start());
    (a.line, a.column) == (b.line, b.column)
}
