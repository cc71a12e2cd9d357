//! Driving functions: harmonics, polynomials, motion laws, trapezoidal velocity.
//!
//! Each is a [`Function`](crate::Function): value and derivatives at any scalar, lanes and `f32` included. The data are
//! `f64` numbers that can stand in flash; where an argument lies in a table, `f64` decides, lane by lane, and the distance to
//! that place is taken without rounding it to a coarser scalar first. An argument that is not finite gives NaN.
//!
//! | driver | formula | continuous derivatives |
//! |---|---|---|
//! | [`Harmonic`] | a + b sin(c t − d) | all |
//! | [`Polynomial`], [`Cubic`] | Σ aⱼ tʲ | all |
//! | [`Rise`], [`Segments`] with [`Polynomial345`] | 10 u³ − 15 u⁴ + 6 u⁵ | 2 |
//! | … with [`Polynomial4567`] | 35 u⁴ − 84 u⁵ + 70 u⁶ − 20 u⁷ | 3 |
//! | … with [`Cycloid`] | u − sin(2π u)/2π | 2 |
//! | [`Trapezoidal`] | speed up, cruise, slow down | 1 |

mod error;
mod harmonic;
mod law;
mod piecewise;
mod polynomial;
mod rise;
mod segments;
mod trapezoidal;

pub use error::LawError;
pub use harmonic::Harmonic;
pub use law::{Cycloid, Law, Polynomial345, Polynomial4567};
pub use polynomial::{Cubic, Polynomial};
pub use rise::Rise;
pub use segments::{Segment, Segments};
pub use trapezoidal::Trapezoidal;

/// Number of continuous derivatives of a function that has them all: more than any text can ask for.
pub const SMOOTH: usize = u8::MAX as usize;
