//! Formulations: accelerations and multipliers from a state, and the way back onto the constraints.

pub(crate) mod baumgarte;
pub(crate) mod block_elimination;
pub(crate) mod friction;
pub(crate) mod penalty;
pub(crate) mod projection;
pub(crate) mod residuals;
pub(crate) mod set_valued;
pub(crate) mod singular;
pub(crate) mod unstabilized;
pub(crate) mod variation;
pub(crate) mod velocity_transformation;
