//! Accuracy against double-double arithmetic, at the places where a reduction fails first.

use core::f64::consts::FRAC_PI_2;
use core::f64::consts::FRAC_PI_4;
use core::f64::consts::PI;

use crate::scalar::lanes::Lanes;
use crate::scalar::number::Scalar;
use crate::scalar::sequence::Sequence;
use crate::scalar::trigonometry::double::LARGEST_ANGLE;
use crate::scalar::trigonometry::*;

extern crate std;

/// The unevaluated sum of two numbers, about 32 digits. Source: Dekker 1971.
#[derive(Clone, Copy)]
struct Pair(f64, f64);

/// Sum and its rounding error. Source: Knuth 1969.
fn two_sum(a: f64, b: f64) -> Pair {
    let sum = a + b;
    let part = sum - a;
    Pair(sum, (a - (sum - part)) + (b - part))
}

/// Product and its rounding error.
fn two_product(a: f64, b: f64) -> Pair {
    let halves = |x: f64| {
        let scaled = x * 134_217_729.0; // 2²⁷ + 1
        let high = scaled - (scaled - x);
        (high, x - high)
    };
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    let product = a * b;
    Pair(product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low)
}

impl Pair {
    fn add(self, other: Pair) -> Pair {
        let Pair(high, low) = two_sum(self.0, other.0);
        two_sum(high, low + (self.1 + other.1))
    }
    fn times(self, other: Pair) -> Pair {
        let Pair(high, low) = two_product(self.0, other.0);
        two_sum(high, low + (self.0 * other.1 + self.1 * other.0))
    }
    fn over(self, divisor: f64) -> Pair {
        let quotient = self.0 / divisor;
        let Pair(high, low) = two_product(quotient, divisor);
        two_sum(quotient, ((self.0 - high) - low + self.1) / divisor)
    }
}

/// π/2 in four parts, 212 bits.
const LONG_HALF_PI: [f64; 4] =
    [FRAC_PI_2, 6.123233995736766e-17, -1.4973849048591698e-33, 5.562271104316826e-50];

/// Of π/2: the first beyond the kernels' range.
const LAST_MULTIPLE: u32 = 63_662;

/// x − n π/2 and n.
fn reduced(x: f64) -> (Pair, i64) {
    let n = libm::rint(x / FRAC_PI_2);
    let mut terms = [x; 9];
    for (k, part) in LONG_HALF_PI.into_iter().enumerate() {
        let Pair(high, low) = two_product(n, part);
        (terms[2 * k], terms[2 * k + 1]) = (-high, -low);
    }
    // As many passes as terms, and each sum is free of the errors of the one before.
    for _ in 0..terms.len() {
        for k in 1..terms.len() {
            let Pair(sum, error) = two_sum(terms[k - 1], terms[k]);
            (terms[k], terms[k - 1]) = (sum, error);
        }
    }
    (Pair(terms[8], terms[7]), n as i64)
}

/// The alternating series `first` − `first` r²/((k+1)(k+2)) + ….
fn series(first: Pair, square: Pair, mut k: f64) -> Pair {
    let (mut term, mut sum) = (first, first);
    while term.0.abs() > 1e-36 * sum.0.abs() {
        term = term.times(square).over(-(k + 1.0) * (k + 2.0));
        sum = sum.add(term);
        k += 2.0;
    }
    sum
}

/// Sine and cosine, 30 digits and more.
fn reference(x: f64) -> (Pair, Pair) {
    let (r, n) = reduced(x);
    let square = r.times(r);
    let (sine, cosine) = (series(r, square, 1.0), series(Pair(1.0, 0.0), square, 0.0));
    let negative = |value: Pair| Pair(-value.0, -value.1);
    match n.rem_euclid(4) {
        0 => (sine, cosine),
        1 => (cosine, negative(sine)),
        2 => (negative(sine), negative(cosine)),
        _ => (negative(cosine), sine),
    }
}

/// Largest errors met: absolute, in units in the last place of the result, the same for |x| ≤ π.
#[derive(Debug, Default)]
struct Errors {
    absolute: f64,
    units: f64,
    units_within_a_turn: f64,
}

impl Errors {
    fn take(&mut self, x: f64, found: [f64; 2], (sine, cosine): (Pair, Pair)) {
        for (found, Pair(high, low)) in found.into_iter().zip([sine, cosine]) {
            let error = ((found - high) - low).abs();
            let unit = (high.abs().next_up() - high.abs()).max(f64::MIN_POSITIVE);
            self.absolute = self.absolute.max(error);
            self.units = self.units.max(error / unit);
            if x.abs() <= PI {
                self.units_within_a_turn = self.units_within_a_turn.max(error / unit);
            }
        }
    }
}

/// Errors of the kernel that is the same on every target, and of the one with fused operations.
#[derive(Debug, Default)]
struct Both {
    separate: Errors,
    fused: Errors,
}

