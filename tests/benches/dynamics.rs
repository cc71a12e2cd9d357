//! Motion from forces against its peers in one run: accelerations of one state, and whole motions to a given accuracy.
//!
//! ```text
//! cargo bench -p mbs-tests --bench dynamics
//! ```
//!
//! Measured, checked and written as by the bench `kinematics`, to `bench/dynamics.md` and `bench/dynamics.svg` below the
//! target directory; with `-- --docs` also next to this file.
#![forbid(unsafe_code)]

mod against_peers;

use std::process::ExitCode;

use against_peers::{Line, Peer, SHOWN, Subject};

/// Largest error of accelerations, over the largest acceleration of all states: a thousand roundings, by which the
/// factorizations of Andrews' mechanism differ.
const LARGEST_ERROR_OF_RATES: f64 = 1e-12;

/// The same of CasADi's sparse QR with multipliers, which does not pivot for size.
const LARGEST_ERROR_OF_PEERS_RATES: f64 = 1e-10;

/// Largest error of Andrews' angles (rad) at the end.
const LARGEST_ERROR_OF_ANDREWS: f64 = 2e-7;

/// Largest distance (m) of the first point of the loops from the exact motion.
const LARGEST_ERROR_OF_LOOPS: f64 = 1e-7;

const NOTES: &str = "Accelerations are asked for as an integrator does, with multipliers, margin and checks; eight lanes as \
                     emitted. Whole motions go from the start to the end with the loosest tolerance, in steps of √10, that is \
                     exact enough: Andrews' angles at 0.03 s to 2e-7 rad of the published solution, the first point of ten \
                     hanging loops to 1e-7 m of the exact pendulum at 1000 samples of 10 s, taken in another run. CVODES is \
                     the one that comes with CasADi, called from the same program through CasADi's C interface, with Adams' \
                     method and functional iteration; its right-hand side is compiled C of CasADi's (multipliers by sparse QR, \
                     Baumgarte ξ = 1, ω = 10).";

/// Limits of the goals that were missed at the last measurement: work and reason.
const BOUNDS: &[(&str, &str)] = &[(
    "right-hand side, forty loops over ten (at most)",
    "instructions grow 3.96 times (`cargo xtask instructions`); without the processor's own instructions time grows 4.2 times, with them ten loops gain more than forty.",
)];

const LINES: &[Line] = &[
    Line(
        "right-hand side of Andrews, against dense LU in C by hand",
        "andrews_rates",
        "emitted",
        Peer::Fastest(&["dense"]),
        5.0,
        9.0,
    ),
    Line("…, against CasADi's C", "andrews_rates", "emitted", Peer::Fastest(&["casadi_rates"]), SHOWN, SHOWN),
    Line(
        "…, 8 lanes, a mechanism, against one",
        "andrews_rates",
        "emitted_lanes",
        Peer::Fastest(&["emitted"]),
        3.0,
        4.0,
    ),
    Line(
        "right-hand side of ten loops, against CasADi's C",
        "n_four_bar_rates",
        "emitted",
        Peer::Fastest(&["casadi_rates"]),
        SHOWN,
        SHOWN,
    ),
    Line(
        "right-hand side, forty loops over ten (at most)",
        "n_four_bar_rates",
        "emitted_40",
        Peer::Growth("emitted"),
        4.5,
        4.0,
    ),
    Line(
        "Andrews to 2e-7, against CVODES",
        "andrews_motion",
        "emitted_order_8",
        Peer::Fastest(&["cvodes"]),
        10.0,
        30.0,
    ),
    Line(
        "ten hanging loops to 1e-7, against CVODES",
        "n_four_bar_motion",
        "emitted_order_8",
        Peer::Fastest(&["cvodes"]),
        4.0,
        15.0,
    ),
];

fn main() -> ExitCode {
    against_peers::run(&Subject {
        name: "dynamics",
        title: "Motion from forces against its peers",
        notes: NOTES,
        lines: LINES,
        limit: |problem, name| match (problem, name) {
            ("andrews_motion", _) => LARGEST_ERROR_OF_ANDREWS,
            ("n_four_bar_motion", _) => LARGEST_ERROR_OF_LOOPS,
            (_, "casadi_rates") => LARGEST_ERROR_OF_PEERS_RATES,
            _ => LARGEST_ERROR_OF_RATES,
        },
        bounds: BOUNDS,
    })
}
