//! Coordinates that rotate for days: `coord phi: turn`, in single precision.

use core::f64::consts::TAU;

use mbs_runtime::{Budget, Failure, FailureKind, Mechanism, Saved, Stepper, mechanism};

mechanism! {
    /// A four-bar linkage whose crank turns.
    pub mechanism Turning;
    param omega: rad/s = 3000rpm;
    coord crank: turn = 0.3;
    coord rod: rad = 0.9;
    coord rocker: rad = 1.8;
    constraint closure { 100mm*unit(crank) + 250mm*unit(rod) == [300mm, 0] + 200mm*unit(rocker); }
    drive motor: rate(crank) == omega;
    branch open: sin(rocker - rod) > 0;
}

mechanism! {
    /// The same with an angle that grows.
    pub mechanism Growing;
    param omega: rad/s = 3000rpm;
    coord crank: rad = 0.3;
    coord rod: rad = 0.9;
    coord rocker: rad = 1.8;
    constraint closure { 100mm*unit(crank) + 250mm*unit(rod) == [300mm, 0] + 200mm*unit(rocker); }
    drive motor: rate(crank) == omega;
    branch open: sin(rocker - rod) > 0;
}

mechanism! {
    /// A drag link: what it drives turns too, and a wheel that is held at three turns of the crank less two of the follower.
    pub mechanism DragLink;
    input speed: rad/s;
    coord crank: turn = 0.5;
    coord rod: turn = 0.6;
    coord follower: turn = 0.4;
    coord wheel: [m; 2];
    constraint closure { 275mm*unit(crank) + 280mm*unit(rod) == [100mm, 0] + 250mm*unit(follower); }
    constraint rim { wheel == 50mm*unit(3*crank - 2*follower); }
    drive motor: rate(-2*crank) == speed;
    branch open: sin(follower - rod) > 0;
    out angle: rad = follower;
}

/// A day at 3000 rpm, as an angle of single precision (rad): its neighbours are 2 rad away.
const A_DAY: f32 = 2.714_336e7;

/// Angle (rad) of the crank after `steps` steps of a millisecond from `start` (rad), with the increment of single precision.
fn exact(start: f32, steps: u32) -> f64 {
    let increment = f64::from(Turning::<f32>::default().omega) * f64::from(0.001_f32);
    f64::from(start) + increment * f64::from(steps)
}

/// The rocker's angle (rad) from the crank's, by the intersection of two circles.
fn rocker(crank: f64) -> f64 {
    let joint = (0.1 * crank.cos(), 0.1 * crank.sin());
    let (x, y) = (joint.0 - 0.3, joint.1);
    let square = x * x + y * y;
    // cos of the angle at the rocker's pivot between the joint and the end of the rod.
    let inner = ((0.04 + square - 0.0625) / (2.0 * 0.2 * square.sqrt())).acos();
    y.atan2(x) - inner
}

/// Distance of two angles within a turn (rad).
fn apart(a: f64, b: f64) -> f64 {
    (a - b - TAU * ((a - b) / TAU).round()).abs()
}

/// Errors of a crank of single precision (rad): two roundings of an angle up to π, of the phase and of the coordinate.
const ROUNDED: f64 = 2.0 * 1.2e-7;

fn turning(crank: f32) -> Stepper<Turning<f32>, f32, 3> {
    Stepper::assemble(Turning::default(), [crank, 0.9, 1.8], 0.0).expect("an assembly")
}

#[test]
fn a_crank_in_single_precision_turns_for_days() {
    let (mut first, mut later) = (turning(0.3), turning(A_DAY));
    // The first turn begins where the day ends.
    let begin = later.q()[0];
    let mut same = turning(begin);
    let turns = later.turns()[0];
    assert_eq!(turns, (f64::from(A_DAY) / TAU).round() as i64);
    let mut worst = [0.0_f64; 2];
    let mut within_ten_turns = 0.0_f64;
    for step in 1..=20_000 {
        first.advance(0.001).expect("a step");
        later.advance(0.001).expect("a step");
        same.advance(0.001).expect("a step");
        assert_eq!((later.q(), later.qd(), later.qdd()), (same.q(), same.qd(), same.qdd()), "step {step}");
        assert_eq!(later.turns()[0] - turns, same.turns()[0]);
        for (stepper, start) in [(&first, 0.3), (&later, A_DAY)] {
            let q = stepper.q().map(f64::from);
            let angle = exact(start, step);
            assert!(
                q[0].abs() < core::f64::consts::PI + 1e-5
                    && (q[0] + TAU * stepper.turns()[0] as f64 - angle).abs() < 1e-5
            );
            worst[0] = worst[0].max(apart(q[0], angle));
            worst[1] = worst[1].max(apart(q[2], rocker(angle)));
        }
        if step == 200 {
            within_ten_turns = worst[1];
        }
    }
    println!(
        "largest errors of crank and rocker: {worst:?} rad, of the rocker in ten turns {within_ten_turns} rad"
    );
    // The solver's error depends on the position within a turn: it does not grow with time.
    assert!(worst[0] <= ROUNDED && worst[1] <= 2.0 * within_ten_turns, "{worst:?} {within_ten_turns}");
}

