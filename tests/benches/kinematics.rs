//! Emitted evaluations and kinematic steps against their peers in one run.
//!
//! ```text
//! cargo bench -p mbs-tests --bench kinematics
//! ```
//!
//! Builds the emitted code and its peers (`tests/proofs/peers`) for this processor and for the default target, and runs
//! both. Writes a table and a plot to `bench/kinematics.md` and `bench/kinematics.svg` below the target directory;
//! with `-- --docs` also next to this file, from where the book takes it; `-- --rounds 5` is enough to see that
//! everything works. Every ratio is the median over rounds in which all implementations took turns; accuracy is checked
//! before anything is timed. Needs Python 3 (for CasADi and SymPy) and a C compiler.
//!
//! Fails if a result is wrong, not if it is slow: the table shows each ratio with its goal.
#![forbid(unsafe_code)]

mod against_peers;

use std::process::ExitCode;

use against_peers::{Line, Peer, SHOWN, Subject};

/// Largest error of an exact evaluation, relative to the largest value of its row. SymPy's code and dual numbers reach
/// 1.4e-13 in the chain, whose γ is a difference of larger numbers there.
const LARGEST_EVALUATION_ERROR: f64 = 1e-12;

/// Largest error of emitted code.
const LARGEST_EMITTED_ERROR: f64 = 1e-14;

/// Largest error of central differences, whose steps balance rounding against truncation.
const LARGEST_ERROR_OF_DIFFERENCES: f64 = 1e-5;

/// Largest error of a step, relative to the largest position, velocity, acceleration: positions are solved to 1e-12.
const LARGEST_STEP_ERROR: f64 = 1e-10;

/// Plain, and with common subexpressions eliminated.
const CASADI: &[&str] = &["casadi_plain", "casadi_shared"];

const NOTES: &str = "Lanes step at as many phases of the turn. The text by hand solves the same blocks in the same \
                     order, without choice of positions, margins or checks. CasADi's Newton \
                     is its `fast_newton`, behind which `solve` factorizes once for the velocity and once for the acceleration; \
                     written out by hand, one factorization does for both. A row without a must is shown for completeness.";

/// Limits of the goals that were missed at the last measurement: work and reason.
const BOUNDS: &[(&str, &str)] = &[
    (
        "kinematic step, ten loops, against Rust by hand",
        "the eleven blocks go one behind the other, each of which waits for the position of the one before; the text by hand does without margin and orientation of each, a tolerance for each row, the worst row, and has fewer numbers to put aside.",
    ),
    (
        "four-bar, against Rust by hand",
        "by hand the angle α + φ2 takes the fourth place of a register of four beside the three others and costs nothing; emitted, its sine and cosine are made of those of its parts, which is worth a third of the time where registers hold two numbers. By hand from the parts it takes as long as emitted (next row).",
    ),
    (
        "8-lane batch step, four-bar, a mechanism, against the single step",
        "next to the must: its middle 80 % lie on both sides of it.",
    ),
    (
        "8-lane batch step, ten loops, a mechanism, against the single step",
        "lanes that fill one register go block after block, as a single step does, and wider ones in such groups. Each group waits for its divisions as long as a single step, and takes more instructions: choices by masks in place of branches, signs of determinants lane by lane.",
    ),
    (
        "time a step, forty loops over ten (at most)",
        "instructions grow 3.8 times (`cargo xtask instructions`), time more.",
    ),
];

