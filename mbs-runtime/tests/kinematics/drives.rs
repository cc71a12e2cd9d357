//! Drives that prescribe a rate: a changed speed does not jump the crank.

use core::f64::consts::TAU;

use std::cell::Cell;

use mbs_runtime::{
    Batch, Budget, Failure, FailureKind, Function, Kinematic, Lanes, Mechanism, Saved, Scalar, Signal, Step,
    Stepper, mechanism, newton_raphson,
};

mechanism! {
    /// A slider-crank whose motor has a speed.
    pub mechanism Motor;
    param r: m = 50mm;
    param l: m = 180mm;
    param omega: rad/s = 10;
    coord theta: rad = 0.3;
    coord phi: rad = 0;
    coord x: m = 0.2;
    constraint closure { r*unit(theta) + l*unit(phi) == [x, 0]; }
    drive motor: rate(theta) == omega;
    branch ahead: cos(phi) > 0;
}

mechanism! {
    /// Rates of every kind: of the time, of an input with its rates, of one without, and of a difference of angles.
    pub mechanism Rates;
    param omega: rad/s = 3;
    input u: rad/s, rates;
    input v: rad/s;
    coord a: rad = 1;
    coord b: rad = 2;
    coord c: rad = 3;
    coord d: [rad; 2] = [4, 5];
    drive timed: rate(a) == omega*cos(2*t/1s);
    drive followed: rate(b) == 2*u;
    drive held: rate(c) == v;
    for i in 0..2 { drive relative: rate(d[i] - a) == omega*(i + 1); }
}

mechanism! {
    /// A cam on a motor of changing speed, its law a table that would be dear to copy.
    pub mechanism Cam;
    input u: rad/s, rates;
    function lift: m(rad), C2;
    coord theta: rad = 1;
    coord y: m = 0.2;
    drive motor: rate(theta) == 2*u;
    constraint face { y == 0.2m + lift(theta); }
    limit reach: 0 <= theta <= 2;
}

/// x² that counts its copies, and how often a single number is looked up.
struct Table;

thread_local! {
    static COPIES: Cell<u32> = const { Cell::new(0) };
    static ALONE: Cell<u32> = const { Cell::new(0) };
}

impl Clone for Table {
    fn clone(&self) -> Self {
        COPIES.set(COPIES.get() + 1);
        Table
    }
}

impl<T: Scalar> Function<T> for Table {
    const ORDER: usize = 2;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        ALONE.set(ALONE.get() + u32::from(T::LANES == 1));
        let all = [x * x, T::constant(2.0) * x, T::constant(2.0)];
        core::array::from_fn(|order| all.get(order).copied().unwrap_or(T::constant(0.0)))
    }
}

type Slider = Stepper<Motor, f64, 3>;

fn running() -> Slider {
    Stepper::assemble(Motor::default(), [0.3, 0.0, 0.2], 0.0).unwrap()
}

fn bits<S: Kinematic<f64, N>, const N: usize>(stepper: &Stepper<S, f64, N>) -> Vec<u64> {
    let state = stepper.q().iter().chain(stepper.qd()).chain(stepper.qdd());
    let variables = (0..S::VARIABLES.len()).filter_map(|index| stepper.mechanism().get(index));
    state.copied().chain(variables).chain([stepper.t()]).map(f64::to_bits).collect()
}

#[test]
fn the_phase_begins_where_the_guess_has_what_is_driven() {
    let stepper = Stepper::assemble(Motor::default(), [1.2, 0.0, 0.2], 5.0).unwrap();
    assert_eq!((stepper.q()[0], stepper.qd()[0], stepper.qdd()[0]), (1.2, 10.0, 0.0));
    let rates = Stepper::assemble(Rates::default(), [1.0, 2.0, 3.0, 4.0, 5.0], 0.0).unwrap();
    assert_eq!(*rates.q(), [1.0, 2.0, 3.0, 4.0, 5.0]);
    // d − a runs at ω (i + 1), and a at ω cos 0.
    assert_eq!(*rates.qd(), [3.0, 0.0, 0.0, 6.0, 9.0]);
}

