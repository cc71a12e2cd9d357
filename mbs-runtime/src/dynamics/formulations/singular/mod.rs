//! Singular positions: limits of rows, passages, contradictions, and the reason why no step is accepted.

pub(crate) mod branch;
pub(crate) mod contradiction;
pub(crate) mod limit_rows;
pub(crate) mod passage;
pub(crate) mod rank;
pub(crate) mod step_failure;
