//! Inputs on whose way a mechanism may go and come back: their change alone does not tell how far it moved.

use std::collections::{BTreeMap, BTreeSet};

use super::Equations;
use crate::symbolic::{Binary, Graph, Leaf, Node, NodeId, Unary};

/// Most values that the terms of a row are looked for in, which keeps the work linear; a row of more counts as one that may fold.
const MOST_TERMS: usize = 64;

/// Dependence of a value on inputs and coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Form {
    /// On neither.
    Free,
    /// On coordinates alone.
    Coordinates,
    /// On inputs alone, linearly.
    Straight,
    /// A sum of such values and of sines and cosines of them.
    Wave,
    /// On inputs alone, otherwise.
    Bent,
    /// On both.
    Mixed,
}

/// Before: the equations of a model. After: `true` unless every input enters the rows linearly, together with coordinates, or
/// as a direction: by sine and cosine of one angle in two rows, or times coordinates. A direction is another one after any
/// change by less than half a turn. A stroke r cos θ comes back to where it was.
pub fn may_fold(equations: &Equations) -> bool {
    let graph = &equations.graph;
    let rows = equations.rows.iter().map(|row| row.phi);
    let mut forms = BTreeMap::new();
    let mut waves = BTreeSet::new();
    for id in graph.reachable(rows.clone()) {
        let node = graph.node(id);
        let form = of_node(node, &forms);
        match (node, form) {
            (_, Form::Bent) => return true,
            (Node::Unary(function @ (Unary::Sin | Unary::Cos), angle), Form::Wave) => {
                waves.insert((function, angle));
            }
            _ => {}
        }
        forms.insert(id, form);
    }
    let is_alone = |(function, angle): &(Unary, NodeId)| !waves.contains(&(other(*function), *angle));
    waves.iter().any(is_alone) || adds_up(graph, &forms, rows)
}

fn other(function: Unary) -> Unary {
    if function == Unary::Sin { Unary::Cos } else { Unary::Sin }
}

fn form(forms: &BTreeMap<NodeId, Form>, id: NodeId) -> Form {
    forms.get(&id).copied().unwrap_or(Form::Bent)
}

fn of_node(node: Node, known: &BTreeMap<NodeId, Form>) -> Form {
    let mut operands = Vec::new();
    node.operands_onto(&mut operands);
    let forms: Vec<Form> = operands.iter().map(|operand| form(known, *operand)).collect();
    let on_coordinates = forms.iter().any(|form| matches!(form, Form::Coordinates | Form::Mixed));
    let on_inputs = forms.iter().any(|form| *form > Form::Coordinates);
    let largest = forms.iter().max().copied().unwrap_or(Form::Free);
    match (node, forms.as_slice()) {
        (Node::Leaf(Leaf::Position(_)), _) => Form::Coordinates,
        (Node::Leaf(Leaf::Input(_)), _) => Form::Straight,
        _ if !on_inputs => largest,
        _ if on_coordinates => Form::Mixed,
        (Node::Unary(Unary::Negate, _) | Node::Binary(Binary::Add | Binary::Subtract, ..), _)
        | (Node::Binary(Binary::Multiply, ..), [Form::Free, _] | [_, Form::Free])
        | (Node::Binary(Binary::Divide, ..), [_, Form::Free]) => largest,
        (Node::Unary(Unary::Sin | Unary::Cos, _), [Form::Straight]) => Form::Wave,
        _ => Form::Bent,
    }
}

/// `true` if sine and cosine of one angle are terms of one row and of no other: their sum is a sine, and comes back as that does.
fn adds_up(graph: &Graph, forms: &BTreeMap<NodeId, Form>, rows: impl Iterator<Item = NodeId>) -> bool {
    // Rows that have an angle, and one of them that has both of its functions.
    let mut angles: BTreeMap<NodeId, (usize, bool)> = BTreeMap::new();
    for row in rows {
        let Some(waves) = added(graph, forms, row) else { return true };
        for (function, angle) in &waves {
            let both = waves.contains(&(other(*function), *angle));
            if *function == Unary::Sin || !both {
                let (count, adds) = angles.entry(*angle).or_default();
                (*count, *adds) = (*count + 1, *adds || both);
            }
        }
    }
    angles.values().any(|(count, adds)| *adds && *count == 1)
}

/// Sines and cosines that are terms of a row; `None` where it has too many terms.
fn added(graph: &Graph, forms: &BTreeMap<NodeId, Form>, row: NodeId) -> Option<BTreeSet<(Unary, NodeId)>> {
    let (mut terms, mut seen, mut waves) = (vec![row], BTreeSet::new(), BTreeSet::new());
    while let Some(id) = terms.pop() {
        let form = form(forms, id);
        if form < Form::Wave || !seen.insert(id) {
            continue;
        }
        if seen.len() > MOST_TERMS {
            return None;
        }
        match graph.node(id) {
            Node::Unary(Unary::Negate, a) => terms.push(a),
            Node::Binary(Binary::Add | Binary::Subtract, a, b) => terms.extend([a, b]),
            Node::Binary(Binary::Multiply | Binary::Divide, a, b) if form == Form::Wave => {
                terms.extend([a, b]);
            }
            Node::Unary(function @ (Unary::Sin | Unary::Cos), angle) if form == Form::Wave => {
                waves.insert((function, angle));
            }
            _ => {}
        }
    }
    Some(waves)
}

#[cfg(test)]
mod tests {
    use super::may_fold;
    use crate::diagnostics::Diagnostics;
    use crate::equations::derive;
    use crate::model::scenes::read_source;

    fn folds(rows: &str) -> bool {
        let mut faults = Diagnostics::default();
        let text = format!(
            "mechanism Text; param r: m = 0.1; param b: m = 0.3; input theta: rad, rates; input s: m, rates;
             coord x: m = 0.1; coord y: m = 0.1; coord phi: rad = 0.1; {rows}"
        );
        let (_, scenes) = read_source(&text, &mut faults).expect("a text that can be read");
        let scene = scenes.find(None).expect("the whole text");
        assert!(faults.is_empty() && scene.faults.is_empty(), "{}{text}", faults.to_text());
        may_fold(&derive(&scene.model))
    }

    #[test]
    fn inputs_that_enter_as_they_are_or_as_directions_do_not_fold() {
        for rows in [
            "drive crank: phi == theta;",
            "drive slider: x == 2*s - r;",
            "constraint crank { [x, y] == r*unit(theta) + [s, 0]; }",
            "constraint crank { [x, y] == rot(2*theta)*[r, b]; }",
            "constraint crank { cross(unit(theta), [x, y]) == 0; }",
            "constraint coupler { norm([x, y] - r*unit(theta)) == b; }",
            "constraint encoder { sin(phi - theta) == 0; }",
            "constraint free { x^2 + y^2 == r^2; }",
        ] {
            assert!(!folds(rows), "{rows}");
        }
    }

    #[test]
    fn strokes_of_inputs_may_fold() {
        for rows in [
            "drive slider: x == r*cos(theta);",
            "drive slider: x == r*cos(theta) + b*sin(theta);",
            "drive slider: x == r*cos(theta) + sqrt(b^2 - (r*sin(theta))^2);",
            "drive slider: x == s^2/1m;",
            "function law: m(rad), C2; drive slider: x == law(theta);",
            "drive slider: x == sin(theta)*s;",
            "let k = r*cos(theta); constraint bars { norm([x, y]) == r; norm([x, y] - [k, 0]) == b; }",
            "drive crank: phi == sin(theta); drive other: x == r*cos(2*theta);",
        ] {
            assert!(folds(rows), "{rows}");
        }
    }
}
