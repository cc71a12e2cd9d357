//! The ratios that the project wants to reach.

use super::run::{Implementation, Measured, fastest};

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

/// A line of the table: work in words, problem, ours, against whom, least ratio, wanted ratio.
pub struct Line(pub &'static str, pub &'static str, pub &'static str, pub Peer, pub f64, pub f64);

/// Who it is compared with.
pub enum Peer {
    /// The fastest one of these in each round.
    Fastest(&'static [&'static str]),
    /// Ours for another size; the ratio is turned, so that growth stands in it.
    Growth(&'static str),
}

/// All goals with what was reached.
pub fn reached(lines: &[Line], measured: &Measured) -> Vec<Goal> {
    lines
        .iter()
        .map(|Line(work, problem, own, peer, must, aim)| {
            let ratio = || -> Option<[f64; 3]> {
                let own: &Implementation = measured.of(problem, own)?;
                Some(match peer {
                    Peer::Fastest(names) => {
                        let peers: Option<Vec<&Implementation>> =
                            names.iter().map(|name| measured.of(problem, name)).collect();
                        own.faster_than(&fastest(&peers?))
                    }
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