const LINES: &[Line] = &[
    Line(
        "{Φ, Φ_q, Φ_t, γ}, four-bar, against CasADi's C",
        "four_bar",
        "emitted",
        Peer::Fastest(CASADI),
        3.5,
        5.0,
    ),
    Line("…, Andrews", "andrews", "emitted", Peer::Fastest(CASADI), 3.5, 5.0),
    Line("…, ten loops in natural coordinates", "chain", "emitted", Peer::Fastest(CASADI), 1.1, 1.4),
    Line("four-bar, against SymPy's C", "four_bar", "emitted", Peer::Fastest(&["sympy"]), 2.3, 3.0),
    Line("Andrews, against SymPy's C", "andrews", "emitted", Peer::Fastest(&["sympy"]), 2.3, 3.0),
    Line("ten loops, against SymPy's C", "chain", "emitted", Peer::Fastest(&["sympy"]), SHOWN, SHOWN),
    Line("four-bar, against forward dual numbers", "four_bar", "emitted", Peer::Fastest(&["dual"]), 3.0, 4.0),
    Line("Andrews, against forward dual numbers", "andrews", "emitted", Peer::Fastest(&["dual"]), 3.0, 4.0),
    Line("ten loops, against forward dual numbers", "chain", "emitted", Peer::Fastest(&["dual"]), 3.0, 4.0),
    Line(
        "four-bar, against central differences",
        "four_bar",
        "emitted",
        Peer::Fastest(&["differences"]),
        30.0,
        40.0,
    ),
    Line(
        "Andrews, against central differences",
        "andrews",
        "emitted",
        Peer::Fastest(&["differences"]),
        30.0,
        40.0,
    ),
    Line(
        "ten loops, against central differences",
        "chain",
        "emitted",
        Peer::Fastest(&["differences"]),
        SHOWN,
        SHOWN,
    ),
    Line(
        "four-bar, against Rust by hand",
        "four_bar",
        "emitted",
        Peer::Fastest(&["by_hand"]),
        1.0 / 1.1,
        1.0,
    ),
    Line(
        "…, four-bar, by hand with α + φ2 from its parts as well",
        "four_bar",
        "emitted",
        Peer::Fastest(&["by_hand_from_parts"]),
        SHOWN,
        SHOWN,
    ),
    Line("Andrews, against Rust by hand", "andrews", "emitted", Peer::Fastest(&["by_hand"]), 1.0 / 1.1, 1.0),
    Line("ten loops, against Rust by hand", "chain", "emitted", Peer::Fastest(&["by_hand"]), 1.0 / 1.1, 1.0),
    Line(
        "four-bar, 8 lanes, a mechanism, against CasADi's C",
        "four_bar",
        "emitted_lanes",
        Peer::Fastest(CASADI),
        12.0,
        18.0,
    ),
    Line(
        "Andrews, 8 lanes, a mechanism, against CasADi's C",
        "andrews",
        "emitted_lanes",
        Peer::Fastest(CASADI),
        12.0,
        18.0,
    ),
    Line(
        "ten loops, 8 lanes, a mechanism, against CasADi's C",
        "chain",
        "emitted_lanes",
        Peer::Fastest(CASADI),
        SHOWN,
        SHOWN,
    ),
    Line(
        "four-bar, 4 lanes, a mechanism, against CasADi's C",
        "four_bar",
        "emitted_4_lanes",
        Peer::Fastest(CASADI),
        SHOWN,
        SHOWN,
    ),
    Line(
        "Andrews, 4 lanes, a mechanism, against CasADi's C",
        "andrews",
        "emitted_4_lanes",
        Peer::Fastest(CASADI),
        SHOWN,
        SHOWN,
    ),
    Line(
        "ten loops, 4 lanes, a mechanism, against CasADi's C",
        "chain",
        "emitted_4_lanes",
        Peer::Fastest(CASADI),
        SHOWN,
        SHOWN,
    ),
    Line(
        "kinematic step, four-bar, against CasADi's Newton from the same prediction",
        "four_bar_step",
        "emitted",
        Peer::Fastest(&["casadi_predicted"]),
        8.0,
        12.0,
    ),
    Line(
        "…, four-bar, its rates from one factorization",
        "four_bar_step",
        "emitted",
        Peer::Fastest(&["casadi_factored"]),
        SHOWN,
        SHOWN,
    ),
    Line(
        "kinematic step, four-bar, against nalgebra's dense Newton–Raphson",
        "four_bar_step",
        "emitted",
        Peer::Fastest(&["nalgebra"]),
        8.0,
        15.0,
    ),
    Line(
        "kinematic step, four-bar, against Rust by hand",
        "four_bar_step",
        "emitted",
        Peer::Fastest(&["by_hand"]),
        1.0 / 1.1,
        1.0,
    ),
    Line(
        "kinematic step, ten loops, against CasADi's Newton from the same prediction",
        "chain_step",
        "emitted",
        Peer::Fastest(&["casadi_predicted"]),
        8.0,
        13.0,
    ),
    Line(
        "…, ten loops, its rates from one factorization",
        "chain_step",
        "emitted",
        Peer::Fastest(&["casadi_factored"]),
        SHOWN,
        SHOWN,
    ),
    Line(
        "kinematic step, ten loops, against Rust by hand",
        "chain_step",
        "emitted",
        Peer::Fastest(&["by_hand"]),
        1.0 / 1.1,
        1.0,
    ),
    Line(
        "8-lane batch step, four-bar, a mechanism, against the single step",
        "four_bar_step",
        "emitted_lanes",
        Peer::Fastest(&["emitted"]),
        4.0,
        7.0,
    ),
    Line(
        "8-lane batch step, ten loops, a mechanism, against the single step",
        "chain_step",
        "emitted_lanes",
        Peer::Fastest(&["emitted"]),
        4.0,
        7.0,
    ),
    Line(
        "4-lane batch step, four-bar, a mechanism, against the single step",
        "four_bar_step",
        "emitted_4_lanes",
        Peer::Fastest(&["emitted"]),
        SHOWN,
        SHOWN,
    ),
    Line(
        "4-lane batch step, ten loops, a mechanism, against the single step",
        "chain_step",
        "emitted_4_lanes",
        Peer::Fastest(&["emitted"]),
        SHOWN,
        SHOWN,
    ),
    Line(
        "kinematic step with inputs set before each, four-bar, against the time-driven step",
        "four_bar_step",
        "emitted_with_inputs",
        Peer::Fastest(&["emitted"]),
        SHOWN,
        SHOWN,
    ),
    Line(
        "8-lane batch step with inputs set before each, four-bar, a mechanism, against the single step with inputs",
        "four_bar_step",
        "emitted_lanes_with_inputs",
        Peer::Fastest(&["emitted_with_inputs"]),
        SHOWN,
        SHOWN,
    ),
    Line(
        "time a step, forty loops over ten (at most)",
        "chain_step",
        "emitted_40",
        Peer::Growth("emitted"),
        4.5,
        4.0,
    ),
];

fn main() -> ExitCode {
    against_peers::run(&Subject {
        name: "kinematics",
        title: "Kinematics against its peers",
        notes: NOTES,
        lines: LINES,
        limit: |problem, name| match name {
            _ if problem.ends_with("_step") => LARGEST_STEP_ERROR,
            "differences" => LARGEST_ERROR_OF_DIFFERENCES,
            _ if name.starts_with("emitted") => LARGEST_EMITTED_ERROR,
            _ => LARGEST_EVALUATION_ERROR,
        },
        bounds: BOUNDS,
    })
}
