//! Contradiction that redundant rows may keep.

use crate::scalar::number::Scalar;
use crate::tolerances::positions;

/// Contradiction that the rows of a block may keep: the widths that the text states, M, in the units of the rows.
#[derive(Clone, Copy, Debug)]
pub struct Widths<T, const M: usize>([T; M]);

impl<T: Scalar, const M: usize> Widths<T, M> {
    /// Of a text that states none.
    #[inline(always)]
    pub fn none() -> Self {
        Widths([T::constant(0.0); M])
    }

    /// Those of the block of `rows` (M), out of `all`.
    #[inline]
    pub fn of(all: &[T], rows: &[u16; M]) -> Self {
        let width = |row: u16| all.get(usize::from(row)).map_or(T::constant(0.0), |width| *width);
        Widths(rows.map(width))
    }

    /// Least residual allowed to each row in addition to rounding, in the unit of the row.
    ///
    /// Least squares share a contradiction among all rows that take part in it, so rows without a width have the largest one
    /// of the block, in the reference metric.
    pub(crate) fn granted(&self, row_scales: &[T; M]) -> [T; M] {
        let largest = largest_width(&self.0, row_scales).max(positions::OF_DIMENSIONS.of());
        let mut granted = *row_scales;
        for (granted, width) in granted.iter_mut().zip(&self.0) {
            let stated = T::constant(0.0).less(*width);
            *granted = T::select(
                stated,
                width.max(positions::OF_DIMENSIONS.of::<T>() * *granted),
                largest * *granted,
            );
        }
        granted
    }
}

/// The largest of `widths` (M) in the reference metric.
pub(crate) fn largest_width<T: Scalar, const M: usize>(widths: &[T; M], row_scales: &[T; M]) -> T {
    let mut largest = T::constant(0.0);
    for (width, scale) in widths.iter().zip(row_scales) {
        largest = largest.max(*width / *scale);
    }
    largest
}
