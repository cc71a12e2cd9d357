//! Tyres over slip and way, wheels that brake and coast, suspensions.

use crate::texts::{Braking, Coasting, HalfCar, Kerb, KerbOutputs, Rolling, Slips};
use crate::{curve, hold, plot, spans};

#[test]
fn force_over_slip() {
    let forces = (0..=160).map(|part| 0.0025 * f64::from(part)).map(|slip| {
        let text: Slips = Slips { slip, ..Slips::default() };
        let [magic, brush] = begun!(text, |run| run.outputs()).map(|force| force.value);
        [slip, magic, brush]
    });
    let forces: Vec<[f64; 3]> = forces.collect();
    let drawn = |label: &str, of: usize| curve(label, forces.iter().map(|p| [p[0], p[of]]).collect());
    let curves = vec![drawn("magic formula", 1), drawn("brush model", 2)];
    hold("tyre_slip", &plot("Force of a tyre over its slip", ["slip (1)", "force (N)"], curves));
}

#[test]
fn force_over_the_way() {
    let curves = [0.03, 0.1, 0.3].map(|slip| {
        let text: Rolling = Rolling { slip, ..Rolling::default() };
        curve(&format!("slip {slip}"), traced!(text, 0.25, 200, |run| [run.q()[0], run.loads()[0]]))
    });
    let axes = ["way (m)", "force (N)"];
    hold("tyre_relaxation", &plot("Force of a tyre over its way", axes, curves.to_vec()));
}

#[test]
fn a_wheel_that_brakes() {
    let seen = traced!(Braking::<f64>::default(), 3.0, 400, |run| [run.t(), run.qd()[0], 0.3 * run.qd()[2]]);
    let drawn = |label: &str, of: usize| curve(label, seen.iter().map(|p| [p[0], p[of]]).collect());
    let curves = vec![drawn("centre", 1), drawn("rim", 2)];
    let axes = ["time (s)", "speed (m/s)"];
    hold("tyre_standstill", &plot("A wheel that brakes to a standstill", axes, curves));
}

#[test]
fn a_wheel_that_coasts() {
    let curves = [0.01, 0.012, 0.015].map(|f| {
        let text: Coasting = Coasting { f };
        curve(&format!("f = {f}"), traced!(text, 36.0, 180, |run| [run.t(), run.outputs()[0].value]))
    });
    hold("coasting", &plot("Speed of a coasting wheel", ["time (s)", "speed (m/s)"], curves.to_vec()));
}

#[test]
fn half_a_car_on_a_wavy_road() {
    let seen = traced!(HalfCar::<f64>::default(), 3.0, 400, |run| [run.t(), run.q()[0], run.q()[1]]);
    let drawn = |label: &str, of: usize| curve(label, seen.iter().map(|p| [p[0], 1e3 * p[of]]).collect());
    let curves = vec![drawn("bounce (mm)", 1), drawn("pitch (mrad)", 2)];
    let axes = ["time (s)", "bounce (mm), pitch (mrad)"];
    hold("half_car", &plot("Half a car on a wavy road", axes, curves));
}

#[test]
fn a_quarter_car_on_a_kerb() {
    let seen = traced!(Kerb::<f64>::default(), 1.5, 600, |run| {
        let KerbOutputs { patch, wheel_load, .. } = run.outputs().into();
        [run.t(), 1e3 * run.q()[0], 1e3 * run.q()[1], 1e3 * patch[1].value, wheel_load.value]
    });
    let off = spans(seen.iter().map(|p| (p[0], p[4] <= 0.0)));
    assert!(!off.is_empty(), "the tyre lifts off");
    let drawn = |label: &str, of: usize| curve(label, seen.iter().map(|p| [p[0], p[of]]).collect());
    let curves = vec![drawn("body", 1), drawn("wheel", 2), drawn("road", 3).dashed()];
    let mut picture = plot("Quarter car on a kerb", ["time (s)", "height above rest (mm)"], curves);
    picture.marks = Some(("tyre off the road".to_string(), off));
    hold("kerb", &picture);
}
