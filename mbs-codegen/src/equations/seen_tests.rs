//! Forces by their names against the same laws typed by hand, and against the generalized forces and powers that they give.

use super::{Equations, derive};
use crate::diagnostics::Diagnostics;
use crate::model::Model;
use crate::model::scenes::read_source;
use crate::symbolic::evaluate::evaluate;
use crate::symbolic::sample_points::scattered;
use crate::symbolic::{Graph, Leaf, NodeId};

/// Roundings of two forms of one law.
const EQUAL: f64 = 1e-13;

const TEXT: &str = "mechanism Seen;
    param k: N/m = 300; param rest: m = 0.4; param c: N*s/m = 7; param mu: 1 = 0.3; param v0: m/s = 0.2;
    input wind: N, rates;
    coord x: m = 0.3; coord y: m = 0.2; coord phi: rad = 0.1; coord p: [m; 2] = [0.5, 0.1];
    body cart { mass: 2kg, com: [x, y] }
    body flap { mass: 1kg, com: p, inertia: 0.1, angle: phi }
    friction rub { along: x - 1 [m/s]*t, normal: press, coefficient: mu, speed: v0, viscous: c }
    let press = normal(floor);
    tsda spring { from: [0, 1m], to: [x, y], stiffness: k, length: rest, damping: c, actuator: wind }
    tsda rope { from: [x, y], to: p, stiffness: k }
    rsda hinge { angle: phi, stiffness: 4, rest: 0.2, damping: 0.1, torque: 3 }
    contact floor { gap: y - 0.5m, stiffness: 900, exponent: 1.5, depth: 1mm, damping: 0.4 }
    force push: [wind, 2*force(spring)] on p;
    torque motor: 0.3m*force(rub) on phi;
    for i in 0..3 { contact stops { gap: p[0] - (0.1 + 0.3*i)*1m, stiffness: 100*(i + 1) } friction drags { along: p[1], normal: force(stops[i]), coefficient: mu, speed: v0 } }
    let l = hypot(x, y - 1m);
    let tension = k*(l - rest) + c*der(l) + wind;
    let pressing = 900 [N/m]*1mm*(max(0.5m - y, 0)/1mm)^1.5*max(1 - 0.4 [s/m]*der(y), 0);
    let slipping = der(x) - 1 [m/s];
    let rubbing = -(mu*abs(pressing)*tanh(slipping/v0) + c*slipping);
    let d = p - [x, y];
";

/// Pairs of a name and its law.
const PAIRS: [(&str, &str, &str); 17] = [
    ("N", "force(spring)", "tension"),
    ("W", "power(spring)", "-tension*der(l)"),
    ("N", "force(rope)", "k*norm(d)"),
    ("W", "power(rope)", "-k*dot(d, der(d))"),
    ("N*m", "force(hinge)", "4 [N*m]*(phi - 0.2rad) + 0.1 [N*m*s]*der(phi) + 3 [N*m]"),
    ("W", "power(hinge)", "-(4 [N*m]*(phi - 0.2rad) + 0.1 [N*m*s]*der(phi) + 3 [N*m])*der(phi)"),
    ("N", "force(floor)", "pressing"),
    ("N", "normal(floor)", "pressing"),
    ("m", "gap(floor)", "y - 0.5m"),
    ("W", "power(floor)", "pressing*der(y)"),
    ("N", "force(rub)", "rubbing"),
    ("m/s", "slip(rub)", "slipping"),
    ("W", "power(rub)", "rubbing*slipping"),
    ("W", "power(push)", "wind*der(p[0]) + 2*tension*der(p[1])"),
    ("N*m", "force(motor)", "0.3m*rubbing"),
    ("N", "force(push)[1]", "2*tension"),
    ("N", "force(stops[1])", "200 [N/m]*max(0.4m - p[0], 0)"),
];

pub(super) fn derived(text: &str) -> (Model, Equations) {
    let mut diagnostics = Diagnostics::default();
    let read = read_source(text, &mut diagnostics);
    assert!(diagnostics.is_empty(), "{}", diagnostics.to_text());
    let (_, scenes) = read.expect("a text");
    let scene = scenes.scenes.into_iter().next().expect("a scene");
    let equations = derive(&scene.model);
    (scene.model, equations)
}

fn value(graph: &Graph, node: Option<NodeId>, trial: usize) -> f64 {
    let leaf = |leaf: Leaf| 2.0 * scattered(leaf, trial) - 0.7;
    node.map_or(0.0, |node| evaluate(graph, &[node], leaf).pop().unwrap_or(f64::NAN))
}

/// Value of one node.
pub(super) fn value_at(graph: &Graph, node: NodeId, leaf: impl Fn(Leaf) -> f64) -> f64 {
    evaluate(graph, &[node], leaf).pop().unwrap_or(f64::NAN)
}

