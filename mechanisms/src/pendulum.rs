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
use mbs_workbench::erased::facade::AnyEquations;
use mbs_workbench::known_motion::{KnownCourse, KnownMotion, KnownState, parameter};

use crate::elliptic::{amplitude, quarter_period};

/// In the list of free mechanisms.
pub const CARD: Card = card!(Pendulum::default()).known_by(&KNOWN);

/// The motion by elliptic functions: sin(θ/2) = sin 45° sn(√(g/L) t − K), with θ from the lowest position.
const KNOWN: KnownMotion = KnownMotion {
    source: "closed form by elliptic functions",
    // Rounding of √(g/L) t, which grows to 31 rad.
    error: 1e-13,
    course: KnownCourse::Form(closed_form),
};

/// State at `t` (s) of a swing of 90°, in closed form by Jacobi's elliptic functions.
pub fn closed_form(pendulum: &dyn AnyEquations, t: f64) -> Option<KnownState> {
    let [length, g] = ["L", "g"].map(|name| parameter(pendulum, name));
    // Parameter of a swing of 90°.
    const M: f64 = 0.5;
    let frequency = (g / length).sqrt();
    if !frequency.is_finite() {
        return None;
    }
    let (sn, cn) = amplitude(frequency * t - quarter_period(M), M).sin_cos();
    let dn = (1.0 - M * sn * sn).sqrt();
    let (sin, cos) = (2.0 * M.sqrt() * sn * dn, 1.0 - 2.0 * M * sn * sn);
    let speed = length * 2.0 * M.sqrt() * frequency * cn;
    Some(KnownState { t, q: vec![length * sin, -length * cos], qd: vec![speed * cos, speed * sin] })
}

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
