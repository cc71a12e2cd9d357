//! Partial derivatives, and the rows and functions of curves, against differences of their values and against closed forms.

use super::derive;
use crate::diagnostics::Diagnostics;
use crate::model::scenes::read_source;
use crate::symbolic::evaluate::evaluate;
use crate::symbolic::{Leaf, NodeId};

/// Leaves of a text at one state: coordinates, then parameters.
#[derive(Clone)]
struct State {
    q: Vec<f64>,
    parameters: Vec<f64>,
}

impl State {
    fn of(&self, leaf: Leaf) -> f64 {
        let at = |values: &[f64], index: u32| values.get(index as usize).copied().expect("a value");
        match leaf {
            Leaf::Position(index) => at(&self.q, index),
            Leaf::Parameter(index) => at(&self.parameters, index),
            other => panic!("{other:?}"),
        }
    }
}

/// Values of the outputs, then each row with its entries of Φ_q as a dense row.
fn values(text: &str, state: &State) -> (Vec<f64>, Vec<(f64, Vec<f64>)>) {
    let mut diagnostics = Diagnostics::default();
    let read = read_source(text, &mut diagnostics);
    let faults = diagnostics.to_text();
    let (_, scenes) = read.expect("a readable text");
    let scene = scenes.find(None).expect("the whole text");
    assert!(faults.is_empty() && scene.faults.is_empty(), "{faults}{}", scene.faults.to_text());
    let equations = derive(&scene.model);
    let of = |roots: &[NodeId]| evaluate(&equations.graph, roots, |leaf| state.of(leaf));
    let outputs: Vec<NodeId> = equations.outputs.iter().map(|output| output.value).collect();
    let rows = equations.rows.iter().map(|row| {
        let mut entries = vec![0.0; state.q.len()];
        for (column, node) in &row.phi_q {
            entries[*column] = of(&[*node])[0];
        }
        (of(&[row.phi])[0], entries)
    });
    (of(&outputs), rows.collect())
}

/// Derivative of a function of one number by differences of order 4.
fn slope(f: impl Fn(f64) -> f64) -> f64 {
    const STEP: f64 = 1e-3;
    (8.0 * (f(STEP) - f(-STEP)) - (f(2.0 * STEP) - f(-2.0 * STEP))) / (12.0 * STEP)
}

