//! State of a motion at one time, with accelerations and multipliers.

use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::Solved;

/// One instant of a motion: state, accelerations, multipliers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant<R, const N: usize, const M: usize, Z> {
    /// Time (s).
    pub t: R,
    /// Coordinates, velocities, first-order states, work.
    pub y: IntegratorState<R, N, Z>,
    /// Their rates and the multipliers.
    pub solved: Solved<R, N, M, Z>,
    /// Accelerations that a method carries from step to step in addition to q̈; q̈ where it carries none: N.
    pub carried: [R; N],
}
