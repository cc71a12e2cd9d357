//! The double parallelogram: a plate on three parallel cranks, one more than it needs.
//!
//! ```text
//!              C
//!             ╱╲           o
//!            ╱  `·.       ╱   L
//!           ╱      `·.   ╱
//!        A o───────── o B          plate A B C
//!         ╱          ╱    F
//!      L ╱        L ╱     o
//!       o ─ ─ ─ ─ ─o              ground D E F, the same triangle
//!       D          E
//! ```
//!
//! Cranks `D A`, `E B`, `F C` of one length `L`, a plate and a ground of one triangle: `B` and `E` at `d` along x, `C` and
//! `F` at `[e, h]`. Two loops, `D A B E` and `D A C F`, give four rows for the three angles that the drive leaves; they
//! agree because the triangles are equal. The plate does not turn, and every point of it moves on a circle. Since the
//! joints are not in line, one loop carries the other over its change point. A plate on two cranks would be free to turn
//! where they are in line with it.
//!
//! Lengths in metres, angles in rad, counter-clockwise: `α`, `β`, `γ` of the cranks and `ψ` of the plate, all but the
//! driven `α` dependent. `error` is what crank `E B` is longer than the others; the loops then contradict each other.
//!
//! Numbers: chosen here.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Plate on three parallel cranks: four rows for three angles, one of them redundant.
    pub mechanism DoubleParallelogram;

    param L: m = 60mm;
    param d: m = 160mm;
    param e: m = 80mm;
    param h: m = 70mm;
    param error: m = 0;
    param omega: rad/s = TAU;

    coord alpha: rad = 0.5;
    coord beta: rad = 0.5;
    coord gamma: rad = 0.5;
    coord psi: rad = 0;

    let across = [d*cos(psi), d*sin(psi)];
    let up = [e*cos(psi) - h*sin(psi), e*sin(psi) + h*cos(psi)];

    constraint first redundant { L*unit(alpha) + across == [d, 0] + (L + error)*unit(beta); }
    constraint second redundant { L*unit(alpha) + up == [e, h] + L*unit(gamma); }
    drive crank: alpha == omega*t + 0.5;
    branch level: cos(psi) > 0;

    out D: [m; 2] = [0, 0];
    out E: [m; 2] = [d, 0];
    out F: [m; 2] = [e, h];
    out A: [m; 2] = L*unit(alpha);
    out B: [m; 2] = [d, 0] + (L + error)*unit(beta);
    out C: [m; 2] = [e, h] + L*unit(gamma);

    title "Double parallelogram";
    about "A plate on three equal parallel cranks: one loop more than it needs, which takes it over the \
           change points of the other. Its rows are marked `redundant`.";
    preset "a turn" "the cranks turn at constant speed" {}
    span turn(omega);
    draw ground D, E, F;
    draw link plate: A, B, C;
    draw link crank: D, A;
    draw link E, B;
    draw link F, C;
    draw joint A, B, C, D, E, F;
    trace "plate corner": C;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(DoubleParallelogram::default());
