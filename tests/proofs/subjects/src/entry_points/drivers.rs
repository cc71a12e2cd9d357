//! Motion laws and splines.

use mbs_runtime::driver::{
    CubicSpline, End, FitError, Foot, FootError, Law, LawError, PeriodicQuintic, ReachError, Rise, Segment,
    Segments, Trapezoidal, nearest_foot, reach,
};
use mbs_runtime::{Function, Interval, Real, Scalar};

entry_points! {
    /// Value and derivatives of a driver.
    fn jet[F: Function<T>, T: Scalar, const K: usize](function: &F, x: T) -> [T; K] {
        function.jet(x)
    }
    /// Next breakpoint of a driver.
    fn breakpoint_after[F: Function<T>, T: Scalar](function: &F, x: f64) -> Option<f64> {
        function.breakpoint_after(x)
    }
    /// Bounds of value and derivatives of a driver.
    fn enclosure[F: Function<T>, T: Scalar, const K: usize](function: &F, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        function.enclosure(from, to)
    }
    /// Reach of a polar curve.
    fn curve_reach[R: Real, F: Function<R>](radius: &F) -> Result<[R; 2], ReachError> {
        reach(radius)
    }
    /// Nearest point of a polar curve.
    fn foot[R: Real, F: Function<R>](radius: &F, point: [R; 2]) -> Result<Foot<R>, FootError<R>> {
        nearest_foot(radius, point)
    }
    /// A motion law between dwells.
    fn rise[L: Law](start: f64, duration: f64, from: f64, to: f64) -> Result<Rise<L>, LawError> {
        Rise::new(start, duration, from, to)
    }
    /// A periodic cam law.
    fn segments[L: Law, const S: usize](start: f64, segments: [Segment; S]) -> Result<Segments<L, S>, LawError> {
        Segments::new(start, segments)
    }
    /// Motion within limits.
    fn trapezoidal[](distance: f64, speed: f64, acceleration: f64) -> Result<Trapezoidal, LawError> {
        Trapezoidal::new(distance, speed, acceleration)
    }
    /// A cubic fit.
    fn cubic_spline[const P: usize](
        knots: &[f64; P], ends: [End; 2], x: &[f64], y: &[f64],
    ) -> Result<CubicSpline<P>, FitError> {
        CubicSpline::least_squares(knots, ends, x, y)
    }
    /// A periodic fit.
    fn periodic_quintic[const P: usize](
        knots: &[f64; P], period: f64, x: &[f64], y: &[f64],
    ) -> Result<PeriodicQuintic<P>, FitError> {
        PeriodicQuintic::least_squares(knots, period, x, y)
    }
}
