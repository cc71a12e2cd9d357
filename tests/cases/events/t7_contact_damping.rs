//! T7: a contact's damping factor without its max, which would pull.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation};
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism Sticky;
    param d: s/m = 0.5;
    coord y: m = 0;
    body ball { mass: 2, com: [0, y] }
    contact floor { gap: y, stiffness: 1000, damping: d }
    contact soft { gap: y, stiffness: 1000, exponent: 1.5, depth: 10mm, damping: d }
}

/// q̈ of a ball that is `depth` (m) deep and rises at `speed` (m/s).
fn acceleration(depth: f64, speed: f64) -> f64 {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start(Sticky::default(), method, 0.0, [-depth], [speed]);
    run.expect("a start").qdd()[0]
}

#[test]
fn a_contact_that_opens_fast_does_not_pull() {
    for (depth, speed) in [(0.01, 2.0), (0.01, 2.1), (0.02, 10.0), (0.001, 1e3)] {
        assert_eq!(acceleration(depth, speed), 0.0, "{depth} {speed}");
    }
    for (depth, speed) in [(0.01, 1.99), (0.01, 0.0), (0.02, -3.0), (0.005, 1.0), (-0.01, -3.0)] {
        let p = f64::max(depth, 0.0);
        let force = (1000.0 * p + 10.0 * (p / 0.01).powf(1.5)) * (1.0 - 0.5 * speed);
        let found = acceleration(depth, speed);
        assert!((found - 0.5 * force).abs() <= 1e-12 * force.abs(), "{found} {force}");
    }
}
