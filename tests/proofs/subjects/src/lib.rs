//! Mechanisms, drivers and every entry point of emitted code and solvers, for the proofs.
//!
//! Results pass through [`black_box`](core::hint::black_box), so that no entry point is optimised away.
#![no_std]
#![forbid(unsafe_code)]

pub mod cam;
pub mod drivers;
pub mod entry_points;
pub mod exercise;
pub mod four_bar;
pub mod platform;

pub use cam::{Cam, cam};
pub use drivers::{exercise_laws, exercise_splines};
pub use exercise::{Start, exercise_emitted, exercise_solvers};
pub use four_bar::FourBar;
pub use platform::Platform;
