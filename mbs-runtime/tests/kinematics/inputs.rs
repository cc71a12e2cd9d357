//! Inputs set before each step, in one mechanism and in lanes: nothing they do may change the assembly.

use mbs_runtime::{Batch, Failure, FailureKind, Kinematic, Lanes, Signal, Stepper, mechanism};

mechanism! {
    /// A crank-rocker that goes where it is told.
    mechanism Commanded;
    param crank: m = 0.1;
    input theta: rad, rates;
    coord phi1: rad;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;
    constraint closure { crank*unit(phi1) + 0.25m*unit(phi2) == [0.3m, 0] + 0.2m*unit(phi3); }
    drive motor: phi1 == theta;
}

mechanism! {
    /// The same, whose other assembly is refused.
    mechanism Guarded;
    param crank: m = 0.1;
    input theta: rad, rates;
    coord phi1: rad;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;
    constraint closure { crank*unit(phi1) + 0.25m*unit(phi2) == [0.3m, 0] + 0.2m*unit(phi3); }
    drive motor: phi1 == theta;
    branch open: sin(phi3 - phi2) > 0;
}

mechanism! {
    /// One that turns as fast as it is told.
    mechanism Spun;
    input speed: rad/s;
    coord phi1: turn;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;
    constraint closure { 0.1m*unit(phi1) + 0.25m*unit(phi2) == [0.3m, 0] + 0.2m*unit(phi3); }
    drive motor: rate(phi1) == speed;
}

const GUESS: [f64; 3] = [0.0, 0.9, 1.8];
const LANES: usize = 8;
type Eight = Lanes<f64, LANES>;

/// Round-off of one position and its rates, relative to their size: each step solves them anew.
const ROUND_OFF: f64 = 1e-11;

/// Time of a step (s).
const STEP: f64 = 0.02;

/// A sequence of numbers in (−1, 1) that look random.
/// Source: Knuth 1997, The Art of Computer Programming 2, §3.3.4, table 1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Signal that a caller may give a crank at `theta` next: a step on, with its rates or without, a jump, or rates that belong to
/// another position; seldom farther than any path is followed.
fn told(theta: f64, numbers: &mut Numbers) -> Signal<f64> {
    let (rate, kind) = (10.0 * numbers.next(), 10.0 * numbers.next().abs());
    let none = Signal { value: theta, rate: 0.0, acceleration: 0.0 };
    match kind as u32 {
        0..=3 => Signal { value: theta + rate * STEP, rate, ..none },
        4 | 5 => Signal { value: theta + rate * STEP, ..none },
        6 => none,
        7 => Signal { value: theta + 0.3 * numbers.next(), rate, ..none },
        8 => Signal { value: theta + 1.5 * numbers.next(), rate: 3.0 * rate, acceleration: 100.0 * rate },
        _ => Signal { value: theta + 1e3 * numbers.next(), ..none },
    }
}

fn assert_equal<S: Kinematic<f64, 3>>(found: &Stepper<S, f64, 3>, alone: &Stepper<S, f64, 3>) {
    for (found, expected) in [(found.q(), alone.q()), (found.qd(), alone.qd()), (found.qdd(), alone.qdd())] {
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() <= ROUND_OFF * (1.0 + expected.abs()), "{found} {expected}");
        }
    }
    let said = |stepper: &Stepper<S, f64, 3>| (stepper.t(), stepper.passages(), stepper.signature());
    assert_eq!(said(found), said(alone));
}

