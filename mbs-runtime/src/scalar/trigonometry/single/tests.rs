//! Accuracy against double precision, whose own error is a billionth of a unit here.

use core::f64::consts::FRAC_PI_2;
use core::f64::consts::FRAC_PI_4;

use crate::scalar::lanes::Lanes;
use crate::scalar::number::Scalar;
use crate::scalar::sequence::Sequence;
use crate::scalar::trigonometry::single::*;
use crate::scalar::trigonometry::{
    Fused, NARROW_SINGLE, Separate, WIDE_SINGLE, of_library, packed, sin_cos_single,
};

extern crate std;

/// Largest errors in units in the last place of the result, and where.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    separate: (f64, f32),
    fused: (f64, f32),
}

impl Errors {
    fn take(&mut self, x: f32) {
        let (sine, cosine) = libm::sincos(f64::from(x));
        let worst = |([found_sine], [found_cosine]): ([f32; 1], [f32; 1]), largest: &mut (f64, f32)| {
            for (found, exact) in [(found_sine, sine), (found_cosine, cosine)] {
                let units = (f64::from(found) - exact).abs() / unit(exact);
                if units > largest.0 || units.is_nan() {
                    *largest = (units, x);
                }
            }
        };
        worst(packed::<f32, Separate, 1, WIDE_SINGLE, NARROW_SINGLE>([x]), &mut self.separate);
        worst(packed::<f32, Fused, 1, WIDE_SINGLE, NARROW_SINGLE>([x]), &mut self.fused);
    }

    fn assert_at_most(&self, units: [f64; 2]) {
        std::println!("{self:?}");
        assert!(self.separate.0 <= units[0] && self.fused.0 <= units[1], "{self:?}");
    }
}

/// Distance from the single below `exact` in size to the next.
fn unit(exact: f64) -> f64 {
    let below = f32::from_bits((exact.abs() as f32).to_bits());
    let below = if f64::from(below) > exact.abs() { below.next_down() } else { below };
    f64::from(below.next_up()) - f64::from(below)
}

/// Units in the last place that are promised up to 128 rad, of separate operations and of fused ones.
const PROMISED: [f64; 2] = [0.9; 2];

/// Half a unit, and what double precision is wrong by.
const ROUNDED: [f64; 2] = [0.5 + 1e-6; 2];

#[test]
fn numbers_of_all_sizes_up_to_twenty_turns_keep_their_digits() {
    let mut errors = Errors::default();
    for bits in (0..=LARGEST_ANGLE.to_bits()).step_by(1_999) {
        errors.take(f32::from_bits(bits));
    }
    for bits in (0..=LARGEST_ANGLE.to_bits()).step_by(20_011) {
        errors.take(-f32::from_bits(bits));
    }
    errors.assert_at_most(PROMISED);
}

#[test]
fn numbers_next_to_multiples_of_an_eighth_of_a_turn_keep_their_digits() {
    let mut errors = Errors::default();
    for k in 0..163 {
        let mut x = (f64::from(k) * FRAC_PI_4) as f32;
        (0..3).for_each(|_| x = x.next_down());
        for _ in 0..7 {
            errors.take(x.min(LARGEST_ANGLE));
            errors.take(-x);
            x = x.next_up();
        }
    }
    errors.assert_at_most(PROMISED);
}

#[test]
fn beyond_twenty_turns_values_are_those_of_double_precision() {
    let mut errors = Errors::default();
    for bits in (LARGEST_ANGLE.next_up().to_bits()..f32::INFINITY.to_bits()).step_by(50_021) {
        errors.take(f32::from_bits(bits));
    }
    for k in (82..600_000).step_by(41) {
        let x = (f64::from(k) * FRAC_PI_2) as f32;
        [x.next_down(), x, x.next_up()].into_iter().for_each(|x| errors.take(-x));
    }
    errors.assert_at_most(ROUNDED);
}

#[test]
fn zero_keeps_its_sign_and_no_number_has_no_sine() {
    let ([plus, minus, tiny], cosines) = sin_cos_single([0.0, -0.0, f32::from_bits(1)]);
    assert_eq!((plus.to_bits(), minus.to_bits(), cosines), (0, (-0.0_f32).to_bits(), [1.0; 3]));
    assert_eq!(tiny.to_bits(), 1);
    let (sines, cosines) = sin_cos_single([f32::NAN, f32::INFINITY, -f32::INFINITY]);
    assert!(sines.into_iter().chain(cosines).all(f32::is_nan));
}

#[test]
fn the_library_is_within_a_unit_too() {
    let mut sequence = Sequence::new(11);
    for size in [0.8, 7.0, 1e3, 1e9] {
        for _ in 0..10_000 {
            let x = (size * sequence.number()) as f32;
            let ([sine], [cosine]) = of_library([x]);
            let exact = libm::sincos(f64::from(x));
            for (found, exact) in [(sine, exact.0), (cosine, exact.1)] {
                assert!((f64::from(found) - exact).abs() <= unit(exact), "{x}");
            }
        }
    }
}

#[test]
fn a_single_angle_does_not_depend_on_its_neighbours() {
    let angles = [0.3, -0.0, -0.7, 99.9, 1e-20, -2.0e5, 77.0, f32::NAN, -128.5, 3e38, 128.0];
    let bits = |value: f32| (!value.is_nan()).then_some(value.to_bits());
    let (sines, cosines) = sin_cos_single(angles);
    let ([lane_sines], [lane_cosines]) = Lanes::sin_cos([Lanes(angles)]);
    for (k, angle) in angles.into_iter().enumerate() {
        let ([sine], [cosine]) = sin_cos_single([angle]);
        assert_eq!((bits(sines[k]), bits(cosines[k])), (bits(sine), bits(cosine)));
        assert_eq!((bits(lane_sines.0[k]), bits(lane_cosines.0[k])), (bits(sine), bits(cosine)));
    }
}

#[test]
fn the_bits_of_singles_are_the_same_on_every_run_target_and_optimization() {
    // FNV-1a over the results; the number is that of the first run.
    let mut sequence = Sequence::new(10);
    let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
    for _ in 0..10_000 {
        let angles = [128.0, 4.0].map(|size| (size * sequence.number()) as f32);
        let (sines, cosines) = packed::<f32, Separate, 2, WIDE_SINGLE, NARROW_SINGLE>(angles);
        for value in sines.into_iter().chain(cosines) {
            hash = (hash ^ u64::from(value.to_bits())).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
    assert_eq!(hash, 10_134_380_523_499_754_603);
}
