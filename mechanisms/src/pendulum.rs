//! A point on a massless rod, in Cartesian coordinates.
//!
//! ```text
//!   A ────────● bob     starts level, at rest
//! ```
//!
//! Source: IFToMM benchmark A01, simple pendulum: 1 kg on 1 m, released at (−1, 0) under 9.81 m/s².

use mbs_runtime::mechanism;

use crate::drawing::Shape;
use crate::masses::boxed_masses;
use crate::registry::{FreeCard, Preset, Usual};

/// In the list of free mechanisms.
pub const CARD: FreeCard = FreeCard {
    name: "pendulum",
    title: "Pendulum in Cartesian coordinates",
    description: "A bob on a massless rod, released level: one degree of freedom in two coordinates.",
    runs: &[Preset { label: "released", description: "released level, at rest", set: &[] }],
    duration: 10.0,
    usual: Usual::Projection,
    drawing: DRAWING,
    make: boxed_masses::<Pendulum, 2, 1>,
};

mechanism! {
    /// A simple pendulum: one degree of freedom in two coordinates.
    pub mechanism Pendulum;
    /// Mass of the bob.
    param m: kg = 1;
    /// Length of the rod.
    param L: m = 1;
    /// Free fall.
    param g: m/s^2 = 9.81;
    /// Place of the bob.
    coord P: [m; 2] = [-1, 0];
    body bob { mass: m, com: P }
    gravity weight { acceleration: [0, -g] }
    constraint rod { dot(P, P) == L^2; }
    start P = [-L, 0] rate [0, 0];
    out tension: N = 2*L*lambda(rod);
    out A: [m; 2] = [0, 0];
    out bob: [m; 2] = P;
}

/// How the mechanism is drawn.
pub const DRAWING: &[Shape] = &[
    Shape::Ground { at: "A" },
    Shape::Link { points: &["A", "bob"], label: "rod" },
    Shape::Joint { at: "A" },
    Shape::Trace { of: "bob", label: "bob" },
];
