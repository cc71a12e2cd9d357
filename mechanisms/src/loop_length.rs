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
