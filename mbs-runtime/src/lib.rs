//! Fixed-size, allocation-free solvers for mechanisms declared with [`mechanism!`].
//!
//! A mechanism is a text of coordinates, constraints, drives and bodies. The macro differentiates it symbolically while the crate
//! compiles, and implements [`Mechanism`] and, by what the text has, [`Kinematic`] and [`Dynamic`]. The solvers use these traits
//! alone. Nothing allocates, nothing panics. A [`Failure`] names the row or coordinate to blame and its line, where there is one.
//!
//! ```
//! use mbs_runtime::{Mechanism, Stepper, mechanism};
//!
//! mechanism! {
//!     /// A crank and a rod that slides along x.
//!     pub mechanism SliderCrank;
//!     param crank: m = 50mm;
//!     param rod: m = 180mm;
//!     coord theta: rad = 0;
//!     coord phi: rad = 0;
//!     coord x: m = 0.2;
//!     constraint closure { crank*unit(theta) + rod*unit(phi) == [x, 0]; }
//!     drive motor: theta == 300rpm*t;
//!     branch ahead: cos(phi) > 0;
//!     out travel: m = x;
//! }
//!
//! let machine: SliderCrank = SliderCrank::default();
//! let guess = machine.guess(&machine.parameters());
//! let mut motion = Stepper::assemble(machine, guess, 0.0)?;
//! motion.advance(0.001)?; // 1 ms on
//! let [travel] = motion.outputs();
//! println!("{} m, {:?} m/s, {:?} m/s²", travel.value, travel.rate, travel.acceleration);
//! assert!((travel.value - 0.22997).abs() < 1e-5);
//! # Ok::<(), mbs_runtime::Failure>(())
//! ```
//!
//! Six programs are in the folder `examples` of the crate; the book of the project (`book/`) has the language and the methods.
//!
//! # Tasks
//!
//! | task | item |
//! |---|---|
//! | declare a mechanism | [`mechanism!`] |
//! | position, velocity and acceleration along the time | [`Stepper`], [`Stepper::advance`] |
//! | a step of bounded work in a control loop | [`Stepper::step`] with a [`Budget`], [`Step`], [`WorstCase`] |
//! | a measured quantity as input | [`Signal`], [`Stepper::change`] |
//! | save and restore a state | [`Stepper::save`], [`Saved`], [`Stepper::assemble_near`] |
//! | reach of a driver | [`Stepper::reach_towards`], [`Stepper::reach_of`] |
//! | one position without a motion | [`assemble()`], [`newton_raphson()`] |
//! | rates at a position | [`solve_velocity`], [`solve_acceleration`] |
//! | constraints that follow from others, rows in unequal units | [`Stepper::redundancy`], [`Redundancy`], [`IllScaled`] |
//! | many designs at once | [`Batch`], [`Lanes`] |
//! | motion from forces | [`dynamics::Simulation`] |
//! | forces from motion | [`dynamics::inverse()`] |
//! | position of rest | [`dynamics::equilibrium()`] |
//! | small motions, eigenvalues | [`dynamics::linearize()`] |
//! | motion laws, splines through tables | [`driver`] |
//! | a program for any mechanism, as the report | [`Reveal`], [`Visitor`] |
//!
//! # Symbols
//!
//! | symbol | shape | meaning |
//! |---|---|---|
//! | q, q̇, q̈ | N | coordinates, velocities, accelerations |
//! | t | 1 | time (s) |
//! | Φ(q, t) | M | rows: constraints and drives, 0 at a position |
//! | Φ_q | M × N | Jacobian of the rows |
//! | Φ_t, Φ_tt | M | explicit time derivatives; velocities solve Φ_q q̇ = −Φ_t |
//! | γ | M | right-hand side of the accelerations: Φ_q q̈ = γ |
//! | **M** | N × N | mass matrix |
//! | Q | N | generalized forces |
//! | λ | M | Lagrange multipliers: **M** q̈ + Φ_qᵀ λ = Q; the driving force or torque of a drive is −λ |
//! | h | 1 | length of a step (s) |
//! | ε | 1 | machine epsilon of the number type, which tolerances scale with |
//!
//! Values are in coherent SI units and rad; other units stand in the text alone. N counts coordinates and M rows; both are part of
//! the types.
//!
//! # Features
//!
//! | feature | effect |
//! |---|---|
//! | `nalgebra` (default) | conversions to nalgebra's vectors and matrices of fixed size, `Matrices` |
//! | `fma` | fused products in sine and cosine where the target has the instruction; links `std` |
//! | `libm` | sine, cosine and `atan2` of the crate `libm`, bit for bit |
#![no_std]
#![forbid(unsafe_code)]
// No index needs a check that an optimiser would have to remove; proofs on linked binaries show that no panic is left (`tests/proofs`).
#![cfg_attr(
    not(test),
    deny(
        clippy::expect_used,
        clippy::indexing_slicing,
        clippy::panic,
        clippy::unreachable,
        clippy::unwrap_used
    )
)]

#[doc(hidden)] // emitted code calls it
pub mod __private;
mod batch;
mod block_solvers;
pub mod driver;
pub mod dynamics;
mod failure;
mod kinematics;
mod linear_algebra;
mod mechanism;
#[cfg(feature = "nalgebra")]
pub mod nalgebra;
mod scalar;
mod stepper;
mod tolerances;
mod worst_case;