#[test]
fn lanes_follow_random_inputs_as_each_alone_and_fail_alone() {
    let assembled = Batch::assemble(Guarded::<Eight>::default(), &[GUESS; LANES], [0.0; LANES]);
    let mut batch = assembled.map_err(|(_, failure)| failure).expect("they assemble");
    let mut alone: [_; LANES] =
        core::array::from_fn(|_| Stepper::assemble(Guarded::default(), GUESS, 0.0).expect("it assembles"));
    let (mut numbers, mut failed) = (Numbers(7), 0);
    for k in 1..=120 {
        let signals: [Signal<f64>; LANES] =
            core::array::from_fn(|lane| told(batch.q()[0].0[lane], &mut numbers));
        // Now and then a crank that closes no loop.
        let cranks: [f64; LANES] = core::array::from_fn(|lane| match numbers.next() {
            chance if chance > 0.95 => 5.0,
            chance => 0.09 + 0.01 * chance * lane as f64 / 8.0,
        });
        batch.change(|four_bar| {
            let of = |part: fn(&Signal<f64>) -> f64| Lanes(signals.each_ref().map(part));
            let theta = Signal {
                value: of(|signal| signal.value),
                rate: of(|signal| signal.rate),
                acceleration: of(|signal| signal.acceleration),
            };
            (four_bar.theta, four_bar.crank) = (theta, Lanes(cranks));
        });
        let t = f64::from(k) * STEP;
        let steps = batch.advance_to([t; LANES]);
        for (lane, (step, alone)) in steps.iter().zip(&mut alone).enumerate() {
            alone.change(|four_bar| (four_bar.theta, four_bar.crank) = (signals[lane], cranks[lane]));
            let expected = alone.advance_to(t);
            let kinds = (
                step.map_err(|f| core::mem::discriminant(&f.kind)).err(),
                expected.map_err(|f| core::mem::discriminant(&f.kind)).err(),
            );
            assert_eq!(kinds.0, kinds.1, "{k} {lane}: {step:?} {expected:?}");
            failed += u32::from(expected.is_err());
            let found = batch.stepper(lane).expect("a lane");
            assert_equal(&found, alone);
            let [_, phi2, phi3] = *found.q();
            assert!((phi3 - phi2).sin() > 0.0, "{k} {lane}");
        }
    }
    assert!(failed > 20, "cranks that close no loop and jumps without a way: {failed}");
}

#[test]
fn inputs_that_jump_or_tell_wrong_rates_never_change_the_assembly_silently() {
    let assembled = Batch::assemble(Commanded::<Eight>::default(), &[GUESS; LANES], [0.0; LANES]);
    let mut batch = assembled.map_err(|(_, failure)| failure).expect("they assemble");
    let mut alone = Stepper::assemble(Commanded::default(), GUESS, 0.0).expect("it assembles");
    let (mut numbers, signature) = (Numbers(11), alone.signature());
    for k in 1..=500 {
        // Rates that foresee up to 1 rad of anything, values that jump up to 1.5 rad.
        let theta = |now: f64, numbers: &mut Numbers| {
            [now + 1.5 * numbers.next(), 50.0 * numbers.next(), 1e3 * numbers.next()]
        };
        let told: [[f64; 3]; LANES] = core::array::from_fn(|lane| theta(batch.q()[0].0[lane], &mut numbers));
        let of = |part: usize| Lanes(told.map(|theta| theta[part]));
        batch.change(|four_bar| four_bar.theta = Signal { value: of(0), rate: of(1), acceleration: of(2) });
        let [value, rate, acceleration] = theta(alone.q()[0], &mut numbers);
        alone.change(|four_bar| four_bar.theta = Signal { value, rate, acceleration });
        let t = f64::from(k) * STEP;
        alone.advance_to(t).expect("a crank goes everywhere");
        assert!(batch.advance_to([t; LANES]).iter().all(Result::is_ok), "{k}");
        let lanes = (0..LANES).map(|lane| batch.stepper(lane).expect("a lane"));
        for stepper in lanes.chain([alone]) {
            let [_, phi2, phi3] = *stepper.q();
            assert!((phi3 - phi2).sin() > 0.0 && stepper.signature() == signature, "{k}");
            assert_eq!((stepper.passages(), stepper.closure_error() < 1e-12), (0, true));
        }
    }
}

