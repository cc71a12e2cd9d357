//! Start values of a search for an assembly, besides the guess: a fixed list, so that runs are bit-equal.

use core::f64::consts::PI;

use crate::scalar::number::Scalar;

/// Share of the search box in which the first other start lies; the last one uses all of it.
const FIRST_RADIUS: f64 = 0.25;

/// `guess` displaced to start number `start` of `count`: a point of Roberts' low-discrepancy sequence in a growing box.
///
/// Half widths are π for angles and twice the coordinate's scale for others: the mirror image of a point is no farther
/// than twice the link that carries it. The sequence is additive with αⱼ = g^−(j+1), g
/// the root of g^(K+1) = g + 1. Source: M. Roberts 2018, "The unreasonable effectiveness of quasirandom sequences".
pub(crate) fn displaced<T: Scalar, const K: usize>(
    guess: &[T; K],
    angles: &[bool; K],
    scales: &[T; K],
    start: u32,
    count: u32,
) -> [T; K] {
    let number = f64::from(start);
    let radius = FIRST_RADIUS + (1.0 - FIRST_RADIUS) * number / f64::from(count.max(1));
    let ratio = generalized_golden_ratio(K as f64);
    let mut step = 1.0;
    let mut displaced = *guess;
    for ((coordinate, scale), angle) in displaced.iter_mut().zip(scales).zip(angles) {
        step /= ratio;
        let point = 0.5 + number * step;
        let offset = T::constant(radius * (2.0 * (point - libm::floor(point)) - 1.0));
        let width = if *angle { T::constant(PI) } else { *scale + *scale };
        *coordinate = *coordinate + offset * width;
    }
    displaced
}

/// The root above 1 of g^(n+1) = g + 1, by fixed-point iteration, which gains a digit or more in two steps.
fn generalized_golden_ratio(n: f64) -> f64 {
    (0..32).fold(1.5, |g, _| libm::pow(1.0 + g, 1.0 / (n + 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_fill_the_box_evenly() {
        let mut quadrants = [0; 4];
        for start in 1..=32 {
            let [x, y] = displaced(&[0.0_f64, 0.0], &[true, false], &[1.0, 2.0], start, 32);
            assert!(x.abs() <= PI && y.abs() <= 4.0);
            quadrants[usize::from(x > 0.0) + 2 * usize::from(y > 0.0)] += 1;
        }
        assert!(quadrants.iter().all(|count| (6..=10).contains(count)), "{quadrants:?}");
    }
}