#[test]
fn a_changed_speed_turns_the_crank_on_from_where_it_is() {
    let mut stepper = running();
    let mut angle = 0.3;
    for (k, omega) in [10.0, 10.0, -4.0, 0.0, 25.0, 25.0, 3.0].into_iter().enumerate() {
        stepper.change(|motor| motor.omega = omega);
        for _ in 0..50 {
            let before = stepper.q()[0];
            match k % 3 {
                0 => drop(stepper.advance(1e-3).unwrap()),
                1 => assert!(matches!(stepper.step(1e-3, Budget { newton: 9, fallback: 0 }), Step::Done(_))),
                _ => {
                    assert!(matches!(stepper.skip(5e-4, 2, Budget { newton: 9, fallback: 0 }), Step::Done(_)))
                }
            }
            angle += 1e-3 * omega;
            assert!((stepper.q()[0] - angle).abs() < 1e-13 && (stepper.q()[0] - before).abs() < 0.026);
            assert_eq!((stepper.qd()[0], stepper.qdd()[0]), (omega, 0.0));
            assert!(stepper.closure_error() < 1e-13);
        }
    }
    // A step of no time solves anew with the new speed, at the old angle.
    let before = stepper.q()[0];
    stepper.change(|motor| motor.omega = 1.0);
    stepper.advance(0.0).unwrap();
    assert_eq!((stepper.q()[0], stepper.qd()[0]), (before, 1.0));
}

#[test]
fn rates_of_time_and_inputs_are_integrated() {
    let mut stepper = Stepper::assemble(Rates::default(), [1.0, 2.0, 3.0, 4.0, 5.0], 0.0).unwrap();
    let (mut held, h) = (3.0, 0.01);
    for k in 1..=500_u32 {
        let t = h * f64::from(k);
        // The input is a cubic in time: within a step its acceleration at the end counts as lasting.
        let (u, rate, acceleration) = (t * t - 0.1 * t, 2.0 * t - 0.1, 2.0);
        let v = f64::from(k % 7);
        stepper.change(|rates| {
            (rates.u.value, rates.u.rate, rates.u.acceleration) = (u, rate, acceleration);
            rates.v = v;
        });
        stepper.advance_to(t).unwrap();
        held += v * h;
        let a = 1.0 + 1.5 * (2.0 * t).sin();
        let b = 2.0 + 2.0 * (t * t * t / 3.0 - 0.05 * t * t);
        let expected = [a, b, held, 3.0 + 3.0 * t + a, 4.0 + 6.0 * t + a];
        for (found, expected) in stepper.q().iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{k}: {:?} {expected:?}", stepper.q());
        }
        let speed = 3.0 * (2.0 * t).cos();
        let expected = [speed, 2.0 * u, v, 3.0 + speed, 6.0 + speed];
        for (found, expected) in stepper.qd().iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12);
        }
        let curvature = -6.0 * (2.0 * t).sin();
        let expected = [curvature, 2.0 * rate, 0.0, curvature, curvature];
        for (found, expected) in stepper.qdd().iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12);
        }
    }
}

#[test]
fn a_million_turns_cost_no_accuracy_but_the_rounding_of_the_angle() {
    let mut stepper = Stepper::assemble(Motor::default(), [0.3, 0.0, 0.2], 0.0).unwrap();
    // A tenth of a radian a step, then from 1e6 turns on: what is added is what the angle gains.
    stepper.change(|motor| {
        motor.motor_phase.value = 1e6 * TAU;
        motor.omega = 100.0;
    });
    let start = 1e6 * TAU;
    // The jump of the phase is a caller's, and whole turns: the position stays.
    let mut stepper: Slider = Stepper::assemble(*stepper.mechanism(), [start, 0.0, 0.2], 0.0).unwrap();
    for k in 1..=100_000_u32 {
        stepper.advance_to(1e-3 * f64::from(k)).unwrap();
    }
    let error = stepper.q()[0] - (start + 1e4);
    assert!(error.abs() <= 1.5 * f64::EPSILON * start, "{error:e}");
}

#[test]
fn a_failure_takes_the_phase_back() {
    let mut stepper = running();
    stepper.advance(0.01).unwrap();
    let before = bits(&stepper);
    let budget = Budget { newton: 1, fallback: 0 };
    // Half a turn at once with one evaluation: no position is next to it.
    assert!(matches!(stepper.step(0.3, budget), Step::Refused(_)));
    assert!(matches!(stepper.skip(0.3, 2, budget), Step::Refused(_)));
    assert!(stepper.advance(f64::INFINITY).is_err());
    assert_eq!(bits(&stepper), before);
    stepper.change(|motor| motor.omega = f64::NAN);
    assert!(matches!(
        stepper.advance(0.01),
        Err(Failure { kind: FailureKind::NonFinite { name: "omega", .. }, .. })
    ));
    stepper.change(|motor| motor.omega = 10.0);
    assert_eq!(bits(&stepper), before);
    stepper.advance(0.01).unwrap();
    assert!((stepper.q()[0] - 0.5).abs() < 1e-14);
}

