//! Linear systems of the equations of motion: saddle-point system, null space, tangents, sign patterns, first-order states.

pub(crate) mod blocks;
pub(crate) mod integrals;
pub(crate) mod kkt;
pub(crate) mod null_space;
pub(crate) mod piecewise;
pub(crate) mod states;
pub(crate) mod tangent;
