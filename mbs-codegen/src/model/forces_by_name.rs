//! Forces that a text declares, by their names.

use std::collections::{BTreeMap, BTreeSet};

use super::expression::Id;
use super::springs::{SpringDamper, Turn};
use super::value::Value;

/// Forces by their names.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// Names of `let`s that refer to forces.
    pub late: BTreeSet<String>,
    /// Statements that have a name without a value.
    pub(super) declared: BTreeMap<String, Declared>,
    /// Forces that are resolved so far, one a round of a loop.
    pub(super) known: BTreeMap<String, Vec<Force>>,
}

/// A statement that has a name without a value.
#[derive(Clone, Copy, Debug)]
pub struct Declared {
    /// The word that it begins with.
    pub(super) word: &'static str,
    /// `true` if it stands in a loop.
    pub(super) repeated: bool,
}

/// A force as expressions see it.
#[derive(Clone, Debug)]
pub enum Force {
    /// A tension.
    Line(SpringDamper),
    /// A torque against an angle.
    Turn(Turn),
    /// A force along a length; `sliding` is the same without what holds at zero speed, which has no power. `deflection`
    /// is the state of bristles, where it has any.
    Friction { along: Id, force: Id, sliding: Id, deflection: Option<Id> },
    /// A force along a gap; `rigid` is the index of a rigid one among the set-valued forces.
    Contact { gap: Id, force: Id, rigid: Option<usize> },
    /// A force or torque as written, and its components with the displacement of each.
    Load { value: Value, pairs: Vec<(Id, Id)> },
}

impl Seen {
    /// Adds a force to those of its name; a loop declares several.
    pub fn define(&mut self, name: &str, force: Force) {
        self.known.entry(name.to_owned()).or_default().push(force);
    }
}
