//! Norms, differences and products of vectors in the reference metric.

use crate::scalar::number::{Real, Scalar};

/// Largest difference of two positions in the reference metric (rad, or reference lengths).
#[inline(always)]
pub(crate) fn largest_difference<R: Real, const N: usize>(new: &[R; N], old: &[R; N], scales: &[R; N]) -> R {
    let mut parts = *new;
    for ((part, old), scale) in parts.iter_mut().zip(old).zip(scales) {
        // The reciprocal of a constant is one.
        *part = (*part - *old) * (R::constant(1.0) / *scale);
    }
    largest(&parts)
}

/// Arrays whose components are all changed alike.
pub(crate) trait Each<T: Scalar> {
    /// Every component by `change`, in their order. A loop: `map` of arrays is five times the code for the compiler, for it provides for
    /// panics midway.
    fn each(self, change: impl FnMut(T) -> T) -> Self;
}

impl<T: Scalar, const K: usize> Each<T> for [T; K] {
    #[inline(always)]
    fn each(mut self, mut change: impl FnMut(T) -> T) -> Self {
        for component in &mut self {
            *component = change(*component);
        }
        self
    }
}

/// The number of each item, in their order. A loop, as [`Each::each`].
#[inline(always)]
pub(crate) fn of_each<X, T: Scalar, const K: usize>(
    items: &[X; K],
    mut number: impl FnMut(&X) -> T,
) -> [T; K] {
    let mut numbers = [T::constant(0.0); K];
    for (place, item) in numbers.iter_mut().zip(items) {
        *place = number(item);
    }
    numbers
}

/// Component by component `yes` where the mask is true, `no` elsewhere.
#[inline(always)]
pub(crate) fn select<T: Scalar, const K: usize>(mask: T::Mask, yes: &[T; K], no: &[T; K]) -> [T; K] {
    let mut chosen = *no;
    for (component, yes) in chosen.iter_mut().zip(yes) {
        *component = T::select(mask, *yes, *component);
    }
    chosen
}

/// Largest coordinate in the reference metric: maxⱼ |qⱼ|/sⱼ.
#[inline]
pub fn extent<T: Scalar, const N: usize>(q: &[T; N], coordinate_scales: &[T; N]) -> T {
    let mut parts = *q;
    for (part, scale) in parts.iter_mut().zip(coordinate_scales) {
        // The reciprocal of a constant is one.
        *part = *part * (T::constant(1.0) / *scale);
    }
    largest(&parts)
}

/// Largest absolute value, in four parts that need not wait for each other.
#[inline(always)]
pub(crate) fn largest<T: Scalar, const N: usize>(values: &[T; N]) -> T {
    let mut parts = [T::constant(0.0); 4];
    for values in values.chunks(4) {
        for (part, value) in parts.iter_mut().zip(values) {
            *part = part.max(value.abs());
        }
    }
    let [a, b, c, d] = parts;
    a.max(b).max(c.max(d))
}

/// Reciprocals of scales.
#[inline(always)]
pub(crate) fn weights<T: Scalar, const N: usize>(scales: &[T; N]) -> [T; N] {
    let mut weights = *scales;
    for weight in &mut weights {
        *weight = T::constant(1.0) / *weight;
    }
    weights
}

/// Scalar product, summed from 0 in the order of the components.
pub(crate) fn dot<T: Scalar, const N: usize>(a: &[T; N], b: &[T; N]) -> T {
    a.iter().zip(b).fold(T::constant(0.0), |sum, (a, b)| sum + *a * *b)
}

/// `matrix` (M rows of N) times `x`: M, each component a [`dot`].
pub(crate) fn times<T: Scalar, const N: usize, const M: usize>(matrix: &[[T; N]; M], x: &[T; N]) -> [T; M] {
    of_each(matrix, |row| dot(row, x))
}
