//! What a lecture shows: matrices, Newton's iterations, basins of attraction, safe steps, degrees of freedom.
//!
//! [`experiment`] is what the emitted types lend to it; everything else computes with plain vectors.

#[cfg(feature = "ready")]
pub mod basins;
#[cfg(feature = "ready")]
pub mod comparison;
#[cfg(feature = "ready")]
pub mod drift;
pub mod experiment;
pub mod formulas;
#[cfg(feature = "ready")]
pub mod freedom;
#[cfg(feature = "ready")]
pub mod latex;
#[cfg(feature = "ready")]
pub mod matrix;
#[cfg(feature = "ready")]
pub mod next_position;
#[cfg(feature = "ready")]
pub mod picture;
#[cfg(feature = "ready")]
pub mod rank;
