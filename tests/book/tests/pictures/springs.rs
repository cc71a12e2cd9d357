//! One-way and gas springs, torsion bar, bushing, backlash, a door.

use crate::texts::{Discs, Door, Gears, Mounted, Piston, Stopped};
use crate::{curve, hold, level, plot, spans};

#[test]
fn a_cart_against_one_way_springs() {
    let run_against = |k: f64| -> Vec<[f64; 2]> {
        traced!(Stopped { k, ..Stopped::default() }, 0.4, 400, |run| [run.t(), 1e3 * run.q()[0]])
    };
    let (hard, soft) = (run_against(5000.0), run_against(1000.0));
    let touches = spans(hard.iter().map(|[t, s]| (*t, *s > 20.0)));
    let curves =
        vec![curve("5000 N/m", hard), curve("1000 N/m", soft), level("unloaded end", [0.0, 0.4], 20.0)];
    let mut picture = plot("A cart against one-way springs", ["time (s)", "place (mm)"], curves);
    picture.marks = Some(("touches, 5000 N/m".to_string(), touches));
    hold("one_way_spring", &picture);
}

#[test]
fn gas_springs_over_their_travel() {
    let over = |n: f64| {
        let places = (0..=70).map(|part| 1e-3 * f64::from(part));
        let points = places.map(|at| {
            let text: Piston = Piston { at, n, ..Piston::default() };
            [1e3 * at, begun!(text, |run| run.outputs()[0].value)]
        });
        curve(&format!("n = {n}"), points.collect())
    };
    let curves = [1.0, 1.2, 1.4].map(over).to_vec();
    hold("gas_spring", &plot("Force of a gas spring", ["travel (mm)", "force (N)"], curves));
}

#[test]
fn two_discs_on_a_bar() {
    let seen = traced!(Discs::<f64>::default(), 0.4, 300, |run| [run.t(), run.q()[0], run.q()[1]]);
    let drawn = |label: &str, of: usize| curve(label, seen.iter().map(|p| [p[0], 1e3 * p[of]]).collect());
    let curves = vec![drawn("0.02 kg m²", 1), drawn("0.05 kg m²", 2)];
    hold("torsion_bar", &plot("Two discs on a bar", ["time (s)", "angle (mrad)"], curves));
}

#[test]
fn a_body_in_a_bushing() {
    let path = traced!(Mounted::<f64>::default(), 0.6, 500, |run| [1e3 * run.q()[0], 1e3 * run.q()[1]]);
    let axes = ["along the first axis of the ground (mm)", "along the second one (mm)"];
    hold("bushing", &plot("Path of a body in a bushing", axes, vec![curve("path for 0.6 s", path)]));
}

#[test]
fn gears_with_play() {
    let seen = traced!(Gears::<f64>::default(), 0.03, 600, |run| {
        let [zone, contacts] = run.outputs().map(|way| 1e3 * way.value);
        [1e3 * run.t(), zone, contacts]
    });
    let drawn = |label: &str, of: usize| curve(label, seen.iter().map(|p| [p[0], p[of]]).collect());
    let curves = vec![
        drawn("dead zone", 1),
        drawn("contacts, e = 0.7", 2),
        level("b/2", [0.0, 30.0], 0.1),
        level("−b/2", [0.0, 30.0], -0.1),
    ];
    hold("backlash", &plot("Gears in their play", ["time (ms)", "way of the teeth (mm)"], curves));
}

#[test]
fn a_door_with_five_effects() {
    let seen = traced!(Door::<f64>::default(), 4.0, 400, |run| [run.t(), run.q()[0].to_degrees()]);
    hold("door", &plot("Angle of a door", ["time (s)", "angle (deg)"], vec![curve("door", seen)]));
}
