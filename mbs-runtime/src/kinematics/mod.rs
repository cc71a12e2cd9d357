//! One instant: position, velocity, acceleration, and the homotopy that leads from one position to the next.

pub(crate) mod assembly;
pub(crate) mod consistency;
pub(crate) mod homotopy;
pub(crate) mod least_squares_assembly;
pub(crate) mod link_lengths;
pub(crate) mod newton_raphson;
pub(crate) mod position;
