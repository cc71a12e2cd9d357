//! Ready mechanisms, and what the `mbs` program does with them.
//!
//! Every mechanism is one file: its text, how it is drawn, and tests against a closed form or a reference
//! solution. [`registry::ALL`] lists them; [`facade::AnyMechanism`] runs any of them; [`report`] and [`csv`] write
//! motions down; [`verify`] compares the emitted code with CasADi; [`lecture`] is what the
//! teaching commands compute; [`tabulated`] lays splines along tables from files.
//!
//! ```
//! let card = mechanisms::registry::find("four_bar").expect("in the list");
//! let mechanism = card.instance(&card.runs[0]).expect("parameters of the preset");
//! let motion = mechanisms::registry::sweep(mechanism.as_ref(), 1.0, 100).expect("it turns fully");
//! assert!(motion.closure.iter().all(|error| *error < 1e-12));
//! ```

pub mod andrews;
pub mod bricard;
pub mod cam_flat;
pub mod cam_law;
pub mod cam_oscillating;
pub mod cam_roller;
pub mod car_axis;
pub mod cart_pole;
pub mod determinant_guide;
pub mod double_parallelogram;
pub mod double_pendulum;
pub mod five_angle_loop;
pub mod four_bar;
pub mod four_bar_mass;
pub mod four_bar_mixed;
pub mod four_bar_natural;
pub mod four_bar_reference_point;
pub mod geneva;
pub mod governor;
pub mod heavy_top;
pub mod jansen;
pub mod loop_length;
pub mod loop_relative;
pub mod n_four_bar;
pub mod n_four_bar_1;
pub mod n_four_bar_10;
pub mod n_four_bar_40;
pub mod open_chain;
pub mod peaucellier;
pub mod pendulum;
pub mod planetary_gear;
pub mod quarter_car;
pub mod quick_return;
pub mod scotch_yoke;
pub mod slider_crank;
pub mod slider_crank_mass;
pub mod slider_crank_scenes;
pub mod stephenson;
pub mod three_rrr;
pub mod watt;

pub mod analyses;
pub mod csv;
pub mod drawing;
pub mod facade;
pub mod lecture;
pub mod masses;
pub mod motion;
pub mod registry;
pub mod report;
pub mod tabulated;
pub mod target_directory;
pub mod verify;

#[cfg(test)]
mod closed_form;
#[cfg(test)]
mod newton_euler;
#[cfg(test)]
mod reference;
