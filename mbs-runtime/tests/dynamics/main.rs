//! Motion from forces, on mechanisms whose answers are known.

mod failures;
mod integrators;
mod linkage;
mod pendulum;
mod singular;
