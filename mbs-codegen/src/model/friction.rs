//! Friction laws → forces along a length.

use super::dynamics::{Action, OnContact, SetValued, SetValuedForce};
use super::elaborator::Elaborator;
use super::expression::{Id, Node};
use super::forces_by_name::Force as Seen;
use super::masses_and_forces::Given;
use super::resolver::Resolver;
use super::value::{Fault, Reach};
use crate::symbolic::{Binary, Unary};
use crate::syntax::ast::Name;

impl Resolver<'_> {
    /// −(μ |N| tanh(ṡ/v₀) + c ṡ) along s: Coulomb's law, smooth below the speed v₀. With `sticks` the law is set-valued.
    ///
    /// With `bristles` it has a state.
    ///
    /// Source: Andersson, Söderberg & Björklund 2007, the tanh model.
    pub(super) fn friction(&mut self, name: &Name, full: String, given: &Given) -> Result<(), Fault> {
        let field = |field: &str| given.scalar(field).ok_or(Fault);
        let (along, normal) = (field("along")?, field("normal")?);
        let coefficient = field("coefficient")?;
        let span = name.span;
        let is_absent = self.model.expressions.is_absent(normal);
        let bristles = self.bristles(name, &full, given, [along, normal, coefficient])?;
        let [force, sliding] = if is_absent {
            // What stays is viscous.
            let force = match given.scalar("viscous") {
                None => normal,
                Some(_) => self.elaborate(Reach::Force, |work| {
                    let rate = work.expressions.push(Node::Rate(along, 1));
                    let force = with_drag(work, normal, rate, given, name)?;
                    work.push_unary(Unary::Negate, force, span)
                })?,
            };
            [force; 2]
        } else if let Some(bristles) = bristles {
            [bristles.force; 2]
        } else if let Some(most) = given.scalar("sticks") {
            let index = self.dynamics().set_valued.len();
            let contact = self.rigid_contact_of(normal);
            let Law { most, limit, force, sliding, slope } = self.elaborate(Reach::Force, |work| {
                set_valued(work, (index, contact), [along, normal, coefficient, most], given, name)
            })?;
            let law = match contact {
                None => SetValued::Friction { limit },
                Some(contact) => {
                    let on = OnContact { contact, coefficient, sliding: slope, sticking: most };
                    SetValued::FrictionOnContact(on)
                }
            };
            self.dynamics().set_valued.push(SetValuedForce { name: full.clone(), along, law, span });
            [force, sliding]
        } else {
            let speed = field("speed")?;
            let force = self.elaborate(Reach::Force, |work| {
                let rate = work.expressions.push(Node::Rate(along, 1));
                let ratio = work.push_binary(Binary::Divide, rate, speed, span)?;
                let direction = work.push_unary(Unary::Tanh, ratio, span)?;
                let pressure = work.push_unary(Unary::Abs, normal, span)?;
                let limit = work.push_binary(Binary::Multiply, coefficient, pressure, span)?;
                let force = work.push_binary(Binary::Multiply, limit, direction, span)?;
                let force = with_drag(work, force, rate, given, name)?;
                work.push_unary(Unary::Negate, force, span)
            })?;
            [force; 2]
        };
        let deflection = bristles.map(|bristles| bristles.deflection);
        self.names.seen.define(&name.text, Seen::Friction { along, force, sliding, deflection });
        self.force(name, full, Action::Work(vec![(force, along)]));
        Ok(())
    }

    /// The rigid contact whose force a normal force is, by its index among the set-valued forces.
    fn rigid_contact_of(&self, normal: Id) -> Option<usize> {
        let Node::Holding(index) = self.model.expressions.node(normal) else { return None };
        let row = self.model.dynamics.as_ref()?.set_valued.get(index)?;
        matches!(row.law, SetValued::Contact { .. }).then_some(index)
    }

    /// Reports forces and rates made of a force that holds: it is what the balance with all other forces leaves, so these cannot need it.
    /// That of a rigid contact is one, but for the frictions that stick on it.
    pub(super) fn check_holding(&mut self) {
        let Some(dynamics) = self.model.dynamics.as_ref().filter(|dynamics| !dynamics.set_valued.is_empty())
        else {
            return;
        };
        let holding = |id: Id, of: &dyn Fn(&str) -> bool| {
            let other = |node| match node {
                Node::Holding(index) => {
                    dynamics.set_valued.get(index).is_some_and(|friction| of(&friction.name))
                }
                _ => false,
            };
            self.contains(id, other)
        };
        let mut faults = Vec::new();
        for force in &dynamics.forces {
            let parts: Vec<Option<Id>> = match &force.action {
                Action::Work(pairs) => pairs.iter().map(|(force, _)| Some(*force)).collect(),
                Action::Dissipation(power) => vec![Some(*power)],
                Action::Line(line) => vec![line.stiffness, line.length, line.damping, line.actuator],
                Action::Turn(turn) => vec![turn.stiffness, turn.rest, turn.damping, turn.torque],
            };
            let own = dynamics.set_valued.iter().find(|row| row.name == force.name);
            let normal = own.and_then(|row| match row.law {
                SetValued::FrictionOnContact(on) => dynamics.set_valued.get(on.contact),
                _ => None,
            });
            let other = |name: &str| name != force.name && normal.is_none_or(|normal| name != normal.name);
            if parts.into_iter().flatten().any(|part| holding(part, &other)) {
                faults.push((
                    force.span,
                    format!(
                        "`{}` needs the force of a friction that sticks, or of a rigid contact",
                        force.name
                    ),
                ));
            }
        }
        for state in &dynamics.states {
            if state.rate.is_some_and(|rate| holding(rate, &|_| true)) {
                let message = format!(
                    "the rate of `{}` needs the force of a friction that sticks, or of a rigid contact",
                    state.name
                );
                faults.push((state.span, message));
            }
        }
        for (span, message) in faults {
            let help = "outputs know the force that holds, forces and rates the `power` alone; or write `speed` in place of `sticks`, and `stiffness` in the contact; the normal force of a friction with `sticks` may be that of one rigid contact";
            self.diagnostics.report(span, message, help);
        }
    }
}

