//! Two points on two massless rods, in Cartesian coordinates.
//!
//! ```text
//!   O ━━━━━● P1
//!           ╲           amplitude of P1 (rad) from the vertical at the start,
//!            ● P2       P2 farther by √2: the slow one of two modes where it is small
//! ```
//!
//! Lengths in metres, masses in kg; both rods and both masses are equal.
//!
//! Closed form of small swings: φ₂ = √2 φ₁ with ω² = (2 − √2) g/L (Landau & Lifshitz, Mechanics, §23).

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

/// In the list of free mechanisms.
pub const CARD: Card = card!(DoublePendulum::default());

mechanism! {
    /// A double pendulum: two degrees of freedom in four coordinates.
    pub mechanism DoublePendulum;
    /// Mass of each point.
    param m: kg = 1;
    /// Length of each rod.
    param L: m = 1;
    /// Free fall.
    param g: m/s^2 = 9.81;
    /// Angle of the first rod against the vertical at the start.
    param amplitude: rad = 1.5;
    coord P1: [m; 2] = [0, -1];
    coord P2: [m; 2] = [0, -2];
    let from = L*[sin(amplitude), -cos(amplitude)];
    let to = from + L*[sin(sqrt(2)*amplitude), -cos(sqrt(2)*amplitude)];
    body first { mass: m, com: P1 }
    body second { mass: m, com: P2 }
    gravity weight { acceleration: [0, -g] }
    constraint rods {
        dot(P1, P1) == L^2;
        dot(P2 - P1, P2 - P1) == L^2;
    }
    start P1 = from rate [0, 0];
    start P2 = to rate [0, 0];
    out O: [m; 2] = [0, 0];
    out A: [m; 2] = P1;
    out B: [m; 2] = P2;
    out tension: [N; 2] = [2*L*lambda(rods[0]), 2*L*lambda(rods[1])];

    title "Double pendulum";
    about "Two equal points on two equal rods: a mode of small swings, and a motion that nobody predicts for \
           long.";
    preset large "from far out, at rest" { amplitude: 1.5 }
    preset small "the slow mode, at rest" { amplitude: 0.1 }
    span 6s;
    draw ground O;
    draw link "upper rod": O, A;
    draw link "lower rod": A, B;
    draw joint O, A;
    trace end: B;
}
