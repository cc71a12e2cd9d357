//! Terms of the equations of motion: bodies, forces, energies, first-order states, starts.

use proc_macro2::Span;

use super::Output;
use super::expression::Id;
use super::inertia::Inertia;
use super::non_negative::NonNegative;
use super::springs::{SpringDamper, Turn};

/// Everything of a text beyond its kinematics.
#[derive(Debug, Default)]
pub struct Dynamics {
    /// Bodies, in the order of the text.
    pub bodies: Vec<Body>,
    /// Accelerations of free fall (m/s²), which add up; of constants, inputs and the time.
    pub gravity: Vec<Vec<Id>>,
    /// Their names, with the declaring tokens.
    pub gravity_names: Vec<(String, Span)>,
    /// Joints whose forces the text may ask for, in the order of the text.
    pub pins: Vec<Pin>,
    /// Forces by name, in the order of the text.
    pub forces: Vec<Force>,
    /// Contacts, in the order of the text.
    pub contacts: Vec<Contact>,
    /// Frictions with stiction and rigid contacts, in the order of the text.
    pub set_valued: Vec<SetValuedForce>,
    /// Events, in the order of the text.
    pub events: Vec<Event>,
    /// Values that they latch, component by component.
    pub latches: Vec<Latch>,
    /// Energies that `potential` adds (J).
    pub potentials: Vec<Id>,
    /// Energies that `kinetic` adds (J).
    pub kinetics: Vec<Kinetic>,
    /// First-order states, component by component.
    pub states: Vec<FirstOrderState>,
    /// Rates of the coordinates at the start, by coordinate.
    pub rates: Vec<(usize, Id)>,
    /// Coordinates whose start the text declares, ascending.
    pub started: Vec<usize>,
    /// Outputs that use multipliers or states, component by component.
    pub loads: Vec<Output>,
    /// Values that must be at least 0, or above.
    pub signed: Vec<NonNegative>,
    /// Inertia of bodies in space.
    pub inertias: Vec<Inertia>,
}

impl Dynamics {
    /// Name of a value that events set.
    pub fn remembered(&self, slot: usize) -> Option<&str> {
        match slot.checked_sub(self.events.len()) {
            None => self.events.get(slot).map(|event| event.name.as_str()),
            Some(index) => self.latches.get(index).map(|latch| latch.name.as_str()),
        }
    }
}

/// A rigid body in a plane or in space, or a point mass.
#[derive(Debug)]
pub struct Body {
    /// Its name.
    pub name: String,
    /// Mass (kg), of parameters.
    pub mass: Id,
    /// Centre of mass (m), as many components as the space has.
    pub com: Vec<Id>,
    /// Rotation, if it has any.
    pub rotation: Option<Rotation>,
}

impl Body {
    /// Inertia and angle of a body of the plane that turns.
    pub fn in_plane(&self) -> Option<(Id, Id)> {
        match self.rotation {
            Some(Rotation::Plane { inertia, angle }) => Some((inertia, angle)),
            _ => None,
        }
    }
}

/// Inertia about the centre of mass, with the angle or the Euler parameters of the body.
#[derive(Debug)]
pub enum Rotation {
    /// About the normal of a plane.
    Plane {
        /// Moment of inertia (kg m²), of parameters.
        inertia: Id,
        /// Angle of the body.
        angle: Id,
    },
    /// About any axis.
    Space {
        /// Upper triangle of J in the axes of the body (kg m²), of parameters: row, column, entry.
        inertia: Vec<(usize, usize, Id)>,
        /// Euler parameters of the body's axes, e·e = 1.
        orientation: [Id; 4],
    },
}

/// A joint of two bodies: its force acts on one, and back on the other.
#[derive(Debug)]
pub struct Pin {
    /// Its name.
    pub name: String,
    /// The joined bodies by their index; `None` is the ground.
    pub bodies: [Option<usize>; 2],
    /// Names in the text, with the token.
    pub joined: [(String, Span); 2],
    /// Position (m).
    pub at: Vec<Id>,
}

/// A kinetic energy of the text.
#[derive(Debug)]
pub struct Kinetic {
    /// Its name.
    pub name: String,
    /// Energy (J), at most quadratic in the rates.
    pub value: Id,
    /// The declaring token.
    pub span: Span,
}

