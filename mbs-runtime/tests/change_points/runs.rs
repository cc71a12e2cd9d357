//! Two hundred runs of each kind, and not one in the wrong assembly.

use mbs_runtime::{Failure, FailureKind, Stepper};

use crate::linkage::{InAngles, InPoints, Linkage, Moving, PARALLELOGRAM, STRETCHED, distance};
use crate::plan::{Kind, Plan, Random};

/// Runs of each kind.
const RUNS: u64 = 200;

/// Nearer than this (m) the two assemblies are one within the accuracy of a position at a change point: a residual of
/// 64 ε leaves its root open, 1.2e-7.
const APART: f64 = 1e-6;

/// Crank angle (rad) from the change point within which rates may be refused: the margin falls with the angle, and is
/// below 32 √ε = 4.8e-7 there.
const REFUSED: f64 = 1e-6;

/// Results of one kind of runs.
#[derive(Debug, Default)]
struct Tally {
    samples: u32,
    wrong: u32,
    passages: u32,
    unreported: u32,
    refused: u32,
}

fn run<S: Moving>(linkage: &Linkage, kind: Kind, seed: u64, tally: &mut Tally) {
    let mut random = Random::new(seed);
    let plan = Plan::of(kind, &mut random);
    let at = |relative: f64| linkage.centre + relative;
    let side = if seed.is_multiple_of(2) { 1.0 } else { -1.0 };
    let mut moving = S::assembled(linkage, at(plan.start), side);
    let (mut last, mut crossed) = (plan.start, 0);
    for (mut signal, t) in plan.samples {
        let relative = signal.value;
        signal.value = at(relative);
        tally.samples += 1;
        match moving.follow(signal, t) {
            Ok(()) => {
                let [right, wrong] =
                    [side, -side].map(|side| distance(moving.point(), linkage.point(at(relative), side)));
                tally.wrong += u32::from(linkage.separation(at(relative)) > APART && wrong < right);
                crossed += u32::from(last * relative < 0.0);
                last = relative;
            }
            Err(Failure { kind: FailureKind::Singular { .. }, .. }) if relative.abs() < REFUSED => {
                tally.refused += 1
            }
            Err(other) => panic!("{}, {kind:?}, seed {seed}, {relative}: {other}", linkage.name),
        }
    }
    tally.passages += crossed;
    tally.unreported += crossed.abs_diff(moving.passages());
}

fn no_run_is_wrong(kind: Kind) {
    for linkage in [PARALLELOGRAM, STRETCHED] {
        let (mut angles, mut points) = (Tally::default(), Tally::default());
        for seed in 0..RUNS {
            run::<Stepper<InAngles, f64, 3>>(&linkage, kind, seed, &mut angles);
            run::<Stepper<InPoints, f64, 4>>(&linkage, kind, seed, &mut points);
        }
        for (coordinates, tally) in [("angles", angles), ("points", points)] {
            println!("{kind:?}, {}, {coordinates}: {tally:?}", linkage.name);
            assert!(u64::from(tally.passages) >= RUNS, "{tally:?}");
            assert_eq!((tally.wrong, tally.unreported), (0, 0), "{}: {tally:?}", linkage.name);
        }
    }
}

#[test]
fn a_steady_crank_keeps_its_assembly_and_reports_every_passage() {
    no_run_is_wrong(Kind::Steady);
}

#[test]
fn a_jittering_encoder_keeps_the_assembly_and_reports_every_passage() {
    no_run_is_wrong(Kind::Jitter);
}

#[test]
fn a_dwell_at_the_point_keeps_the_assembly_and_reports_every_passage() {
    no_run_is_wrong(Kind::Dwell);
}

#[test]
fn a_reversal_at_the_point_keeps_the_assembly_and_reports_every_passage() {
    no_run_is_wrong(Kind::Reversal);
}

#[test]
fn a_doubled_sample_keeps_the_assembly_and_reports_every_passage() {
    no_run_is_wrong(Kind::DoubledSample);
}