fn assert_near(found: f64, expected: f64, what: &str) {
    assert!((found - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{what}: {found}, not {expected}");
}

const SMOOTH: &str = "pub mechanism Smooth;
param L: m = 0.4;
function lift: m(rad), C9, periodic TAU;
coord phi: rad = 0.3;
coord p: [m; 2] = [0.1, 0.2];
drive turn: phi == 1rad;
let z = L^2*sin(2*phi)*exp(p.0/L) + p.1*lift(phi*p.0/L)*atan2(p.1, p.0 + L) + norm(p)*max(p.0, 2*p.1);
constraint hold { d(z, phi) == 0; d(d(z, p.0), phi) == 0; }
out value: m^2 = z;
out first: m^2 = d(z, phi);
out along: [m; 2] = d(z, p);
out of_parameter: m = d(z, L);
out twice: m = d(d(z, p.1), phi);
out turned: [1; 2, 2] = d(rot(phi)*p, p);
out none: m = d(p.0, phi);
";

#[test]
fn partial_derivatives_are_those_of_differences_along_one_variable() {
    let at = |phi: f64, x: f64, y: f64, length: f64| State { q: vec![phi, x, y], parameters: vec![length] };
    let (phi, x, y, length) = (0.7, 0.31, 0.22, 0.4);
    let (found, rows) = values(SMOOTH, &at(phi, x, y, length));
    let output = |index: usize, state: State| values(SMOOTH, &state).0[index];
    let expected = [
        slope(|h| output(0, at(phi + h, x, y, length))),
        slope(|h| output(0, at(phi, x + h, y, length))),
        slope(|h| output(0, at(phi, x, y + h, length))),
        slope(|h| output(0, at(phi, x, y, length + h))),
        slope(|h| output(3, at(phi + h, x, y, length))),
    ];
    for (index, expected) in expected.into_iter().enumerate() {
        assert_near(found[index + 1], expected, &format!("output {}", index + 1));
    }
    let (sine, cosine) = phi.sin_cos();
    for (index, expected) in [cosine, -sine, sine, cosine, 0.0].into_iter().enumerate() {
        assert_near(found[index + 6], expected, &format!("output {}", index + 6));
    }
    // Rows of partial derivatives have gradients of their own.
    for (row, index) in [(1, 1), (2, usize::MAX)] {
        let value = |state: State| match index {
            1 => values(SMOOTH, &state).0[1],
            _ => values(SMOOTH, &state).1[2].0,
        };
        let gradient = [
            slope(|h| value(at(phi + h, x, y, length))),
            slope(|h| value(at(phi, x + h, y, length))),
            slope(|h| value(at(phi, x, y + h, length))),
        ];
        for (column, expected) in gradient.into_iter().enumerate() {
            assert_near(rows[row].1[column], expected, &format!("row {row}, column {column}"));
        }
    }
}

#[test]
fn a_partial_derivative_at_a_kink_is_the_right_sided_one() {
    let text = "pub mechanism Kink;
coord x: m = 1;
coord y: m = 1;
drive a: x == 1m;
drive b: y == 1m;
out magnitude: 1 = d(abs(x), x);
out smaller: [1; 2] = [d(min(x, 2*y), x), d(min(x, 2*y), y)];
out larger: [1; 2] = [d(max(x, 2*y), x), d(max(x, 2*y), y)];
";
    let at = |x: f64, y: f64| values(text, &State { q: vec![x, y], parameters: Vec::new() }).0;
    assert_eq!(at(0.0, 0.0), [1.0, 0.0, 2.0, 1.0, 0.0]);
    assert_eq!(at(-0.5, 1.0), [-1.0, 1.0, 0.0, 0.0, 2.0]);
    assert_eq!(at(3.0, 1.0), [1.0, 0.0, 2.0, 1.0, 0.0]);
}

const CAM: &str = "pub mechanism Cam;
param C: [m; 2] = 0;
function pitch: m(rad), C9, periodic TAU;
coord A: [m; 2] = [0.1, 0.2];
coord theta: rad = 0.3;
curve cam = polar pitch about C turned theta;
constraint rides { A on cam; distance(A, cam) == 0; }
drive turn: theta == 1rad;
out gap: m = distance(A, cam);
out outwards: [1; 2] = normal(A, cam);
out slope: [1; 2] = d(norm(A - C) - pitch(atan2(A.1 - C.1, A.0 - C.0) - theta), A);
";

/// The radius that `evaluate` takes for the first function of a text, and its slope.
fn pitch(angle: f64) -> [f64; 2] {
    [angle.sin(), angle.cos()]
}

#[test]
fn a_point_on_a_curve_has_the_rows_of_its_polar_radius() {
    let centre = [0.03, -0.05];
    let at = |x: f64, y: f64, theta: f64| State { q: vec![x, y, theta], parameters: centre.to_vec() };
    for (x, y, theta) in [(0.4, 0.7, 0.3), (-0.6, 0.2, 40.0), (-0.5, -0.9, -2.0), (0.2, -0.3, 1.0)] {
        let (outputs, rows) = values(CAM, &at(x, y, theta));
        let from = [x - centre[0], y - centre[1]];
        let (r, w) = (from[0].hypot(from[1]), from[1].atan2(from[0]));
        let [radius, steep] = pitch(w - theta);
        let steepness = 1.0_f64.hypot(steep / r);
        assert_near(rows[0].0, r - radius, "row");
        assert_near(outputs[0], (r - radius) / steepness, "gap");
        assert_near(rows[1].0, outputs[0], "row of the gap");
        // e_r − (R′/r) e_t, and its direction.
        let (e_r, e_t) = ([w.cos(), w.sin()], [-w.sin(), w.cos()]);
        for axis in 0..2 {
            let gradient = e_r[axis] - steep / r * e_t[axis];
            assert_near(rows[0].1[axis], gradient, "gradient of the row");
            assert_near(outputs[3 + axis], gradient, "partial derivative");
            assert_near(outputs[1 + axis], gradient / steepness, "normal");
        }
        assert_near(rows[0].1[2], steep, "slope of the row with the angle");
        // Off the curve the gradient of the gap has the term (r − R) ∇(1/√…) too.
        let gap = |state: State| values(CAM, &state).0[0];
        let gradient = [
            slope(|h| gap(at(x + h, y, theta))),
            slope(|h| gap(at(x, y + h, theta))),
            slope(|h| gap(at(x, y, theta + h))),
        ];
        for (column, expected) in gradient.into_iter().enumerate() {
            assert!((rows[1].1[column] - expected).abs() < 1e-8, "{column}: {expected}, {:?}", rows[1]);
            assert!(
                column == 2 || (expected - outputs[1 + column]).abs() > 1e-3,
                "the term is not small here"
            );
        }
    }
}

#[test]
fn at_its_centre_a_curve_has_no_gradient() {
    let (_, rows) = values(CAM, &State { q: vec![0.0, 0.0, 0.3], parameters: vec![0.0, 0.0] });
    assert!(rows[0].0.is_finite() && rows[0].1[..2].iter().all(|entry| entry.is_nan()), "{:?}", rows[0]);
}
