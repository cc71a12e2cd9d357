//! Hard cases: a mechanism by every method in many variants, each run judged by an oracle of its own.

pub mod course;
mod driven;
mod instants;
mod judge;
pub mod list;
pub mod matrix;
mod moved;
pub mod oracle;
mod references;
pub mod result;
mod sensitivity;
mod similar;
pub mod similarity;
pub mod study;
#[cfg(test)]
mod tests;
pub mod variation;
pub mod verdict;
