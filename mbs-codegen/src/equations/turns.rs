//! Coordinates and inputs that turn without bound: no value may change with a whole turn of them, except the phases that hold
//! such a coordinate.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use proc_macro2::Span;

use super::Equations;
use crate::diagnostics::Diagnostics;
use crate::model::expression::{self, Id};
use crate::model::{ConstraintRow, Model, VariableKind};
use crate::symbolic::{Binary, Leaf, Node, NodeId, Unary};

/// Most angles whose turns one value may add up; of more it counts as changing otherwise, which keeps the work linear.
const MOST_ADDED: usize = 8;

/// A period in turns that is nearer to a whole number than this, in roundings of the quotient, is one.
const WHOLE: f64 = 4.0 * f64::EPSILON;

/// An angle that the text declares as `turn`, by its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Angle {
    Coordinate(usize),
    /// Among the variables.
    Input(usize),
}

/// Change of a value with whole turns of these angles.
#[derive(Clone, Debug, PartialEq)]
enum Shift {
    /// It changes by so many turns with each turn of an angle; an empty map means no change.
    Turns(BTreeMap<Angle, f64>),
    /// It changes otherwise with a turn of this angle.
    Otherwise(Angle),
}

impl Shift {
    const NONE: Shift = Shift::Turns(BTreeMap::new());

    /// Change of the angle itself.
    fn turn_of(angle: Angle) -> Shift {
        Shift::Turns(BTreeMap::from([(angle, 1.0)]))
    }

    /// An angle with whose turns the value changes.
    fn angle(&self) -> Option<Angle> {
        match self {
            Shift::Turns(turns) => turns.keys().next().copied(),
            Shift::Otherwise(angle) => Some(*angle),
        }
    }

    /// An angle with which the value changes by other than whole turns of a coordinate, which its phase is turned back by.
    fn broken(&self) -> Option<Angle> {
        let is_held =
            |angle: &Angle, count: &f64| matches!(angle, Angle::Coordinate(_)) && count.fract() == 0.0;
        match self {
            Shift::Turns(turns) => {
                turns.iter().find(|(angle, count)| !is_held(angle, count)).map(|(angle, _)| *angle)
            }
            Shift::Otherwise(angle) => Some(*angle),
        }
    }

    /// `self + sign other`
    fn plus(&self, sign: f64, other: &Shift) -> Shift {
        let (Shift::Turns(left), Shift::Turns(right)) = (self, other) else {
            let either = [self, other].into_iter().find(|shift| matches!(shift, Shift::Otherwise(_)));
            return either.cloned().unwrap_or(Shift::NONE);
        };
        let mut turns = left.clone();
        for (angle, count) in right {
            *turns.entry(*angle).or_insert(0.0) += sign * count;
        }
        turns.retain(|_, count| *count != 0.0);
        match turns.keys().next() {
            Some(first) if turns.len() > MOST_ADDED => Shift::Otherwise(*first),
            _ => Shift::Turns(turns),
        }
    }

    fn times(&self, factor: f64) -> Shift {
        match self {
            Shift::Turns(turns) => {
                Shift::Turns(turns.iter().map(|(c, count)| (*c, factor * count)).collect())
            }
            other => other.clone(),
        }
    }

    /// Change of a function of the values: it is constant where they are.
    fn of_any(values: &[&Shift]) -> Shift {
        match values.iter().find_map(|shift| shift.angle()) {
            Some(angle) => Shift::Otherwise(angle),
            None => Shift::NONE,
        }
    }

    /// Change of a function of the value with a period of so many turns.
    fn periodic(&self, period: f64) -> Shift {
        let counts = self.times(1.0 / period);
        let near = |count: f64| (count - count.round()).abs() <= WHOLE * count.abs();
        match &counts {
            Shift::Turns(turns) if turns.values().all(|count| near(*count)) => Shift::NONE,
            _ => Shift::of_any(&[self]),
        }
    }
}

/// A coordinate that turns.
#[derive(Debug)]
pub struct Turning {
    /// Its index.
    pub coordinate: usize,
    /// Phases that hold it, and the number of turns by which they change with one of it.
    pub phases: Vec<(usize, i64)>,
}

