//! D29: steps of the augmented Lagrangian ended with rows that were open, by 3.65 m of a rod of 1 m.

use mbs_cases::every;
use mbs_runtime::dynamics::{
    AugmentedLagrangian, Explicit, Extrapolated, GeneralizedAlpha, Method, Projection, Radau5, RungeKutta4,
    Simulation, VelocityTransformation,
};
use mbs_runtime::mechanism;

mechanism! {
    /// A pendulum as a point on a rod.
    pub mechanism Pendulum;
    coord p: [m; 2] = [1, 0];
    body bob { mass: 1, com: p }
    gravity weight { acceleration: [0, -9.81] }
    constraint rod { norm(p) == 1m; }
    start p = [1, 0] rate [0, 0];
}

/// The largest distance from the rod after steps that are `Ok`, of lengths from 0.1 ms to 1e12 s; and their number.
fn distance<X: Method<Pendulum<f64>, f64, 2, 1> + Copy>(method: X) -> (f64, u32) {
    let mut worst = (0.0_f64, 0);
    for exponent in (-8..24).step_by(every(4)) {
        let h = 10.0_f64.powf(0.5 * f64::from(exponent));
        let mut run = Simulation::start_from_text(Pendulum::default(), method, 0.0).expect("a start");
        for _ in 0..5 {
            if run.step(h).is_err() {
                break;
            }
            let [x, y] = *run.q();
            worst = (worst.0.max((x.hypot(y) - 1.0).abs()), worst.1 + 1);
        }
    }
    worst
}

#[test]
fn a_step_that_is_taken_ends_on_the_rows() {
    let ends = [
        ("augmented Lagrangian", distance(AugmentedLagrangian)),
        ("extrapolated", distance(Extrapolated)),
        ("generalised alpha", distance(GeneralizedAlpha::default())),
        ("all damped", distance(GeneralizedAlpha { rho: 0.0 })),
        ("not damped", distance(GeneralizedAlpha { rho: 1.0 })),
        ("Runge-Kutta", distance(Explicit::new(RungeKutta4, Projection::default()))),
        ("independent", distance(Explicit::new(RungeKutta4, VelocityTransformation))),
        ("Radau", distance(Explicit::new(Radau5, Projection::default()))),
    ];
    for (method, (distance, steps)) in ends {
        // 64 ε of the row's scale and 4 ε of its coordinates: the tolerance of positions.
        assert!(
            steps > 20 / every(4) as u32 && distance < 68.0 * f64::EPSILON,
            "{method}: {distance:e} after {steps} steps"
        );
    }
}
