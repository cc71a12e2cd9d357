//! Contradiction that redundant rows may keep.

use crate::scalar::number::Scalar;
use crate::tolerances::{positions, singular};

/// Contradiction that the rows of a block may keep: the widths that the text states, M, in the units of the rows.
#[derive(Clone, Copy, Debug)]
pub struct Widths<T, const M: usize>([T; M]);

impl<T: Scalar, const M: usize> Widths<T, M> {
    /// Of a text that states none.
    #[inline(always)]
    pub fn none() -> Self {
        Widths([T::constant(0.0); M])
    }

    /// Those of all rows.
    pub(crate) fn from(widths: [T; M]) -> Self {
        Widths(widths)
    }

    /// Those of the block of `rows` (M), out of `all`.
    #[inline]
    pub fn of(all: &[T], rows: &[u16; M]) -> Self {
        let width = |row: u16| all.get(usize::from(row)).map_or(T::constant(0.0), |width| *width);
        Widths(rows.map(width))
    }

    /// `true` if a row of any lane has a width.
    #[inline]
    pub(crate) fn are_stated(&self) -> bool {
        self.0.iter().any(|width| !T::all(!T::constant(0.0).less(*width)))
    }

    /// The scales of rows that yield over their weight and with the sign changed, those of the others as they are.
    pub(crate) fn yielding(&self, row_scales: &[T; M]) -> [T; M] {
        let mut scales = *row_scales;
        let light = T::constant(-1.0) / singular::YIELDING_WEIGHT.of::<T>();
        for (scale, width) in scales.iter_mut().zip(&self.0) {
            *scale = T::select(T::constant(0.0).less(*width), light * *scale, *scale);
        }
        scales
    }

    /// Least residual allowed to each row in addition to rounding, in the unit of the row.
    ///
    /// Rows with a width yield to the others. These keep the square of [`singular::YIELDING_WEIGHT`] of the largest width, in the
    /// reference metric, for [`OF_THE_OTHERS`] of it.
    pub(crate) fn granted(&self, row_scales: &[T; M]) -> [T; M] {
        let weight = singular::YIELDING_WEIGHT.of::<T>();
        let kept = T::constant(OF_THE_OTHERS) * weight * weight * largest_width(&self.0, row_scales);
        let kept = kept.max(positions::OF_DIMENSIONS.of());
        let mut granted = *row_scales;
        for (granted, width) in granted.iter_mut().zip(&self.0) {
            let stated = T::constant(0.0).less(*width);
            *granted =
                T::select(stated, width.max(positions::OF_DIMENSIONS.of::<T>() * *granted), kept * *granted);
        }
        granted
    }
}

/// Contradiction that rows without a width may keep, in squares of the weight times the largest width: what rows of unequal
/// gradients make of it.
const OF_THE_OTHERS: f64 = 64.0;

/// The largest of `widths` (M) in the reference metric.
pub(crate) fn largest_width<T: Scalar, const M: usize>(widths: &[T; M], row_scales: &[T; M]) -> T {
    let mut largest = T::constant(0.0);
    for (width, scale) in widths.iter().zip(row_scales) {
        largest = largest.max(*width / *scale);
    }
    largest
}