/// A force with a name.
#[derive(Debug)]
pub struct Force {
    /// Its name.
    pub name: String,
    /// Its action.
    pub action: Action,
    /// The bodies that the text names with its points: with the only one, or with its begin and its end.
    pub carriers: [Option<Carrier>; 2],
    /// The declaring token.
    pub span: Span,
}

/// A contact, whose force is zero as long as its gap is open.
#[derive(Debug)]
pub struct Contact {
    /// Its name.
    pub name: String,
    /// Index of its force among the forces.
    pub force: usize,
    /// Gap (m).
    pub gap: Id,
    /// Largest |second time derivative of the gap| while it is open (m/s²), of parameters.
    pub bound: Option<Id>,
    /// The declaring token.
    pub span: Span,
}

/// A force that is set-valued: a friction at rest, or a contact without stiffness.
#[derive(Debug)]
pub struct SetValuedForce {
    /// Its name.
    pub name: String,
    /// Length, or gap (m).
    pub along: Id,
    /// The set of its forces.
    pub law: SetValued,
    /// The declaring token.
    pub span: Span,
}

/// The set of forces of a row.
#[derive(Clone, Copy, Debug)]
pub enum SetValued {
    /// Up to a largest force (N) to both sides.
    Friction {
        /// Largest force.
        limit: Id,
    },
    /// Up to a multiple of the force of a rigid contact.
    FrictionOnContact(OnContact),
    /// Any force that pushes, with impacts of a coefficient of restitution.
    Contact {
        /// Coefficient of restitution.
        restitution: Id,
        /// `true` if its impacts are its own, one after the other with those of others.
        ordered: bool,
    },
}

/// An event, which begins where the first value of a condition exceeds the second, and ends where another condition holds.
#[derive(Debug)]
pub struct Event {
    /// Its name, with its round in a loop.
    pub name: String,
    /// Condition of its begin; none before it is resolved, or where that is faulty.
    pub begins: Option<[Id; 2]>,
    /// Condition of its end; none where it never ends.
    pub ends: Option<[Id; 2]>,
    /// The declaring token.
    pub span: Span,
}

/// A value that an event latches where it begins.
#[derive(Debug)]
pub struct Latch {
    /// Name, with its round in a loop and the component's number for arrays.
    pub name: String,
    /// Unit as written.
    pub unit: String,
    /// Its definition; none before it is resolved, or where that is faulty.
    pub value: Option<Id>,
    /// Index of the event; none before it is resolved, or where its name is faulty.
    pub event: Option<usize>,
    /// The declaring token.
    pub span: Span,
}

/// A friction on a rigid contact.
#[derive(Clone, Copy, Debug)]
pub struct OnContact {
    /// The contact by its index among the set-valued forces.
    pub contact: usize,
    /// Coefficient μ of impacts.
    pub coefficient: Id,
    /// Coefficient μ at the present speed.
    pub sliding: Id,
    /// Coefficient μₛ.
    pub sticking: Id,
}

/// The body that a point is one of: `A of rod`.
#[derive(Debug)]
pub struct Carrier {
    /// Name in the text.
    pub name: String,
    /// The body by its index; `None` is the ground.
    pub body: Option<usize>,
    /// The naming token.
    pub span: Span,
}

/// Action of a force.
#[derive(Debug)]
pub enum Action {
    /// Work on displacements: components of a force or torque, and the displacement of each.
    Work(Vec<(Id, Id)>),
    /// Rayleigh's function R (W/2): the generalized forces are −∂R/∂q̇.
    Dissipation(Id),
    /// A tension between two points.
    Line(SpringDamper),
    /// A torque against an angle.
    Turn(Turn),
}

/// A first-order state.
#[derive(Debug)]
pub struct FirstOrderState {
    /// Name, with the component's number for arrays.
    pub name: String,
    /// Unit as written.
    pub unit: String,
    /// Value at the start, of parameters; 0 where none is given.
    pub start: Option<Id>,
    /// Its rate.
    pub rate: Option<Id>,
    /// The declaring token.
    pub span: Span,
}
