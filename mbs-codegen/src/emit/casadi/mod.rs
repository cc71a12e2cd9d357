//! The second back end: a mechanism as a CasADi definition, from the model, independent of the symbolic derivatives.

pub(crate) mod dynamics;
pub(crate) mod pins;

use std::fmt::Write;

use crate::equations::Attribution;
use crate::model::expression::{Id, Node};
use crate::model::{Model, VariableKind};
use crate::symbolic::Unary;

/// Before: a model without faults. After: a Python module that defines Φ and the outputs for CasADi to
/// differentiate.
///
/// `define(ca, q, v, t, der)` returns the rows, and the outputs with the number of their time derivatives. `v` are the
/// parameters and inputs in the order of `VARIABLES`, `der` is the total time derivative. Each declared function is
/// replaced by its [`stand_in`]. A back end adds two functions to CasADi's. `ca.gain(e, rows, row, sign)` is ∂e/∂drive:
/// the drive's row, of all the rows, rises by `sign`, and the coordinates follow it.
/// `ca.pins(bodies, gravity, joints, acting, held, length, der)` are the forces of joints by least squares of Newton's
/// and Euler's sums. Margins depend on the runtime's own measure: an output with one has −1 derivatives.
pub fn definition(model: &Model, attribution: Option<&Attribution>, name: &str) -> String {
    let rates: Vec<String> = model
        .variables
        .iter()
        .enumerate()
        .filter(|(_, variable)| variable.kind == VariableKind::InputWithRates)
        .map(|(index, _)| format!("({index}, {}, {})", index + 1, index + 2))
        .collect();
    let mut text = String::new();
    let _ = writeln!(
        text,
        "\"\"\"{name}: constraints and outputs, written from the text of the mechanism.\"\"\"\n"
    );
    let (n, m, v) = (model.coordinates.len(), model.rows.len(), model.variables.len());
    let _ = writeln!(text, "NAME = \"{name}\"\nN = {n}\nM = {m}\nV = {v}");
    let _ = writeln!(text, "RATES = [{}]", rates.join(", "));
    laws(model.functions.len(), &mut text);
    let _ = writeln!(text, "\n\ndef define(ca, q, v, t, der):");
    let roots =
        model.rows.iter().map(|row| row.residual).chain(model.outputs.iter().map(|output| output.value));
    assignments(model, roots, &mut text);
    let rows: Vec<String> = model.rows.iter().map(|row| variable(row.residual)).collect();
    let outputs: Vec<String> = model
        .outputs
        .iter()
        .map(|output| match has_margin(model, output.value) {
            true => format!("({}, -1)", variable(output.value)),
            false => format!("({}, {})", variable(output.value), derivatives(model, output.value)),
        })
        .collect();
    let _ = writeln!(text, "    return [{}], [{}]", rows.join(", "), outputs.join(", "));
    if let Some(dynamics) = &model.dynamics {
        dynamics::definition(model, dynamics, attribution, &mut text);
    }
    text
}

/// Substitute for the declared function of this index where values are required: `Σ a sin(w x + p)`, a row
/// `[a, w, p]` a term. Functions of neighbouring indices differ, so that none can be taken for another.
pub fn stand_in(function: usize) -> [[f64; 3]; 3] {
    let index = (function % 16) as f64;
    [
        [0.75, 1.0 + 0.125 * index, 0.3 + 0.45 * index],
        [-0.5, 2.0 + 0.125 * index, 1.1 - 0.35 * index],
        [0.25, 3.0 - 0.125 * index, 1.9 + 0.25 * index],
    ]
}

/// The substitutes as a table, and the function that evaluates them: by formula as far as the text itself writes
/// derivatives; the reader of the definition derives any higher ones.
fn laws(count: usize, text: &mut String) {
    if count == 0 {
        return;
    }
    text.push_str("LAWS = [\n");
    for function in 0..count {
        let terms = stand_in(function).map(|[a, w, p]| format!("({a:?}, {w:?}, {p:?})"));
        let _ = writeln!(text, "    [{}],", terms.join(", "));
    }
    text.push_str(
        "]\n\n\n\
         def law(ca, function, order, x):\n    \
             \"\"\"The derivative of this order of the sum of a sin(w x + p).\"\"\"\n    \
             terms = []\n    \
             for a, w, p in LAWS[function]:\n        \
                 angle = ca.SX(w) * x + ca.SX(p)\n        \
                 value = ca.sin(angle) if order % 2 == 0 else ca.cos(angle)\n        \
                 terms.append(ca.SX((a if order % 4 < 2 else -a) * w**order) * value)\n    \
             return terms[0] + terms[1] + terms[2]\n",
    );
}

/// Assigns the roots and all their operands, operands first.
pub fn assignments(model: &Model, roots: impl IntoIterator<Item = Id>, text: &mut String) {
    let needed = model.expressions.reachable(roots);
    let mut solver = false;
    for (id, node) in model.expressions.iter() {
        if needed.get(id.index()) == Some(&true) {
            if matches!(node, Node::Ratio(..)) && !std::mem::replace(&mut solver, true) {
                let rows: Vec<String> = model.rows.iter().map(|row| variable(row.residual)).collect();
                let _ = writeln!(text, "    rows = [{}]", rows.join(", "));
            }
            let _ = writeln!(text, "    {} = {}", variable(id), operation(model, node));
        }
    }
}

