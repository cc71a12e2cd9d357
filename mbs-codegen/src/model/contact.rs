//! Contact → force along its gap, or row that closes.

use proc_macro2::Span;

use super::dynamics::{Action, Contact, SetValued, SetValuedForce};
use super::elaborator::Elaborator;
use super::expression::{Id, Node};
use super::forces_by_name::Force as Seen;
use super::masses_and_forces::Given;
use super::non_negative::{Least, NonNegative};
use super::resolver::Resolver;
use super::value::{Fault, Reach};
use crate::symbolic::{Binary, Unary};
use crate::syntax::ast::Name;

impl Resolver<'_> {
    /// k p₀ (p/p₀)ⁿ max(1 + d ṗ, 0) along the gap g, with the depth p = max(−g, 0): never a pull.
    ///
    /// Source: Hunt & Crossley 1975; n = 3/2 is Hertz's contact of spheres.
    pub(super) fn contact(&mut self, name: &Name, full: String, given: &Given) -> Result<(), Fault> {
        if given.value("stiffness").is_none() {
            return self.rigid_contact(name, full, given);
        }
        if given.has("simultaneous") {
            let message = format!("`{}` has a stiffness and a `simultaneous`", name.text);
            let help = "leave out one of them: a contact with `stiffness` has no impacts";
            return Err(self.fault(name.span, message, help));
        }
        let field = |field: &str| given.scalar(field).ok_or(Fault);
        let (gap, stiffness) = (field("gap")?, field("stiffness")?);
        let power = match (given.scalar("exponent"), given.scalar("depth")) {
            (None, None) => None,
            (Some(exponent), Some(depth)) => Some((exponent, depth)),
            (Some(_), None) => {
                let help = "write `depth: …`: the stiffness is force over depth there";
                return Err(self.fault(
                    name.span,
                    format!("contact `{}` has an exponent and no depth", name.text),
                    help,
                ));
            }
            (None, Some(_)) => {
                let help = "write `exponent: 1.5`, or leave out both for a force that rises with the depth";
                return Err(self.fault(
                    name.span,
                    format!("contact `{}` has a depth and no exponent", name.text),
                    help,
                ));
            }
        };
        let damping = self.damping(name, given)?;
        if self.model.expressions.is_absent(stiffness) {
            self.names.seen.define(&name.text, Seen::Contact { gap, force: stiffness, rigid: None });
            return Ok(());
        }
        let force =
            self.elaborate(Reach::Force, |work| pressing(work, gap, stiffness, (power, damping), name.span))?;
        let (bound, span) = (given.scalar("bound"), name.span);
        let dynamics = self.dynamics();
        let force_index = dynamics.forces.len();
        dynamics.contacts.push(Contact { name: full.clone(), force: force_index, gap, bound, span });
        self.names.seen.define(&name.text, Seen::Contact { gap, force, rigid: None });
        self.force(name, full, Action::Work(vec![(force, gap)]));
        Ok(())
    }

    /// A row that holds while its force pushes, and closes with an impact: a contact without stiffness.
    fn rigid_contact(&mut self, name: &Name, full: String, given: &Given) -> Result<(), Fault> {
        for field in ["exponent", "depth", "damping", "approach", "bound"] {
            if let Some(value) = given.value(field) {
                let message =
                    format!("`{field}` is of contacts with a `stiffness`, and `{}` has none", name.text);
                let help =
                    "write `stiffness: …`, or leave it out: a rigid contact has a gap and a restitution";
                return Err(self.fault(value.span, message, help));
            }
        }
        let field = |field: &str| given.scalar(field).ok_or(Fault);
        let (gap, restitution, span) = (field("gap")?, field("restitution")?, name.span);
        let index = self.dynamics().set_valued.len();
        let (force, rest) = self.elaborate(Reach::Force, |work| {
            let one = work.expressions.push(Node::Number(1.0));
            let rest = work.push_binary(Binary::Subtract, one, restitution, span)?;
            Ok::<_, Fault>((work.expressions.push(Node::Holding(index)), rest))
        })?;
        let (field, of) = ("1 - restitution", name.text.clone());
        let dynamics = self.dynamics();
        dynamics.signed.push(NonNegative { field, least: Least::Zero, of, value: rest, span });
        let law = SetValued::Contact { restitution, ordered: given.has("simultaneous") };
        dynamics.set_valued.push(SetValuedForce { name: full.clone(), along: gap, law, span });
        self.names.seen.define(&name.text, Seen::Contact { gap, force, rigid: Some(index) });
        self.force(name, full, Action::Work(vec![(force, gap)]));
        Ok(())
    }
}

fn pressing(
    work: &mut Elaborator<'_>,
    gap: Id,
    stiffness: Id,
    (power, damping): (Option<(Id, Id)>, Option<Id>),
    span: Span,
) -> Result<Id, Fault> {
    let zero = work.expressions.push(Node::Number(0.0));
    let closed = work.push_unary(Unary::Negate, gap, span)?;
    let depth = work.push_binary(Binary::Max, closed, zero, span)?;
    // (p/p₀)ⁿ and not p (p/p₀)ⁿ⁻¹, whose slope is no number at p = 0.
    let depth = match power {
        None => depth,
        Some((exponent, reference)) => {
            let ratio = work.push_binary(Binary::Divide, depth, reference, span)?;
            let rise = work.push_binary(Binary::Power, ratio, exponent, span)?;
            work.push_binary(Binary::Multiply, reference, rise, span)?
        }
    };
    let mut force = work.push_binary(Binary::Multiply, stiffness, depth, span)?;
    if let Some(damping) = damping {
        let one = work.expressions.push(Node::Number(1.0));
        let opening = work.expressions.push(Node::Rate(gap, 1));
        let share = work.push_binary(Binary::Multiply, damping, opening, span)?;
        let factor = work.push_binary(Binary::Subtract, one, share, span)?;
        let factor = work.push_binary(Binary::Max, factor, zero, span)?;
        force = work.push_binary(Binary::Multiply, force, factor, span)?;
    }
    Ok(force)
}
