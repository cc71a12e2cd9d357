//! The open chain of three links: independent coordinates, each with its time constraint.
//!
//! ```text
//!                       B      L3
//!                      o────────────o P      θ1: link 1 against the x axis
//!                L2  .' θ3                   θ2: link 2 against link 1
//!               A  .'                        θ3: link 3 against link 2
//!              o .'
//!         L1  / θ2
//!            / θ1
//!           o────── x
//!           O
//! ```
//!
//! Angles in rad, lengths in metres. Nothing closes, so that as many coordinates as degrees of freedom suffice,
//! and each of them is a function of the time: `θ1` and `θ2` swing, `θ3` turns.
//!
//! Numbers: chosen here, an arm of 0.75 m whose end draws a closed curve once a turn of `omega`.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Open chain of three links, each joint driven.
    pub mechanism OpenChain;

    param L1: m = 0.35;
    param L2: m = 0.25;
    param L3: m = 0.15;
    param omega: rad/s = TAU;
    param swing1: rad = 0.5;
    param swing2: rad = 0.7;

    coord theta1: rad = 0.9;
    coord theta2: rad = -0.5;
    coord theta3: rad = 0;

    let a = L1*unit(theta1);
    let b = a + L2*unit(theta1 + theta2);

    drive shoulder: theta1 == 0.9rad + swing1*sin(omega*t);
    drive elbow: theta2 == swing2*cos(2*omega*t) - 0.5rad;
    drive wrist: theta3 == -omega*t;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = a;
    out B: [m; 2] = b;
    out P: [m; 2] = b + L3*unit(theta1 + theta2 + theta3);
    out speed: m/s = norm(der(b + L3*unit(theta1 + theta2 + theta3)));

    title "Open chain of three links";
    about "Independent coordinates: three joint angles, each given as a function of the time, move the end \
           point of an arm.";
    preset "one cycle" "two joints swing, the last one turns" {}
    span turn(omega);
    draw ground O;
    draw link "link 1": O, A;
    draw link "link 2": A, B;
    draw link "link 3": B, P;
    draw joint O, A, B;
    trace "end point": P;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(OpenChain::default());
