//! D5: normal forces that are a smooth law of a multiplier, in implicit methods: rounding of a balance is not jamming.

use mbs_cases::every;
use mbs_runtime::dynamics::{AugmentedLagrangian, Extrapolated, Method, Simulation};
use mbs_runtime::mechanism;

mechanism! {
    /// A crank press whose guide has |λ| rounded off, so that its friction is solved by Newton's method.
    mechanism Rounded;
    param edge: N = 1e-6;
    coord phi: rad = 0.3;
    coord psi: rad = -0.24;
    coord x: m = 0.1;
    coord y: m = 0;
    body crank { mass: 1, inertia: 2e-3, com: [0, 0], angle: phi }
    body slider { mass: 0.4, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    torque drive: 0.3N*1m on phi;
    constraint rod { 50mm*unit(phi) + 60mm*unit(psi) == [x, y]; }
    constraint guide { y == 0m; }
    friction rub { along: x, normal: sqrt(lambda(guide)^2 + edge^2), coefficient: 0.3, speed: 0.02 }
    start phi = 0.3 rate 40;
}

/// Angle of the crank after 0.2 s (rad) with |λ|: one equation by hand, its sign of λ by cases, by DOP853 at 1e-12.
const ANGLE: f64 = 8.521_576_707;

fn turned(method: impl Method<Rounded, f64, 4, 3>, edge: f64, steps: u32) -> f64 {
    let rounded = Rounded { edge };
    let mut run = Simulation::start_from_text(rounded, method, 0.0).expect("it starts");
    run.step_to(0.2, steps).unwrap_or_else(|failure| panic!("{edge} N, {steps} steps: {failure}"));
    run.q()[0]
}

#[test]
fn normal_forces_that_are_smooth_in_a_multiplier_do_not_jam_implicit_methods() {
    for edge in [1e-9, 1e-6, 1e-3].into_iter().step_by(every(2)) {
        let mut worst = [0.0_f64; 2];
        for steps in [200, 261, 340, 480].into_iter().step_by(every(2)) {
            let found = [turned(AugmentedLagrangian, edge, steps), turned(Extrapolated, edge, steps)];
            worst.iter_mut().zip(found).for_each(|(worst, found)| *worst = worst.max((found - ANGLE).abs()));
        }
        println!("{edge:e} N: {worst:?}");
        assert!(worst[0] < 2e-3 && worst[1] < 2e-4, "{edge:e} N: {worst:?}");
    }
}
