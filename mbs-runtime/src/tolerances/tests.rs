//! Values of the laws: in both number types those that the constants had where they were used, [`positions::UNMET`] in `f32` apart.

use super::{Law, forces, is_single, motion, positions, singular};

const DOUBLE: f64 = f64::EPSILON;
const SINGLE: f32 = f32::EPSILON;

/// Laws with their values in both number types.
const VALUES: &[(&str, Law, f64, f32)] = &[
    ("terms", positions::OF_TERMS, 64.0 * DOUBLE, 64.0 * SINGLE),
    ("coordinates", positions::OF_COORDINATES, 4.0 * DOUBLE, 4.0 * SINGLE),
    ("stationary", positions::STATIONARY, 1e-4 * DOUBLE, 1e-4 * SINGLE),
    ("in line", positions::IN_LINE, 64.0 * DOUBLE, 64.0 * SINGLE),
    ("dimensions", positions::OF_DIMENSIONS, 5e-14, 5e-14),
    ("start", positions::OF_START, 1e-8, 64.0 * SINGLE),
    ("left", positions::LEFT, 1e-3, 1e-3),
    ("coarse", positions::COARSE, 70.0, 70.0),
    ("seen", positions::SEEN, 0.27, 0.27),
    ("fine", positions::FINE, 0.0625, 0.0625),
    ("quick approach", positions::QUICK_APPROACH, 1e-5, 2e3 * SINGLE),
    ("least movement", positions::LEAST_MOVEMENT, 1e-5, 1e3 * SINGLE),
    ("rounded movement", positions::ROUNDED_MOVEMENT, 1e3 * DOUBLE, 1e3 * SINGLE),
    ("shortest piece", positions::SHORTEST_PIECE, 64.0 * DOUBLE, 64.0 * SINGLE),
    ("reach", positions::OF_REACH, 1e-9, 1e-9),
    ("bound", positions::OF_BOUND, 64.0 * DOUBLE, 64.0 * SINGLE),
    ("saved", positions::OF_SAVED, 16.0 * DOUBLE, 16.0 * SINGLE),
    ("coarsest resolution", positions::COARSEST_RESOLUTION, 1e-3, 1e-3),
    ("coarsest part", positions::COARSEST_PART, 1e-6, 1e-6),
    ("zone", singular::ZONE, 1e-2, 630_000.0 * SINGLE),
    ("zone of forces", singular::ZONE_OF_FORCES, 1e-2, 1e-2),
    ("limit rows", singular::LIMIT_ROWS, 1e-3, 1e-3),
    ("adaptive zone", singular::ADAPTIVE_ZONE, 5e-4, 5e-4),
    ("least motion", singular::LEAST_MOTION, 1e-7, 1e-7),
    ("no passage", singular::NO_PASSAGE, 0.1, 0.1),
    ("dependent", singular::DEPENDENT, 1e-10, 256.0 * SINGLE),
    ("own part", singular::OWN_PART, 1e-8, 256.0 * SINGLE),
    ("probe", singular::PROBE, 1e-4, 64.0 * (256.0 * SINGLE)),
    ("unanswered", singular::UNANSWERED, 1e-2, 1e-2),
    ("least pivot", singular::LEAST_PIVOT, 1e-4, 1e-4),
    ("sure pivot", singular::SURE_PIVOT, 2e-2, 2e-2),
    ("least inertia", singular::LEAST_INERTIA, 64.0 * DOUBLE, 64.0 * SINGLE),
    ("no inertia", singular::NO_INERTIA, 1e-7, 1e-7),
    ("flat at start", singular::FLAT_AT_START, 64e3 * DOUBLE, 64e3 * SINGLE),
    ("least rate", singular::LEAST_RATE, 1e-6, 1e-6),
    ("combination", singular::OF_COMBINATION, 64.0 * DOUBLE, 64.0 * SINGLE),
    ("unresolved", forces::UNRESOLVED, 4.0 * DOUBLE, 4.0 * SINGLE),
    ("standing", forces::STANDING, 16.0 * DOUBLE, 16.0 * SINGLE),
    ("cancelled", forces::CANCELLED, 1e-8, 256.0 * SINGLE),
    ("piecewise", forces::OF_PIECEWISE, 16.0 * DOUBLE, 16.0 * SINGLE),
    ("no stiffness", forces::NO_STIFFNESS, 1e-9, 256.0 * SINGLE),
    ("indifferent", forces::INDIFFERENT, 1e-6, 1e-6),
    ("no work", forces::NO_WORK, 32.0 * DOUBLE, 32.0 * SINGLE),
    ("at rest", forces::AT_REST, 1e-9, 256.0 * SINGLE),
    ("state rate", forces::OF_STATE_RATE, 64.0 * DOUBLE, 64.0 * SINGLE),
    ("no pivot", forces::NO_PIVOT, 1e-12, 256.0 * SINGLE),
    ("corrected", forces::CORRECTED, 64.0 * DOUBLE, 64.0 * SINGLE),
    ("stuck", forces::STUCK, 1e-9, 1e-9),
    ("movement", forces::OF_MOVEMENT, 4.0 * DOUBLE, 4.0 * SINGLE),
    ("slow", forces::SLOW, 1e-5, 1e-5),
    ("unseen", forces::UNSEEN, 1e-3, 1e-3),
    ("least", motion::LEAST, 32.0 * DOUBLE, 32.0 * SINGLE),
    ("default", motion::DEFAULT, 1e-9, 32.0 * SINGLE),
    ("fixed steps", motion::OF_FIXED_STEPS, 1e-10, 32.0 * SINGLE),
    ("first part", motion::OF_PARTS[0], 1e-10, 32.0 * SINGLE),
    ("second part", motion::OF_PARTS[1], 1e-9, 32.0 * SINGLE),
    ("stages", motion::OF_STAGES, 10.0 * DOUBLE, 10.0 * SINGLE),
    ("motion at rest", motion::AT_REST, 1e-3, 1e-3),
    ("least step", motion::LEAST_STEP, 16.0 * DOUBLE, 16.0 * SINGLE),
    ("part of a search", motion::LEAST_PART, 4.0 * DOUBLE, 4.0 * SINGLE),
    ("contact", motion::OF_REACH, 16.0 * DOUBLE, 16.0 * SINGLE),
    ("no value", motion::NO_VALUE, 64.0 * DOUBLE, 64.0 * SINGLE),
    ("located", motion::LOCATED, 16.0 * DOUBLE, 16.0 * SINGLE),
    ("blurred", motion::BLURRED, 2048.0 * DOUBLE, 2048.0 * SINGLE),
    ("solved anew", motion::SOLVED_ANEW, 1024.0 * DOUBLE, 1024.0 * SINGLE),
    ("enclosure", motion::OF_ENCLOSURE, 131_072.0 * DOUBLE, 131_072.0 * SINGLE),
];

