//! Parameters and inputs on whose way rows may come back to where they were: their change alone does not tell how far the
//! mechanism moved.

use std::collections::{BTreeMap, BTreeSet};

use super::Equations;
use crate::model::{Model, VariableKind};
use crate::symbolic::{Binary, Graph, Leaf, Node, NodeId, Unary};

/// Most values that the terms of a row are looked for in, which keeps the work linear; a row of more counts as one that may fold.
const MOST_TERMS: usize = 64;

/// Largest rate of an angle by one input (rad/rad) with which a step turns a direction in two rows by less than half a turn. An
/// angle that changes by more than 0.35 rad is never taken in one step.
const MOST_OF_DIRECTION: f64 = 8.0;

/// The same of a sine alone, which keeps its sign for half as long.
const MOST_OF_SINE: f64 = 4.0;

/// Dependence of a value on variables that move, at one position and time.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
enum Form {
    /// None.
    Free,
    /// A sum of variables times values that are free; for an angle the largest rate of it (rad/rad).
    Affine(f64),
    /// A sum of such values, and of sines and cosines of them times values that are free.
    Wave,
    /// Otherwise.
    Bent,
}

/// A value with its dependence on the time, apart from the variables.
#[derive(Clone, Copy, Debug)]
struct Value {
    form: Form,
    timed: bool,
}

impl Value {
    /// `true` for a factor that keeps the form of a product: where it passes zero with the time, a variable does not count.
    fn is_factor(self) -> bool {
        self.form == Form::Free && !self.timed
    }
}

type Values = BTreeMap<NodeId, Value>;

/// A product before a sine or cosine: its sign, and its factors, `true` for those that divide.
type Product = (bool, Vec<(bool, NodeId)>);

/// A row as a sum with sines and cosines of one angle.
#[derive(Debug, Default)]
struct Waves {
    angle: Option<NodeId>,
    cosine: Vec<Product>,
    sine: Vec<Product>,
    /// All other terms.
    rest: Vec<NodeId>,
}

/// Rows with the same coefficients of the same angle, in the same measure.
type Key = (NodeId, NodeId, Vec<Product>, Vec<Product>);

impl Waves {
    fn key(&self, scale: NodeId) -> Option<Key> {
        Some((self.angle?, scale, self.cosine.clone(), self.sine.clone()))
    }

    /// Keys of a row whose coefficients are these, a quarter of a turn on or back: both rows together are a direction.
    fn partners(&self, scale: NodeId) -> Option<[Key; 2]> {
        let angle = self.angle?;
        let on = (angle, scale, self.sine.clone(), opposite(&self.cosine));
        Some([on, (angle, scale, opposite(&self.sine), self.cosine.clone())])
    }
}

fn opposite(products: &[Product]) -> Vec<Product> {
    let mut all: Vec<Product> =
        products.iter().map(|(negative, factors)| (!negative, factors.clone())).collect();
    all.sort();
    all
}

