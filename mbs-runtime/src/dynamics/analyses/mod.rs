//! Analyses of one state: inverse dynamics, small motions, uniqueness of multipliers.

pub(crate) mod determinacy;
pub(crate) mod held_variation;
pub(crate) mod inverse;
pub(crate) mod linearization;
mod modes;
mod virtual_motions;
