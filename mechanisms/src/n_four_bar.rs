//! Two four-bars in a row that share their uprights, in natural coordinates.
//!
//! ```text
//!   B0 ──── B1 ──── B2      five uniform rods of one length
//!   │       │       │       A fixed, B the coordinates
//!   A0      A1      A2
//! ```
//!
//! Source: IFToMM benchmark A02, N-four-bar mechanism with N = 2: rods of 1 m and 1 kg, upright at the start, B0 at
//! 1 m/s towards +x. With all rods in line (uprights level) Φ_q loses rank.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

/// In the list of free mechanisms.
pub const CARD: Card = card!(NFourBar::default());

mechanism! {
    /// Two parallelograms: one degree of freedom in six coordinates.
    pub mechanism NFourBar;
    const N: 1 = 2;
    /// Mass of a rod.
    param m: kg = 1;
    /// Length of a rod.
    param L: m = 1;
    /// Free fall.
    param g: m/s^2 = 9.81;
    /// Velocity of the upper ends at the start.
    param v: m/s = 1;
    /// Upper ends of the uprights.
    coord B: [m; N + 1, 2] = [[0, 1], [1, 1], [2, 1]];
    gravity weight { acceleration: [0, -g] }
    // A uniform rod is half its mass at the middle of its ends, and the rest of its energy is m |v₂ − v₁|²/24.
    for i in 0..N + 1 {
        let A = [i*L, 0];
        body upright { mass: m, com: (A + B[i])/2 }
        kinetic upright_turning = m*dot(der(B[i]), der(B[i]))/24;
        constraint uprights { dot(B[i] - A, B[i] - A) == L^2; }
    }
    for i in 0..N {
        body coupler { mass: m, com: (B[i] + B[i + 1])/2 }
        kinetic coupler_turning = m*dot(der(B[i + 1] - B[i]), der(B[i + 1] - B[i]))/24;
        constraint couplers { dot(B[i + 1] - B[i], B[i + 1] - B[i]) == L^2; }
    }
    start B = [[0, L], [L, L], [2*L, L]] rate [[v, 0], [v, 0], [v, 0]];
    out A0: [m; 2] = [0, 0];
    out A1: [m; 2] = [L, 0];
    out A2: [m; 2] = [2*L, 0];
    out B0: [m; 2] = B[0];
    out B1: [m; 2] = B[1];
    out B2: [m; 2] = B[2];

    title "Two four-bars in a row";
    about "Two parallelograms that share their uprights fall over and come up again, through positions with \
           all rods in line, where the rows lose rank.";
    preset pushed "upright at the start, pushed to the right" {}
    span 10s;
    draw ground A0, A1, A2;
    draw link "left upright": A0, B0;
    draw link "middle upright": A1, B1;
    draw link "right upright": A2, B2;
    draw link "left coupler": B0, B1;
    draw link "right coupler": B1, B2;
    draw joint A0, A1, A2, B0, B1, B2;
    trace "middle joint": B1;
}
