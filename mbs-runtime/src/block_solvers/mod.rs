//! Solvers of one nonlinear block: next position, assembly, redundant rows, bounded work.

pub(crate) mod bounded_newton;
pub(crate) mod budget;
pub(crate) mod convergence;
pub(crate) mod dyad;
pub(crate) mod fast_newton;
pub(crate) mod gauss_newton;
pub(crate) mod levenberg_marquardt;
pub(crate) mod multistart;
pub(crate) mod newton;
#[cfg(test)]
mod newton_tests;
mod root_step;
pub(crate) mod trace;
