//! D27: beyond 80 reference lengths `equilibrium` denied rests that exist, with one linear spring. So it did where a soft one balances a
//! weight to rounding.

use mbs_runtime::dynamics::equilibrium;
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    /// A mass on a spring.
    pub mechanism Spring;
    coord x: m = 0;
    body b { mass: 1, com: [x, 0] }
    force f: -1e5 [N/m]*(x - 0.1m) on x;
}

mechanism! {
    /// A mass between two walls.
    pub mechanism Slot;
    coord x: m = 0;
    body b { mass: 1, com: [x, 0] }
    contact left { gap: x + 0.1m, stiffness: 1e5 }
    contact right { gap: 0.1m - x, stiffness: 1e5 }
}

mechanism! {
    /// A ball over a floor.
    pub mechanism Ball;
    coord y: m = 1;
    body b { mass: 1, com: [0, y] }
    gravity g { acceleration: [0, -9.81] }
    contact floor { gap: y - 0.05m, stiffness: 1e5 }
}

mechanism! {
    /// A bead on an inclined wire, with a stop.
    pub mechanism Wire;
    coord s: m = 1;
    coord p: [m; 2] = [0.7, 0.7];
    body b { mass: 1, com: p }
    constraint wire { p == (s - 1m)*unit(0.7); }
    gravity g { acceleration: [0, -9.81] }
    contact stop { gap: s + 3m, stiffness: 1e4 }
}

mechanism! {
    /// A ball without a floor, and a wheel that a torque turns.
    pub mechanism Falling;
    param torque: N*m = 0;
    coord y: m = 1;
    coord a: rad = 0;
    body b { mass: 1, com: [0.1m, y] }
    body wheel { mass: 1, inertia: 1, com: [0, 0], angle: a }
    gravity g { acceleration: [0, -9.81] }
    torque motor: torque on a;
}

mechanism! {
    /// A weight on a cable that is taut from everywhere.
    pub mechanism Cable;
    coord x: m = 0;
    coord y: m = 0;
    body b { mass: 1, com: [x, y] }
    gravity g { acceleration: [0, -9.81] }
    tsda cable { from: [0, 0], to: [x, y], stiffness: 1000, length: 1 }
}

mechanism! {
    /// A weight on a soft spring, and one that hangs on it by a stiff one.
    pub mechanism Soft;
    param k: N/m = 1e-6;
    coord x: m = 0;
    coord y: m = 0;
    body upper { mass: 1, com: [0, x] }
    body lower { mass: 2, com: [0, x + y] }
    gravity g { acceleration: [0, -9.81] }
    tsda soft { from: [0, 0], to: [0, x], stiffness: k }
    tsda stiff { from: [0, x], to: [0, x + y], stiffness: 100*k }
}

/// Distances from a rest: some steps to coordinates that are hardly resolved.
const FAR: [f64; 6] = [1.0, 10.0, 100.0, 3e3, 1e6, 1e9];

#[test]
fn a_rest_is_found_from_any_distance() {
    for far in FAR.into_iter().flat_map(|far| [far, -far]) {
        // Beside the rounding of the start a stiff law is linear.
        let rounding = 4.0 * f64::EPSILON * far.abs() + 1e-12;
        let spring = equilibrium(&Spring::<f64>::default(), 0.0, &[far]).expect("a rest").q[0];
        assert!((spring - 0.1).abs() < 1e-12, "{far}: {spring}");
        let slot = equilibrium(&Slot::<f64>::default(), 0.0, &[far]).expect("a rest");
        assert!(slot.q[0].abs() <= 0.1 + rounding && slot.indifferent[0], "{far}: {slot:?}");
        let ball = equilibrium(&Ball::<f64>::default(), 0.0, &[far]).expect("a rest").q[0];
        assert!((ball - (0.05 - 9.81e-5)).abs() < 1e-12, "{far}: {ball}");
        let wire = equilibrium(&Wire::<f64>::default(), 0.0, &[far; 3]).expect("a rest").q[0];
        assert!((wire + 3.0 + 9.81e-4 * 0.7_f64.sin()).abs() < 1e-9, "{far}: {wire}");
    }
}

#[test]
fn a_rest_is_found_from_afar_in_single_precision() {
    for far in [10.0_f32, 100.0, -100.0] {
        let spring = equilibrium(&Spring::<f32>::default(), 0.0, &[far]).expect("a rest").q[0];
        let ball = equilibrium(&Ball::<f32>::default(), 0.0, &[far]).expect("a rest").q[0];
        assert!((spring - 0.1).abs() < 1e-5 && (ball - 0.0499).abs() < 1e-4, "{far}: {spring} {ball}");
    }
}

#[test]
fn forces_without_an_answer_leave_no_rest() {
    for torque in [0.0, 2.0] {
        let failure = equilibrium(&Falling { torque }, 0.0, &[1.0, 0.3]).expect_err("it falls");
        assert!(matches!(failure.kind, FailureKind::NoEquilibrium { .. }), "{failure}");
    }
}

/// A search that ends on the way says so, and not that forces are nearest to balance where it ended.
#[test]
fn a_search_that_still_comes_nearer_denies_no_rest() {
    for far in FAR {
        for direction in [[0.1, -1.0], [1.0, 0.3], [-1.0, -0.3], [-0.1, 1.0]] {
            match equilibrium(&Cable::<f64>::default(), 0.0, &direction.map(|part| part * far)) {
                Ok(rest) => assert!(rest.q[0].abs() < 1e-9 && rest.q[1].abs() < 1.01, "{far}: {rest:?}"),
                Err(Failure { kind: FailureKind::EquilibriumNotConverged { .. }, .. }) if far > 50.0 => {}
                Err(failure) => panic!("{far} {direction:?}: {failure}"),
            }
        }
    }
}

/// Weights stretch soft springs by as many reference lengths as their stiffness asks for, and balance to rounding of a coordinate.
#[test]
fn a_soft_spring_balances_a_weight() {
    for k in [1.0, 1e-3, 1e-5, 1e-6, 1e-7] {
        for start in [0.0, 1.0, -5e3] {
            let rest = equilibrium(&Soft::<f64> { k }, 0.0, &[start, -start]);
            let rest = rest.unwrap_or_else(|failure| panic!("{k:e} {start}: {failure}"));
            let [x, y] = [-3.0 * 9.81 / k, -2.0 * 9.81 / (100.0 * k)];
            assert!(
                (rest.q[0] / x - 1.0).abs() < 1e-12 && (rest.q[1] / y - 1.0).abs() < 1e-9,
                "{k:e}: {rest:?}"
            );
            assert_eq!(rest.indifferent, [false; 2]);
        }
    }
}