impl Both {
    fn take(&mut self, x: f64) {
        let expected = reference(x);
        let ([sine], [cosine]) = packed::<f64, Separate, 1, WIDE, NARROW>([x]);
        self.separate.take(x, [sine, cosine], expected);
        let ([sine], [cosine]) = packed::<f64, Fused, 1, WIDE, NARROW>([x]);
        self.fused.take(x, [sine, cosine], expected);
    }

    fn assert_small(&self) {
        std::println!("{self:?}");
        assert!(self.separate.units <= 0.8 && self.separate.absolute <= 1e-16, "{self:?}");
        assert!(self.fused.units_within_a_turn <= 1.6 && self.fused.absolute <= 1.8e-16, "{self:?}");
    }
}

#[test]
fn the_reference_has_thirty_digits() {
    let known = [
        (
            1.0,
            Pair(0.8414709848078965, 1.776845092935536e-18),
            Pair(0.5403023058681398, -4.760954612604417e-17),
        ),
        (
            22.0,
            Pair(-0.008851309290403876, 2.8485303089220057e-19),
            Pair(-0.9999608263946371, -8.51603380017413e-19),
        ),
        (
            -0.7,
            Pair(-0.644217687237691, -2.8740567927338755e-18),
            Pair(0.7648421872844885, -4.013780434022238e-17),
        ),
        (
            99999.5,
            Pair(0.5104916150747798, 1.0492647623186778e-17),
            Pair(-0.8598827309222711, 2.479742432899302e-18),
        ),
        (FRAC_PI_2, Pair(1.0, -1.874699728327322e-33), Pair(6.123233995736766e-17, -1.4973849048591698e-33)),
    ];
    for (x, sine, cosine) in known {
        let (s, c) = reference(x);
        for (found, expected) in [(s, sine), (c, cosine)] {
            let error = ((found.0 - expected.0) + (found.1 - expected.1)).abs();
            assert!(error <= 1e-30 * expected.0.abs(), "{x} {error}");
        }
    }
}

/// The double next to n π/2.
fn multiple(n: f64) -> f64 {
    let [high, low, ..] = LONG_HALF_PI;
    let product = two_product(n, high);
    product.0 + (product.1 + n * low)
}

/// The double next to each n π/2 and three on either side.
#[test]
fn numbers_next_to_multiples_of_a_quarter_turn_keep_their_digits() {
    let mut errors = Both::default();
    for n in 0..=LAST_MULTIPLE {
        let mut x = (0..3).fold(multiple(f64::from(n)), |x, _| x.next_down());
        for _ in 0..7 {
            errors.take(x);
            errors.take(-x);
            x = x.next_up();
        }
    }
    errors.assert_small();
    let beyond = multiple(f64::from(LAST_MULTIPLE));
    assert!(beyond > LARGEST_ANGLE, "all multiples of the kernels' range were met");
}

#[test]
fn numbers_next_to_the_quadrants_borders_keep_their_digits() {
    let mut errors = Both::default();
    for k in (0..127_000).step_by(14) {
        let border = f64::from(k + 1) * FRAC_PI_4;
        for x in [border, border.next_up(), border.next_down()] {
            errors.take(x);
            errors.take(-x);
        }
    }
    errors.assert_small();
}

#[test]
fn random_angles_of_every_size_keep_their_digits() {
    let mut errors = Both::default();
    let mut sequence = Sequence::new(8);
    for _ in 0..10_000 {
        for size in [0.8, 7.0, 1e3, LARGEST_ANGLE] {
            errors.take(size * sequence.number());
        }
        errors.take(libm::exp2(512.0 * sequence.number() - 496.0));
    }
    errors.assert_small();
}

#[test]
fn zero_keeps_its_sign() {
    let ([plus, minus], cosines) = sin_cos([0.0, -0.0]);
    assert_eq!((plus.to_bits(), minus.to_bits(), cosines), (0, (-0.0_f64).to_bits(), [1.0; 2]));
    assert_eq!(sin_cos([f64::MIN_POSITIVE, 5e-324]).0, [f64::MIN_POSITIVE, 5e-324]);
}

/// Not a number has many patterns of bits.
fn bits(value: f64) -> Option<u64> {
    (!value.is_nan()).then_some(value.to_bits())
}

#[test]
fn beyond_the_fast_path_it_is_libm() {
    let far =
        [LARGEST_ANGLE.next_up(), -1.5e5, 1e22, -1e300, f64::MAX, f64::INFINITY, -f64::INFINITY, f64::NAN];
    let (sines, cosines) = sin_cos(far);
    for ((sine, cosine), x) in sines.into_iter().zip(cosines).zip(far) {
        let expected = libm::sincos(x);
        assert_eq!((bits(sine), bits(cosine)), (bits(expected.0), bits(expected.1)), "{x}");
    }
}

