//! Analyses of a mechanism with masses: direct dynamics, inverse dynamics, static equilibrium, small motions.

mod determined;
pub mod direct_dynamics;
#[cfg(feature = "program")]
mod first_order;
pub mod integrators;
pub mod inverse_dynamics;
#[cfg(feature = "program")]
pub mod linearization;
mod loads;
#[cfg(feature = "program")]
pub mod modes;
mod power_balance;
mod record;
#[cfg(feature = "program")]
mod settling;
pub mod start;
pub mod static_equilibrium;
mod work_by_source;
#[cfg(test)]
mod work_by_source_tests;

use mbs_runtime::{Dynamic, Failure};

use crate::erased::facade::{Facade, Motion, State};
use crate::erased::masses::Loads;
use direct_dynamics::{Approach, PartitionedFunctions, Simulated};
use integrators::Integrators;
#[cfg(feature = "program")]
use linearization::SmallMotions;
use static_equilibrium::Rest;

/// A mechanism with masses of any size, whose motion follows from forces.
pub trait AnyDynamics {
    /// The motion from the text's start at the first instant (s) through the others.
    ///
    /// `progress` gets the number of instants done.
    ///
    /// # Errors
    /// The mechanism cannot start. A later failure is part of the result.
    fn simulate(
        &self,
        approach: &Approach,
        times: &[f64],
        progress: &mut dyn FnMut(usize),
    ) -> Result<Simulated, Failure>;
    /// Adds to a motion that drives prescribe the energies, efforts and multipliers that it needs.
    ///
    /// # Errors
    /// Those of inverse dynamics.
    fn add_forces(&self, motion: &mut Motion) -> Result<(), Failure>;
    /// The equilibrium next to the text's start, at time 0. `guesses` are coordinates by their indices from which the search
    /// starts in place of the text's; the others follow them so that the rows hold. Named coordinates that no force answers are
    /// at their values in the equilibrium.
    ///
    /// # Errors
    /// Those of the search for an equilibrium.
    fn rest(&self, guesses: &[(usize, f64)]) -> Result<Rest, Failure>;
    /// Multipliers λ (M) of a state, with the text's start of its first-order states. Accelerations follow from the rows if these
    /// fix them, else from the forces.
    ///
    /// # Errors
    /// A motion that the rows leave free moves no mass, or a vector has a wrong length.
    fn multipliers(&self, state: &State) -> Result<Loads, String>;
    /// Small motions about the last instant of a motion from forces, or about a position of rest.
    ///
    /// # Errors
    /// Reason why there are none, in words.
    #[cfg(feature = "program")]
    fn small_motions(&self, motion: &Motion) -> Result<SmallMotions, String>;
    /// A stable equilibrium reached with falling energy from the equilibrium `unstable` with `small` motions; none if none is
    /// found, or if forces depend on the time.
    #[cfg(feature = "program")]
    fn settled(&self, unstable: &Rest, small: &SmallMotions) -> Option<Rest>;
}

impl<S, I, const N: usize, const M: usize> AnyDynamics for Facade<S, N, M, PartitionedFunctions<S, I, N, M>>
where
    S: Dynamic<f64, N, M> + 'static,
    I: Integrators,
{
    fn simulate(
        &self,
        approach: &Approach,
        times: &[f64],
        progress: &mut dyn FnMut(usize),
    ) -> Result<Simulated, Failure> {
        let mut mechanism = self.0.clone();
        (self.1.feed)(&mut mechanism, &self.2, times.first().copied().unwrap_or(0.0));
        direct_dynamics::simulate(&mechanism, &self.1, approach, times, progress)
    }

    fn add_forces(&self, motion: &mut Motion) -> Result<(), Failure> {
        let mut mechanism = self.0.clone();
        let mut lead = |mechanism: &mut S, t| (self.1.feed)(mechanism, &self.2, t);
        lead(&mut mechanism, motion.time.first().copied().unwrap_or(0.0));
        inverse_dynamics::add_forces::<S, I, N, M>(mechanism, &mut lead, motion)
    }

    fn rest(&self, guesses: &[(usize, f64)]) -> Result<Rest, Failure> {
        let mechanism = &self.0;
        let start = (self.1.start)(mechanism, 0.0).0;
        let found =
            static_equilibrium::rest(mechanism, &static_equilibrium::begin(mechanism, start, guesses))?;
        Ok(static_equilibrium::at_guesses(mechanism, found, guesses))
    }

    fn multipliers(&self, state: &State) -> Result<Loads, String> {
        loads::multipliers(&self.0, state)
    }

    #[cfg(feature = "program")]
    fn small_motions(&self, motion: &Motion) -> Result<SmallMotions, String> {
        linearization::small_motions(&self.0, self.1.independent, motion)
    }

    #[cfg(feature = "program")]
    fn settled(&self, unstable: &Rest, small: &SmallMotions) -> Option<Rest> {
        let independent = self.1.independent;
        let fall = || settling::settled::<S, I, N, M>(&self.0, independent, &unstable.motion, small);
        (!unstable.held).then(fall).flatten()
    }
}
