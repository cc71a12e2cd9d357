//! The ratios that the project wants to reach.

use super::run::{Implementation, Measured, fastest};

/// A ratio with its goal.
pub struct Goal {
    /// Description of the compared work.
    pub work: &'static str,
    /// The peer's time over ours: median, 10 %, 90 % of the rounds; `None` where one was not measured.
    pub ratio: Option<[f64; 3]>,
    /// The median for the default target.
    pub default: Option<f64>,
    /// Least ratio that is good enough.
    pub must: f64,
    /// Ratio that is wanted.
    pub aim: f64,
}

/// A line of the table: work in words, problem, ours, against whom, least ratio, wanted ratio; NaN where none is asked.
pub struct Line(pub &'static str, pub &'static str, pub &'static str, pub Peer, pub f64, pub f64);

/// Goal of a ratio that is only shown.
pub const SHOWN: f64 = f64::NAN;

/// Peer of a comparison.
pub enum Peer {
    /// The fastest one of these in each round.
    Fastest(&'static [&'static str]),
    /// Ours for another size; the ratio is inverted to show the growth.
    Growth(&'static str),
}

/// All goals with the ratios reached on this processor and on the default target.
pub fn reached(lines: &[Line], native: &Measured, default: &Measured) -> Vec<Goal> {
    lines
        .iter()
        .map(|line| Goal {
            work: line.0,
            ratio: line.ratio(native),
            default: line.ratio(default).map(|[median, ..]| median),
            must: line.4,
            aim: line.5,
        })
        .collect()
}

impl Line {
    /// The peer's time over ours: median, 10 %, 90 % of the rounds.
    fn ratio(&self, measured: &Measured) -> Option<[f64; 3]> {
        let Line(_, problem, own, peer, ..) = self;
        let own: &Implementation = measured.of(problem, own)?;
        Some(match peer {
            Peer::Fastest(names) => {
                let peers: Option<Vec<&Implementation>> =
                    names.iter().map(|name| measured.of(problem, name)).collect();
                own.faster_than(&fastest(&peers?))
            }
            Peer::Growth(name) => measured.of(problem, name)?.faster_than(own),
        })
    }
}

impl Goal {
    /// `true` if a smaller ratio is better.
    pub fn is_limit(&self) -> bool {
        self.aim < self.must
    }

    /// Ratio reached over the least one, at least 1 if the goal is met; `None` if there is no goal or no measurement.
    pub fn part(&self) -> Option<f64> {
        let [median, ..] = self.ratio?;
        let part = if self.is_limit() { self.must / median } else { median / self.must };
        (!part.is_nan()).then_some(part)
    }

    /// Ratio wanted over the least one.
    pub fn wanted_part(&self) -> f64 {
        if self.is_limit() { self.must / self.aim } else { self.aim / self.must }
    }

    /// Verdict in words.
    pub fn verdict(&self) -> &'static str {
        let Some([median, ..]) = self.ratio else { return "not measured" };
        let Some(part) = self.part() else { return "" };
        let wanted = if self.is_limit() { median <= self.aim } else { median >= self.aim };
        match (part >= 1.0, wanted) {
            (_, true) => "aim reached",
            (true, false) => "reached",
            (false, false) => "**missed**",
        }
    }
}
