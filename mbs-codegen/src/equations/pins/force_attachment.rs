//! The body that a force acts on at a point.
//!
//! A point of a joint belongs to both bodies, and no motion shows which of them carries a force there. The text names it,
//! `on P of rod`, where a point belongs to several bodies.

use super::attribution::{PlaneBody, Slopes};
use super::velocities::{Here, Motions, Seen};
use super::{Given, On, PinFault};
use crate::equations::generalized_forces::{Acting, Place};
use crate::model::Model;
use crate::model::dynamics::{Action, Dynamics as Declared};
use crate::symbolic::{Graph, NodeId};

/// Bodies by their index; `None` is the ground.
pub type Able = Vec<Option<usize>>;

/// Points, and the bodies that may carry them.
pub struct Points<'a> {
    pub slopes: &'a Slopes,
    pub bodies: &'a [PlaneBody],
    pub declared: &'a Declared,
    /// Node of each expression.
    pub nodes: &'a [NodeId],
}

impl Points<'_> {
    /// Before: parts of forces, and the functions of their places. After: the bodies that the point of each belongs to, as it is
    /// written. If there is none, or not the one that the text names, motion decides. Then they are the bodies with which the
    /// point moves in every motion that the rows without the drives allow.
    pub fn attached(
        &self,
        g: &mut Graph,
        model: &Model,
        given: Given<'_>,
        parts: &[(&Acting, [usize; 2])],
    ) -> Vec<Able> {
        let mut all = Vec::new();
        let (mut unknown, mut points) = (Vec::new(), Vec::new());
        for (index, (part, place)) in parts.iter().enumerate() {
            let Place::Point(point) = part.place else {
                all.push(Able::new());
                continue;
            };
            let able = self.as_written(point, *place);
            let said =
                self.declared.forces.get(part.force).and_then(|force| force.carriers.get(part.end)?.as_ref());
            let known = said.map_or(!able.is_empty(), |said| able.contains(&said.body));
            if !known && !self.slopes.is_fixed_point(*place) {
                unknown.push(index);
                points.push(point);
            }
            all.push(able);
        }
        if !points.is_empty() {
            let seen = moving_with(g, (model, self.declared), given, &points);
            for (index, seen) in unknown.into_iter().zip(seen) {
                if let Some(able) = all.get_mut(index) {
                    able.extend(seen);
                }
            }
        }
        all
    }

    /// Carrier of the point where a part of a force acts. It is the body that the text names, the ground where nothing moves
    /// the point, or the one `able` body. `None` where no body carries it. `place` has the indices of its components.
    pub fn carrier(&self, part: &Acting, place: [usize; 2], able: &Able) -> Result<Option<On>, PinFault> {
        let Some(force) = self.declared.forces.get(part.force) else { return Ok(None) };
        let stands = self.slopes.is_fixed_point(place);
        if let Some(said) = force.carriers.get(part.end).and_then(Option::as_ref) {
            return match said.body {
                _ if able.contains(&said.body) || (said.body.is_none() && stands) => Ok(Some(on(said.body))),
                _ => Err(PinFault {
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
                Err(PinFault {
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
    fn as_written(&self, point: [NodeId; 2], place: [usize; 2]) -> Able {
        let carrying = self.bodies.iter().enumerate().filter(|(_, body)| self.slopes.carries(body, place));
        let mut able: Able = carrying.map(|(body, _)| Some(body)).collect();
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

/// For each point, the bodies with which it moves at all evaluated positions; none where the rows leave no motion.
fn moving_with(
    g: &mut Graph,
    (model, declared): (&Model, &Declared),
    given: Given<'_>,
    points: &[[NodeId; 2]],
) -> Vec<Able> {
    let driven = |row: usize| model.rows.get(row).is_some_and(|row| row.driven);
    let motions = Motions::of(g, (model, declared), given, points, |row| !driven(row));
    let bodies = || [None].into_iter().chain((0..declared.bodies.len()).map(Some));
    let with = |here: &Here<'_>, point: usize| {
        let own = here.own(point)?;
        let mut able = Able::new();
        for body in bodies().filter(|_| here.moves()) {
            if here.same(&own, &here.carried(body, point)?) {
                able.push(body);
            }
        }
        Some(able)
    };
    let all =
        |here: &Here<'_>| (0..points.len()).map(|point| with(here, point)).collect::<Option<Vec<Able>>>();
    let both = |known: Vec<Able>, seen: Vec<Able>| {
        let both =
            |(known, seen): (Able, Able)| known.into_iter().filter(|body| seen.contains(body)).collect();
        known.into_iter().zip(seen).map(both).collect()
    };
    match motions.seen(g, all, both) {
        Seen::Somewhere(able) => able,
        Seen::Nowhere | Seen::TooLong => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    /// Report of the compiler on a text with this force.
    fn fault(text: &str, force: &str) -> Option<String> {
        crate::expand_source(&text.replace("FORCE", force)).err()
    }

    fn accepts(text: &str, force: &str) {
        assert_eq!(fault(text, force), None, "{force}");
    }

    fn refuses(text: &str, force: &str, reason: &str) {
        let fault = fault(text, force).unwrap_or_default();
        assert!(fault.contains(reason), "{force}: {fault}");
    }

    /// Two links by the places of their ends: that points are points of bodies is in the rows.
    const ENDS: &str = "pub mechanism Ends;
        coord a: [m; 2] = [0.3, 0.4];
        coord b: [m; 2] = [0.8, 0.4];
        let arm = b - a;
        body upper { mass: 1, com: a/2, inertia: 0.1, angle: atan2(a.1, a.0) }
        body lower { mass: 1, com: (a + b)/2, inertia: 0.1, angle: atan2(arm.1, arm.0) }
        constraint lengths { dot(a, a) == 500mm*500mm; dot(arm, arm) == 500mm*500mm; }
        pin shoulder: ground, upper at [0, 0];
        pin elbow: upper, lower at a;
        FORCE
        out force: [N; 2] = reaction(elbow, lower);";

    #[test]
    fn a_point_of_natural_coordinates_is_one_of_the_body_that_the_rows_tie_it_to() {
        for force in [
            "force f: [1, 2] on b;",
            "force f: [1, 2] on b of lower;",
            "force f: [1, 2] on a + (b - a)/3;",
            "force f: [1, 2] on a of upper;",
            "tsda f { from: [1m, 0], to: b of lower, stiffness: 3 }",
            "tsda f { from: a of upper, to: b, stiffness: 3 }",
        ] {
            accepts(ENDS, force);
        }
        refuses(ENDS, "force f: [1, 2] on b of upper;", "does not act on `upper`");
        refuses(ENDS, "force f: [1, 2] on a;", "a point of `upper` and of `lower`");
        refuses(ENDS, "force f: [1, 2] on 2*b;", "is not said");
    }

    /// The point of a coupler has coordinates of its own; the crank is driven.
    const COUPLER: &str = "pub mechanism Coupler;
        param L: [m; 3] = [200mm, 516mm, 500mm];
        coord p: [m; 2] = [0.26, 0.48];
        coord phi: [rad; 3] = [1, 0.57, 1.46];
        let elbow = L[0]*unit(phi[0]);
        body crank { mass: 1, com: elbow/2, inertia: 0.1, angle: phi[0] }
        body coupler { mass: 1, com: elbow + L[1]/2*unit(phi[1]), inertia: 0.1, angle: phi[1] }
        body rocker { mass: 1, com: [550mm, 0] + L[2]/2*unit(phi[2]), inertia: 0.1, angle: phi[2] }
        constraint closure { elbow + L[1]*unit(phi[1]) == [550mm, 0] + L[2]*unit(phi[2]); }
        constraint point { p == elbow + 300mm*unit(phi[1] + 30deg); }
        drive motor: phi[0] == 1 + 6*t*1rad/1s;
        pin a: ground, crank at [0, 0];
        pin b: crank, coupler at elbow;
        pin c: coupler, rocker at elbow + L[1]*unit(phi[1]);
        pin d: rocker, ground at [550mm, 0];
        FORCE
        out force: [N; 2] = reaction(b, coupler);";

    #[test]
    fn a_point_with_coordinates_of_its_own_is_one_of_the_body_that_it_moves_with() {
        accepts(COUPLER, "force f: [10, 0] on p;");
        accepts(COUPLER, "force f: [10, 0] on p of coupler;");
        refuses(COUPLER, "force f: [10, 0] on p of rocker;", "does not act on `rocker`");
    }
}
