//! The balance of energy of texts that depend on time: the power of what the time does by itself is in it.

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, Projection, RungeKutta4, Simulation, Tolerance, VelocityTransformation,
};
use mbs_runtime::{Dynamic, Mechanism, mechanism};

mechanism! {
    /// A point that the time carries along and across, and a body that it turns.
    pub mechanism Carried;
    coord x: m = 0.1;
    coord phi: rad = 0.2;
    body point { mass: 2, com: [x + 0.1m*sin(5*t/1s), 0.3m*cos(4*t/1s)] }
    body turned { mass: 1, inertia: 0.2, com: x*unit(phi + t/1s), angle: phi + 0.3*sin(7*t/1s) }
    gravity weight { acceleration: [0, -9.81] }
    start x = 0.1 rate 1;
    start phi = 0.2 rate 0.5;
}

mechanism! {
    /// A point under gravity that changes with the time.
    pub mechanism Pulsing;
    coord x: m = 0.1;
    coord y: m = 0.1;
    body point { mass: 2, com: [x, y] }
    gravity pull { acceleration: [0.3g0*cos(2*t/1s), -1g0*(1 + 0.2*sin(t/1s))] }
    constraint plane { y == 0.3*x; }
    start x = 0.1 rate 1;
}

mechanism! {
    /// Kinetic energies that depend on time, with a part that is linear in the rates and one without them.
    pub mechanism Varying;
    coord x: m = 0.1;
    coord y: m = 0;
    body point { mass: 2, com: [x, y] }
    kinetic growing = 0.5*1kg*(1.5 + sin(t/1s))*der(x)^2;
    kinetic turning = 1.5N*1s/1m*(1 + x/1m)*der(y)*x + 2N/1m*(1 + 0.3*cos(3*t/1s))*y^2;
    potential spring = 20N/1m*(x^2 + y^2);
    start x = 0.1 rate 1;
    start y = 0 rate 0.5;
}

mechanism! {
    /// A spring as a potential whose stiffness changes with the time.
    pub mechanism Pumped;
    coord x: m = 0.1;
    body point { mass: 2, com: [x, 0] }
    potential spring = 20N/1m*(1 + 0.5*sin(2*t/1s))*x^2;
    start x = 0.1 rate 1;
}

mechanism! {
    /// A body in space that the time turns about an axis of its own.
    pub mechanism Spun;
    coord a: rad = 0.3;
    coord b: rad = 0.2;
    let e = [cos(a/2)*cos(t/1s), sin(a/2)*cos(b), sin(a/2)*sin(b), cos(a/2)*sin(t/1s)];
    body top { mass: 2, com: [0.1m*sin(a), 0.2m*cos(3*t/1s), 0], inertia: [1, 2, 2.5, 0.2, -0.1, 0.3], orientation: e }
    potential hold = 3N*1m*(a - 0.5)^2 + 2N*1m*b^2;
    start a = 0.6 rate 0.4;
    start b = 0.2 rate 0.1;
}

mechanism! {
    /// A point and the end of its spring on a base that an input moves, and a force of an input.
    pub mechanism Based;
    input u: m, rates;
    input f: N;
    input k: N/m;
    coord x: m = 0.1;
    coord y: m = 0;
    body point { mass: 2, com: [x + u, y] }
    tsda spring { from: [2*u, 0.5], to: [x + u, y], stiffness: 50, length: 0.2, damping: 1 }
    torque stop: 0*1N*1m on y/1m;
    force push: [0, f] on [x, y];
    potential held = k*x^2/2;
    start x = 0.1 rate 1;
    start y = 0 rate 0;
}

/// Asserts that the energy defect after two seconds is as small as the tolerance.
#[track_caller]
fn assert_balanced<S: Dynamic<f64, N, M> + Copy, const N: usize, const M: usize>(mechanism: S) {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let start = Simulation::start_from_text(mechanism, method, 0.0).unwrap();
    for tolerance in [1e-6, 1e-9, 1e-12] {
        let mut run = start.with_tolerance(Tolerance::new(tolerance));
        run.advance_to(2.0).unwrap();
        let balance = run.balance();
        assert!(balance.work.abs() > 0.1, "the time does work: {balance:?}");
        // Of some ten joules, in some ten steps.
        assert!(balance.defect.abs() < 1e3 * tolerance, "{:e} at {tolerance:e}", balance.defect);
    }
}

