//! Integrators of ordinary differential equations, step control and events. They know nothing of mechanisms.

pub(crate) mod dormand_prince5;
pub(crate) mod dormand_prince8;
pub(crate) mod either;
pub(crate) mod embedded;
pub(crate) mod equation;
pub(crate) mod event;
pub(crate) mod fixed_step;
pub(crate) mod step_control;
pub(crate) mod vector;
