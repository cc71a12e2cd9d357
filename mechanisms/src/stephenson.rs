//! A Stephenson six-bar driven off its four-bar loop: four unknowns that no chain of triangles solves.
//!
//! ```text
//!                      A ─────────── B          θ: crank F E        α: O A
//!      E              ╱ `·.     .·'   ╲         δ: rod E P          β: coupler A B
//!      o─────────────╱─────`o·'        ╲                            γ: D B
//!   r ╱       l     ╱        P          ╲
//!    o          La ╱                     ╲ Ld
//!    F            ╱                       ╲
//!                o ────────── d ────────── o
//!                O                         D
//! ```
//!
//! All angles absolute (rad), lengths in metres, `q = [θ α β γ δ]`. The point `P` stands on the coupler `A B`, `m` along
//! and `n` across to the right. The crank `F E` is none of the four bars of the loop `O A B D`. Neither the loop nor the
//! chain `F E P` can be closed alone, so the four angles `α β γ δ` make one block. (Driven at `O A` the same linkage is
//! two triangles, one after the other.)
//!
//! For every `θ` there is one assembly with `sin(γ − β) > 0` (drawn) and one with `< 0`, as a scan of `α` over the
//! circle shows. During a turn `sin(γ − β)` stays above 0.80. The distance `E P`, as a function of `α` in the
//! four-bar, keeps a slope between −0.36 m and −0.29 m: no singular position.
//!
//! Numbers: chosen here.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Stephenson's six-bar linkage driven off its four-bar loop.
    pub mechanism Stephenson;

    param d: m = 0.30;
    param La: m = 0.25;
    param Lb: m = 0.15;
    param Ld: m = 0.25;
    param m: m = 0.075;
    param n: m = 0.08;
    param fx: m = -0.15;
    param fy: m = 0.16;
    param r: m = 0.05;
    param l: m = 0.30;
    param omega: rad/s = TAU;

    coord theta: rad = 0;
    coord alpha: rad = 1.1;
    coord beta: rad = 0.16;
    coord gamma: rad = 1.7;
    coord delta: rad = 0;

    let pivot = [fx, fy];
    let a = La*unit(alpha);
    let p = a + rot(beta)*[m, -n];

    constraint four_bar { a + Lb*unit(beta) == [d, 0] + Ld*unit(gamma); }
    constraint rod { pivot + r*unit(theta) + l*unit(delta) == p; }
    drive crank: theta == omega*t;
    branch open: sin(gamma - beta) > 0;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = a;
    out B: [m; 2] = [d, 0] + Ld*unit(gamma);
    out D: [m; 2] = [d, 0];
    out E: [m; 2] = pivot + r*unit(theta);
    out F: [m; 2] = pivot;
    out P: [m; 2] = p;

    title "Stephenson's six-bar, driven off its loop";
    about "The crank pushes the coupler point of a four-bar: four angles are one block of equations, which no \
           construction of triangles solves one after the other.";
    preset "one turn" "the four-bar in its open assembly" {}
    span turn(omega);
    draw ground O, D, F;
    draw plate coupler: A, B, P;
    draw link rocker: O, A;
    draw link rocker: D, B;
    draw link rod: E, P;
    draw link crank: F, E;
    draw joint O, A, B, D, E, F, P;
    trace "coupler point": P;
    trace rocker: B;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(Stephenson::default());
