//! Steps of several mechanisms at once are those of each alone.

use mbs_runtime::{Batch, Failure, Kinematic, Lanes, Mechanism, Stepper, mechanism};

mechanism! {
    /// A four-bar whose crank may be too long.
    mechanism FourBar;
    param crank: m = 0.1;
    param omega: rad/s = TAU;
    coord phi1: rad;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;
    let tip = crank*unit(phi1) + 0.25m*unit(phi2);
    constraint closure { tip == [0.3m, 0] + 0.2m*unit(phi3); }
    drive motor: phi1 == omega*t;
    branch open: sin(phi3 - phi2) > 0;
}

type Four = Lanes<f64, 4>;

/// Round-off of a turn of steps, in the reference metric.
const ROUND_OFF: f64 = 1e-12;

fn lanes() -> FourBar<Four> {
    FourBar { crank: Lanes([0.1, 0.08, 0.12, 0.05]), ..FourBar::default() }
}

const GUESS: [f64; 3] = [0.0, 0.9, 1.8];

fn equal<S: Kinematic<f64, 3>>(batch: &Stepper<S, f64, 3>, alone: &Stepper<S, f64, 3>) {
    let pairs = [(batch.q(), alone.q()), (batch.qd(), alone.qd()), (batch.qdd(), alone.qdd())];
    for (found, expected) in pairs {
        for (found, expected) in found.iter().zip(expected) {
            let scale = 1.0 + expected.abs();
            assert!((found - expected).abs() < ROUND_OFF * scale, "{found} {expected}");
        }
    }
    assert_eq!(
        (batch.t(), batch.passages(), batch.signature()),
        (alone.t(), alone.passages(), alone.signature())
    );
    assert!((batch.margin() - alone.margin()).abs() < ROUND_OFF);
}

#[test]
fn designs_side_by_side_turn_as_each_alone() {
    let mechanism = lanes();
    let mut batch =
        Batch::assemble(mechanism, &[GUESS; 4], [0.0; 4]).map_err(|(_, f)| f).expect("they assemble");
    let mut alone: Vec<_> = (0..4)
        .map(|lane| Stepper::assemble(mechanism.lane(lane), GUESS, 0.0).expect("it assembles"))
        .collect();
    for k in 1..=200 {
        let t = f64::from(k) * 5e-3;
        let found = batch.advance_to([t; 4]);
        for (lane, (found, stepper)) in found.iter().zip(&mut alone).enumerate() {
            let expected = stepper.advance_to(t).expect("it moves on");
            let found = found.as_ref().expect("it moves on");
            assert!(found.evaluations >= expected.evaluations, "{lane}");
        }
    }
    for (lane, alone) in alone.iter().enumerate() {
        equal(&batch.stepper(lane).expect("a lane"), alone);
    }
}

#[test]
fn phases_of_a_turn_go_side_by_side() {
    let mechanism: FourBar<Four> = FourBar::default();
    let starts = [0.0, 0.25, 0.5, 0.75];
    let guesses = starts.map(|t| {
        let mut stepper = Stepper::assemble(FourBar::default(), GUESS, 0.0).expect("it assembles");
        for k in 1..=100 {
            stepper.advance_to(t * f64::from(k) / 100.0).expect("it moves on");
        }
        *stepper.q()
    });
    let mut batch = Batch::assemble(mechanism, &guesses, starts).map_err(|(_, f)| f).expect("they assemble");
    for k in 1..=50 {
        let times = starts.map(|start| start + 5e-3 * f64::from(k));
        assert!(batch.advance_to(times).iter().all(Result::is_ok));
    }
    // Where one phase ends the next one began.
    let end = batch.stepper(0).expect("a lane");
    for (found, expected) in end.q().iter().zip(guesses[1]) {
        assert!((found - expected).abs() < ROUND_OFF, "{found} {expected}");
    }
}

#[test]
fn a_lane_fails_alone_with_its_own_failure_and_stays_what_it_was() {
    let mut batch =
        Batch::assemble(lanes(), &[GUESS; 4], [0.0; 4]).map_err(|(_, f)| f).expect("they assemble");
    batch.advance_to([0.01; 4]).iter().for_each(|step| assert!(step.is_ok()));
    // The third crank becomes too long to be closed.
    batch.change(|mechanism| mechanism.crank = Lanes([0.1, 0.08, 5.0, 0.05]));
    let before = batch.q().map(|q| q.0[2]);
    let steps = batch.advance_to([0.02; 4]);
    assert!(matches!(steps[2], Err(Failure::NotConverged { .. })), "{:?}", steps[2]);
    assert!([0, 1, 3].iter().all(|lane| steps[*lane].is_ok()));
    assert_eq!((batch.q().map(|q| q.0[2]), batch.t().0), (before, [0.02, 0.02, 0.01, 0.02]));
    // A time that is none fails alone too.
    let steps = batch.advance_to([0.03, f64::NAN, 0.03, 0.03]);
    assert!(matches!(steps[1], Err(Failure::NonFinite { name: "t", .. })));
    assert!(steps[0].is_ok() && steps[3].is_ok());
    // Put right, it goes on.
    batch.change(|mechanism| mechanism.crank = Lanes([0.1, 0.08, 0.12, 0.05]));
    assert!(batch.advance_to([0.04; 4]).iter().all(Result::is_ok));
}
