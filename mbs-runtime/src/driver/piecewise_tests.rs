//! The largest whole number below, to the bits of the standard library but for the sign of zero.

use super::floor;
use crate::driver::Table;

#[test]
fn floor_is_that_of_the_standard_library() {
    let powers = (-60..=70).map(|power| 2_f64.powi(power));
    let near = |x: f64| [x, x.next_up(), x.next_down(), x + 0.5, x - 0.5, 0.75 * x, x + 1.0];
    let mut compared = 0;
    for x in powers.flat_map(near).flat_map(|x| [x, -x]) {
        assert_eq!(floor(x), x.floor(), "{x:e}");
        compared += 1;
    }
    for x in (-20_000..20_000).map(|k| f64::from(k) / 7.0) {
        assert_eq!(floor(x), x.floor(), "{x:e}");
    }
    for x in [0.0, -0.0, f64::MAX, f64::MIN, f64::INFINITY, f64::NEG_INFINITY, f64::MIN_POSITIVE, -5e-324] {
        assert_eq!(floor(x), x.floor(), "{x:e}");
    }
    assert!(floor(f64::NAN).is_nan() && compared == 1834);
}

#[test]
fn uneven_knots_are_found_by_halving_and_infinity_is_no_place() {
    // Straight pieces of slope 1 to 4, and a table that holds beyond both ends.
    let knots = [0.0, 0.1, 1.0, 7.0];
    let pieces = [[0.0, 1.0], [0.1, 2.0], [1.9, 3.0], [19.9, 4.0]];
    let open = Table::open(&knots, &pieces);
    for (x, value, slope) in
        [(-1.0, 0.0, 0.0), (0.05, 0.05, 1.0), (0.5, 0.9, 2.0), (6.5, 18.4, 3.0), (9.0, 27.9, 4.0)]
    {
        let [found, rate, ..] = open.derivatives::<f64>(x);
        assert!((found - value).abs() < 1e-12 && rate == slope, "{x}: {found} {rate}");
    }
    let periodic = Table::periodic(&knots, &pieces, 8.0);
    for turns in [-3.0, 0.0, 5.0] {
        let [found, rate, ..] = periodic.derivatives::<f64>(0.5 + 8.0 * turns);
        assert!((found - 0.9).abs() < 1e-12 && rate == 2.0, "{turns}: {found} {rate}");
    }
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(periodic.derivatives::<f64>(x).iter().all(|number| number.is_nan()), "{x}");
    }
}
