//! Forces of pins by Newton's and Euler's sums over the bodies that they join.
//!
//! The sums of each body are known: inertia less the applied forces. Pins, and the guides of bodies that the coordinates
//! hold, are the unknowns, found by least squares of all sums. These have a solution wherever the rows are regular,
//! whichever of the sums are redundant there.

mod attribution;
mod elimination;
mod force_attachment;
mod manifold;
mod places;
mod velocities;

use proc_macro2::Span;

use self::attribution::{PlaneBody, Slopes};
use self::elimination::{Column, solve};
use self::force_attachment::Points;
use self::places::{Misplaced, misplaced};
use super::acting_bodies::{Attribution, On, RowMotion, Undetermined};
use super::dynamics::Dynamics;
use super::generalized_forces::Place;
use super::lower::{Clock, PIN};
use super::sum::Sum;
use super::{Equations, Row, again};
use crate::diagnostics::Diagnostics;
use crate::model::Model;
use crate::model::dynamics::{Action, Body, Dynamics as Declared};
use crate::model::expression::Id;
use crate::symbolic::substitute::substitute;
use crate::symbolic::{Graph, Leaf, Node, NodeId, tangent};

/// Components held by the coordinates, and components held by rows.
type Guides = (Vec<(usize, usize)>, Vec<(usize, RowMotion)>);

/// Terms of the sums.
#[derive(Clone, Copy)]
pub struct Given<'a> {
    pub nodes: &'a [NodeId],
    pub clock: &'a Clock,
    /// The reference length.
    pub length: NodeId,
    pub rows: &'a [Row],
    /// Start values of the coordinates.
    pub guesses: &'a [NodeId],
}

/// Before: outputs in which leaves represent forces of pins. After: the forces replace the leaves, or the reason is
/// noted why they are unknown.
pub fn complete(g: &mut Graph, model: &Model, declared: &Declared, derived: &mut Dynamics, given: Given<'_>) {
    let asks = |g: &Graph, load: NodeId| {
        let leaf = |id: &NodeId| matches!(g.node(*id), Node::Leaf(Leaf::Given(PIN, _)));
        g.reachable([load]).iter().any(leaf)
    };
    let Some(load) = derived.loads.iter().position(|load| asks(g, *load)) else { return };
    match forces(g, model, declared, derived, given) {
        Ok((forces, attribution)) => {
            if let Some(found) = misplaced(g, (model, declared), given, &attribution) {
                derived.undetermined = message(declared, &found);
                return;
            }
            derived.attribution = Some(attribution);
            for load in &mut derived.loads {
                *load = substitute(g, *load, |leaf| match leaf {
                    Leaf::Given(PIN, index) => forces.get(index as usize).copied(),
                    _ => None,
                });
            }
        }
        Err(PinFault { span, message, help }) => {
            let span = span.or_else(|| declared.loads.get(load).map(|load| load.span));
            derived.undetermined = span.map(|span| Undetermined { span, message, help });
        }
    }
}

/// Message about a misplaced pin.
fn message(declared: &Declared, found: &Misplaced) -> Option<Undetermined> {
    let Misplaced::Off { pin, body, on_other } = *found else {
        let ([(_, span), _], name) = declared.pins.first().map(|pin| (&pin.joined, &pin.name))?;
        let message = format!("where the pin `{name}` stands cannot be judged: no position fulfils all rows");
        let help = "give the coordinates guesses near a position of the mechanism";
        return Some(Undetermined { span: *span, message, help: help.into() });
    };
    let pin = declared.pins.get(pin)?;
    let ((body, span), (other, _)) = match (&pin.joined, body) {
        ([first, second], 0) => (first, second),
        ([first, second], _) => (second, first),
    };
    let name = &pin.name;
    let message = match on_other {
        true => {
            format!("the pin `{name}` is not on `{body}`: its point moves with `{other}`, not with `{body}`")
        }
        false => format!("the pin `{name}` joins `{body}` and `{other}` where they move apart"),
    };
    let help =
        "write the point of the joint, where both bodies keep together in every motion that the rows allow";
    Some(Undetermined { span: *span, message, help: help.into() })
}

/// Before: the equations of a model. After: forces of pins that are asked for and not known are reported.
pub fn check(equations: &Equations, diagnostics: &mut Diagnostics) {
    let undetermined = equations.dynamics.as_ref().and_then(|derived| derived.undetermined.as_ref());
    if let Some(Undetermined { span, message, help }) = undetermined {
        diagnostics.report(*span, message.clone(), help.clone());
    }
}

/// Before: a resolved model. After: the body that each force and row acts on, where an output asks for the force of a pin.
pub fn attribution(model: &Model) -> Option<Attribution> {
    let asks = model.dynamics.as_ref().is_some_and(|declared| !declared.pins.is_empty());
    if asks { super::derive(model).dynamics.and_then(|derived| derived.attribution) } else { None }
}

