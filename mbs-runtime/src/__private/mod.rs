//! Functions that only emitted code calls. Not part of the public interface.

pub mod chunks;
pub(crate) mod evaluation;
pub mod tape;

pub use evaluation::{call_never_inlined, is_same};

pub use crate::dynamics::formulations::block_elimination::accelerations;
pub use crate::dynamics::linear_systems::sparse::{SparseFactors, SparseOrder};
pub use crate::linear_algebra::guarded::LARGEST_MULTIPLIER;
pub use crate::mechanism::outcome::first_failure;
pub use crate::mechanism::phase::means;
