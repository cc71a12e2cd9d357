//! Harmonic, polynomial, and single rises.

use core::f64::consts::TAU;

use mbs_runtime::Function;
use mbs_runtime::driver::{
    Cubic, Cycloid, Harmonic, Law, LawError, Polynomial, Polynomial345, Polynomial4567, Rise,
};

use crate::checks::{
    assert_continuity, assert_differences_converge, assert_lanes_agree, assert_nan_stays, assert_near,
    assert_single_precision,
};
use crate::series::Series;

#[allow(clippy::approx_constant, reason = "the lecture's own number")]
const FREQUENCY: f64 = 3.14159;
const HARMONIC: Harmonic = Harmonic { offset: 1.0, amplitude: 2.0, frequency: FREQUENCY, phase: 4.0 };
const CUBIC: Cubic = Cubic { coefficients: [20.0, 2.0, 4.0, 2.0] };

/// Lengths and angles of the rises below.
const START: f64 = 0.5;
const DURATION: f64 = 2.0;
const FROM: f64 = -0.25;
const TO: f64 = 1.5;

fn rise<L: Law>() -> Rise<L> {
    Rise::new(START, DURATION, FROM, TO).expect("a rise")
}

/// The formulas of the text books, in u.
fn formula_345(u: Series) -> Series {
    u.power(3) * 10.0 - u.power(4) * 15.0 + u.power(5) * 6.0
}

fn formula_4567(u: Series) -> Series {
    u.power(4) * 35.0 - u.power(5) * 84.0 + u.power(6) * 70.0 - u.power(7) * 20.0
}

fn formula_cycloid(u: Series) -> Series {
    u - (u * TAU).sin() * (1.0 / TAU)
}

#[track_caller]
fn assert_follows<L: Law>(formula: fn(Series) -> Series) {
    let rise = rise::<L>();
    for step in 0..=64 {
        let x = START + DURATION * f64::from(step) / 64.0;
        let u = (Series::variable(x) - Series::number(START)) * (1.0 / DURATION);
        let expected = (Series::number(FROM) + formula(u) * (TO - FROM)).derivatives();
        // The oracle sums powers with coefficients up to 84·7·6·5·4: 70 000 in the fourth derivative.
        assert_near::<5>(rise.jet(x), &expected, &[1e-13, 1e-13, 1e-12, 1e-11, 1e-10], &format!("{x}"));
    }
}

#[test]
fn the_harmonic_is_its_formula() {
    for step in -50..50 {
        let x = 0.37 * f64::from(step);
        let phase = Series::variable(x) * FREQUENCY - Series::number(4.0);
        let expected = (Series::number(1.0) + phase.sin() * 2.0).derivatives();
        // The phase, up to 58, is rounded in another order: 2 ε of it times the next derivative.
        let bounds: [f64; 8] = core::array::from_fn(|order| 2e-14 * 2.0 * FREQUENCY.powi(order as i32) * 2.0);
        assert_near::<8>(HARMONIC.jet(x), &expected, &bounds, "harmonic");
    }
    assert_differences_converge(&HARMONIC, &[-1.0, 0.2, 3.0], 1e-2);
}

#[test]
fn the_polynomial_is_its_formula() {
    let quintic = Polynomial { coefficients: [0.5, -1.0, 0.25, 2.0, -0.125, 0.0625] };
    for step in -20..20 {
        let x = 0.125 * f64::from(step);
        let u = Series::variable(x);
        // Sixteenths and powers of an eighth: every operation is exact.
        let expected = (Series::number(20.0) + u * 2.0 + u.power(2) * 4.0 + u.power(3) * 2.0).derivatives();
        assert_near::<8>(CUBIC.jet(x), &expected, &[0.0; 8], "cubic");
        let expected = (Series::number(0.5) - u + u.power(2) * 0.25 + u.power(3) * 2.0 - u.power(4) * 0.125
            + u.power(5) * 0.0625)
            .derivatives();
        assert_near::<8>(quintic.jet(x), &expected, &[0.0; 8], "quintic");
    }
    let empty: [f64; 3] = Polynomial { coefficients: [] }.jet(1.0);
    assert_eq!(empty, [0.0; 3]);
}