/// Before: the equations of a model. After: the indices of parameters and inputs whose change may lead rows away and back,
/// ascending. All others lead every row straight on at any position, alone or together:
///
/// - linearly, times values of the position;
/// - as a direction, by sine and cosine of one angle with the same coefficients in two rows; a change of that angle by less than half a
///   turn always gives another direction;
/// - in a row of sine and cosine of one angle alone, which vanishes once in half a turn.
pub fn folding(model: &Model, equations: &Equations) -> Vec<usize> {
    let graph = &equations.graph;
    let rows: Vec<NodeId> = equations.rows.iter().map(|row| row.phi).collect();
    let nodes = graph.reachable(rows.iter().copied());
    let angles: BTreeSet<usize> = model.angles().collect();
    let by_all = values(graph, &nodes, |leaf| matches!(leaf, Leaf::Parameter(_) | Leaf::Input(_)), &angles);
    let by_inputs = values(graph, &nodes, |leaf| matches!(leaf, Leaf::Input(_)), &angles);
    let straight = |values: &Values, row: NodeId| form(values, row) < Form::Wave;
    // Roots whose parameters may fold, and those whose inputs may.
    let (mut held, mut free) = (Vec::new(), Vec::new());
    let mut waves = Vec::new();
    for (row, scale) in rows.iter().zip(&equations.row_scales) {
        if straight(&by_all, *row) {
            continue;
        }
        held.push(*row);
        if !straight(&by_inputs, *row) {
            match terms(graph, &by_inputs, *row) {
                Some(found) => waves.push((*row, *scale, found)),
                None => free.push(*row),
            }
        }
    }
    let keys: BTreeSet<Key> = waves.iter().filter_map(|(_, scale, waves)| waves.key(*scale)).collect();
    for (row, scale, waves) in &waves {
        let rate = waves.angle.map_or(f64::INFINITY, |angle| rate(form(&by_inputs, angle)));
        let partners = waves.partners(*scale);
        let is_direction = partners.is_some_and(|partners| partners.iter().any(|key| keys.contains(key)));
        if waves.rest.is_empty() && rate <= MOST_OF_SINE {
            continue;
        }
        match is_direction && rate <= MOST_OF_DIRECTION {
            true => free.extend(&waves.rest),
            false => free.push(*row),
        }
    }
    let parameters = leaves(graph, held, |leaf| matches!(leaf, Leaf::Parameter(_)));
    let inputs = leaves(graph, free, |leaf| matches!(leaf, Leaf::Input(_)));
    let all: BTreeSet<usize> = parameters.into_iter().chain(inputs).collect();
    let is_set = |index: &usize| {
        model.variables.get(*index).is_some_and(|variable| variable.kind != VariableKind::InputRate)
    };
    all.into_iter().filter(is_set).collect()
}

/// Indices of those variables below `roots` that are `wanted`.
fn leaves(graph: &Graph, roots: Vec<NodeId>, wanted: impl Fn(Leaf) -> bool) -> Vec<usize> {
    let index = |id| match graph.node(id) {
        Node::Leaf(leaf @ (Leaf::Parameter(index) | Leaf::Input(index))) if wanted(leaf) => {
            Some(index as usize)
        }
        _ => None,
    };
    graph.reachable(roots).into_iter().filter_map(index).collect()
}

fn form(values: &Values, id: NodeId) -> Form {
    values.get(&id).map_or(Form::Bent, |value| value.form)
}

/// Largest rate of an angle.
fn rate(form: Form) -> f64 {
    match form {
        Form::Free => 0.0,
        Form::Affine(rate) => rate,
        Form::Wave | Form::Bent => f64::INFINITY,
    }
}

/// Dependence of all `nodes` on variables that are `moving`; those among `angles` are angles.
fn values(
    graph: &Graph,
    nodes: &[NodeId],
    moving: impl Fn(Leaf) -> bool,
    angles: &BTreeSet<usize>,
) -> Values {
    let mut values = Values::new();
    for id in nodes {
        let value = of_node(graph, graph.node(*id), &values, &moving, angles);
        values.insert(*id, value);
    }
    values
}

fn of_node(
    graph: &Graph,
    node: Node,
    known: &Values,
    moving: &impl Fn(Leaf) -> bool,
    angles: &BTreeSet<usize>,
) -> Value {
    let of = |id: NodeId| known.get(&id).copied().unwrap_or(Value { form: Form::Bent, timed: true });
    let mut operands = Vec::new();
    node.operands_onto(&mut operands);
    let timed = node == Node::Leaf(Leaf::Time) || operands.iter().any(|operand| of(*operand).timed);
    let is_free = operands.iter().all(|operand| of(*operand).form == Form::Free);
    let product = |a: NodeId, size: f64| match of(a).form {
        Form::Affine(rate) => Form::Affine(rate * size),
        other => other,
    };
    let size = |id: NodeId| graph.constant_value(id).map_or(f64::INFINITY, f64::abs);
    let form = match node {
        Node::Leaf(leaf @ (Leaf::Parameter(index) | Leaf::Input(index))) if moving(leaf) => {
            Form::Affine(if angles.contains(&(index as usize)) { 1.0 } else { f64::INFINITY })
        }
        _ if is_free => Form::Free,
        Node::Unary(Unary::Negate, a) => of(a).form,
        Node::Unary(Unary::Sin | Unary::Cos, a) if of(a).form < Form::Wave => Form::Wave,
        Node::Binary(Binary::Add | Binary::Subtract, a, b) => match (of(a).form, of(b).form) {
            (a, b) if a < Form::Wave && b < Form::Wave => Form::Affine(rate(a) + rate(b)),
            (a, b) if a == Form::Bent || b == Form::Bent => Form::Bent,
            _ => Form::Wave,
        },
        Node::Binary(Binary::Multiply, a, b) if of(b).is_factor() => product(a, size(b)),
        Node::Binary(Binary::Multiply, a, b) if of(a).is_factor() => product(b, size(a)),
        Node::Binary(Binary::Divide, a, b) if of(b).is_factor() => product(a, 1.0 / size(b)),
        _ => Form::Bent,
    };
    Value { form, timed }
}

