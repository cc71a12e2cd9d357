//! A planar 3-RRR platform: three drives move a plate in x, y and its angle.
//!
//! ```text
//!                O0 o
//!                    ╲ l1              θi: driven link Oi Bi (rad)
//!                     o B0             ψi: second link Bi Ci (rad)
//!                 l2 ╱                 (x, y), φ: centre and angle of the platform (m, rad)
//!                C0 o
//!              .·  ╲  ·.               Oi on a circle of radius R, at 90° + 120° i
//!       B1 ──o C1───── C2 o── B2       Ci on a circle of radius rp of the platform, at φ + 90° + 120° i
//!        ╱                     ╲
//!    O1 o                       o O2
//! ```
//!
//! Absolute angles, `q = [x y φ θ0 θ1 θ2 ψ0 ψ1 ψ2]`. Each leg closes with two rows; the drives swing by `swing` about
//! their middle positions, a third of a period apart. The six unknowns other than the driven angles make one block; up
//! to six assemblies belong to given drives. The branches pick one: the three elbows bent the same way, and the sign of
//! a determinant. It is that of the platform's equations of velocity; its zero is the singular position of the parallel
//! kind. During the motion the sines of the elbows stay below −0.8, the determinant between 1.3 and 1.6.
//!
//! Numbers: chosen here.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Planar parallel platform with three driven legs.
    pub mechanism ThreeRrr;

    param R: m = 0.30;
    param rp: m = 0.08;
    param l1: m = 0.16;
    param l2: m = 0.18;
    param home: rad = -126deg;
    param swing: rad = 20deg;
    param omega: rad/s = TAU;

    coord x: m = -40mm;
    coord y: m = 40mm;
    coord phi: rad = -0.1;
    coord theta: [rad; 3] = [-0.6, 1.8, -3.0];
    coord psi: [rad; 3] = [-2.7, 0.0, 2.0];

    let arm0 = rp*unit(phi + 90deg);
    let arm1 = rp*unit(phi + 210deg);
    let arm2 = rp*unit(phi + 330deg);
    let b0 = R*unit(90deg) + l1*unit(theta[0]);
    let b1 = R*unit(210deg) + l1*unit(theta[1]);
    let b2 = R*unit(330deg) + l1*unit(theta[2]);

    constraint leg0 { b0 + l2*unit(psi[0]) == [x, y] + arm0; }
    constraint leg1 { b1 + l2*unit(psi[1]) == [x, y] + arm1; }
    constraint leg2 { b2 + l2*unit(psi[2]) == [x, y] + arm2; }
    drive motor0: theta[0] == 90deg + home + swing*sin(omega*t);
    drive motor1: theta[1] == 210deg + home + swing*sin(omega*t + 120deg);
    drive motor2: theta[2] == 330deg + home + swing*sin(omega*t + 240deg);
    branch elbow0: sin(psi[0] - theta[0]) < 0;
    branch elbow1: sin(psi[1] - theta[1]) < 0;
    branch elbow2: sin(psi[2] - theta[2]) < 0;
    branch platform: det([
        [cos(psi[0]), sin(psi[0]), cross(arm0, unit(psi[0]))/rp],
        [cos(psi[1]), sin(psi[1]), cross(arm1, unit(psi[1]))/rp],
        [cos(psi[2]), sin(psi[2]), cross(arm2, unit(psi[2]))/rp]
    ]) > 0;

    out O0: [m; 2] = R*unit(90deg);
    out O1: [m; 2] = R*unit(210deg);
    out O2: [m; 2] = R*unit(330deg);
    out B0: [m; 2] = b0;
    out B1: [m; 2] = b1;
    out B2: [m; 2] = b2;
    out C0: [m; 2] = [x, y] + arm0;
    out C1: [m; 2] = [x, y] + arm1;
    out C2: [m; 2] = [x, y] + arm2;
    out P: [m; 2] = [x, y];

    title "Planar platform on three driven legs";
    about "Three cranks move a plate in x, y and its angle: a parallel robot of the kind 3-RRR.";
    preset "one cycle" "the drives swing a third of a period apart" {}
    span turn(omega);
    draw ground O0, O1, O2;
    draw plate platform: C0, C1, C2;
    draw link crank: O0, B0;
    draw link O1, B1;
    draw link O2, B2;
    draw link rod: B0, C0;
    draw link B1, C1;
    draw link B2, C2;
    draw joint O0, O1, O2, B0, B1, B2, C0, C1, C2;
    trace "centre of the platform": P;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(ThreeRrr::default());
