//! Spring, damper and actuator on an angle → torque against it.

use super::dynamics::Action;
use super::forces_by_name::Force as Seen;
use super::masses_and_forces::Given;
use super::resolver::Resolver;
use super::springs::Turn;
use super::value::Fault;
use crate::syntax::ast::Name;

impl Resolver<'_> {
    /// A torque −(k (α − α₀) + c α̇ + τ) on the angle α.
    pub(super) fn turn(&mut self, name: &Name, full: String, given: &Given) -> Result<(), Fault> {
        let constant = ["stiffness", "rest"].iter().filter_map(|field| given.scalar(field));
        let stores = constant.into_iter().all(|id| self.model.is_constant(id));
        let Some(angle) = given.scalar("angle") else { return Err(Fault) };
        let turn = Turn {
            angle,
            stiffness: given.scalar("stiffness"),
            rest: given.scalar("rest"),
            damping: given.scalar("damping"),
            torque: given.scalar("torque"),
            stores,
        };
        self.names.seen.define(&name.text, Seen::Turn(turn));
        self.force(name, full, Action::Turn(turn));
        Ok(())
    }
}
