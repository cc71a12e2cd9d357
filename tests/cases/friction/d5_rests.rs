//! D5: equilibria under friction that depends on multipliers, in directions without stiffness. The derivative ∂Q/∂λ was left out
//! there, and normal forces that do not balance were returned as an equilibrium.

use mbs_runtime::dynamics::{equilibrium, equilibrium_with_states};
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    /// A block on a belt that runs below it, held by a spring; its friction presses it on by `tilt`. A puck beside it lies free.
    mechanism Belt;
    param tilt: 1 = 0.5;
    param mu: 1 = 1;
    param load: N = -10N;
    param stiffness: N/m = 1e5;
    coord x: m = 0;
    coord y: m = 0;
    coord z: m = 0;
    body block { mass: 1, com: [x, y] }
    body puck { mass: 1, com: [z, 1] }
    force spring: -stiffness*x on x;
    force press: load on y;
    constraint guide { y == 0; }
    friction rub { along: x + tilt*y - 1 [m/s]*t, normal: lambda(guide), coefficient: mu, speed: 1mm/1s }
}

/// λ = load + μ tilt |λ|: its solutions.
fn normal_forces(belt: &Belt) -> Vec<f64> {
    let b = belt.mu * belt.tilt;
    let solutions = [1.0, -1.0].map(|sign| belt.load / (1.0 - b * sign));
    solutions.into_iter().zip([1.0, -1.0]).filter(|(n, sign)| n * sign > 0.0).map(|(n, _)| n).collect()
}

#[test]
fn a_block_on_a_belt_rests_beside_a_puck_that_nothing_holds() {
    let mut counts = [0; 3];
    for tilt in [-3.0_f64, -1.5, -0.9, -0.5, 0.0, 0.5, 0.9, 0.999, 1.5, 3.0] {
        for load in [-10.0_f64, 10.0] {
            let belt = Belt { tilt, load, ..Belt::default() };
            let known = normal_forces(&belt);
            counts[known.len()] += 1;
            match (known.as_slice(), equilibrium(&belt, 0.0, &[0.02, 0.0, 0.3])) {
                ([normal], Ok(found)) => {
                    let x = normal.abs() / belt.stiffness;
                    assert!((found.lambda[0] - normal).abs() < 1e-12 * normal.abs(), "{tilt}: {found:?}");
                    assert!((found.q[0] - x).abs() < 1e-12 * x, "{tilt}: {found:?}");
                    assert_eq!(found.indifferent, [false, false, true]);
                    assert!(found.iterations < 6, "{tilt}: {found:?}");
                }
                ([], Err(Failure { kind: FailureKind::FrictionLocked { .. }, .. }))
                | ([_, _], Err(Failure { kind: FailureKind::Ambiguous { solutions: 2, .. }, .. })) => {}
                (known, found) => panic!("{tilt}, {load}: {known:?}, {found:?}"),
            }
        }
    }
    assert!(counts.iter().all(|count| *count > 1), "{counts:?}");
}

mechanism! {
    /// The same block, drawn by a control that integrates its error: the state holds it at `goal`.
    mechanism Drawn;
    param tilt: 1 = 0.5;
    param goal: m = 0.1;
    coord x: m = 0;
    coord y: m = 0;
    coord z: m = 0;
    body block { mass: 1, com: [x, y] }
    body puck { mass: 1, com: [z, 1] }
    state pull: N = 0;
    der(pull) == 50 [N/(m*s)]*(goal - x);
    force draw: pull on x;
    force press: -10N on y;
    constraint guide { y == 0; }
    friction rub { along: x + tilt*y - 1 [m/s]*t, normal: lambda(guide), coefficient: 1, speed: 1mm/1s }
}

#[test]
fn a_block_on_a_belt_rests_where_its_control_holds_it() {
    for tilt in [-0.9_f64, 0.5, 0.9] {
        let drawn = Drawn { tilt, goal: 0.1 };
        let (found, states) = equilibrium_with_states(&drawn, 0.0, &[0.0, 0.0, 0.2]).expect("a rest");
        let normal = -10.0 / (1.0 + tilt);
        assert!((found.q[0] - 0.1).abs() < 1e-12, "{tilt}: {found:?}");
        assert!((found.lambda[0] - normal).abs() < 1e-11 * normal.abs(), "{tilt}: {found:?}");
        // The draw takes up the friction, which pulls along with the belt.
        assert!((states[0] + normal.abs()).abs() < 1e-11 * normal.abs(), "{tilt}: {states:?}");
    }
    // 5 N against −2.5 N.
    let found = equilibrium(&Drawn { tilt: 3.0, goal: 0.1 }, 0.0, &[0.0, 0.0, 0.2]);
    assert!(
        matches!(found, Err(Failure { kind: FailureKind::Ambiguous { solutions: 2, .. }, .. })),
        "{found:?}"
    );
}