/// Reason why the sums are unknown.
pub(super) struct PinFault {
    /// Token, if not the output that asks for a force.
    pub span: Option<Span>,
    pub message: String,
    pub help: String,
}

impl PinFault {
    fn new(message: String, help: &str) -> Self {
        PinFault { span: None, message, help: help.into() }
    }
}

/// Both components of each pin's force on its first body.
fn forces(
    g: &mut Graph,
    model: &Model,
    declared: &Declared,
    derived: &Dynamics,
    given: Given<'_>,
) -> Result<(Vec<NodeId>, Attribution), PinFault> {
    unattributable(declared)?;
    let work = Sums::new(g, model, declared, derived, given)?;
    let attribution = work.attribution(model, declared)?;
    let (columns, known) = work.system(g, declared, derived, &attribution);
    let forces = solve(g, &columns, known).into_iter().take(2 * declared.pins.len()).collect();
    Ok((forces, attribution))
}

/// Refuses energies, whose bodies the text does not name, and bodies in space, which have more sums.
fn unattributable(declared: &Declared) -> Result<(), PinFault> {
    let dissipation = declared.forces.iter().find(|force| matches!(force.action, Action::Dissipation(_)));
    let named = declared.kinetics.first().map(|kinetic| kinetic.name.as_str());
    let named = named.or(dissipation.map(|force| force.name.as_str()));
    let named = named.or(declared.potentials.first().map(|_| "a potential"));
    if let Some(name) = named {
        return Err(PinFault::new(
            format!("the forces of pins are not known: on which body `{name}` acts is not said"),
            "write what acts as `body`, `gravity`, `force`, `torque`, `tsda` or `rsda`",
        ));
    }
    match declared.bodies.iter().find(|body| body.com.len() != 2) {
        Some(body) => Err(PinFault::new(
            format!("the forces of pins are not known: `{}` is no body of the plane", body.name),
            "the sums of pins are those of plane bodies; `lambda(row)` has the force of a row",
        )),
        None => Ok(()),
    }
}

/// The functions of the position that matter, by index among those that were tried.
struct Sums<'a> {
    given: Given<'a>,
    slopes: Slopes,
    bodies: Vec<PlaneBody>,
    /// Motion that each row measures.
    rows: Vec<Option<RowMotion>>,
    acting: Vec<(usize, On)>,
    /// Nodes of centres and angles.
    frames: Vec<([NodeId; 2], Option<NodeId>)>,
}

impl<'a> Sums<'a> {
    fn new(
        g: &mut Graph,
        model: &Model,
        declared: &Declared,
        derived: &Dynamics,
        given: Given<'a>,
    ) -> Result<Self, PinFault> {
        let zero = g.constant(0.0);
        let of = |id: Id| given.nodes.get(id.index()).copied().unwrap_or(zero);
        let mut functions = Vec::new();
        let mut add = |node: NodeId| {
            functions.push(node);
            functions.len() - 1
        };
        let (mut bodies, mut frames) = (Vec::new(), Vec::new());
        for body in &declared.bodies {
            let (centre, angle) = frame(body, of, zero);
            frames.push((centre, angle));
            bodies.push(PlaneBody { centre: centre.map(&mut add), angle: angle.map(&mut add) });
        }
        let rows: Vec<usize> = given.rows.iter().map(|row| add(row.phi)).collect();
        let places: Vec<[usize; 2]> = derived
            .acting
            .iter()
            .map(|part| match part.place {
                Place::Point(point) => point.map(&mut add),
                Place::Scalar(scalar) => [add(scalar); 2],
                Place::Elsewhere => [0; 2],
            })
            .collect();
        let slopes = Slopes::of(g, &functions, model.coordinates.len());
        let joined: Vec<_> = declared.pins.iter().map(|pin| pin.bodies).collect();
        let rows = rows.into_iter().map(|row| slopes.motion_of(row, &bodies, &joined)).collect();
        let mut acting = Vec::new();
        let points = Points { slopes: &slopes, bodies: &bodies, declared, nodes: given.nodes };
        let parts: Vec<_> = derived.acting.iter().zip(places).collect();
        let able = points.attached(g, model, given, &parts);
        for ((part, place), able) in parts.into_iter().zip(&able) {
            let found = match part.place {
                Place::Point(_) => points.carrier(part, place, able)?,
                Place::Scalar(_) if slopes.is_fixed(place[0]) => Some(On::Ground),
                Place::Scalar(_) => slopes.motion_of(place[0], &bodies, &joined).map(On::Moves),
                Place::Elsewhere => None,
            };
            let Some(found) = found else {
                let name = declared.forces.get(part.force).map_or("", |force| force.name.as_str());
                return Err(PinFault::new(
                    format!("the forces of pins are not known: on which body `{name}` acts is not said"),
                    "let it act on a point of a body, or on the angle of one or between two",
                ));
            };
            acting.push((part.force, found));
        }
        Ok(Sums { given, slopes, bodies, rows, acting, frames })
    }

