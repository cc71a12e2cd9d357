//! Tests of `mechanisms::slider_crank_engine`.

use mbs_workbench::card;
use mbs_workbench::card::{Card, Preset};

use crate::reference::{dynamics_at, load};
use mechanisms::slider_crank_engine::*;

/// With play in the piston's pin.
const LOOSE: Card = card!(SliderCrankEngine::<f64>::default());

/// Parameters that an effect vanishes with.
const SWITCHES: [&str; 8] = ["bore", "g", "mu_liner", "viscous", "mu_pins", "stall", "drag", "stiffness"];

/// Of a case of the reference: those that it keeps.
fn kept(case: &str) -> &'static [&'static str] {
    match case {
        "all" => &SWITCHES,
        "gas" => &["bore"],
        "gravity" => &["g"],
        "liner_friction" => &["mu_liner", "viscous"],
        "pin_friction" => &["mu_pins"],
        "motor" => &["stall"],
        "fan" => &["drag"],
        "spring" => &["stiffness"],
        other => panic!("no case {other}"),
    }
}

#[test]
fn all_effects_without_play_and_each_alone_move_as_equations_derived_by_hand() {
    let reference = include_str!("../../references/slider_crank_engine.txt");
    let mut cases: Vec<(&str, Vec<[f64; 4]>)> = Vec::new();
    for line in reference.lines().filter(|line| !line.starts_with('#')) {
        let (case, numbers) = line.split_once(' ').expect("a case");
        let numbers: Vec<f64> = numbers.split(' ').map(|number| number.parse().expect("a number")).collect();
        if cases.last().is_none_or(|(known, _)| *known != case) {
            cases.push((case, Vec::new()));
        }
        let numbers = <[f64; 4]>::try_from(numbers).expect("four numbers");
        cases.last_mut().expect("a case").1.push(numbers);
    }
    assert_eq!(cases.len(), 8);
    for (case, expected) in cases {
        let set = SWITCHES.iter().filter(|name| !kept(case).contains(name));
        let set = set.map(|name| ((*name).to_string(), 0.0)).collect();
        let run = Preset { label: case.to_string(), description: String::new(), set };
        let times: Vec<f64> = expected.iter().map(|[t, ..]| *t).collect();
        let found = dynamics_at(&CARD, &run, &times);
        let side = load(&found.motion, "side_load");
        let most = expected.iter().fold(0.0_f64, |most, [.., side]| most.max(side.abs()));
        let mut worst = [0.0_f64; 3];
        for (k, [_, theta, omega, load]) in expected.iter().enumerate() {
            let crank = &found.motion.coordinates[0];
            let errors = [crank.q[k] - theta, (crank.qd[k] - omega) / 251.0, (side[k] - load) / most];
            worst.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error.abs()));
        }
        println!(
            "engine, {case}: angle {:.1e}, speed {:.1e}, side load {:.1e}",
            worst[0], worst[1], worst[2]
        );
        assert!(worst[0] < 1e-8 && worst[1] < 1e-8 && worst[2] < 1e-6, "{case}: {worst:?}");
    }
}

/// Columns of the reference with play: t, θ, φ, y, ω, side load, force in the eye.
const COLUMNS: usize = 7;

#[test]
#[cfg_attr(debug_assertions, ignore = "takes long without optimisation: `cargo test --release`")]
fn a_pin_with_play_moves_as_equations_derived_by_hand() {
    let reference = include_str!("../../references/slider_crank_engine_clearance.txt");
    let rows: Vec<[f64; COLUMNS]> = reference
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| {
            let numbers: Vec<f64> = line.split(' ').map(|number| number.parse().expect("a number")).collect();
            numbers.try_into().expect("seven numbers")
        })
        .collect();
    assert_eq!(rows.len(), 26);
    let run = Preset { label: "with play".to_string(), description: String::new(), set: Vec::new() };
    let times: Vec<f64> = rows.iter().map(|[t, ..]| *t).collect();
    let found = dynamics_at(&LOOSE, &run, &times);
    let column =
        |name: &str| found.motion.coordinates.iter().find(|one| one.name == name).expect("a coordinate");
    let [theta, phi, y] = ["theta", "phi", "p.1"].map(column);
    let side = load(&found.motion, "side_load");
    let eye = found.motion.outputs.iter().find(|one| one.name == "eye_force").expect("an output");
    let most = |k: usize| rows.iter().fold(0.0_f64, |most, row| most.max(row[k].abs()));
    let mut worst = [0.0_f64; COLUMNS];
    for (k, row) in rows.iter().enumerate() {
        let values = [row[0], theta.q[k], phi.q[k], y.q[k], theta.qd[k], side[k], eye.value[k]];
        for (column, worst) in worst.iter_mut().enumerate() {
            // Angles as they are, lengths over the play, others over their largest value.
            let scale = match column {
                0..=2 => 1.0,
                3 => 15e-6,
                _ => most(column),
            };
            *worst = worst.max((values[column] - row[column]).abs() / scale);
        }
    }
    println!("engine with play: {}", worst.map(|worst| format!("{worst:.1e}")).join(", "));
    let bounds = [1e-15, 1e-9, 1e-9, 1e-5, 1e-9, 1e-6, 1e-6];
    assert!(worst.iter().zip(bounds).all(|(worst, bound)| *worst <= bound), "{worst:?}");
}
