//! Painlevé's rod: a rod that slides on its tip over a rough floor.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, RungeKutta4, Simulation};
use mbs_runtime::{FailureKind, mechanism};

mechanism! {
    /// A homogeneous rod of 1 m, 2 kg on its lower end.
    pub mechanism Rod;
    param mu: 1 = 2;
    param angle: rad = 1;
    param v0: m/s = 1;
    param turn: rad/s = 0;
    coord tip: [m; 2] = [0, 0];
    coord a: rad = 1;
    body rod { mass: 2kg, com: tip + 0.5m*unit(a), inertia: 1/6, angle: a }
    gravity weight { acceleration: [0, -9.81] }
    contact floor { gap: tip[1], restitution: 0.3 }
    friction rub { along: tip[0], normal: normal(floor), coefficient: mu, sticks: mu }
    start tip = [0, 0] rate [v0, 0];
    start a = angle rate turn;
    out push: N = force(floor);
}

/// m ÿ of the tip by a unit of the normal force while it slides to the side `s`, and without one.
fn coefficients(rod: &Rod<f64>, s: f64) -> [f64; 2] {
    let (sin, cos) = rod.angle.sin_cos();
    [1.0 + 3.0 * cos * cos + 3.0 * s * rod.mu * sin * cos, 2.0 * (0.5 * rod.turn * rod.turn * sin - 9.81)]
}

#[test]
fn a_rod_that_slides_has_the_force_of_the_closed_form() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    for (mu, angle, v0) in
        [(0.5, 1.0, 1.0), (0.5, 1.0, -1.0), (1.2, 1.1, -1.0), (2.0, 1.1, 1.0), (3.0, 0.3, 1.0)]
    {
        let rod = Rod { mu, angle, v0, turn: 0.0 };
        let [soft, free] = coefficients(&rod, v0.signum());
        assert!(soft > 0.0);
        let mut run = Simulation::start_from_text(rod, method, 0.0_f64).expect("it starts");
        run.advance_to(1e-9).expect("it slides");
        assert!((run.loads()[0] + free / soft).abs() < 1e-6, "{mu}: {:?} {}", run.loads(), -free / soft);
    }
}

#[test]
fn where_no_force_or_several_are_consistent_it_is_refused() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    for (turn, wanted) in [(0.0, 0), (8.0, 2)] {
        let rod = Rod { mu: 2.0, angle: 1.1, v0: -1.0, turn };
        let [soft, free] = coefficients(&rod, -1.0);
        assert!(soft < 0.0 && (free < 0.0) == (wanted == 0));
        let failure = Simulation::start_from_text(rod, method, 0.0_f64).expect_err("it is refused");
        assert!(
            matches!(failure.kind, FailureKind::ContactUndecided { contact, modes } if contact.name == "floor" && modes == wanted),
            "{failure}"
        );
        assert!(failure.to_string().contains("Painlevé's paradox"), "{failure}");
    }
}

/// Dropped, it strikes and stops sliding, for the impulse is no paradox; thereafter it falls or goes on as the law says.
#[test]
fn what_runs_into_the_paradox_ends_there_with_a_closed_gap() {
    let mut refused = 0;
    for index in 0..24 {
        let angle = 0.2 + 0.1 * f64::from(index);
        let rod = Rod { mu: 1.8, angle, v0: -4.0, turn: 0.0 };
        for fixed in [false, true] {
            let ended = if fixed {
                let method = Explicit::new(RungeKutta4, Projection::default());
                Simulation::start_from_text(rod, method, 0.0_f64).and_then(|mut run| {
                    let end = run.step_to(0.3, 300);
                    assert!(run.q()[1] > -1e-12, "{angle}: {:?}", run.instant());
                    end
                })
            } else {
                let method = Explicit::new(DormandPrince8, Projection::default());
                Simulation::start_from_text(rod, method, 0.0_f64).and_then(|mut run| {
                    let end = run.advance_to(0.3);
                    assert!(run.q()[1] > -1e-12, "{angle}: {:?}", run.instant());
                    end
                })
            };
            if let Err(failure) = ended {
                refused += 1;
                let named = match failure.kind {
                    FailureKind::ContactUndecided { contact, .. } => contact.name == "floor",
                    FailureKind::StepTooSmall { .. } => true,
                    _ => false,
                };
                assert!(named, "{angle}: {failure}");
            }
        }
    }
    assert!((4..40).contains(&refused), "{refused}");
}