#[test]
fn an_angle_that_grows_loses_its_digits() {
    let growing = |crank: f32| Stepper::assemble(Growing::<f32>::default(), [crank, 0.9, 1.8], 0.0);
    let mut stepper = growing(0.3).expect("an assembly");
    let mut worst = 0.0_f64;
    for step in 1..=10_000 {
        stepper.advance(0.001).expect("a step");
        worst = worst.max(apart(f64::from(stepper.q()[2]), rocker(exact(0.3, step))));
    }
    // Steps add up exactly; the angle itself, up to 3142 rad, is rounded to 1.2e-4.
    assert!(worst > 100.0 * ROUNDED, "{worst}");
    assert!(matches!(growing(A_DAY), Err(Failure { kind: FailureKind::Unresolved { .. }, .. })));
}

#[test]
fn time_goes_on_when_single_precision_no_longer_resolves_a_step() {
    // At 2^19 s the next number is 0.06 s away.
    let mut stepper: Stepper<Turning<f32>, f32, 3> =
        Stepper::assemble(Turning::default(), [0.3, 0.9, 1.8], 524_288.0).expect("an assembly");
    for _ in 0..2_000 {
        stepper.advance(0.001).expect("a step");
    }
    assert!((stepper.t() - 524_290.0).abs() <= 0.0625, "{}", stepper.t());
    assert!(apart(f64::from(stepper.q()[0]), exact(0.3, 2_000)) <= ROUNDED);
}

#[test]
fn whole_turns_survive_a_reset() {
    let mut stepper = turning(A_DAY);
    for _ in 0..777 {
        stepper.advance(0.001).expect("a step");
    }
    let mut bytes = [0; 512];
    stepper.save().to_le_bytes_into(&mut bytes).expect("room");
    let saved = Saved::from_le_bytes(&bytes).expect("a state");
    assert_eq!(saved.turns(), stepper.turns());
    let again =
        Stepper::assemble_near(Turning::<f32>::default(), &saved, stepper.t()).expect("the same assembly");
    assert_eq!(again.turns(), stepper.turns());
    assert!((again.q()[0] - stepper.q()[0]).abs() < 1e-6);
}

#[test]
fn driven_coordinates_turn_too_and_phases_turn_by_their_factor() {
    let link = DragLink::<f64> { speed: 40.0, ..DragLink::default() };
    let guess = link.guess(&link.parameters());
    let mut stepper = Stepper::assemble(link, guess, 0.0).expect("an assembly");
    let before = stepper.q().to_owned();
    // −20 rad/s: ten turns back.
    for _ in 0..3_000 {
        stepper.advance(TAU / 20.0 / 300.0).expect("a step");
    }
    assert_eq!(stepper.turns()[..3], [-10; 3]);
    for (now, then) in stepper.q().iter().zip(before) {
        assert!((now - then).abs() < 1e-9, "{now} {then}");
    }
    assert!(stepper.closure_error() < 1e-12 && stepper.mechanism().motor_phase.value.abs() < TAU + 1e-9);
}

/// `true` if two steppers are at one position, within 32 ε. `advance` iterates to rounding. A bounded step ends where the rows are within their
/// tolerance: 1.9e-6 rad from the closed form here, 5.8e-6 rad in the worst of 10 000 steps.
fn close(one: &Stepper<Turning<f32>, f32, 3>, other: &Stepper<Turning<f32>, f32, 3>) -> bool {
    one.q().iter().zip(other.q()).all(|(one, other)| (one - other).abs() < 32.0 * f32::EPSILON)
}

#[test]
fn steps_of_bounded_work_and_failed_ones_keep_the_turns() {
    let mut stepper = turning(3.0);
    let mut plain = turning(3.0);
    for _ in 0..100 {
        let _ = stepper.step(0.001, Budget::DEFAULT);
        plain.advance(0.001).expect("a step");
    }
    assert_eq!((stepper.turns(), stepper.t()), (plain.turns(), plain.t()));
    assert!(close(&stepper, &plain), "{:?} {:?}", stepper.q(), plain.q());
    let (q, t) = (*stepper.q(), stepper.t());
    assert!(stepper.advance(f32::NAN).is_err());
    assert_eq!((stepper.q(), stepper.turns(), stepper.t()), (&q, plain.turns(), t));
    let _ = stepper.skip(0.001, 50, Budget::DEFAULT);
    for _ in 0..50 {
        plain.advance(0.001).expect("a step");
    }
    assert_eq!(stepper.turns(), plain.turns());
    assert!(close(&stepper, &plain), "{:?} {:?}", stepper.q(), plain.q());
}
