use super::*;
use crate::scalar::sequence::Sequence;

/// Exponents of two between which the numbers of a pair are: usual ones, all, and those at the edge of squares that underflow.
const SIZES: [[[f64; 2]; 2]; 3] =
    [[[-8.0, 8.0]; 2], [[-1074.0, 1023.9]; 2], [[-490.0, -480.0], [-540.0, -480.0]]];

/// Shows pairs of numbers of all sizes.
fn each_pair(mut see: impl FnMut(f64, f64)) {
    let mut random = Sequence::new(7);
    for sizes in SIZES {
        for _ in 0..3000 {
            let [x, y] = sizes.map(|[least, most]| {
                let size = least + (most - least) * 0.5 * (1.0 + random.number());
                libm::copysign(libm::exp2(size), random.number())
            });
            see(x, y);
        }
    }
}

#[test]
fn lengths_are_those_of_the_library_within_a_unit_of_the_last_place() {
    each_pair(|x, y| {
        let (found, known) = (hypot(x, y), libm::hypot(x, y));
        let same = found == known;
        assert!(same || (found - known).abs() <= f64::EPSILON * known, "{x:e} {y:e}: {found:e}, {known:e}");
        // A direction's cosine is no more than 1.
        assert!(x.abs() <= found && y.abs() <= found, "{x:e} {y:e}: {found:e}");
    });
}

#[test]
fn extremes_are_those_of_the_library() {
    let extremes = [0.0, -0.0, f64::MIN_POSITIVE, 5e-324, 1e-200, 1e200, f64::MAX, f64::INFINITY, f64::NAN];
    for x in extremes {
        for y in extremes {
            let (found, known) = (hypot(x, y), libm::hypot(x, y));
            assert!(found.to_bits() == known.to_bits() || found.is_nan() && known.is_nan(), "{x:e} {y:e}");
        }
    }
}

#[test]
fn lanes_have_the_same_bits() {
    let mut last = [1.0; 4];
    each_pair(|x, y| {
        last.rotate_left(1);
        last[3] = y;
        let one = [x, -x, y, 3.0 * x];
        let found = hypot_of_lanes(one, last);
        for (found, (x, y)) in found.iter().zip(one.iter().zip(&last)) {
            assert_eq!(found.to_bits(), hypot(*x, *y).to_bits());
        }
    });
}
