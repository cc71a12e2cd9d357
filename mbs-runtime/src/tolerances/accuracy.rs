//! Errors of whole runs: estimates by runs of other tolerances.

use crate::tolerances::Law;

/// Least error that can be asked for: the roundings of a short run.
pub(crate) const LEAST: Law = Law::ulps(100.0);

/// Ratio of the tolerances of runs that are compared.
pub(crate) const RATIO: f64 = 10.0;

/// The finest tolerance of a run beside another, in the least one: its product with rounded numbers must not fall below that.
pub(crate) const ABOVE_LEAST: f64 = 1.01;

/// First difference over the wanted error up to which a coarser run is tried: the error itself is left where differences fall by
/// [`TRUSTED`].
pub(crate) const EASY: f64 = TRUSTED - 1.0;

/// First difference over the wanted error above which the first three runs do not count: that they seem to reach it is chance.
pub(crate) const HARD: f64 = 300.0;

/// Least and largest ratio of the differences of three runs that an estimate is trusted for: errors fall, and not by chance alone. Of 1640
/// runs from 21 mechanisms with the pairs of order 5 and 8 nine in ten fall so, and their estimates are 0.35 to 21 times the error.
pub(crate) const FALLS: [f64; 2] = [2.0, 100.0];

/// Least and largest ratio of the differences of three runs to a wanted error: less is no order of a method, more is chance.
pub(crate) const FALLS_TO_ERROR: [f64; 2] = [3.0, 1000.0];

/// Largest ratio of the differences that the next one is expected to have: runs of double pendulums fall by 100 once and by 4 then. Up to 4
/// one error of 2783 runs was twice the wanted one, up to 6 five were.
pub(crate) const TRUSTED: f64 = 4.0;

/// Ratio of the differences above which the next one counts as the least: forces that steps begin to resolve.
pub(crate) const STEEP: f64 = 15.0;

/// Least ratio of the steps of runs whose difference tells an error.
pub(crate) const FINER: f64 = 1.1;

/// Largest error that can be asked for, and that an estimate is trusted for: above it nothing is small.
pub(crate) const COARSEST: f64 = 0.1;

/// Coarsest tolerance of steps: what is coarser says nothing of the error.
pub(crate) const COARSEST_STEPS: f64 = 1e-2;

/// Differences below so many least tolerances are rounding where they no longer fall.
pub(crate) const NOISE: f64 = 1e3;
