//! Ready mechanisms, and what the `mbs` program does with them.
//!
//! Every mechanism is one file: its text, how it is drawn, and tests against a closed form or a reference
//! solution. [`registry::ALL`] lists them; [`facade::AnyMechanism`] runs any of them; [`report`] and [`csv`] write
//! motions down; [`verify`] compares the emitted code with CasADi; [`lecture`] is what the
//! teaching commands compute; [`tabulated`] lays splines along tables from files.
//!
//! Without the feature `ready` there are no ready mechanisms, but what compares one of your own: [`facade`] and [`verify`].
//!
//! ```
//! let card = mechanisms::registry::find("four_bar").expect("in the list");
//! let mechanism = card.instance(&card.runs[0]).expect("parameters of the preset");
//! let motion = mechanisms::registry::sweep(mechanism.as_ref(), 1.0, 100).expect("it turns fully");
//! assert!(motion.closure.iter().all(|error| *error < 1e-12));
//! ```

#[cfg(feature = "ready")]
pub mod andrews;
#[cfg(feature = "ready")]
pub mod bricard;
#[cfg(feature = "ready")]
pub mod cam_flat;
#[cfg(feature = "ready")]
pub mod cam_law;
#[cfg(feature = "ready")]
pub mod cam_oscillating;
#[cfg(feature = "ready")]
pub mod cam_roller;
#[cfg(feature = "ready")]
pub mod car_axis;
#[cfg(feature = "ready")]
pub mod cart_pole;
#[cfg(feature = "ready")]
pub mod determinant_guide;
#[cfg(feature = "ready")]
pub mod double_parallelogram;
#[cfg(feature = "ready")]
pub mod double_pendulum;
#[cfg(feature = "ready")]
pub mod five_angle_loop;
#[cfg(feature = "ready")]
pub mod four_bar;
#[cfg(feature = "ready")]
pub mod four_bar_mass;
#[cfg(feature = "ready")]
pub mod four_bar_mixed;
#[cfg(feature = "ready")]
pub mod four_bar_natural;
#[cfg(feature = "ready")]
pub mod four_bar_reference_point;
#[cfg(feature = "ready")]
pub mod geneva;
#[cfg(feature = "ready")]
pub mod governor;
#[cfg(feature = "ready")]
pub mod heavy_top;
#[cfg(feature = "ready")]
pub mod jansen;
#[cfg(feature = "ready")]
pub mod loop_length;
#[cfg(feature = "ready")]
pub mod loop_relative;
#[cfg(feature = "ready")]
pub mod n_four_bar;
#[cfg(feature = "ready")]
pub mod n_four_bar_1;
#[cfg(feature = "ready")]
pub mod n_four_bar_10;
#[cfg(feature = "ready")]
pub mod n_four_bar_40;
#[cfg(feature = "ready")]
pub mod open_chain;
#[cfg(feature = "ready")]
pub mod peaucellier;
#[cfg(feature = "ready")]
pub mod pendulum;
#[cfg(feature = "ready")]
pub mod planetary_gear;
#[cfg(feature = "ready")]
pub mod quarter_car;
#[cfg(feature = "ready")]
pub mod quick_return;
#[cfg(feature = "ready")]
pub mod scotch_yoke;
#[cfg(feature = "ready")]
pub mod slider_crank;
#[cfg(feature = "ready")]
pub mod slider_crank_mass;
#[cfg(feature = "ready")]
pub mod slider_crank_scenes;
#[cfg(feature = "ready")]
pub mod stephenson;
#[cfg(feature = "ready")]
pub mod three_rrr;
#[cfg(feature = "ready")]
pub mod watt;

pub mod analyses;
mod branching;
#[cfg(feature = "ready")]
pub mod csv;
#[cfg(feature = "ready")]
pub mod drawing;
pub mod facade;
pub mod lecture;
pub mod masses;
pub mod motion;
#[cfg(feature = "ready")]
pub mod registry;
#[cfg(feature = "ready")]
pub mod report;
pub mod supplies;
#[cfg(feature = "ready")]
pub mod tabulated;
pub mod target_directory;
pub mod verify;

#[cfg(test)]
mod closed_form;
#[cfg(test)]
mod newton_euler;
#[cfg(test)]
mod reference;
