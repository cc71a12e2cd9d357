//! How a mechanism is drawn: shapes between points, which are vector outputs of the text.
//!
//! The report's page gets the shapes as JSON, one object a shape: `kind` is the variant's name in lower case, the
//! other members are its fields. A point is the name of an `out` with two components in metres, or with three where the
//! drawing has a [`View`](Shape::View); what turns does so with its points, so that a shape has no lengths of its own and follows the parameters. A point whose name has an
//! underscore (`slot_end`) helps to draw; its name does not stand beside it. A shape with an empty label is a further
//! part of the body before it and has its colour.

use core::f64::consts::FRAC_1_SQRT_2;

use serde::Serialize;

/// 1/√6.
pub const FRAC_1_SQRT_6: f64 = 0.408_248_290_463_863;

/// Along the diagonal of the axes, z upwards.
pub const DIAGONAL_Z_UP: Shape = Shape::View {
    right: [-FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0],
    up: [-FRAC_1_SQRT_6, -FRAC_1_SQRT_6, 2.0 * FRAC_1_SQRT_6],
    label: "from x = y = z, z upwards",
};

/// A shape of the picture.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Shape {
    /// How points in space are seen: what stands along these directions is drawn, what stands across them is not.
    View {
        /// Unit vector to the right of the picture.
        right: [f64; 3],
        /// Unit vector upwards in the picture, across the other.
        up: [f64; 3],
        /// From where it is seen.
        label: &'static str,
    },
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
    /// A bar with a slot along its whole length, in which a slider or a pin runs.
    Slot {
        /// Points from one end to the other.
        points: &'static [&'static str],
        /// Name beside the bar.
        label: &'static str,
    },
    /// A spring between two points.
    Spring {
        /// Its ends.
        points: [&'static str; 2],
        /// Name beside the spring.
        label: &'static str,
    },
    /// A revolute joint.
    Joint {
        /// Centre of the joint.
        at: &'static str,
    },
    /// A block that slides on a rail, a bar or in a slot.
    Slider {
        /// Centre of the block.
        at: &'static str,
        /// Direction of the rail.
        along: Along,
    },
    /// A fixed rail along the whole path of a point.
    Rail {
        /// The point that moves on the rail.
        at: &'static str,
        /// Direction of the rail.
        along: Along,
    },
    /// A smooth wheel or roller with a mark on its rim.
    Wheel {
        /// Centre.
        at: &'static str,
        /// The mark; its distance from the centre is the radius.
        rim: &'static str,
        /// Name beside the wheel.
        label: &'static str,
    },
    /// A gear.
    Gear {
        /// Centre.
        at: &'static str,
        /// A point on the pitch circle in the middle of a tooth, of a gap where the teeth point inwards.
        rim: &'static str,
        /// Number of teeth.
        teeth: u32,
        /// Whether the teeth point inwards, as those of a ring gear.
        inside: bool,
        /// Name beside the gear.
        label: &'static str,
    },
    /// A disc cam. Its profile is what `contact` draws on the cam during the run, which turns the cam once.
    Cam {
        /// Centre of rotation.
        at: &'static str,
        /// The point where the follower touches.
        contact: &'static str,
        /// Angle of the cam (rad): a coordinate or a scalar output.
        turn: &'static str,
        /// Name beside the cam.
        label: &'static str,
    },
    /// The flat face of a follower with its stem.
    Face {
        /// Ends of the face.
        points: [&'static str; 2],
        /// End of the stem, on the side away from the cam.
        back: &'static str,
        /// Name beside the follower.
        label: &'static str,
    },
    /// A Geneva drive: the driver with its pin and locking disc, and the slotted wheel.
    Geneva {
        /// Centre of the driver.
        at: &'static str,
        /// The driver's pin.
        pin: &'static str,
        /// Centre of the slotted wheel.
        wheel: &'static str,
        /// A point on the wheel's rim in the middle of a slot.
        rim: &'static str,
        /// Number of slots.
        slots: u32,
    },
    /// The road that passes under a point at a speed of the picture's own: its height over the run, level before and behind.
    Road {
        /// The point on the road.
        at: &'static str,
        /// Speed (m/s) to the right at which the picture moves over the road.
        speed: f64,
        /// Name beside the road.
        label: &'static str,
    },
    /// The path that a point draws.
    Trace {
        /// The point.
        of: &'static str,
        /// Name of the path.
        label: &'static str,
    },
}

/// Direction of a slide.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(untagged)]
pub enum Along {
    /// Fixed: two components.
    Fixed([f64; 2]),
    /// Turning: an angle (rad), as the name of a coordinate or of a scalar output, or a direction as that of a vector
    /// output.
    Named(&'static str),
}

impl Shape {
    /// Names of the points that the shape needs.
    pub fn points(&self) -> Vec<&'static str> {
        match *self {
            Shape::Link { points, .. } | Shape::Plate { points, .. } | Shape::Slot { points, .. } => {
                points.to_vec()
            }
            Shape::View { .. } => Vec::new(),
            Shape::Ground { at }
            | Shape::Joint { at }
            | Shape::Slider { at, .. }
            | Shape::Rail { at, .. }
            | Shape::Road { at, .. } => {
                vec![at]
            }
            Shape::Spring { points, .. } => points.to_vec(),
            Shape::Wheel { at, rim, .. } | Shape::Gear { at, rim, .. } => vec![at, rim],
            Shape::Cam { at, contact, .. } => vec![at, contact],
            Shape::Face { points: [left, right], back, .. } => vec![left, right, back],
            Shape::Geneva { at, pin, wheel, rim, .. } => vec![at, pin, wheel, rim],
            Shape::Trace { of, .. } => vec![of],
        }
    }

    /// Name of the angle or direction that turns the shape, where its points do not.
    pub fn direction(&self) -> Option<&'static str> {
        match *self {
            Shape::Slider { along: Along::Named(name), .. }
            | Shape::Rail { along: Along::Named(name), .. }
            | Shape::Cam { turn: name, .. } => Some(name),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::FREE;

    #[test]
    fn views_are_orthonormal() {
        for shape in FREE.iter().flat_map(|card| card.drawing) {
            let Shape::View { right, up, .. } = shape else { continue };
            let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            for (found, expected) in [(dot(right, right), 1.0), (dot(up, up), 1.0), (dot(right, up), 0.0)] {
                assert!((found - expected).abs() < 1e-15, "{shape:?}");
            }
        }
    }
}
