//! Ten four-bars in a row that share their uprights, in natural coordinates.
//!
//! Source: IFToMM benchmark A02, N-four-bar mechanism with N = 10; [`n_four_bar`](crate::n_four_bar) has N = 2 and a picture.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::{Card, DefaultMethod};

/// In the list of free mechanisms.
pub const CARD: Card =
    card!(NFourBar10::default()).known_by(&crate::n_four_bar::KNOWN).moved_by(DefaultMethod::Velocity);

mechanism! {
    /// Ten parallelograms: one degree of freedom in 22 coordinates.
    pub mechanism NFourBar10;
    const N: 1 = 10;
    /// Mass of a rod.
    param m: kg = 1;
    /// Length of a rod.
    param L: m = 1;
    /// Free fall.
    param g: m/s^2 = 9.81;
    /// Velocity of the upper ends at the start.
    param v: m/s = 1;
    /// Upper ends of the uprights.
    coord B: [m; N + 1, 2] = 0;
    gravity weight { acceleration: [0, -g] }
    // A uniform rod is half its mass at the middle of its ends, and the rest of its energy is m |v₂ − v₁|²/24.
    for i in 0..N + 1 {
        let A = [i*L, 0];
        body upright { mass: m, com: (A + B[i])/2 }
        kinetic upright_turning = m*dot(der(B[i]), der(B[i]))/24;
        constraint uprights { dot(B[i] - A, B[i] - A) == L^2; }
        start B[i] = [i*L, L] rate [v, 0];
    }
    for i in 0..N {
        body coupler { mass: m, com: (B[i] + B[i + 1])/2 }
        kinetic coupler_turning = m*dot(der(B[i + 1] - B[i]), der(B[i + 1] - B[i]))/24;
        constraint couplers { dot(B[i + 1] - B[i], B[i + 1] - B[i]) == L^2; }
    }
    out lower_end: [m; N + 1, 2] = [
        [0, 0], [L, 0], [2*L, 0], [3*L, 0], [4*L, 0], [5*L, 0], [6*L, 0], [7*L, 0], [8*L, 0], [9*L, 0],
        [10*L, 0]
    ];
    out upper_end: [m; N + 1, 2] = B;

    title "Ten four-bars in a row";
    about "Ten parallelograms that share their uprights fall over and come up again; with all rods in line \
           they have eleven degrees of freedom.";
    preset pushed "upright at the start, pushed to the right" {}
    span 10s;
    for i in 0..N + 1 {
        draw ground lower_end[i];
        draw joint lower_end[i], upper_end[i];
        draw link uprights: lower_end[i], upper_end[i];
    }
    for i in 0..N { draw link couplers: upper_end[i], upper_end[i + 1]; }
    trace "last joint": upper_end[N];
}
