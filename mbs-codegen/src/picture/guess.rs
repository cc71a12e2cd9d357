//! A plain picture of a text without drawing statements: bodies between their pins, springs, else the vector outputs.

use std::collections::BTreeSet;

use super::draw::diagonal;
use super::places::{COM, Places, lines};
use super::shape::Shape;
use crate::model::dynamics::Dynamics;
use crate::model::expression::Id;

/// A point, and `true` if it is fixed.
struct Spot {
    name: String,
    is_fixed: bool,
}

/// Before: a scene whose text draws no shape. After: its picture, guessed; points that the text cannot evaluate are left out.
pub fn guess(places: &mut Places<'_>) -> Vec<Shape> {
    let model = places.model;
    let mut shapes = Vec::new();
    match &model.dynamics {
        Some(dynamics) if !dynamics.pins.is_empty() => bodies(places, dynamics, &mut shapes),
        dynamics => {
            let drawn = outputs(places, &mut shapes);
            if let Some(dynamics) = dynamics.as_ref().filter(|_| !drawn) {
                masses(places, dynamics, &mut shapes);
            }
        }
    }
    if let Some(dynamics) = &model.dynamics {
        springs(places, dynamics, &mut shapes);
    }
    in_one_space(places, shapes)
}

/// Bodies as links or plates between their pins; a body of one pin reaches to its centre of mass.
fn bodies(places: &mut Places<'_>, dynamics: &Dynamics, shapes: &mut Vec<Shape>) {
    let pins: Vec<Option<String>> =
        dynamics.pins.iter().map(|pin| point(places, pin.name.clone(), &pin.at)).collect();
    for (pin, name) in dynamics.pins.iter().zip(&pins) {
        if let Some(name) = name.as_ref().filter(|_| pin.bodies.contains(&None)) {
            shapes.push(Shape::Ground { at: name.clone() });
        }
    }
    for (index, body) in dynamics.bodies.iter().enumerate() {
        let of_body = dynamics.pins.iter().zip(&pins).filter(|(pin, _)| pin.bodies.contains(&Some(index)));
        let mut points: Vec<String> = of_body.filter_map(|(_, name)| name.clone()).collect();
        if points.len() < 2 {
            points.extend(point(places, format!("{}.{COM}", body.name), &body.com));
        }
        let label = body.name.clone();
        match points.as_slice() {
            [] => {}
            [at] => shapes.push(Shape::Joint { at: at.clone() }),
            [_, _] => shapes.push(Shape::Link { points, label }),
            _ => shapes.push(Shape::Plate { points, label }),
        }
    }
    shapes.extend(pins.into_iter().flatten().map(|at| Shape::Joint { at }));
}

/// Vector outputs as joints, each linked to the next one; fixed ones are supports. Returns `true` if there are any.
fn outputs(places: &mut Places<'_>, shapes: &mut Vec<Shape>) -> bool {
    let spots = vectors(places);
    for spot in spots.iter().filter(|spot| spot.is_fixed) {
        shapes.push(Shape::Ground { at: spot.name.clone() });
    }
    for (one, next) in spots.iter().zip(spots.iter().skip(1)) {
        if !(one.is_fixed && next.is_fixed) {
            let points = vec![one.name.clone(), next.name.clone()];
            shapes.push(Shape::Link { points, label: format!("{}–{}", one.name, next.name) });
        }
    }
    shapes.extend(spots.iter().map(|spot| Shape::Joint { at: spot.name.clone() }));
    !spots.is_empty()
}

/// Outputs of two or three components in metres, rows of arrays each by itself.
fn vectors(places: &mut Places<'_>) -> Vec<Spot> {
    let model = places.model;
    let outputs = model.outputs.as_slice();
    let base = |name: &str| name.rsplit_once('.').map(|(base, _)| base.to_owned());
    let (mut spots, mut next) = (Vec::new(), 0);
    while let Some(first) = outputs.get(next) {
        let Some(name) = base(&first.name) else {
            next += 1;
            continue;
        };
        let rest = outputs.get(next..).unwrap_or_default();
        let components: Vec<Id> = rest
            .iter()
            .take_while(|output| base(&output.name).as_deref() == Some(&name))
            .map(|output| output.value)
            .collect();
        next += components.len().max(1);
        if first.unit == "m" && matches!(components.len(), 2 | 3) {
            let is_fixed = components.iter().all(|id| model.is_constant(*id));
            let name = places.point(name, &components, true).ok();
            spots.extend(name.map(|name| Spot { name, is_fixed }));
        }
    }
    spots
}

/// Bodies without pins as points.
fn masses(places: &mut Places<'_>, dynamics: &Dynamics, shapes: &mut Vec<Shape>) {
    for body in &dynamics.bodies {
        let com = point(places, format!("{}.{COM}", body.name), &body.com);
        shapes.extend(com.map(|at| Shape::Joint { at }));
    }
}

fn springs(places: &mut Places<'_>, dynamics: &Dynamics, shapes: &mut Vec<Shape>) {
    for (name, from, to) in lines(dynamics) {
        let ends = [("from", from), ("to", to)].map(|(end, at)| point(places, format!("{name}.{end}"), at));
        if let [Some(from), Some(to)] = ends {
            shapes.push(Shape::Spring { points: [from, to], label: name.to_owned() });
        }
    }
}

/// A point of the text that can be evaluated without the mechanism.
fn point(places: &mut Places<'_>, name: String, at: &[Id]) -> Option<String> {
    if places.outside(at).is_none() { places.point(name, at, false).ok() } else { None }
}

/// Points of a plane and in space are not drawn together: where any is in space those are.
fn in_one_space(places: &Places<'_>, shapes: Vec<Shape>) -> Vec<Shape> {
    let spatial = places.known.iter().filter(|known| known.ids.len() == 3);
    let spatial: BTreeSet<&str> = spatial.map(|known| known.place.name.as_str()).collect();
    let is_spatial = |name: &str| spatial.contains(name);
    if !shapes.iter().flat_map(Shape::points).any(&is_spatial) {
        return shapes;
    }
    let spatial = shapes.into_iter().filter(|shape| shape.points().into_iter().all(&is_spatial));
    std::iter::once(diagonal(String::new())).chain(spatial).collect()
}
