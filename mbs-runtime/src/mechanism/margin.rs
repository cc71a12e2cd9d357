//! Margin of a Jacobian to singularity, and the signs of the blocks' determinants.

use core::hint::black_box;

use crate::scalar::number::{Scalar, index};

/// Margin of a Jacobian to singularity, with the block that has it.
#[derive(Clone, Copy, Debug)]
pub struct Margin<T: Scalar> {
    /// 0 where singular, at most 1, independent of units: the smallest of any diagonal block.
    pub value: T,
    /// Index of the first row of that block: a number, so that it is selected like everything else.
    row: T,
    /// Index of its first coordinate.
    coordinate: T,
    /// Signs of the blocks' determinants, one bit a block, a lane. Where a bit has changed from one position to the
    /// next, the mechanism passed a singular position in between, or it is in another assembly. Bits of more than 64
    /// blocks lie on each other; blocks of more rows than coordinates have no determinant and no bit.
    pub orientation: T::Lanes<u64>,
}

impl<T: Scalar> Margin<T> {
    /// The margin of a mechanism without any block that could become singular.
    pub fn regular() -> Self {
        let none = T::constant(0.0);
        Margin { value: T::constant(1.0), row: none, coordinate: none, orientation: T::per_lane(|_| 0) }
    }

    /// The smaller one of this margin and that of a block with first row `row` and first coordinate `coordinate`.
    #[inline(always)]
    pub fn with_block(self, value: T, row: u16, coordinate: u16) -> Self {
        let nearer = value.less(self.value);
        Margin {
            value: in_one_piece::<T, _>(T::select(nearer, value, self.value)),
            row: T::select(nearer, T::constant(f64::from(row)), self.row),
            coordinate: T::select(nearer, T::constant(f64::from(coordinate)), self.coordinate),
            orientation: self.orientation,
        }
    }

    /// Becomes the smaller one of this margin and that of a block with its first row and coordinate (indices below 65 536). Takes
    /// up the sign of its determinant too: negative where `reverses`.
    #[inline(always)]
    pub fn take(&mut self, value: T, [row, coordinate]: [usize; 2], reverses: T::Mask) {
        *self = self.with_block(value, row as u16, coordinate as u16).oriented(reverses);
    }

    /// Index of the first row of the block, of lane `lane`.
    pub fn row(&self, lane: usize) -> u16 {
        index(self.row, lane)
    }

    /// Index of its first coordinate, of lane `lane`.
    pub fn coordinate(&self, lane: usize) -> u16 {
        index(self.coordinate, lane)
    }

    /// This margin with the sign of one more block's determinant: negative where `reverses`.
    #[inline(always)]
    pub fn oriented(self, reverses: T::Mask) -> Self {
        let turned = |lane: usize| {
            let signs = self.orientation.as_ref().get(lane).copied().unwrap_or(0);
            signs.rotate_left(1) ^ u64::from(T::test(reverses, lane))
        };
        Margin { orientation: in_one_piece::<T, _>(T::per_lane(turned)), ..self }
    }
}

/// Keeps lanes that pass from block to block together: over so many blocks the compiler would lose sight of the lanes that
/// belong together, and compute them in twos and ones.
#[inline(always)]
fn in_one_piece<T: Scalar, X>(lanes: X) -> X {
    if T::LANES > 1 { black_box(lanes) } else { lanes }
}