#[test]
fn bodies_that_the_time_carries_are_accounted_for() {
    assert_balanced(Carried::default());
    assert_balanced(Spun::default());
}

#[test]
fn gravity_that_changes_is_accounted_for() {
    assert_balanced(Pulsing::default());
}

#[test]
fn kinetic_energies_of_the_text_are_accounted_for() {
    assert_balanced(Varying::default());
}

#[test]
fn a_potential_that_changes_is_accounted_for() {
    assert_balanced(Pumped::default());
}

#[test]
fn texts_that_the_time_does_nothing_to_have_no_such_power() {
    let (pumped, based) = (Pumped::<f64>::default(), Based::<f64>::default());
    let p = pumped.parameters();
    let here = pumped.position(&p, &[0.1], 0.0);
    // ∂V/∂t = 20 x² cos 0.
    assert!((pumped.carried(&p, &here, &[1.0], &[0.0]).unwrap() - 0.2).abs() < 1e-15);
    let p = based.parameters();
    let here = based.position(&p, &[0.1, 0.0], 0.0);
    // It has inputs with rates, which are 0.
    assert_eq!(based.carried(&p, &here, &[1.0, 0.5], &[2.0, 1.0]), Some(0.0));
}

#[test]
fn inputs_with_rates_are_carried_along_and_do_their_work_while_a_motion_is_integrated() {
    let mut based: Based = Based { f: 2.0, k: 30.0, ..Based::default() };
    based.u.value = 0.1;
    based.u.rate = 0.7;
    based.u.acceleration = -0.4;
    let method = Explicit::new(DormandPrince8, VelocityTransformation);
    let run = Simulation::start_from_text(based, method, 0.0).unwrap();
    let mut run = run.with_tolerance(Tolerance::new(1e-12));
    run.advance_to(1.0).unwrap();
    assert!(run.balance().defect.abs() < 1e-9, "{:?}", run.balance());
    let u: mbs_runtime::Signal<f64> = run.mechanism().u;
    assert!((u.value - 0.6).abs() < 1e-14 && (u.rate - 0.3).abs() < 1e-15, "{u:?}");
    // The base jumps between two steps: that brings energy in, which is not a defect.
    run.change(|based| based.u.value = 0.2);
    run.advance_to(2.0).unwrap();
    assert!(run.balance().defect.abs() < 1e-9, "{:?}", run.balance());
}

#[test]
fn an_input_that_was_no_number_leaves_the_balance_as_it_was() {
    let based: Based = Based { f: 1.0, k: 30.0, ..Based::default() };
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(based, method, 0.0).unwrap();
    let mut run = run.with_tolerance(Tolerance::new(1e-12));
    run.advance_to(0.5).unwrap();
    run.change(|based| based.k = f64::NAN);
    assert!(run.advance_to(1.0).is_err());
    run.change(|based| based.u.value = f64::INFINITY);
    run.change(|based| (based.k, based.u.value) = (80.0, 0.05));
    run.advance_to(1.0).unwrap();
    assert!(run.balance().defect.abs() < 1e-9, "{:?}", run.balance());
}

mechanism! {
    /// A crank at a speed from outside, with a mass.
    pub mechanism Cranked;
    input speed: rad/s;
    coord phi: rad = 0.3;
    body bob { mass: 2, com: 0.5m*unit(phi) }
    drive motor: rate(phi) == speed;
}

#[test]
fn a_speed_that_jumps_brings_energy_in_that_is_no_defect() {
    let cranked: Cranked = Cranked { speed: 4.0, ..Cranked::default() };
    let method = Explicit::new(RungeKutta4, Projection::default());
    let mut run = Simulation::start_near(cranked, method, 0.0, [0.3], [4.0]).unwrap();
    run.step_to(0.1, 10).unwrap();
    run.change(|cranked| cranked.speed = -1.0);
    run.step_to(0.2, 10).unwrap();
    assert!((run.qd()[0] + 1.0).abs() < 1e-12 && run.balance().defect.abs() < 1e-9, "{:?}", run.balance());
}
