//! Reference solutions in double-double numbers by two methods of different kind, none of them of the runtime.
//!
//! [`extrapolated`] integrates M q̈ + Φ_qᵀ λ = Q with Φ_q q̈ = γ by extrapolated midpoint steps. [`collocated`] integrates
//! M q̈ + Φ_qᵀ λ = Q with Φ_q q̇ + Φ_t = 0 by Radau IIA of five stages; its motion does not depend on γ. Accelerations and reactions at
//! the instants of both follow from γ. Both put their positions back onto
//! Φ = 0 after each step. A fault of the runtime, of a method's weights or of γ alone is therefore no fault of both.
//!
//! Modes of frictions that stick, of rigid contacts and of events are decided by the runtime alone. Motions with them have references of one
//! kind ([`one_kind`]): two explicit methods of the runtime, of different order and formulation.

pub mod collocated;
pub mod extrapolated;
pub mod linear;
pub mod motion;
pub mod one_kind;

pub use motion::{Contact, Leg, Reference, Shot, reference};
