//! Tools for any mechanism: the command line of `mbs`, analyses, reports, cross-checks, teaching commands.
//!
//! [`program()`] is the command line over a list of mechanisms, a [`Catalogue`](catalogue::Catalogue); the crate `mechanisms` has the
//! ready ones. [`erased`] runs a mechanism of any size behind one trait; it has all code that is generic over mechanisms.
//! [`text_file`] reads mechanisms from files, [`forge`] builds programs of them.
//! [`verify`] compares emitted code with CasADi, in a test of the crate that declares the mechanism too.
//!
//! Without the feature `program` there is no command line, only the comparison of a mechanism of one's own: [`erased`], [`verify`].

#[cfg(feature = "program")]
pub mod cams;
#[cfg(feature = "program")]
pub mod card;
#[cfg(feature = "program")]
pub mod catalogue;
#[cfg(feature = "program")]
mod command_line;
#[cfg(feature = "program")]
mod commands;
#[cfg(feature = "program")]
pub mod cost;
#[cfg(feature = "program")]
pub mod double_double;
#[cfg(feature = "program")]
pub mod effects;
pub mod erased;
#[cfg(feature = "program")]
pub mod forge;
#[cfg(feature = "program")]
pub mod hard_cases;
mod hash;
#[cfg(feature = "program")]
pub mod known_motion;
#[cfg(feature = "program")]
pub mod layout;
#[cfg(feature = "program")]
pub mod mismatch;
pub mod motion;
#[cfg(feature = "program")]
pub mod output;
pub mod random;
#[cfg(feature = "program")]
pub mod setting;
#[cfg(feature = "program")]
pub mod study;
#[cfg(feature = "program")]
pub mod tables;
pub mod target_directory;
#[cfg(feature = "program")]
pub mod teaching;
#[cfg(feature = "program")]
pub mod text_file;
pub mod verify;

#[cfg(feature = "program")]
pub use command_line::{cost_program, effects_program, hard_cases_program, hard_cases_program_list, program};
#[cfg(feature = "program")]
pub use commands::functions::{GivenFunction, given_function};
