//! The solvers on a mechanism whose answers are known.

mod failures;
mod four_bar;
mod lanes;
mod motion;