/// Before: equations without a fault of [`check`]. After: the coordinates that turn, in their order.
pub fn turning(model: &Model, equations: &Equations) -> Vec<Turning> {
    let shifts = shifts(model, equations);
    let mut turning: BTreeMap<usize, Vec<(usize, i64)>> =
        coordinates(model).map(|c| (c, Vec::new())).collect();
    for (index, phase) in equations.phases.iter().enumerate() {
        if let Some(Shift::Turns(turns)) = shifts.get(&phase.argument) {
            for (angle, count) in turns {
                if let Angle::Coordinate(coordinate) = angle {
                    turning.entry(*coordinate).or_default().push((index, *count as i64));
                }
            }
        }
    }
    turning.into_iter().map(|(coordinate, phases)| Turning { coordinate, phases }).collect()
}

/// Before: the equations of a model. After: rows, prescribed rates, branches and limits that change with a whole turn of an angle
/// declared as `turn` are reported. So is explicit dependence on the time where such a coordinate exists.
pub fn check(model: &Model, equations: &Equations, diagnostics: &mut Diagnostics) {
    let shifts = shifts(model, equations);
    let none = Shift::NONE;
    let mut reported = BTreeSet::new();
    let shift = |id: NodeId| shifts.get(&id).unwrap_or(&none);
    for (row, derived) in model.rows.iter().zip(&equations.rows) {
        let change = shift(derived.phi);
        let wrong = if holds_a_phase(model, row) { change.broken() } else { change.angle() };
        if let Some(angle) = wrong {
            let cure = match (row.driven, angle) {
                (true, Angle::Coordinate(_)) => held_to_an_input(model, row)
                    .unwrap_or_else(|| format!("prescribe a rate, `drive {}: rate({{}}) == …;`", row.name)),
                (true, Angle::Input(_)) => held_to_an_input(model, row).unwrap_or_else(|| CURE.to_owned()),
                _ => CURE.to_owned(),
            };
            changes(model, angle, (&format!("row `{}`", row.name), row.span), &cure, diagnostics);
            reported.insert(derived.phi);
        }
    }
    for (branch, value) in model.branches.iter().zip(&equations.branches) {
        if let Some(angle) = shift(*value).angle() {
            changes(model, angle, (&format!("branch `{}`", branch.name), branch.span), CURE, diagnostics);
        }
    }
    for (limit, values) in model.limits.iter().zip(&equations.limits) {
        if let Some(angle) = values.iter().find_map(|value| shift(*value).angle()) {
            changes(model, angle, (&format!("limit `{}`", limit.name), limit.span), CURE, diagnostics);
        }
    }
    for (what, root, span) in speeds(model, equations) {
        if let Some(angle @ Angle::Input(_)) = shift(root).angle() {
            changes(model, angle, (&what, span), CURE, diagnostics);
        }
    }
    let Some(first) = coordinates(model).next() else { return };
    let roots: Vec<(String, NodeId, Span)> = roots(model, equations).collect();
    let timed = timed(equations, roots.iter().map(|(_, root, _)| *root));
    for (what, root, span) in roots {
        if timed.contains(&root) && !reported.contains(&root) {
            let name = model.coordinates.get(first).map_or("", |coordinate| coordinate.name.as_str());
            diagnostics.report(
                span,
                format!("{what} depends on the time, and `{name}` turns for longer than the time has digits"),
                format!(
                    "take the motion from outside, `input x: …, rates;` or `drive …: rate({name}) == …;`, or declare \
                     `coord {name}: rad`"
                ),
            );
        }
    }
}

const CURE: &str =
    "write `{}` within `sin`, `cos`, `unit`, `rot` or a function of period TAU, times a whole number";

