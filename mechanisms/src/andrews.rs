//! Andrews' squeezer: seven bodies, three loops, a spring and a constant torque.
//!
//! ```text
//!   O ─ F ─── E      crank OF and rod FE; at E meet the triangle BDE, whose corner D the spring
//!             │      pulls to C, and the rods EG and EH, whose other ends the bodies AG and AH
//!   A, B, C fixed    guide about A
//! ```
//!
//! Source: IFToMM benchmark A03; Test Set for IVP Solvers, problem "Andrews' squeezing mechanism" (Mazzia &
//! Magherini 2008), whose letters the parameters keep.

use mbs_runtime::mechanism;

use crate::drawing::Shape;
use crate::masses::boxed_masses;
use crate::registry::{FreeCard, Preset, Usual};

/// In the list of free mechanisms.
pub const CARD: FreeCard = FreeCard {
    name: "andrews",
    title: "Andrews' squeezer",
    description: "A constant torque drives a crank with seven bodies against a spring: three loops, a time scale of \
                  milliseconds, accelerations up to 5e5 rad/s².",
    runs: &[Preset { label: "0.03 s", description: "from rest, under a constant torque", set: &[] }],
    duration: 0.03,
    usual: Usual::Projection,
    drawing: DRAWING,
    make: boxed_masses::<Andrews, 7, 6>,
};

mechanism! {
    /// Andrews' squeezer: one degree of freedom in seven angles.
    pub mechanism Andrews;
    /// Masses of the seven bodies.
    param m: [kg; 7] = [0.04325, 0.00365, 0.02373, 0.00706, 0.0705, 0.00706, 0.05498];
    /// Their moments of inertia about the centres of mass.
    param I: [kg*m^2; 7] = [2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5];
    /// Bearings.
    param A: [m; 2] = [-0.06934, -0.00227];
    param B: [m; 2] = [-0.03635, 0.03273];
    param C: [m; 2] = [0.014, 0.072];
    /// Stiffness of the spring.
    param c0: N/m = 4530;
    /// Its length at rest.
    param l0: m = 0.07785;
    /// Torque on the crank.
    param mom: N*m = 0.033;
    const d: m = 0.028;
    const da: m = 0.0115;
    const e: m = 0.02;
    const ea: m = 0.01421;
    const rr: m = 0.007;
    const ra: m = 0.00092;
    const ss: m = 0.035;
    const sa: m = 0.01874;
    const sb: m = 0.01043;
    const sc: m = 0.018;
    const sd: m = 0.02;
    const ta: m = 0.02308;
    const tb: m = 0.00916;
    const u: m = 0.04;
    const ua: m = 0.01228;
    const ub: m = 0.00449;
    const zf: m = 0.02;
    const zt: m = 0.04;
    const fa: m = 0.01421;
    coord beta: rad = -0.06171389001427645;
    coord Theta: rad = 0;
    coord gamma: rad = 0.45527981916307037;
    coord Phi: rad = 0.22266839016588588;
    coord delta: rad = 0.48736497954384256;
    coord Omega: rad = -0.22266839016588588;
    coord epsilon: rad = 1.2305474445498212;
    let E = rr*unit(beta) - d*unit(beta + Theta);
    // Across a direction of angle phi, clockwise: [sin phi, −cos phi].
    let across_gamma = [sin(gamma), -cos(gamma)];
    let across_rod = [sin(Phi + delta), -cos(Phi + delta)];
    let across_epsilon = [sin(epsilon), -cos(epsilon)];
    let D = B + sd*unit(gamma) + sc*across_gamma;
    let G = A + zt*unit(delta);
    let H = A + u*across_epsilon;
    body crank { mass: m[0], inertia: I[0], com: ra*unit(beta), angle: beta }
    body rod { mass: m[1], inertia: I[1], com: rr*unit(beta) - da*unit(beta + Theta), angle: beta + Theta }
    body triangle { mass: m[2], inertia: I[2], com: B + sa*across_gamma + sb*unit(gamma), angle: gamma }
    body upper { mass: m[3], inertia: I[3], com: G + (e - ea)*across_rod, angle: Phi + delta }
    body upper_guide { mass: m[4], inertia: I[4], com: A + ta*unit(delta) - tb*[sin(delta), -cos(delta)], angle: delta }
    body lower { mass: m[5], inertia: I[5], com: H + (zf - fa)*unit(Omega + epsilon), angle: Omega + epsilon }
    body lower_guide { mass: m[6], inertia: I[6], com: A + ua*across_epsilon + ub*unit(epsilon), angle: epsilon }
    tsda spring { from: C, to: D, stiffness: c0, length: l0 }
    torque motor: mom on beta;
    constraint at_triangle { E == B + ss*across_gamma; }
    constraint at_upper { E == G + e*across_rod; }
    constraint at_lower { E == H + zf*unit(Omega + epsilon); }
    start beta = -0.06171389001427645 rate 0;
    out crank_centre: [m; 2] = [0, 0];
    out crank_pin: [m; 2] = rr*unit(beta);
    out upper_bearing: [m; 2] = A;
    out lower_bearing: [m; 2] = B;
    out spring_bearing: [m; 2] = C;
    out hub: [m; 2] = E;
    out spring_end: [m; 2] = D;
    out upper_end: [m; 2] = G;
    out lower_end: [m; 2] = H;
}

/// How the mechanism is drawn.
pub const DRAWING: &[Shape] = &[
    Shape::Ground { at: "crank_centre" },
    Shape::Ground { at: "upper_bearing" },
    Shape::Ground { at: "lower_bearing" },
    Shape::Ground { at: "spring_bearing" },
    Shape::Spring { points: ["spring_bearing", "spring_end"], label: "spring" },
    Shape::Plate { points: &["lower_bearing", "hub", "spring_end"], label: "triangle" },
    Shape::Link { points: &["upper_bearing", "upper_end"], label: "upper guide" },
    Shape::Link { points: &["upper_end", "hub"], label: "upper rod" },
    Shape::Link { points: &["upper_bearing", "lower_end"], label: "lower guide" },
    Shape::Link { points: &["lower_end", "hub"], label: "lower rod" },
    Shape::Link { points: &["crank_pin", "hub"], label: "rod" },
    Shape::Link { points: &["crank_centre", "crank_pin"], label: "crank" },
    Shape::Joint { at: "crank_centre" },
    Shape::Joint { at: "crank_pin" },
    Shape::Joint { at: "hub" },
    Shape::Joint { at: "spring_end" },
    Shape::Joint { at: "upper_end" },
    Shape::Joint { at: "lower_end" },
    Shape::Trace { of: "hub", label: "hub" },
];
