//! Periodic quintic splines of a size that is known to the compiler.

use crate::driver::error::FitError;
use crate::driver::quintic_fit::{QuinticRow, fit_periodic_quintic};
use crate::driver::table::Table;
use crate::mechanism::function::Function;
use crate::scalar::interval::Interval;
use crate::scalar::number::Scalar;

/// A periodic quintic spline with `P` knots, four times continuously differentiable: a measured cam.
///
/// Through points of a smooth function the error of the spline falls with the sixth power of the distance between knots.
/// That of its derivative of order k falls with the power 6 − k. With fewer knots than points it smooths them: rounding
/// and noise grow with the square of the knots' density in the second derivative.
/// Source: de Boor 2001, A Practical Guide to Splines, ch. IX, XIV.
///
/// ```
/// use core::{array::from_fn, f64::consts::TAU};
/// use mbs_runtime::driver::PeriodicQuintic;
///
/// let x: [f64; 36] = from_fn(|point| TAU * point as f64 / 36.0);
/// let spline = PeriodicQuintic::interpolate(&x, TAU, &x.map(f64::sin))?;
/// let [value, slope, curvature, third] = spline.derivatives(100.0_f64);
/// assert!((value - 100_f64.sin()).abs() < 1e-7 && (slope - 100_f64.cos()).abs() < 1e-6);
/// assert!((curvature + 100_f64.sin()).abs() < 1e-5 && (third + 100_f64.cos()).abs() < 1e-3);
/// # Ok::<(), mbs_runtime::driver::FitError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeriodicQuintic<const P: usize> {
    knots: [f64; P],
    pieces: [[f64; 6]; P],
    period: f64,
    rate: f64,
}

impl<const P: usize> PeriodicQuintic<P> {
    /// The numbers of a table, as [`Table::periodic`] takes them: the form for constants.
    pub const fn from_pieces(knots: [f64; P], period: f64, pieces: [[f64; 6]; P]) -> Self {
        let rate = Table::<6>::periodic(&knots, &[], period).rate;
        PeriodicQuintic { knots, pieces, period, rate }
    }

    /// Through points within one period; the first one is not repeated at its end.
    ///
    /// # Errors
    /// [`FitError`], with the point.
    pub fn interpolate(x: &[f64; P], period: f64, y: &[f64; P]) -> Result<Self, FitError> {
        Self::least_squares(x, period, x, y)
    }

    /// Along points that are as many as the knots or more, over any number of periods, with the least sum of squares.
    ///
    /// Takes 144 bytes of stack a knot in addition to the result.
    ///
    /// # Errors
    /// [`FitError`], with the point or the knot.
    pub fn least_squares(knots: &[f64; P], period: f64, x: &[f64], y: &[f64]) -> Result<Self, FitError> {
        let mut rows = [QuinticRow::EMPTY; P];
        let mut pieces = [[0.0; 6]; P];
        fit_periodic_quintic(knots, period, x, y, &mut rows, &mut pieces)?;
        Ok(Self::from_pieces(*knots, period, pieces))
    }

    /// The spline as a table.
    #[inline]
    pub const fn table(&self) -> Table<'_, 6> {
        Table { knots: &self.knots, pieces: &self.pieces, period: Some(self.period), rate: self.rate }
    }

    /// Value and three derivatives at `x`.
    #[inline]
    pub fn derivatives<T: Scalar>(&self, x: T) -> [T; 4] {
        self.jet(x)
    }
}

impl<T: Scalar, const P: usize> Function<T> for PeriodicQuintic<P> {
    const ORDER: usize = 4;

    #[inline]
    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        self.table().jet(x)
    }

    fn breakpoint_after(&self, x: f64) -> Option<f64> {
        Function::<T>::breakpoint_after(&self.table(), x)
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        Function::<T>::enclosure(&self.table(), from, to)
    }
}
