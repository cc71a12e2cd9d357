//! Tests of `mechanisms::kerb`.

use mbs_workbench::card::Preset;

use crate::reference::dynamics_at;
use mechanisms::kerb::*;

/// Parameters that an effect vanishes with.
const SWITCHES: [(&str, &str); 6] = [
    ("weight", "g"),
    ("spring", "k"),
    ("damper", "c"),
    ("bump_stop", "up"),
    ("rebound_stop", "down"),
    ("dry", "rub"),
];

fn preset(set: Vec<(String, f64)>) -> Preset {
    Preset { label: "changed".to_string(), description: String::new(), set }
}

#[test]
fn all_effects_and_all_but_one_move_as_newtons_equations() {
    let reference = include_str!("../../references/kerb.txt");
    let cases = SWITCHES.map(|(effect, switch)| (format!("without_{effect}"), Some(switch)));
    for (case, switch) in [("all".to_string(), None)].into_iter().chain(cases) {
        let lines = reference.lines().filter_map(|line| line.strip_prefix(case.as_str())?.strip_prefix(' '));
        let numbers = |line: &str| line.split(' ').map(|number| number.parse().expect("a number")).collect();
        let expected: Vec<Vec<f64>> = lines.map(numbers).collect();
        assert_eq!(expected.len(), 30, "{case}");
        let run = preset(switch.map(|name| (name.to_string(), 0.0)).into_iter().collect());
        let times: Vec<f64> = core::iter::once(0.0).chain(expected.iter().map(|row| row[0])).collect();
        let found = dynamics_at(&CARD, &run, &times);
        let load = found.motion.outputs.iter().find(|output| output.name == "wheel_load").expect("an output");
        let mut worst = [0.0_f64; 2];
        for (k, row) in expected.iter().enumerate() {
            for (coordinate, exact) in found.motion.coordinates.iter().zip(&row[1..3]) {
                worst[0] = worst[0].max((coordinate.q[k + 1] - exact).abs());
            }
            worst[1] = worst[1].max((load.value[k + 1] - row[3]).abs());
        }
        println!("kerb, {case}: heights {:.1e} m, wheel load {:.1e} N", worst[0], worst[1]);
        assert!(worst[0] < 1e-10 && worst[1] < 1e-4, "{case}: {worst:?}");
    }
}

#[test]
fn the_tyre_lifts_off_and_the_strut_comes_to_both_stops() {
    let times: Vec<f64> = (0..=1500).map(|k| f64::from(k) * 1e-3).collect();
    let found = dynamics_at(&CARD, &preset(Vec::new()), &times);
    let output =
        |name| &found.motion.outputs.iter().find(|output| output.name == name).expect("an output").value;
    let (load, strut) = (output("wheel_load"), output("strut"));
    assert!(load.contains(&0.0));
    assert!(strut.iter().any(|way| *way < -0.05) && strut.iter().any(|way| *way > 0.04));
}

#[test]
fn small_motions_have_the_modes_of_the_closed_form() {
    // The damper alike both ways, and neither friction nor loss.
    let set = [("together", 1.0), ("rub", 0.0), ("loss", 0.0), ("height", 0.0)];
    let set = set.map(|(name, value)| (name.to_string(), value)).to_vec();
    let mechanism = CARD.instance(&preset(set)).expect("its parameters");
    let dynamics = mechanism.dynamics().expect("it has masses");
    let rest = dynamics.rest(&[]).expect("it rests");
    let small = dynamics.small_motions(&rest.motion).expect("it can move");
    assert_eq!(small.modes.len(), 2);
    for (mode, (hertz, ratio)) in small.modes.iter().zip([(1.252, 0.264), (11.079, 0.275)]) {
        let [real, imaginary] = mode.eigenvalue;
        let size = real.hypot(imaginary);
        assert!((size / core::f64::consts::TAU - hertz).abs() < 1e-3, "{mode:?}");
        assert!((-real / size - ratio).abs() < 1e-3, "{mode:?}");
    }
}
