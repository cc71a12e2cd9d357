//! Rests under integral controls: what they integrate is 0, and they bear the loads.

use mbs_runtime::dynamics::{equilibrium_with_states, undetermined_states};
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    /// A load that a control lifts to a height.
    pub mechanism Lift;
    param m: kg = 1;
    param gain: N/m/s = 5;
    coord x: m = 0.1;
    state z: N = 0;
    body load { mass: m, com: [0, x] }
    gravity weight { acceleration: [0, -9.81] }
    force rope: z on x;
    der(z) == gain*(0.5m - x);
}

mechanism! {
    /// The same on a rail.
    pub mechanism Guided;
    param m: kg = 1;
    param gain: N/m/s = 5;
    coord r: [m; 2] = [0, 0.1];
    state z: N = 0;
    body load { mass: m, com: r }
    gravity weight { acceleration: [0, -9.81] }
    constraint rail { r[0] == 0; }
    force rope: z on r[1];
    der(z) == gain*(0.5m - r[1]);
}

mechanism! {
    /// A control of the square of the height.
    pub mechanism Squared;
    param m: kg = 1;
    coord x: m = 0.1;
    state z: N = 0;
    body load { mass: m, com: [0, x] }
    gravity weight { acceleration: [0, -9.81] }
    force rope: z on x;
    der(z) == 50N/1m/1m/1s*(0.0625m*1m - x^2);
}

mechanism! {
    /// Two controls that integrate one error, of which one acts through a lagging motor.
    pub mechanism Shared;
    param m: kg = 1;
    coord x: m = 0.1;
    state z: N = 0;
    state motor: N = 0;
    state other: N = 3;
    state clock: N = 7;
    body load { mass: m, com: [0, x] }
    gravity weight { acceleration: [0, -9.81] }
    force rope: motor + other on x;
    der(z) == 5N/1m/1s*(0.5m - x);
    der(motor) == (z - motor)/0.1s;
    der(other) == 2N/1m/1s*(0.5m - x);
    der(clock) == 3N/1m*der(x);
}

mechanism! {
    /// A state that integrates and pushes nothing, beside a spring.
    pub mechanism Unheard;
    coord x: m = 0.1;
    state z: N = 0;
    body load { mass: 2, com: [0, x] }
    force spring: -40N/1m*x on x;
    der(z) == 5N/1m/1s*(0.5m - x);
}

mechanism! {
    /// An integrand without a zero, though each place has another value of it.
    pub mechanism Positive;
    coord x: m = 0.1;
    state z: N = 0;
    body load { mass: 2, com: [0, x] }
    force rope: z on x;
    der(z) == 5N/1s*(1 + (x/1m)^2);
}

const MASSES: [f64; 9] = [1e-3, 1e-2, 0.1, 1.0, 5.0, 10.0, 50.0, 100.0, 1e3];

#[test]
fn an_integral_control_lifts_any_load() {
    for m in MASSES {
        for gain in [5e-6, 5.0, 5e6] {
            for guess in [0.1, 0.0, -3.0, 40.0] {
                let lift: Lift = Lift { m, gain };
                let (rest, [z]) = equilibrium_with_states(&lift, 0.0, &[guess]).unwrap();
                assert!((rest.q[0] - 0.5).abs() < 1e-13 && (z / (9.81 * m) - 1.0).abs() < 1e-13, "{m} {z}");
                assert!(rest.indifferent == [false] && rest.iterations <= 4, "{rest:?}");
                let guided: Guided = Guided { m, gain };
                let (rest, [z]) = equilibrium_with_states(&guided, 0.0, &[0.02, guess]).unwrap();
                assert!((rest.q[1] - 0.5).abs() < 1e-13 && rest.q[0].abs() < 1e-15, "{rest:?}");
                assert!((z / (9.81 * m) - 1.0).abs() < 1e-13 && rest.unique == [true], "{m} {z}");
            }
        }
    }
}

#[test]
fn an_integral_control_lifts_any_load_in_single_precision() {
    for m in MASSES {
        let m = m as f32;
        let (rest, [z]) = equilibrium_with_states(&Lift { m, gain: 5.0_f32 }, 0.0, &[0.1]).unwrap();
        assert!((rest.q[0] - 0.5).abs() < 1e-6 && (z / (9.81 * m) - 1.0).abs() < 1e-6, "{m} {z}");
        let (rest, [z]) = equilibrium_with_states(&Guided { m, gain: 5.0_f32 }, 0.0, &[0.0, 0.1]).unwrap();
        assert!((rest.q[1] - 0.5).abs() < 1e-6 && (z / (9.81 * m) - 1.0).abs() < 1e-6, "{m} {z}");
        let (rest, [z]) = equilibrium_with_states(&Squared { m }, 0.0, &[0.1]).unwrap();
        assert!((rest.q[0] - 0.25).abs() < 1e-6 && (z / (9.81 * m) - 1.0).abs() < 1e-6, "{m} {z}");
    }
}

#[test]
fn a_nonlinear_integrand_comes_to_the_zero_on_the_side_of_the_guess() {
    for m in MASSES {
        for guess in [0.1, 1e-4, 0.0, 2.0, -0.1, -7.0] {
            let (rest, [z]) = equilibrium_with_states(&Squared { m }, 0.0, &[guess]).unwrap();
            let side = if guess < 0.0 { -0.25 } else { 0.25 };
            assert!(
                (rest.q[0] - side).abs() < 1e-13 && (z / (9.81 * m) - 1.0).abs() < 1e-13,
                "{m} {guess} {rest:?}"
            );
        }
    }
}

#[test]
fn states_that_may_have_other_values_are_named() {
    for m in MASSES {
        let shared: Shared = Shared { m };
        let (rest, states) = equilibrium_with_states(&shared, 0.0, &[0.1]).unwrap();
        let [z, motor, other, clock] = states;
        assert!((rest.q[0] - 0.5).abs() < 1e-13 && (motor - z).abs() < 1e-12 * (1.0 + z.abs()), "{rest:?}");
        assert!(
            ((motor + other) / (9.81 * m) - 1.0).abs() < 1e-12 * (1.0 + 3.0 / m) && clock == 7.0,
            "{states:?}"
        );
        assert_eq!(rest.indifferent, [false]);
        let undetermined: [f64; 4] = undetermined_states(&shared, 0.0, &rest, &states).unwrap();
        assert_eq!(undetermined, [1.0; 4]);
        let lift: Lift = Lift { m, gain: 5.0 };
        let (rest, states) = equilibrium_with_states(&lift, 0.0, &[0.1]).unwrap();
        assert_eq!(undetermined_states(&lift, 0.0, &rest, &states).unwrap(), [0.0]);
    }
}

#[test]
fn a_state_without_a_rest_is_named_only_where_that_was_found() {
    let failure = equilibrium_with_states(&Unheard::<f64>::default(), 0.0, &[0.1]).unwrap_err();
    assert!(
        matches!(failure, Failure { kind: FailureKind::NoStateEquilibrium { state, .. }, .. } if state.name == "z"),
        "{failure}"
    );
    let failure = equilibrium_with_states(&Positive::<f64>::default(), 0.0, &[0.1]).unwrap_err();
    assert!(
        matches!(failure, Failure { kind: FailureKind::EquilibriumNotConverged { coordinate, .. }, .. } if coordinate.name == "x"),
        "{failure}"
    );
}
