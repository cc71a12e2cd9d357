//! Implicit methods of equal steps.

pub(crate) mod augmented_lagrangian;
pub(crate) mod extrapolated;
pub(crate) mod generalized_alpha;
mod held_rows;
pub(crate) mod iteration;
pub(crate) mod springs;
