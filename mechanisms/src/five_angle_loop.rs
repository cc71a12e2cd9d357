//! The lecture's first closed figure: one loop, five moving angles, three of them driven.
//!
//! ```text
//!               B     θ4     C        θ5
//!               o────────────o────────────────o E
//!              /      L4           L5          \
//!          L3 /                                 \ L6
//!            / θ3                                \ θ6
//!      A .──o                                     \
//!     .─'  L2                                      \
//!    o──────────────────────────────────────────────o
//!    O  θ2               L1                         D
//! ```
//!
//! Every angle is absolute (rad, from the ground line `O D`) and points along the way round the loop, from `O` to
//! `D`; lengths are in metres. `qᵢ = [θ2 θ3 θ4]` are independent, each with its time constraint;
//! `q_d = [θ5 θ6]` follow from the two rows of the closure. `θ2` turns, `θ3` and `θ4` swing.
//!
//! The distance from `C` to `D` stays between 0.197 m and 0.407 m; `L6 − L5 = 0.02 m` and `L5 + L6 = 0.46 m` lie
//! outside of it, so that links 5 and 6 are never in line: `sin(θ6 − θ5)` keeps its sign, negative with `E` above.
//!
//! Numbers: chosen here; the lecture's figure gives none.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// One loop with five moving angles, three of them driven.
    pub mechanism FiveAngleLoop;

    param L1: m = 0.40;
    param L2: m = 0.06;
    param L3: m = 0.18;
    param L4: m = 0.12;
    param L5: m = 0.22;
    param L6: m = 0.24;
    param omega: rad/s = TAU;
    param side: 1 = 1;

    coord theta2: rad = 0;
    coord theta3: rad = 70deg;
    coord theta4: rad = 0;
    coord theta5: rad = 66deg*side - 44deg;
    coord theta6: rad = -57deg*side - 44deg;

    let a = L2*unit(theta2);
    let b = a + L3*unit(theta3);
    let c = b + L4*unit(theta4);

    constraint closure {
        L2*cos(theta2) + L3*cos(theta3) + L4*cos(theta4) + L5*cos(theta5) + L6*cos(theta6) == L1;
        L2*sin(theta2) + L3*sin(theta3) + L4*sin(theta4) + L5*sin(theta5) + L6*sin(theta6) == 0;
    }
    drive turn: theta2 == omega*t;
    drive swing: theta3 == 70deg + 0.25rad*sin(omega*t);
    drive nod: theta4 == 10deg - 0.3rad*cos(2*omega*t);
    branch assembly: side*sin(theta5 - theta6) > 0;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = a;
    out B: [m; 2] = b;
    out C: [m; 2] = c;
    out E: [m; 2] = c + L5*unit(theta5);
    out D: [m; 2] = [L1, 0];

    title "One loop, five moving angles";
    about "The lecture's first closed figure: three angles are driven, the two others follow from the closure \
           of the loop.";
    preset "upper assembly" "E above the line C D" { side: 1 }
    preset "lower assembly" "E below the line C D" { side: -1 }
    span turn(omega);
    draw ground O, D;
    draw link "link 3": A, B;
    draw link "link 2": O, A;
    draw link "link 4": B, C;
    draw link "link 5": C, E;
    draw link "link 6": E, D;
    draw joint O, A, B, C, E, D;
    trace "end of the driven links": C;
    trace "dependent joint": E;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(FiveAngleLoop::default());
