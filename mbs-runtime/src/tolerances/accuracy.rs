//! Errors of whole runs: estimates by runs of other tolerances.

use crate::tolerances::Law;

/// Least error that can be asked for: the roundings of a short run.
pub(crate) const LEAST: Law = Law::ulps(100.0);

/// Ratio of the tolerances of runs that are compared.
pub(crate) const RATIO: f64 = 10.0;

/// Least ratio of the differences of three runs: less is no order of a method.
pub(crate) const FALL: f64 = 3.0;

/// Largest ratio of the differences that the next one is expected to have: runs of double pendulums fall by 100 once and by 4 then.
pub(crate) const TRUSTED: f64 = 4.0;

/// Least and largest ratio of the differences of three runs that an estimate is trusted for: errors fall, and not by chance alone.
pub(crate) const FALLS: [f64; 2] = [2.0, 100.0];

/// Largest share of rejected steps, in the accepted ones, of a run whose differences tell an error. Kinks and short forces reject more,
/// and a coarse run may miss them. Of 480 runs with the pairs of order 5 and 8 estimates are 0.5 to 25 times the error up to it, and up to
/// 80 times beyond 0.4.
pub(crate) const REJECTED: f64 = 0.35;

/// Least ratio of the steps of runs whose difference tells an error.
pub(crate) const FINER: f64 = 1.1;

/// Largest error that can be asked for: above it nothing is small.
pub(crate) const COARSEST: f64 = 0.1;

/// Coarsest tolerance of steps: what is coarser says nothing of the error.
pub(crate) const COARSEST_STEPS: f64 = 1e-2;

/// Differences below so many least tolerances are rounding where they no longer fall.
pub(crate) const NOISE: f64 = 1e3;
