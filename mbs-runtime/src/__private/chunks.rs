//! Building blocks of emitted code for long mechanisms: parts compiled by themselves, and the values that they pass on.
//!
//! A compiler takes longer for one function of ten thousand operations than for a hundred of a hundred. One copy of a solver
//! for each block takes it as long as the block's share of a small mechanism. So a long mechanism has parts of bounded length,
//! and one loop over all blocks of a kind.

use core::cell::Cell;

use crate::linear_algebra::factorization::Factorization;
use crate::mechanism::block::Block;
use crate::mechanism::function::Function;
use crate::scalar::number::Scalar;

/// A part of a long function. It is never inlined into its caller, whose length would be that of all parts.
#[inline(never)]
pub fn apart<R>(part: impl FnOnce() -> R) -> R {
    part()
}

/// Values that the parts of a solution pass on: V, those of the position stage first.
#[derive(Debug)]
pub struct Passed<T: Copy, const V: usize>(pub [Cell<T>; V]);

impl<T: Scalar, const V: usize> Passed<T, V> {
    /// Before any part.
    #[inline]
    #[must_use]
    pub fn none() -> Self {
        Passed(core::array::from_fn(|_| Cell::new(T::constant(0.0))))
    }

    /// The value in a place, 0 where there is no such place.
    #[inline(always)]
    #[must_use]
    pub fn get(&self, place: usize) -> T {
        self.0.get(place).map_or(T::constant(0.0), Cell::get)
    }

    /// Puts a value in a place, if there is one.
    #[inline(always)]
    pub fn put(&self, place: usize, value: T) {
        if let Some(passed) = self.0.get(place) {
            passed.set(value);
        }
    }

    /// The first P of them.
    #[inline]
    pub fn kept<const P: usize>(&self) -> [T; P] {
        let mut kept = [T::constant(0.0); P];
        kept.iter_mut().zip(&self.0).for_each(|(kept, passed)| *kept = passed.get());
        kept
    }
}

/// An element of an array, 0 where there is none.
#[inline(always)]
#[must_use]
pub fn at<T: Scalar>(values: &[T], place: usize) -> T {
    values.get(place).map_or(T::constant(0.0), |value| *value)
}

/// Value and K − 1 derivatives of a function in an array, 0 where there is none.
#[inline(always)]
#[must_use]
pub fn jet<T: Scalar, F: Function<T>, const K: usize>(functions: &[F], place: usize, x: T) -> [T; K] {
    functions.get(place).map_or([T::constant(0.0); K], |function| function.jet(x))
}

/// Puts a value among others, if it has a place there.
#[inline(always)]
pub fn put<T>(values: &mut [T], place: usize, value: T) {
    if let Some(place) = values.get_mut(place) {
        *place = value;
    }
}

/// K of N values, those from `first` on. N is not 0.
#[inline]
#[must_use]
pub fn part<T: Copy, const N: usize, const K: usize>(values: &[T; N], first: usize) -> [T; K] {
    let mut part = [values[0]; K];
    part.iter_mut().zip(values.iter().skip(first)).for_each(|(part, value)| *part = *value);
    part
}

/// Puts `part` among other values, from `first` on.
#[inline]
pub fn put_part<T: Copy, const N: usize, const K: usize>(values: &mut [T; N], first: usize, part: &[T; K]) {
    values.iter_mut().skip(first).zip(part).for_each(|(value, part)| *value = *part);
}

/// The places that a round of a loop uses.
#[inline(always)]
#[must_use]
pub fn places<const W: usize>(rounds: &[[u32; W]], round: usize) -> [usize; W] {
    rounds.get(round).map_or([usize::MAX; W], |places| places.map(|place| place as usize))
}

/// The numbers that a round of a loop uses.
#[inline(always)]
#[must_use]
pub fn numbers<const W: usize>(rounds: &[[f64; W]], round: usize) -> [f64; W] {
    rounds.get(round).map_or([0.0; W], |numbers| *numbers)
}

