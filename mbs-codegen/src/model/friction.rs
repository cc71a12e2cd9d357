//! Friction laws → forces along a length.

use super::dynamics::Action;
use super::expression::Node;
use super::forces_by_name::Force as Seen;
use super::masses_and_forces::Given;
use super::resolver::Resolver;
use super::value::{Fault, Reach};
use crate::symbolic::{Binary, Unary};
use crate::syntax::ast::Name;

impl Resolver<'_> {
    /// −(μ |N| tanh(ṡ/v₀) + c ṡ) along s: Coulomb's law, smooth below the speed v₀.
    ///
    /// Source: Andersson, Söderberg & Björklund 2007, the tanh model.
    pub(super) fn friction(&mut self, name: &Name, full: String, given: &Given) -> Result<(), Fault> {
        let field = |field: &str| given.scalar(field).ok_or(Fault);
        let (along, normal) = (field("along")?, field("normal")?);
        let (coefficient, speed) = (field("coefficient")?, field("speed")?);
        let force = self.elaborate(Reach::Force, |work| {
            let span = name.span;
            let rate = work.expressions.push(Node::Rate(along, 1));
            let ratio = work.push_binary(Binary::Divide, rate, speed, span)?;
            let direction = work.push_unary(Unary::Tanh, ratio, span)?;
            let pressure = work.push_unary(Unary::Abs, normal, span)?;
            let limit = work.push_binary(Binary::Multiply, coefficient, pressure, span)?;
            let mut force = work.push_binary(Binary::Multiply, limit, direction, span)?;
            if let Some(viscous) = given.scalar("viscous") {
                let drag = work.push_binary(Binary::Multiply, viscous, rate, span)?;
                force = work.push_binary(Binary::Add, force, drag, span)?;
            }
            work.push_unary(Unary::Negate, force, span)
        })?;
        self.names.seen.define(&name.text, Seen::Friction { along, force });
        self.force(name, full, Action::Work(vec![(force, along)]));
        Ok(())
    }
}
