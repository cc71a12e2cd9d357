//! Hash-consed graph of scalar functions: construction by numbered rules, exact differentiation, evaluation.
//!
//! It does not depend on mechanisms, on syntax or on Rust: leaves are `(kind, index)`.

mod angles;
mod derivatives;
pub mod differentiate;
pub mod evaluate;
pub mod graph;
pub mod operations;
mod powers;
mod rules;
pub mod sample_points;
pub mod substitute;

pub use angles::{AngleSum, add_angles};
pub use differentiate::{tangent, tangents};
pub use graph::{Graph, Leaf, Node, NodeId, Stage};
pub use operations::{Binary, Unary};
pub use powers::take_roots;

#[cfg(test)]
mod compositions_tests;