/// Numbers of a table as values.
#[inline(never)]
#[must_use]
pub fn constants<T: Scalar, const W: usize>(numbers: &[f64; W]) -> [T; W] {
    let mut values = [T::constant(0.0); W];
    for (value, number) in values.iter_mut().zip(numbers) {
        *value = T::constant(*number);
    }
    values
}

/// The place `first + step·round`.
#[inline(always)]
#[must_use]
pub const fn along(first: usize, step: usize, round: usize) -> usize {
    first.wrapping_add(step.wrapping_mul(round))
}

/// Rows and coordinates of a diagonal block: a [`Block`] without its share of the metric.
#[derive(Clone, Copy, Debug)]
pub struct Place<const K: usize, const M: usize = K> {
    /// Rows of Φ: M.
    pub rows: [u16; M],
    /// Coordinates solved for: K.
    pub coordinates: [u16; K],
    /// `true` for each coordinate that is an angle: K.
    pub angles: [bool; K],
}

/// The share that blocks of a kind have of the metric.
#[derive(Clone, Copy, Debug)]
pub enum Metric<'a, T, const K: usize, const M: usize = K> {
    /// Scales of the rows and of the coordinates of a block, the same in all: quotients by them are computed once.
    Shared([T; M], [T; K]),
    /// Scales of all rows and all coordinates, from which each block takes its own.
    Whole(&'a [T], &'a [T]),
}

impl<const K: usize, const M: usize> Place<K, M> {
    /// The block with its share of the metric.
    #[inline(always)]
    pub fn block<T: Scalar>(&self, metric: &Metric<'_, T, K, M>) -> Block<T, K, M> {
        let one = T::constant(1.0);
        let scale = |scales: &[T], index: u16| scales.get(usize::from(index)).map_or(one, |scale| *scale);
        let (row_scales, coordinate_scales) = match *metric {
            Metric::Shared(rows, coordinates) => (rows, coordinates),
            Metric::Whole(rows, coordinates) => (
                self.rows.map(|row| scale(rows, row)),
                self.coordinates.map(|coordinate| scale(coordinates, coordinate)),
            ),
        };
        Block {
            rows: self.rows,
            coordinates: self.coordinates,
            angles: self.angles,
            row_scales,
            coordinate_scales,
        }
    }

    /// Its coordinates among all of `q`.
    #[inline(always)]
    pub fn of<T: Scalar>(&self, q: &[T]) -> [T; K] {
        self.coordinates.map(|index| q.get(usize::from(index)).map_or(T::constant(0.0), |value| *value))
    }

    /// Puts its coordinates `x` among all of `q`.
    #[inline(always)]
    pub fn put<T: Scalar>(&self, x: &[T; K], q: &mut [T]) {
        for (index, x) in self.coordinates.iter().zip(x) {
            if let Some(coordinate) = q.get_mut(usize::from(*index)) {
                *coordinate = *x;
            }
        }
    }
}

/// Places of the factors of B blocks.
#[inline(always)]
#[must_use]
pub fn unfactorized<T: Scalar, F: Factorization<T, K>, const K: usize, const B: usize>() -> [F; B] {
    let zero = T::constant(0.0);
    [F::factorize(&[[zero; K]; K], &[zero; K], &[zero; K]).0; B]
}

/// Entries at their places, row and column, among zeros.
#[inline]
pub fn scattered<T: Scalar, const N: usize, const M: usize>(
    places: &[(u16, u16)],
    entries: &[T],
) -> [[T; N]; M] {
    let mut rows = [[T::constant(0.0); N]; M];
    for ((row, column), entry) in places.iter().zip(entries) {
        let row = rows.get_mut(usize::from(*row));
        if let Some(place) = row.and_then(|row| row.get_mut(usize::from(*column))) {
            *place = *entry;
        }
    }
    rows
}
