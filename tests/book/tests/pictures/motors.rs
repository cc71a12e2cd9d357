//! Drag, motors, a turning frame.

use crate::texts::{Armature, Dragged, Limited, Line, Puck};
use crate::{curve, hold, plot};

#[test]
fn drag_slows_a_cart() {
    let mut curves = [0.4, 0.8, 1.6]
        .map(|c| {
            let seen = traced!(Dragged { c }, 4.0, 200, |run| [run.t(), run.qd()[0]]);
            curve(&format!("c = {c} N·s²/m²"), seen)
        })
        .to_vec();
    let times = (0..=40).map(|part| 0.1 * f64::from(part));
    let closed = times.map(|t| [t, 3.0 / (1.0 + 0.4 * 3.0 * t / 2.0)]).collect();
    curves.push(curve("closed form, c = 0.4", closed).dashed());
    hold("drag", &plot("Speed of a dragged cart", ["time (s)", "speed (m/s)"], curves));
}

#[test]
fn torque_over_speed() {
    let speeds: Vec<f64> = (-20..=100).map(|part| 5.0 * f64::from(part)).collect();
    let line = |omega: f64| {
        let text: Line = Line { omega, ..Line::default() };
        [omega, begun!(text, |run| run.outputs()[0].value)]
    };
    let limited = |omega: f64| {
        let text: Limited = Limited { omega, ..Limited::default() };
        [omega, begun!(text, |run| run.outputs()[0].value)]
    };
    let curves = vec![
        curve("constant voltage", speeds.iter().map(|omega| line(*omega)).collect()),
        curve("with a limit of 2 N·m", speeds.iter().map(|omega| limited(*omega)).collect()),
    ];
    hold("torque_speed", &plot("Torque of a motor", ["speed (rad/s)", "torque (N·m)"], curves));
}

#[test]
fn current_of_a_motor() {
    let curves = [(3e-3, "3 mH"), (30e-3, "30 mH"), (0.3, "300 mH")].map(|(inductance, label)| {
        let text: Armature = Armature { L: inductance, ..Armature::default() };
        // The fastest rise takes 3 ms.
        curve(label, traced!(text, 0.8, 500, |run| [run.t(), run.states()[0]]))
    });
    let axes = ["time (s)", "current (A)"];
    hold("motor_current", &plot("Current of a motor after a step of voltage", axes, curves.to_vec()));
}

#[test]
fn a_puck_on_a_turntable() {
    let seen = traced!(Puck::<f64>::default(), 1.5, 300, |run| (*run.q(), run.outputs().map(|at| at.value)));
    let curves = vec![
        curve("seen from the table", seen.iter().map(|(table, _)| *table).collect()),
        curve("seen from the ground", seen.iter().map(|(_, ground)| *ground).collect()),
    ];
    hold("turning_frame", &plot("Path of a puck on a turntable", ["x (m)", "y (m)"], curves));
}
