//! Coefficient of restitution → damping of a contact.

use proc_macro2::Span;

use super::elaborator::Elaborator;
use super::expression::{Id, Node};
use super::masses_and_forces::Given;
use super::non_negative::{Least, NonNegative};
use super::resolver::Resolver;
use super::value::{Fault, Reach};
use crate::symbolic::{Binary, Unary};
use crate::syntax::ast::Name;

/// Least coefficient that the damping is solved for: below it the contact is as good as plastic.
const LEAST: f64 = 1e-6;
/// Coefficient above which the series at 1 is taken: the equation has a double root there.
const SERIES: f64 = 0.99;
/// Coefficients of c in 1 − e from the first power on. The sixth power adds 1e-12 at most.
const POWERS: [f64; 5] = [1.5, 1.5, 27.0 / 20.0, 1.2, 759.0 / 700.0];
/// First estimate of c e/(1 − e) as a polynomial in e, within 1.1 per cent from 0 to [`SERIES`].
const ESTIMATE: [f64; 4] = [0.9902, 1.4484, -1.3321, 0.3903];
/// Newton's steps from there: 1e-2, 2e-5, 3e-10.
const STEPS: usize = 2;

impl Resolver<'_> {
    /// The damping d of a contact: as given, or c/v₀ with c of the restitution e; `None` where neither is given.
    ///
    /// With k p₀ (p/p₀)ⁿ (1 + d ṗ) the equation of motion is separable: v dv/(1 + d v) is the same function of the depth on the
    /// way in and out, whatever n and the mass are. So c = d v₀ fulfils c − ln(1 + c) = −e c − ln(1 − e c).
    pub(super) fn damping(&mut self, name: &Name, given: &Given) -> Result<Option<Id>, Fault> {
        let damping = given.scalar("damping");
        let (restitution, approach) = match (given.scalar("restitution"), given.scalar("approach")) {
            (None, None) => return Ok(damping),
            (Some(restitution), Some(approach)) => (restitution, approach),
            (Some(_), None) => {
                let message = format!("contact `{}` has a restitution and no approach", name.text);
                let help = "write `approach: …`, the speed at touch for which the restitution holds";
                return Err(self.fault(name.span, message, help));
            }
            (None, Some(_)) => {
                let message = format!("contact `{}` has an approach and no restitution", name.text);
                return Err(self.fault(name.span, message, "write `restitution: 0.8`, or leave out both"));
            }
        };
        if damping.is_some() {
            let message = format!("contact `{}` has a damping and a restitution", name.text);
            return Err(self.fault(
                name.span,
                message,
                "leave out one of them: the restitution gives the damping",
            ));
        }
        let span = name.span;
        let (damping, rest) = self.elaborate(Reach::Force, |work| {
            let one = work.expressions.push(Node::Number(1.0));
            let rest = work.push_binary(Binary::Subtract, one, restitution, span)?;
            let product = Work { work, span }.dimensionless(restitution)?;
            Ok::<_, Fault>((work.push_binary(Binary::Divide, product, approach, span)?, rest))
        })?;
        let (field, of) = ("1 - restitution", name.text.clone());
        self.dynamics().signed.push(NonNegative { field, least: Least::Zero, of, value: rest, span });
        Ok(Some(damping))
    }
}

struct Work<'a, 'b> {
    work: &'a mut Elaborator<'b>,
    span: Span,
}

impl Work<'_, '_> {
    fn number(&mut self, value: f64) -> Id {
        self.work.expressions.push(Node::Number(value))
    }

    fn join(&mut self, function: Binary, a: Id, b: Id) -> Result<Id, Fault> {
        self.work.push_binary(function, a, b, self.span)
    }

    /// Σ coefficientₖ xᵏ.
    fn polynomial(&mut self, coefficients: &[f64], x: Id) -> Result<Id, Fault> {
        let mut sum = self.number(0.0);
        for (place, coefficient) in coefficients.iter().rev().enumerate() {
            let term = self.number(*coefficient);
            sum = match place {
                0 => term,
                _ => {
                    let product = self.join(Binary::Multiply, sum, x)?;
                    self.join(Binary::Add, product, term)?
                }
            };
        }
        Ok(sum)
    }

    /// c of the restitution e: by Newton's method below [`SERIES`], by the series above.
    fn dimensionless(&mut self, e: Id) -> Result<Id, Fault> {
        let (zero, one) = (self.number(0.0), self.number(1.0));
        let (least, series) = (self.number(LEAST), self.number(SERIES));
        let below = self.join(Binary::Min, e, series)?;
        let below = self.join(Binary::Max, below, least)?;
        let above = self.join(Binary::Max, e, series)?;
        let solved = self.solved(below)?;
        let left = self.join(Binary::Subtract, one, above)?;
        let powers = [&[0.0][..], &POWERS].concat();
        let rest = self.polynomial(&powers, left)?;
        let joint = POWERS.iter().rev().fold(0.0, |sum, power| (sum + power) * (1.0 - SERIES));
        let joint = self.number(joint);
        let rest = self.join(Binary::Subtract, rest, joint)?;
        let sum = self.join(Binary::Add, solved, rest)?;
        self.join(Binary::Max, sum, zero)
    }

    /// c with s = (1 + e) c, the root of e (φ − 1) − 1 + φ E = 0, where E = exp(−s) and φ = s/(1 − E) = 1 + c. It comes from
    /// r = (1 + c)/(1 − e c) = exp(s): then 1 + c = s/(1 − 1/r) and 1 − e c = s/(r − 1).
    fn solved(&mut self, e: Id) -> Result<Id, Fault> {
        let one = self.number(1.0);
        let more = self.join(Binary::Add, one, e)?;
        let less = self.join(Binary::Subtract, one, e)?;
        let estimate = self.polynomial(&ESTIMATE, e)?;
        let share = self.join(Binary::Divide, less, e)?;
        let c = self.join(Binary::Multiply, share, estimate)?;
        let mut s = self.join(Binary::Multiply, more, c)?;
        for _ in 0..STEPS {
            let minus = self.work.push_unary(Unary::Negate, s, self.span)?;
            let decay = self.work.push_unary(Unary::Exp, minus, self.span)?;
            let d = self.join(Binary::Subtract, one, decay)?;
            let phi = self.join(Binary::Divide, s, d)?;
            let c = self.join(Binary::Subtract, phi, one)?;
            let product = self.join(Binary::Multiply, e, c)?;
            let residual = self.join(Binary::Subtract, product, one)?;
            let product = self.join(Binary::Multiply, phi, decay)?;
            let residual = self.join(Binary::Add, residual, product)?;
            // Its slope times d²: e (d − s E) + E (d − s).
            let product = self.join(Binary::Multiply, s, decay)?;
            let first = self.join(Binary::Subtract, d, product)?;
            let first = self.join(Binary::Multiply, e, first)?;
            let second = self.join(Binary::Subtract, d, s)?;
            let second = self.join(Binary::Multiply, decay, second)?;
            let slope = self.join(Binary::Add, first, second)?;
            let square = self.join(Binary::Multiply, d, d)?;
            let step = self.join(Binary::Multiply, residual, square)?;
            let step = self.join(Binary::Divide, step, slope)?;
            s = self.join(Binary::Subtract, s, step)?;
        }
        self.join(Binary::Divide, s, more)
    }
}
