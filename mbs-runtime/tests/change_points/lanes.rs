//! Lanes that fold flat at different steps, each as its stepper alone.

use mbs_runtime::{Batch, Lanes, Signal, Stepper};

use crate::linkage::{InAngles, Moving, PARALLELOGRAM, distance};

const LANES: usize = 4;

#[test]
fn a_lane_has_the_sign_of_its_own_determinant() {
    // Neighbours are on the two sides of the change point and in the two assemblies, and pass it at steps of their own.
    let (starts, sides) = ([0.5, -0.7, 0.9, -1.1], [1.0, -1.0, -1.0, 1.0]);
    let mut alone: [Stepper<InAngles, f64, 3>; LANES] =
        core::array::from_fn(|lane| Stepper::assembled(&PARALLELOGRAM, starts[lane], sides[lane]));
    let guesses = core::array::from_fn(|lane| *alone[lane].q());
    let theta = Signal { value: Lanes(starts), rate: Lanes([0.0; LANES]), acceleration: Lanes([0.0; LANES]) };
    let lanes = InAngles::<Lanes<f64, LANES>> { theta, ..Default::default() };
    let mut batch = Batch::assemble(lanes, &guesses, [0.0; LANES]).expect("assemblies");
    for k in 1..=25_u32 {
        let t = 0.1 * f64::from(k);
        let turned = |lane: usize| starts[lane] - starts[lane].signum() * 0.0673 * f64::from(k);
        let rate = |lane: usize| -0.673 * starts[lane].signum();
        batch.change(|lanes| {
            for lane in 0..LANES {
                (lanes.theta.value.0[lane], lanes.theta.rate.0[lane]) = (turned(lane), rate(lane));
            }
        });
        let steps = batch.advance_to([t; LANES]);
        for (lane, stepper) in alone.iter_mut().enumerate() {
            let signal = Signal { value: turned(lane), rate: rate(lane), acceleration: 0.0 };
            let step = stepper.follow(signal, t);
            assert_eq!(steps[lane].map(|_| ()), step.map(|_| ()), "step {k}, lane {lane}");
            let led = batch.stepper(lane).expect("a lane");
            assert!(distance(led.point(), stepper.point()) < 1e-11, "step {k}, lane {lane}");
            let right = PARALLELOGRAM.point(turned(lane), sides[lane]);
            assert!(
                distance(led.point(), right) < 1e-9,
                "step {k}, lane {lane}: {:?} {right:?}",
                led.point()
            );
            let passed = u32::from(turned(lane) * starts[lane] < 0.0);
            assert_eq!((led.passages(), stepper.passages()), (passed, passed), "step {k}, lane {lane}");
        }
    }
}
