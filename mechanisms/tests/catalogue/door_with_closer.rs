//! Tests of `mechanisms::door_with_closer`.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};

use crate::reference::{dynamics_at, load};
use mechanisms::door_with_closer::*;

const REFERENCE: &str = include_str!("../../references/door_with_closer.txt");

/// Numbers of the reference's lines that begin with this word.
fn of_reference(case: &str) -> Vec<Vec<f64>> {
    let lines = REFERENCE.lines().filter_map(|line| line.strip_prefix(case)?.strip_prefix(' '));
    lines.map(|line| line.split(' ').map(|number| number.parse().expect("a number")).collect()).collect()
}

#[test]
fn all_presets_move_as_the_laws_integrated_between_switches() {
    for run in CARD.runs().expect("presets") {
        let expected = of_reference(&run.label);
        assert!(expected.len() >= 6, "{}", run.label);
        let times: Vec<f64> = core::iter::once(0.0).chain(expected.iter().map(|row| row[0])).collect();
        let found = dynamics_at(&CARD, &run, &times);
        let door = &found.motion.coordinates[0];
        let mut worst = [0.0_f64; 2];
        for (k, row) in expected.iter().enumerate() {
            let errors = [(door.q[k + 1] - row[1]).abs(), (door.qd[k + 1] - row[2]).abs()];
            worst.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error));
        }
        let last = |name| *load(&found.motion, name).last().expect("an end");
        println!("door, {}: angle {:.1e} rad, rate {:.1e} rad/s", run.label, worst[0], worst[1]);
        assert!(worst[0] < 1e-8 && worst[1] < 1e-7, "{}: {worst:?}", run.label);
        let caught = of_reference(&format!("caught {}", run.label));
        assert_eq!(last("is_caught"), if caught.is_empty() { 0.0 } else { 1.0 }, "{}", run.label);
        if let Some(at) = caught.last() {
            assert!((last("caught_at") - at[0]).abs() < 1e-8, "{}: {} {at:?}", run.label, last("caught_at"));
        }
    }
}

#[test]
fn friction_holds_the_door_above_an_angle() {
    let border = of_reference("border")[0][0];
    for (off, holds) in [(1e-9, true), (-1e-9, false)] {
        let door = DoorWithCloser { opened: border + off, ..DoorWithCloser::default() };
        let method = Explicit::new(DormandPrince8, Projection::default());
        let run = Simulation::start_from_text(door, method, 0.0_f64).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(1e-10));
        run.advance_to(20.0).expect("it goes on");
        let moved = (run.q()[0] - border - off).abs();
        assert!(if holds { moved < 1e-15 } else { moved > 1.0 }, "{off}: {moved}");
    }
}
