//! Checks that every driver must pass.

use mbs_runtime::{Function, Lanes};

/// Values that are near `expected` by `bounds`, order by order.
#[track_caller]
pub fn assert_near<const K: usize>(found: [f64; K], expected: &[f64], bounds: &[f64], context: &str) {
    for (order, value) in found.into_iter().enumerate() {
        let error = (value - expected[order]).abs();
        assert!(error <= bounds[order], "{context}, order {order}: {value} {} {error:e}", expected[order]);
    }
}

/// Each derivative is that of the one before: the error of central differences falls by four as their width halves.
///
/// The places must be as far from the breakpoints as `width`; derivatives are of the order of 1.
#[track_caller]
pub fn assert_differences_converge<F: Function<f64>>(function: &F, places: &[f64], width: f64) {
    const ORDERS: usize = 5;
    for place in places {
        let jet: [f64; ORDERS] = function.jet(*place);
        for order in 1..ORDERS {
            let error = |width: f64| {
                let after: [f64; ORDERS] = function.jet(place + width);
                let before: [f64; ORDERS] = function.jet(place - width);
                ((after[order - 1] - before[order - 1]) / (2.0 * width) - jet[order]).abs()
            };
            let (coarse, fine) = (error(width), error(0.5 * width));
            // Rounding of a difference: a few ε of the values over the width, with room for the table's own.
            let size = jet.iter().fold(1.0, |size: f64, value| size.max(value.abs()));
            let rounding = 64.0 * f64::EPSILON * size / width;
            assert!(fine <= 0.27 * coarse + rounding, "order {order} at {place}: {coarse:e} {fine:e}");
        }
    }
}

/// Derivatives up to `ORDER` are continuous at `place`, the next one jumps by `jump`.
#[track_caller]
pub fn assert_continuity<F: Function<f64>>(function: &F, place: f64, jump: f64) {
    // Close enough that the derivatives themselves do not tell, far enough that `place ± step` are different numbers.
    let step = 1e-9 * place.abs().max(1.0);
    let before: [f64; 8] = function.jet(place - step);
    let after: [f64; 8] = function.jet(place + step);
    for order in 0..=F::ORDER {
        // What the next derivative adds on the way from one to the other.
        let size = before[order + 1].abs().max(after[order + 1].abs()).max(1.0);
        let change = (after[order] - before[order]).abs();
        assert!(change <= 4.0 * step * size, "order {order} jumps by {change:e} at {place}");
    }
    let change = after[F::ORDER + 1] - before[F::ORDER + 1];
    assert!(
        (change - jump).abs() <= 1e-5 * jump.abs().max(1.0),
        "jump of {change} at {place}, not of {jump}"
    );
}

/// Lanes are the single numbers bit by bit, NaN and far arguments included.
#[track_caller]
pub fn assert_lanes_agree<F: Function<f64> + Function<Lanes<f64, 4>>>(function: &F, places: [f64; 4]) {
    let lanes: [Lanes<f64, 4>; 6] = function.jet(Lanes(places));
    for (lane, place) in places.into_iter().enumerate() {
        let alone: [f64; 6] = function.jet(place);
        for order in 0..6 {
            let (found, expected) = (lanes[order].0[lane], alone[order]);
            let same = found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan());
            assert!(same, "order {order} at {place}: {found} {expected}");
        }
    }
}

/// Single precision is double precision at the same argument within `ulps` ε of the sizes of the derivatives.
#[track_caller]
pub fn assert_single_precision<F: Function<f64> + Function<f32>>(
    function: &F,
    places: &[f64],
    sizes: [f64; 4],
    ulps: f64,
) {
    for place in places {
        let single: [f32; 4] = function.jet(*place as f32);
        let double: [f64; 4] = function.jet(f64::from(*place as f32));
        let bounds = sizes.map(|size| ulps * f64::from(f32::EPSILON) * size);
        assert_near(single.map(f64::from), &double, &bounds, &format!("f32 at {place}"));
    }
}

/// An argument that is not finite gives no number.
#[track_caller]
pub fn assert_nan_stays<F: Function<f64> + Function<f32>>(function: &F) {
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let double: [f64; 5] = function.jet(x);
        let single: [f32; 5] = function.jet(x as f32);
        assert!(double.iter().all(|value| value.is_nan()), "{x}: {double:?}");
        assert!(single.iter().all(|value| value.is_nan()), "{x}: {single:?}");
        assert_eq!(Function::<f64>::breakpoint_after(function, f64::NAN), None);
    }
}
