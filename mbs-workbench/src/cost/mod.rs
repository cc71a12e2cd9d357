//! Cost of accuracy: each setting of the solvers by its true error and its time.

pub mod advice;
pub mod continued;
#[cfg(test)]
mod counts_tests;
#[cfg(test)]
mod doubles_tests;
pub mod errors;
pub mod kernels;
pub mod kinematics;
pub mod moved;
#[cfg(test)]
mod one_kind_tests;
pub mod peers;
pub mod perturbed;
pub mod picture;
pub mod points;
pub mod reference;
pub mod result;
pub mod splines;
#[cfg(test)]
mod tests;
pub mod third_leg;
