//! A contact whose damping follows from the speed at touch, which a `latch` keeps.

use mbs_runtime::dynamics::{Direction, DormandPrince8, Explicit, Projection, Radau5, Simulation, Tolerance};
use mbs_runtime::mechanism;

use crate::Worst;

/// Root of c − ln(1 + c) = −e c − ln(1 − e c) for e = 0.8, by bisection in 30 digits.
const C: f64 = 0.373_146_203_365_053_67;

mechanism! {
    /// A ball between two walls, without other forces: each touch takes the same share of the speed.
    pub mechanism Between;
    param c: 1 = 0.373_146_203_365_053_67;
    param slowest: m/s = 10mm/1s;
    coord x: m = 0;
    body ball { mass: 0.2kg, com: [x, 0] }
    for i in 0..2 {
        contact wall { gap: 10mm - (2*i - 1)*x, stiffness: 1e6, exponent: 1.5, depth: 1mm, damping: c/max(speed[i], slowest) }
        event touches: gap(wall[i]) < 0;
        latch speed: m/s = -der(gap(wall[i])) at touches[i];
    }
    start x = 0 rate 2;
}

/// Speeds after each of the first touches.
macro_rules! speeds {
    ($integrator:expr, $tolerance:expr) => {{
        let method = Explicit::new($integrator, Projection::default());
        let run = Simulation::start_from_text(Between::default(), method, 0.0_f64).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new($tolerance));
        // Each touch lies between two passages of the middle.
        (1..=10)
            .map(|touch| {
                assert!(run.advance_until_event(1.0, Direction::Any, |_, q, _| q[0]).expect("a motion"));
                (touch, run.qd()[0].abs())
            })
            .collect::<Vec<(i32, f64)>>()
    }};
}

#[test]
fn a_latched_speed_gives_the_same_restitution_at_every_speed() {
    assert!((C - C.ln_1p() + 0.8 * C + (-0.8 * C).ln_1p()).abs() < 1e-15);
    let mut worst = Worst::of("contact with latched speed");
    for (touch, speed) in speeds!(DormandPrince8, 1e-12) {
        worst.see((speed / (2.0 * 0.8_f64.powi(touch)) - 1.0).abs(), 1e-9, touch);
    }
    for (touch, speed) in speeds!(Radau5, 1e-11) {
        worst.see((speed / (2.0 * 0.8_f64.powi(touch)) - 1.0).abs(), 1e-9, touch);
    }
}
