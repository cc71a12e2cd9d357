//! D4: a start that is zero but for rounding.

use super::texts::Ball;
use mbs_runtime::dynamics::{DormandPrince5, DormandPrince8, Explicit, Projection, Simulation};
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism Pushed;
    input push: N;
    coord phi: rad = 0;
    coord x: m = 0;
    body cart { mass: 1, com: [x, 0] }
    body wheel { mass: 1, com: [x, 0], inertia: 1e-2, angle: phi }
    force hand: [push, 0] on [x, 0];
    tsda spring { from: [-1, 0], to: [x, 0], stiffness: 100, length: 1m }
}

#[test]
fn a_start_that_is_zero_but_for_rounding_runs() {
    for exponent in [0, -3, -8, -12, -16, -17, -30, -100, -300] {
        let small = if exponent == 0 { 0.0 } else { 6.0 * 10.0_f64.powi(exponent) };
        for (q, qd) in [(0.0, small), (small, 0.0), (small, small), (-small, small)] {
            for until in [1e-3, 1.0, 10.0, 1000.0] {
                let method = Explicit::new(DormandPrince8, Projection::default());
                let mut run = Simulation::start(Ball::default(), method, 0.0, [q], [qd]).expect("a start");
                run.advance_to(until).unwrap_or_else(|failure| panic!("{q:e} {qd:e} {until}: {failure}"));
                let y = q + qd * until - 0.5 * 9.81 * until * until;
                assert!((run.q()[0] - y).abs() <= 1e-12 * y.abs().max(1.0), "{q:e} {qd:e} {until}");
            }
        }
    }
}

#[test]
fn rest_but_for_rounding_with_a_spring_runs() {
    for small in [0.0, 6e-17, 1e-13, 1e-9] {
        for until in [0.1, 5.0, 100.0] {
            let method = Explicit::new(DormandPrince5, Projection::default());
            let start = Simulation::start(Pushed { push: 2.0 }, method, 0.0, [small, -small], [small, small]);
            let mut run = start.expect("a start");
            run.advance_to(until).unwrap_or_else(|failure| panic!("{small:e} {until}: {failure}"));
            // Two masses of 1 kg together on 100 N/m, pushed by 2 N from rest.
            let x = 0.02 * (1.0 - (50.0_f64.sqrt() * until).cos());
            assert!((run.q()[1] - x).abs() < 1e-6 + 2e-9 * until + small, "{} {x}", run.q()[1]);
        }
    }
}
