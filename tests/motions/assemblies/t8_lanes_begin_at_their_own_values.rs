//! T8: the homotopy of a lane that leaves its batch begins at its own parameters and inputs, not at those of a neighbouring lane.

use core::mem::discriminant;

use mbs_runtime::{Batch, Failure, Lanes, Stepper, mechanism};

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

mechanism! {
    /// A four-bar whose crank comes as far as the diagonal is shorter than the other two bars: 1.427 rad.
    pub mechanism Held;
    input theta: rad, rates;
    coord p2: rad = 0.5;
    coord p3: rad = 1.5;
    constraint loop1 { 1m*unit(theta) + 1.5m*unit(p2) == [3.5m, 0] + 2m*unit(p3); }
}

/// Steps that fail in one lane and not in its neighbours: what each lane was changed from is its own.
#[test]
fn a_lane_that_failed_begins_where_it_was_solved() {
    let mut random = crate::linkages::follow::Random(8);
    let (mut failed, mut moved) = (0, 0);
    for _ in 0..20 {
        let starts: [f64; 4] = core::array::from_fn(|_| random.between(-0.5, 0.5));
        let of = |theta: f64| {
            let mut held = Held::<f64>::default();
            held.theta.value = theta;
            Stepper::assemble(held, [0.5, 1.5], 0.0).expect("an assembly")
        };
        let mut alone = starts.map(of);
        let mut lanes = Held::<Lanes<f64, 4>>::default();
        lanes.theta.value = Lanes(starts);
        let mut batch = Batch::assemble(lanes, &[[0.5, 1.5]; 4], [0.0; 4]).expect("assemblies");
        for k in 1..=50 {
            let t = 0.1 * f64::from(k);
            // Every third step without a change: a lane that failed is still one that was changed, its neighbours are not.
            let still = k % 3 == 0;
            // Near the last value, anywhere, or where there is no position; some lanes are left as they are.
            let next: [f64; 4] = core::array::from_fn(|lane| match random.between(0.0, 4.0) as u32 {
                0 => alone[lane].mechanism().theta.value,
                1 => alone[lane].mechanism().theta.value + random.between(-0.01, 0.01),
                _ => random.between(-2.2, 2.2),
            });
            if !still {
                batch.change(|lanes| lanes.theta.value = Lanes(next));
            }
            let steps = batch.advance_to([t; 4]);
            for (lane, stepper) in alone.iter_mut().enumerate() {
                if !still {
                    stepper.change(|own| own.theta.value = next[lane]);
                }
                let step = stepper.advance_to(t).map(|_| ());
                // What is left of a row that cannot close has digits of its own.
                let kind = |step: Result<(), Failure>| step.map_err(|failure| discriminant(&failure.kind));
                assert_eq!(kind(steps[lane].map(|_| ())), kind(step), "{k}, lane {lane}");
                let apart = batch.q().iter().zip(stepper.q()).map(|(a, b)| (a.0[lane] - b).abs());
                assert!(
                    apart.fold(0.0, f64::max) < 1e-11,
                    "{k}, lane {lane}: {:?} {:?}",
                    batch.q(),
                    stepper.q()
                );
                let led = batch.stepper(lane).expect("a lane");
                assert_eq!(led.passages(), stepper.passages(), "{k}, lane {lane}");
                // Those of the position, not those of a step that failed.
                assert_eq!(led.save().values(), stepper.save().values(), "{k}, lane {lane}");
                (failed, moved) = (failed + u32::from(step.is_err()), moved + u32::from(step.is_ok()));
            }
        }
    }
    assert!(failed > 500 && moved > 500, "{failed} {moved}");
}
