//! Steps of several mechanisms at once are those of each alone.

use mbs_runtime::{Batch, Failure, FailureKind, Kinematic, Lanes, Mechanism, Real, Stepper, mechanism};

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
            assert_eq!(found.evaluations, expected.evaluations, "{lane}");
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
    assert!(
        matches!(steps[2], Err(Failure { kind: FailureKind::NotConverged { .. }, .. })),
        "{:?}",
        steps[2]
    );
    assert!([0, 1, 3].iter().all(|lane| steps[*lane].is_ok()));
    assert_eq!((batch.q().map(|q| q.0[2]), batch.t().0), (before, [0.02, 0.02, 0.01, 0.02]));
    // A time that is none fails alone too.
    let steps = batch.advance_to([0.03, f64::NAN, 0.03, 0.03]);
    assert!(matches!(steps[1], Err(Failure { kind: FailureKind::NonFinite { name: "t", .. }, .. })));
    assert!(steps[0].is_ok() && steps[3].is_ok());
    // Put right, it goes on.
    batch.change(|mechanism| mechanism.crank = Lanes([0.1, 0.08, 0.12, 0.05]));
    assert!(batch.advance_to([0.04; 4]).iter().all(Result::is_ok));
}

#[test]
fn lanes_that_cannot_be_assembled_are_out_until_they_can() {
    let mut mechanism = lanes();
    mechanism.crank = Lanes([0.1, 5.0, 0.12, 0.05]);
    let mut batch = Batch::assemble_each(mechanism, &[GUESS; 4], [0.0; 4]).expect("three can be assembled");
    let out = batch.failures().map(|failure| failure.is_some());
    assert_eq!(out, [false, true, false, false]);
    assert!(batch.stepper(1).is_none() && batch.stepper(4).is_none() && batch.q()[1].0[1].is_nan());
    let steps = batch.advance_to([0.01; 4]);
    assert!(
        matches!(steps[1], Err(Failure { kind: FailureKind::NotAssemblable { .. }, .. })),
        "{:?}",
        steps[1]
    );
    assert!([0, 2, 3].iter().all(|lane| steps[*lane].is_ok()));
    assert!(batch.revive(1, &GUESS, 0.01).is_err(), "it is as long as before");
    batch.change(|mechanism| mechanism.crank = Lanes([0.1, 0.08, 0.12, 0.05]));
    batch.revive(1, &GUESS, 0.01).expect("it closes now");
    assert!(batch.advance_to([0.02; 4]).iter().all(Result::is_ok));
    // Where all are out there is no batch, but a failure each.
    mechanism.crank = Lanes([5.0; 4]);
    let Err(failures) = Batch::assemble_each(mechanism, &[GUESS; 4], [0.0; 4]) else { panic!("none closes") };
    assert!(
        failures
            .iter()
            .all(|failure| matches!(failure, Failure { kind: FailureKind::NotAssemblable { .. }, .. }))
    );
}

#[test]
fn a_lane_that_is_revived_is_itself_whichever_it_is() {
    let mechanism = lanes();
    let assembled =
        || Batch::assemble(mechanism, &[GUESS; 4], [0.0; 4]).map_err(|(_, f)| f).expect("they assemble");
    for lane in 0..4 {
        let (mut batch, mut others) = (assembled(), assembled());
        for k in 1..=5 {
            let t = [0.01, 0.012, 0.014, 0.016].map(|h| h * f64::from(k));
            assert!(batch.advance_to(t).iter().chain(&others.advance_to(t)).all(Result::is_ok));
        }
        let t = 0.03 + 0.001 * lane as f64;
        batch.revive(lane, &GUESS, t).expect("it assembles");
        let mut alone = Stepper::assemble(mechanism.lane(lane), GUESS, t).expect("it assembles");
        equal(&batch.stepper(lane).expect("it is in"), &alone);
        alone.advance_to(0.1).expect("it moves on");
        assert!(batch.advance_to([0.1; 4]).iter().chain(&others.advance_to([0.1; 4])).all(Result::is_ok));
        for (other, expected) in (0..4).map(|other| (other, others.stepper(other).expect("it is in"))) {
            let found = batch.stepper(other).expect("it is in");
            equal(&found, if other == lane { &alone } else { &expected });
        }
    }
}

