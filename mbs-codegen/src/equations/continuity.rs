//! Derivatives of declared functions that the equations need, checked against the continuity that the text declares.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use proc_macro2::Span;

use super::{Dynamics, Equations, Row, SetValuedRow, Sparse};
use crate::diagnostics::Diagnostics;
use crate::model::Model;
use crate::symbolic::{Leaf, Node, NodeId};

/// The highest derivative of a function that something needs.
#[derive(Clone, Debug)]
pub struct Demand {
    /// Index of the function.
    pub function: usize,
    /// Order of the derivative; 0 where the value is enough.
    pub order: u8,
    /// Quantity that needs it, as a message calls it.
    pub by: String,
    /// Call of the function in the text.
    pub span: Span,
    /// Argument of the call.
    argument: NodeId,
}

/// Before: the equations of a model. After: a demand beyond the declared continuity is reported where the text calls
/// the function, once a call, with the quantity of the highest demand.
pub fn check(model: &Model, equations: &Equations, diagnostics: &mut Diagnostics) {
    let mut worst: BTreeMap<(usize, usize, usize), Demand> = BTreeMap::new();
    for demand in demands(model, equations) {
        let start = demand.span.start();
        // Rounds of a loop call functions of one array in one place.
        let place = (model.first_of_declaration(demand.function), start.line, start.column);
        if worst.get(&place).is_none_or(|known| known.order < demand.order) {
            worst.insert(place, demand);
        }
    }
    for Demand { function, order, by, span, argument: place } in worst.into_values() {
        let Some(function) = model.functions.get(function).filter(|f| f.continuity < order) else { continue };
        let (name, declared) = (&function.name.text, function.continuity);
        let (unit, argument) = (function.declared_unit(), &function.argument_unit);
        let closed = if function.period == Some(TAU) { ", periodic TAU" } else { "" };
        let mut help = format!(
            "supply a smoother function and declare it, `function {name}: {unit}({argument}), C{order}{closed};`"
        );
        // Before a coordinate is known a caller can compute it, and knows which side of a jump holds.
        if !contains_coordinate(equations, place) {
            help += &format!(
                "; or take its values and rates from outside, where they may jump: `input {name}: {unit}, rates;`"
            );
        }
        diagnostics.report(
            span,
            format!("{by} needs {} of `{name}`, which is declared C{declared}", derivative(order)),
            help,
        );
    }
}

/// Before: the equations of a model. After: the demand for the highest derivative of each function that is called, in
/// the order of the functions.
pub fn highest(model: &Model, equations: &Equations) -> Vec<Demand> {
    let mut highest: BTreeMap<usize, Demand> = BTreeMap::new();
    for demand in demands(model, equations) {
        if highest.get(&demand.function).is_none_or(|known| known.order < demand.order) {
            highest.insert(demand.function, demand);
        }
    }
    highest.into_values().collect()
}

/// Before: demands as [`highest`] has them. After: the highest of each declaration, for functions of one array are of one type.
pub fn of_declarations(model: &Model, demands: Vec<Demand>) -> Vec<Demand> {
    let mut highest: BTreeMap<usize, Demand> = BTreeMap::new();
    for demand in demands {
        let first = model.first_of_declaration(demand.function);
        if highest.get(&first).is_none_or(|known| known.order < demand.order) {
            highest.insert(first, demand);
        }
    }
    highest.into_values().collect()
}

fn contains_coordinate(equations: &Equations, value: NodeId) -> bool {
    let graph = &equations.graph;
    let mut reached = graph.reachable([value]).into_iter();
    reached.any(|id| matches!(graph.node(id), Node::Leaf(Leaf::Position(_) | Leaf::Velocity(_))))
}

/// "the value", "the second derivative".
pub(super) fn derivative(order: u8) -> String {
    const ORDINALS: [&str; 4] =
        ["the value", "the first derivative", "the second derivative", "the third derivative"];
    match ORDINALS.get(usize::from(order)) {
        Some(words) => (*words).into(),
        None => format!("the {order}th derivative"),
    }
}