#[test]
fn an_angle_does_not_depend_on_its_neighbours() {
    let angles = [0.3, -0.0, -0.7, FRAC_PI_4, 1e-20, -2.0e5, 77.0, f64::NAN, -1e5];
    let (sines, cosines) = sin_cos(angles);
    let ([lane_sines], [lane_cosines]) = Lanes::sin_cos([Lanes(angles)]);
    for (k, angle) in angles.into_iter().enumerate() {
        let ([sine], [cosine]) = sin_cos([angle]);
        assert_eq!((bits(sines[k]), bits(cosines[k])), (bits(sine), bits(cosine)));
        assert_eq!((bits(lane_sines.0[k]), bits(lane_cosines.0[k])), (bits(sine), bits(cosine)));
    }
}

#[test]
fn the_library_keeps_its_digits_too() {
    let mut sequence = Sequence::new(12);
    let mut errors = Errors::default();
    for size in [0.8, 7.0, 1e3, 1e5] {
        for _ in 0..2_000 {
            let x = size * sequence.number();
            let ([sine], [cosine]) = of_library([x]);
            errors.take(x, [sine, cosine], reference(x));
        }
    }
    assert!(errors.units <= 0.8 && errors.absolute <= 1e-16, "{errors:?}");
}

/// Sines and cosines equal the library's bit for bit with the feature `libm`, and only then.
#[test]
fn the_feature_chooses_the_library() {
    let mut sequence = Sequence::new(13);
    let doubles: [f64; 1_000] = core::array::from_fn(|_| 100.0 * sequence.number());
    let singles = doubles.map(|x| x as f32);
    let (in_use, library) = (sin_cos(doubles), of_library(doubles));
    let (in_use_single, library_single) = (sin_cos_single(singles), of_library(singles));
    let ([lanes], _) = Lanes::sin_cos([Lanes(doubles)]);
    assert_eq!(lanes.0, in_use.0);
    assert_eq!(in_use == library, cfg!(feature = "libm"));
    assert_eq!(in_use_single == library_single, cfg!(feature = "libm"));
}

#[test]
fn the_bits_are_the_same_on_every_run_target_and_optimization() {
    // FNV-1a over the results; the number is that of the first run.
    let mut sequence = Sequence::new(9);
    let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
    for _ in 0..10_000 {
        let (sines, cosines) = packed::<f64, Separate, 2, WIDE, NARROW>([
            LARGEST_ANGLE * sequence.number(),
            4.0 * sequence.number(),
        ]);
        for value in sines.into_iter().chain(cosines) {
            hash = (hash ^ value.to_bits()).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
    assert_eq!(hash, 10_527_694_864_454_309_857);
}

/// Error of a found angle in units of its last place: the point turned back by it, in double-double arithmetic.
fn units_of_direction(found: f64, y: f64, x: f64) -> f64 {
    let (sine, cosine) = reference(found);
    let [y, x] = [y, x].map(|part| Pair(part, 0.0));
    let negative = |value: Pair| Pair(-value.0, -value.1);
    let across = y.times(cosine).add(negative(x.times(sine)));
    let along = x.times(cosine).add(y.times(sine));
    // The angle that is left is its tangent, to a third of its cube.
    let unit = (found.abs().next_up() - found.abs()).max(f64::MIN_POSITIVE);
    (across.0 / along.0).abs() / unit
}

#[test]
fn angles_of_points_are_as_exact_as_those_of_the_library() {
    let mut random = Sequence::new(11);
    let (mut largest, mut library) = (0.0_f64, 0.0_f64);
    let mut take = |y: f64, x: f64| {
        for (y, x) in [(y, x), (-y, x), (y, -x), (-y, -x)] {
            largest = largest.max(units_of_direction(atan2(y, x), y, x));
            library = library.max(units_of_direction(libm::atan2(y, x), y, x));
        }
    };
    for _ in 0..40_000 {
        take(random.number(), random.number());
        // Next to the borders of all sectors and to their lines.
        for ratio in [7.0 / 16.0, 11.0 / 16.0, 19.0 / 16.0, 39.0 / 16.0, 0.5, 1.0, 1.5, 1e-9, 1e9] {
            let x = random.number();
            take(x * ratio * (1.0 + 1e-3 * random.number().powi(5)), x);
        }
    }
    for size in [1e-250, 1e-100, 1e100, 1e300] {
        for _ in 0..1000 {
            take(size * random.number(), size * random.number());
        }
    }
    std::println!("{largest} units of the last place, {library} of the library");
    assert!(largest <= 1.5 && largest <= library, "{largest}, {library} of the library");
}

#[test]
fn angles_of_extreme_points_are_those_of_the_library() {
    let extremes =
        [0.0, -0.0, 5e-324, f64::MIN_POSITIVE, 1e-200, 1.0, 1e200, f64::MAX, f64::INFINITY, f64::NAN];
    for y in extremes.into_iter().flat_map(|y| [y, -y]) {
        for x in extremes.into_iter().flat_map(|x| [x, -x]) {
            let (found, known) = (atan2(y, x), libm::atan2(y, x));
            assert!(
                found.to_bits() == known.to_bits() || found.is_nan() && known.is_nan(),
                "{y:e} {x:e}: {found:e}"
            );
        }
    }
}
