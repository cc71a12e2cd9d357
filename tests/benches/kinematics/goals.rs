//! The ratios that the project wants to reach.

use super::run::{Implementation, Measured, faster};

/// A ratio with its goal.
pub struct Goal {
    /// What is compared, in words.
    pub work: &'static str,
    /// The peer's time over ours: median, 10 %, 90 % of the rounds; `None` where one was not measured.
    pub ratio: Option<[f64; 3]>,
    /// Least ratio that is good enough.
    pub must: f64,
    /// Ratio that is wanted.
    pub aim: f64,
}

/// Ours against whom, and by how much.
struct Line(&'static str, &'static str, &'static str, Peer, f64, f64);

/// Who it is compared with.
enum Peer {
    /// The faster one of CasADi's two codes in each round.
    Casadi,
    /// By name.
    Named(&'static str),
    /// Ours for another size; the ratio is turned, so that growth stands in it.
    Growth(&'static str),
}

const LINES: [Line; 19] = [
    Line("{Φ, Φ_q, Φ_t, γ}, four-bar, against CasADi's C", "four_bar", "emitted", Peer::Casadi, 3.5, 5.0),
    Line("…, Andrews", "andrews", "emitted", Peer::Casadi, 3.5, 5.0),
    Line("…, ten loops in natural coordinates", "chain", "emitted", Peer::Casadi, 1.1, 1.4),
    Line("four-bar, against SymPy's C", "four_bar", "emitted", Peer::Named("sympy"), 2.3, 3.0),
    Line("Andrews, against SymPy's C", "andrews", "emitted", Peer::Named("sympy"), 2.3, 3.0),
    Line("four-bar, against forward dual numbers", "four_bar", "emitted", Peer::Named("dual"), 3.0, 4.0),
    Line("Andrews, against forward dual numbers", "andrews", "emitted", Peer::Named("dual"), 3.0, 4.0),
    Line(
        "four-bar, against central differences",
        "four_bar",
        "emitted",
        Peer::Named("differences"),
        30.0,
        40.0,
    ),
    Line(
        "Andrews, against central differences",
        "andrews",
        "emitted",
        Peer::Named("differences"),
        30.0,
        40.0,
    ),
    Line("four-bar, against Rust by hand", "four_bar", "emitted", Peer::Named("by_hand"), 1.0 / 1.1, 1.0),
    Line("Andrews, against Rust by hand", "andrews", "emitted", Peer::Named("by_hand"), 1.0 / 1.1, 1.0),
    Line(
        "four-bar, 8 lanes, a mechanism, against CasADi's C",
        "four_bar",
        "emitted_lanes",
        Peer::Casadi,
        12.0,
        18.0,
    ),
    Line(
        "Andrews, 8 lanes, a mechanism, against CasADi's C",
        "andrews",
        "emitted_lanes",
        Peer::Casadi,
        12.0,
        18.0,
    ),
    Line(
        "kinematic step, four-bar, against CasADi's Newton from the same prediction",
        "four_bar_step",
        "emitted",
        Peer::Named("casadi_predicted"),
        8.0,
        12.0,
    ),
    Line(
        "kinematic step, four-bar, against nalgebra's dense Newton–Raphson",
        "four_bar_step",
        "emitted",
        Peer::Named("nalgebra"),
        8.0,
        15.0,
    ),
    Line(
        "kinematic step, four-bar, against Rust by hand",
        "four_bar_step",
        "emitted",
        Peer::Named("by_hand"),
        1.0 / 1.1,
        1.0,
    ),
    Line(
        "kinematic step, ten loops, against CasADi's Newton from the same prediction",
        "chain_step",
        "emitted",
        Peer::Named("casadi_predicted"),
        8.0,
        13.0,
    ),
    Line(
        "8-lane batch step, four-bar, a mechanism, against the single step",
        "four_bar_step",
        "emitted_lanes",
        Peer::Named("emitted"),
        4.0,
        7.0,
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

/// All goals with what was reached.
pub fn reached(measured: &Measured) -> Vec<Goal> {
    LINES
        .iter()
        .map(|Line(work, problem, own, peer, must, aim)| {
            let ratio = || -> Option<[f64; 3]> {
                let own: &Implementation = measured.of(problem, own)?;
                Some(match peer {
                    Peer::Casadi => {
                        let (plain, shared) =
                            (measured.of(problem, "casadi_plain")?, measured.of(problem, "casadi_shared")?);
                        own.faster_than(&faster(plain, shared))
                    }
                    Peer::Named(name) => own.faster_than(measured.of(problem, name)?),
                    Peer::Growth(name) => measured.of(problem, name)?.faster_than(own),
                })
            };
            Goal { work, ratio: ratio(), must: *must, aim: *aim }
        })
        .collect()
}

impl Goal {
    /// Whether less is better.
    pub fn is_limit(&self) -> bool {
        self.aim < self.must
    }

    /// What was reached over what must be, above 1 where it is.
    pub fn part(&self) -> Option<f64> {
        let [median, ..] = self.ratio?;
        Some(if self.is_limit() { self.must / median } else { median / self.must })
    }

    /// In words.
    pub fn verdict(&self) -> &'static str {
        let (Some(part), Some([median, ..])) = (self.part(), self.ratio) else { return "not measured" };
        let wanted = if self.is_limit() { median <= self.aim } else { median >= self.aim };
        match (part >= 1.0, wanted) {
            (_, true) => "aim reached",
            (true, false) => "reached",
            (false, false) => "missed",
        }
    }
}
