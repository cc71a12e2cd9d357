//! Integration in time: errors of steps, events, and the resolution of times.

use crate::tolerances::Law;

/// Smallest sum of the relative and the absolute tolerance of an integration: the twelve stages that a step and its error are summed
/// of leave as many roundings.
pub(crate) const LEAST: Law = Law::ulps(LEAST_ROUNDINGS);

const LEAST_ROUNDINGS: f64 = 32.0;

/// Tolerance of an adaptive integration where none is given.
pub(crate) const DEFAULT: Law = Law::at_least(1e-9, LEAST_ROUNDINGS);

/// Tolerance of the iteration of Radau5 in steps of fixed size, in the metric.
pub(crate) const OF_FIXED_STEPS: Law = Law::at_least(1e-10, LEAST_ROUNDINGS);

/// Tolerances of the parts of a step next to a singular position, one after the other until one of them leads through: the error of a
/// step of 1e-3 of a period, and the effect of rounding of the rows in any set of coordinates.
pub(crate) const OF_PARTS: [Law; 2] =
    [Law::at_least(1e-10, LEAST_ROUNDINGS), Law::at_least(1e-9, LEAST_ROUNDINGS)];

/// Least part of the tolerance that the iteration of Radau5 can be asked for, times the tolerance.
pub(crate) const OF_STAGES: Law = Law::ulps(10.0);

/// Largest energy defect over a step, over the energy that is moved: 1.7e-4 in single precision. Runs in bar angles that end right
/// leave less; with 16 in place of ½ runs in natural coordinates end 0.03 m off.
pub(crate) const UNEXPLAINED: Law = Law::root(0.5);

/// Speed (1/s, in the metric) below which no rate counts as changed, and which rates of rows are measured by at rest: that of a scale
/// in 1000 seconds.
pub(crate) const AT_REST: Law = Law::fixed(1e-3);

/// Smallest step over the time: below it t + c h no longer tells stages apart.
pub(crate) const LEAST_STEP: Law = Law::ulps(16.0);

/// Smallest part of a search for an event over the time.
pub(crate) const LEAST_PART: Law = Law::ulps(4.0);

/// Error over a time that is computed from a gap, its rate and its bound.
pub(crate) const OF_REACH: Law = Law::ulps(16.0);

/// Part of the largest value within a step up to which a value of an event function is none: roundings of some operations.
pub(crate) const NO_VALUE: Law = Law::ulps(64.0);

/// Gap over the size of its terms at the end of a step that was located there: roundings of the gap, of the time and of the polynomial of a
/// step.
pub(crate) const LOCATED: Law = Law::ulps(16.0);

/// The same for nine values of which the polynomial tells nothing more: its coefficients add up 560 roundings.
pub(crate) const BLURRED: Law = Law::ulps(2048.0);

/// Part of the largest value by which an event function may change where a state is solved anew.
pub(crate) const SOLVED_ANEW: Law = Law::ulps(1024.0);

/// Estimated errors of the steps so far, over the tolerance of one, that may count as touching a limit. The sum grows with the number of
/// steps, also where a motion has forgotten the first ones. Oscillators pass the place that they were let go at by two at most, in 1000 s
/// at tolerances from 1e-3 to 1e-8.
pub(crate) const TOUCHED: Law = Law::fixed(16.0);

/// Part of a coordinate that its enclosure may be wide by: roundings of its coefficients, sixteen of which are in a rate, and a lever
/// of the function that is not one.
pub(crate) const OF_ENCLOSURE: Law = Law::ulps(131_072.0);

/// Time (s) between changes of events, of the run's time or of 1 s where that is more, and motion between them in reference lengths, below
/// which they follow each other without end: what two located times that differ by rounding show.
pub(crate) const NEXT_EVENT: Law = Law::root(1.0);
