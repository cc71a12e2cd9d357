//! State handed from a batch lane to its scalar stepper.

use crate::block_solvers::convergence::Statistics;
use crate::kinematics::homotopy::leads;
use crate::mechanism::phase::Phase;
use crate::mechanism::{Kinematic, Mechanism};
use crate::scalar::lanes::Lanes;
use crate::scalar::number::{Real, Scalar};
use crate::stepper::Stepper;
use crate::stepper::state::Drift;

/// Data with which the stepper of a lane goes on from the state of the lane. Phases, and parameters and inputs since they were
/// changed, are taken from the mechanism.
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
    /// `true` if parameters or inputs were changed since the lane was solved.
    pub changed: bool,
    /// `true` if rows may have come back on the way of such a change.
    pub folds: bool,
    /// `true` if they are not those of the stepper.
    pub outdated: bool,
}

impl<R: Real, const N: usize> Standing<R, N> {
    /// Puts `stepper` at the state of lane `lane` of `mechanism`; where it was changed, `solved` holds the values before.
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
        if self.changed && stepper.leads() {
            stepper.lead_far();
        }
        (stepper.changed, stepper.folds) = (self.changed, self.folds);
        let mut phases = stepper.mechanism.phases();
        for (own, phase) in phases.as_mut().iter_mut().zip(mechanism.phases().as_ref()) {
            *own = phase.lane(lane);
        }
        stepper.mechanism.set_phases(phases);
    }
}
