//! D11: friction on multipliers that are not unique gave another motion for each choice of them, without a failure.

use mbs_runtime::dynamics::{
    AugmentedLagrangian, Baumgarte, DormandPrince8, Explicit, GeneralizedAlpha, Method, Penalty, Projection,
    Simulation, VelocityTransformation, inverse,
};
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    /// A block on a floor that is there twice: the weight is borne by both rows in any way.
    mechanism Floors;
    param mu: 1 = 0.3;
    coord x: m = 0;
    coord y: m = 0;
    body block { mass: 2, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    constraint floor redundant { y == 0; 3*y == 0m; }
    friction rub { along: x, normal: lambda(floor[0]), coefficient: mu, speed: 1mm/1s }
    start x = 0 rate 2;
}

mechanism! {
    /// The same, with the force that both rows bear together.
    mechanism Together;
    param mu: 1 = 0.3;
    coord x: m = 0;
    coord y: m = 0;
    body block { mass: 2, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    constraint floor redundant { y == 0; 3*y == 0m; }
    friction rub { along: x, normal: lambda(floor[0]) + 3*lambda(floor[1]), coefficient: mu, speed: 1mm/1s }
    start x = 0 rate 2;
}

mechanism! {
    /// A normal force that is smooth in a multiplier which is not unique.
    mechanism Smooth;
    coord x: m = 0;
    coord y: m = 0;
    body block { mass: 2, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    constraint floor redundant { y == 0; 3*y == 0m; }
    friction rub { along: x, normal: lambda(floor[0])*tanh(lambda(floor[0])/1N), coefficient: 0.3, speed: 1mm/1s }
    start x = 0 rate 2;
}

mechanism! {
    /// Guides of which one is there twice, and friction on the other.
    mechanism Apart;
    coord x: m = 0;
    coord y: m = 0;
    coord z: m = 0;
    body block { mass: 2, com: [x, y, z] }
    gravity weight { acceleration: [0, -9.81, 0] }
    constraint floor { y == 0; }
    constraint side redundant { z == 0; 3*z == 0m; }
    friction rub { along: x, normal: lambda(floor), coefficient: 0.3, speed: 1mm/1s }
    start x = 0 rate 2;
}

fn explicit<F>(formulation: F) -> Explicit<DormandPrince8, F> {
    Explicit::new(DormandPrince8, formulation)
}

/// First velocity after 50 steps from a sliding state, or from one at rest that a push will move.
fn run<S: mbs_runtime::Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: S,
    method: impl Method<S, f64, N, M>,
) -> Result<f64, Failure> {
    let mut run = Simulation::start_from_text(mechanism, method, 0.0)?;
    for _ in 0..50 {
        run.step(1e-3)?;
    }
    Ok(run.qd()[0])
}

#[test]
fn friction_on_a_multiplier_that_is_not_unique_is_refused_by_every_method() {
    let floors = Floors::default();
    let found = [
        run(floors, explicit(Projection::default())),
        run(floors, explicit(VelocityTransformation)),
        run(floors, explicit(Baumgarte::default())),
        run(floors, explicit(Penalty::default())),
        run(floors, AugmentedLagrangian),
        run(floors, GeneralizedAlpha::default()),
        run(Smooth::default(), explicit(Projection::default())),
        run(Smooth::default(), AugmentedLagrangian),
    ];
    for found in found {
        let failure = found.expect_err("any share is a motion of its own");
        assert!(
            matches!(failure, Failure { kind: FailureKind::SharedNormalForce { row, .. }, .. } if row.name == "floor.0"),
            "{failure}"
        );
    }
    let found = inverse(&floors, 0.0, &[0.0, 0.0]);
    // Nothing drives x: it is taken as at rest, where friction does nothing.
    assert!(found.is_ok(), "{found:?}");
}

#[test]
fn friction_that_starts_to_act_during_a_run_is_refused_there() {
    fn later(method: impl Method<Floors, f64, 2, 2>) -> Failure {
        let mut run =
            Simulation::start_from_text(Floors { mu: 0.0 }, method, 0.0).expect("no friction, no doubt");
        run.step(1e-3).expect("without friction any share is the same motion");
        run.change(|floors| floors.mu = 0.3);
        (0..5).try_for_each(|_| run.step(1e-3)).expect_err("now it is not")
    }
    let failures = [
        later(explicit(Projection::default())),
        later(explicit(Penalty::default())),
        later(AugmentedLagrangian),
        later(GeneralizedAlpha::default()),
    ];
    for failure in failures {
        assert!(matches!(failure, Failure { kind: FailureKind::SharedNormalForce { .. }, .. }), "{failure}");
    }
}

#[test]
fn friction_on_what_rows_bear_together_or_on_other_rows_moves_as_one_row_would() {
    let together = Together::default();
    let found = [
        run(together, explicit(Projection::default())),
        run(together, explicit(VelocityTransformation)),
        run(together, AugmentedLagrangian),
        run(together, GeneralizedAlpha::default()),
        run(Apart::default(), explicit(Projection::default())),
        run(Apart::default(), explicit(VelocityTransformation)),
        run(Apart::default(), AugmentedLagrangian),
    ];
    for found in found {
        let speed = found.expect("one motion");
        assert!((speed - (2.0 - 0.3 * 9.81 * 0.05)).abs() < 1e-9, "{speed}");
    }
}
