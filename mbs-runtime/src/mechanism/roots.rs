//! Closed-form positions of a block.

use crate::scalar::number::Scalar;

/// The positions in which a block of K unknowns closes.
#[derive(Clone, Copy, Debug)]
pub struct Roots<T: Scalar, const K: usize> {
    /// The two positions; twice the one nearest to closing where there is none.
    pub x: [[T; K]; 2],
    /// Lanes in which the block closes.
    pub real: T::Mask,
}
