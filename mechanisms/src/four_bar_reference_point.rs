//! The lecture's four-bar in reference-point coordinates: `x`, `y`, `φ` of each moving body.
//!
//! ```text
//!                    . P
//!               L5 .'  ·
//!                .' α   ·  B          q = [x1 y1 φ1  x2 y2 φ2  x3 y3 φ3]
//!             A o────×────o
//!              /  (x2,y2)  \          ×: reference point, the middle of each body's joints
//!     (x1,y1) ×             × (x3,y3)
//!            / φ1         φ3 \        revolute joints O, A, B, D: two rows each
//!           o─────────────────o
//!           O       L4        D
//! ```
//!
//! Links, units, branch and motion are those of `four_bar.rs`. Each revolute joint says that a point of one body is
//! a point of another or of the ground. Nine coordinates, eight rows of joints, one of the crank.
//!
//! Numbers: those of `four_bar.rs`.

use mbs_runtime::mechanism;

use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Four-bar linkage in reference-point coordinates.
    pub mechanism FourBarReferencePoint;

    param L1: m = 0.20;
    param L2: m = 0.60;
    param L3: m = 0.50;
    param L4: m = 0.55;
    param L5: m = 0.35;
    param alpha: rad = 30deg;
    param omega: rad/s = TAU;
    param side: 1 = 1;

    coord x1: m = L1/2;
    coord y1: m = 0;
    coord phi1: rad = 0;
    coord x2: m = 0.40;
    coord y2: m = 0.25m*side;
    coord phi2: rad = 0.9*side;
    coord x3: m = 0.55;
    coord y3: m = 0.25m*side;
    coord phi3: rad = 1.6*side;

    let crank = [x1, y1];
    let coupler = [x2, y2];
    let rocker = [x3, y3];

    constraint pin_O { crank - L1/2*unit(phi1) == [0, 0]; }
    constraint pin_A { crank + L1/2*unit(phi1) == coupler - L2/2*unit(phi2); }
    constraint pin_B { coupler + L2/2*unit(phi2) == rocker + L3/2*unit(phi3); }
    constraint pin_D { rocker - L3/2*unit(phi3) == [L4, 0]; }
    drive turn: phi1 == omega*t;
    branch assembly: side*sin(phi3 - phi2) > 0;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = crank + L1/2*unit(phi1);
    out B: [m; 2] = coupler + L2/2*unit(phi2);
    out D: [m; 2] = [L4, 0];
    out P: [m; 2] = coupler + rot(phi2)*[L5*cos(alpha) - L2/2, L5*sin(alpha)];

    title "Four-bar in reference-point coordinates";
    about "The lecture's four-bar with x, y and φ of each moving body as coordinates and a pair of rows for \
           each revolute joint: the same motion from nine coordinates.";
    preset "open assembly" "coupler and rocker on the upper side" { side: 1 }
    preset "crossed assembly" "coupler and rocker on the lower side" { side: -1 }
    span turn(omega);
    draw ground O, D;
    draw plate coupler: A, B, P;
    draw link crank: O, A;
    draw link rocker: D, B;
    draw joint O, A, B, D;
    trace "coupler curve": P;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(FourBarReferencePoint::default());
