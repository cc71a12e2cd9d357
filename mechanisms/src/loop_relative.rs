//! The lecture's closed loop in relative coordinates `ψ1 ψ2 ψ3`.
//!
//! ```text
//!                        B
//!                  ψ2 .·o ψ3      ψ1: link 1 against the ground line O D
//!              L2  .·'   \        ψ2: link 2 against link 1
//!            A  .·'       \       ψ3: link 3 against link 2
//!             o'           \ L3
//!        L1  /              \
//!           / ψ1             \
//!          o──────────────────o
//!          O        OD        D
//! ```
//!
//! Each angle (rad) is that of a link against the one before, positive counter-clockwise; lengths in metres.
//! The loop closes at `D`. Rows stand in the lecture's order: the time constraint first, then the closure.
//! `sin ψ3` is zero where links 2 and 3 are in line, and keeps its sign otherwise. It is negative in the drawn
//! assembly (`side = 1`), positive in its mirror image (`side = -1`).
//!
//! Numbers: chosen here, a crank-rocker by Grashof's rule, `L1 + OD = 0.40 m < L2 + L3 = 0.45 m`.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Closed loop of three moving links in relative coordinates.
    pub mechanism LoopRelative;

    param L1: m = 100mm;
    param L2: m = 250mm;
    param L3: m = 200mm;
    param OD: m = 300mm;
    param omega: rad/s = TAU;
    param side: 1 = 1;

    coord psi1: rad = 0;
    coord psi2: rad = 0.9*side;
    coord psi3: rad = -2.0*side;

    let a = L1*unit(psi1);
    let b = a + L2*unit(psi1 + psi2);

    drive crank: psi1 == omega*t;
    constraint closure {
        L1*cos(psi1) + L2*cos(psi1 + psi2) + L3*cos(psi1 + psi2 + psi3) - OD == 0;
        L1*sin(psi1) + L2*sin(psi1 + psi2) + L3*sin(psi1 + psi2 + psi3) == 0;
    }
    branch assembly: side*sin(psi3) < 0;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = a;
    out B: [m; 2] = b;
    out D: [m; 2] = [OD, 0];
    out M: [m; 2] = (a + b)/2;

    title "Closed loop in relative coordinates";
    about "The lecture's loop of three moving links: each angle counts from the link before, the vector sum \
           of the links closes at D.";
    preset "upper assembly" "B above the ground line" { side: 1 }
    preset "lower assembly" "B below the ground line" { side: -1 }
    span turn(omega);
    draw ground O, D;
    draw link "link 1": O, A;
    draw link "link 2": A, B;
    draw link "link 3": B, D;
    draw joint O, A, B, D;
    trace "middle of link 2": M;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(LoopRelative::default());

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use super::*;
    use crate::reference::{angle_difference, one_turn};

    const L: [f64; 3] = [0.1, 0.25, 0.2];
    const OD: f64 = 0.3;

    /// Absolute angles of links 2 and 3 by the cosine rule in the triangle `A B D`; `side` as in the text.
    fn angles(theta1: f64, side: f64) -> [f64; 3] {
        let d = [OD - L[0] * theta1.cos(), -L[0] * theta1.sin()];
        let reach = d[0].hypot(d[1]);
        let at_a = ((L[1] * L[1] + reach * reach - L[2] * L[2]) / (2.0 * L[1] * reach)).acos();
        let theta2 = d[1].atan2(d[0]) + side * at_a;
        let b = [L[0] * theta1.cos() + L[1] * theta2.cos(), L[0] * theta1.sin() + L[1] * theta2.sin()];
        [theta1, theta2, (-b[1]).atan2(OD - b[0])]
    }

    /// Rates of the absolute angles from `Σ Lᵢ ωᵢ u′(θᵢ) = 0`, multiplied by the unit vectors of links 3 and 2.
    fn rates([a1, a2, a3]: [f64; 3], w1: f64) -> [f64; 3] {
        let w2 = -L[0] * w1 * (a3 - a1).sin() / (L[1] * (a3 - a2).sin());
        let w3 = -L[0] * w1 * (a2 - a1).sin() / (L[2] * (a2 - a3).sin());
        [w1, w2, w3]
    }

    /// Second derivatives in the same way, from `Σ Lᵢ (αᵢ u′(θᵢ) − ωᵢ² u(θᵢ)) = 0` with `α1 = 0`.
    fn accelerations([a1, a2, a3]: [f64; 3], [w1, w2, w3]: [f64; 3]) -> [f64; 3] {
        let e = [L[0] * w1 * w1, L[1] * w2 * w2, L[2] * w3 * w3];
        let along3 = e[0] * (a1 - a3).cos() + e[1] * (a2 - a3).cos() + e[2];
        let along2 = e[0] * (a1 - a2).cos() + e[1] + e[2] * (a3 - a2).cos();
        [0.0, along3 / (L[1] * (a3 - a2).sin()), along2 / (L[2] * (a2 - a3).sin())]
    }

    fn relative([a, b, c]: [f64; 3]) -> [f64; 3] {
        [a, b - a, c - b]
    }

    #[test]
    fn the_motion_equals_the_closed_form() {
        for (run, side) in [1.0, -1.0].into_iter().enumerate() {
            let motion = one_turn(&CARD, run, 72);
            for (step, t) in motion.time.iter().enumerate() {
                let angle = angles(TAU * t, side);
                let rate = rates(angle, TAU);
                let acceleration = accelerations(angle, rate);
                for (k, coordinate) in motion.coordinates.iter().enumerate() {
                    assert!(
                        angle_difference(coordinate.q[step], relative(angle)[k]) < 1e-12,
                        "ψ{} at {t}",
                        k + 1
                    );
                    assert!((coordinate.qd[step] - relative(rate)[k]).abs() < 1e-11, "ψ̇{} at {t}", k + 1);
                    let difference = coordinate.qdd[step] - relative(acceleration)[k];
                    assert!(difference.abs() < 1e-9, "ψ̈{} at {t}: {difference:e}", k + 1);
                }
            }
        }
    }

    #[test]
    fn the_time_constraint_stands_first() {
        let names: Vec<_> = CARD.equations().rows().iter().map(|row| row.name).collect();
        assert_eq!(names, ["crank", "closure.0", "closure.1"]);
    }
}