/// Cure of a drive that sets a coordinate equal to an input: rows without whole turns that say the same. Of other drives none.
fn held_to_an_input(model: &Model, row: &ConstraintRow) -> Option<String> {
    let node = |id: Id| model.expressions.node(id);
    let expression::Node::Binary(Binary::Subtract, a, b) = node(row.residual) else { return None };
    let (index, variable) = match (node(a), node(b)) {
        (expression::Node::Coordinate(index), expression::Node::Variable(variable))
        | (expression::Node::Variable(variable), expression::Node::Coordinate(index)) => (index, variable),
        _ => return None,
    };
    let input = model.variables.get(variable)?;
    if !matches!(input.kind, VariableKind::Input | VariableKind::InputWithRates) {
        return None;
    }
    // The row of a vector has a number behind a dot, which no declared name has.
    let (coordinate, drive) = (&model.coordinates.get(index)?.name, row.name.replace('.', "_"));
    let input = &input.name;
    Some(format!(
        "write `constraint {drive} {{ sin({coordinate} - {input}) == 0; }}` and `branch {drive}_ahead: \
         cos({coordinate} - {input}) > 0;` in its place"
    ))
}

/// Reports a value that changes with a turn of an angle; `{}` in the cure is its name.
fn changes(
    model: &Model,
    angle: Angle,
    (what, span): (&str, Span),
    cure: &str,
    diagnostics: &mut Diagnostics,
) {
    let (name, other) = match angle {
        Angle::Coordinate(index) => {
            let name = model.coordinates.get(index).map_or("", |coordinate| coordinate.name.as_str());
            (name, format!("coord {name}: rad"))
        }
        Angle::Input(index) => {
            let variable = model.variables.get(index);
            let name = variable.map_or("", |variable| variable.name.as_str());
            let rated = variable.is_some_and(|variable| variable.kind == VariableKind::InputWithRates);
            let rates = if rated { ", rates" } else { "" };
            (name, format!("input {}: rad{rates}", name.split('.').next().unwrap_or(name)))
        }
    };
    diagnostics.report(
        span,
        format!("{what} changes with a whole turn of `{name}`, which is declared as `turn`"),
        format!("{}, or declare `{other}`", cure.replace("{}", name)),
    );
}

fn coordinates(model: &Model) -> impl Iterator<Item = usize> + '_ {
    let all = model.coordinates.iter().enumerate();
    all.filter(|(_, coordinate)| coordinate.turns).map(|(index, _)| index)
}

/// `true` if the row is that of a drive that prescribes a rate: its phase turns with it.
fn holds_a_phase(model: &Model, row: &ConstraintRow) -> bool {
    let node = |id: Id| model.expressions.node(id);
    let is_phase = |id: Id| match node(id) {
        expression::Node::Variable(index) => model.phases.iter().any(|phase| phase.variable == index),
        _ => false,
    };
    row.driven
        && matches!(node(row.residual), expression::Node::Binary(Binary::Subtract, _, b) if is_phase(b))
}

/// Everything that the kinematics evaluate, with its name and place.
fn roots<'a>(
    model: &'a Model,
    equations: &'a Equations,
) -> impl Iterator<Item = (String, NodeId, Span)> + 'a {
    let rows = model.rows.iter().zip(&equations.rows);
    let rows = rows.map(|(row, derived)| (format!("row `{}`", row.name), derived.phi, row.span));
    let branches = model.branches.iter().zip(&equations.branches);
    let branches = branches.map(|(branch, value)| (format!("branch `{}`", branch.name), *value, branch.span));
    let limits = model.limits.iter().zip(&equations.limits);
    let limits = limits.map(|(limit, [_, value, _])| (format!("limit `{}`", limit.name), *value, limit.span));
    let outputs = model.outputs.iter().zip(&equations.outputs);
    let outputs = outputs.map(|(out, derived)| (format!("output `{}`", out.name), derived.value, out.span));
    rows.chain(speeds(model, equations)).chain(branches).chain(limits).chain(outputs)
}

/// The prescribed rates of phases, with names and places.
fn speeds<'a>(
    model: &'a Model,
    equations: &'a Equations,
) -> impl Iterator<Item = (String, NodeId, Span)> + 'a {
    model.phases.iter().zip(&equations.phases).filter_map(|(phase, derived)| {
        let variable = model.variables.get(phase.variable)?;
        Some((format!("the rate that moves `{}`", variable.name), derived.speed, variable.span))
    })
}

