//! Drivers: each derivative against an oracle that shares no code, continuity at the breakpoints, lanes, single precision.

mod checks;
mod convergence;
mod cubic;
mod laws;
mod quintic;
mod segments;
mod series;
mod smoothing;
mod trapezoidal;
