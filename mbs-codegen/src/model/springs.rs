//! Springs, dampers and actuators on lengths and angles.

use super::expression::Id;

/// Spring, damper and actuator between two points: tension k (l − l₀) + c l̇ + f.
///
/// At zero length there is no direction: k (P − Q) is exact there; the terms of l₀, c and f vanish.
#[derive(Clone, Debug)]
pub struct SpringDamper {
    /// Start point (m).
    pub from: Vec<Id>,
    /// End point (m).
    pub to: Vec<Id>,
    /// k (N/m)
    pub stiffness: Option<Id>,
    /// l₀ (m)
    pub length: Option<Id>,
    /// c (N s/m)
    pub damping: Option<Id>,
    /// f (N), pulls the points together where positive.
    pub actuator: Option<Id>,
    /// `true` if the spring stores energy: k and l₀ are of parameters alone.
    pub stores: bool,
}

/// Spring, damper and actuator on an angle: −(k (α − α₀) + c α̇ + τ).
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// α
    pub angle: Id,
    /// k (N m)
    pub stiffness: Option<Id>,
    /// α₀
    pub rest: Option<Id>,
    /// c (N m s)
    pub damping: Option<Id>,
    /// τ (N m), turns back where positive.
    pub torque: Option<Id>,
    /// `true` if the spring stores energy: k and α₀ are of parameters alone.
    pub stores: bool,
}
