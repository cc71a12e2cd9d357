//! Values of leaves at which graphs are tried.

use super::graph::Leaf;
use crate::sample_points::fraction;

/// A value of a leaf from 0 up to 1, scattered but the same in every build.
pub fn scattered(leaf: Leaf, trial: usize) -> f64 {
    let (kind, index) = match leaf {
        Leaf::Parameter(index) => (1, index),
        Leaf::Input(index) => (2, index),
        Leaf::Time => (3, 0),
        Leaf::Position(index) => (4, index),
        Leaf::Velocity(index) => (5, index),
        Leaf::Acceleration(index) => (6, index),
        Leaf::State(index) => (7, index),
        Leaf::Multiplier(index) => (8, index),
        Leaf::Direction(index) => (9, index),
        Leaf::Given(group, index) => (10 + u64::from(group), index),
        Leaf::Sliding(index) => (1 << 40, index),
        Leaf::Holding(index) => (1 << 41, index),
        Leaf::Remembered(index) => (1 << 42, index),
        Leaf::Impulse(index) => (1 << 43, index),
    };
    fraction(kind, index, trial)
}
