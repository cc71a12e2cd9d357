//! Which multipliers are facts, and which one choice of many.

use mbs_runtime::dynamics::{
    Determinacy, Explicit, Projection, RungeKutta4, Simulation, equilibrium, inverse,
};
use mbs_runtime::{Mechanism, mechanism};

use crate::linkage::{End, Linkage, Rod, parallel_loops, pendulum};

mechanism! {
    /// A plate on three parallel cranks without mass, which swing: one row of their heads follows from the others.
    pub mechanism Plate;
    param L: m = 0.5;
    param d: m = 0.4;
    coord alpha: [rad; 3] = 1;
    coord p: [m; 2] = [0.67, 0.42];
    coord psi: rad = 0;
    body plate { mass: 3, inertia: 0.2, com: p, angle: psi }
    gravity weight { acceleration: [0, -9.81] }
    constraint heads redundant {
        for i in 0..3 { [i*d, 0] + L*unit(alpha[i]) == p + rot(psi)*[(i - 1)*d, 0]; }
    }
    start alpha = [1, 1, 1] rate [0, 0, 0];
    out alone: N = lambda(heads[1]);
    out together: N = lambda(heads[1]) + lambda(heads[3]) + lambda(heads[5]);
}

#[test]
fn three_cranks_share_the_load_of_a_plate_in_many_ways_and_bear_it_in_one() {
    let method: Explicit<RungeKutta4, Projection> = Explicit::default();
    let mut run = Simulation::start_from_text(Plate::<f64>::default(), method, 0.0).unwrap();
    run.step_to(0.1, 10).unwrap();
    let found = run.determinacy().unwrap();
    assert!(found.rank == 5 && !found.is_whole());
    assert_eq!(found.unique, [false; 6], "each crank bears along itself, in x and y");
    assert_eq!(found.dependent_rows().map(|row| row.name).collect::<Vec<_>>(), ["heads.5"]);
    assert_eq!(found.shared_rows().count(), 6);
    let mut unique = [true; 2];
    run.mark_unique_loads(&mut unique).unwrap();
    assert_eq!(unique, [false, true]);
    // Of all choices the shortest has equal forces at equal cranks, as far as the plate's balance of moments lets it.
    let lambda = run.lambda();
    assert!((lambda[1] + lambda[5] - 2.0 * lambda[3]).abs() < 1e-9 * lambda[3].abs(), "{lambda:?}");
}

#[test]
fn a_bar_that_is_there_twice_is_named_once() {
    let (linkage, q, qd) = parallel_loops::<4, 4>(0.3, 1.0);
    let method: Explicit<RungeKutta4, Projection> = Explicit::default();
    let run = Simulation::start(linkage, method, 0.0, q, qd).unwrap();
    let found = run.determinacy().unwrap();
    assert_eq!((found.rank, found.unique), (3, [false, true, true, false]));
    assert_eq!(found.dependent, [false, false, false, true]);
}

#[test]
fn rods_in_line_bear_along_it_together() {
    // Two loops lie flat: five rows for three places along one line.
    let (linkage, ..) = parallel_loops::<6, 5>(0.0, 0.0);
    let flat = [1.0, 0.0, 2.0, 0.0, 3.0, 0.0];
    for shift in [0.0, 0.1] {
        let q = if shift == 0.0 { flat } else { turned(shift) };
        let found = Determinacy::of(&linkage, &(), &linkage.position(&(), &q, 0.0), 0.0).unwrap();
        let (rank, unique) = if shift == 0.0 { (3, [false; 5]) } else { (5, [true; 5]) };
        assert_eq!((found.rank, found.unique), (rank, unique));
        assert_eq!(found.dependent_rows().count(), 5 - rank);
    }
    let method: Explicit<RungeKutta4, Projection> = Explicit::default();
    let run = Simulation::start(linkage, method, 0.0, flat, [0.0; 6]).unwrap();
    assert!(!run.determinacy().unwrap().is_whole());
}

/// The heads of both loops with the uprights at `angle` (rad) above the line.
fn turned(angle: f64) -> [f64; 6] {
    let (sine, cosine) = angle.sin_cos();
    core::array::from_fn(|j| if j % 2 == 0 { cosine + (j / 2) as f64 } else { sine })
}

#[test]
fn a_regular_position_determines_every_multiplier() {
    let driven = inverse(&pendulum(), 0.0, &[0.6, -0.8]).unwrap();
    assert_eq!(driven.unique, [true]);
    let rest = equilibrium(&pendulum(), 0.0, &[0.1, -0.9]).unwrap();
    assert_eq!(rest.unique, [true]);
    // A point between two rods in line with each other: what presses the one presses the other.
    let rods =
        [-1.0, 1.0].map(|x| Rod { from: End::Ground([x, 0.0]), to: End::Point(0), length: 1.0, mass: 0.0 });
    let pinched = Linkage::new(rods, [1.0; 2], [0.0, 0.0]);
    assert_eq!(inverse(&pinched, 0.0, &[0.0, 0.0]).unwrap().unique, [false; 2]);
}