/// Adds c ṡ, where it is given.
pub(super) fn with_drag(
    work: &mut Elaborator<'_>,
    force: Id,
    rate: Id,
    given: &Given,
    name: &Name,
) -> Result<Id, Fault> {
    let Some(viscous) = given.scalar("viscous") else { return Ok(force) };
    let drag = work.push_binary(Binary::Multiply, viscous, rate, name.span)?;
    work.push_binary(Binary::Add, force, drag, name.span)
}

/// A set-valued law of friction.
struct Law {
    /// μₛ.
    most: Id,
    /// The largest force μₛ |N| with which it sticks.
    limit: Id,
    /// The force h − σ μ |N| − c ṡ.
    force: Id,
    /// The same without h.
    sliding: Id,
    /// μ at the present speed.
    slope: Id,
}

/// The law of a friction with stiction: σ is the direction of sliding, h the force while it sticks. On a rigid contact N ≥ 0.
///
/// μ is the coefficient, or falls from μₛ to it as exp(−(ṡ/v)²) where a speed is given. A μₛ below the coefficient counts as
/// the coefficient.
/// Source: Bo & Pavelescu 1982, the exponential model with the exponent 2.
fn set_valued(
    work: &mut Elaborator<'_>,
    (index, contact): (usize, Option<usize>),
    [along, normal, coefficient, most]: [Id; 4],
    given: &Given,
    name: &Name,
) -> Result<Law, Fault> {
    let span = name.span;
    let rate = work.expressions.push(Node::Rate(along, 1));
    let pressure = match contact {
        Some(_) => normal,
        None => work.push_unary(Unary::Abs, normal, span)?,
    };
    let most = work.push_binary(Binary::Max, most, coefficient, span)?;
    let limit = work.push_binary(Binary::Multiply, most, pressure, span)?;
    let mut slope = coefficient;
    if let Some(speed) = given.scalar("speed") {
        let ratio = work.push_binary(Binary::Divide, rate, speed, span)?;
        let square = work.push_binary(Binary::Multiply, ratio, ratio, span)?;
        let exponent = work.push_unary(Unary::Negate, square, span)?;
        let share = work.push_unary(Unary::Exp, exponent, span)?;
        let rise = work.push_binary(Binary::Subtract, most, coefficient, span)?;
        let rise = work.push_binary(Binary::Multiply, rise, share, span)?;
        slope = work.push_binary(Binary::Add, coefficient, rise, span)?;
    }
    let resistance = work.push_binary(Binary::Multiply, slope, pressure, span)?;
    let direction = work.expressions.push(Node::Sliding(index));
    let force = work.push_binary(Binary::Multiply, resistance, direction, span)?;
    let force = with_drag(work, force, rate, given, name)?;
    let sliding = work.push_unary(Unary::Negate, force, span)?;
    let holding = work.expressions.push(Node::Holding(index));
    let force = work.push_binary(Binary::Subtract, holding, force, span)?;
    Ok(Law { most, limit, force, sliding, slope })
}
