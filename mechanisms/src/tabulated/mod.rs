//! Tables from files: a measured lift, a law from elsewhere, as splines for the runtime.
//!
//! [`read`] takes a file apart and turns its units into SI, [`Spline::fit`] lays a spline along the points,
//! [`chart`] draws it, [`constant`] writes it as Rust, [`sample`] is a file to try it on.

pub mod chart;
pub mod constant;
mod reader;
pub mod sample;
mod spline;
mod unit;

pub use reader::{Columns, Fault, Points, read};
pub use spline::{Kind, Spline, close_period};
pub use unit::Unit;
