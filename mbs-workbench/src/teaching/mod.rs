//! Teaching commands: basins of attraction, safe steps, degrees of freedom, drift, comparison of coordinates.
//!
//! [`experiment`](crate::erased::experiment) lends single steps of the solvers; everything here computes with plain vectors.

pub mod basins;
pub mod basins_picture;
pub mod comparison;
pub mod drift;
pub mod freedom;
pub mod next_position;
pub mod rank;
