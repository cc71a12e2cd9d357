//! Position tolerance of the caller: fewer corrections, rows within it, velocities on the constraints all the same.

use mbs_runtime::dynamics::{Explicit, Projection, RungeKutta4, Simulation};
use mbs_runtime::{FailureKind, mechanism};

use crate::linkage::{parallel_loops, pendulum};

#[test]
fn a_looser_projection_takes_fewer_corrections() {
    let tolerance = 1e-8;
    let method = Explicit::new(RungeKutta4, Projection::default());
    let mut exact = Simulation::start(pendulum(), method, 0.0, [-1.0, 0.0], [0.0; 2]).unwrap();
    let mut loose = exact.with_position_tolerance(tolerance).unwrap();
    let mut most_open = 0.0_f64;
    for _ in 0..800 {
        exact.step(5e-3).unwrap();
        loose.step(5e-3).unwrap();
        let (exact, loose) = (exact.balance(), loose.balance());
        assert!(loose.phi <= tolerance + 1e-14 && exact.phi <= 2e-14, "{loose:?} {exact:?}");
        assert!(loose.phi_d <= 1e-12 && loose.defect.abs() < 1e-6, "{loose:?}");
        most_open = most_open.max(loose.phi);
    }
    let (exact, loose) = (exact.counts().corrections, loose.counts().corrections);
    assert!(most_open > 1e-10 && 5 * loose < 4 * exact, "{most_open:e}, {loose} of {exact}");
}

#[test]
fn tolerances_of_projections_that_nothing_could_keep_are_refused() {
    let method = Explicit::new(RungeKutta4, Projection::default());
    let run = Simulation::start(pendulum(), method, 0.0, [-1.0, 0.0], [0.0; 2]).unwrap();
    for tolerance in [f64::NAN, -1e-9, 0.0, 1e-6, f64::INFINITY] {
        let failure = run.with_position_tolerance(tolerance).unwrap_err().kind;
        assert!(matches!(failure, FailureKind::InvalidMethodParameter { name: "position tolerance", .. }));
    }
    let failure = run.with_position_tolerance(1e-15).unwrap_err().kind;
    assert!(matches!(failure, FailureKind::UnresolvedTolerance { tolerance: 1e-15, .. }));
}

mechanism! {
    /// A parallelogram with a point mass on each head. A second row for the first rod follows from it where the rod has its length alone:
    /// off the constraints the rank rises with the distance.
    mechanism Tied;
    coord p: [m; 2] = [0, 1];
    coord r: [m; 2] = [1, 1];
    body left { mass: 1, com: p }
    body right { mass: 1, com: r }
    constraint rods {
        dot(p, p) == 1 [m^2];
        dot(r - [1m, 0], r - [1m, 0]) == 1 [m^2];
        dot(r - p, r - p) == 1 [m^2];
    }
    constraint tie redundant { (dot(p, p) - 1 [m^2])*(1 + 0.5 [1/m^2]*p[0]*p[1]) == 0; }
    gravity weight { acceleration: [0, -9.81] }
    start p = [0, 1] rate [1, 0];
    start r = [1, 1] rate [1, 0];
}

#[test]
fn rows_that_follow_from_others_are_met_to_rounding() {
    let method = Explicit::new(RungeKutta4, Projection::default());
    let run = |tied: Tied| Simulation::start_from_text(tied, method, 0.0_f64).unwrap();
    let (mut exact, mut loose) =
        (run(Tied::default()), run(Tied::default()).with_position_tolerance(1e-7).unwrap());
    for _ in 0..300 {
        exact.step(1e-3).unwrap();
        loose.step(1e-3).unwrap();
        assert!(loose.balance().phi < 1e-13, "{:?}", loose.balance());
    }
    assert!(exact.q().iter().zip(loose.q()).all(|(exact, loose)| (exact - loose).abs() < 1e-11));
}

/// The parallelogram passes two singular positions a turn, five turns and more.
#[test]
fn singular_positions_are_passed_as_without() {
    let (linkage, q, qd) = parallel_loops::<4, 3>(0.0, 1.0);
    let method = Explicit::new(RungeKutta4, Projection::default());
    let mut exact = Simulation::start(linkage, method, 0.0, q, qd).unwrap();
    let mut loose = exact.with_position_tolerance(1e-8).unwrap();
    for _ in 0..100 {
        exact.step_to(exact.t() + 0.1, 100).unwrap();
        loose.step_to(loose.t() + 0.1, 100).unwrap();
        let pairs = exact.q().iter().zip(loose.q());
        assert!(pairs.into_iter().all(|(exact, loose)| (exact - loose).abs() < 1e-5), "t = {}", loose.t());
    }
}
