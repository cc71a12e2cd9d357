//! Cases in which positions and rates are hard to get: each is named for what happens in the mechanism.

mod assemblies;
mod scales;
mod speed;
mod turns;
mod units;
