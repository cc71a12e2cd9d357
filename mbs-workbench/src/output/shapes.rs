//! Shapes of a picture as the report's page takes them.
//!
//! One object a shape: `kind` is the variant's name in lower case, the other members are its fields. A point is named as in the
//! text. A point whose name has an underscore (`slot_end`) helps to draw; its name does not stand beside it. A shape with an
//! empty label is a further part of the body before it and has its colour.

use mbs_codegen::picture::{Along, Shape};
use serde_json::{Value, json};

/// The shapes in their order.
pub fn shapes(shapes: &[Shape]) -> Vec<Value> {
    shapes.iter().map(shape).collect()
}

// Written here and not derived: the macro and the program share one build of `mbs-codegen`, which has no serde.
fn shape(shape: &Shape) -> Value {
    match shape {
        Shape::View { right, up, label } => {
            json!({ "kind": "view", "right": right, "up": up, "label": label })
        }
        Shape::Ground { at } => json!({ "kind": "ground", "at": at }),
        Shape::Link { points, label } => json!({ "kind": "link", "points": points, "label": label }),
        Shape::Plate { points, label } => json!({ "kind": "plate", "points": points, "label": label }),
        Shape::Slot { points, label } => json!({ "kind": "slot", "points": points, "label": label }),
        Shape::Spring { points, label } => json!({ "kind": "spring", "points": points, "label": label }),
        Shape::Joint { at } => json!({ "kind": "joint", "at": at }),
        Shape::Slider { at, along } => json!({ "kind": "slider", "at": at, "along": direction(along) }),
        Shape::Rail { at, along } => json!({ "kind": "rail", "at": at, "along": direction(along) }),
        Shape::Wheel { at, rim, label } => json!({ "kind": "wheel", "at": at, "rim": rim, "label": label }),
        Shape::Gear { at, rim, teeth, inside, label } => {
            json!({ "kind": "gear", "at": at, "rim": rim, "teeth": teeth, "inside": inside, "label": label })
        }
        Shape::Cam { at, contact, turn, label } => {
            json!({ "kind": "cam", "at": at, "contact": contact, "turn": turn, "label": label })
        }
        Shape::Face { points, back, label } => {
            json!({ "kind": "face", "points": points, "back": back, "label": label })
        }
        Shape::Geneva { at, pin, wheel, rim, slots } => {
            json!({ "kind": "geneva", "at": at, "pin": pin, "wheel": wheel, "rim": rim, "slots": slots })
        }
        Shape::Road { at, speed, label } => {
            json!({ "kind": "road", "at": at, "speed": speed, "label": label })
        }
        Shape::Trace { of, label } => json!({ "kind": "trace", "of": of, "label": label }),
    }
}

fn direction(along: &Along) -> Value {
    match along {
        Along::Fixed(direction) => json!(direction),
        Along::Named(name) => json!(name),
    }
}
