//! K7: a drive that prescribes a rate gained speed at late times, at which the difference of two rounded times is not the step.

use mbs_runtime::{Batch, Budget, Lanes, Real, Step, Stepper, mechanism};

mechanism! {
    /// A crank with a slider; its rate, a part that varies in time, and one by an input.
    pub mechanism Slider;
    param omega: rad/s = 10;
    param wave: rad/s = 0;
    input more: rad/s;
    coord phi: rad = 0.25;
    coord x: m = 0.3;
    constraint rod { x == 0.1m*cos(phi) + 0.3m; }
    drive crank: rate(phi) == omega + wave*sin(t/1s) + more;
}

const GUESS: [f64; 2] = [0.25, 0.4];

/// Late times (s), of which the last is a day short of four months.
const LATE: [f64; 4] = [0.0, 1e3, 1e6, 1e7];

fn late<R: Real>(t: f64, wave: f64) -> Stepper<Slider<R>, R, 2> {
    let slider = Slider { wave: R::constant(wave), ..Slider::default() };
    Stepper::assemble(slider, GUESS.map(R::constant), R::constant(t)).expect("it assembles")
}

#[test]
fn a_plain_rate_drive_gains_no_speed_at_late_times() {
    for start in LATE {
        for h in [1e-3, 1.7e-3, 1.0 / 3.0 * 1e-2, -1e-3] {
            let mut slider = late::<f64>(start, 0.0);
            let count = 20_000;
            for _ in 0..count {
                slider.advance(h).expect("it moves");
            }
            let passed = f64::from(count) * h;
            // Compensated sums: the rounding of the angle itself, at most 670 rad, and of its guess.
            let error = slider.q()[0] - (0.25 + 10.0 * passed);
            assert!(error.abs() < 4e-13, "{start} {h}: {error:e}");
            assert!((slider.t() - (start + passed)).abs() <= f64::EPSILON * (start + 50.0), "{}", slider.t());
            assert!((slider.qd()[0] - 10.0).abs() < 1e-13);
        }
    }
}

#[test]
fn a_rate_that_varies_is_integrated_over_the_time_that_passes() {
    for start in LATE {
        let mut slider = late::<f64>(start, 3.0);
        for _ in 0..10_000 {
            slider.advance(1e-3).expect("it moves");
        }
        let end = start + 10.0;
        let exact = 0.25 + 10.0 * 10.0 + 3.0 * (start.cos() - end.cos());
        let error = slider.q()[0] - exact;
        // The wave is taken at times that are rounded by 1e-9 s at most.
        assert!(error.abs() < 1e-12 + 2.0 * f64::EPSILON * start, "{start}: {error:e}");
    }
}

#[test]
fn steps_of_bounded_work_and_missed_ones_keep_the_phase() {
    let budget = Budget { newton: 4, fallback: 4 };
    for start in LATE {
        let (mut stepped, mut skipped) = (late::<f64>(start, 0.0), late::<f64>(start, 0.0));
        for _ in 0..3_000 {
            for _ in 0..3 {
                assert!(matches!(stepped.step(1.1e-3, budget), Step::Done(_)));
            }
            assert!(matches!(skipped.skip(1.1e-3, 3, budget), Step::Done(_)));
        }
        assert_eq!((stepped.q(), stepped.t()), (skipped.q(), skipped.t()));
        let error = stepped.q()[0] - (0.25 + 10.0 * 9_000.0 * 1.1e-3);
        assert!(error.abs() < 1e-13, "{start}: {error:e}");
    }
}

#[test]
fn steps_by_duration_and_to_a_time_may_be_mixed() {
    for start in LATE {
        let mut slider = late::<f64>(start, 0.0);
        for k in 1..=5_000 {
            slider.advance(1e-3).expect("it moves");
            slider.advance(0.7e-3).expect("it moves");
            slider.advance_to(start + 2e-3 * f64::from(k)).expect("it moves");
        }
        // To a time: the angle is that of the time as it is given.
        let error = slider.q()[0] - (0.25 + 10.0 * (slider.t() - start));
        assert!(error.abs() < 1e-13, "{start}: {error:e}");
    }
}

#[test]
fn changed_rates_and_refused_steps_leave_no_trace() {
    let mut slider = late::<f64>(1e6, 0.0);
    let mut exact = 0.25;
    for k in 0..5_000 {
        let more = if k % 2 == 0 { 5.0 } else { -3.0 };
        slider.change(|slider| slider.more = f64::NAN);
        assert!(slider.advance(1e-3).is_err());
        slider.change(|slider| slider.more = more);
        slider.advance(1e-3).expect("it moves");
        exact += 1e-3 * (10.0 + more);
    }
    assert!((slider.q()[0] - exact).abs() < 1e-11, "{:e}", slider.q()[0] - exact);
}

#[test]
fn single_precision_keeps_the_phase_where_its_time_is_coarse() {
    // At 3000 s the time has a resolution of 0.24 ms.
    let mut slider = late::<f32>(3e3, 0.0);
    for _ in 0..10_000 {
        slider.advance(1e-3).expect("it moves");
    }
    let exact = 0.25 + 10.0 * 10_000.0 * f64::from(1e-3_f32);
    let error = f64::from(slider.q()[0]) - exact;
    // Half the resolution of an angle of 100 rad.
    assert!(error.abs() < 4e-6, "{error:e}");
    assert!((f64::from(slider.t()) - 3010.0).abs() < 2.5e-4, "{}", slider.t());
}

#[test]
fn lanes_at_late_times_have_the_angle_of_their_times() {
    let mechanism = Slider::<Lanes<f64, 4>>::default();
    let mut batch = Batch::<_, f64, 4, 2>::assemble(mechanism, &[GUESS; 4], LATE).expect("it assembles");
    for k in 1..=5_000 {
        let t = LATE.map(|start| start + 1e-3 * f64::from(k));
        assert!(batch.advance_to(t).iter().all(Result::is_ok));
    }
    for (lane, start) in LATE.into_iter().enumerate() {
        let passed = batch.t().0[lane] - start;
        assert!((batch.q()[0].0[lane] - (0.25 + 10.0 * passed)).abs() < 1e-13);
        // A lane on its own goes on by durations.
        let mut alone = batch.stepper(lane).expect("a lane");
        for _ in 0..5_000 {
            alone.advance(1e-3).expect("it moves");
        }
        let error = alone.q()[0] - (0.25 + 10.0 * (passed + 5.0));
        assert!(error.abs() < 2e-13, "{start}: {error:e}");
    }
}
