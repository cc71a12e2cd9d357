//! Bodies that forces and rows act on, as the forces in pins need them.

use proc_macro2::Span;

/// Body that each force and row acts on, and what holds bodies apart from pins.
#[derive(Clone, Debug)]
pub struct Attribution {
    /// One a part of a named force, with the force's index: of a tension the part at its begin, then that at its end.
    pub acting: Vec<(usize, On)>,
    /// Rows whose multipliers act on bodies: drives, and guides.
    pub rows: Vec<(usize, RowMotion)>,
    /// Bodies and components, 2 for the angle, that the coordinates hold: forces and moments unknown as pins are.
    pub held: Vec<(usize, usize)>,
}

/// Body or motion that a part of a force acts on.
#[derive(Clone, Copy, Debug)]
pub enum On {
    Ground,
    /// A point of a body.
    Point(usize),
    Moves(RowMotion),
}

/// Body motion that a scalar function of the position measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RowMotion {
    /// The angle of a body against another or the ground, times `sign`.
    Angle { body: usize, against: Option<usize>, sign: f64 },
    /// A component of the place of a body's centre of mass, times `sign`.
    Component { body: usize, component: usize, sign: f64 },
}

/// Reason why the forces of pins are unknown.
#[derive(Clone, Debug)]
pub struct Undetermined {
    /// Output that asks for one, or pin at another place than its joint.
    pub span: Span,
    pub message: String,
    pub help: String,
}
