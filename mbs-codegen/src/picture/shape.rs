//! Shapes between points.

/// A shape of the picture. Points, angles and directions are names of [`Place`](super::Place)s.
///
/// A shape turns with its points: it has no lengths of its own and follows the parameters. A shape with an
/// empty label is a further part of the body before it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(tag = "kind", rename_all = "lowercase"))]
pub enum Shape {
    /// Line of sight of points in space.
    View {
        /// Unit vector to the right of the picture.
        right: [f64; 3],
        /// Unit vector upwards in the picture, perpendicular to the other.
        up: [f64; 3],
        /// Name of the line of sight.
        label: String,
    },
    /// A support fixed to the ground.
    Ground {
        /// Point of the support.
        at: String,
    },
    /// A bar through points in a line.
    Link {
        /// Points from one end to the other.
        points: Vec<String>,
        /// Name drawn at the bar.
        label: String,
    },
    /// A rigid plate with corners.
    Plate {
        /// Corners in order around the plate.
        points: Vec<String>,
        /// Name drawn at the plate.
        label: String,
    },
    /// A bar with a slot along its whole length, in which a slider or a pin runs.
    Slot {
        /// Points from one end to the other.
        points: Vec<String>,
        /// Name drawn at the bar.
        label: String,
    },
    /// A spring between two points.
    Spring {
        /// Its ends.
        points: [String; 2],
        /// Name drawn at the spring.
        label: String,
    },
    /// A revolute joint.
    Joint {
        /// Centre of the joint.
        at: String,
    },
    /// A block that slides on a rail, a bar or in a slot.
    Slider {
        /// Centre of the block.
        at: String,
        /// Direction of the rail.
        along: Along,
    },
    /// A fixed rail along the whole path of a point.
    Rail {
        /// The point that moves on the rail.
        at: String,
        /// Direction of the rail.
        along: Along,
    },
    /// A smooth wheel or roller with a mark on its rim.
    Wheel {
        /// Centre.
        at: String,
        /// The mark; its distance from the centre is the radius.
        rim: String,
        /// Name drawn at the wheel.
        label: String,
    },
    /// A gear.
    Gear {
        /// Centre.
        at: String,
        /// A point on the pitch circle in the middle of a tooth, of a gap where the teeth point inwards.
        rim: String,
        /// Number of teeth.
        teeth: u32,
        /// `true` where the teeth point inwards, as those of a ring gear.
        inside: bool,
        /// Name drawn at the gear.
        label: String,
    },
    /// A disc cam. Its profile is the path of `contact` on the cam during a run that turns the cam once.
    Cam {
        /// Centre of rotation.
        at: String,
        /// The point where the follower touches.
        contact: String,
        /// Angle of the cam (rad).
        turn: String,
        /// Name drawn at the cam.
        label: String,
    },
    /// The flat face of a follower with its stem.
    Face {
        /// Ends of the face.
        points: [String; 2],
        /// End of the stem, on the side away from the cam.
        back: String,
        /// Name drawn at the follower.
        label: String,
    },
    /// A Geneva drive: the driver with its pin and locking disc, and the slotted wheel.
    Geneva {
        /// Centre of the driver.
        at: String,
        /// The driver's pin.
        pin: String,
        /// Centre of the slotted wheel.
        wheel: String,
        /// A point on the wheel's rim in the middle of a slot.
        rim: String,
        /// Number of slots.
        slots: u32,
    },
    /// The road that passes under a point: its height over the run, level before and after.
    Road {
        /// The point on the road.
        at: String,
        /// Speed (m/s) to the right at which the picture moves over the road.
        speed: f64,
        /// Name drawn at the road.
        label: String,
    },
    /// The path of a point.
    Trace {
        /// The point.
        of: String,
        /// Name of the path.
        label: String,
    },
}

/// Direction of a slide.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(untagged))]
pub enum Along {
    /// Fixed: two components.
    Fixed([f64; 2]),
    /// Turning: the name of an angle (rad) or of a vector.
    Named(String),
}

impl Shape {
    /// Names of the points that the shape needs.
    pub fn points(&self) -> Vec<&str> {
        match self {
            Shape::Link { points, .. } | Shape::Plate { points, .. } | Shape::Slot { points, .. } => {
                points.iter().map(String::as_str).collect()
            }
            Shape::View { .. } => Vec::new(),
            Shape::Ground { at }
            | Shape::Joint { at }
            | Shape::Slider { at, .. }
            | Shape::Rail { at, .. }
            | Shape::Road { at, .. } => vec![at],
            Shape::Spring { points: [from, to], .. } => vec![from, to],
            Shape::Wheel { at, rim, .. } | Shape::Gear { at, rim, .. } => vec![at, rim],
            Shape::Cam { at, contact, .. } => vec![at, contact],
            Shape::Face { points: [left, right], back, .. } => vec![left, right, back],
            Shape::Geneva { at, pin, wheel, rim, .. } => vec![at, pin, wheel, rim],
            Shape::Trace { of, .. } => vec![of],
        }
    }

    /// Name of the angle or direction that turns the shape, where its points do not.
    pub fn direction(&self) -> Option<&str> {
        match self {
            Shape::Slider { along: Along::Named(name), .. }
            | Shape::Rail { along: Along::Named(name), .. }
            | Shape::Cam { turn: name, .. } => Some(name),
            _ => None,
        }
    }
}
