//! Mechanisms of any size behind object-safe traits: all code of the workbench that is generic over mechanisms.

#[cfg(feature = "program")]
pub mod adapted;
#[cfg(feature = "program")]
pub mod adaption;
mod branching;
#[cfg(feature = "program")]
pub mod costs;
#[cfg(feature = "program")]
pub mod driven_variations;
pub mod dynamics;
pub mod erase;
#[cfg(feature = "program")]
pub mod event_times;
#[cfg(feature = "program")]
pub mod exact;
pub mod experiment;
pub mod facade;
pub mod fed;
pub mod feeds;
pub mod formulas;
#[cfg(feature = "program")]
pub mod in_double;
pub mod lanes;
pub mod masses;
#[cfg(feature = "program")]
pub mod scene_runs;
#[cfg(feature = "program")]
pub mod timed_runs;
#[cfg(feature = "program")]
pub mod timed_steps;
#[cfg(feature = "program")]
pub mod variations;
