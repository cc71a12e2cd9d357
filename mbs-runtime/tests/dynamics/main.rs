//! Motion from forces, on mechanisms whose answers are known.

mod analyses;
mod balance;
mod determinacy;
mod failures;
mod first_order;
mod integral_control;
mod integrators;
mod linkage;
mod methods;
mod pendulum;
mod position_tolerance;
mod prescribed;
mod singular;
mod terms;
mod variations;
