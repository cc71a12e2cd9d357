//! Fields of bodies, forces and contacts: names, kinds of value, and which must be given.

use super::units::Dimension;
use super::value::Reach;
use crate::syntax::ast::Element;

/// The field that makes a body one in space.
pub const ORIENTATION: &str = "orientation";

/// Kind of value in a field.
#[derive(Clone, Copy)]
pub enum FieldKind {
    /// A number of a unit, of parameters alone.
    Constant(Dimension),
    /// A number of a unit, at the reach.
    Scalar(Dimension, Reach),
    /// A point of two or three components.
    Point,
    /// A vector of a unit, of constants, inputs and the time.
    Vector(Dimension),
    /// One moment of inertia, three principal ones or all six entries, of parameters alone.
    Inertia,
    /// Four Euler parameters.
    Orientation,
    /// This word.
    Word(&'static str),
}

/// A field of an element: its name, its kind of value, `true` if it must be given.
pub type Known = (&'static str, FieldKind, bool);

/// Fields of an element, in the order of the reference.
pub fn known(element: Element) -> Vec<Known> {
    let per_metre = Dimension::NEWTON.over(Dimension::METRE);
    let scalar = |dimension| FieldKind::Scalar(dimension, Reach::Force);
    match element {
        Element::Body => vec![
            ("mass", FieldKind::Constant(Dimension::KILOGRAM), true),
            ("com", FieldKind::Point, true),
            ("inertia", FieldKind::Inertia, false),
            ("angle", FieldKind::Scalar(Dimension::NUMBER, Reach::Position), false),
            (ORIENTATION, FieldKind::Orientation, false),
        ],
        Element::Gravity => {
            let acceleration = Dimension::METRE.over(Dimension::SECOND).over(Dimension::SECOND);
            vec![("acceleration", FieldKind::Vector(acceleration), true)]
        }
        Element::Tsda => vec![
            ("from", FieldKind::Point, true),
            ("to", FieldKind::Point, true),
            ("stiffness", scalar(per_metre), false),
            ("length", scalar(Dimension::METRE), false),
            ("damping", scalar(per_metre.times(Dimension::SECOND)), false),
            ("actuator", scalar(Dimension::NEWTON), false),
        ],
        Element::Rsda => vec![
            ("angle", FieldKind::Scalar(Dimension::NUMBER, Reach::Position), true),
            ("stiffness", scalar(Dimension::JOULE), false),
            ("rest", scalar(Dimension::NUMBER), false),
            ("damping", scalar(Dimension::JOULE.times(Dimension::SECOND)), false),
            ("torque", scalar(Dimension::JOULE), false),
        ],
        Element::Friction => vec![
            ("along", FieldKind::Scalar(Dimension::METRE, Reach::Position), true),
            ("normal", scalar(Dimension::NEWTON), true),
            ("coefficient", scalar(Dimension::NUMBER), true),
            ("speed", FieldKind::Constant(Dimension::METRE.over(Dimension::SECOND)), true),
            ("viscous", scalar(per_metre.times(Dimension::SECOND)), false),
            ("sticks", scalar(Dimension::NUMBER), false),
            ("bristles", FieldKind::Constant(Dimension::METRE), false),
            ("damping", scalar(Dimension::SECOND.over(Dimension::METRE)), false),
        ],
        Element::Contact => vec![
            ("gap", FieldKind::Scalar(Dimension::METRE, Reach::Position), true),
            ("stiffness", scalar(per_metre), true),
            ("exponent", FieldKind::Constant(Dimension::NUMBER), false),
            ("depth", FieldKind::Constant(Dimension::METRE), false),
            ("damping", scalar(Dimension::SECOND.over(Dimension::METRE)), false),
            ("restitution", FieldKind::Constant(Dimension::NUMBER), false),
            ("simultaneous", FieldKind::Word("ordered"), false),
            ("approach", FieldKind::Constant(Dimension::METRE.over(Dimension::SECOND)), false),
            (
                "bound",
                FieldKind::Constant(Dimension::METRE.over(Dimension::SECOND).over(Dimension::SECOND)),
                false,
            ),
        ],
    }
}