/// Demands of all roots, each with the call that it comes from.
fn demands(model: &Model, equations: &Equations) -> Vec<Demand> {
    if model.functions.is_empty() {
        return Vec::new();
    }
    let mut demands = Vec::new();
    let origins = origins(model, equations);
    let mut of = |by: &str, roots: &[NodeId]| demands.extend(calls(equations, &origins, by, roots));
    let calls_any = |row: &Row| {
        let nodes = equations.graph.reachable([row.phi]).into_iter();
        nodes.map(|id| equations.graph.node(id)).any(|node| matches!(node, Node::Call { .. }))
    };
    for (row, derived) in model.rows.iter().zip(&equations.rows).filter(|(_, derived)| calls_any(derived)) {
        // The later of equals is named: γ is the most informative.
        for (part, roots) in parts(derived).into_iter().rev() {
            of(&format!("{part} of row `{}`", row.name), &roots);
        }
    }
    for (branch, root) in model.branches.iter().zip(&equations.branches) {
        of(&format!("branch `{}`", branch.name), &[*root]);
    }
    for (limit, roots) in model.limits.iter().zip(&equations.limits) {
        of(&format!("limit `{}`", limit.name), roots);
    }
    for phase in &equations.phases {
        let roots: Vec<NodeId> =
            [Some(phase.argument), Some(phase.speed), phase.acceleration].into_iter().flatten().collect();
        of("a prescribed rate", &roots);
    }
    for (output, derived) in model.outputs.iter().zip(&equations.outputs) {
        let rates = [derived.rate.flatten(), derived.acceleration.flatten()].into_iter().flatten();
        let roots: Vec<NodeId> = core::iter::once(derived.value).chain(rates).collect();
        of(&format!("output `{}`", output.name), &roots);
    }
    if let Some(dynamics) = &equations.dynamics {
        for (by, roots) in of_dynamics(dynamics) {
            of(by, &roots);
        }
    }
    for (coordinate, root) in model.coordinates.iter().zip(&equations.guesses) {
        of(&format!("the guess of `{}`", coordinate.name), &[*root]);
    }
    demands
}

/// The functions of masses and forces.
fn of_dynamics(dynamics: &Dynamics) -> [(&'static str, Vec<NodeId>); 19] {
    let some = |nodes: &[Option<NodeId>]| nodes.iter().copied().flatten().collect::<Vec<_>>();
    let entries = |matrix: &Sparse| matrix.iter().flatten().map(|(_, entry)| *entry).collect::<Vec<_>>();
    [
        ("the mass matrix M", entries(&dynamics.mass)),
        ("the product M x", some(&dynamics.mass_times)),
        ("the force vector Q", some(&dynamics.force)),
        ("the reaction Φ_qᵀ λ", some(&dynamics.reaction)),
        ("the slope ∂Q/∂q", entries(&dynamics.force_q)),
        ("the slope ∂Q/∂q̇", entries(&dynamics.force_qd)),
        ("the slope ∂Q/∂λ", entries(&dynamics.force_lambda)),
        ("the slope (M x)_q", entries(&dynamics.mass_times_q)),
        ("the slope (Φ_qᵀ λ)_q", entries(&dynamics.reaction_q)),
        ("the energy", some(&[dynamics.kinetic, dynamics.potential])),
        ("a power", some(&dynamics.powers)),
        ("the power of the time", some(&[dynamics.carried])),
        ("the rate of a state", some(&dynamics.state_rates)),
        ("a derivative by a state", dynamics.slopes.iter().flat_map(|slope| slope.roots()).collect()),
        ("an output of multipliers or states", dynamics.loads.clone()),
        ("the gap of a contact", dynamics.gaps.iter().flat_map(|gap| gap.roots()).collect()),
        ("a friction", dynamics.set_valued.iter().flat_map(SetValuedRow::roots).collect()),
        ("an event", dynamics.events.roots().collect()),
        ("the start", [some(&dynamics.start_states), some(&dynamics.start_rates)].concat()),
    ]
}

/// The derivatives of a row that are emitted.
fn parts(row: &Row) -> [(&'static str, Vec<NodeId>); 6] {
    let some = |root: Option<NodeId>| root.into_iter().collect::<Vec<_>>();
    [
        ("Φ", vec![row.phi]),
        ("Φ_q", row.phi_q.iter().map(|(_, entry)| *entry).collect()),
        ("Φ_t", some(row.phi_t)),
        ("Φ_tt", some(row.phi_tt)),
        ("Φ_qt q̇", some(row.phi_qt_qd)),
        ("γ", some(row.gamma)),
    ]
}

/// Calls that the text makes, by function and argument: order and place of each, ascending.
type Origins = BTreeMap<(u32, NodeId), Vec<(u8, Span)>>;

fn origins(model: &Model, equations: &Equations) -> Origins {
    let mut origins = Origins::new();
    for (call, node) in model.expressions.calls().iter().zip(&equations.calls) {
        if let Node::Call { function, order, argument } = equations.graph.node(*node) {
            origins.entry((function, argument)).or_default().push((order, call.span));
        }
    }
    origins.values_mut().for_each(|calls| calls.sort_by_key(|(order, _)| *order));
    origins
}

/// The calls below `roots`, each with its place in the text: a derivative comes from the call of the highest order
/// below its own at the same argument.
fn calls(equations: &Equations, origins: &Origins, by: &str, roots: &[NodeId]) -> Vec<Demand> {
    let reached = equations.graph.reachable(roots.iter().copied()).into_iter();
    let demands = reached.filter_map(|id| match equations.graph.node(id) {
        Node::Call { function, order, argument } => {
            let written = origins.get(&(function, argument))?;
            let (_, span) = written.iter().take_while(|(below, _)| *below <= order).last()?;
            Some(Demand { function: function as usize, order, by: by.to_owned(), span: *span, argument })
        }
        _ => None,
    });
    demands.collect()
}
