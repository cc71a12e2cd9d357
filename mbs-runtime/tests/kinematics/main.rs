//! The solvers on a mechanism whose answers are known.

mod batch;
mod deadline;
mod drives;
mod dyads;
mod failures;
mod four_bar;
mod groups;
mod inputs;
mod lanes;
mod motion;
mod ranges;
mod reset;
mod stops;
mod terms;
mod transmission;
