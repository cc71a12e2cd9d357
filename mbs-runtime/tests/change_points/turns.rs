//! Cranks that count whole turns and fold flat where a turn ends: the position that leads on turns with the state.

use core::f64::consts::{PI, TAU};

use mbs_runtime::{Batch, Lanes, Mechanism, Stepper, mechanism};

use crate::linkage::{Linkage, PARALLELOGRAM, STRETCHED, distance};
use crate::plan::Random;

mechanism! {
    /// A four-bar whose crank turns at a prescribed speed, and its angle is counted in whole turns.
    pub mechanism Turning;
    param crank: m = 1;
    param coupler: m = 2;
    param rocker: m = 1;
    param ground: m = 2;
    param omega: rad/s = 1;
    coord phi: turn = 0;
    coord psi: rad = 0;
    coord chi: rad = 0;
    constraint closure { crank*unit(phi) + coupler*unit(psi) == [ground, 0] + rocker*unit(chi); }
    drive motor: rate(phi) == omega;
}

/// Speeds and durations of steps to angles around the end of a turn, and the angles that they lead to.
fn plan(start: f64, random: &mut Random) -> Vec<(f64, f64, f64)> {
    let mut steps = Vec::new();
    let mut angle = start;
    let mut turn = 0.0;
    for _ in 0..60 {
        // Regular or next to the change point, where the last position that leads on is farther away; forth and back.
        let exponent = random.between(-5.5, -0.5);
        let side = if random.between(0.0, 1.0) < 0.5 { 1.0 } else { -1.0 };
        if random.between(0.0, 1.0) < 0.3 {
            turn += if random.between(0.0, 1.0) < 0.5 { 1.0 } else { -1.0 };
        }
        let next = PI + TAU * turn + side * 10_f64.powf(exponent);
        // In pieces that the motion of a drive may have.
        let pieces = ((next - angle).abs() / 0.4).ceil().max(1.0);
        let h = random.between(0.01, 0.1);
        for _ in 0..pieces as u32 {
            steps.push(((next - angle) / (pieces * h), h, 0.0));
        }
        let from = steps.len() - pieces as usize;
        for (k, step) in steps[from..].iter_mut().enumerate() {
            step.2 = angle + (next - angle) * (k + 1) as f64 / pieces;
        }
        angle = next;
    }
    steps
}

/// The path that a point is on in this turn, where it is on `side` in the first: of bars that fold flat once a turn, the other one
/// in every second turn.
fn path(linkage: &Linkage, side: f64, angle: f64) -> f64 {
    let turn = (angle / TAU).floor();
    if linkage.centre == 0.0 || turn.rem_euclid(2.0) == 0.0 { side } else { -side }
}

/// Distance from the right assembly, times the angle from where a turn ends: rounding is divided by it there.
fn off(linkage: &Linkage, side: f64, q: &[f64; 3], angle: f64) -> f64 {
    let point = [
        linkage.crank * q[0].cos() + linkage.coupler * q[1].cos(),
        linkage.crank * q[0].sin() + linkage.coupler * q[1].sin(),
    ];
    let from_centre = (angle - PI).rem_euclid(TAU);
    distance(point, linkage.point(angle, path(linkage, side, angle))) * from_centre.min(TAU - from_centre)
}

fn guess(linkage: &Linkage, side: f64, angle: f64) -> [f64; 3] {
    let point = linkage.point(angle, side);
    let along = |from: [f64; 2]| (point[1] - from[1]).atan2(point[0] - from[0]);
    [angle, along([linkage.crank * angle.cos(), linkage.crank * angle.sin()]), along([linkage.ground, 0.0])]
}

/// Angle less its phase (rad) at the position and at the last one that leads on, from the bytes of the saved state: an angle follows
/// its phase, in whatever turn.
fn behind_phases(stepper: &Stepper<Turning, f64, 3>) -> [f64; 2] {
    let saved = stepper.save();
    let mut page = [0_u8; 512];
    let length = saved.to_le_bytes_into(&mut page).expect("room");
    let (words, _) = page[..length].as_chunks::<8>();
    let number = |index: usize| f64::from_le_bytes(words[index]);
    let phase = Turning::<f64>::VARIABLES.iter().position(|entry| entry.name.starts_with("motor"));
    let (phase, values) = (phase.expect("a phase"), saved.values().len());
    // Behind version, numbers and name stand three turns; a place has its time, three coordinates and the values.
    [6, 6 + 4 + values].map(|place| number(place + 1) - number(place + 4 + phase))
}

#[test]
fn a_crank_that_ends_its_turns_at_a_change_point_keeps_its_assembly() {
    let mut random = Random::new(9);
    for linkage in [PARALLELOGRAM, STRETCHED] {
        for run in 0..20 {
            let side = if run % 2 == 0 { 1.0 } else { -1.0 };
            let start = random.between(1.5, 2.5);
            let steps = plan(start, &mut random);
            let Linkage { crank, coupler, rocker, ground, .. } = linkage;
            let design = Turning { crank, coupler, rocker, ground, ..Turning::default() };
            let mut alone: Stepper<_, f64, 3> =
                Stepper::assemble(design, guess(&linkage, side, start), 0.0).expect("an assembly");
            let mut lanes = Turning::<Lanes<f64, 2>>::default();
            (lanes.crank, lanes.coupler) = (Lanes([crank; 2]), Lanes([coupler; 2]));
            (lanes.rocker, lanes.ground) = (Lanes([rocker; 2]), Lanes([ground; 2]));
            let guesses = [guess(&linkage, side, start), guess(&linkage, -side, start)];
            let mut batch = Batch::assemble(lanes, &guesses, [0.0; 2]).expect("assemblies");
            for (index, (omega, h, angle)) in steps.into_iter().enumerate() {
                alone.change(|linkage| linkage.omega = omega);
                batch.change(|linkage| linkage.omega = Lanes([omega; 2]));
                let step = alone.advance(h);
                let t = alone.t();
                assert!(step.is_ok(), "{}, run {run}, step {index} to {angle}: {step:?}", linkage.name);
                assert!(
                    off(&linkage, side, alone.q(), angle) < 1e-9,
                    "{}, {run}, {index}: {angle}",
                    linkage.name
                );
                assert!(
                    (alone.q()[0] + alone.turns()[0] as f64 * TAU - angle).abs() < 1e-10,
                    "{run}, {index}"
                );
                let [at, from] = behind_phases(&alone);
                assert!((at - from).abs() < 1e-9, "{run}, {index}: {at} {from}");
                for (lane, step) in batch.advance_to([t; 2]).into_iter().enumerate() {
                    assert!(step.is_ok(), "{}, run {run}, lane {lane}, step {index}: {step:?}", linkage.name);
                    let q = batch.q().map(|q| q.0[lane]);
                    let side = if lane == 0 { side } else { -side };
                    assert!(
                        off(&linkage, side, &q, angle) < 1e-9,
                        "{}, {run}, {lane}, {index}",
                        linkage.name
                    );
                }
            }
        }
    }
}