#[test]
fn a_reset_keeps_the_phase() {
    let mut stepper = running();
    for k in 0..300 {
        stepper.change(|motor| motor.omega = f64::from(k));
        stepper.advance(1e-3).unwrap();
    }
    let mut memory = [0; 512];
    stepper.save().to_le_bytes_into(&mut memory).unwrap();
    let saved = Saved::from_le_bytes(&memory).unwrap();
    // A new mechanism, as after a reset: its own phase stands at zero.
    let fresh = Motor { omega: 7.0, ..Motor::default() };
    let back: Slider = Stepper::assemble_near(fresh, &saved, saved.t()).unwrap();
    assert_eq!(back.q()[0], stepper.q()[0]);
    assert!((back.q()[1] - stepper.q()[1]).abs() < 1e-14);
    let late: Slider = Stepper::assemble_near(fresh, &saved, saved.t() + 0.01).unwrap();
    assert!((late.q()[0] - (stepper.q()[0] + 0.07)).abs() < 1e-14);
}

#[test]
fn no_step_copies_a_function() {
    let signal = |rate: f64| Signal { value: 0.1, rate, acceleration: 0.0 };
    let cam = Cam { u: signal(0.1), ..Cam::new(Table) };
    let mut stepper = Stepper::<_, f64, 2>::assemble(cam, [1.0, 1.2], 0.0).unwrap();
    COPIES.set(0);
    for k in 1..=20 {
        stepper.change(|cam| cam.u.value = 0.1 + 0.001 * f64::from(k));
        stepper.advance(0.01).unwrap();
        assert!(matches!(stepper.step(0.01, Budget::DEFAULT), Step::Done(_)));
        // What the inputs are moved to within a step is not left behind.
        assert_eq!(stepper.mechanism().u, Signal { value: 0.1 + 0.001 * f64::from(k), ..signal(0.1) });
    }
    let before = (stepper.q()[0], stepper.mechanism().motor_phase);
    assert!(matches!(stepper.advance(1e3), Err(Failure { kind: FailureKind::BeyondLimit { .. }, .. })));
    assert!(matches!(stepper.step(1e3, Budget::DEFAULT), Step::Refused(_)));
    assert_eq!((stepper.q()[0], stepper.mechanism().motor_phase), before);
    assert_eq!(COPIES.get(), 0);
}

#[test]
fn steps_of_a_batch_move_phases_together_and_copy_no_function() {
    type Two = Lanes<f64, 2>;
    let still =
        Signal { value: Two::constant(0.1), rate: Two::constant(0.0), acceleration: Two::constant(0.0) };
    let cam = Cam::<Table, Two> { u: still, ..Cam::new(Table) };
    let mut batch = Batch::<_, f64, 2, 2>::assemble(cam, &[[1.0, 1.2], [0.5, 0.45]], [0.0; 2])
        .map_err(|(lane, failure)| panic!("{lane}: {failure}"))
        .unwrap();
    COPIES.set(0);
    ALONE.set(0);
    for k in 1..=20 {
        assert!(batch.advance_to([0.01 * f64::from(k); 2]).iter().all(Result::is_ok));
    }
    assert_eq!(ALONE.get(), 0, "no lane is stepped alone");
    for (angle, start) in batch.q()[0].0.into_iter().zip([1.0, 0.5]) {
        assert!((angle - (start + 0.04)).abs() < 1e-12);
    }
    // A lane that fails stays where it was.
    let before = *batch.q();
    assert!(batch.advance_to([1e3, 0.3])[0].is_err());
    assert!(batch.q()[0].0[0] == before[0].0[0] && batch.q()[0].0[1] > before[0].0[1]);
    assert_eq!(COPIES.get(), 0);
}

#[test]
fn lanes_hold_their_own_phases() {
    type Two = Lanes<f64, 2>;
    let mut motors = Motor::<Two> { omega: Two::from_lanes(|lane| 10.0 + lane as f64), ..Motor::default() };
    let guess = [Lanes([0.3, 0.7]), Lanes([0.0; 2]), Lanes([0.2; 2])];
    motors.start_phases(&guess, Two::constant(0.0));
    motors.advance_phases(Two::constant(0.0), Two::constant(0.1));
    assert_eq!(motors.motor_phase.value, Lanes([1.3, 1.8]));
    let second = motors.lane(1);
    assert_eq!((second.motor_phase.value, second.motor_phase.rate), (1.8, 11.0));
    let found = newton_raphson(&second, [1.8, -0.2, 0.2], 0.1);
    assert!(found.is_ok_and(|(found, _)| (found[0] - 1.8).abs() < 1e-12));
}
