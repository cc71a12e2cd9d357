//! From a mechanism of a known type to one behind an object-safe trait.

use mbs_runtime::{Dynamic, Kinematic, Mechanism, Partitioned, Reveal, Visitor};

use super::dynamics::AnyDynamics;
use super::dynamics::direct_dynamics::PartitionedFunctions;
use super::dynamics::integrators::{All, ExplicitOnly, Integrators};
use super::facade::{AnyEquations, AnyMechanism, Facade};
use super::fed::{Fed, may_have_inputs};
use super::feeds::Feeds;

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

/// A mechanism with masses whose inputs can follow courses.
type WithInputs<S, I, const N: usize, const M: usize> =
    Facade<Fed<S>, N, M, PartitionedFunctions<Fed<S>, I, N, M>>;

fn with_inputs<S, I, const N: usize, const M: usize>(mechanism: S) -> WithInputs<S, I, N, M>
where
    S: Dynamic<f64, N, M> + 'static,
    I: Integrators,
{
    let mut partitioned = PartitionedFunctions::of();
    partitioned.feed = Fed::feed::<N, M>;
    Facade(Fed::of(mechanism), partitioned, Feeds::default())
}

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
        if const { may_have_inputs(S::SOURCE) } {
            return Erased::Fixed(Box::new(with_inputs::<S, All, N, M>(mechanism)));
        }
        let partitioned = PartitionedFunctions::<S, All, N, M>::of();
        Erased::Fixed(Box::new(Facade::<S, N, M, _>(mechanism, partitioned, Feeds::default())))
    }

    fn free<const N: usize, const M: usize>(self, mechanism: S) -> Erased
    where
        S: Dynamic<f64, N, M> + Partitioned<f64, N, M>,
    {
        if const { may_have_inputs(S::SOURCE) } {
            return Erased::Free(Box::new(with_inputs::<S, All, N, M>(mechanism)));
        }
        let partitioned = PartitionedFunctions::<S, All, N, M>::of();
        Erased::Free(Box::new(Facade::<S, N, M, _>(mechanism, partitioned, Feeds::default())))
    }

    fn large_driven<const N: usize, const M: usize>(self, mechanism: S) -> Erased
    where
        S: Kinematic<f64, N, M> + Dynamic<f64, N, M> + Partitioned<f64, N, M>,
    {
        if const { may_have_inputs(S::SOURCE) } {
            return Erased::Fixed(Box::new(with_inputs::<S, ExplicitOnly, N, M>(mechanism)));
        }
        let partitioned = PartitionedFunctions::<S, ExplicitOnly, N, M>::of();
        Erased::Fixed(Box::new(Facade::<S, N, M, _>(mechanism, partitioned, Feeds::default())))
    }

    fn large_free<const N: usize, const M: usize>(self, mechanism: S) -> Erased
    where
        S: Dynamic<f64, N, M> + Partitioned<f64, N, M>,
    {
        if const { may_have_inputs(S::SOURCE) } {
            return Erased::Free(Box::new(with_inputs::<S, ExplicitOnly, N, M>(mechanism)));
        }
        let partitioned = PartitionedFunctions::<S, ExplicitOnly, N, M>::of();
        Erased::Free(Box::new(Facade::<S, N, M, _>(mechanism, partitioned, Feeds::default())))
    }
}
