//! From a mechanism of a known type to one behind an object-safe trait.

use mbs_runtime::{Dynamic, Kinematic, Mechanism, Partitioned, Reveal, Visitor};

use super::dynamics::AnyDynamics;
use super::dynamics::direct_dynamics::PartitionedFunctions;
use super::dynamics::integrators::{All, ExplicitOnly};
use super::facade::{AnyEquations, AnyMechanism, Facade, Feeds};

/// A mechanism of any size.
pub enum Erased {
    /// Its rows fix every coordinate.
    Fixed(Box<dyn AnyMechanism>),
    /// Its rows leave coordinates free; forces move it if it has masses.
    Free(Box<dyn AnyEquations>),
}

impl Erased {
    /// Names and functions.
    pub fn equations(&self) -> &dyn AnyEquations {
        match self {
            Erased::Fixed(mechanism) => mechanism.as_ref(),
            Erased::Free(mechanism) => mechanism.as_ref(),
        }
    }

    /// Names and functions, for setting parameters.
    pub fn equations_mut(&mut self) -> &mut dyn AnyEquations {
        match self {
            Erased::Fixed(mechanism) => mechanism.as_mut(),
            Erased::Free(mechanism) => mechanism.as_mut(),
        }
    }

    /// Motion from forces and forces from motion; `None` where the text has no masses or forces.
    pub fn dynamics(&self) -> Option<&dyn AnyDynamics> {
        self.equations().dynamics()
    }

    /// Names and functions alone.
    pub fn into_equations(self) -> Box<dyn AnyEquations> {
        match self {
            Erased::Fixed(mechanism) => mechanism,
            Erased::Free(mechanism) => mechanism,
        }
    }

    /// The mechanism where its rows fix it.
    pub fn into_mechanism(self) -> Option<Box<dyn AnyMechanism>> {
        match self {
            Erased::Fixed(mechanism) => Some(mechanism),
            Erased::Free(_) => None,
        }
    }
}

/// Hides the size of `mechanism`; all that the program does with it is compiled here.
pub fn erase<S: Reveal>(mechanism: S) -> Erased {
    mechanism.reveal(Erase)
}

struct Erase;

impl<S: 'static> Visitor<S> for Erase {
    type Output = Erased;

    fn described<const N: usize, const M: usize>(self, mechanism: S) -> Erased
    where
        S: Mechanism<f64, N, M>,
    {
        Erased::Free(Box::new(Facade::<S, N, M>::of(mechanism)))
    }

    fn kinematic<const N: usize, const M: usize>(self, mechanism: S) -> Erased
    where
        S: Kinematic<f64, N, M>,
    {
        Erased::Fixed(Box::new(Facade::<S, N, M>::of(mechanism)))
    }

    fn driven<const N: usize, const M: usize>(self, mechanism: S) -> Erased
    where
        S: Kinematic<f64, N, M> + Dynamic<f64, N, M> + Partitioned<f64, N, M>,
    {
        let partitioned = PartitionedFunctions::<S, All, N, M>::of();
        Erased::Fixed(Box::new(Facade::<S, N, M, _>(mechanism, partitioned, Feeds::default())))
    }

    fn free<const N: usize, const M: usize>(self, mechanism: S) -> Erased
    where
        S: Dynamic<f64, N, M> + Partitioned<f64, N, M>,
    {
        let partitioned = PartitionedFunctions::<S, All, N, M>::of();
        Erased::Free(Box::new(Facade::<S, N, M, _>(mechanism, partitioned, Feeds::default())))
    }

    fn large_driven<const N: usize, const M: usize>(self, mechanism: S) -> Erased
    where
        S: Kinematic<f64, N, M> + Dynamic<f64, N, M> + Partitioned<f64, N, M>,
    {
        let partitioned = PartitionedFunctions::<S, ExplicitOnly, N, M>::of();
        Erased::Fixed(Box::new(Facade::<S, N, M, _>(mechanism, partitioned, Feeds::default())))
    }

    fn large_free<const N: usize, const M: usize>(self, mechanism: S) -> Erased
    where
        S: Dynamic<f64, N, M> + Partitioned<f64, N, M>,
    {
        let partitioned = PartitionedFunctions::<S, ExplicitOnly, N, M>::of();
        Erased::Free(Box::new(Facade::<S, N, M, _>(mechanism, partitioned, Feeds::default())))
    }
}
