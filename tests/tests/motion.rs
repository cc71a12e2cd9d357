//! Emitted mechanisms in motion: Andrews' squeezer against its published solution, by two formulations.

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, Formulation, GeneralizedAlpha, Method, Projection, RungeKutta4, Simulation,
    Tolerance, VelocityTransformation,
};
use mbs_runtime::mechanism;
use mechanisms::andrews::Andrews;

/// Coordinates and velocities at 0.03 s, by integrators of high order from independent equations; they agree with the
/// published solution to all its digits.
const Q: [f64; 7] = [
    15.810771195153707,
    -15.756371058411839,
    0.0408222401196458,
    -0.5347301163420796,
    0.524409965879954,
    0.5347301163420796,
    1.048080741041938,
];
const QD: [f64; 7] = [
    1139.9203022591062,
    -1424.3792951775401,
    11.032911910618594,
    19.29337410503204,
    0.5735699148295025,
    -19.29337410503204,
    0.3231791492491309,
];

/// The motion to 0.03 s, and the largest deviations of coordinates and velocities over the largest of each.
fn run<F: Formulation<Andrews, f64, 7, 6>>(
    formulation: F,
) -> (Simulation<Andrews, Explicit<DormandPrince8, F>, f64, 7, 6>, f64, f64) {
    let method = Explicit::new(DormandPrince8, formulation);
    let mut simulation = Simulation::start_from_text(Andrews::default(), method, 0.0)
        .unwrap()
        .with_tolerance(Tolerance::new(1e-12));
    simulation.advance_to(0.03).unwrap();
    let largest = |found: &[f64; 7], exact: &[f64; 7]| {
        let size = exact.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        found.iter().zip(exact).fold(0.0_f64, |largest, (a, b)| largest.max((a - b).abs() / size))
    };
    let (q, qd) = (largest(simulation.q(), &Q), largest(simulation.qd(), &QD));
    (simulation, q, qd)
}

#[test]
fn the_squeezer_ends_where_it_should_without_a_matrix_of_multipliers_and_with_one() {
    let (fast, q, qd) = run(VelocityTransformation);
    println!("{q:.1e} {qd:.1e} {:?} {:?}", fast.counts(), fast.balance());
    assert!(q < 1e-9 && qd < 1e-8);
    let (multipliers, q, qd) = run(Projection::default());
    println!("{q:.1e} {qd:.1e} {:?} {:?}", multipliers.counts(), multipliers.balance());
    assert!(q < 1e-9 && qd < 1e-8);
    let size = multipliers.lambda().iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    for (a, b) in fast.lambda().iter().zip(multipliers.lambda()) {
        assert!((a - b).abs() < 1e-7 * size, "{a} {b}");
    }
    for balance in [fast.balance(), multipliers.balance()] {
        assert!(balance.work > 0.1 && balance.defect.abs() < 1e-9 * balance.energy.kinetic, "{balance:?}");
    }
}

mechanism! {
    /// A crank at a prescribed speed with a rod at its end.
    mechanism Flail;
    input speed: rad/s;
    coord crank: rad = 0.3;
    coord rod: rad = -1.5;
    let P = 100mm*unit(crank);
    body swinging { mass: 2, inertia: 0.01, com: P + 200mm*unit(rod), angle: rod }
    gravity weight { acceleration: [0, -9.81] }
    drive motor: rate(crank) == speed;
}

/// The crank after a second at 4 rad/s and another at −1 rad/s.
fn cranked<X: Method<Flail, f64, 2, 1>>(method: X) -> (f64, f64) {
    let flail = Flail { speed: 4.0, ..Flail::default() };
    let mut simulation = Simulation::start_near(flail, method, 0.0, [0.3, -1.5], [4.0, 0.0]).unwrap();
    simulation.step_to(1.0, 2000).unwrap();
    let balance = simulation.balance();
    let defect = balance.defect.abs();
    simulation.change(|flail| flail.speed = -1.0);
    simulation.step_to(2.0, 2000).unwrap();
    assert!((simulation.qd()[0] + 1.0).abs() < 1e-3, "{:?}", simulation.qd());
    (simulation.q()[0], defect)
}

#[test]
fn a_drive_that_prescribes_a_speed_turns_the_crank_within_every_step() {
    for (angle, defect) in
        [cranked(Explicit::new(RungeKutta4, Projection::default())), cranked(GeneralizedAlpha::default())]
    {
        assert!((angle - 3.3).abs() < 1e-9, "{angle}");
        assert!(defect < 1e-3, "{defect:e}");
    }
}
