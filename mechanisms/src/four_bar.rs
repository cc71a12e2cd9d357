//! The lecture's four-bar linkage with a coupler point.
//!
//! ```text
//!                      P = (x2, y2)
//!                    .·' ·
//!              L5 .·'     ·
//!              .·' α       B
//!            A ────────────o
//!            o      L2      \
//!        L1 /  φ2            \ L3
//!          / φ1            φ3 \
//!         o────────────────────o
//!         O         L4         D
//! ```
//!
//! All angles count from the ground line `O D` (rad), lengths are in metres, `q = [x2 y2 φ1 φ2 φ3]`. The coupler
//! point stands at `L5` from `A`, turned by `α` against `A B`. The crank turns at constant `ω`.
//!
//! Rows stand in the order of the lecture's slides and have their signs. The crank is the shortest link and
//! `L1 + L2 = 0.80 m < L3 + L4 = 1.05 m`, so it turns fully (Grashof) in either assembly. `sin(φ3 − φ2)` keeps its
//! sign, positive in the open one (`side = 1`), negative in the crossed one (`side = -1`).
//!
//! Numbers: the reference problem in `tests/data/four_bar.csv`.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;
use mbs_workbench::erased::facade::AnyEquations;
use mbs_workbench::known_motion::{KnownCourse, KnownMotion, KnownState, parameter};

mechanism! {
    /// Four-bar linkage with a coupler point.
    pub mechanism FourBar;

    param L1: m = 0.20;
    param L2: m = 0.60;
    param L3: m = 0.50;
    param L4: m = 0.55;
    param L5: m = 0.35;
    param alpha: rad = 30deg;
    param omega: rad/s = TAU;
    param side: 1 = 1;

    coord x2: m;
    coord y2: m;
    coord phi1: rad = 0;
    coord phi2: rad = 0.9*side;
    coord phi3: rad = 1.6*side;

    constraint coupler_point {
        x2 == L1*cos(phi1) + L5*cos(alpha + phi2);
        y2 == L1*sin(phi1) + L5*sin(alpha + phi2);
    }
    constraint closure {
        L3*cos(phi3) + L4 == L1*cos(phi1) + L2*cos(phi2);
        L1*sin(phi1) + L2*sin(phi2) == L3*sin(phi3);
    }
    drive crank: phi1 == omega*t;
    branch assembly: side*sin(phi3 - phi2) > 0;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = L1*unit(phi1);
    out B: [m; 2] = L1*unit(phi1) + L2*unit(phi2);
    out D: [m; 2] = [L4, 0];
    out P: [m; 2] = [x2, y2];
    out transmission_angle: rad = phi3 - phi2;

    title "Four-bar linkage with coupler point";
    about "The lecture's example: a crank turns at constant speed, the coupler carries a point P. Both \
           assemblies of the same links come from one text.";
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
pub const CARD: Card = card!(FourBar::default()).known_by(&KNOWN);

/// Positions by the intersection of two circles.
const KNOWN: KnownMotion = KnownMotion {
    source: "closed form: intersection of two circles",
    // Angles next to stretched positions have fewer digits than lengths.
    error: 1e-13,
    course: KnownCourse::Form(closed_form),
};

fn closed_form(four_bar: &dyn AnyEquations, t: f64) -> Option<KnownState> {
    let [crank, coupler, rocker, ground] = ["L1", "L2", "L3", "L4"].map(|name| parameter(four_bar, name));
    let [point, alpha, omega, side] = ["L5", "alpha", "omega", "side"].map(|name| parameter(four_bar, name));
    let angle = omega * t;
    let a = [crank * angle.cos(), crank * angle.sin()];
    let way = [ground - a[0], -a[1]];
    let square = way[0] * way[0] + way[1] * way[1];
    // B along and across the way from A to D.
    let along = (square + coupler * coupler - rocker * rocker) / (2.0 * square);
    let across = side.signum() * (coupler * coupler / square - along * along).sqrt();
    if across.is_nan() {
        return None;
    }
    let to_b = [along * way[0] - across * way[1], along * way[1] + across * way[0]];
    let coupler_angle = to_b[1].atan2(to_b[0]);
    let rocker_angle = (a[1] + to_b[1]).atan2(a[0] + to_b[0] - ground);
    let p = [a[0] + point * (alpha + coupler_angle).cos(), a[1] + point * (alpha + coupler_angle).sin()];
    Some(KnownState { t, q: vec![p[0], p[1], angle, coupler_angle, rocker_angle], qd: Vec::new() })
}
