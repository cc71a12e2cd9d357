//! Two four-bars in a row that share their uprights, in natural coordinates.
//!
//! ```text
//!   B0 ──── B1 ──── B2      five uniform rods of one length
//!   │       │       │       A fixed, B the coordinates
//!   A0      A1      A2
//! ```
//!
//! Source: IFToMM benchmark A02, N-four-bar mechanism with N = 2: rods of 1 m and 1 kg, upright at the start, B0 at
//! 1 m/s towards +x. With all rods in line (uprights level) Φ_q loses rank.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;
use mbs_workbench::erased::facade::AnyEquations;
use mbs_workbench::known_motion::{KnownCourse, KnownMotion, KnownState, parameter};

use crate::elliptic::{amplitude, quarter_period};

/// In the list of free mechanisms.
pub const CARD: Card = card!(NFourBar::default()).known_by(&KNOWN);

/// The motion of any number of four-bars by elliptic functions: uprights turn by θ from the vertical, couplers do not turn, so that
/// θ̈ = a sin θ.
pub(crate) const KNOWN: KnownMotion = KnownMotion {
    source: "closed form by elliptic functions",
    // Rounding of the phase, which grows to 35 rad, next to a parameter of 1.
    error: 1e-12,
    course: KnownCourse::Form(closed_form),
};

/// State at `t` (s) in closed form. `None` where the bars do not turn over: `v` must be above zero, lengths and gravity too.
pub fn closed_form(bars: &dyn AnyEquations, t: f64) -> Option<KnownState> {
    let [length, g, v] = ["L", "g", "v"].map(|name| parameter(bars, name));
    let uprights = bars.coordinates().len() / 2;
    let (rods, couplers) = (uprights as f64, uprights as f64 - 1.0);
    // Moments about the lower ends, over the mass of a rod.
    let a = g / length * (rods / 2.0 + couplers) / (rods / 3.0 + couplers);
    let first = v / length;
    // θ = π + 2 am(Ω t − K): the top is passed with `first`, the bottom with 2 Ω.
    let fastest = (first * first / 4.0 + a).sqrt();
    let m = a / (fastest * fastest);
    if !(first > 0.0 && a > 0.0 && m < 1.0) {
        return None;
    }
    let half = amplitude(fastest * t - quarter_period(m), m);
    let rate = 2.0 * fastest * (1.0 - m * half.sin().powi(2)).sqrt();
    let (sin, cos) = (-(2.0 * half).sin(), -(2.0 * half).cos());
    let q = (0..uprights).flat_map(|i| [(i as f64 + sin) * length, length * cos]);
    let qd = (0..uprights).flat_map(|_| [length * rate * cos, -length * rate * sin]);
    Some(KnownState { t, q: q.collect(), qd: qd.collect() })
}

mechanism! {
    /// Two parallelograms: one degree of freedom in six coordinates.
    pub mechanism NFourBar;
    const N: 1 = 2;
    /// Mass of a rod.
    param m: kg = 1;
    /// Length of a rod.
    param L: m = 1;
    /// Free fall.
    param g: m/s^2 = 9.81;
    /// Velocity of the upper ends at the start.
    param v: m/s = 1;
    /// Upper ends of the uprights.
    coord B: [m; N + 1, 2] = [[0, 1], [1, 1], [2, 1]];
    gravity weight { acceleration: [0, -g] }
    // A uniform rod is half its mass at the middle of its ends, and the rest of its energy is m |v₂ − v₁|²/24.
    for i in 0..N + 1 {
        let A = [i*L, 0];
        body upright { mass: m, com: (A + B[i])/2 }
        kinetic upright_turning = m*dot(der(B[i]), der(B[i]))/24;
        constraint uprights { dot(B[i] - A, B[i] - A) == L^2; }
    }
    for i in 0..N {
        body coupler { mass: m, com: (B[i] + B[i + 1])/2 }
        kinetic coupler_turning = m*dot(der(B[i + 1] - B[i]), der(B[i + 1] - B[i]))/24;
        constraint couplers { dot(B[i + 1] - B[i], B[i + 1] - B[i]) == L^2; }
    }
    start B = [[0, L], [L, L], [2*L, L]] rate [[v, 0], [v, 0], [v, 0]];
    out A0: [m; 2] = [0, 0];
    out A1: [m; 2] = [L, 0];
    out A2: [m; 2] = [2*L, 0];
    out B0: [m; 2] = B[0];
    out B1: [m; 2] = B[1];
    out B2: [m; 2] = B[2];

    title "Two four-bars in a row";
    about "Two parallelograms that share their uprights fall over and come up again, through positions with \
           all rods in line, where the rows lose rank.";
    preset pushed "upright at the start, pushed to the right" {}
    span 10s;
    draw ground A0, A1, A2;
    draw link "left upright": A0, B0;
    draw link "middle upright": A1, B1;
    draw link "right upright": A2, B2;
    draw link "left coupler": B0, B1;
    draw link "right coupler": B1, B2;
    draw joint A0, A1, A2, B0, B1, B2;
    trace "middle joint": B1;
}
