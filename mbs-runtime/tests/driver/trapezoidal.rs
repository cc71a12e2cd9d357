//! Trapezoidal velocity.

use mbs_runtime::Function;
use mbs_runtime::driver::{LawError, Trapezoidal};

use crate::checks::{
    assert_continuity, assert_differences_converge, assert_lanes_agree, assert_nan_stays, assert_near,
    assert_single_precision,
};

#[test]
fn a_long_way_is_a_trapezoid() {
    let slide = Trapezoidal::new(3.0, 1.0, 2.0).expect("a motion");
    assert_eq!((slide.duration(), slide.speed()), (3.5, 1.0));
    let expected = |t: f64| match t {
        t if t < 0.5 => [t * t, 2.0 * t, 2.0],
        t if t < 3.0 => [0.25 + (t - 0.5), 1.0, 0.0],
        t => [3.0 - (3.5 - t).powi(2), 2.0 * (3.5 - t), -2.0],
    };
    for step in 0..350 {
        let t = 0.01 * f64::from(step);
        assert_near::<3>(slide.jet(t), &expected(t), &[1e-15; 3], &format!("{t}"));
    }
    assert_eq!(slide.jet(-1.0), [0.0; 4]);
    assert_eq!(slide.jet(9.0), [3.0, 0.0, 0.0, 0.0]);
    assert_differences_converge(&slide, &[-1.0, 0.25, 1.0, 3.25], 1e-2);
}

#[test]
fn a_short_way_is_a_triangle() {
    let slide = Trapezoidal::new(-0.5, 10.0, 2.0).expect("a motion");
    assert_eq!((slide.duration(), slide.speed()), (1.0, -1.0));
    assert_eq!(slide.jet(0.5), [-0.25, -1.0, 2.0]);
    // At the limit between the two there is no cruise.
    let limit = Trapezoidal::new(0.5, 1.0, 2.0).expect("a motion");
    assert_eq!((limit.duration(), limit.speed()), (1.0, 1.0));
    let nowhere = Trapezoidal::new(0.0, 1.0, 1.0).expect("rest");
    assert_eq!((nowhere.duration(), nowhere.jet(0.0)), (0.0, [0.0; 3]));
}

#[test]
fn no_limit_is_exceeded() {
    for step in 1..200 {
        let distance = 0.013 * f64::from(step);
        let slide = Trapezoidal::new(distance, 0.7, 1.3).expect("a motion");
        for instant in 0..100 {
            let [_, speed, acceleration]: [f64; 3] = slide.jet(slide.duration() * f64::from(instant) / 99.0);
            // The acceleration comes back from the distance: a few roundings.
            assert!(speed.abs() <= 0.7 * (1.0 + 1e-15) && acceleration.abs() <= 1.3 * (1.0 + 4e-15));
        }
    }
}

#[test]
fn the_velocity_is_continuous_and_the_acceleration_jumps() {
    let slide = Trapezoidal::new(3.0, 1.0, 2.0).expect("a motion");
    let mut t = -1.0;
    for (place, jump) in [(0.0, 2.0), (0.5, -2.0), (3.0, -2.0), (3.5, 2.0)] {
        assert_eq!(Function::<f64>::breakpoint_after(&slide, t), Some(place));
        assert_continuity(&slide, place, jump);
        t = place;
    }
    assert_eq!(Function::<f64>::breakpoint_after(&slide, t), None);
}

#[test]
fn lanes_and_single_precision_agree() {
    let slide = Trapezoidal::new(3.0, 1.0, 2.0).expect("a motion");
    let places: [f64; 60] = core::array::from_fn(|step| 0.07 * step as f64 - 0.3);
    for four in places.chunks_exact(4).map(|four| [four[0], four[1], four[2], four[3]]) {
        assert_lanes_agree(&slide, four);
    }
    assert_single_precision(&slide, &places, [3.0, 1.0, 2.0, 0.0], 2.0);
    assert_nan_stays(&slide);
}

#[test]
fn impossible_motions_are_refused() {
    assert_eq!(Trapezoidal::new(1.0, 0.0, 1.0), Err(LawError::NotPositive("speed")));
    assert_eq!(Trapezoidal::new(1.0, 1.0, -1.0), Err(LawError::NotPositive("acceleration")));
    assert_eq!(Trapezoidal::new(f64::NAN, 1.0, 1.0), Err(LawError::NotFinite("distance")));
    assert_eq!(
        Trapezoidal::from_times(1.0, 0.0, 1.0),
        Err(LawError::NotPositive("time of the acceleration"))
    );
    assert_eq!(Trapezoidal::from_times(1.0, 1.0, -1.0), Err(LawError::Negative("time")));
}
