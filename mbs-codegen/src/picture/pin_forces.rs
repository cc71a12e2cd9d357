//! Outputs that are the force in a pin.

use std::collections::BTreeMap;

use super::PinForce;
use super::places::Places;
use crate::model::expression::{Id, Node};
use crate::symbolic::Unary;

/// Before: a scene without a fault. After: its outputs of two components that are the force in one pin, in the order of the text,
/// their places known. Pins that the text alone cannot place are left out.
pub fn pin_forces(places: &mut Places<'_>) -> Vec<PinForce> {
    let Some(dynamics) = &places.model.dynamics else { return Vec::new() };
    let mut components: BTreeMap<&str, Vec<(usize, usize, bool)>> = BTreeMap::new();
    let mut order = Vec::new();
    for load in &dynamics.loads {
        let (Some((name, number)), Some(found)) = (load.name.rsplit_once('.'), pin(places, load.value))
        else {
            continue;
        };
        if number == "0" {
            order.push(name);
        }
        components.entry(name).or_default().push(found);
    }
    let mut forces = Vec::new();
    for output in order {
        let Some([(pin, 0, negated), second]) = components.get(output).map(Vec::as_slice) else { continue };
        if *second != (*pin, 1, *negated) {
            continue;
        }
        let Some(pin) = dynamics.pins.get(*pin).filter(|pin| places.outside(&pin.at).is_none()) else {
            continue;
        };
        // An output that has the name of the pin is another point.
        let name = if places.is_output(&pin.name) { format!("{}'", pin.name) } else { pin.name.clone() };
        if let Ok(at) = places.point(name, &pin.at, false) {
            forces.push(PinForce { output: output.to_owned(), at });
        }
    }
    forces
}

/// The pin and the component that an expression is, and whether it is negated.
fn pin(places: &Places<'_>, id: Id) -> Option<(usize, usize, bool)> {
    match places.expressions.node(id) {
        Node::Pin(pin, component) => Some((pin, component, false)),
        Node::Unary(Unary::Negate, inner) => match places.expressions.node(inner) {
            Node::Pin(pin, component) => Some((pin, component, true)),
            _ => None,
        },
        _ => None,
    }
}
