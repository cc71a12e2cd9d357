//! Peaucellier's linkage: a joint that moves on an exact straight line.
//!
//! ```text
//!                   A                    |
//!              L .·' ╲ c              c  |
//!            .·'      ╲             .·'  |  S
//!       O  o──────o────o P · · · · · · · o
//!            `·.  Q   ╱             `·.  |
//!              L `·. ╱ c              c  |
//!                   B                    |
//! ```
//!
//! Links of length `L` from `O` to `A` and `B`, a rhombus of side `c` through `A`, `P`, `B`, `S`, and a crank `Q P` of
//! the length `k` of the ground link `O Q`. `P` moves on a circle through `O`; since `|OP| |OS| = L² − c²`, the joint
//! `S` is its inverse in a circle about `O` and moves on the line `x = (L² − c²)/(2 k)`.
//!
//! Lengths in metres, `θ` in rad: the crank `Q P` against the x axis, swinging by `swing` to either side.
//! `q = [θ a b s]` with the points `A`, `B`, `S` as natural coordinates. The rhombus is never flat: `|OP|` stays
//! between 87 mm and 100 mm, above `L − c = 70 mm` and below `L + c`. The branches: `A` on the left of `O P`, `B` on
//! its right, `S` beyond the line `A B`.
//!
//! Numbers: chosen here. Source: Peaucellier 1864, as in Kempe, How to Draw a Straight Line, 1877.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Peaucellier's straight-line linkage.
    pub mechanism Peaucellier;

    param k: m = 50mm;
    param L: m = 150mm;
    param c: m = 80mm;
    param swing: rad = 60deg;
    param omega: rad/s = TAU;

    coord theta: rad = 0;
    coord a: [m; 2] = [130mm, 75mm];
    coord b: [m; 2] = [130mm, -75mm];
    coord s: [m; 2] = [160mm, 0];

    let p = [k, 0] + k*unit(theta);

    constraint arms { dot(a, a) == L^2; dot(b, b) == L^2; }
    constraint inner { dot(a - p, a - p) == c^2; dot(b - p, b - p) == c^2; }
    constraint outer { dot(s - a, s - a) == c^2; dot(s - b, s - b) == c^2; }
    drive crank: theta == swing*sin(omega*t);
    branch left: cross(p, a) > 0;
    branch right: cross(p, b) < 0;
    branch beyond: cross(b - a, s - a) > 0;

    out O: [m; 2] = [0, 0];
    out Q: [m; 2] = [k, 0];
    out P: [m; 2] = p;
    out A: [m; 2] = a;
    out B: [m; 2] = b;
    out S: [m; 2] = s;

    title "Peaucellier's straight line";
    about "A rhombus on two arms inverts a circle through the fixed joint into a line: the first linkage that \
           draws an exact straight line.";
    preset "to and fro" "the crank swings by 60° to either side" {}
    span turn(omega);
    draw ground O, Q;
    draw link arm: O, A;
    draw link O, B;
    draw link rhombus: A, P;
    draw link B, P;
    draw link A, S;
    draw link B, S;
    draw link crank: Q, P;
    draw joint O, Q, P, A, B, S;
    trace "straight line": S;
    trace "circle through O": P;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(Peaucellier::default());
