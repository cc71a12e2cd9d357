//! Many turns with play, and the scenes beside each other.

use core::f64::consts::TAU;

use mbs_runtime::dynamics::{Simulation, Tolerance};
use mbs_workbench::cams::follower::Direction;
use mechanisms::desmo::design::Curve;
use mechanisms::desmo::{Design, DesmoOrdinary, DesmoRigid};

use super::own::{Own, Sample};
use super::{Method, moved, peak, rpm, started, valvetrain};

/// 5 %, median and 95 %.
fn quantiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    [0.05, 0.5, 0.95].map(|share| {
        let place = share * (values.len() - 1) as f64;
        let below = place.floor() as usize;
        let above = (below + 1).min(values.len() - 1);
        values[below] + (place - below as f64) * (values[above] - values[below])
    })
}

/// Peaks of each turn from the third on.
fn peaks(samples: &[Sample], turns: usize, force: usize) -> impl Iterator<Item = f64> {
    samples.chunks(samples.len() / turns).skip(2).map(move |turn| peak(turn, force))
}

#[test]
fn with_play_the_envelope_of_perturbed_runs_is_that_of_formulas_typed_by_hand() {
    const TURNS: usize = 4;
    const SAMPLES: u32 = 2000 * TURNS as u32;
    /// Roberts' sequence in three dimensions.
    const GOLDEN: f64 = 1.220_744_084_605_759_5;
    let speed = rpm(9000.0);
    let mut all: [[Vec<f64>; 2]; 5] = Default::default();
    for run in 0..32 {
        let spread = |axis| 0.8 + 0.4 * (0.5 + f64::from(run) * GOLDEN.powi(-axis)).fract();
        let contact = [5e10 * spread(1), 1.5 * spread(2)];
        let play = [1e-4 * spread(3), 3e-5 * spread(3)];
        let mut perturbed = valvetrain(speed, play, false);
        [perturbed.stiffness, perturbed.damping] = contact;
        let ours = moved(&perturbed, TURNS as f64, SAMPLES);
        let own = Own::lecture(speed, play, [2.0, 3.0]).with_contact(contact);
        let own = own.moved(TURNS as f64, SAMPLES);
        for (force, [found, expected]) in all.iter_mut().enumerate() {
            found.extend(peaks(&ours, TURNS, force));
            expected.extend(peaks(&own, TURNS, force));
        }
    }
    for (force, both) in all.into_iter().enumerate() {
        let [found, expected] = both.map(quantiles);
        println!("desmo, force {force}: {found:.0?} N, by hand {expected:.0?} N");
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
        }
    }
}

#[test]
fn a_scene_without_play_and_friction_moves_as_the_whole_text_with_zeros() {
    let whole = valvetrain(rpm(9000.0), [0.0; 2], true);
    let rigid: DesmoRigid<Curve, Curve> = whole.clone().scene();
    let run = Simulation::start_from_text(rigid, Method::default(), 0.0).expect("it starts");
    let mut rigid = run.with_tolerance(Tolerance::new(1e-11));
    let mut whole = started(whole);
    let mut most = 0.0_f64;
    for step in 1..=90 {
        let t = TAU / rpm(9000.0) * f64::from(step) / 90.0;
        rigid.advance_to(t).expect("it moves");
        whole.advance_to(t).expect("it moves");
        most = most.max((rigid.q()[2] - whole.q()[2]).abs());
    }
    println!("desmo, scene beside zeros: {most:.1e} m of 1e-10");
    assert!(most < 1e-10, "{most:e}");
}

#[test]
fn a_valve_spring_keeps_the_finger_on_its_cam_at_5000_and_not_at_9000() {
    let law = Design::law(0.011, 160_f64.to_radians()).expect("a law");
    let design = Design::ready(law, Direction::CounterClockwise);
    let lost = |speed: f64| {
        let mut spring: DesmoOrdinary<Curve, Curve> = design.mechanism().expect("cams").scene();
        (spring.speed, spring.open_play) = (speed, 0.0);
        let run = Simulation::start_from_text(spring, Method::default(), 0.0).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(1e-10));
        // Above a millimetre of the law, how far the finger's pad leaves the valve where its cam wants it.
        let mut most = 0.0_f64;
        run.watch(TAU / speed, 720, |run| {
            let [wanted] = design.law.jet::<f64>(run.q()[0]).first_chunk().copied().expect("a lift");
            if wanted > 1e-3 {
                most = most.max(run.q()[2] - wanted);
            }
        })
        .expect("it moves");
        most
    };
    let [slow, fast] = [5000.0, 9000.0].map(|speed| lost(rpm(speed)));
    println!("desmo, valve spring: beyond its law by {slow:.1e} m at 5000/min, {fast:.1e} m at 9000/min");
    assert!(slow < 2e-5 && fast > 5e-4, "{slow:e} {fast:e}");
}
