//! Parts of vectors and matrices, for any index: no access needs a check that may panic.
//!
//! An index that the compiler sees to be in range costs nothing. No optimisation has to see it, as it would for `x[k]`.

use crate::scalar::number::Scalar;

/// The components from `first` on; none from the end on.
#[inline(always)]
pub(crate) fn tail<X>(x: &[X], first: usize) -> &[X] {
    x.get(first..).unwrap_or_default()
}

/// As [`tail`], to be changed.
#[inline(always)]
pub(crate) fn tail_mut<X>(x: &mut [X], first: usize) -> &mut [X] {
    x.get_mut(first..).unwrap_or_default()
}

/// The component at `index`. Callers count within the length; beyond it the number would be NaN, which every check refuses.
#[inline(always)]
pub(crate) fn at<T: Scalar>(x: &[T], index: usize) -> T {
    x.get(index).copied().unwrap_or(T::constant(f64::NAN))
}

/// As [`at`], with 0 left in its place.
#[inline(always)]
pub(crate) fn taken<T: Scalar>(x: &mut [T], index: usize) -> T {
    let nothing = T::constant(f64::NAN);
    x.get_mut(index).map_or(nothing, |component| core::mem::replace(component, T::constant(0.0)))
}

/// The entries on the diagonal.
#[inline(always)]
pub(crate) fn diagonal<T, const K: usize>(matrix: &[[T; K]; K]) -> impl Iterator<Item = &T> {
    matrix.iter().enumerate().filter_map(|(k, row)| row.get(k))
}

/// As [`diagonal`], to be changed.
#[inline(always)]
pub(crate) fn diagonal_mut<T, const K: usize>(matrix: &mut [[T; K]; K]) -> impl Iterator<Item = &mut T> {
    matrix.iter_mut().enumerate().filter_map(|(k, row)| row.get_mut(k))
}

/// The identity, K rows of K.
#[inline(always)]
pub(crate) fn identity<T: Scalar, const K: usize>() -> [[T; K]; K] {
    let mut identity = [[T::constant(0.0); K]; K];
    diagonal_mut(&mut identity).for_each(|entry| *entry = T::constant(1.0));
    identity
}

/// The columns of `rows` (M rows of K): K of M.
#[inline(always)]
pub(crate) fn transposed<T: Scalar, const M: usize, const K: usize>(rows: &[[T; K]; M]) -> [[T; M]; K] {
    let mut columns = [[T::constant(0.0); M]; K];
    for (j, column) in columns.iter_mut().enumerate() {
        column.iter_mut().zip(rows).for_each(|(entry, row)| *entry = at(row, j));
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_end_where_the_vector_does() {
        let mut x = [1.0_f64, 2.0, 3.0];
        assert_eq!((tail(&x, 1), tail(&x, 3), tail(&x, 4)), (&[2.0, 3.0][..], &[][..], &[][..]));
        assert_eq!(tail_mut(&mut x, 2), [3.0]);
        assert!(tail_mut(&mut x, 4).is_empty());
        assert!(at(&x, 2) == 3.0 && at(&x, 3).is_nan());
        assert!(taken(&mut x, 1) == 2.0 && taken(&mut x, 3).is_nan());
        assert_eq!(x, [1.0, 0.0, 3.0]);
    }

    #[test]
    fn rows_become_columns_and_the_identity_stays() {
        assert_eq!(transposed(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]), [[1.0, 4.0], [2.0, 5.0], [3.0, 6.0]]);
        assert_eq!(identity::<f64, 2>(), [[1.0, 0.0], [0.0, 1.0]]);
        assert!(diagonal(&[[1.0, 2.0], [3.0, 4.0]]).eq(&[1.0, 4.0]));
    }
}
