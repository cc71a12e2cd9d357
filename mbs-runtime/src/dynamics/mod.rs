//! Motion from forces: M q̈ + Φ_qᵀ λ = Q with Φ = 0.
//!
//! A method is chosen by type: an integrator with a formulation, or an implicit method that is both.

pub mod adaptive;
pub mod augmented_lagrangian;
pub mod baumgarte;
mod blocks;
mod both_sides;
pub mod dormand_prince5;
pub mod dormand_prince8;
pub mod embedded;
pub mod equation;
pub mod equilibrium;
pub mod event;
pub mod explicit;
pub mod extrapolated;
pub mod generalized_alpha;
mod implicit;
pub mod inverse;
pub mod kkt;
pub mod linearization;
pub mod metric;
pub mod model;
pub mod motion;
pub mod multipliers;
mod null_space;
pub mod penalty;
pub mod projection;
pub mod simulation;
mod text_start;
pub mod vector;
pub mod velocity_transformation;

pub use adaptive::Adaptive;
pub use augmented_lagrangian::AugmentedLagrangian;
pub use baumgarte::Baumgarte;
pub use dormand_prince5::DormandPrince5;
pub use dormand_prince8::DormandPrince8;
pub use embedded::Embedded;
pub use equation::{Equation, Measured};
pub use equilibrium::{Equilibrium, equilibrium};
pub use event::Direction;
pub use explicit::{FixedStep, RungeKutta4, SemiImplicitEuler};
pub use extrapolated::Extrapolated;
pub use generalized_alpha::GeneralizedAlpha;
pub use inverse::{Driven, inverse};
pub use linearization::{Linearization, linearize};
pub use metric::{Metric, Tolerance};
pub use model::{Counts, Doubt, Formulation, Model, Solved};
pub use motion::{Equations, Explicit, Instant, Method};
pub use multipliers::Unstabilized;
pub use penalty::Penalty;
pub use projection::{Projection, Stages};
pub use simulation::{Balance, Simulation};
pub use vector::{State, Vector};
pub use velocity_transformation::VelocityTransformation;
