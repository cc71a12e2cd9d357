//! Friction with bristles: a law with a first-order state of its own.

use super::dynamics::FirstOrderState;
use super::elaborator::Elaborator;
use super::expression::{Id, Node};
use super::friction::with_drag;
use super::masses_and_forces::Given;
use super::resolver::Resolver;
use super::value::{Fault, Reach};
use crate::symbolic::{Binary, Unary};
use crate::syntax::ast::Name;

/// Coefficient below which a sum of friction counts as none: without friction the deflection is divided by nothing.
const NO_FRICTION: f64 = 1e-30;

/// Force and deflection of a friction with bristles.
#[derive(Clone, Copy)]
pub struct Bristles {
    /// The force along s (N).
    pub force: Id,
    /// Mean deflection z (m), a state.
    pub deflection: Id,
}

impl Resolver<'_> {
    /// ż = ṡ − |ṡ| z μ/(δ g(ṡ)) and F = −(μ |N| (z/δ + d ż) + c ṡ), with g = μ + (μₛ − μ) exp(−(ṡ/v)²), or g = μ; `None` where
    /// the text gives no bristles.
    ///
    /// The deflection does not know the normal force, so a contact may open and a multiplier may be it. A μₛ below the
    /// coefficient counts as the coefficient.
    /// Source: Canudas de Wit, Olsson, Åström & Lischinsky 1995, with σ₀ = μ |N|/δ, σ₁ = d μ |N|, σ₂ = c; without μₛ Dahl 1968.
    pub(super) fn bristles(
        &mut self,
        name: &Name,
        full: &str,
        given: &Given,
        [along, normal, coefficient]: [Id; 3],
    ) -> Result<Option<Bristles>, Fault> {
        let Some(length) = given.scalar("bristles") else {
            if given.scalar("damping").is_none() {
                return Ok(None);
            }
            let message = format!("friction `{}` has a damping and no bristles", name.text);
            let help = "write `viscous: …` for a force that grows with the speed; or `bristles: …`, which the damping is of";
            return Err(self.fault(name.span, message, help));
        };
        let rise = match (given.scalar("sticks"), given.scalar("speed")) {
            (None, None) => None,
            (Some(most), Some(speed)) => Some((most, speed)),
            (Some(_), None) => {
                let message = format!("friction `{}` has bristles, `sticks` and no `speed`", name.text);
                let help = "write `speed: …`, at which the friction falls from `sticks` to `coefficient`; or leave out `sticks`";
                return Err(self.fault(name.span, message, help));
            }
            (None, Some(_)) => {
                let message = format!("friction `{}` has bristles, a speed and no `sticks`", name.text);
                let help =
                    "write `sticks: …`, from which the friction falls at that speed; or leave out `speed`";
                return Err(self.fault(name.span, message, help));
            }
        };
        let span = name.span;
        // The surfaces do not touch, so no bristle bends.
        if self.model.expressions.is_absent(normal) {
            return Ok(Some(Bristles { force: normal, deflection: normal }));
        }
        let index = self.dynamics().states.len();
        let [force, deflection, growth] = self.elaborate(Reach::Force, |work| {
            let deflection = work.expressions.push(Node::State(index));
            let rate = work.expressions.push(Node::Rate(along, 1));
            let share = work.push_binary(Binary::Divide, deflection, length, span)?;
            let growth = growth(work, [rate, share, coefficient], rise, name)?;
            let bent = match given.scalar("damping") {
                None => share,
                Some(damping) => {
                    let damped = work.push_binary(Binary::Multiply, damping, growth, span)?;
                    work.push_binary(Binary::Add, share, damped, span)?
                }
            };
            let pressure = work.push_unary(Unary::Abs, normal, span)?;
            let limit = work.push_binary(Binary::Multiply, coefficient, pressure, span)?;
            let force = work.push_binary(Binary::Multiply, limit, bent, span)?;
            let force = with_drag(work, force, rate, given, name)?;
            Ok::<_, Fault>([work.push_unary(Unary::Negate, force, span)?, deflection, growth])
        })?;
        self.dynamics().states.push(FirstOrderState {
            name: format!("{full}.deflection"),
            unit: "m".into(),
            start: None,
            rate: Some(growth),
            span,
        });
        Ok(Some(Bristles { force, deflection }))
    }
}

/// ż = ṡ − |ṡ| (z/δ) μ/g.
fn growth(
    work: &mut Elaborator<'_>,
    [rate, share, coefficient]: [Id; 3],
    rise: Option<(Id, Id)>,
    name: &Name,
) -> Result<Id, Fault> {
    let span = name.span;
    let mut share = share;
    if let Some((most, speed)) = rise {
        let most = work.push_binary(Binary::Max, most, coefficient, span)?;
        let ratio = work.push_binary(Binary::Divide, rate, speed, span)?;
        let square = work.push_binary(Binary::Multiply, ratio, ratio, span)?;
        let exponent = work.push_unary(Unary::Negate, square, span)?;
        let part = work.push_unary(Unary::Exp, exponent, span)?;
        let rise = work.push_binary(Binary::Subtract, most, coefficient, span)?;
        let rise = work.push_binary(Binary::Multiply, rise, part, span)?;
        let sliding = work.push_binary(Binary::Add, coefficient, rise, span)?;
        let none = work.expressions.push(Node::Number(NO_FRICTION));
        let sliding = work.push_binary(Binary::Max, sliding, none, span)?;
        let part = work.push_binary(Binary::Divide, coefficient, sliding, span)?;
        share = work.push_binary(Binary::Multiply, share, part, span)?;
    }
    let speed = work.push_unary(Unary::Abs, rate, span)?;
    let lost = work.push_binary(Binary::Multiply, speed, share, span)?;
    work.push_binary(Binary::Subtract, rate, lost, span)
}
