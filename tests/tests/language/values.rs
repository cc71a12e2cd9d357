//! Values and derivatives of functions, operators, vectors, matrices and loops.

use super::*;

/// The rows of a text whose `y` have these values.
fn rows(values: [Jet; 16], q: &[Jet; 18], t: Jet) -> (Vec<Jet>, Vec<Jet>) {
    let mut rows = vec![q[0] - (0.3 + 0.2 * t.sin()), q[1] - (0.7 - 0.1 * t)];
    rows.extend(values.iter().zip(&q[2..]).map(|(value, y)| *y - *value));
    (rows, Vec::new())
}

fn operators(q: &[Jet; 18], t: Jet) -> (Vec<Jet>, Vec<Jet>) {
    let ([x, z], one) = ([q[0], q[1]], Jet::number(1.0));
    let values = [
        x + z,
        x - z,
        x * z,
        x / z,
        -x,
        (2.0 + x).pow(z),
        x * x * x,
        one / (x * x),
        (1.0 + x).sqrt(),
        one / ((1.0 + x) * (1.0 + x).sqrt()),
        (1.0 + x * z).sqrt(),
        (-x * z).exp(),
        (1.0 + x * z).ln(),
        (x * z).sin(),
        (x + z).cos(),
        (x * z).sin() / (x * z).cos(),
    ];
    rows(values, q, t)
}

fn functions(q: &[Jet; 18], t: Jet) -> (Vec<Jet>, Vec<Jet>) {
    let [x, z] = [q[0], q[1]];
    let values = [
        (x * z).asin(),
        PI / 2.0 - (x * z).asin(),
        (x - 3.0 * z).atan(),
        (x / z).atan(),
        0.5 * ((x * z).exp() - (-x * z).exp()),
        0.5 * ((x * z).exp() + (-x * z).exp()),
        ((x * z).exp() - (-x * z).exp()) / ((x * z).exp() + (-x * z).exp()),
        z - x,
        -x,
        x * z,
        z,
        (x * x + z * z + x * z * x * z).sqrt(),
        1.0 + 2.0 * x + 3.0 * x * x,
        0.5 + x - 0.5 * z,
        x * x.sin() * x.cos() / (2.0 + x.sin() * z.cos()),
        z.pow(x) * t,
    ];
    rows(values, q, t)
}

#[test]
fn every_function_and_operator_has_its_value_and_derivatives() {
    for state in [state([0.3, 0.7], 0.4), state([0.11, 0.95], -0.2)] {
        check(&Operators::default(), &state, operators);
        check(&Functions::default(), &state, functions);
    }
}

fn plane(q: &[Jet; 5], t: Jet) -> (Vec<Jet>, Vec<Jet>) {
    let (l, c) = ([0.3, 0.2], [0.1, -0.05]);
    let [p0, p1, r0, r1, phi] = *q;
    let (s, k) = (phi.sin(), phi.cos());
    let tip = [p0 + k * c[0] - s * c[1], p1 + s * c[0] + k * c[1]];
    let (dx, dy) = (p0 - c[0], p1 - c[1]);
    let rows = vec![
        r0 - (tip[0] + l[0] * k - 2.0 * l[1]),
        r1 - (tip[1] + l[0] * s),
        // A suffix belongs to its number: (0.1 m)².
        dx * dx + dy * dy - 0.01,
        p0 * s - p1 * k - 0.05,
        phi - (0.3 + 0.5 * t),
    ];
    let area = p0 * r1 - p1 * r0;
    let distance = ((r0 - p0) * (r0 - p0) + (r1 - p1) * (r1 - p1)).sqrt();
    let rates = [tip[0].rate(), tip[1].rate(), tip[0].rate().rate(), tip[1].rate().rate()];
    let mut outputs = vec![distance, area, area];
    outputs.extend(rates);
    (rows, outputs)
}

