//! Check of the command line for options that an analysis does not use.

use super::Request;
use crate::commands::CommandError;
use crate::commands::target::Target;

/// Options present on the command line, and properties of the method that runs.
#[derive(Clone, Copy, Default)]
pub struct UsedOptions {
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
    /// `true` if the method that runs is a penalty.
    pub penalty: bool,
    /// `true` if the method that runs has steps of its own.
    pub implicit: bool,
    /// `true` if the method is `radau`, which adapts steps of its own.
    pub radau: bool,
    /// `true` if the method damps violations.
    pub damped: bool,
    /// `true` if the steps of an explicit integrator adapt themselves.
    pub adaptive: bool,
}

impl Request {
    /// Fails if the command line has an option that the analysis does not use.
    pub(super) fn require_use(&self, target: &Target) -> Result<(), CommandError> {
        let moved = self.is_moved(target);
        let of_motion =
            "is how a motion from forces is integrated: use `mbs simulate`, or `mbs modes` with `--at`";
        let UsedOptions { implicit, damped, adaptive, .. } = self.used_options;
        let useless = [
            (!moved && self.used_options.method, "`--method`", of_motion),
            (!moved && self.used_options.integrator, "`--integrator`", of_motion),
            (!moved && self.used_options.step, "`--step`", of_motion),
            (!moved && self.used_options.tolerance, "`--tolerance`", of_motion),
            (
                !moved && self.used_options.damping,
                "`--frequency` and `--damping`",
                "belong to `--method baumgarte` or `penalty` of a motion from forces",
            ),
            (
                !damped && self.used_options.damping,
                "`--frequency` and `--damping`",
                "belong to `--method baumgarte` or `penalty`",
            ),
            (!moved && self.used_options.alpha, "`--alpha`", of_motion),
            (
                !self.used_options.penalty && self.used_options.alpha,
                "`--alpha`",
                "belongs to `--method penalty`",
            ),
            (
                implicit && self.used_options.integrator,
                "`--integrator`",
                "is for methods without steps of their own; others take `--step`",
            ),
            (
                self.used_options.radau && self.used_options.integrator,
                "`--integrator`",
                "is for methods without steps of their own; `radau` adapts its steps to `--tolerance`",
            ),
            (
                implicit && self.used_options.tolerance,
                "`--tolerance`",
                "is for adaptive steps; this method takes `--step`",
            ),
            (
                !implicit && adaptive && self.used_options.step,
                "`--step`",
                "is for methods with steps of their own and for `--integrator rk4` or `euler`; adaptive steps take `--tolerance`",
            ),
            (
                !implicit && !adaptive && self.used_options.tolerance,
                "`--tolerance`",
                "is for adaptive steps; equal ones take `--step`",
            ),
        ];
        match useless.into_iter().find(|(is, ..)| *is) {
            Some((_, option, reason)) => Err(CommandError::Usage(format!("{option} {reason}"))),
            None => Ok(()),
        }
    }

    /// Fails if a motion from forces has too many equal steps for a reasonable time of computation.
    pub(super) fn require_end(&self, target: &Target, times: &[f64]) -> Result<(), CommandError> {
        /// One or two minutes for the smallest mechanisms.
        const MOST_STEPS: f64 = 1e8;
        let (Some(longest), Some(duration)) = (self.approach().longest(), times.last()) else {
            return Ok(());
        };
        let steps = duration / longest;
        if steps <= MOST_STEPS || !self.is_moved(target) {
            return Ok(());
        }
        let adapt =
            if self.used_options.implicit { "" } else { ", or let them adapt: `--integrator order8`" };
        Err(CommandError::Usage(format!(
            "steps of {longest:e} s to t = {duration} s are {steps:.1e}, more than the {MOST_STEPS:.0e} of a run: end earlier, take \
             longer ones by `--step`{adapt}"
        )))
    }
}
