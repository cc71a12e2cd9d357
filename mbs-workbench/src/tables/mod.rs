//! Tables from files: a measured lift, a law from elsewhere, as splines for the runtime.
//!
//! [`read`] parses a file and converts its units to SI; [`Spline::fit`] fits a spline to the points; [`knots`] finds how many knots it
//! should have; [`Table`] is the function of a text; [`valley`] shows what points, rounding and knots cost; [`measured`] reads quantities over the time, [`chart`] draws a
//! spline, [`constant`] writes it as Rust, [`sample`] is a file to try it on.

pub mod chart;
pub mod constant;
pub mod knots;
pub mod measured;
mod reader;
pub mod sample;
mod spline;
mod table;
mod unit;
pub mod valley;

pub(crate) use reader::UNITS_UNKNOWN;
pub use reader::{Columns, Points, ReadFault, read, read_unordered};
pub use spline::{SEED, Spline, SplineKind, close_period};
pub use table::{Table, TableError, explained};
pub use unit::Unit;
