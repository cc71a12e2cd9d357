//! The lecture's closed loop with a sliding joint: `ψ3` is a length.
//!
//! ```text
//!                          guide (link 2)
//!                      . ─'
//!            ψ3   . ─ [B]          ψ1: link 1 against the ground line O D (rad)
//!            . ─ '      \          ψ2: guide against link 1 (rad)
//!        A o'         L3 \         ψ3: from A along the guide to the slider B (m)
//!     L1  / ψ2            \
//!        / ψ1              \
//!       o───────────────────o
//!       O         OD        D
//! ```
//!
//! Link 3 turns about `D` and carries a slider `B` at right angles: it stands at `−π/2` to the guide. The guide
//! is hinged to the crank at `A`. Lengths are in metres. Rows stand in the lecture's order: the time
//! constraint first, then the closure. `∂(closure)/∂(ψ2, ψ3)` has the determinant `−ψ3`: the two assemblies are
//! those with the slider ahead of `A` (`ψ3 > 0`, drawn) and behind it.
//!
//! Numbers: chosen here. `OD − L1 = 70 mm > L3 = 30 mm`, so that the crank turns fully and `ψ3` never vanishes:
//! it stays between 63.2 mm and 167.3 mm.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Closed loop whose third coordinate is a length.
    pub mechanism LoopLength;

    param L1: m = 50mm;
    param L3: m = 30mm;
    param OD: m = 120mm;
    param omega: rad/s = TAU;

    coord psi1: rad = 0;
    coord psi2: rad = 0.4;
    coord psi3: m = 65mm;

    let a = L1*unit(psi1);
    let b = a + psi3*unit(psi1 + psi2);

    drive crank: psi1 == omega*t;
    constraint closure {
        L1*cos(psi1) + psi3*cos(psi1 + psi2) + L3*cos(psi1 + psi2 - PI/2) - OD == 0;
        L1*sin(psi1) + psi3*sin(psi1 + psi2) + L3*sin(psi1 + psi2 - PI/2) == 0;
    }
    branch ahead: psi3 > 0;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = a;
    out B: [m; 2] = b;
    out D: [m; 2] = [OD, 0];
    out G: [m; 2] = a + 180mm*unit(psi1 + psi2);
    out guide: rad = psi1 + psi2;

    title "Closed loop with a length as coordinate";
    about "The twin of the closed loop in relative coordinates: the third joint slides, its coordinate is the \
           length from the crank pin to the slider.";
    preset "slider ahead" "the slider ahead of the crank pin" {}
    span turn(omega);
    draw ground O, D;
    draw link crank: O, A;
    draw slider B along guide;
    draw link guide: A, G;
    draw link "link 3": B, D;
    draw joint O, A, B, D;
    trace "end of the guide": G;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(LoopLength::default());

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use super::*;
    use crate::reference::{angle_difference, one_turn};

    const L1: f64 = 0.05;
    const L3: f64 = 0.03;
    const OD: f64 = 0.12;

    /// A value with its first and second time derivatives.
    type Jet = [f64; 3];

    /// `ψ3` by Pythagoras in the right-angled triangle `A B D`: `ψ3² = |AD|² − L3²`.
    fn length(psi1: f64, omega: f64) -> Jet {
        let s = (L1 * L1 + OD * OD - 2.0 * L1 * OD * psi1.cos() - L3 * L3).sqrt();
        let rate = L1 * OD * omega * psi1.sin() / s;
        [s, rate, (L1 * OD * omega * omega * psi1.cos() - rate * rate) / s]
    }

    /// Direction of the line `A D`.
    fn direction(psi1: f64, omega: f64) -> Jet {
        let d = [OD - L1 * psi1.cos(), -L1 * psi1.sin()];
        let v = [L1 * omega * psi1.sin(), -L1 * omega * psi1.cos()];
        let a = [L1 * omega * omega * psi1.cos(), L1 * omega * omega * psi1.sin()];
        let square = d[0] * d[0] + d[1] * d[1];
        let rate = (d[0] * v[1] - d[1] * v[0]) / square;
        let turning = (d[0] * a[1] - d[1] * a[0]) / square;
        [d[1].atan2(d[0]), rate, turning - 2.0 * rate * (d[0] * v[0] + d[1] * v[1]) / square]
    }

    /// The guide's angle is that of `A D` plus the angle `atan(L3/ψ3)` of the triangle at `A`.
    fn guide(psi1: f64, omega: f64) -> Jet {
        let ([s, v, a], [delta, rate, turning]) = (length(psi1, omega), direction(psi1, omega));
        let square = s * s + L3 * L3;
        [
            delta + (L3 / s).atan(),
            rate - L3 * v / square,
            turning - L3 * (a * square - 2.0 * s * v * v) / (square * square),
        ]
    }

    #[test]
    fn the_motion_equals_the_closed_form() {
        let motion = one_turn(&CARD, 0, 72);
        let [_, psi2, psi3] = &motion.coordinates[..] else { unreachable!("three coordinates") };
        for (step, t) in motion.time.iter().enumerate() {
            let (s, beta) = (length(TAU * t, TAU), guide(TAU * t, TAU));
            assert!((psi3.q[step] - s[0]).abs() < 1e-13, "ψ3 at {t}");
            assert!((psi3.qd[step] - s[1]).abs() < 1e-12, "ψ̇3 at {t}");
            assert!((psi3.qdd[step] - s[2]).abs() < 1e-11, "ψ̈3 at {t}");
            assert!(angle_difference(psi2.q[step], beta[0] - TAU * t) < 1e-12, "ψ2 at {t}");
            assert!((psi2.qd[step] - (beta[1] - TAU)).abs() < 1e-11, "ψ̇2 at {t}");
            assert!((psi2.qdd[step] - beta[2]).abs() < 1e-9, "ψ̈2 at {t}");
        }
    }

    #[test]
    fn the_length_stays_within_the_documented_range() {
        let motion = one_turn(&CARD, 0, 360);
        let shortest = motion.coordinates[2].q.iter().copied().fold(f64::INFINITY, f64::min);
        let longest = motion.coordinates[2].q.iter().copied().fold(0.0, f64::max);
        assert!(
            (shortest - 0.0632).abs() < 5e-5 && (longest - 0.1673).abs() < 5e-5,
            "{shortest} … {longest}"
        );
    }
}
