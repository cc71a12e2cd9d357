//! Tests of `mechanisms::valve_spring`.

use mbs_runtime::dynamics::{Direction, DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_workbench::card::Preset;

use crate::reference::dynamics_at;
use mechanisms::valve_spring::*;

const REFERENCE: &str = include_str!("../../references/valve_spring.txt");

/// Numbers of the reference's lines that begin with this word.
fn of_reference(case: &str) -> Vec<Vec<f64>> {
    let lines = REFERENCE.lines().filter_map(|line| line.strip_prefix(case)?.strip_prefix(' '));
    lines.map(|line| line.split(' ').map(|number| number.parse().expect("a number")).collect()).collect()
}

#[test]
fn the_valve_moves_as_by_equal_steps_on_the_nose_and_off_it() {
    for (case, speed) in [("holds", 2500.0), ("floats_at_4200", 4200.0)] {
        let expected = of_reference(case);
        assert_eq!(expected.len(), 16);
        let set = vec![("speed".to_string(), speed * core::f64::consts::PI / 30.0)];
        let run = Preset { label: case.to_string(), description: String::new(), set };
        let times: Vec<f64> = core::iter::once(0.0).chain(expected.iter().map(|row| row[0])).collect();
        let found = dynamics_at(&CARD, &run, &times);
        let output =
            |name| found.motion.outputs.iter().find(|output| output.name == name).expect("an output");
        let (valve, force) = (&found.motion.coordinates[1], &output("cam_force").value);
        let mut worst = [0.0_f64; 3];
        for (k, row) in expected.iter().enumerate() {
            let errors = [
                (valve.q[k + 1] - row[1]) / 0.009,
                (valve.qd[k + 1] - row[2]) / 3.0,
                (force[k + 1] - row[3]) / 500.0,
            ];
            worst.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error.abs()));
        }
        println!("valve, {case}: lift {:.1e}, rate {:.1e}, force {:.1e}", worst[0], worst[1], worst[2]);
        assert!(worst[0] < 1e-9 && worst[1] < 1e-8 && worst[2] < 1e-7, "{case}: {worst:?}");
    }
}

/// The face leaves the cam while this is above half of its lift, in the first turn at this speed (rad/s).
fn floats(valve: ValveSpring, speed: f64) -> bool {
    let valve = ValveSpring { speed, ..valve };
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(valve, method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-10));
    // sin⁸(θ/2) is above 1/2.
    let half = 2.0 * 0.5_f64.powf(0.125).asin();
    run.advance_to(half / speed).expect("it goes on");
    let until = (core::f64::consts::TAU - half) / speed;
    let gap =
        |_: f64, [theta, y]: &[f64; 2], _: &[f64; 2]| y + valve.play - 0.009 * (theta / 2.0).sin().powi(8);
    run.advance_until_event(until, Direction::Rising, gap).expect("it goes on")
}

#[test]
fn float_begins_at_the_speed_of_the_reference_and_next_to_that_of_a_rigid_cam() {
    let text = ValveSpring::default();
    let bare = ValveSpring { play: 0.0, mu: 0.0, p: 0.0, ..text };
    for (name, valve) in [("floats text", text), ("floats bare", bare)] {
        let speed = of_reference(name)[0][0];
        assert!(!floats(valve, speed * (1.0 - 3e-6)) && floats(valve, speed * (1.0 + 3e-6)), "{name}");
    }
    let rigid = ((150.0 + 18_000.0 * 0.009 + 0.15 * 9.81) / (2.0 * 0.15 * 0.009_f64)).sqrt();
    let found = of_reference("floats bare")[0][0];
    // The compliance of the contact counts as (ω/ω₀)² = 0.09 % of the force, and its vibrations.
    assert!((found / rigid - 1.0).abs() < 3e-3, "{found} {rigid}");
}
