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
use mbs_workbench::card;
use mbs_workbench::card::Card;
use mbs_workbench::known_motion::{KnownCourse, KnownMotion};

use crate::known::states;

/// In the list of free mechanisms.
pub const CARD: Card = card!(Andrews::default()).known_by(&KNOWN);

/// Published digits, with further instants.
const KNOWN: KnownMotion = KnownMotion {
    source: "published digits of the Test Set for IVP Solvers",
    error: 1e-10,
    course: KnownCourse::Table(|| states(include_str!("../tests/data/andrews.csv"), 7)),
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
    pin crank_bearing: ground, crank at [0, 0];
    pin crank_end: crank, rod at rr*unit(beta);
    pin triangle_bearing: ground, triangle at B;
    pin upper_guide_bearing: ground, upper_guide at A;
    pin upper_guide_end: upper_guide, upper at G;
    pin lower_guide_bearing: ground, lower_guide at A;
    pin lower_guide_end: lower_guide, lower at H;
    // At E four bodies meet: the rod with each of the others.
    pin hub_of_triangle: rod, triangle at E;
    pin hub_of_upper: rod, upper at E;
    pin hub_of_lower: rod, lower at E;
    out crank_centre: [m; 2] = [0, 0];
    out crank_pin: [m; 2] = rr*unit(beta);
    out upper_bearing: [m; 2] = A;
    out lower_bearing: [m; 2] = B;
    out spring_bearing: [m; 2] = C;
    out hub: [m; 2] = E;
    out spring_end: [m; 2] = D;
    out upper_end: [m; 2] = G;
    out lower_end: [m; 2] = H;
    /// Force of the frame on the crank.
    out crank_bearing_force: [N; 2] = reaction(crank_bearing, crank);
    /// Force of the crank on the rod.
    out crank_end_force: [N; 2] = reaction(crank_end, rod);
    /// Force of the frame on the triangle BDE.
    out triangle_bearing_force: [N; 2] = reaction(triangle_bearing, triangle);
    /// Force of the frame on the guide AG.
    out upper_bearing_force: [N; 2] = reaction(upper_guide_bearing, upper_guide);
    /// Force of the guide AG on the rod EG.
    out upper_end_force: [N; 2] = reaction(upper_guide_end, upper);
    /// Force of the frame on the guide AH.
    out lower_bearing_force: [N; 2] = reaction(lower_guide_bearing, lower_guide);
    /// Force of the guide AH on the rod EH.
    out lower_end_force: [N; 2] = reaction(lower_guide_end, lower);
    /// Force at E on the triangle BDE.
    out triangle_force: [N; 2] = reaction(hub_of_triangle, triangle);
    /// Force at E on the rod EG.
    out upper_force: [N; 2] = reaction(hub_of_upper, upper);
    /// Force at E on the rod EH.
    out lower_force: [N; 2] = reaction(hub_of_lower, lower);

    title "Andrews' squeezer";
    about "A constant torque drives a crank with seven bodies against a spring: three loops, a time scale of \
           milliseconds, accelerations up to 5e5 rad/s².";
    preset "0.03 s" "from rest, under a constant torque" {}
    span 0.03s;
    draw ground crank_centre, upper_bearing, lower_bearing, spring_bearing;
    draw spring spring: spring_bearing, spring_end;
    draw plate triangle: lower_bearing, hub, spring_end;
    draw link "upper guide": upper_bearing, upper_end;
    draw link "upper rod": upper_end, hub;
    draw link "lower guide": upper_bearing, lower_end;
    draw link "lower rod": lower_end, hub;
    draw link rod: crank_pin, hub;
    draw link crank: crank_centre, crank_pin;
    draw joint crank_centre, crank_pin, hub, spring_end, upper_end, lower_end;
    trace hub;
}
