//! Driving functions: harmonics, polynomials, motion laws, trapezoidal velocity, splines through tables.
//!
//! Each is a [`Function`](crate::Function): value and derivatives at any scalar, lanes and `f32` included. The data are `f64`
//! numbers that can be placed in flash. The place of an argument in a table is found in `f64`, lane by lane. The distance to
//! that place is not rounded to a coarser scalar first. An argument that is not finite gives NaN.
//!
//! | driver | formula | continuous derivatives |
//! |---|---|---|
//! | [`Harmonic`] | a + b sin(c t − d) | all |
//! | [`Polynomial`], [`Cubic`] | Σ aⱼ tʲ | all |
//! | [`Rise`], [`Segments`] with [`Polynomial345`] | 10 u³ − 15 u⁴ + 6 u⁵ | 2 |
//! | … with [`Polynomial4567`] | 35 u⁴ − 84 u⁵ + 70 u⁶ − 20 u⁷ | 3 |
//! | … with [`Cycloid`] | u − sin(2π u)/2π | 2 |
//! | [`Trapezoidal`] | speed up, cruise, slow down | 1 |
//! | [`CubicSpline`] | through points or along them | 2 |
//! | [`PeriodicQuintic`] | through points or along them | 4 |
//!
//! Rows need two derivatives of a `function` (γ has the second). [`Trapezoidal`], whose acceleration jumps, drives a row as an
//! `input …, rates` that is set before each step from its [`jet`](crate::mechanism::function::Function::jet), or appears in
//! outputs.

pub(crate) mod basis;
pub(crate) mod bounded;
pub(crate) mod closed_curve;
pub(crate) mod cubic_fit;
pub(crate) mod cubic_spline;
pub(crate) mod curve_bounds;
pub(crate) mod enclosures;
pub(crate) mod error;
pub(crate) mod foot;
pub(crate) mod harmonic;
pub(crate) mod law;
pub(crate) mod periodic_quintic;
pub(crate) mod piecewise;
pub(crate) mod points;
pub(crate) mod polynomial;
pub(crate) mod quintic_fit;
pub(crate) mod reach;
pub(crate) mod rise;
pub(crate) mod segments;
pub(crate) mod table;
pub(crate) mod trapezoidal;
pub(crate) mod triangle;

pub use bounded::Bounded;
pub use closed_curve::{ClosedCurve, Parametric, Polar};
pub use cubic_fit::{CubicRow, End, fit_cubic};
pub use cubic_spline::CubicSpline;
pub use enclosures::centred;
pub use error::{FitError, LawError};
pub use foot::{Foot, FootError, nearest_foot};
pub use harmonic::Harmonic;
pub use law::{Cycloid, Law, Polynomial345, Polynomial4567};
pub use periodic_quintic::PeriodicQuintic;
pub use polynomial::{Cubic, Polynomial};
pub use quintic_fit::{QuinticRow, fit_periodic_quintic};
pub use reach::{ReachError, reach};
pub use rise::Rise;
pub use segments::{Segment, Segments};
pub use table::Table;
pub use trapezoidal::Trapezoidal;
pub use triangle::Row;

/// Number of continuous derivatives of a function that has them all: more than any text can ask for.
pub const SMOOTH: usize = u8::MAX as usize;
