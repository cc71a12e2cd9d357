//! The lecture's four-bar in mixed coordinates: the points of the natural ones and the crank's angle.
//!
//! ```text
//!                    . P = p
//!               L5 .'  ·
//!                .' α   ·
//!             A o─────────o B         q = [φ1 a b p]
//!              /    L2     \
//!          L1 /             \ L3      as natural coordinates, and a ∥ unit(φ1)
//!            / φ1            \
//!           o─────────────────o
//!           O       L4        D
//! ```
//!
//! Links, units, branches and motion are those of `four_bar.rs` and `four_bar_natural.rs`. A motor gives an angle.
//! The angle becomes a coordinate with a row that ties it to the crank's point, so that the drive is the lecture's
//! `φ1 = ωt`. The row is the cross product, which never degenerates, where `x = L1 cos φ1` would at `φ1 = 0` and `π`.
//!
//! Numbers: those of `four_bar.rs`.

use mbs_runtime::mechanism;

use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Four-bar linkage in natural coordinates with the crank's angle.
    pub mechanism FourBarMixed;

    param L1: m = 0.20;
    param L2: m = 0.60;
    param L3: m = 0.50;
    param L4: m = 0.55;
    param L5: m = 0.35;
    param alpha: rad = 30deg;
    param omega: rad/s = TAU;
    param side: 1 = 1;

    coord phi1: rad = 0;
    coord a: [m; 2] = [L1, 0];
    coord b: [m; 2] = [L4, L3*side];
    coord p: [m; 2];

    let d = [L4, 0];
    let coupler = b - a;

    constraint distances {
        dot(a, a) == L1^2;
        dot(coupler, coupler) == L2^2;
        dot(b - d, b - d) == L3^2;
    }
    constraint crank_angle { cross(unit(phi1), a) == 0; }
    constraint coupler_point {
        p == a + L5/L2*(cos(alpha)*coupler + sin(alpha)*[-coupler.1, coupler.0]);
    }
    drive crank: phi1 == omega*t;
    branch forward: dot(unit(phi1), a) > 0;
    branch assembly: side*cross(coupler, b - d) > 0;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = a;
    out B: [m; 2] = b;
    out D: [m; 2] = d;
    out P: [m; 2] = p;

    title "Four-bar in mixed coordinates";
    about "The lecture's four-bar in natural coordinates and the angle of the crank, which the motor gives.";
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
pub const CARD: Card = card!(FourBarMixed::default());