/// The name of an expression.
pub fn variable(id: Id) -> String {
    format!("e{}", id.index())
}

/// A value, or 0 where none is given.
pub fn or_zero(value: Option<Id>) -> String {
    value.map_or_else(|| "ca.SX(0)".into(), variable)
}

/// `true` if an output contains a margin, so that no oracle has its value.
fn has_margin(model: &Model, value: Id) -> bool {
    let marked = model.expressions.reachable([value]);
    let margin =
        |(id, node): (Id, Node)| matches!(node, Node::Margin(_)) && marked.get(id.index()) == Some(&true);
    model.expressions.iter().any(margin)
}

/// Number of time derivatives that the definition of an output admits.
fn derivatives(model: &Model, value: Id) -> u8 {
    // Differentiations above each expression, found from the root downwards.
    let mut above: Vec<Option<u8>> = vec![None; value.index() + 1];
    if let Some(root) = above.last_mut() {
        *root = Some(0);
    }
    let mut most = 0;
    let moving = moving(model);
    let nodes: Vec<(Id, Node)> = model.expressions.iter().take(value.index() + 1).collect();
    for (id, node) in nodes.into_iter().rev() {
        let Some(order) = above.get(id.index()).copied().flatten() else { continue };
        let (below, own) = match node {
            Node::Rate(_, more) => (order + more, 0),
            // Known at a position alone.
            Node::Margin(_) | Node::Ratio(..) => (order + 2, 2),
            Node::Variable(index) => (
                order,
                match model.variables.get(index).map(|variable| variable.kind) {
                    Some(VariableKind::Input) => 2,
                    Some(VariableKind::InputWithRates) | Some(VariableKind::Parameter) => 0,
                    Some(VariableKind::InputRate) | None => 2,
                },
            ),
            _ => (order, 0),
        };
        let varies = !matches!(node, Node::Number(_))
            && !matches!(node, Node::Variable(i) if model.variables.get(i).is_some_and(|v| v.kind == VariableKind::Parameter));
        if varies && node.operands().next().is_none() && node != Node::Time {
            most = most.max(order + own);
        }
        if let Node::Call { function, order: own, .. } = node
            && moving.get(id.index()) == Some(&true)
        {
            let continuity = model.functions.get(function).map_or(0, |function| function.continuity);
            most = most.max((order + own + 2).saturating_sub(continuity));
        }
        for operand in node.operands() {
            if let Some(slot) = above.get_mut(operand.index()) {
                *slot = Some(slot.unwrap_or(0).max(below));
            }
        }
    }
    2_u8.saturating_sub(most)
}

/// `true` for each expression that may change in time.
fn moving(model: &Model) -> Vec<bool> {
    let mut moving: Vec<bool> = Vec::with_capacity(model.expressions.len());
    for (_, node) in model.expressions.iter() {
        let constant = |index: usize| {
            model.variables.get(index).is_some_and(|variable| variable.kind == VariableKind::Parameter)
        };
        moving.push(match node {
            Node::Number(_) => false,
            Node::Time | Node::Coordinate(_) => true,
            Node::Variable(index) => !constant(index),
            _ => node.operands().any(|operand| moving.get(operand.index()) == Some(&true)),
        });
    }
    moving
}

/// The sign of a drive's row along which the drive rises.
fn sign(model: &Model, row: usize) -> i8 {
    if model.rows.get(row).is_some_and(|row| row.reversed) { -1 } else { 1 }
}

fn operation(model: &Model, node: Node) -> String {
    let v = variable;
    match node {
        // A number of the back end's own kind: one with more digits than Python's must not round what follows.
        Node::Number(value) => format!("ca.SX({value:?})"),
        Node::Time => "t".into(),
        Node::Coordinate(index) => format!("q[{index}]"),
        Node::Variable(index) => format!("v[{index}]"),
        Node::State(index) => format!("z[{index}]"),
        Node::Multiplier(index) => format!("l[{index}]"),
        // The law of sliding forwards; the mode is the program's alone.
        Node::Sliding(_) => "ca.SX(1)".into(),
        Node::Holding(_) => "ca.SX(0)".into(),
        // Before any impact.
        Node::Impulse(_) => "ca.SX(0)".into(),
        // Every event holds, and every latched value is 1 in SI units.
        Node::Remembered(_) => "ca.SX(1)".into(),
        Node::Pin(pin, component) => format!("pins[{}]", 2 * pin + component),
        Node::Rate(a, 1) => format!("der({})", v(a)),
        Node::Rate(a, _) => format!("der(der({}))", v(a)),
        // No oracle can evaluate it; values that depend on it are not compared.
        Node::Margin(_) => "ca.SX(float(\"nan\"))".into(),
        Node::Ratio(a, row) => format!("ca.gain({}, rows, {row}, {})", v(a), sign(model, row)),
        Node::Unary(Unary::Negate, a) => format!("-{}", v(a)),
        Node::Unary(function, a) => format!("ca.{}({})", function.entry().casadi, v(a)),
        Node::Call { function, order, argument } => {
            format!("law(ca, {function}, {order}, {})", v(argument))
        }
        Node::Binary(function, a, b) => function.entry().casadi.of("ca.", &v(a), &v(b)),
    }
}