/// Multiples of √ε.
const ROOTS: &[(&str, Law, f64)] = &[
    ("short", positions::SHORT, 5.0),
    ("jump", positions::JUMP, 1.0),
    ("fit", positions::OF_FIT, 1.0),
    ("least margin", singular::LEAST_MARGIN, 32.0),
    ("half the digits", singular::HALF_THE_DIGITS, 1.0),
    ("no passage rounded", singular::NO_PASSAGE_ROUNDED, 500.0),
    ("turned", singular::TURNED, 8.0),
    ("weakest of a start", singular::WEAKEST_OF_START, 0.125),
    ("flat", singular::FLAT, 512.0),
    ("apart", forces::APART, 16.0),
    ("hidden", forces::HIDDEN, 1.0),
    ("stuck multipliers", forces::STUCK_MULTIPLIERS, 1e-2),
    ("shortest edge", forces::SHORTEST_EDGE, 1.0),
    ("beside", forces::BESIDE, 4.0),
    ("balanced", forces::BALANCED, 64.0),
    ("integrand", forces::INTEGRAND, 1.0),
    ("unexplained", motion::UNEXPLAINED, 0.5),
];

#[test]
fn laws_have_the_values_of_the_constants_before() {
    for (name, law, double, single) in VALUES {
        assert_eq!(law.of::<f64>().to_bits(), double.to_bits(), "{name}");
        assert_eq!(law.of::<f32>().to_bits(), single.to_bits(), "{name} in f32");
    }
    for (name, law, factor) in ROOTS {
        let double = factor * libm::sqrt(DOUBLE);
        let single = *factor as f32 * libm::sqrtf(SINGLE);
        assert_eq!(law.of::<f64>().to_bits(), double.to_bits(), "{name}");
        assert_eq!(law.of::<f32>().to_bits(), single.to_bits(), "{name} in f32");
    }
    assert_eq!(positions::OF_FIT.of::<f64>(), 1.0 / 67_108_864.0);
}

#[test]
fn other_roots_are_those_of_the_elementary_functions() {
    let double = libm::sqrt(libm::sqrt(DOUBLE));
    let single = libm::sqrtf(libm::sqrtf(SINGLE));
    for (law, factor) in [(singular::PASSES, 8.0), (singular::BALANCE, 1.0)] {
        assert_eq!(law.of::<f64>().to_bits(), (factor * double).to_bits());
        assert_eq!(law.of::<f32>().to_bits(), (factor as f32 * single).to_bits());
    }
    let [double, single] = [libm::pow(DOUBLE, 1.0 / 3.0), f64::from(libm::powf(SINGLE, 1.0_f32 / 3.0))];
    assert_eq!(singular::DOUBTFUL.of::<f64>().to_bits(), double.to_bits());
    assert_eq!(f64::from(singular::DOUBTFUL.of::<f32>()).to_bits(), single.to_bits());
}

#[test]
fn powers_need_no_root() {
    let both = |law: Law| (law.of::<f64>(), law.of::<f32>());
    assert_eq!(both(singular::LEAST_MARGIN_SQUARED), (1024.0 * DOUBLE, 1024.0 * SINGLE));
    assert_eq!(both(singular::HALF_THE_DIGITS_SQUARED), (DOUBLE, SINGLE));
    assert_eq!(both(singular::LEADS_TO_THE_FOURTH), (256.0 * DOUBLE, 256.0 * SINGLE));
}

/// 1e8 tolerances of a row were 763 times its scale in `f32`, so that rows far off counted as met.
#[test]
fn rows_that_are_not_met_are_within_their_scale() {
    let unmet = positions::UNMET.of::<f64>() / positions::OF_TERMS.of::<f64>();
    assert_eq!(unmet.to_bits(), 1e8_f64.to_bits());
    assert_eq!(positions::UNMET.of::<f32>(), 0.031_25);
}

#[test]
fn number_types_are_told_apart() {
    assert!(is_single::<f32>() && !is_single::<f64>());
}