    /// Body of each force and drive, and the guides that hold bodies where pins do not. There are as many unknowns as
    /// sums, or the forces are indeterminate.
    fn attribution(&self, model: &Model, declared: &Declared) -> Result<Attribution, PinFault> {
        let mut driven = Vec::new();
        for (index, (row, motion)) in
            model.rows.iter().zip(&self.rows).enumerate().filter(|(_, (row, _))| row.driven)
        {
            let Some(motion) = motion else {
                return Err(PinFault::new(
                    format!(
                        "the forces of pins are not known: on which body the drive `{}` acts is not said",
                        row.name
                    ),
                    "drive the angle of a body, or a component of its centre of mass, by itself: `phi == …`, not `3*phi == …`",
                ));
            };
            driven.push((index, *motion));
        }
        let drives = driven.len();
        let mut found = Attribution { acting: self.acting.clone(), rows: driven, held: Vec::new() };
        let equations: usize = self.bodies.iter().map(|body| 2 + usize::from(body.angle.is_some())).sum();
        let freedom = model.coordinates.len().saturating_sub(model.rows.len());
        let explained = 2 * declared.pins.len() + drives + freedom;
        if explained == equations {
            return Ok(found);
        }
        let (held, guiding) = self.guides(model, declared);
        let guides = held.len() + guiding.len();
        if explained + guides == equations {
            found.held = held;
            found.rows.extend(guiding);
            return Ok(found);
        }
        Err(PinFault::new(
            format!(
                "the forces of pins are indeterminate: bodies have {equations} sums, of which {freedom} give the \
                 accelerations, for {} unknown forces and moments",
                2 * declared.pins.len() + drives + guides
            ),
            "name every joint by a `pin`, also those with `ground`; a guide holds a component of a centre of mass or an \
             angle, by a row or by how it is written",
        ))
    }

    /// Components and angles that no coordinate moves, or that a row holds, of bodies that no pin holds there.
    fn guides(&self, model: &Model, declared: &Declared) -> Guides {
        let on_ground = |body: usize| {
            declared.pins.iter().any(|pin| pin.bodies.contains(&Some(body)) && pin.bodies.contains(&None))
        };
        let mut held = Vec::new();
        for (body, frame) in self.bodies.iter().enumerate() {
            let [x, y] = frame.centre;
            for (component, function) in [Some(x), Some(y), frame.angle].into_iter().enumerate() {
                let fixed = function.is_some_and(|function| self.slopes.is_fixed(function));
                if fixed && (component == 2 || !on_ground(body)) {
                    held.push((body, component));
                }
            }
        }
        let guides = |motion: &RowMotion| match motion {
            RowMotion::Component { body, .. } => !on_ground(*body),
            RowMotion::Angle { against, .. } => against.is_none(),
        };
        let rows = model.rows.iter().zip(&self.rows).enumerate().filter(|(_, (row, _))| !row.driven);
        let rows = rows.filter_map(|(index, (_, motion))| Some((index, (*motion)?)));
        (held, rows.filter(|(_, motion)| guides(motion)).collect())
    }

    /// Columns of the unknowns and the known sums, three a body, moments over the reference length.
    fn system(
        &self,
        g: &mut Graph,
        declared: &Declared,
        derived: &Dynamics,
        attribution: &Attribution,
    ) -> (Vec<Column>, Column) {
        let mut known = self.inertia(g, declared);
        for (part, (_, on)) in derived.acting.iter().zip(&attribution.acting) {
            match (*on, part.place) {
                (On::Point(body), Place::Point(place)) => {
                    let wrench = self.wrench(g, body, place, part.value);
                    subtract(g, &mut known, body, wrench);
                }
                (On::Moves(motion), _) => self.subtract_along(g, &mut known, motion, part.value[0]),
                _ => {}
            }
        }
        for (row, motion) in &attribution.rows {
            let multiplier = g.leaf(Leaf::Multiplier(*row as u32));
            let effort = g.negate(multiplier);
            self.subtract_along(g, &mut known, *motion, effort);
        }
        let mut columns = self.pins(g, declared);
        let one = g.constant(1.0);
        let held =
            attribution.held.iter().map(|(body, component)| Column::from([(3 * body + component, one)]));
        columns.extend(held);
        let known = known.into_iter().enumerate();
        let mut known: Column = known.filter_map(|(row, sum)| Some((row, sum.0?))).collect();
        for column in columns.iter_mut().chain([&mut known]) {
            for (_, moment) in column.iter_mut().filter(|(row, _)| *row % 3 == 2) {
                *moment = g.divide(*moment, self.given.length);
            }
        }
        (columns, known)
    }

