//! Sizes and traits of a mechanism, for code that takes any mechanism.

use crate::mechanism::dynamic::{Dynamic, Partitioned};
use crate::mechanism::{Kinematic, Mechanism};
use crate::scalar::number::Scalar;

/// A mechanism in numbers `T` that shows its numbers of coordinates and rows and the traits that it implements.
///
/// The macro implements it for every scene. It is generic, so that a program that does not use it compiles none of it.
pub trait Reveal<T: Scalar = f64>: Sized + 'static {
    /// Calls the method of `visitor` that suits the mechanism.
    fn reveal<V: Visitor<Self, T>>(self, visitor: V) -> V::Output;
}

/// The same mechanism in other numbers, its parameters and inputs rounded to them. For reference solutions of more digits, and for
/// comparisons of single with double precision.
///
/// The macro implements it for every scene in double precision.
///
/// ```
/// use mbs_runtime::{InNumbers, mechanism};
///
/// # mechanism! {
/// #     /// A crank.
/// #     pub mechanism Crank;
/// #     param omega: rad/s = 1;
/// #     coord phi: rad;
/// #     drive motor: phi == omega*t;
/// # }
///
/// let crank = Crank { omega: 0.1 };
/// let single: Crank<f32> = crank.in_numbers();
/// assert_eq!(single.omega, 0.1);
/// ```
pub trait InNumbers<U: Scalar> {
    /// Its type.
    type Mechanism;

    /// The mechanism with each parameter and input in the nearest number of type `U`.
    fn in_numbers(&self) -> Self::Mechanism;
}

/// Code that takes a mechanism `S` of any size: one method a set of traits, with `N` coordinates and `M` rows.
///
/// A mechanism is large where N + M is above [`Radau5::MOST_UNKNOWNS`](crate::dynamics::Radau5::MOST_UNKNOWNS). `Radau5` does
/// not take it, and dense matrices of all its unknowns are large for a stack.
pub trait Visitor<S, T: Scalar = f64> {
    /// Result of the visit.
    type Output;

    /// A mechanism without masses whose rows leave coordinates free: its functions can be evaluated.
    fn described<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Mechanism<T, N, M>;

    /// A mechanism without masses whose rows fix every coordinate.
    fn kinematic<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Mechanism<T, N, M, Lane: Kinematic<T::Real, N, M>> + Kinematic<T, N, M>;

    /// A mechanism with masses whose rows fix every coordinate.
    fn driven<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Mechanism<T, N, M, Lane: Kinematic<T::Real, N, M>>
            + Kinematic<T, N, M>
            + Dynamic<T, N, M>
            + Partitioned<T, N, M>;

    /// A mechanism with masses that forces move.
    fn free<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Dynamic<T, N, M> + Partitioned<T, N, M>;

    /// A large mechanism with masses whose rows fix every coordinate.
    fn large_driven<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Mechanism<T, N, M, Lane: Kinematic<T::Real, N, M>>
            + Kinematic<T, N, M>
            + Dynamic<T, N, M>
            + Partitioned<T, N, M>;

    /// A large mechanism with masses that forces move.
    fn large_free<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Dynamic<T, N, M> + Partitioned<T, N, M>;
}
