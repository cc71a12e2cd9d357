//! Effects of a text compared: scenes with all of them, without each, with each alone, and the cheapest that is near enough.
//!
//! [`study`](study::study) chooses scenes round by round; a program that has a round's scenes [measures](measurement) them.

pub mod comparison;
pub mod measurement;
pub mod picture;
pub mod result;
pub mod scene;
pub mod study;
mod symbols;
#[cfg(test)]
mod tests;
