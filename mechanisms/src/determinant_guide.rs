//! A prismatic guide written by the lecture's determinant of three points.
//!
//! ```text
//!                            B ·
//!                    ┌───┐ .'        Ψ = | X_A Y_A 1 |
//!              C, E  │ S │'              | X_B Y_B 1 | = 0,  and the same with E in place of C
//!                    └.'─┘               | X_C Y_C 1 |
//!               A  .'   \
//!                ·'      \ L
//!          e  .   θ       \            θ: guide against the ground line O D (rad)
//!           o──────o───────┘           φ: slider against the ground line (rad)
//!           O   d  D   ψ               ψ: rocker D S against the ground line (rad)
//! ```
//!
//! A guide turns about `O` at constant `ω`; its line passes beside `O` at the distance `e`. `A` and `B` are points of
//! the guide, `C` and `E` points of the slider, one `h` behind and one `h` before its middle `S = (x, y)`. Three
//! points are in line where the determinant vanishes; two such rows leave the slider one freedom along the guide: a
//! prismatic joint. A rocker of length `L` about `D` carries the slider. Lengths in metres, `q = [θ x y φ ψ]`.
//!
//! `O` lies within the rocker's circle with its guide line (`L > d + e`): the guide turns fully. The line meets the
//! circle twice; the slider is on the forward side (`ahead`) and not turned round (`upright`).
//!
//! Numbers: chosen here. Source of the determinant: the lecture's slides on joints, "Coppia prismatica".

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Turning guide with a slider on a rocker, the prismatic joint as two determinants.
    pub mechanism DeterminantGuide;

    param d: m = 50mm;
    param L: m = 120mm;
    param e: m = 35mm;
    param h: m = 15mm;
    param omega: rad/s = TAU;

    coord theta: rad = 0;
    coord x: m = 164mm;
    coord y: m = 35mm;
    coord phi: rad = 0;
    coord psi: rad = 0.3;

    let a = rot(theta)*[0, e];
    let b = rot(theta)*[200mm, e];
    let c = [x, y] - h*unit(phi);
    let front = [x, y] + h*unit(phi);

    constraint prismatic {
        det([[a.0, a.1, 1], [b.0, b.1, 1], [c.0, c.1, 1]]) == 0;
        det([[a.0, a.1, 1], [b.0, b.1, 1], [front.0, front.1, 1]]) == 0;
    }
    constraint rocker { [x, y] == [d, 0] + L*unit(psi); }
    drive guide: theta == omega*t;
    branch ahead: dot([x, y], unit(theta)) > 0;
    branch upright: cos(phi - theta) > 0;

    out O: [m; 2] = [0, 0];
    out D: [m; 2] = [d, 0];
    out A: [m; 2] = a;
    out B: [m; 2] = b;
    out S: [m; 2] = [x, y];

    title "Prismatic guide by a determinant";
    about "A slider on a turning guide: the prismatic joint is the lecture's determinant of three points in \
           line, once for either end of the slider.";
    preset "slider ahead" "the slider on the forward side of the guide" {}
    span turn(omega);
    draw ground O, D;
    draw slider S along phi;
    draw link guide: A, B;
    draw link O, A;
    draw link rocker: D, S;
    draw joint O, D, S;
    trace slider: S;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(DeterminantGuide::default());
