//! Ready mechanisms, and what the `mbs` program does with them.
//!
//! Every mechanism is one file: its text, how it is drawn, and tests against a closed form or a reference
//! solution. [`registry::ALL`] lists them; [`facade::AnyMechanism`] runs any of them; [`report`] and [`csv`] write
//! motions down; [`verify`] compares the emitted code with CasADi.
//!
//! ```
//! let card = mechanisms::registry::find("four_bar").expect("in the list");
//! let mechanism = card.instance(&card.runs[0]).expect("parameters of the preset");
//! let motion = mechanisms::registry::sweep(mechanism.as_ref(), 1.0, 100).expect("it turns fully");
//! assert!(motion.closure.iter().all(|error| *error < 1e-12));
//! ```

pub mod four_bar;
pub mod loop_length;
pub mod loop_relative;
pub mod open_chain;
pub mod slider_crank;

pub mod csv;
pub mod drawing;
pub mod facade;
pub mod registry;
pub mod report;
pub mod target_directory;
pub mod verify;

#[cfg(test)]
mod reference;
