//! Fixed-size, allocation-free solvers for mechanisms declared with [`mechanism!`].
//!
//! A mechanism is written once as text; the macro differentiates it and emits an implementation of
//! [`Mechanism`] and, where the structure is square, of [`Kinematic`]. The solvers here work on those
//! traits alone. Nothing allocates, nothing panics, every failure is a [`Failure`] value that
//! names the row or the coordinate and its line in the text.
#![no_std]
#![forbid(unsafe_code)]
// Whether an index is in range, LLVM decides, and a proof on the linked binary shows that it did (`tests/proofs`).
#![cfg_attr(not(test), deny(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used))]

pub mod assembly;
mod batch;
#[cfg(feature = "nalgebra")]
pub mod boundary;
pub mod budget;
mod budgeted;
pub mod diagnosis;
pub mod driver;
pub mod dyad;
pub mod dynamic;
pub mod dynamics;
pub mod failure;
mod function;
mod instant;
pub mod interval;
pub mod kinematics;
pub mod lanes;
mod lengths;
pub mod limit;
pub mod linear;
#[doc(hidden)] // emitted code calls it
pub mod long;
pub mod mechanism;
mod nearest;
pub mod newton;
pub mod newton_raphson;
pub mod operations;
mod path;
pub mod phase;
mod plain;
pub mod redundancy;
mod redundant;
pub mod resolution;
pub mod safeguarded;
pub mod saved;
pub mod scalar;
mod starts;
pub mod stepper;
pub mod stop;
pub mod sweep;
#[doc(hidden)] // emitted code calls it
pub mod tape;
pub mod trace;
mod trial;
mod trigonometry;
mod turns;
pub mod worst_case;

pub use assembly::{Assembled, assemble};
pub use batch::Batch;
#[cfg(feature = "nalgebra")]
pub use boundary::Matrices;
pub use budget::{Budget, Step};
pub use diagnosis::{Diagnosis, Statistics, Worst};
pub use dyad::{Dyad, Roots, Single};
pub use dynamic::{Dynamic, Energy, Gap, MissingSlope, Motion, Partitioned, Signed, StateSlope};
pub use failure::{Failure, Holding, Level, Outcome};
pub use function::{Function, FunctionEntry};
pub use interval::Interval;
pub use kinematics::{RegularFactors, factorize, solve_acceleration, solve_position, solve_velocity};
pub use lanes::Lanes;
pub use limit::{Limit, Warning};
pub use linear::{Direct1, Direct2, Direct3, Elimination, Guarded, Lu, Orthogonal};
pub use mechanism::{
    Block, BlockSolver, Entry, Evaluation, Factorization, Kinematic, Margin, Mechanism, OutputValue,
    Reference, Signal, Solved, Whole,
};
pub use newton::Newton;
pub use newton_raphson::{Iterate, newton_raphson, newton_raphson_watched};
pub use operations::Operations;
pub use phase::{Phase, Speed};
pub use redundancy::Redundancy;
pub use redundant::Widths;
pub use resolution::IllScaled;
pub use safeguarded::Safeguarded;
pub use saved::Saved;
pub use scalar::{Real, Scalar};
pub use stepper::Stepper;
pub use stop::Stop;
pub use sweep::{Frame, Sweep};
pub use trace::{Trace, Traced};
pub use worst_case::{BlockWork, Work, WorstCase};

/// Declares a mechanism: a struct with its parameters, and implementations of [`Mechanism`], of [`Kinematic`] where the
/// rows fix every coordinate, and of [`Dynamic`] where the text has masses or forces.
///
/// The text is a header and statements: `const`, `param`, `input`, `coord`, `let`, `constraint`, `drive`, `branch`,
/// `limit`, `out`, `function` and `for`; for dynamics `body`, `gravity`, `force`, `torque`, `tsda`, `rsda`, `potential`,
/// `kinetic`, `dissipation`, `state` and `start`; `effect` and `scene` for several mechanisms in one text. Units are
/// checked, vectors are arrays, derivatives are exact. The emitted struct has the parameters and inputs as public fields,
/// `Default`, a view of the coordinates by name, and in its documentation shapes, sparsity, order of solution and operation
/// counts. With functions it has a type parameter and a public field for each, before the scalar, and `new` that takes
/// them. A constraint marked `redundant` may have rows that follow from others. With scenes it has a type parameter behind the scalar's for the scene, [`Whole`] where nothing else is said, and
/// an alias for each scene. The README explains every statement.
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
