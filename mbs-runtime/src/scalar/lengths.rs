//! Lengths √(x² + y²).

use crate::scalar::number::Real;

/// Least and largest sum of squares that keeps all digits. Below 2⁻⁹⁶⁸ a square may have underflowed that is no rounding of the sum.
const REGULAR: [f64; 2] = [f64::from_bits(0x0370_0000_0000_0000), f64::MAX];

/// √(x² + y²) within one unit of the last place: from the squares where they are regular, else by the library, which scales them.
#[inline(always)]
pub(crate) fn hypot(x: f64, y: f64) -> f64 {
    let sum = x * x + y * y;
    let [least, most] = REGULAR;
    if least <= sum && sum <= most { libm::sqrt(sum) } else { apart(x, y) }
}

/// [`hypot`] in each lane, to the same bits: roots in one register where all sums are regular.
#[inline(always)]
pub(crate) fn hypot_of_lanes<const L: usize>(x: [f64; L], y: [f64; L]) -> [f64; L] {
    let [least, most] = REGULAR;
    let (mut sums, mut regular) = (x, true);
    for (sum, y) in sums.iter_mut().zip(&y) {
        *sum = *sum * *sum + *y * *y;
        regular &= (least <= *sum) & (*sum <= most);
    }
    if !regular {
        return each(x, y);
    }
    sums.iter_mut().for_each(|sum| *sum = libm::sqrt(*sum));
    sums
}

/// √(x² + y²) in each lane, one after the other.
#[inline(always)]
pub(crate) fn each<R: Real, const L: usize>(mut x: [R; L], y: [R; L]) -> [R; L] {
    x.iter_mut().zip(y).for_each(|(x, y)| *x = x.hypot(y));
    x
}

#[cold]
#[inline(never)]
fn apart(x: f64, y: f64) -> f64 {
    libm::hypot(x, y)
}

#[cfg(test)]
#[path = "lengths_tests.rs"]
mod tests;
