//! The lecture's four-bar in natural coordinates: Cartesian points, no angle.
//!
//! ```text
//!                    . P = p
//!               L5 .'  ·
//!                .' α   ·
//!             A o─────────o B         q = [a b p], two components each
//!              /    L2     \
//!          L1 /             \ L3      constant distances: |a|² = L1², |b − a|² = L2², |b − d|² = L3²
//!            /               \
//!           o─────────────────o       p = a + L5/L2 (cos α (b − a) + sin α (b − a)⊥)
//!           O       L4        D
//! ```
//!
//! Links, units and motion are those of `four_bar.rs`. Distances are squared: the rows are quadratic and the
//! Jacobian is linear in the coordinates. The coupler point is a linear combination of the points of its body. The
//! crank stands along `unit(ωt)`: the cross product says so up to its sign, which the branch `forward` picks; the
//! branch `assembly` is `sin(φ3 − φ2)` as in `four_bar.rs`, times `L2 L3`.
//!
//! Numbers: those of `four_bar.rs`.

use mbs_runtime::mechanism;

use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Four-bar linkage in natural coordinates.
    pub mechanism FourBarNatural;

    param L1: m = 0.20;
    param L2: m = 0.60;
    param L3: m = 0.50;
    param L4: m = 0.55;
    param L5: m = 0.35;
    param alpha: rad = 30deg;
    param omega: rad/s = TAU;
    param side: 1 = 1;

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
    constraint coupler_point {
        p == a + L5/L2*(cos(alpha)*coupler + sin(alpha)*[-coupler.1, coupler.0]);
    }
    drive crank: cross(unit(omega*t), a) == 0;
    branch forward: dot(unit(omega*t), a) > 0;
    branch assembly: side*cross(coupler, b - d) > 0;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = a;
    out B: [m; 2] = b;
    out D: [m; 2] = d;
    out P: [m; 2] = p;

    title "Four-bar in natural coordinates";
    about "The lecture's four-bar with Cartesian points as coordinates: constant distances squared, the \
           coupler point by linear combination, no angle at all.";
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
pub const CARD: Card = card!(FourBarNatural::default());