#[test]
fn a_retired_lane_stays_where_it_is_and_answers_its_failure() {
    let mut batch =
        Batch::assemble(lanes(), &[GUESS; 4], [0.0; 4]).map_err(|(_, f)| f).expect("they assemble");
    batch.change(|mechanism| mechanism.crank = Lanes([0.1, 0.08, 5.0, 0.05]));
    let Err(failure) = batch.advance_to([0.01; 4])[2] else { panic!("the crank is too long") };
    batch.retire(2, failure);
    let before = batch.q().map(|q| q.0[2]);
    for k in 2..=50 {
        let steps = batch.advance_to([0.01 * f64::from(k); 4]);
        assert!([0, 1, 3].iter().all(|lane| steps[*lane].is_ok()));
        assert_eq!(steps[2].map(|_| ()), Err(failure));
    }
    assert_eq!((batch.q().map(|q| q.0[2]), batch.t().0[2]), (before, 0.0));
}

mechanism! {
    /// Four unknowns that hang together.
    mechanism Ring;
    param amount: 1 = 0.2;
    coord x: [1; 4] = 0.5;
    constraint ring { for i in 0..3 { x[i] + amount*sin(x[i + 1]) == sin(t/1s + i); } }
    constraint last { x[3] + amount*sin(x[0]) == cos(t/1s); }
}

mechanism! {
    /// More blocks than are written one by one.
    mechanism Chain;
    const LOOPS: 1 = 60;
    coord p: [m; LOOPS + 1, 2] = 0.7;
    drive motor: p[0, 0] == 0.5m*sin(TAU*t/1s);
    constraint uprights { for i in 0..LOOPS + 1 { p[i, 0]^2 + p[i, 1]^2 == (1m)^2; } }
    constraint couplers {
        for i in 0..LOOPS { (1m + p[i + 1, 0] - p[i, 0])^2 + (p[i + 1, 1] - p[i, 1])^2 == (1m)^2; }
    }
}

mechanism! {
    /// A slider-crank whose motor has a speed, its crank an angle that turns for days.
    mechanism Press;
    param omega: rad/s = 40;
    coord theta: turn = 0.3;
    coord phi: rad = 0;
    coord x: m = 0.2;
    constraint closure { 50mm*unit(theta) + 180mm*unit(phi) == [x, 0]; }
    drive motor: rate(theta) == omega;
    branch ahead: cos(phi) > 0;
}

mechanism! {
    /// The same with a speed that varies, and an angle that grows.
    mechanism Pump;
    param omega: rad/s = 40;
    coord theta: rad = 0.3;
    coord phi: rad = 0;
    coord x: m = 0.2;
    constraint closure { 50mm*unit(theta) + 180mm*unit(phi) == [x, 0]; }
    drive motor: rate(theta) == omega*(1 + 0.5*sin(9*t/1s));
    branch ahead: cos(phi) > 0;
}

/// Eight lanes, each with steps of its own length, against eight mechanisms alone; `rounding`: relative.
pub fn assert_as_alone<S, R: Real, const N: usize>(mechanism: S, guess: [f64; N], rounding: f64)
where
    S: Kinematic<Lanes<R, 8>, N>,
    S::Lane: Kinematic<R, N>,
{
    let guess = guess.map(R::constant);
    let mut alone: [_; 8] = core::array::from_fn(|lane| {
        Stepper::assemble(mechanism.lane(lane), guess, R::constant(0.0)).expect("it assembles")
    });
    let batch = Batch::assemble(mechanism, &[guess; 8], [R::constant(0.0); 8]);
    let mut batch = batch.map_err(|(_, failure)| failure).expect("they assemble");
    for k in 1..=60 {
        let times: [R; 8] =
            core::array::from_fn(|lane| R::constant(f64::from(k) * 8e-4 * (lane as f64 + 1.0)));
        let found = batch.advance_to(times);
        for ((found, stepper), t) in found.iter().zip(&mut alone).zip(times) {
            let expected = stepper.advance_to(t).expect("it moves on");
            let found = found.as_ref().expect("it moves on");
            // Circles and lines step by second derivatives alone, as lanes by Newton's method, which may evaluate once more.
            let more = i64::from(found.evaluations) - i64::from(expected.evaluations);
            // At small margins a mechanism alone evaluates once more, so that its step closes finely.
            let closes_finely = more == -1 && stepper.margin().to_f64() < 0.27;
            assert!(more == 0 || (S::HAS_CIRCLES && more == 1) || closes_finely, "step {k}: {more}");
        }
    }
    for (lane, alone) in alone.iter().enumerate() {
        let batch = batch.stepper(lane).expect("a lane");
        assert_eq!((batch.turns(), batch.t().to_f64()), (alone.turns(), alone.t().to_f64()));
        for (found, expected) in
            [(batch.q(), alone.q()), (batch.qd(), alone.qd()), (batch.qdd(), alone.qdd())]
        {
            for (found, expected) in found.iter().zip(expected) {
                let (found, expected) = (found.to_f64(), expected.to_f64());
                assert!((found - expected).abs() <= rounding * (1.0 + expected.abs()), "{found} {expected}");
            }
        }
    }
}

