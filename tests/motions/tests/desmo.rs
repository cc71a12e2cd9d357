//! The rigid desmodromic valvetrain against a program that shares no code with the library: formulas of the synthesis, of the gap and
//! of the contact typed by hand, integrated by Dormand and Prince's method of order 5.
#![forbid(unsafe_code)]

use core::f64::consts::{PI, TAU};

#[path = "desmo/own.rs"]
mod own;

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_workbench::cams::follower::Direction;
use mechanisms::desmo::design::Curve;
use mechanisms::desmo::{Design, DesmoFriction};
use own::{Own, Sample};

type Method = Explicit<DormandPrince8, Projection>;
type Valvetrain = DesmoFriction<Curve, Curve>;

fn rpm(speed: f64) -> f64 {
    speed * PI / 30.0
}

/// The ready valvetrain at `speed` (rad/s) with this play (m), without friction where `is_smooth`.
fn valvetrain(speed: f64, [open_play, close_play]: [f64; 2], is_smooth: bool) -> Valvetrain {
    let law = Design::law(0.011, 160_f64.to_radians()).expect("a law");
    let design = Design::ready(law, Direction::CounterClockwise);
    let mut valvetrain: Valvetrain = design.mechanism().expect("a pair of cams").scene();
    (valvetrain.open_play, valvetrain.close_play, valvetrain.speed) = (open_play, close_play, speed);
    if is_smooth {
        (valvetrain.drag, valvetrain.dry) = (0.0, 0.0);
    }
    valvetrain
}

fn started(valvetrain: Valvetrain) -> Simulation<Valvetrain, Method, f64, 4, 1> {
    let run = Simulation::start_from_text(valvetrain, Method::default(), 0.0).expect("it starts");
    run.with_tolerance(Tolerance::new(1e-11))
}

/// Lift (m) and forces of nose, tip, seat, heel, fork (N) at equal distances of `turns`.
fn moved(valvetrain: &Valvetrain, turns: f64, samples: u32) -> Vec<Sample> {
    let mut run = started(valvetrain.clone());
    let mut found = Vec::new();
    run.watch(turns * TAU / valvetrain.speed, samples, |run| {
        let outputs = run.outputs();
        let forces = core::array::from_fn(|index| outputs.as_ref()[index].value);
        found.push(Sample { lift: run.q()[2], forces });
    })
    .expect("it moves");
    found
}

fn peak(samples: &[Sample], force: usize) -> f64 {
    samples.iter().fold(0.0, |most: f64, sample| most.max(sample.forces[force]))
}

/// Lifts within `bound` (m) of each other, and the largest value of each force within 1e-4 of itself.
fn assert_agree(name: &str, [found, expected]: [&[Sample]; 2], bound: f64) {
    let apart = found.iter().zip(expected).map(|(a, b)| (a.lift - b.lift).abs());
    let lift = apart.fold(0.0, f64::max);
    println!("desmo, {name}: lift {lift:.1e} m of {bound:.0e}");
    assert_eq!(found.len(), expected.len());
    assert!(lift < bound, "{lift:e}");
    for force in 0..5 {
        let [found, expected] = [found, expected].map(|samples| peak(samples, force));
        println!("  peak {force}: {found:.3} N, {:.1e} of 1e-4", found / expected - 1.0);
        assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
    }
}

#[test]
fn without_play_the_valve_moves_as_formulas_typed_by_hand() {
    const SAMPLES: u32 = 3600;
    for speed in [5000.0, 9000.0] {
        let ours = moved(&valvetrain(rpm(speed), [0.0; 2], true), 1.0, SAMPLES);
        let own = Own::lecture(rpm(speed), [0.0; 2], [0.0; 2]).moved(1.0, SAMPLES);
        assert_agree(&format!("{speed}/min, no play"), [&ours, &own], 1e-9);
    }
}

#[test]
fn with_play_and_friction_the_first_impacts_are_those_of_formulas_typed_by_hand() {
    // The valve is opened, and the closer has caught it: to full lift and 20° on.
    const SAMPLES: u32 = 4000;
    let (speed, play) = (rpm(9000.0), [1e-4, 3e-5]);
    let turns = 200.0 / 360.0;
    let ours = moved(&valvetrain(speed, play, false), turns, SAMPLES);
    let own = Own::lecture(speed, play, [2.0, 3.0]).moved(turns, SAMPLES);
    assert_agree("9000/min, with play", [&ours, &own], 1e-8);
}

#[test]
fn the_cams_work_is_the_change_of_energy_and_what_contacts_and_guide_take() {
    for (speed, play) in [(9000.0, [1e-4, 3e-5]), (5000.0, [0.0; 2])] {
        let mut run = started(valvetrain(rpm(speed), play, false));
        let energy = |energy: mbs_runtime::Energy<f64>| energy.kinetic + energy.potential;
        let before = energy(run.balance().energy);
        let (mut most, mut defect) = (0.0_f64, 0.0_f64);
        run.watch(TAU / rpm(speed), 360, |run| {
            let loads = run.loads();
            let [torque, work, taken] = [0, 1, 2].map(|index| loads.as_ref()[index]);
            most = most.max(work.abs());
            defect = defect.max((work - (energy(run.balance().energy) - before) - taken).abs());
            // The torque that the drive needs is that of the forces on both cams.
            assert!(torque.is_finite());
        })
        .expect("it moves");
        println!(
            "desmo, {speed}/min, {play:?}: work of the cam {most:.4} J, defect {:.1e} of 1e-9",
            defect / most
        );
        assert!(most > 0.1 && defect < 1e-9 * most, "{defect:e} of {most}");
    }
}
