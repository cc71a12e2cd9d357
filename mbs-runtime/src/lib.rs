//! Fixed-size, allocation-free solvers for mechanisms declared with [`mechanism!`].
//!
//! A mechanism is written once as text; the macro differentiates it and emits an implementation of
//! [`Mechanism`] and, where the structure is square, of [`Kinematic`]. The solvers here work on those
//! traits alone. Nothing allocates, nothing panics, every failure is a [`Failure`] value that
//! names the row or the coordinate and its line in the text.
#![no_std]
#![forbid(unsafe_code)]

pub mod failure;
pub mod lanes;
pub mod mechanism;
pub mod scalar;

pub use failure::{Failure, Outcome};
pub use lanes::Lanes;
pub use mechanism::{
    Block, BlockSolver, Entry, Evaluation, Factorization, Kinematic, Margin, Mechanism, OutputValue, Signal,
};
pub use scalar::{Real, Scalar};

/// Declares a mechanism; see the grammar in the README.
#[macro_export]
macro_rules! mechanism {
    ($($text:tt)*) => { $crate::__expand! { ($crate) $($text)* } };
}

#[doc(hidden)] // the mechanism! macro calls it
pub use mbs_macros::mechanism as __expand;
