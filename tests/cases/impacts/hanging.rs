//! Contacts that are closed and bear no force: what is left of the force is rounding, and no search looks for its zeros.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_runtime::{Dynamic, mechanism};

mechanism! {
    /// A cradle of equal pendulums: three of them hang while the last one swings.
    pub mechanism Cradle;
    const N: 1 = 4;
    param L: m = 0.3;
    coord phi: [rad; N];
    for i in 0..N { body ball { mass: 0.1kg, com: L*[sin(phi[i]), -cos(phi[i])] } }
    for i in 1..N { contact hit { gap: L*(phi[i] - phi[i - 1]), restitution: 1, simultaneous: ordered } }
    gravity weight { acceleration: [0, -9.81] }
    start phi = [-0.5, 0, 0, 0] rate 0;
}

mechanism! {
    /// Equal pendulums that meet without rebound, swing together, and come to rest.
    pub mechanism Together;
    param L: m = 0.3;
    param c: N*m*s = 0.02;
    coord phi: [rad; 3];
    for i in 0..3 {
        body ball { mass: 0.1kg, com: L*[sin(phi[i]), -cos(phi[i])] }
        rsda air { angle: phi[i], damping: c }
    }
    for i in 1..3 { contact hit { gap: L*(phi[i] - phi[i - 1]), restitution: 0 } }
    gravity weight { acceleration: [0, -9.81] }
    start phi = [-0.5, 0, 0] rate 0;
}

mechanism! {
    /// Blocks that touch while they fall, beside a push that leaves them together.
    pub mechanism Falling;
    coord p: [m; 2, 2] = [[0, 0], [0, 0.1]];
    body low { mass: 3kg, com: p[0] }
    body high { mass: 0.7kg, com: p[1] }
    force wind: [3*sin(7 [rad/s]*t), 0] on p[0];
    gravity weight { acceleration: [0.3, -9.81] }
    contact between { gap: p[1, 1] - p[0, 1] - 0.1m, restitution: 0 }
    start p = [[0, 0], [0, 0.1]] rate 0;
}

/// Evaluations of a motion to `until` (s) at `points` instants.
fn evaluations<S: Dynamic<f64, N, 0>, const N: usize>(mechanism: S, until: f64, points: u32) -> u64 {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(mechanism, method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-10));
    for point in 1..=points {
        run.advance_to(until * f64::from(point) / f64::from(points)).expect("it moves");
    }
    assert!(run.balance().defect.abs() < 1e-8, "{:?}", run.balance());
    run.counts().evaluations + run.counts().shown
}

#[test]
fn forces_that_are_rounding_are_not_searched() {
    // A search that takes rounding for passages evaluates 2000 parts of nine instants.
    for (found, most) in [
        (evaluations(Cradle::default(), 0.6, 6), 1_000),
        (evaluations(Together::default(), 1.0, 4), 2_000),
        (evaluations(Falling::default(), 2.0, 4), 1_000),
    ] {
        assert!(found < most, "{found} evaluations");
    }
}
