//! Functions made of pieces, each known about an origin of its own.

use core::array::from_fn;

use crate::linear_algebra::parts::at;
use crate::scalar::number::{Real, Scalar};

/// Σ `coefficients[j]` (x − `origin`)ʲ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece<const C: usize> {
    pub origin: f64,
    pub coefficients: [f64; C],
}

/// Value and `K` − 1 derivatives at `x` of the piece that holds in each lane.
#[inline]
pub(super) fn jet<T: Scalar, const C: usize, const K: usize>(
    x: T,
    piece: impl Fn(f64) -> Piece<C>,
) -> [T; K] {
    let pieces = T::per_lane(|lane| piece(x.lane(lane).to_f64()));
    let distance = distance(x, &pieces, |piece: &Piece<C>| piece.origin);
    taylor::<T, C, K>(from_fn(|j| each(&pieces, |piece: &Piece<C>| at(&piece.coefficients, j))), distance)
}

/// `x` less the origin of each lane, which may have more digits than the scalar.
///
/// The difference is one of scalars, so that a number that carries derivatives keeps them.
#[inline(always)]
pub(super) fn distance<T: Scalar, X: Copy>(x: T, found: &T::Lanes<X>, origin: impl Fn(&X) -> f64) -> T {
    let leading = each(found, &origin);
    if T::Real::EPSILON.to_f64() <= f64::EPSILON {
        return x - leading;
    }
    let rest = each(found, |found| origin(found) - T::Real::constant(origin(found)).to_f64());
    (x - leading) - rest
}

/// A number of each lane's `X`.
#[inline(always)]
pub(super) fn each<T: Scalar, X: Copy>(found: &T::Lanes<X>, number: impl Fn(&X) -> f64) -> T {
    T::from_lanes(|lane| {
        let known = found.as_ref().get(lane).or(found.as_ref().last());
        T::Real::constant(known.map_or(f64::NAN, &number))
    })
}

/// Value and `K` − 1 derivatives of Σ `coefficients[j]` xʲ; NaN throughout where `x` is not finite.
///
/// Even and odd powers apart, for each derivative by itself: so few products wait for others.
/// Source: Knuth 1997, The Art of Computer Programming 2, §4.6.4.
#[inline(always)]
pub(super) fn taylor<T: Scalar, const C: usize, const K: usize>(coefficients: [T; C], x: T) -> [T; K] {
    let unknown = x * T::constant(0.0); // 0, or NaN where `x` is not finite
    let square = x * x;
    // Those of the derivative of the order, j! / (j − order)! times the coefficient of x^j, from j = order on.
    let mut scaled = coefficients;
    from_fn(|order| {
        if order > 0 {
            for (j, coefficient) in scaled.iter_mut().enumerate().skip(order) {
                *coefficient = *coefficient * T::constant((j - order + 1) as f64);
            }
        }
        let mut parts = [unknown; 2];
        for (j, coefficient) in scaled.iter().enumerate().skip(order).rev() {
            let is_highest = C < j + 3;
            let part = if (j - order) % 2 == 0 { &mut parts[0] } else { &mut parts[1] };
            // To the one that is added last: nothing waits for it.
            let coefficient = if j == order { *coefficient + unknown } else { *coefficient };
            *part = if is_highest { coefficient } else { *part * square + coefficient };
        }
        let [even, odd] = parts;
        if C > order + 1 { odd * x + even } else { even }
    })
}

/// Number of whole periods that `x` lies beyond `start`.
#[inline]
pub(super) fn turns(x: f64, start: f64, period: f64) -> f64 {
    floor((x - start) / period)
}

/// The largest whole number that is not above `x`: `libm::floor`, which takes the bits apart on targets without an instruction for it.
#[inline(always)]
pub(super) fn floor(x: f64) -> f64 {
    // A sum of this size has no digits behind the point: what is added and taken off again is rounded to the nearest whole number.
    const WHOLE: f64 = 1.5 * (1_u64 << 52) as f64;
    let nearest = (x + WHOLE) - WHOLE;
    match x.abs() < (1_u64 << 50) as f64 {
        true => nearest - if x < nearest { 1.0 } else { 0.0 },
        // NaN, and what is next to the largest whole numbers or beyond them.
        false => libm::floor(x),
    }
}

#[cfg(test)]
#[path = "piecewise_tests.rs"]
mod tests;