#[test]
fn an_input_of_one_lane_that_is_no_number_leaves_the_others_as_they_are() {
    let assembled = Batch::assemble(Commanded::<Eight>::default(), &[GUESS; LANES], [0.0; LANES]);
    let mut batch = assembled.map_err(|(_, failure)| failure).expect("they assemble");
    let tell = |batch: &mut Batch<Commanded<Eight>, f64, LANES, 3>, t: f64, third: f64| {
        let constant = |value: f64| Lanes([value; LANES]);
        let mut theta = Signal { value: constant(t), rate: constant(1.0), acceleration: constant(0.0) };
        theta.value.0[3] = third;
        batch.change(|four_bar| four_bar.theta = theta);
    };
    for k in 1..=10 {
        let t = f64::from(k) * STEP;
        tell(&mut batch, t, t);
        assert!(batch.advance_to([t; LANES]).iter().all(Result::is_ok));
    }
    let (mut sound, before) = (batch.clone(), batch.q().map(|q| q.0[3]));
    for (k, broken) in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY].into_iter().enumerate() {
        let t = (11 + k) as f64 * STEP;
        tell(&mut batch, t, broken);
        tell(&mut sound, t, t);
        let steps = batch.advance_to([t; LANES]);
        assert!(sound.advance_to([t; LANES]).iter().all(Result::is_ok));
        assert!(
            matches!(steps[3], Err(Failure { kind: FailureKind::NonFinite { name: "theta", .. }, .. })),
            "{:?}",
            steps[3]
        );
        for lane in [0, 1, 2, 4, 5, 6, 7] {
            assert!(steps[lane].is_ok());
            for (found, expected) in batch.q().iter().zip(sound.q()) {
                assert_eq!(found.0[lane].to_bits(), expected.0[lane].to_bits());
            }
            for (found, expected) in batch.qdd().iter().zip(sound.qdd()) {
                assert_eq!(found.0[lane].to_bits(), expected.0[lane].to_bits());
            }
        }
        assert_eq!((batch.q().map(|q| q.0[3]), batch.t().0[3]), (before, 10.0 * STEP));
    }
    tell(&mut batch, 14.0 * STEP, 14.0 * STEP);
    assert!(batch.advance_to([14.0 * STEP; LANES]).iter().all(Result::is_ok));
    assert!((batch.q()[0].0[3] - 14.0 * STEP).abs() < ROUND_OFF);
}

#[test]
fn lanes_that_turn_as_fast_as_they_are_told_go_as_each_alone() {
    let assembled = Batch::assemble(Spun::<Eight>::default(), &[GUESS; LANES], [0.0; LANES]);
    let mut batch = assembled.map_err(|(_, failure)| failure).expect("they assemble");
    let mut alone: [_; LANES] =
        core::array::from_fn(|_| Stepper::assemble(Spun::default(), GUESS, 0.0).expect("it assembles"));
    let mut numbers = Numbers(13);
    for k in 1..=300 {
        let speeds: [f64; LANES] = core::array::from_fn(|lane| 2.0 * lane as f64 + 4.0 * numbers.next());
        batch.change(|four_bar| four_bar.speed = Lanes(speeds));
        let t = f64::from(k) * STEP;
        assert!(batch.advance_to([t; LANES]).iter().all(Result::is_ok), "{k}");
        for (lane, (stepper, speed)) in alone.iter_mut().zip(speeds).enumerate() {
            stepper.change(|four_bar| four_bar.speed = speed);
            stepper.advance_to(t).expect("a crank goes everywhere");
            let found = batch.stepper(lane).expect("a lane");
            assert_eq!((found.turns(), found.mechanism().speed), (stepper.turns(), speed));
            assert_equal(&found, stepper);
        }
    }
    assert!(alone[7].turns()[0] > 5, "{:?}", alone[7].turns());
}

#[test]
fn a_commanded_crank_costs_as_many_evaluations_as_one_that_turns_by_itself() {
    // What an input's rates foresee is foreseen: no step needs more than one that knows the time.
    let theta = |value: f64| Signal { value, rate: 1.0, acceleration: 0.0 };
    let commanded = Commanded { theta: theta(0.0), ..Commanded::default() };
    let mut stepper = Stepper::assemble(commanded, GUESS, 0.0).expect("it assembles");
    for k in 1..=1000 {
        let t = f64::from(k) * 1e-3;
        stepper.change(|four_bar| four_bar.theta = theta(t));
        let statistics = stepper.advance_to(t).expect("it moves on");
        assert!(
            statistics.evaluations <= 2 && !statistics.fallback && statistics.correction < 1e-8,
            "{k} {statistics:?}"
        );
    }
}
