//! A quarter of a car: a body on a spring and a damper, a wheel on its tyre, a wavy road.
//!
//! ```text
//!       [ body ]      y_body: above its height at rest on a flat road
//!        ≀   ⊓        spring and damper of the suspension
//!       [ wheel ]     y_wheel
//!          ≀          tyre
//!     ~~~~~~~~~~~     road: a sin(ω t) under the wheel
//! ```
//!
//! Lengths in metres, masses in kg. The wheel never leaves the road here: the tyre is a spring both ways.
//!
//! Numbers: a quarter of a middle-class car, round. Closed form: the motion is linear, q̈ = A q + B q̇ + b sin(ω t),
//! and so the exponential of a matrix of six rows.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

/// In the list of free mechanisms.
pub const CARD: Card = card!(QuarterCar::default());

mechanism! {
    /// Quarter car: two degrees of freedom, no rows.
    pub mechanism QuarterCar;
    /// Masses of the body and of the wheel.
    param m: [kg; 2] = [300, 40];
    /// Stiffness of the suspension and of the tyre.
    param k: [N/m; 2] = [18000, 160000];
    /// Damping of the suspension.
    param c: N*s/m = 1500;
    /// Height of the waves.
    param a: m = 10mm;
    /// Their angular frequency under the wheel.
    param omega: rad/s = 7.5;
    /// Free fall.
    param g: m/s^2 = 9.81;
    const WHEEL: m = 0.35;
    const BODY: m = 0.9;
    coord y: [m; 2];
    let road = a*sin(omega*t);
    // At rest on a flat road the springs carry the weights.
    let tyre = WHEEL + (m[0] + m[1])*g/k[1];
    let suspension = BODY - WHEEL + m[0]*g/k[0];
    let body_centre = [0, BODY + y[0]];
    let wheel_centre = [0, WHEEL + y[1]];
    let patch = [0, road];
    body chassis { mass: m[0], com: body_centre }
    body wheel { mass: m[1], com: wheel_centre }
    gravity weight { acceleration: [0, -g] }
    tsda strut { from: wheel_centre, to: body_centre, stiffness: k[0], length: suspension, damping: c }
    tsda rubber { from: patch, to: wheel_centre, stiffness: k[1], length: tyre }
    start y = [0, 0] rate [0, 0];
    out chassis_centre: [m; 2] = body_centre;
    out hub: [m; 2] = wheel_centre;
    out contact: [m; 2] = patch;
    out load_change: N = k[1]*(road - y[1]);

    title "Quarter car on a wavy road";
    about "Body and wheel on suspension and tyre: a linear system that a road excites, near the resonance of \
           the body or of the wheel.";
    preset body "waves at 1.2 Hz: the body bounces" { omega: 7.5 }
    preset wheel "waves at 10 Hz: the wheel hops" { omega: 63 }
    span 3s;
    draw spring suspension: hub, chassis_centre;
    draw spring tyre: contact, hub;
    draw slider chassis_centre along [0, 1];
    draw slider hub along [0, 1];
    draw joint contact;
    draw road road: contact speed 1 [m/s];
}
