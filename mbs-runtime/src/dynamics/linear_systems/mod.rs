//! Linear systems of the equations of motion: saddle-point system, dense and without its zeros, null space, tangents, sign patterns, first-order states.

pub(crate) mod blocks;
pub(crate) mod integrals;
pub(crate) mod kkt;
pub(crate) mod null_space;
pub(crate) mod piecewise;
pub mod sparse;
pub(crate) mod states;
pub(crate) mod tangent;
