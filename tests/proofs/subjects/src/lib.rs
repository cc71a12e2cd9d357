//! Mechanisms, drivers and every entry point of emitted code and solvers, for the proofs.
//!
//! Results pass through [`black_box`](core::hint::black_box), so that no entry point is optimised away.
#![no_std]
#![forbid(unsafe_code)]

pub mod cam;
pub mod drivers;
pub mod dynamics;
pub mod engine;
pub mod entry_points;
pub mod exercise;
pub mod four_bar;
pub mod hammer;
pub mod parallelogram;
pub mod platform;
pub mod sledge;
pub mod tape;

pub use cam::{Cam, cam};
pub use drivers::{exercise_laws, exercise_splines};
pub use dynamics::{
    exercise_contacts, exercise_dynamics, exercise_masses, exercise_modes, exercise_modes_further,
    exercise_sleep,
};
pub use engine::{Engine, engine};
pub use exercise::{Start, exercise_batch, exercise_emitted, exercise_functions, exercise_solvers};
pub use four_bar::FourBar;
pub use hammer::Hammer;
pub use parallelogram::Parallelogram;
pub use platform::Platform;
pub use sledge::Sledge;
pub use tape::exercise_tape;