/// Nodes that depend on the time, of `roots` and all nodes below them.
fn timed(equations: &Equations, roots: impl Iterator<Item = NodeId>) -> BTreeSet<NodeId> {
    let (mut timed, mut operands) = (BTreeSet::new(), Vec::new());
    for id in equations.graph.reachable(roots) {
        let node = equations.graph.node(id);
        operands.clear();
        node.operands_onto(&mut operands);
        if node == Node::Leaf(Leaf::Time) || operands.iter().any(|operand| timed.contains(operand)) {
            timed.insert(id);
        }
    }
    timed
}

/// Shift by a whole turn of each value below rows, branches, limits and driven arguments, as far as there is one.
fn shifts(model: &Model, equations: &Equations) -> BTreeMap<NodeId, Shift> {
    let mut shifts: BTreeMap<NodeId, Shift> = BTreeMap::new();
    if coordinates(model).next().is_none() && !model.variables.iter().any(|variable| variable.turns) {
        return shifts;
    }
    let rows = equations.rows.iter().map(|row| row.phi);
    let others = equations.branches.iter().copied().chain(equations.limits.iter().flatten().copied());
    let phases = equations.phases.iter().flat_map(|phase| [phase.argument, phase.speed]);
    for id in equations.graph.reachable(rows.chain(others).chain(phases)) {
        let shift = of_node(equations.graph.node(id), model, equations, &shifts);
        if shift != Shift::NONE {
            shifts.insert(id, shift);
        }
    }
    shifts
}

fn of_node(node: Node, model: &Model, equations: &Equations, known: &BTreeMap<NodeId, Shift>) -> Shift {
    let none = Shift::NONE;
    let of = |id: NodeId| known.get(&id).unwrap_or(&none);
    let constant = |id: NodeId| equations.graph.constant_value(id);
    match node {
        Node::Leaf(Leaf::Position(index)) => {
            let index = index as usize;
            let turns = model.coordinates.get(index).is_some_and(|coordinate| coordinate.turns);
            if turns { Shift::turn_of(Angle::Coordinate(index)) } else { Shift::NONE }
        }
        Node::Leaf(Leaf::Input(index)) => {
            let index = index as usize;
            let turns = model.variables.get(index).is_some_and(|variable| variable.turns);
            if turns { Shift::turn_of(Angle::Input(index)) } else { Shift::NONE }
        }
        Node::Constant(_) | Node::Leaf(_) => Shift::NONE,
        Node::Unary(Unary::Negate, a) => of(a).times(-1.0),
        Node::Unary(Unary::Sin | Unary::Cos, a) => of(a).periodic(1.0),
        Node::Unary(Unary::Tan, a) => of(a).periodic(0.5),
        Node::Unary(_, a) => Shift::of_any(&[of(a)]),
        Node::Binary(Binary::Add, a, b) => of(a).plus(1.0, of(b)),
        Node::Binary(Binary::Subtract, a, b) => of(a).plus(-1.0, of(b)),
        Node::Binary(Binary::Multiply, a, b) => match (constant(a), constant(b)) {
            (Some(factor), _) => of(b).times(factor),
            (_, Some(factor)) => of(a).times(factor),
            _ => Shift::of_any(&[of(a), of(b)]),
        },
        Node::Binary(Binary::Divide, a, b) => match constant(b) {
            Some(divisor) if divisor != 0.0 => of(a).times(1.0 / divisor),
            _ => Shift::of_any(&[of(a), of(b)]),
        },
        Node::Binary(_, a, b) => Shift::of_any(&[of(a), of(b)]),
        Node::Select { less, than, yes, no } => Shift::of_any(&[of(less), of(than), of(yes), of(no)]),
        Node::Call { function, argument, .. } => {
            let period = model.functions.get(function as usize).and_then(|function| function.period);
            match period {
                Some(period) => of(argument).periodic(period / TAU),
                None => Shift::of_any(&[of(argument)]),
            }
        }
    }
}
