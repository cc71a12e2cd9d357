//! Extrapolated steps resolve the bend of a friction wherever the frame stands.
//!
//! A step might differ from its thirds by 1e-7 of the coordinates: 600 m away a block slid twice as far as it does.

use mbs_runtime::dynamics::{Extrapolated, Simulation};
use mbs_runtime::mechanism;

mechanism! {
    /// A block on a slope of 30° whose friction is a ten-thousandth below what would hold it, in a frame that is moved.
    mechanism FrictionLimit;
    const SLOPE: rad = 30deg;
    /// Place in metres: a length would be a reference length of the text.
    param away: 1 = 0;
    coord P: [m; 2] = [0, 0];
    let from = P - [away*1m, -away*1m];
    let x = dot(from, unit(SLOPE));
    body block { mass: 1, com: P }
    gravity weight { acceleration: [0, -9.81] }
    constraint ground { dot(from, unit(SLOPE + 90deg)) == 0m; }
    friction rub { along: x, normal: lambda(ground), coefficient: tan(SLOPE) - 1e-4, speed: 1mm/1s }
    start P = [away*1m, -away*1m] rate [0, 0];
    out way: m = -x;
}

#[test]
fn a_block_slides_alike_in_every_frame() {
    // v̇ = g (sin α − μ cos α tanh(v/v₀)), Radau at 1e-13.
    const WAY: f64 = 0.010_577_582_762_810_05;
    for away in [0.0, 6.0, -600.0] {
        let block = FrictionLimit { away };
        for steps in [128, 256] {
            let mut run = Simulation::start_from_text(block, Extrapolated, 0.0).expect("it starts");
            run.step_to(2.0, steps).expect("it slides");
            let off = run.outputs()[0].value - WAY;
            assert!(off.abs() < 1e-6, "{away} {steps}: {off:e}");
        }
    }
}
