//! Coordinates that turn for days: that nothing changes with a whole turn of them, but for the phases that hold them.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use proc_macro2::Span;

use super::Equations;
use crate::diagnostics::Diagnostics;
use crate::model::expression::{self, Id};
use crate::model::{Model, Row};
use crate::symbolic::{Binary, Leaf, Node, NodeId, Unary};

/// Most coordinates whose turns one value may add up; of more it counts as changing otherwise, which keeps the work linear.
const MOST_ADDED: usize = 8;

/// A period in turns that is nearer to a whole number than this, in roundings of the quotient, is one.
const WHOLE: f64 = 4.0 * f64::EPSILON;

/// What whole turns of the coordinates do to a value.
#[derive(Clone, Debug, PartialEq)]
enum Shift {
    /// It changes by so many turns with each turn of a coordinate; nothing where none is named.
    Turns(BTreeMap<usize, f64>),
    /// It changes otherwise with a turn of this coordinate.
    Otherwise(usize),
}

impl Shift {
    const NONE: Shift = Shift::Turns(BTreeMap::new());

    /// A coordinate with whose turns the value changes.
    fn coordinate(&self) -> Option<usize> {
        match self {
            Shift::Turns(turns) => turns.keys().next().copied(),
            Shift::Otherwise(coordinate) => Some(*coordinate),
        }
    }

    /// A coordinate with which the value changes by other than whole turns.
    fn broken(&self) -> Option<usize> {
        match self {
            Shift::Turns(turns) => turns.iter().find(|(_, count)| count.fract() != 0.0).map(|(c, _)| *c),
            Shift::Otherwise(coordinate) => Some(*coordinate),
        }
    }

