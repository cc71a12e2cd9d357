//! Drivers: each derivative against an oracle that shares no code, continuity at the breakpoints, lanes, single precision.

mod checks;
mod laws;
mod segments;
mod series;
mod trapezoidal;
