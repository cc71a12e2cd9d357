//! T8: the homotopy of a lane that leaves its batch begins at its own parameters and inputs, not at those of a neighbouring lane.

use mbs_runtime::{Batch, Lanes, Stepper, mechanism};

mechanism! {
    /// A four-bar whose crank turns all the way round, by an input; its coupler is a parameter.
    pub mechanism FourBar;
    param coupler: m = 2.5;
    input theta: rad, rates;
    coord p2: rad = 0.8;
    coord p3: rad = 1.8;
    constraint loop1 { 1m*unit(theta) + coupler*unit(p2) == [3.5m, 0] + 2m*unit(p3); }
}

fn four_bar(theta: f64, coupler: f64) -> FourBar<f64> {
    let mut four_bar = FourBar { coupler, ..FourBar::default() };
    four_bar.theta.value = theta;
    four_bar
}

#[test]
fn a_lane_is_led_from_its_own_inputs_and_parameters() {
    let starts = [0.3, 1.9, 3.1, 5.0];
    let couplers = [2.5, 2.3, 2.6, 2.4];
    let steppers = core::array::from_fn::<_, 4, _>(|lane| {
        Stepper::assemble(four_bar(starts[lane], couplers[lane]), [0.8, 1.8], 0.0).expect("an assembly")
    });
    for (round, jump) in [0.4, -0.9, 1.6, -2.4, 2.9].into_iter().enumerate() {
        let mut alone = steppers;
        let mut lanes = FourBar::<Lanes<f64, 4>>::default();
        (lanes.theta.value, lanes.coupler) = (Lanes(starts), Lanes(couplers));
        let mut batch = Batch::assemble(lanes, &[[0.8, 1.8]; 4], [0.0; 4]).expect("assemblies");
        // Each by another jump, and the coupler a little; the second change follows on a step.
        for (k, share) in [1.0, -0.7].into_iter().enumerate() {
            let change = |lane: usize| share * jump * (1.0 - 0.17 * lane as f64);
            let together = batch.change(|lanes| {
                for lane in 0..4 {
                    lanes.theta.value.0[lane] += change(lane);
                    lanes.coupler.0[lane] += 0.01 * share;
                }
                *lanes
            });
            let steps = batch.advance_to([0.1 * (k + 1) as f64; 4]);
            for (lane, stepper) in alone.iter_mut().enumerate() {
                stepper.change(|own| {
                    own.theta.value = together.theta.value.0[lane];
                    own.coupler = together.coupler.0[lane];
                });
                let step = stepper.advance_to(0.1 * (k + 1) as f64).map(|_| ());
                assert_eq!(steps[lane].map(|_| ()), step, "{round}, {k}, lane {lane}");
                let q = batch.q().map(|q| q.0[lane]);
                let apart = q.iter().zip(stepper.q()).fold(0.0_f64, |apart, (a, b)| apart.max((a - b).abs()));
                assert!(apart < 1e-12, "{round}, {k}, lane {lane}: {apart:e}");
                let (led, own) = (batch.stepper(lane).expect("a lane"), &*stepper);
                assert_eq!(led.passages(), own.passages(), "{round}, {k}, lane {lane}");
            }
        }
    }
}
