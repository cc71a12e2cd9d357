//! What a lecture shows: matrices, Newton's iterations, basins of attraction, safe steps, degrees of freedom.
//!
//! [`experiment`] is what the emitted types lend to it; everything else computes with plain vectors.

pub mod basins;
mod branchless;
pub mod comparison;
pub mod drift;
pub mod experiment;
pub mod formulas;
pub mod freedom;
pub mod latex;
pub mod matrix;
pub mod next_position;
pub mod picture;
pub mod rank;
