//! Coordinates and outputs by their names, for values that are known beforehand; kinds of parts that a text has.

use mbs_codegen::syntax_tree::{Element, StatementKind};

use super::evaluation::{Gap, Scope, value};
use super::mechanics::is_rigid;
use super::number::Number;
use super::state::{OracleState, Quantity};
use super::tree::Placed;
use super::{Along, Oracle, components};

impl Oracle {
    /// Components of a coordinate or an output called `name`, or the one component of this name.
    ///
    /// # Errors
    /// There is none, or it cannot be evaluated.
    pub fn quantities(&self, name: &str, state: &OracleState) -> Result<Vec<Quantity>, Gap> {
        let names = self.names(state, Along::Nothing);
        let mut found = Vec::new();
        let mut take = |own: &str, shape: &[usize], items: &[Number]| {
            let is_asked = |component: &String| {
                let rest = component.strip_prefix(name);
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
            };
            let components = components(own, shape).into_iter().zip(items);
            found.extend(components.filter(|(own, _)| is_asked(own)).map(|(_, number)| Quantity {
                value: number.value.v,
                rate: number.rate.v,
                second: number.rate.b,
            }));
        };
        for (own, shape) in &self.coordinates {
            if let Some(value) = names.moving.get(own) {
                take(own, shape, &value.items);
            }
        }
        for Placed { kind, rounds } in self.placed.iter() {
            if let StatementKind::Out { name: own, value: expression, .. } = kind
                && name.split('.').next() == Some(own.text.as_str())
            {
                let found = value(expression, &Scope::of(&names, rounds))?;
                take(&own.text, &found.shape, &found.items);
            }
        }
        if found.is_empty() {
            Err(Gap(format!("`{name}`, which is no coordinate and no output")))
        } else {
            Ok(found)
        }
    }

    /// `true` with contacts, whose closing and opening end steps.
    pub fn has_contacts(&self) -> bool {
        let is =
            |placed: &Placed| matches!(&placed.kind, StatementKind::Element { kind: Element::Contact, .. });
        self.placed.iter().any(is)
    }

    /// `true` with contacts without stiffness, in whose impacts velocities jump.
    pub fn has_impacts(&self) -> bool {
        self.placed.iter().any(|placed| is_rigid(&placed.kind))
    }

    /// `true` with masses or forces.
    pub fn is_dynamic(&self) -> bool {
        let is = |placed: &Placed| {
            matches!(
                placed.kind,
                StatementKind::Element { .. } | StatementKind::Load { .. } | StatementKind::Energy { .. }
            )
        };
        self.placed.iter().any(is)
    }
}