    /// m (a − g), I α of each body.
    fn inertia(&self, g: &mut Graph, declared: &Declared) -> Vec<Sum> {
        let zero = g.constant(0.0);
        let of = |id: Id| self.given.nodes.get(id.index()).copied().unwrap_or(zero);
        let mut known = Vec::new();
        for (body, (centre, angle)) in declared.bodies.iter().zip(&self.frames) {
            for (component, place) in centre.iter().enumerate() {
                let mut sum = Sum(acceleration(g, self.given.clock, *place));
                for field in &declared.gravity {
                    let fall = field.get(component).map(|fall| of(*fall));
                    sum = sum.minus(g, fall.filter(|fall| g.constant_value(*fall) != Some(0.0)));
                }
                known.push(Sum(sum.0.map(|sum| g.multiply(of(body.mass), sum))));
            }
            let turning = angle.and_then(|angle| acceleration(g, self.given.clock, angle));
            let inertia = body.in_plane().map(|(inertia, _)| of(inertia));
            known.push(Sum(turning.zip(inertia).map(|(turning, inertia)| g.multiply(inertia, turning))));
        }
        known
    }

    /// Force and moment about the centre of mass.
    fn wrench(
        &self,
        g: &mut Graph,
        body: usize,
        [x, y]: [NodeId; 2],
        [force_x, force_y]: [NodeId; 2],
    ) -> [Option<NodeId>; 3] {
        let Some(([centre_x, centre_y], angle)) = self.frames.get(body).copied() else { return [None; 3] };
        let moment = angle.map(|_| {
            let (arm_x, arm_y) = (g.subtract(x, centre_x), g.subtract(y, centre_y));
            let (right, left) = (g.multiply(arm_x, force_y), g.multiply(arm_y, force_x));
            g.subtract(right, left)
        });
        [Some(force_x), Some(force_y), moment]
    }

    /// Subtracts the forces and moments on the bodies due to a force or torque `value` along a motion.
    fn subtract_along(&self, g: &mut Graph, known: &mut [Sum], motion: RowMotion, value: NodeId) {
        let signed = |g: &mut Graph, sign: f64| if sign < 0.0 { g.negate(value) } else { value };
        match motion {
            RowMotion::Angle { body, against, sign } => {
                let (on, back) = (signed(g, sign), signed(g, -sign));
                subtract(g, known, body, [None, None, Some(on)]);
                if let Some(against) = against {
                    subtract(g, known, against, [None, None, Some(back)]);
                }
            }
            RowMotion::Component { body, component, sign } => {
                let on = Some(signed(g, sign));
                let parts = if component == 0 { [on, None, None] } else { [None, on, None] };
                subtract(g, known, body, parts);
            }
        }
    }

    /// A unit force along x and one along y of each pin, on its first body and back on its second.
    fn pins(&self, g: &mut Graph, declared: &Declared) -> Vec<Column> {
        let (zero, one) = (g.constant(0.0), g.constant(1.0));
        let mut columns = Vec::new();
        for pin in &declared.pins {
            let at = |index: usize| pin.at.get(index).and_then(|id| self.given.nodes.get(id.index()));
            let place = [at(0).copied().unwrap_or(zero), at(1).copied().unwrap_or(zero)];
            for direction in [[one, zero], [zero, one]] {
                let mut column = Column::new();
                for (body, back) in pin.bodies.iter().zip([false, true]) {
                    let Some(body) = *body else { continue };
                    for (component, entry) in self.wrench(g, body, place, direction).into_iter().enumerate() {
                        let Some(entry) = entry.filter(|entry| g.constant_value(*entry) != Some(0.0)) else {
                            continue;
                        };
                        let entry = if back { g.negate(entry) } else { entry };
                        column.insert(3 * body + component, entry);
                    }
                }
                columns.push(column);
            }
        }
        columns
    }
}

/// Centre and angle of a plane body.
pub fn frame(body: &Body, of: impl Fn(Id) -> NodeId, zero: NodeId) -> ([NodeId; 2], Option<NodeId>) {
    let component = |index: usize| body.com.get(index).map_or(zero, |id| of(*id));
    ([component(0), component(1)], body.in_plane().map(|(_, angle)| of(angle)))
}

fn acceleration(g: &mut Graph, clock: &Clock, place: NodeId) -> Option<NodeId> {
    let velocity = tangent(g, &[place], |g, leaf| clock.total(g, leaf, true));
    again(g, &velocity, |g, leaf| clock.total(g, leaf, true)).pop().flatten()
}

fn subtract(g: &mut Graph, known: &mut [Sum], body: usize, wrench: [Option<NodeId>; 3]) {
    for (sum, part) in known.iter_mut().skip(3 * body).zip(wrench) {
        *sum = sum.minus(g, part);
    }
}