/// The terms of a row; `None` where it has too many, several angles, or is no such sum.
fn terms(graph: &Graph, values: &Values, row: NodeId) -> Option<Waves> {
    let mut found = Waves::default();
    let mut waiting = vec![(row, false, Vec::new())];
    let mut seen = 0_usize;
    while let Some((id, negative, mut factors)) = waiting.pop() {
        seen = seen.saturating_add(1);
        if seen > MOST_TERMS {
            return None;
        }
        let is_factor = |id: NodeId| values.get(&id).is_some_and(|value| value.is_factor());
        match (form(values, id), graph.node(id)) {
            (Form::Free | Form::Affine(_), _) => found.rest.push(id),
            (Form::Bent, _) => return None,
            (_, Node::Unary(Unary::Negate, a)) => waiting.push((a, !negative, factors)),
            (_, Node::Binary(Binary::Add, a, b)) => {
                waiting.extend([(a, negative, factors.clone()), (b, negative, factors)]);
            }
            (_, Node::Binary(Binary::Subtract, a, b)) => {
                waiting.extend([(a, negative, factors.clone()), (b, !negative, factors)]);
            }
            (_, Node::Binary(Binary::Multiply, a, b)) => {
                let (factor, rest) = if is_factor(a) { (a, b) } else { (b, a) };
                factors.push((false, factor));
                waiting.push((rest, negative, factors));
            }
            (_, Node::Binary(Binary::Divide, a, b)) => {
                factors.push((true, b));
                waiting.push((a, negative, factors));
            }
            (_, Node::Unary(function, angle)) if found.angle.is_none_or(|other| other == angle) => {
                found.angle = Some(angle);
                factors.sort();
                let list = if function == Unary::Sin { &mut found.sine } else { &mut found.cosine };
                list.push((negative, factors));
            }
            _ => return None,
        }
    }
    found.sine.sort();
    found.cosine.sort();
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::folding;
    use crate::diagnostics::Diagnostics;
    use crate::equations::derive;
    use crate::model::scenes::read_source;

    /// Names of the parameters and inputs that may fold.
    fn found(rows: &str) -> String {
        let mut faults = Diagnostics::default();
        let text = format!(
            "mechanism Text; param r: m = 0.1; param b: m = 0.3; param alpha: rad = 0.3;
             input theta: rad, rates; input beta: rad, rates; input s: m, rates; input angle: 1, rates;
             coord x: m = 0.1; coord y: m = 0.1; coord z: m = 0.1; coord phi: rad = 0.1; {rows}"
        );
        let (_, scenes) = read_source(&text, &mut faults).expect("a text that can be read");
        let scene = scenes.find(None).expect("the whole text");
        assert!(faults.is_empty() && scene.faults.is_empty(), "{}{text}", faults.to_text());
        let indices = folding(&scene.model, &derive(&scene.model));
        let names = indices.iter().map(|index| scene.model.variables[*index].name.as_str());
        names.collect::<Vec<&str>>().join(" ")
    }

    #[test]
    fn variables_that_enter_linearly_or_as_directions_do_not_fold() {
        for (rows, expected) in [
            ("drive crank: phi == theta;", ""),
            ("drive slider: x == 2*s - r;", ""),
            ("constraint bar { norm([x, y]) == r; }", ""),
            ("constraint wedge { x*s == y*b; }", ""),
            ("constraint crank { [x, y] == 0.1m*unit(theta); }", ""),
            ("constraint crank { [x, y] == r*unit(theta); }", "r"),
            ("constraint crank { [x, y] == r/3*unit(theta - phi) + [z, 0]; }", "r"),
            ("constraint crank { [x, y] == rot(2*theta)*[r, b]; }", "r b"),
            ("constraint crank { [x, y] == z*unit(theta + beta); }", ""),
            ("constraint crank { [x, y] == 0.1m*unit(theta + 3*t/1s) + [0.1m*sin(t/1s), 0]; }", ""),
            ("constraint crank { cross(unit(theta), [x, y]) == 0; }", ""),
            ("constraint encoder { sin(phi - theta) == 0; }", ""),
            ("constraint encoder { sin(phi - alpha - theta) == 0; }", "alpha"),
            ("constraint free { x^2 + y^2 == r^2; }", "r"),
        ] {
            assert_eq!(found(rows), expected, "{rows}");
        }
    }

    #[test]
    fn strokes_of_inputs_and_parameters_may_fold() {
        for (rows, expected) in [
            ("drive slider: x == r*cos(theta);", "r theta"),
            ("drive slider: x == 0.1m*cos(alpha);", "alpha"),
            ("drive slider: x == r*cos(theta) + b*sin(theta);", "r b theta"),
            ("drive slider: x == r*cos(theta) + sqrt(b^2 - (r*sin(theta))^2);", "r b theta"),
            ("drive slider: x == s^2/1m;", "s"),
            ("drive slider: x == r*s/1m;", "r"),
            ("drive slider: x == s*(theta - beta);", "theta beta s"),
            ("function law: m(rad), C2; drive slider: x == law(theta);", "theta"),
            ("drive slider: x == sin(theta)*s;", "theta s"),
            ("drive slider: x == sin(t/1s)*s;", "s"),
            ("drive crank: phi == sin(theta); drive other: x == 0.1m*cos(2*theta);", "theta"),
        ] {
            assert_eq!(found(rows), expected, "{rows}");
        }
    }

    #[test]
    fn inputs_together_with_coordinates_may_fold() {
        for (rows, expected) in [
            ("constraint lean { norm([s, 0] - [x, y]) == 2m; x == 0; }", "s"),
            ("constraint trammel { norm([s, 0] - [0, y]) == 2m; }", "s"),
            ("constraint plumb { y == 3m - norm([s, 1m] - [x, z]); }", "s"),
            ("constraint shadow { z == 1.5m + dot([x, y], unit(theta)); }", "theta"),
            ("constraint coupler { norm([x, y] - 0.1m*unit(theta)) == b; }", "b theta"),
            (
                "let k = r*cos(theta); constraint bars { norm([x, y]) == r; norm([x, y] - [k, 0]) == b; }",
                "r b theta",
            ),
        ] {
            assert_eq!(found(rows), expected, "{rows}");
        }
    }

    #[test]
    fn sines_and_cosines_in_two_rows_that_are_no_direction_may_fold() {
        for (rows, expected) in [
            ("constraint cams { z == 1 [um]*sin(theta); x == 0.5m*cos(theta); }", "theta"),
            ("constraint cams { z == 0*sin(theta) + y; x == 0.5m*cos(theta); }", "theta"),
            ("constraint cams { [x, y] == [r*cos(theta), b*sin(theta)]; }", "r b theta"),
            (
                "let k = 0.3m*cos(theta + 1) + 0.4m*sin(theta + 1); drive a: x == k; drive b: y == 2*k;",
                "theta",
            ),
            ("let k = 0.3m*cos(theta) + 0.4m*sin(theta); constraint two { [x, y] == [k, k]; }", "theta"),
            // An elbow, and a slide that makes up for the crank.
            ("constraint arm { [x, y] == 1m*unit(theta) + 1m*unit(beta); }", "theta beta"),
            ("constraint crank { [x, y] == 0.1m*unit(theta) + [s, 0]; }", "s"),
            ("constraint wheel { [x, y] == 0.1m*unit(theta) + [0.1m*theta, 0]; }", "theta"),
            // Angles that come round again.
            ("constraint gear { [x, y] == 0.1m*unit(20*theta); }", "theta"),
            ("constraint rack { [x, y] == 0.1m*unit(s/1mm); }", "s"),
            ("constraint dial { [x, y] == 0.1m*unit(angle); }", "angle"),
            ("constraint encoder { sin(7*phi - 7*theta) == 0; }", "theta"),
        ] {
            assert_eq!(found(rows), expected, "{rows}");
        }
    }
}
