//! Motion from forces: M q̈ + Φ_qᵀ λ = Q with Φ = 0. Forces from motion are in [`inverse()`].
//!
//! # Direct dynamics
//!
//! A text states masses, forces and constraints; the coordinates that move follow from them.
//!
//! ```
//! use mbs_runtime::dynamics::{DormandPrince8, Explicit, Simulation, VelocityTransformation};
//! use mbs_runtime::mechanism;
//!
//! mechanism! {
//!     /// A pendulum that a motor holds up against its weight.
//!     pub mechanism Arm;
//!     param m: kg = 2;
//!     param L: m = 0.5;
//!     input motor: N*m;
//!     coord phi: rad = 0;
//!     coord p: [m; 2] = [0.5, 0];
//!     body load { mass: m, com: p }
//!     gravity weight { acceleration: [0, -9.81] }
//!     torque drive_side: motor on phi;
//!     constraint arm { p == L*unit(phi); }
//!     start phi = 0 rate 0;
//!     out rod: [N; 2] = [-lambda(arm[0]), -lambda(arm[1])];
//! }
//!
//! # fn main() -> Result<(), mbs_runtime::Failure> {
//! let mut arm: Arm = Arm::default();
//! arm.motor = 2.0 * 0.5 * 9.81; // what the weight needs: nothing moves
//! let method = Explicit::new(DormandPrince8, VelocityTransformation);
//! let mut run = Simulation::start_from_text(arm, method, 0.0)?;
//! run.advance_to(1.0)?;
//! assert!(run.q()[0].abs() < 1e-9);
//! run.change(|arm| arm.motor = 0.0); // let go
//! run.advance_to(2.0)?;
//! let (q, balance) = (ArmCoordinates::from(*run.q()), run.balance());
//! assert!(q.phi < -1.0 && balance.defect.abs() < 1e-7 && balance.phi < 1e-12);
//! # Ok(())
//! # }
//! ```
//!
//! [`Simulation`] owns the state: [`step`](Simulation::step) for control loops, [`advance_to`](Simulation::advance_to)
//! with adaptive steps for a tolerance. [`balance`](Simulation::balance) gives the energy balance and the violation of the
//! rows, [`counts`](Simulation::counts) the cost. [`equilibrium()`] finds a position of
//! rest, [`linearize()`] the small motions about a state.
//!
//! # Which method
//!
//! A method is a type: an integrator with a formulation, `Explicit::new(RungeKutta4, Baumgarte::default())`, or an implicit
//! method that is both.
//!
//! | formulation | for | not for |
//! |---|---|---|
//! | [`Projection`] | the default: any rows, redundant ones and singular positions included; blocks of the rows where they determine the motion well, all rows together elsewhere; positions and velocities on the constraints to rounding, those of stages too where rows follow from others on the constraints alone | |
//! | [`VelocityTransformation`] | the same blocks; orthogonal motions where its coordinates turn back, `Projection` where the rows lose rank | redundant rows, where it always goes over |
//! | [`Baumgarte`] | steps of the least fixed cost in a control loop | ω h > 1 (refused), singular positions |
//! | [`Unstabilized`] | short runs, and to see the drift | long ones |
//! | [`Penalty`] | to see what a penalty is | results |
//!
//! | integrator | order | for |
//! |---|---|---|
//! | [`DormandPrince8`] | 8(5,3), adaptive | errors of 1e-7 and less |
//! | [`DormandPrince5`] | 5(4), adaptive | errors of 1e-3 to 1e-7 |
//! | [`Radau5`] | 5(3), implicit, adaptive | stiff forces, smoothed friction, first-order states with short time constants |
//! | [`RungeKutta4`] | 4, fixed steps | control loops, comparison |
//! | [`SemiImplicitEuler`] | 1, fixed steps | the cheapest step |
//! | [`AugmentedLagrangian`] | 2, implicit, fixed steps | stiff forces, redundant rows |
//! | [`Extrapolated`] | 3, implicit, fixed steps | the same, where forces damp what the step does not show |
//! | [`GeneralizedAlpha`] | 2, implicit, fixed steps | stiff vibrations, damped numerically |
//! | [`MoreauJean`] | 1, fixed steps over impacts | many rigid contacts, chatter, friction that sticks |

pub(crate) mod analyses;
pub(crate) mod equilibrium;
pub(crate) mod first_order_form;
pub(crate) mod formulations;
pub(crate) mod implicit;
pub(crate) mod integrators;
pub(crate) mod linear_systems;
pub(crate) mod model;
pub(crate) mod simulation;
pub(crate) mod time_stepping;

pub use crate::mechanism::enclosure::WithIntervals;
pub use crate::mechanism::event::{Condition, Event};
pub use crate::mechanism::normal_forces::{NormalForces, Term, WithNormalForces};
pub use crate::mechanism::set_valued::{OnContact, SetValuedMode, SetValuedRow, WithSetValuedRows};
pub use crate::mechanism::transformed::Transformed;
pub use analyses::determinacy::Determinacy;
pub use analyses::inverse::{Driven, inverse, inverse_with_states};
pub use analyses::linearization::{
    Linearization, WithStates, linearize, linearize_in, linearize_with_states,
};
pub use equilibrium::consistent_start::{MovedStart, closed};
pub use equilibrium::states::states_at_rest;
pub use equilibrium::{
    Equilibrium, WithModes, equilibrium, equilibrium_with_modes, equilibrium_with_states, undetermined_states,
};
pub use first_order_form::equations::Equations;
pub use first_order_form::explicit::Explicit;
pub use first_order_form::phases::Phased;
pub use first_order_form::radau::Radau5;
pub use formulations::baumgarte::Baumgarte;
pub use formulations::penalty::Penalty;
pub use formulations::projection::{ProjectedStages, Projection};
pub use formulations::singular::passage::Passage;
pub use formulations::unstabilized::Unstabilized;
pub use formulations::velocity_transformation::VelocityTransformation;
pub use implicit::augmented_lagrangian::AugmentedLagrangian;
pub use implicit::extrapolated::Extrapolated;
pub use implicit::generalized_alpha::GeneralizedAlpha;
pub use integrators::dormand_prince5::DormandPrince5;
pub use integrators::dormand_prince8::DormandPrince8;
pub use integrators::either::Either;
pub use integrators::embedded::{Embedded, StepControl};
pub use integrators::equation::{Equation, ErrorNorm};
pub use integrators::event::monitor::{Monitor, Stopped};
pub use integrators::event::{Dense, Direction, Scrutiny};
pub use integrators::fixed_step::{FixedStep, RungeKutta4, SemiImplicitEuler};
pub use integrators::step_control::{Adaptive, Point};
pub use integrators::vector::{IntegratorState, Vector};
pub use linear_systems::kkt::System;
pub use model::instant::Instant;
pub use model::method::{Method, SteppedInModes};
pub use model::metric::{Metric, Tolerance};
pub use model::{Counts, Formulation, MethodWarning, Model, Solved};
pub use simulation::Simulation;
pub use simulation::accuracy::{Accurate, ErrorEstimate, Estimated};
pub use simulation::continued::Continued;
pub use simulation::reading::Balance;
pub use simulation::sleep::Simulations;
pub use time_stepping::moreau_jean::MoreauJean;
