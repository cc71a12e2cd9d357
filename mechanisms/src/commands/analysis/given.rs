//! What the command line says that an analysis has no use for.

use super::{Analysis, Wish};
use crate::commands::CommandError;
use crate::commands::subject::Subject;

/// Which options the command line has.
#[derive(Clone, Copy, Default)]
pub struct Given {
    /// `--steps`
    pub steps: bool,
    /// `--method`
    pub method: bool,
    /// `--integrator`
    pub integrator: bool,
    /// `--step`
    pub step: bool,
    /// `--tolerance`
    pub tolerance: bool,
    /// `--frequency` or `--damping`
    pub damping: bool,
    /// `--alpha`
    pub alpha: bool,
    /// Whether the method that runs is a penalty.
    pub penalty: bool,
    /// Whether the method that runs has steps of its own.
    pub implicit: bool,
    /// Whether it is `radau`, which adapts steps of its own.
    pub radau: bool,
    /// Whether it damps violations.
    pub damped: bool,
    /// Whether the steps of an explicit integrator adapt themselves.
    pub adaptive: bool,
}

impl Wish {
    /// Fails where the command line says what the analysis has no use for.
    pub(super) fn require_use(&self, subject: Subject) -> Result<(), CommandError> {
        let analysis = self.analysis_of(subject);
        let rest = self.is_of_rest(subject);
        let moved = self.is_moved(subject);
        let searched = matches!(analysis, Analysis::Static | Analysis::Linear);
        let of_motion =
            "is how a motion from forces is integrated: use `--analysis dynamic`, or `linear` with `--at`";
        let Given { implicit, damped, adaptive, .. } = self.given;
        let useless = [
            (
                searched && !rest && !self.guesses.is_empty(),
                "`--at`",
                "follows the motion from the text's start; a position of rest alone takes `--guess`",
            ),
            (
                !searched && !self.guesses.is_empty(),
                "`--guess`",
                "is where the search for rest starts: use `--analysis static` or `linear`",
            ),
            (
                analysis != Analysis::Linear && self.at.is_some(),
                "`--at`",
                "is when small motions are looked at: use `--analysis linear`; a motion ends at `--until`",
            ),
            (
                rest && self.until.is_some(),
                "`--until`",
                "is the end of a motion; a position of rest has none",
            ),
            (
                !rest && searched && self.until.is_some(),
                "`--until`",
                "is the end of a motion; small motions are looked at `--at`",
            ),
            (rest && self.given.steps, "`--steps`", "divide a motion; a position of rest has none"),
            (!moved && self.given.method, "`--method`", of_motion),
            (!moved && self.given.integrator, "`--integrator`", of_motion),
            (!moved && self.given.step, "`--step`", of_motion),
            (!moved && self.given.tolerance, "`--tolerance`", of_motion),
            (
                !moved && self.given.damping,
                "`--frequency` and `--damping`",
                "belong to `--method baumgarte` or `penalty` of a motion from forces",
            ),
            (
                !damped && self.given.damping,
                "`--frequency` and `--damping`",
                "belong to `--method baumgarte` or `penalty`",
            ),
            (!moved && self.given.alpha, "`--alpha`", of_motion),
            (!self.given.penalty && self.given.alpha, "`--alpha`", "belongs to `--method penalty`"),
            (
                implicit && self.given.integrator,
                "`--integrator`",
                "is for methods without steps of their own; an implicit one takes `--step`",
            ),
            (
                self.given.radau && self.given.integrator,
                "`--integrator`",
                "is for methods without steps of their own; `radau` adapts its steps to `--tolerance`",
            ),
            (
                implicit && self.given.tolerance,
                "`--tolerance`",
                "is for adaptive steps; an implicit method takes `--step`",
            ),
            (
                !implicit && adaptive && self.given.step,
                "`--step`",
                "is for implicit methods and for `--integrator rk4` or `euler`; adaptive steps take `--tolerance`",
            ),
            (
                !implicit && !adaptive && self.given.tolerance,
                "`--tolerance`",
                "is for adaptive steps; equal ones take `--step`",
            ),
        ];
        match useless.into_iter().find(|(is, ..)| *is) {
            Some((_, option, reason)) => Err(CommandError::Usage(format!("{option} {reason}"))),
            None => Ok(()),
        }
    }

    /// Fails where the equal steps of a motion from forces are more than anyone waits for.
    pub(super) fn require_end(&self, subject: Subject, times: &[f64]) -> Result<(), CommandError> {
        /// A minute or two of the smallest mechanisms.
        const MOST_STEPS: f64 = 1e8;
        let (Some(longest), Some(duration)) = (self.approach().longest(), times.last()) else {
            return Ok(());
        };
        let steps = duration / longest;
        if steps <= MOST_STEPS || !self.is_moved(subject) {
            return Ok(());
        }
        let adapt = if self.given.implicit { "" } else { ", or let them adapt: `--integrator order8`" };
        Err(CommandError::Usage(format!(
            "steps of {longest:e} s to t = {duration} s are {steps:.1e}, more than the {MOST_STEPS:.0e} of a run: end earlier, take \
             longer ones by `--step`{adapt}"
        )))
    }
}
