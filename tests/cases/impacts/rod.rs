//! Painlevé's rod: a rod that slides on its tip over a rough floor.

use mbs_cases::every;
use mbs_runtime::dynamics::{DormandPrince8, Explicit, Method, Projection, RungeKutta4, Simulation};
use mbs_runtime::{Failure, FailureKind, mechanism};

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

/// The end of a run of 0.3 s; its gap is closed or open all the way.
fn ends<X: Method<Rod<f64>, f64, 3, 0>>(
    rod: Rod<f64>,
    method: X,
    go: impl Fn(&mut Simulation<Rod<f64>, X, f64, 3, 0>, f64) -> Result<(), Failure>,
) -> Option<Failure> {
    let mut run = match Simulation::start_from_text(rod, method, 0.0_f64) {
        Ok(run) => run,
        Err(failure) => return Some(failure),
    };
    let (mut ended, mut last) = (None, f64::MAX);
    for part in 1..=30 {
        let t = 0.01 * f64::from(part);
        ended = go(&mut run, t).err();
        let energy = run.balance().energy;
        let energy = energy.kinetic + energy.potential;
        assert!(run.q()[1] > -1e-12 && energy < last + 1e-9, "{rod:?}: {energy} {last} {:?}", run.instant());
        last = energy;
        if ended.is_some() {
            break;
        }
    }
    ended
}

#[test]
fn rods_near_the_paradox_keep_their_gap_or_are_refused() {
    let (mut refused, mut went_on, mut shrunk) = (0, 0, 0);
    for turn in [-6.0, -2.0, 0.0, 2.0, 6.0] {
        for index in (0..24).step_by(every(4)) {
            let rod = Rod { mu: 1.8, angle: 0.2 + 0.1 * f64::from(index), v0: -4.0, turn };
            let adaptive =
                ends(rod, Explicit::new(DormandPrince8, Projection::default()), |run, t| run.advance_to(t));
            let fixed =
                ends(rod, Explicit::new(RungeKutta4, Projection::default()), |run, t| run.step_to(t, 20));
            for (failure, is_fixed) in [(adaptive, false), (fixed, true)] {
                let Some(failure) = failure else {
                    went_on += 1;
                    continue;
                };
                refused += 1;
                // Towards the paradox the force grows without bound: a fixed step is too long for it, and an adaptive one may shrink to nothing
                // just before the contact is undecided.
                let typed = match failure.kind {
                    FailureKind::ContactUndecided { contact, .. } => contact.name == "floor",
                    FailureKind::Chatter { .. } => is_fixed,
                    FailureKind::StepTooSmall { .. } => {
                        shrunk += 1;
                        !is_fixed
                    }
                    _ => false,
                };
                assert!(typed, "{rod:?}: {failure}");
            }
        }
    }
    println!("{refused} refused, {shrunk} of them by steps that shrink; {went_on} went on");
    assert!(refused > 20 / every(4) && went_on > 100 / every(4), "{refused} {went_on}");
    assert!(10 * shrunk <= refused, "{shrunk} of {refused}");
}
