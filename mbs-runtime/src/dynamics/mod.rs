//! Motion from forces: M q̈ + Φ_qᵀ λ = Q with Φ = 0. Forces from motion are in [`mod@inverse`].
//!
//! # Direct dynamics
//!
//! A text says what has mass, what pulls and what holds; which coordinates move follows from that.
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
//! with the steps that a tolerance asks for, [`balance`](Simulation::balance) for what went into the energy and how
//! far the rows are violated, [`counts`](Simulation::counts) for what it cost. [`equilibrium()`] finds a position of
//! rest, [`linearize()`] the small motions about a state.
//!
//! # Which method
//!
//! A method is a type: an integrator with a formulation, `Explicit::new(RungeKutta4, Baumgarte::default())`, or an implicit
//! method that is both.
//!
//! | formulation | for | not for |
//! |---|---|---|
//! | [`Projection`] | the default: any rows, redundant ones and singular positions included; positions and velocities on the constraints to rounding, those of stages too where rows follow from others on the constraints alone | the last microsecond |
//! | [`VelocityTransformation`] | the fast one: no matrix of multipliers, work in proportion to the coordinates; chooses other motions where its coordinates turn back, goes over to `Projection` where the rows lose rank, and counts both | redundant rows, where it always goes over |
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
//! | [`GeneralizedAlpha`] | 2, implicit, fixed steps | stiff vibrations that shall die out |

pub mod adaptive;
pub mod augmented_lagrangian;
pub mod baumgarte;
mod blocks;
mod contact;
mod contradiction;
mod crossing;
pub mod determinacy;
pub mod dormand_prince5;
pub mod dormand_prince8;
pub mod embedded;
pub mod equation;
pub mod equilibrium;
pub mod event;
pub mod explicit;
pub mod extrapolated;
mod free_play;
mod free_stiffness;
pub mod friction;
pub mod generalized_alpha;
mod implicit;
mod integrals;
pub mod inverse;
pub mod kkt;
mod limit_rows;
pub mod linearization;
pub mod metric;
pub mod model;
pub mod motion;
pub mod multipliers;
mod null_space;
mod obstacle;
pub mod passage;
pub mod penalty;
pub mod phases;
mod piecewise;
pub mod projection;
pub mod radau;
mod rank;
mod saddle;
mod signed;
pub mod simulation;
pub mod states;
mod text_start;
mod variation;
pub mod vector;
pub mod velocity_transformation;

pub use adaptive::Adaptive;
pub use augmented_lagrangian::AugmentedLagrangian;
pub use baumgarte::Baumgarte;
pub use determinacy::Determinacy;
pub use dormand_prince5::DormandPrince5;
pub use dormand_prince8::DormandPrince8;
pub use embedded::Embedded;
pub use equation::{Equation, Measured};
pub use equilibrium::{Equilibrium, equilibrium, equilibrium_with_states, undetermined_states};
pub use event::Direction;
pub use event::WithIntervals;
pub use explicit::{FixedStep, RungeKutta4, SemiImplicitEuler};
pub use extrapolated::Extrapolated;
pub use friction::{NormalForces, WithNormalForces};
pub use generalized_alpha::GeneralizedAlpha;
pub use inverse::{Driven, inverse, inverse_with_states};
pub use linearization::{Linearization, WithStates, linearize, linearize_in, linearize_with_states};
pub use metric::{Metric, Tolerance};
pub use model::{Counts, Doubt, Formulation, Model, Solved};
pub use motion::{Equations, Explicit, Instant, Method};
pub use multipliers::Unstabilized;
pub use passage::Passage;
pub use penalty::Penalty;
pub use phases::Phased;
pub use piecewise::Term;
pub use projection::{Projection, Stages};
pub use radau::Radau5;
pub use simulation::{Balance, Simulation};
pub use states::states_at_rest;
pub use text_start::{MovedStart, closed};
pub use vector::{State, Vector};
pub use velocity_transformation::VelocityTransformation;
