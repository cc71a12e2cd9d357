//! Functions that are supplied at run time: tabulated laws, splines, a user's own.

use crate::Scalar;

/// A scalar function with derivatives, of one argument: what a `function` of the text is at run time.
///
/// The data of a function are numbers; only its argument and its values are of the scalar type, so that one function
/// serves `f64`, `f32` and lanes alike.
pub trait Function<T: Scalar> {
    /// Number of continuous derivatives: 2 for a natural cubic spline. A text that needs more does not compile.
    const ORDER: usize;

    /// Value and the first `K` − 1 derivatives at `x`: K, in the function's unit over that of `x` to the power of the
    /// derivative. Asked for with `K <= ORDER + 1` alone.
    fn jet<const K: usize>(&self, x: T) -> [T; K];

    /// The least argument above `x` where a derivative of order `ORDER` + 1 may jump; `None` where none does.
    ///
    /// An integrator that steps to it keeps its order.
    fn breakpoint_after(&self, _x: f64) -> Option<f64> {
        None
    }
}

impl<T: Scalar, F: Function<T>> Function<T> for &F {
    const ORDER: usize = F::ORDER;

    #[inline]
    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        (*self).jet(x)
    }

    fn breakpoint_after(&self, x: f64) -> Option<f64> {
        (*self).breakpoint_after(x)
    }
}
