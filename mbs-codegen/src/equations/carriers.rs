//! The body that a force acts on at a point.
//!
//! A point of a joint is one of both bodies, and which of them bears a force there is nothing that the motion could tell: the
//! text says it, `on P of rod`, where a point is one of several bodies.

use super::attribution::{Frame, Slopes};
use super::forces::Acting;
use super::pins::{Fault, On};
use crate::model::dynamics::{Action, Dynamics as Declared};
use crate::symbolic::NodeId;

/// Points, and what may carry them.
pub struct Points<'a> {
    pub slopes: &'a Slopes,
    pub bodies: &'a [Frame],
    pub declared: &'a Declared,
    /// Of each expression.
    pub nodes: &'a [NodeId],
}

impl Points<'_> {
    /// What the point of a part of a force moves with, `None` where that is no body: the body that the text names, the ground
    /// where nothing moves it, the one body that carries it. `place` has its functions.
    pub fn carrier(&self, part: &Acting, point: [NodeId; 2], place: [usize; 2]) -> Result<Option<On>, Fault> {
        let Some(force) = self.declared.forces.get(part.force) else { return Ok(None) };
        let stands = self.slopes.stands(place);
        let able = self.able(point, place);
        if let Some(said) = force.carriers.get(part.end).and_then(Option::as_ref) {
            return match said.body {
                _ if able.contains(&said.body) || (said.body.is_none() && stands) => Ok(Some(on(said.body))),
                _ => Err(Fault {
                    span: Some(said.span),
                    message: format!(
                        "`{}` does not act on `{}`: its point is none of that body",
                        force.name, said.name
                    ),
                    help: "name the body that the point moves with, or write another point".into(),
                }),
            };
        }
        match able.as_slice() {
            _ if stands => Ok(Some(On::Ground)),
            [] => Ok(None),
            [one] => Ok(Some(on(*one))),
            [first, second, ..] => {
                let [first, second] = [first, second].map(|body| self.name(*body));
                let write = match (&force.action, part.end) {
                    (Action::Line(_), 0) => "from: P of",
                    (Action::Line(_), _) => "to: P of",
                    _ => "on P of",
                };
                Err(Fault {
                    span: Some(force.span),
                    message: format!(
                        "the forces of pins are not known: `{}` acts on a point of `{first}` and of `{second}`",
                        force.name
                    ),
                    help: format!("say which one bears it: `{write} {first}` or `{write} {second}`"),
                })
            }
        }
    }

    /// The bodies that carry a point as it is written, and those of a pin that is written at the same point; `None` is the
    /// ground.
    fn able(&self, point: [NodeId; 2], place: [usize; 2]) -> Vec<Option<usize>> {
        let carrying = self.bodies.iter().enumerate().filter(|(_, body)| self.slopes.carries(body, place));
        let mut able: Vec<Option<usize>> = carrying.map(|(body, _)| Some(body)).collect();
        for pin in &self.declared.pins {
            let at = pin.at.iter().filter_map(|id| self.nodes.get(id.index()));
            if at.eq(&point) {
                able.extend(pin.bodies);
            }
        }
        able.sort_unstable();
        able.dedup();
        able
    }

    fn name(&self, body: Option<usize>) -> &str {
        body.and_then(|body| self.declared.bodies.get(body)).map_or("ground", |body| body.name.as_str())
    }
}

fn on(body: Option<usize>) -> On {
    body.map_or(On::Ground, On::Point)
}