    /// `self + sign other`
    fn plus(&self, sign: f64, other: &Shift) -> Shift {
        let (Shift::Turns(left), Shift::Turns(right)) = (self, other) else {
            let either = [self, other].into_iter().find(|shift| matches!(shift, Shift::Otherwise(_)));
            return either.cloned().unwrap_or(Shift::NONE);
        };
        let mut turns = left.clone();
        for (coordinate, count) in right {
            *turns.entry(*coordinate).or_insert(0.0) += sign * count;
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

    /// Of a function that depends on the values: it stays where they stay.
    fn of_any(values: &[&Shift]) -> Shift {
        match values.iter().find_map(|shift| shift.coordinate()) {
            Some(coordinate) => Shift::Otherwise(coordinate),
            None => Shift::NONE,
        }
    }

    /// Of a function of the value with a period of so many turns.
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
    /// Phases that hold it, and by how many turns they change with one of it.
    pub phases: Vec<(usize, i64)>,
}

/// Before: equations that [`check`] has no fault of. After: the coordinates that turn, in their order.
pub fn turning(model: &Model, equations: &Equations) -> Vec<Turning> {
    let shifts = shifts(model, equations);
    let mut turning: BTreeMap<usize, Vec<(usize, i64)>> =
        coordinates(model).map(|c| (c, Vec::new())).collect();
    for (index, phase) in equations.phases.iter().enumerate() {
        if let Some(Shift::Turns(turns)) = shifts.get(&phase.argument) {
            for (coordinate, count) in turns {
                turning.entry(*coordinate).or_default().push((index, *count as i64));
            }
        }
    }
    turning.into_iter().map(|(coordinate, phases)| Turning { coordinate, phases }).collect()
}

/// Before: the equations of a model. After: rows, branches and limits that change with a whole turn of a coordinate that turns
/// are reported, and what depends on the time beside one.
pub fn check(model: &Model, equations: &Equations, diagnostics: &mut Diagnostics) {
    let Some(first) = coordinates(model).next() else { return };
    let shifts = shifts(model, equations);
    let none = Shift::NONE;
    let mut reported = BTreeSet::new();
    let shift = |id: NodeId| shifts.get(&id).unwrap_or(&none);
    for (row, derived) in model.rows.iter().zip(&equations.rows) {
        let change = shift(derived.phi);
        let wrong = if holds_a_phase(model, row) { change.broken() } else { change.coordinate() };
        if let Some(coordinate) = wrong {
            let cure = match row.driven {
                true => format!("prescribe a rate, `drive {}: rate({{}}) == …;`", row.name),
                false => CURE.to_owned(),
            };
            changes(model, coordinate, (&format!("row `{}`", row.name), row.span), &cure, diagnostics);
            reported.insert(derived.phi);
        }
    }
    for (branch, value) in model.branches.iter().zip(&equations.branches) {
        if let Some(coordinate) = shift(*value).coordinate() {
            changes(
                model,
                coordinate,
                (&format!("branch `{}`", branch.name), branch.span),
                CURE,
                diagnostics,
            );
        }
    }
    for (limit, values) in model.limits.iter().zip(&equations.limits) {
        if let Some(coordinate) = values.iter().find_map(|value| shift(*value).coordinate()) {
            changes(model, coordinate, (&format!("limit `{}`", limit.name), limit.span), CURE, diagnostics);
        }
    }
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

/// Reports what changes with a turn of a coordinate; `{}` in the cure is its name.
fn changes(
    model: &Model,
    coordinate: usize,
    (what, span): (&str, Span),
    cure: &str,
    diagnostics: &mut Diagnostics,
) {
    let name = model.coordinates.get(coordinate).map_or("", |coordinate| coordinate.name.as_str());
    diagnostics.report(
        span,
        format!("{what} changes with a whole turn of `{name}`, which is declared as `turn`"),
        format!("{}, or declare `coord {name}: rad`", cure.replace("{}", name)),
    );
}

fn coordinates(model: &Model) -> impl Iterator<Item = usize> + '_ {
    let all = model.coordinates.iter().enumerate();
    all.filter(|(_, coordinate)| coordinate.turns).map(|(index, _)| index)
}

/// Whether the row is that of a drive that prescribes a rate: its phase turns with it.
fn holds_a_phase(model: &Model, row: &Row) -> bool {
    let node = |id: Id| model.expressions.node(id);
    let is_phase = |id: Id| match node(id) {
        expression::Node::Variable(index) => model.phases.iter().any(|phase| phase.variable == index),
        _ => false,
    };
    row.driven
        && matches!(node(row.residual), expression::Node::Binary(expression::Binary::Subtract, _, b) if is_phase(b))
}

/// Everything that the kinematics evaluate, with its name and place.
fn roots<'a>(
    model: &'a Model,
    equations: &'a Equations,
) -> impl Iterator<Item = (String, NodeId, Span)> + 'a {
    let rows = model.rows.iter().zip(&equations.rows);
    let rows = rows.map(|(row, derived)| (format!("row `{}`", row.name), derived.phi, row.span));
    let speeds = model.phases.iter().zip(&equations.phases).filter_map(|(phase, derived)| {
        let variable = model.variables.get(phase.variable)?;
        Some((format!("the rate that moves `{}`", variable.name), derived.speed, variable.span))
    });
    let branches = model.branches.iter().zip(&equations.branches);
    let branches = branches.map(|(branch, value)| (format!("branch `{}`", branch.name), *value, branch.span));
    let limits = model.limits.iter().zip(&equations.limits);
    let limits = limits.map(|(limit, [_, value, _])| (format!("limit `{}`", limit.name), *value, limit.span));
    let outputs = model.outputs.iter().zip(&equations.outputs);
    let outputs = outputs.map(|(out, derived)| (format!("output `{}`", out.name), derived.value, out.span));
    rows.chain(speeds).chain(branches).chain(limits).chain(outputs)
}

/// What depends on the time among `roots` and all that they are made of.
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

/// What turns do to each value below rows, branches, limits and driven arguments, as far as they do anything.
fn shifts(model: &Model, equations: &Equations) -> BTreeMap<NodeId, Shift> {
    let mut shifts: BTreeMap<NodeId, Shift> = BTreeMap::new();
    if coordinates(model).next().is_none() {
        return shifts;
    }
    let rows = equations.rows.iter().map(|row| row.phi);
    let others = equations.branches.iter().copied().chain(equations.limits.iter().flatten().copied());
    let arguments = equations.phases.iter().map(|phase| phase.argument);
    for id in equations.graph.reachable(rows.chain(others).chain(arguments)) {
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
            if turns { Shift::Turns(BTreeMap::from([(index, 1.0)])) } else { Shift::NONE }
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
