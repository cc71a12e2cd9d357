//! Cost of accuracy: each setting of the solvers by its true error and its time.

pub mod double_double;
mod elementary;
