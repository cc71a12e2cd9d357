//! A pendulum whose pin has Coulomb friction, by half swings.

use mbs_runtime::dynamics::{
    Direction, DormandPrince8, Explicit, Projection, Radau5, RungeKutta4, Simulation, Tolerance,
};
use mbs_runtime::mechanism;

mechanism! {
    /// A pendulum on a pin of 2 cm, in its point's coordinates.
    pub mechanism Pendulum;
    param r: m = 20mm;
    param N: N = 20;
    coord phi: rad = 1;
    coord P: [m; 2] = [0.8, -0.5];
    constraint rod { P == 1m*[sin(phi), -cos(phi)]; }
    body bob { mass: 1kg, com: P }
    gravity weight { acceleration: [0, -9.81] }
    friction pin { along: r*phi, normal: N, coefficient: 0.8, sticks: 1 }
    start phi = 1 rate 0;
}

/// Angle at the end of a half swing from `phi`: the energy falls by the work of a moment of 0.32 N m.
fn swung(phi: f64) -> f64 {
    let (weight, moment) = (9.81, 0.02 * 20.0 * 0.8);
    let side = phi.signum();
    let mut next = -phi;
    for _ in 0..50 {
        let open = weight * (phi.cos() - next.cos()) + moment * (phi - next) * side;
        let slope = weight * next.sin() - moment * side;
        next -= open / slope;
    }
    next
}

#[test]
fn half_swings_are_those_of_the_closed_form() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-12));
    let mut fixed = Simulation::start_from_text(
        Pendulum::default(),
        Explicit::new(RungeKutta4, Projection::default()),
        0.0,
    )
    .expect("it starts");
    let method = Explicit::new(Radau5, Projection::default());
    let implicit = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64).expect("it starts");
    let mut implicit = implicit.with_tolerance(Tolerance::new(1e-10));
    let (mut phi, mut swings) = (1.0_f64, 0);
    // It sticks where the weight's moment is below 0.4 N m.
    while 9.81 * phi.sin().abs() > 0.4 {
        phi = swung(phi);
        swings += 1;
        assert!(run.advance_until_event(60.0, Direction::Any, |_, _, qd| qd[0]).expect("it swings"));
        assert!((run.q()[0] - phi).abs() < 1e-10, "swing {swings}: {} {phi}", run.q()[0]);
        assert!(implicit.advance_until_event(60.0, Direction::Any, |_, _, qd| qd[0]).expect("it swings"));
        assert!((implicit.q()[0] - phi).abs() < 1e-7, "swing {swings}: {} {phi}", implicit.q()[0]);
        assert!(fixed.step_until_event(60.0, 6000, Direction::Any, |_, _, qd| qd[0]).expect("it swings"));
        assert!((fixed.q()[0] - phi).abs() < 1e-7, "swing {swings}: {} {phi}", fixed.q()[0]);
    }
    assert!(swings > 8, "{swings}");
    run.advance_to(100.0).expect("it rests");
    assert!((run.q()[0] - phi).abs() < 1e-10 && run.qd()[0].abs() < 1e-15, "{:?}", run.instant());
}
