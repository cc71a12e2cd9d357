//! Changes of parameters and inputs between steps.

use crate::batch::{Batch, at};
use crate::failure::checks::are_valid;
use crate::kinematics::homotopy::{LARGEST_PIECE, differ, largest_change, put_short_way_round};
use crate::linear_algebra::vectors::weights;
use crate::mechanism::Kinematic;
use crate::scalar::lanes::{LaneMask, Lanes};
use crate::scalar::number::{Real, Scalar};

impl<S, R, const L: usize, const N: usize, const M: usize> Batch<S, R, L, N, M>
where
    S: Kinematic<Lanes<R, L>, N, M>,
    S::Lane: Kinematic<R, N, M>,
    R: Real,
{
    /// Changes parameters or inputs of any lanes; see [`Stepper::change`](crate::Stepper::change).
    pub fn change<X>(&mut self, change: impl FnOnce(&mut S) -> X) -> X {
        if self.changed == [false; L] {
            self.solved = self.mechanism.values();
        } else {
            self.keep_solved();
        }
        let noted = !(S::TURNING_INPUTS.is_empty() && S::FOLDING.is_empty());
        let before = noted.then(|| self.mechanism.values());
        let result = change(&mut self.mechanism);
        if let Some(before) = before {
            self.go_short_way_round(&before);
            let now = self.mechanism.values();
            let changed = self.changed;
            for (lane, folds) in self.folds.iter_mut().enumerate() {
                let [old, new] = [&before, &now].map(|values| values.as_ref());
                let differs = differ(S::FOLDING, old, new, lane);
                *folds = (at(&changed, lane, false) & *folds) | differs;
            }
        }
        self.parameters = self.mechanism.parameters();
        self.weights = weights(&self.mechanism.coordinate_scales(&self.parameters));
        if const { Self::IN_GROUPS } {
            self.groups = Self::prepared(&self.mechanism);
        }
        // The steppers get theirs where they are needed.
        (self.changed, self.outdated) = ([true; L], [true; L]);
        self.waits = self.out | !are_valid(&self.mechanism);
        let change = largest_change(S::ANGLES, &self.solved, &self.mechanism.values());
        self.waits = self.waits | Lanes::constant(LARGEST_PIECE).less(change);
        // Only its own stepper knows what a lane was changed from.
        self.waits = self.waits | LaneMask::new(self.folds);
        result
    }

    /// Lets inputs that turn go the short way round from their values `before` a change, in each lane.
    fn go_short_way_round(&mut self, before: &S::Values) {
        let now = self.mechanism.values();
        for index in S::TURNING_INPUTS.iter().map(|index| usize::from(*index)) {
            let solved = self.solved.as_mut().get_mut(index);
            let (Some(solved), Some(before), Some(now)) =
                (solved, before.as_ref().get(index), now.as_ref().get(index))
            else {
                continue;
            };
            for (lane, stepper) in self.steppers.iter_mut().enumerate() {
                let (from, to) = ([before.lane(lane)], [now.lane(lane)]);
                if let Some(solved) = solved.0.get_mut(lane) {
                    put_short_way_round(&[0], core::slice::from_mut(solved), &from, &to);
                }
                // That of a lane next to a singular position, which is led from farther away.
                if let Some(kept) = stepper.anchor.values.as_mut().get_mut(index) {
                    put_short_way_round(&[0], core::slice::from_mut(kept), &from, &to);
                }
            }
        }
    }

    /// Takes parameters, inputs and phases of the lanes that were solved since they were changed last.
    #[cold]
    #[inline(never)]
    fn keep_solved(&mut self) {
        let changed = LaneMask::new(self.changed);
        let now = self.mechanism.values();
        for (old, new) in self.solved.as_mut().iter_mut().zip(now.as_ref()) {
            *old = Lanes::select(changed, *old, *new);
        }
    }
}
