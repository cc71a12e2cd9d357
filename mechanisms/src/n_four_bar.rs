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

use crate::drawing::Shape;
use crate::masses::boxed_masses;
use crate::registry::{FreeCard, Preset, Usual};

/// In the list of free mechanisms.
pub const CARD: FreeCard = FreeCard {
    name: "n_four_bar",
    title: "Two four-bars in a row",
    description: "Two parallelograms that share their uprights fall over and come up again, through positions with all \
                  rods in line, where the rows lose rank.",
    runs: &[Preset { label: "pushed", description: "upright at the start, pushed to the right", set: &[] }],
    duration: 10.0,
    usual: Usual::Projection,
    drawing: DRAWING,
    make: boxed_masses::<NFourBar, 6, 5>,
};

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
}

/// How the mechanism is drawn.
pub const DRAWING: &[Shape] = &[
    Shape::Ground { at: "A0" },
    Shape::Ground { at: "A1" },
    Shape::Ground { at: "A2" },
    Shape::Link { points: &["A0", "B0"], label: "left upright" },
    Shape::Link { points: &["A1", "B1"], label: "middle upright" },
    Shape::Link { points: &["A2", "B2"], label: "right upright" },
    Shape::Link { points: &["B0", "B1"], label: "left coupler" },
    Shape::Link { points: &["B1", "B2"], label: "right coupler" },
    Shape::Joint { at: "A0" },
    Shape::Joint { at: "A1" },
    Shape::Joint { at: "A2" },
    Shape::Joint { at: "B0" },
    Shape::Joint { at: "B1" },
    Shape::Joint { at: "B2" },
    Shape::Trace { of: "B1", label: "middle joint" },
];

/// How a row of uprights is drawn, for the numbers of `lower_end` and `upper_end`: `uprights!(0 1 2)`.
macro_rules! uprights {
    (@pairs [$($shapes:tt)*] $last:literal) => {
        &[
            $($shapes)*
            Shape::Trace { of: concat!("upper_end.", $last), label: "last joint" },
        ]
    };
    (@pairs [$($shapes:tt)*] $one:literal $next:literal $($more:literal)*) => {
        uprights!(@pairs [
            $($shapes)*
            Shape::Link {
                points: &[concat!("upper_end.", $one), concat!("upper_end.", $next)],
                label: if $one == 0 { "couplers" } else { "" },
            },
        ] $next $($more)*)
    };
    ($($index:literal)*) => {
        uprights!(@pairs [
            $(
                Shape::Ground { at: concat!("lower_end.", $index) },
                Shape::Joint { at: concat!("lower_end.", $index) },
                Shape::Joint { at: concat!("upper_end.", $index) },
                Shape::Link {
                    points: &[concat!("lower_end.", $index), concat!("upper_end.", $index)],
                    label: if $index == 0 { "uprights" } else { "" },
                },
            )*
        ] $($index)*)
    };
}
pub(crate) use uprights;
