//! A point on a massless rod, in Cartesian coordinates.
//!
//! ```text
//!   A ────────● bob     starts level, at rest
//! ```
//!
//! Source: IFToMM benchmark A01, simple pendulum: 1 kg on 1 m, released at (−1, 0) under 9.81 m/s².

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

/// In the list of free mechanisms.
pub const CARD: Card = card!(Pendulum::default());

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

    title "Pendulum in Cartesian coordinates";
    about "A bob on a massless rod, released level: one degree of freedom in two coordinates.";
    preset released "released level, at rest" {}
    span 10s;
    draw ground A;
    draw link rod: A, bob;
    draw joint A;
    trace bob;
}
