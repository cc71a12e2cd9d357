//! Least squares with banded rows: one rotation after the other, never the normal equations.

use crate::driver::error::FitError;
use crate::tolerances::positions;

/// A row of a fit's triangular factor: `W` entries from the diagonal on, `E` entries in the last columns.
///
/// Room for a fit, one row a knot. Its content afterwards is of no use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<const W: usize, const E: usize> {
    pub(super) band: [f64; W],
    pub(super) tail: [f64; E],
    pub(super) right: f64,
}

impl<const W: usize, const E: usize> Row<W, E> {
    /// A row of zeros.
    pub const EMPTY: Self = Row { band: [0.0; W], tail: [0.0; E], right: 0.0 };

    /// The entry on the diagonal; `banded` rows precede those with a tail alone.
    fn pivot(&self, index: usize, banded: usize) -> f64 {
        match index.checked_sub(banded) {
            None => first(&self.band),
            Some(place) => self.tail.get(place).copied().unwrap_or(0.0),
        }
    }

    /// Takes the pivots `upper` and `lower` to (r, 0).
    #[inline]
    fn rotate(&mut self, lower: &mut Self, pivots: [f64; 2]) {
        let radius = libm::hypot(pivots[0], pivots[1]);
        let (cosine, sine) = (pivots[0] / radius, pivots[1] / radius);
        let upper = self.band.iter_mut().chain(&mut self.tail).chain([&mut self.right]);
        let lower = lower.band.iter_mut().chain(&mut lower.tail).chain([&mut lower.right]);
        for (upper, lower) in upper.zip(lower) {
            (*upper, *lower) = (cosine * *upper + sine * *lower, cosine * *lower - sine * *upper);
        }
    }
}

/// The triangular factor of a least-squares problem of as many unknowns as rows; the last `E` rows have a tail alone.
///
/// Source: Golub & Van Loan 2013, §5.1.8 (rotations); Dierckx 1993, Curve and Surface Fitting with Splines, §4.1 (bands
/// and their periodic corner).
pub(super) struct Triangle<'a, const W: usize, const E: usize>(&'a mut [Row<W, E>]);

impl<'a, const W: usize, const E: usize> Triangle<'a, W, E> {
    pub fn new(rows: &'a mut [Row<W, E>]) -> Self {
        rows.fill(Row::EMPTY);
        Triangle(rows)
    }

    /// Number of unknowns ahead of the tail.
    fn banded(&self) -> usize {
        self.0.len().saturating_sub(E)
    }

    /// Adds an equation whose band begins at the unknown `start`.
    pub fn add(&mut self, start: usize, mut row: Row<W, E>) {
        let banded = self.banded();
        for upper in self.0.iter_mut().take(banded).skip(start) {
            if row.band.iter().all(|entry| *entry == 0.0) {
                break;
            }
            let pivots = [first(&upper.band), first(&row.band)];
            if pivots[1] != 0.0 {
                upper.rotate(&mut row, pivots);
            }
            row.band.rotate_left(1);
            if let Some(last) = row.band.last_mut() {
                *last = 0.0;
            }
        }
        row.band = [0.0; W];
        for (place, upper) in self.0.iter_mut().skip(banded).enumerate() {
            let pivot = |row: &Row<W, E>| row.tail.get(place).copied().unwrap_or(0.0);
            let pivots = [pivot(upper), pivot(&row)];
            if pivots[1] != 0.0 {
                upper.rotate(&mut row, pivots);
            }
        }
    }

    /// Leaves each unknown in the `right` of its row.
    ///
    /// # Errors
    /// [`FitError::Undetermined`] with the unknown's index.
    pub fn solve(self) -> Result<(), FitError> {
        let banded = self.banded();
        let pivots = || self.0.iter().enumerate().map(|(index, row)| row.pivot(index, banded));
        let largest = pivots().fold(0.0, |largest: f64, pivot| largest.max(pivot.abs()));
        let weak = |pivot: f64| !pivot.is_finite() || pivot.abs() <= positions::OF_FIT.of::<f64>() * largest;
        if let Some(knot) = pivots().position(weak) {
            return Err(FitError::Undetermined { knot });
        }
        let mut last = [0.0; E];
        for index in (0..self.0.len()).rev() {
            let Some((above, below)) = self.0.split_at_mut_checked(index + 1) else { continue };
            let Some(row) = above.last_mut() else { continue };
            // In the last rows the band is empty, and what is not yet known in the tail counts as 0.
            let beside = row.band.iter().skip(1).zip(below).map(|(entry, below)| entry * below.right);
            let behind = row.tail.iter().zip(&last).map(|(entry, value)| entry * value);
            row.right = (row.right - beside.sum::<f64>() - behind.sum::<f64>()) / row.pivot(index, banded);
            if let Some(value) = index.checked_sub(banded).and_then(|place| last.get_mut(place)) {
                *value = row.right;
            }
        }
        Ok(())
    }
}

fn first<const W: usize>(band: &[f64; W]) -> f64 {
    band.first().copied().unwrap_or(0.0)
}