#[cfg(feature = "nalgebra")]
pub use self::nalgebra::Matrices;
pub use batch::Batch;
pub use block_solvers::budget::Budget;
pub use block_solvers::convergence::{Diagnosis, Statistics, Worst};
pub use block_solvers::dyad::{Dyad, Single};
pub use block_solvers::levenberg_marquardt::AssemblySolver;
pub use block_solvers::newton::Newton;
pub use block_solvers::trace::{Trace, Traced};
pub use failure::conflicting_rows::ConflictingRows;
pub use failure::{DerivativeOrder, Failure, FailureKind, FailureSource};
pub use kinematics::assembly::{Assembled, assemble};
pub use kinematics::newton_raphson::{Iterate, newton_raphson, newton_raphson_watched};
pub use kinematics::position::{
    RegularFactors, factorize, solve_acceleration, solve_position, solve_velocity,
};
pub use linear_algebra::direct1::Direct1;
pub use linear_algebra::direct2::Direct2;
pub use linear_algebra::direct3::Direct3;
pub use linear_algebra::factorization::Factorization;
pub use linear_algebra::guarded::{Elimination, Guarded};
pub use linear_algebra::lu::Lu;
pub use linear_algebra::rectangular::Orthogonal;
pub use linear_algebra::redundant_widths::Widths;
pub use linear_algebra::vectors::extent;
pub use mechanism::block::{Block, BlockSolver};
pub use mechanism::dynamic::{
    Dynamic, DynamicState, Energy, Gap, MissingSlope, NonNegative, Partitioned, StateSlope,
};
pub use mechanism::function::{Function, FunctionEntry};
pub use mechanism::limit::{Limit, OPEN, WARNING_SHARE, Warning};
pub use mechanism::margin::Margin;
pub use mechanism::operations::Operations;
pub use mechanism::outcome::Outcome;
pub use mechanism::phase::{Phase, Speed};
pub use mechanism::reveal::{InNumbers, Reveal, Visitor};
pub use mechanism::roots::Roots;
pub use mechanism::saved_variables::Kept;
pub use mechanism::{
    AllEffects, Entry, Evaluation, Kinematic, Mechanism, OutputValue, Reference, Signal, Solved,
};
pub use scalar::interval::Interval;
pub use scalar::lanes::Lanes;
pub use scalar::number::{Real, Scalar};
pub use stepper::Stepper;
pub use stepper::bounded_step::Step;
pub use stepper::dependent_rows::Redundancy;
pub use stepper::mismatch::Mismatch;
pub use stepper::reach::ReachLimit;
pub use stepper::saved::{NEAR, Saved};
pub use stepper::scaling::IllScaled;
pub use stepper::sweep::{Frame, Sweep};
pub use worst_case::WorstCase;
pub use worst_case::work::{BlockWork, Work};

/// Declares a mechanism: a struct with its parameters, and implementations of [`Mechanism`], of [`Kinematic`] if the
/// rows fix every coordinate, and of [`Dynamic`] if the text has masses or forces.
///
/// The text is a header and statements. The most used are `param`, `coord`, `constraint`, `drive`, `branch` and `out`; for dynamics
/// `body` and `force`. The language reference of the book (`book/src/language`) explains all of them.
///
/// The emitted struct has the parameters and inputs as public fields, `Default`, and a view of the coordinates by name. Its
/// documentation has shapes, sparsity, order of solution and operation counts. With functions it has a type parameter and a public
/// field for each, before the scalar, and `new` that takes them. With scenes it has a type parameter for the scene after the
/// scalar's, [`AllEffects`] by default, and an alias for each scene.
///
/// ```
/// use mbs_runtime::{Mechanism, Stepper, mechanism};
///
/// mechanism! {
///     /// A crank and a rod that slides along x.
///     pub mechanism SliderCrank;
///     param crank: m = 50mm;
///     param rod: m = 180mm;
///     param omega: rad/s = 300rpm;
///     coord theta: rad = 0;
///     coord phi: rad = 0;
///     coord x: m = 0.2;
///     constraint closure { crank*unit(theta) + rod*unit(phi) == [x, 0]; }
///     drive motor: theta == omega*t;
///     branch ahead: cos(phi) > 0;
/// }
///
/// let machine: SliderCrank = SliderCrank { crank: 0.04, ..SliderCrank::default() };
/// let guess = machine.guess(&machine.parameters());
/// let mut motion = Stepper::assemble(machine, guess, 0.0)?;
/// motion.advance(0.001)?;
/// let q = SliderCrankCoordinates::from(*motion.q());
/// assert!((q.x - (0.04 * q.theta.cos() + 0.18 * q.phi.cos())).abs() < 1e-12);
/// # Ok::<(), mbs_runtime::Failure>(())
/// ```
#[macro_export]
macro_rules! mechanism {
    ($($text:tt)*) => { $crate::__expand! { ($crate) $($text)* } };
}

#[doc(hidden)] // the mechanism! macro calls it
pub use mbs_macros::mechanism as __expand;