#[test]
fn eight_lanes_go_as_each_alone_also_in_large_blocks_long_chains_and_single_precision() {
    let uprights = core::array::from_fn(|k| (k % 2) as f64);
    assert_as_alone::<_, f64, 3>(FourBar::default(), GUESS, ROUND_OFF);
    assert_as_alone::<_, f64, 4>(Ring::default(), [0.0, 0.7, 0.7, 0.8], ROUND_OFF);
    assert_as_alone::<_, f64, 122>(Chain::default(), uprights, 1e-10);
    assert_as_alone::<_, f32, 3>(FourBar::default(), GUESS, 1e-4);
    assert_as_alone::<_, f32, 4>(Ring::default(), [0.0, 0.7, 0.7, 0.8], 1e-4);
}

#[test]
fn eight_lanes_hold_their_phases_and_count_their_turns_as_each_alone() {
    let guess = [0.3, 0.0, 0.2];
    let speeds = Lanes([40.0, 35.0, -20.0, 0.0, 40.0, 45.0, 50.0, 60.0]);
    assert_as_alone::<_, f64, 3>(Press { omega: speeds, ..Press::default() }, guess, ROUND_OFF);
    assert_as_alone::<_, f64, 3>(Pump { omega: speeds, ..Pump::default() }, guess, ROUND_OFF);
    assert_as_alone::<_, f32, 3>(Press::default(), guess, 1e-4);
}

#[test]
fn a_lane_that_fails_or_changes_speed_keeps_the_phase_that_it_had() {
    let guess = [[0.3, 0.0, 0.2], [6.1, 0.0, 0.23]];
    let batch = Batch::assemble(Press::<Lanes<f64, 2>>::default(), &guess, [0.0; 2]);
    let mut batch = batch.map_err(|(_, failure)| failure).expect("they assemble");
    let (mut angles, mut speeds) = ([0.3, 6.1], [40.0, 40.0]);
    for k in 1..=200 {
        // The first lane fails in each tenth step and makes up for it in the next.
        let fails = k % 10 == 0;
        let t = 1e-3 * f64::from(k);
        let before = batch.t().0;
        let steps = batch.advance_to([if fails { f64::NAN } else { t }, t]);
        assert_eq!((steps[0].is_err(), steps[1].is_ok()), (fails, true), "{k}");
        for lane in 0..2 {
            angles[lane] += speeds[lane] * if lane == 0 && fails { 0.0 } else { t - before[lane] };
            let stepper = batch.stepper(lane).expect("a lane");
            let found = stepper.q()[0] + core::f64::consts::TAU * stepper.turns()[0] as f64;
            assert!(
                (found - angles[lane]).abs() < 1e-12 * f64::from(k),
                "{k} {lane}: {found} {}",
                angles[lane]
            );
            assert!(stepper.q()[0].abs() < 3.2 && (stepper.qd()[0] - speeds[lane]).abs() < 1e-9);
        }
        if k % 15 == 0 {
            speeds = [60.0 - speeds[0], -speeds[1]];
            batch.change(|press| press.omega = Lanes(speeds));
        }
    }
    let turns = [0, 1].map(|lane| batch.stepper(lane).expect("a lane").turns()[0]);
    assert!(turns[0] > 0, "{turns:?}");
}
