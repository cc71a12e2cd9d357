//! Functions that both sides of a cross-check know, in place of those that a text declares.

use mbs_runtime::{Function, Scalar};

use crate::facade::{AnyEquations, AnyMechanism};
use crate::registry::{self, Card, Mismatch};

/// Makes a mechanism.
type Make = fn() -> Box<dyn AnyMechanism>;

/// Ready mechanisms with functions, each with stand-ins for them.
const WITH_FUNCTIONS: [(&str, Make); 1] = [("cam_law", crate::cam_law::compared)];

/// A new instance of which both sides of a cross-check know everything.
pub fn comparable(card: &Card) -> Box<dyn AnyMechanism> {
    let found = WITH_FUNCTIONS.iter().find(|(name, _)| *name == card.name);
    found.map_or_else(card.make, |(_, make)| make())
}

/// The mechanism called `name`, free to move or not, so that both sides of a cross-check know everything.
///
/// # Errors
/// [`Mismatch::Mechanism`] where there is none; its text lists the known names.
pub fn comparable_by_name(name: &str) -> Result<Box<dyn AnyEquations>, Mismatch> {
    match registry::FREE.iter().find(|card| card.name == name) {
        Some(card) => Ok((card.make)()),
        None => Ok(comparable(registry::find(name)?)),
    }
}

/// What CasADi takes for the declared function of index `I`: `Σ a sin(w x + p)`, its derivatives by formula.
///
/// A mechanism with functions is confirmed with these in their places, in the order of the text:
/// `check(Follower::new(StandIn::<0>, StandIn::<1>))`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StandIn<const I: usize>;

impl<T: Scalar, const I: usize> Function<T> for StandIn<I> {
    const ORDER: usize = u8::MAX as usize;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        let terms = mbs_codegen::stand_in(I);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::ALL;

    #[test]
    fn every_mechanism_with_functions_has_stand_ins() {
        for card in ALL {
            let listed = WITH_FUNCTIONS.iter().any(|(name, _)| *name == card.name);
            assert_eq!((card.make)().functions().is_empty(), !listed, "{}", card.name);
        }
    }
}
