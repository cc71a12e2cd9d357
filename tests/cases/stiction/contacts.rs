//! Friction that sticks on the normal force of a contact, and its power in a state.

use mbs_cases::every;
use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, RungeKutta4, Simulation, Tolerance};
use mbs_runtime::{Real, mechanism};

mechanism! {
    /// A block on a contact, let go in its depth at rest or above it.
    pub mechanism Block;
    param pull: m/s^2 = 1;
    param v0: m/s = 0;
    param height: m = 0;
    coord p: [m; 2] = [0, 0];
    body block { mass: 1kg, com: p }
    gravity weight { acceleration: [pull, -9.81] }
    contact floor { gap: p[1], stiffness: 1e4 }
    friction rub { along: p[0], normal: normal(floor), coefficient: 0.2, sticks: 0.3 }
    start p = [0, height - 0.981mm] rate [v0, 0];
}

#[test]
fn on_a_contact_it_slides_sticks_and_goes_on() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let block = Block { pull: 0.0, v0: -2.0, ..Block::default() };
    let run = Simulation::start_from_text(block, method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-10));
    run.advance_to(10.0).expect("it comes to rest");
    let end = -4.0 / (2.0 * 0.2 * 9.81);
    assert!((run.q()[0] - end).abs() < 1e-9 && run.qd()[0] == 0.0, "{:?} {end}", run.instant());
    run.change(|block| block.pull = -4.0);
    run.advance_to(11.0).expect("it slides");
    let exact = end - 0.5 * (4.0 - 0.2 * 9.81);
    assert!((run.q()[0] - exact).abs() < 1e-9, "{:?} {exact}", run.instant());
}

/// Steps of fixed size into a contact: a friction at rest there was taken for one that slips at once, until the step was refused.
#[test]
fn equal_steps_bounce_as_adaptive_ones() {
    let block = Block { pull: 0.0, v0: 1.0, height: 0.1 };
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(block, method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-10));
    run.advance_to(1.0).expect("it bounces");
    assert!(run.qd()[0] == 0.0 && run.balance().defect.abs() < 1e-8, "{:?}", run.instant());
    for steps in [500, 4000].into_iter().step_by(every(2)) {
        let method = Explicit::new(RungeKutta4, Projection::default());
        let mut fixed = Simulation::start_from_text(block, method, 0.0_f64).expect("it starts");
        fixed.step_to(1.0, steps).unwrap_or_else(|failure| panic!("{steps}: {failure}"));
        let off = [fixed.q()[0] - run.q()[0], fixed.q()[1] - run.q()[1]];
        // Of order 4 in steps of 0.2 rad of the contact's vibration and below.
        let bound = 2e-5 * (500.0 / f64::from(steps)).powi(4);
        assert!(off.iter().all(|off| off.abs() < bound.max(1e-9)), "{steps}: {off:?} {bound:e}");
    }
}

mechanism! {
    /// Blocks on each other, the lower one pushed to and fro; what the frictions lose heats them.
    pub mechanism Warm;
    coord x: [m; 2] = 0;
    state heat: J;
    state given: J;
    for i in 0..2 { body block { mass: 1kg, com: [x[i], i*1m] } }
    friction ground { along: x[0], normal: 10N, coefficient: 0.2, sticks: 0.3 }
    friction top { along: x[1] - x[0], normal: 9.81N, coefficient: 0.1, sticks: 0.2 }
    force push: 4 [N]*sin(1 [rad/s]*t) on x[0];
    der(heat) == -power(ground) - power(top);
    der(given) == power(push);
}

#[test]
fn the_heat_is_the_work_that_is_missing() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Warm::default(), method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-10));
    run.advance_to(10.0).expect("it moves");
    let [heat, given] = *run.states();
    assert!(heat > 10.0 && (given - heat - run.balance().energy.kinetic).abs() < 1e-7, "{:?}", run.instant());
}

mechanism! {
    /// A heavy body that slides to rest on rigid ground, a light one beside it, and one that a belt holds.
    pub mechanism Company;
    coord heavy: [m; 2] = [0, 0];
    coord light: [m; 2] = [0, 0];
    coord held: m = 0;
    body heavy_body { mass: 2kg, com: heavy }
    body light_body { mass: 0.2kg, com: light }
    body held_body { mass: 1kg, com: [held, 0] }
    gravity weight { acceleration: [0, -9.81] }
    contact ground { gap: heavy[1], restitution: 0 }
    contact floor { gap: light[1], restitution: 0 }
    friction rub { along: heavy[0], normal: normal(ground), coefficient: 0.3, sticks: 0.4 }
    friction belt { along: held - 0.1 [m/s]*t, normal: 9.81N, coefficient: 0.1, sticks: 0.15 }
    start heavy = [0, 0] rate [1, 0];
    start held = 0 rate 0.1;
}

/// Rows that stick of different masses and limits are no rows that follow from others, in single precision either.
#[test]
fn a_body_comes_to_rest_beside_light_ones_and_tight_ones() {
    fn stops<R: Real>(allowed: f64) {
        let method = Explicit::new(DormandPrince8, Projection::default());
        let run = Simulation::start_from_text(Company::<R>::default(), method, R::constant(0.0));
        let mut run = run.expect("it starts").with_tolerance(Tolerance::new(1e-5));
        run.advance_to(R::constant(0.6)).expect("it comes to rest");
        let end = 1.0 / (2.0 * 0.3 * 9.81);
        let [place, height, _, _, held] = run.q().map(Real::to_f64);
        assert!((place - end).abs() < allowed && height == 0.0, "{place} {end} {height}");
        assert!((held - 0.06).abs() < allowed, "{held}");
        assert!(run.qd()[0].to_f64().abs() < 1e-12, "{:e}", run.qd()[0].to_f64());
    }
    stops::<f32>(1e-6);
    stops::<f64>(1e-12);
}
