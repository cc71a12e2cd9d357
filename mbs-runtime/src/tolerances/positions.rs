//! Positions: residuals of rows at which one is found, distances, and the numbers that a text or a caller gives.

use crate::tolerances::Law;

/// Rounding errors of a row's own terms that a closed row may hold, over the row's scale.
///
/// A closure row sums some ten terms of at most the reference length, each wrong by an ε or two. So 64 leaves a factor of three, and
/// is still 1.4e-14 of the length in `f64`.
pub(crate) const OF_TERMS: Law = Law::ulps(64.0);

/// Loosest position tolerance τ that a caller may give projections, over the square of the margin μ: the position is off by 2τ/μ at most
/// (Kantorovich), the accelerations by some 6τ/μ² of their size, and six digits of them are right. In `f32` it is no more than
/// rounding.
pub(crate) const LOOSEST: Law = Law::at_least(2.5e-7, 64.0);

/// Rounding errors of a coordinate that a closed row may hold, over the coordinate: half an ε for its own rounding, the same for each
/// sum that it enters.
pub(crate) const OF_COORDINATES: Law = Law::ulps(4.0);

/// Step of a point's coordinates over their scale whose square is within [`OF_TERMS`], that of two of them too: 2 · 25 ε.
pub(crate) const SHORT: Law = Law::root(5.0);

/// A point is stationary where ‖Jᵀr‖² ≤ this times ‖J‖² ‖r‖²: the residual can fall there by no more than √ε of itself.
pub(crate) const STATIONARY: Law = Law::ulps(1e-4);

/// Roundings of its own terms within which the discriminant of a dyad that is below zero counts as zero: the bars are in line.
pub(crate) const IN_LINE: Law = Law::ulps(64.0);

/// Contradiction allowed to redundant rows in addition to rounding, relative to the row's scale: the error of dimensions typed with 15
/// digits. Each is off by 5e-15 of itself at most, and a row has some ten.
pub(crate) const OF_DIMENSIONS: Law = Law::fixed(5e-14);

/// Violation of a row by a start, in the reference metric and of the coordinates (per second for its rate), that is projected out.
/// Also the change of a declared number by it, in its scale, that is none. Numbers are typed with nine digits.
pub(crate) const OF_START: Law = Law::at_least(1e-8, 64.0);

/// Largest residual that remains although nothing lowers it any more, over the row's scale: that of a direction which is too weak to
/// be corrected, 1e-2 of the residual of a step in it. Beyond it the constraints cannot be met. 1e8 tolerances [`OF_TERMS`] in `f64`,
/// 4096 in `f32`, where a step leaves √ε of a reference length in such a direction.
pub(crate) const UNMET: Law = Law::at_least(1e8 * 64.0 * f64::EPSILON, 4096.0 * 64.0);

/// Residual in the metric from which on a state has left the constraints and shows nothing about the mechanism.
pub(crate) const LEFT: Law = Law::fixed(1e-3);

/// Largest residual over its tolerance, and over the cube of the margin μ, that is left in a position as it is.
///
/// A residual of r reference lengths is an error of r/μ in the position. In the acceleration it is 3 to 6 r/μ² on sliders next to the end
/// of their range, and as much r/μ³ on parallelograms of points next to a change point. With [`OF_TERMS`] it is 27 000 ε or 6e-12 at most;
/// above margins of 0.24 no step is looked at twice. Below 0.1 [`FINE`] decides.
pub(crate) const COARSE: Law = Law::fixed(70.0);

/// Margin below which a step may end at one where [`COARSE`] is less than 1: 0.24 over 0.9.
pub(crate) const SEEN: Law = Law::fixed(0.27);

/// Largest residual over its tolerance that is rounding alone: 4 of 64 roundings. A further step does not lower it.
pub(crate) const FINE: Law = Law::fixed(0.0625);

/// Distance from the prediction over the margin from which on a step of a mechanism with lengths is checked: a thousandth of a link of
/// a hundredth, or rounding of the position.
pub(crate) const QUICK_APPROACH: Law = Law::at_least(1e-5, 2e3);

/// Movement of a link over the margin that is ignored in a fast step, of links so short or of coordinates that do not move: rounding
/// to a hundredth where that is more.
pub(crate) const LEAST_MOVEMENT: Law = Law::at_least(1e-5, 1e3);

/// Movement times the margin below which it is rounding to a hundredth.
pub(crate) const ROUNDED_MOVEMENT: Law = Law::ulps(1e3);

/// Part of a way of drivers that no piece is shorter than: beyond it values of the way differ by their rounding alone.
pub(crate) const SHORTEST_PIECE: Law = Law::ulps(64.0);

/// Change of a row over the shortest piece of a way, in the reference metric, from which on it jumps.
pub(crate) const JUMP: Law = Law::root(1.0);

/// Width of the bracket around the reach of a driver over the driver's way.
pub(crate) const OF_REACH: Law = Law::fixed(1e-9);

/// Roundings by which a quantity may pass the bound of its range: those that a closed position may hold, so that a dead centre on the
/// bound is not beyond it.
pub(crate) const OF_BOUND: Law = Law::ulps(64.0);

/// Largest difference of saved values, which went through another number type or a phase's start, from the original ones.
pub(crate) const OF_SAVED: Law = Law::ulps(16.0);

/// Coarsest resolution of a coordinate, relative to its scale, that still is a position: 1e-3 rad. An `f64` angle has it for 7e11
/// turns, an `f32` angle for 1300: an `f32` angle at 3000 rpm is worthless after minutes.
pub(crate) const COARSEST_RESOLUTION: Law = Law::fixed(1e-3);

/// Part of a length that closed rows may leave open before it is reported: six digits are more than most lengths are known to.
pub(crate) const COARSEST_PART: Law = Law::fixed(1e-6);

/// Pivots of the fit of a spline below this part of the largest leave less than half the digits of their unknowns.
pub(crate) const OF_FIT: Law = Law::root(1.0);
