//! What masses add to the analyses of a mechanism: motion from forces, forces from motion, rest.

mod determined;
pub mod direct;
pub mod driven;
#[cfg(feature = "ready")]
mod first_order;
#[cfg(feature = "ready")]
pub mod linear;
mod loads;
#[cfg(feature = "ready")]
pub mod modes;
pub mod rest;
#[cfg(feature = "ready")]
mod settling;
mod single;
pub mod start;
mod supplied;

use mbs_runtime::{Dynamic, Failure};

use crate::facade::{Motion, State};
use crate::masses::{Loads, MassFacade};
use direct::{Approach, Simulated};
#[cfg(feature = "ready")]
use linear::SmallMotions;
use rest::Rest;

/// A mechanism with masses of any size, whose motion follows from forces.
pub trait AnyDynamics {
    /// The motion from the text's start at the first instant (s) through the others.
    ///
    /// `progress` hears the number of instants done.
    ///
    /// # Errors
    /// Where it cannot start. A failure on the way is part of what is returned.
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
    /// The position of rest next to the text's start, at time 0. `guesses` are coordinates by their indices that the search
    /// starts from in place of the text's; the others follow them as the rows ask.
    ///
    /// # Errors
    /// Those of the search for an equilibrium.
    fn rest(&self, guesses: &[(usize, f64)]) -> Result<Rest, Failure>;
    /// Multipliers λ (M) of a state, with the text's start of its first-order states: accelerations follow from the rows where
    /// they fix them, else from the forces.
    ///
    /// # Errors
    /// Where a motion that the rows leave free moves no mass, or a vector has another length than it should.
    fn multipliers(&self, state: &State) -> Result<Loads, String>;
    /// Small motions about the last instant of a motion from forces, or about a position of rest.
    ///
    /// # Errors
    /// Why there are none, in words.
    #[cfg(feature = "ready")]
    fn small_motions(&self, motion: &Motion) -> Result<SmallMotions, String>;
    /// A stable rest that it comes to from the rest `unstable` with `small` motions, its energy falling; none where it comes to none
    /// that way, or where forces depend on the time.
    #[cfg(feature = "ready")]
    fn settled(&self, unstable: &Rest, small: &SmallMotions) -> Option<Rest>;
}

impl<S: Dynamic<f64, N, M>, const N: usize, const M: usize> AnyDynamics for MassFacade<S, N, M> {
    fn simulate(
        &self,
        approach: &Approach,
        times: &[f64],
        progress: &mut dyn FnMut(usize),
    ) -> Result<Simulated, Failure> {
        direct::simulate(&self.kinematics.0, &self.partitioned, approach, times, progress)
    }

    fn add_forces(&self, motion: &mut Motion) -> Result<(), Failure> {
        driven::add_forces(&self.kinematics.0, motion)
    }

    fn rest(&self, guesses: &[(usize, f64)]) -> Result<Rest, Failure> {
        let mechanism = &self.kinematics.0;
        let start = (self.partitioned.start)(mechanism, 0.0).0;
        rest::rest(mechanism, &rest::begin(mechanism, start, guesses))
    }

    fn multipliers(&self, state: &State) -> Result<Loads, String> {
        loads::multipliers(&self.kinematics.0, state)
    }

    #[cfg(feature = "ready")]
    fn small_motions(&self, motion: &Motion) -> Result<SmallMotions, String> {
        linear::small_motions(&self.kinematics.0, self.partitioned.independent, motion)
    }

    #[cfg(feature = "ready")]
    fn settled(&self, unstable: &Rest, small: &SmallMotions) -> Option<Rest> {
        let independent = self.partitioned.independent;
        let fall = || settling::settled(&self.kinematics.0, independent, &unstable.motion, small);
        (!unstable.held).then(fall).flatten()
    }
}