#[test]
fn planar_vectors_are_computed_by_components() {
    check(&Plane::default(), &state([0.4, 0.2, 0.5, -0.1, 0.8], 0.7), plane);
    let outputs = Plane::<f64>::OUTPUTS.iter().map(|entry| (entry.name, entry.unit)).collect::<Vec<_>>();
    assert_eq!(outputs[0], ("distance", "m"));
    assert_eq!(outputs[2], ("area.1", "m^2"));
    assert_eq!(outputs[3], ("speed.0", "m/s"));
}

fn space(q: &[Jet; 6], t: Jet) -> (Vec<Jet>, Vec<Jet>) {
    let a = [[1.0, 2.0, 0.5], [-1.0, 0.3, 0.0], [0.2, 0.0, 2.0]].map(|row| row.map(Jet::number));
    let b = [0.5, -1.0, 2.0].map(Jet::number);
    let (v, w) = ([q[0], q[1], q[2]], [q[3], q[4], q[5]]);
    let dot = |a: [Jet; 3], b: [Jet; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross = |a: [Jet; 3], b: [Jet; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let turned = cross(v, b);
    let mut rows: Vec<Jet> =
        (0..3).map(|i| w[i] - (dot(a[i], v) + turned[i] - 2.0 / 3.0 * v[i] + v[i] * b[2])).collect();
    rows.push(dot(v, b) - 0.1 * t);
    rows.push(dot(v, v).sqrt() - 2.0);
    rows.push(dot(v, cross(b, [a[0][1], a[1][1], a[2][1]])) - v[0]);
    let length = v[0] + dot(a[1], a[1]).sqrt();
    let volume = dot(a[0], cross(a[1], a[2])) + dot(v, cross(w, b));
    (rows, vec![length, volume])
}

#[test]
fn spatial_vectors_and_matrices_are_computed_by_components() {
    check(&Space::default(), &state([1.1, 0.4, -0.3, 0.2, 0.9, -1.4], 0.3), space);
}

fn chain(q: &[Jet; 9], t: Jet) -> (Vec<Jet>, Vec<Jet>) {
    let l = [0.3, 0.2, 0.1];
    let (phi, p) = ([q[0], q[1], q[2]], |i: usize| [q[3 + 2 * i], q[4 + 2 * i]]);
    let bar = |i: usize| {
        let end = [l[i] * phi[i].cos(), l[i] * phi[i].sin()];
        let begin = if i == 0 { [Jet::number(0.0); 2] } else { p(i - 1) };
        [p(i)[0] - begin[0] - end[0], p(i)[1] - begin[1] - end[1]]
    };
    let turn = |i: usize| phi[i] - phi[i - 1] - (0.1 + i as f64) * t;
    let [[a, b], [c, d], [e, f]] = [bar(0), bar(1), bar(2)];
    let rows = vec![a, b, c, d, turn(1), e, f, turn(2), p(2)[0] - 0.45 - 0.01 * t.sin()];
    let reach = l[0] * phi[0].cos() + l[1] * phi[1].cos() + l[2] * phi[2].cos();
    (rows, vec![p(1)[1], p(2)[1], reach])
}

#[test]
fn loops_repeat_rows_outputs_and_terms() {
    check(&Chain::default(), &state([0.2, 0.5, -0.3, 0.3, 0.1, 0.4, 0.2, 0.5, 0.3], 0.9), chain);
    let rows: Vec<&str> = Chain::<f64>::ROWS.iter().map(|row| row.name).collect();
    let expected = ["first.0", "first.1", "bar.0", "bar.1", "turn.0", "bar.2", "bar.3", "turn.1", "tip"];
    assert_eq!(rows, expected);
    let coordinates: Vec<&str> = Chain::<f64>::COORDINATES.iter().map(|c| c.name).collect();
    assert_eq!(coordinates[..5], ["phi.0", "phi.1", "phi.2", "p.0.0", "p.0.1"]);
    let outputs: Vec<&str> = Chain::<f64>::OUTPUTS.iter().map(|output| output.name).collect();
    assert_eq!(outputs, ["height.0", "height.1", "reach"]);
}
