//! Values of inputs, parameters and phases as a saved state keeps them.

use core::fmt::Debug;

/// The numbers of a saved mechanism's variables: `[f64; V]`, one for each of [`VARIABLES`](crate::Mechanism::VARIABLES).
pub trait Kept: Copy + Debug + PartialEq + AsRef<[f64]> + AsMut<[f64]> {
    /// V.
    const COUNT: usize;
    /// All 0.
    const ZEROS: Self;
}

impl<const V: usize> Kept for [f64; V] {
    const COUNT: usize = V;
    const ZEROS: Self = [0.0; V];
}
