//! Cubic splines of a size that is known to the compiler.

use crate::driver::cubic_fit::{CubicRow, End, fit_cubic};
use crate::driver::error::FitError;
use crate::driver::table::Table;
use crate::mechanism::function::Function;
use crate::scalar::interval::Interval;
use crate::scalar::number::Scalar;

/// A cubic spline with `P` knots, twice continuously differentiable everywhere.
///
/// Beyond its ends it goes on with value, slope and curvature: a straight line where the end is natural, a parabola
/// elsewhere. Through points of a smooth function the error of a clamped spline falls with the fourth power of the
/// distance between knots. That of its derivative of order k falls with the power 4 − k, near a natural end only
/// with the power 2 − k.
/// Source: de Boor 2001, A Practical Guide to Splines, ch. IV, V, XIV.
///
/// ```
/// use mbs_runtime::{Function, driver::CubicSpline};
///
/// let x = [0.0, 1.0, 2.0, 4.0];
/// let spline = CubicSpline::clamped(&x, &x.map(|x| x * x * x), [0.0, 48.0])?;
/// let [value, slope, curvature, third] = spline.derivatives(3.0_f64);
/// assert!((value - 27.0).abs() < 1e-13 && (slope - 27.0).abs() < 1e-13);
/// assert!((curvature - 18.0).abs() < 1e-12 && (third - 6.0).abs() < 1e-12);
/// # Ok::<(), mbs_runtime::driver::FitError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubicSpline<const P: usize> {
    knots: [f64; P],
    pieces: [[f64; 4]; P],
    rate: f64,
}

impl<const P: usize> CubicSpline<P> {
    /// The numbers of a table, as [`Table::open`] takes them: the form for constants.
    pub const fn from_pieces(knots: [f64; P], pieces: [[f64; 4]; P]) -> Self {
        let rate = Table::<4>::open(&knots, &[]).rate;
        CubicSpline { knots, pieces, rate }
    }

    /// Through the points, with second derivative 0 at both ends.
    ///
    /// # Errors
    /// [`FitError`], with the point.
    pub fn natural(x: &[f64; P], y: &[f64; P]) -> Result<Self, FitError> {
        Self::least_squares(x, [End::Natural; 2], x, y)
    }

    /// Through the points, with these slopes at the ends.
    ///
    /// # Errors
    /// [`FitError`], with the point.
    pub fn clamped(x: &[f64; P], y: &[f64; P], slopes: [f64; 2]) -> Result<Self, FitError> {
        Self::least_squares(x, slopes.map(End::Slope), x, y)
    }

    /// Along points that are as many as the knots or more, with the least sum of squares.
    ///
    /// Takes 80 bytes of stack a knot in addition to the result.
    ///
    /// # Errors
    /// [`FitError`], with the point or the knot.
    pub fn least_squares(knots: &[f64; P], ends: [End; 2], x: &[f64], y: &[f64]) -> Result<Self, FitError> {
        let mut rows = [CubicRow::EMPTY; P];
        let mut pieces = [[0.0; 4]; P];
        fit_cubic(knots, ends, x, y, &mut rows, &mut pieces)?;
        Ok(Self::from_pieces(*knots, pieces))
    }

    /// The spline as a table.
    #[inline]
    pub const fn table(&self) -> Table<'_, 4> {
        Table { knots: &self.knots, pieces: &self.pieces, period: None, rate: self.rate }
    }

    /// Value and three derivatives at `x`; the third one is constant from knot to knot, and 0 beyond the ends.
    #[inline]
    pub fn derivatives<T: Scalar>(&self, x: T) -> [T; 4] {
        self.jet(x)
    }
}

impl<T: Scalar, const P: usize> Function<T> for CubicSpline<P> {
    const ORDER: usize = 2;

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
