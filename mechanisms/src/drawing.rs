//! How a mechanism is drawn: shapes between points, which are vector outputs of the text.

use serde::Serialize;

/// A shape of the picture. Points are named by their `out` in the text, two components in metres.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Shape {
    /// A support fixed to the ground.
    Ground {
        /// Point of the support.
        at: &'static str,
    },
    /// A bar through points in a line.
    Link {
        /// Points from one end to the other.
        points: &'static [&'static str],
        /// Name beside the bar.
        label: &'static str,
    },
    /// A rigid plate with corners.
    Plate {
        /// Corners in order around the plate.
        points: &'static [&'static str],
        /// Name beside the plate.
        label: &'static str,
    },
    /// A revolute joint.
    Joint {
        /// Centre of the joint.
        at: &'static str,
    },
    /// A block that slides on a rail.
    Slider {
        /// Centre of the block.
        at: &'static str,
        /// Direction of the rail.
        along: [f64; 2],
    },
    /// A fixed rail along the whole path of a point.
    Rail {
        /// The point that moves on the rail.
        at: &'static str,
        /// Direction of the rail.
        along: [f64; 2],
    },
    /// The path that a point draws.
    Trace {
        /// The point.
        of: &'static str,
        /// Name of the path.
        label: &'static str,
    },
}

impl Shape {
    /// Names of the points that the shape needs.
    pub fn points(&self) -> &[&'static str] {
        match self {
            Shape::Link { points, .. } | Shape::Plate { points, .. } => points,
            Shape::Ground { at }
            | Shape::Joint { at }
            | Shape::Slider { at, .. }
            | Shape::Rail { at, .. } => core::slice::from_ref(at),
            Shape::Trace { of, .. } => core::slice::from_ref(of),
        }
    }
}
