//! Functions that both sides of a cross-check know, in place of those that a text declares.

use mbs_runtime::{Function, Scalar};

/// Replacement of the declared function of index `I` in a cross-check: `Σ a sin(w x + p)`, its derivatives by formula.
///
/// A mechanism with functions is confirmed with these in their places, in the order of the text:
/// `check(Follower::new(StandIn::<0>, StandIn::<1>))`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StandIn<const I: usize>;

impl<T: Scalar, const I: usize> Function<T> for StandIn<I> {
    const ORDER: usize = u8::MAX as usize;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        NumberedStandIn(I).jet(x)
    }
}

/// [`StandIn`] whose index is a value: functions of an array are of one type. [`array`](Self::array) makes all of one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NumberedStandIn(pub usize);

impl NumberedStandIn {
    /// The stand-ins of an array of N functions whose first has the index `first`: behind all functions that the text declares before it.
    #[must_use]
    pub fn array<const N: usize>(first: usize) -> [Self; N] {
        core::array::from_fn(|index| NumberedStandIn(first + index))
    }
}

impl<T: Scalar> Function<T> for NumberedStandIn {
    const ORDER: usize = u8::MAX as usize;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        let terms = mbs_codegen::stand_in(self.0);
        let angles = terms.map(|[_, w, p]| T::constant(w) * x + T::constant(p));
        let (sines, cosines) = T::sin_cos(angles);
        core::array::from_fn(|order| {
            let mut sum = T::constant(0.0);
            for ([a, w, _], (sine, cosine)) in terms.iter().zip(sines.into_iter().zip(cosines)) {
                let factor = T::constant(a * w.powi(i32::try_from(order).unwrap_or(i32::MAX)));
                sum = sum + factor * [sine, cosine, -sine, -cosine][order % 4];
            }
            sum
        })
    }
}
