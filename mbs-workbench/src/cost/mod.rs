//! Cost of accuracy: each setting of the solvers by its true error and its time.

pub mod advice;
pub mod kinematics;
pub mod moved;
pub mod peers;
pub mod perturbed;
pub mod picture;
pub mod points;
pub mod reference;
pub mod result;
pub mod splines;
#[cfg(test)]
mod tests;
