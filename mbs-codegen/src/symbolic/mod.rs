//! Hash-consed graph of scalar functions: construction by numbered rules, exact differentiation, evaluation.
//!
//! Knows nothing of mechanisms, of syntax or of Rust: leaves are `(kind, index)`.

mod angles;
pub mod differentiate;
pub mod evaluate;
pub mod graph;
mod powers;
mod rules;
pub mod scattered;
pub mod substitute;

pub use angles::{AngleSum, add_angles};
pub use differentiate::{tangent, tangents};
pub use graph::{Binary, Graph, Leaf, Node, NodeId, Stage, Unary};
pub use powers::take_roots;

#[cfg(test)]
mod compositions_tests;