fn assert_near(found: f64, wanted: f64, of: &str) {
    assert!((found - wanted).abs() <= EQUAL * (1.0 + wanted.abs()), "{of}: {found} and {wanted}");
}

#[test]
fn a_force_by_name_is_its_law() {
    let mut text = TEXT.to_owned();
    for (index, (unit, name, law)) in PAIRS.iter().enumerate() {
        text += &format!("out seen{index}: {unit} = {name}; out law{index}: {unit} = {law};\n");
    }
    let (_, equations) = derived(&text);
    let graph = &equations.graph;
    assert_eq!(equations.outputs.len(), 2 * PAIRS.len());
    let (mut closed, mut moving) = (0, 0);
    for ((_, name, _), pair) in PAIRS.iter().zip(equations.outputs.chunks(2)) {
        let [seen, law] = pair else { panic!("a pair") };
        assert_eq!(seen.rate.is_some(), law.rate.is_some(), "{name}");
        for trial in 0..6 {
            let wanted = value(graph, Some(law.value), trial);
            closed += usize::from(*name == "force(floor)" && wanted > 0.0);
            assert_near(value(graph, Some(seen.value), trial), wanted, name);
            let rates = [seen, law].map(|output| output.rate.flatten());
            let [rate, wanted] = rates.map(|rate| value(graph, rate, trial));
            moving += usize::from(wanted != 0.0);
            assert_near(rate, wanted, name);
        }
    }
    assert!(closed > 0 && closed < 6, "the contact is {closed} times closed");
    assert!(moving > 40, "{moving} rates");
}

#[test]
fn a_force_that_others_use_is_that_of_the_law_typed_by_hand() {
    let typed = TEXT.replace("let press = normal(floor);", "let press = pressing;");
    let typed = typed.replace("force(spring)", "tension").replace("force(rub)", "rubbing");
    let typed = typed.replace("force(stops[i])", "100 [N/m]*(i + 1)*max((0.1 + 0.3*i)*1m - p[0], 0)");
    let ((_, seen), (_, typed)) = (derived(TEXT), derived(&typed));
    let (found, wanted) = (seen.dynamics.expect("forces"), typed.dynamics.expect("forces"));
    let matrices = |dynamics: &super::Dynamics| {
        [&dynamics.force_q, &dynamics.force_qd].map(|matrix| {
            let entries = matrix.iter().enumerate();
            let rows = entries
                .flat_map(|(row, entries)| entries.iter().map(move |(column, node)| ((row, *column), *node)));
            rows.collect::<std::collections::BTreeMap<_, _>>()
        })
    };
    for trial in 0..6 {
        for (row, (force, other)) in found.force.iter().zip(&wanted.force).enumerate() {
            let wanted = value(&typed.graph, *other, trial);
            assert_near(value(&seen.graph, *force, trial), wanted, &format!("row {row} of Q"));
        }
        for (matrix, other) in matrices(&found).into_iter().zip(matrices(&wanted)) {
            assert!(matrix.keys().eq(other.keys()), "other entries");
            for (place, node) in matrix {
                let wanted = value(&typed.graph, other.get(&place).copied(), trial);
                assert_near(value(&seen.graph, Some(node), trial), wanted, &format!("slope {place:?}"));
            }
        }
    }
}

/// The balance of energies counts the same powers where time moves no place and nothing is stored.
#[test]
fn the_power_by_name_is_that_of_the_balance() {
    let names = ["floor", "push", "motor", "stops[0]", "drags[2]", "rub"];
    let outputs =
        names.iter().enumerate().map(|(index, name)| format!("out power{index}: W = power({name});"));
    let text = TEXT.replace("along: x - 1 [m/s]*t", "along: x") + &outputs.collect::<String>();
    let (model, equations) = derived(&text);
    let (graph, powers) = (&equations.graph, equations.dynamics.expect("forces").powers);
    let forces = model.dynamics.expect("forces").forces;
    for (name, output) in names.iter().zip(&equations.outputs) {
        let full = name.replace('[', ".").replace(']', "");
        let index = forces.iter().position(|force| force.name == full).expect("a force");
        for trial in 0..6 {
            assert_near(value(graph, Some(output.value), trial), value(graph, powers[index], trial), name);
        }
    }
}

/// Statements that name no force stay in the order of the text.
#[test]
fn a_force_stands_in_front_of_what_refers_to_it() {
    let (model, _) = derived(&format!("{TEXT} out last: N = force(rub); out first: m = x;"));
    let names: Vec<String> =
        model.dynamics.expect("forces").forces.into_iter().map(|force| force.name).collect();
    let place = |name: &str| names.iter().position(|known| known == name);
    assert!(place("floor") < place("rub") && place("rub") < place("motor"), "{names:?}");
    assert!(place("spring") < place("rope") && place("rope") < place("hinge"), "{names:?}");
    let outputs: Vec<&str> = model.outputs.iter().map(|output| output.name.as_str()).collect();
    assert_eq!(outputs, ["last", "first"]);
}
