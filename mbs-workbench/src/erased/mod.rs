//! Mechanisms of any size behind object-safe traits: all code of the workbench that is generic over mechanisms.

mod branching;
pub mod dynamics;
pub mod erase;
pub mod experiment;
pub mod facade;
pub mod formulas;
pub mod lanes;
pub mod masses;
