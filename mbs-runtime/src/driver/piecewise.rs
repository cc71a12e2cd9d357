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
/// Horner's scheme for the value and, in the same loop, for every derivative over its factorial.
/// Source: Knuth 1997, The Art of Computer Programming 2, §4.6.4.
#[inline(always)]
pub(super) fn taylor<T: Scalar, const C: usize, const K: usize>(coefficients: [T; C], x: T) -> [T; K] {
    let unknown = x * T::constant(0.0); // 0, or NaN where `x` is not finite
    let mut jet = [unknown; K];
    for (step, coefficient) in coefficients.into_iter().rev().enumerate() {
        let mut carried = coefficient + if step == 0 { unknown } else { T::constant(0.0) };
        // After `step` coefficients no derivative beyond the order `step` has begun.
        for derivative in jet.iter_mut().take(step + 1) {
            let before = *derivative;
            *derivative = before * x + carried;
            carried = before;
        }
    }
    let mut factorial = 1.0;
    for (order, derivative) in jet.iter_mut().enumerate() {
        factorial *= order.max(1) as f64;
        *derivative = *derivative * T::constant(factorial);
    }
    jet
}

/// Number of whole periods that `x` lies beyond `start`.
#[inline]
pub(super) fn turns(x: f64, start: f64, period: f64) -> f64 {
    libm::floor((x - start) / period)
}
