//! Watt's six-bar linkage: two four-bars in series over one ternary rocker.
//!
//! ```text
//!              B                C        E
//!          .·'o\            .·'o─────────o
//!      A .'  L3 \ L4    .·' Lc    L5      \
//!       o        \  .·'  δ                 \ L6
//!   L2 /          o (ternary rocker)        \
//!     o           D                          o F
//!     O
//!     |←─── d ───→|
//!     |←─────────────────── f ──────────────→|
//! ```
//!
//! Angles absolute (rad): `θ2` crank, `θ3` coupler, `θ4` rocker's side `D B`, `θ5` second coupler, `θ6` output rocker
//! `F E`; the side `D C` of the ternary rocker stands at `θ4 − δ`. Lengths in metres, `q = [θ2 θ3 θ4 θ5 θ6]`.
//!
//! The first loop is a crank-rocker (`0.06 + 0.20 < 0.18 + 0.12`), the second one is driven by a rocker that swings
//! by 60°. `sin(θ4 − θ3)` stays above 0.77, `sin(θ6 − θ5)` above 0.79.
//!
//! Numbers: chosen here.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Watt's six-bar linkage.
    pub mechanism Watt;

    param L2: m = 0.06;
    param L3: m = 0.18;
    param L4: m = 0.12;
    param Lc: m = 0.12;
    param L5: m = 0.18;
    param L6: m = 0.13;
    param d: m = 0.20;
    param f: m = 0.40;
    param delta: rad = 40deg;
    param omega: rad/s = TAU;

    coord theta2: rad = 0;
    coord theta3: rad = 0.7;
    coord theta4: rad = 1.6;
    coord theta5: rad = 0.1;
    coord theta6: rad = 1.2;

    let c = [d, 0] + Lc*unit(theta4 - delta);

    constraint first_loop { L2*unit(theta2) + L3*unit(theta3) == [d, 0] + L4*unit(theta4); }
    constraint second_loop { c + L5*unit(theta5) == [f, 0] + L6*unit(theta6); }
    drive crank: theta2 == omega*t;
    branch first: sin(theta4 - theta3) > 0;
    branch second: sin(theta6 - theta5) > 0;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = L2*unit(theta2);
    out B: [m; 2] = [d, 0] + L4*unit(theta4);
    out C: [m; 2] = c;
    out D: [m; 2] = [d, 0];
    out E: [m; 2] = [f, 0] + L6*unit(theta6);
    out F: [m; 2] = [f, 0];
    out M: [m; 2] = c + L5/2*unit(theta5);

    title "Watt's six-bar linkage";
    about "Two four-bars in series: the rocker of the first one has three joints and drives the second one.";
    preset "one turn" "both loops in their open assembly" {}
    span turn(omega);
    draw ground O, D, F;
    draw plate ternary: D, B, C;
    draw link coupler: A, B;
    draw link crank: O, A;
    draw link "second coupler": C, E;
    draw link rocker: F, E;
    draw joint O, A, B, C, D, E, F;
    trace "middle of the second coupler": M;
    trace "output rocker": E;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(Watt::default());
