//! What masses add to the analyses of a mechanism: motion from forces, forces from motion, rest.

pub mod direct;
pub mod driven;
pub mod rest;
pub mod start;

use mbs_runtime::{Dynamic, Failure};

use crate::facade::Motion;
use crate::masses::MassFacade;
use direct::{Approach, Simulated};

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
    /// The position of rest next to the text's start, at time 0, as a motion of one instant.
    ///
    /// # Errors
    /// Those of the search for an equilibrium.
    fn rest(&self) -> Result<Motion, Failure>;
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

    fn rest(&self) -> Result<Motion, Failure> {
        let mechanism = &self.kinematics.0;
        rest::rest(mechanism, &(self.partitioned.start)(mechanism, 0.0).0)
    }
}