#[test]
fn the_rises_are_the_formulas_of_the_text_books() {
    assert_follows::<Polynomial345>(formula_345);
    assert_follows::<Polynomial4567>(formula_4567);
    assert_follows::<Cycloid>(formula_cycloid);
    let places = [0.7, 1.3, 1.6, 2.2];
    assert_differences_converge(&rise::<Polynomial345>(), &places, 1e-2);
    assert_differences_converge(&rise::<Polynomial4567>(), &places, 1e-2);
    assert_differences_converge(&rise::<Cycloid>(), &places, 1e-2);
}

#[test]
fn a_rise_ends_exactly_at_rest() {
    #[track_caller]
    fn check<L: Law>() {
        for (place, height) in
            [(START, FROM), (START + DURATION, TO), (-1e9, FROM), (START + DURATION + 1e-12, TO), (1e9, TO)]
        {
            assert_eq!(rise::<L>().jet(place), [height, 0.0, 0.0], "at {place}");
        }
    }
    check::<Polynomial345>();
    check::<Polynomial4567>();
    check::<Cycloid>();
    let fourth: [f64; 4] = rise::<Polynomial4567>().jet(START + DURATION);
    assert_eq!(fourth[3], 0.0);
}

#[test]
fn a_rise_has_the_continuity_that_its_law_claims() {
    let rise_over = |power: i32| (TO - FROM) / DURATION.powi(power);
    let ends = [START, START + DURATION];
    for (place, sign) in ends.into_iter().zip([1.0, -1.0]) {
        assert_continuity(&rise::<Polynomial345>(), place, sign * 60.0 * rise_over(3));
        assert_continuity(&rise::<Cycloid>(), place, sign * TAU * TAU * rise_over(3));
        // The fourth derivative is odd about the middle: −840 before the end.
        assert_continuity(&rise::<Polynomial4567>(), place, 840.0 * rise_over(4));
    }
    let next = |x| Function::<f64>::breakpoint_after(&rise::<Cycloid>(), x);
    assert_eq!([-9.0, 0.5, 2.5].map(next), [Some(0.5), Some(2.5), None]);
}

#[test]
fn lanes_and_single_precision_agree() {
    let places: [f64; 40] = core::array::from_fn(|step| 0.0625 * step as f64 + 0.01);
    for four in places.chunks_exact(4).map(|four| [four[0], four[1], four[2], four[3]]) {
        assert_lanes_agree(&HARMONIC, four);
        assert_lanes_agree(&CUBIC, four);
        assert_lanes_agree(&rise::<Polynomial345>(), four);
        assert_lanes_agree(&rise::<Polynomial4567>(), four);
        assert_lanes_agree(&rise::<Cycloid>(), four);
    }
    // Largest sums of absolute terms in u ≤ 1/2 over the durations, rounded up.
    assert_single_precision(&rise::<Polynomial345>(), &places, [2.0, 4.0, 10.0, 40.0], 4.0);
    assert_single_precision(&rise::<Polynomial4567>(), &places, [3.0, 8.0, 30.0, 150.0], 4.0);
    assert_single_precision(&rise::<Cycloid>(), &places, [2.0, 2.0, 6.0, 20.0], 8.0);
    // The phase, up to 4, is known to ε of itself.
    assert_single_precision(&HARMONIC, &places, [3.0, 6.3, 19.8, 62.1], 8.0);
    assert_single_precision(&CUBIC, &places, [90.0, 60.0, 40.0, 12.0], 2.0);
}

#[test]
fn arguments_that_are_not_finite_give_no_number() {
    assert_nan_stays(&HARMONIC);
    assert_nan_stays(&CUBIC);
    assert_nan_stays(&rise::<Polynomial345>());
    assert_nan_stays(&rise::<Polynomial4567>());
    assert_nan_stays(&rise::<Cycloid>());
}

#[test]
fn impossible_rises_are_refused() {
    let new = Rise::<Cycloid>::new;
    assert_eq!(new(0.0, 0.0, 0.0, 1.0), Err(LawError::NotPositive("duration")));
    assert_eq!(new(0.0, -1.0, 0.0, 1.0), Err(LawError::NotPositive("duration")));
    assert_eq!(new(f64::NAN, 1.0, 0.0, 1.0), Err(LawError::NotFinite("start or duration")));
    assert_eq!(new(0.0, 1.0, f64::MIN, f64::MAX), Err(LawError::NotFinite("height")));
    assert!(new(0.0, 1e-320, 0.0, 1.0).is_err(), "its reciprocal overflows");
}
