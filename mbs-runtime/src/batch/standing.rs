//! Where a lane of several mechanisms stands.

use crate::diagnosis::Statistics;
use crate::path::leads;
use crate::stepper::Drift;
use crate::{Kinematic, Lanes, Mechanism, Phase, Real, Scalar, Stepper};

/// All that the stepper of a lane has to know to go on from where the lane is, but for what the mechanism has: phases, and
/// parameters and inputs since they were changed.
pub(super) struct Standing<R, const N: usize> {
    pub t: R,
    pub clock: Phase<R>,
    pub q: [R; N],
    pub qd: [R; N],
    pub qdd: [R; N],
    pub margin: R,
    pub drift: Drift<R>,
    pub statistics: Statistics,
    pub passages: u32,
    pub orientation: u64,
    /// Whether parameters or inputs were changed since the lane was solved.
    pub changed: bool,
    /// Whether they are not those of the stepper.
    pub outdated: bool,
}

impl<R: Real, const N: usize> Standing<R, N> {
    /// Puts `stepper` where lane `lane` of `mechanism` stands; where it was changed, `solved` is what it was before.
    pub fn hand_over<S, X, const L: usize, const M: usize>(
        self,
        stepper: &mut Stepper<X, R, N, M>,
        mechanism: &S,
        solved: &S::Values,
        lane: usize,
    ) where
        S: Mechanism<Lanes<R, L>, N, M, Lane = X>,
        X: Kinematic<R, N, M>,
    {
        stepper.state.set((self.t, self.q, self.qd, self.qdd), self.margin);
        stepper.state.note(self.drift, self.statistics, self.passages, self.orientation);
        stepper.turns.clock = self.clock;
        stepper.led &= !leads(self.margin);
        // Nearer to a singular position the stepper has what belongs to the last position that leads on.
        if self.changed && leads(self.margin) {
            for (own, solved) in stepper.anchor.values.as_mut().iter_mut().zip(solved.as_ref()) {
                *own = solved.lane(lane);
            }
        }
        if self.outdated {
            stepper.mechanism = mechanism.lane(lane);
            stepper.take_up();
        }
        if self.changed {
            stepper.lead_far();
        }
        stepper.changed = self.changed;
        let mut phases = stepper.mechanism.phases();
        for (own, phase) in phases.as_mut().iter_mut().zip(mechanism.phases().as_ref()) {
            *own = phase.lane(lane);
        }
        stepper.mechanism.set_phases(phases);
    }
}
