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
