//! Sizes and traits of a mechanism, for code that takes any mechanism.

use crate::mechanism::dynamic::{Dynamic, Partitioned};
use crate::mechanism::{Kinematic, Mechanism};

/// A mechanism in double precision that shows its numbers of coordinates and rows and the traits that it implements.
///
/// The macro implements it for every scene. It is generic, so that a program that does not use it compiles none of it.
pub trait Reveal: Sized + 'static {
    /// Calls the method of `visitor` that suits the mechanism.
    fn reveal<V: Visitor<Self>>(self, visitor: V) -> V::Output;
}

/// Code that takes a mechanism `S` of any size: one method a set of traits, with `N` coordinates and `M` rows.
///
/// A mechanism is large where N + M is above [`Radau5::MOST_UNKNOWNS`](crate::dynamics::Radau5::MOST_UNKNOWNS). `Radau5` does
/// not take it, and dense matrices of all its unknowns are large for a stack.
pub trait Visitor<S> {
    /// Result of the visit.
    type Output;

    /// A mechanism without masses whose rows leave coordinates free: its functions can be evaluated.
    fn described<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Mechanism<f64, N, M>;

    /// A mechanism without masses whose rows fix every coordinate.
    fn kinematic<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Kinematic<f64, N, M>;

    /// A mechanism with masses whose rows fix every coordinate.
    fn driven<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Kinematic<f64, N, M> + Dynamic<f64, N, M> + Partitioned<f64, N, M>;

    /// A mechanism with masses that forces move.
    fn free<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Dynamic<f64, N, M> + Partitioned<f64, N, M>;

    /// A large mechanism with masses whose rows fix every coordinate.
    fn large_driven<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Kinematic<f64, N, M> + Dynamic<f64, N, M> + Partitioned<f64, N, M>;

    /// A large mechanism with masses that forces move.
    fn large_free<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Dynamic<f64, N, M> + Partitioned<f64, N, M>;
}
