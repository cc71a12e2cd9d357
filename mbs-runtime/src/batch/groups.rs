//! Steps of as many lanes at once as fill a register, group after group.
//!
//! A register's worth of lanes goes through a chain of blocks as a single mechanism does, and what it computes with stays in registers.
//! More lanes at once would be put aside and taken up again between any two operations.

use core::array::from_fn;

use crate::batch::Batch;
use crate::block_solvers::fast_newton::PLAIN;
use crate::kinematics::link_lengths;
use crate::linear_algebra::vectors::weights;
use crate::mechanism::{Kinematic, Mechanism};
use crate::scalar::lanes::{LaneMask, Lanes};
use crate::scalar::number::{Real, Scalar};
use crate::stepper::fast_step::{FEW, FastStep, Start, foreseen, quick};

/// Values of parameters of the lanes of a group.
#[derive(Clone)]
pub(super) struct Prepared<S: Mechanism<P, N, M>, P: Scalar, const N: usize, const M: usize> {
    parameters: S::Parameters,
    /// Reciprocals of the coordinates' scales.
    weights: [P; N],
}

impl<S: Mechanism<P, N, M>, P: Scalar, const N: usize, const M: usize> Prepared<S, P, N, M> {
    fn of(mechanism: &S) -> Self {
        let parameters = mechanism.parameters();
        let weights = weights(&mechanism.coordinate_scales(&parameters));
        Prepared { parameters, weights }
    }
}

impl<S, R, const L: usize, const N: usize, const M: usize> Batch<S, R, L, N, M>
where
    S: Kinematic<Lanes<R, L>, N, M>,
    S::Lane: Kinematic<R, N, M>,
    R: Real,
{
    /// `true` if lanes are computed in groups: where they fill more registers than one, and several blocks or many coordinates do
    /// not leave them there. A few coordinates gain more from lanes that need not wait for each other.
    pub(super) const IN_GROUPS: bool = {
        let group = S::GroupNumber::LANES;
        group > 1 && group < L && L.is_multiple_of(group) && (S::BLOCK_BY_BLOCK || N > FEW)
    };

    /// Parts of `mechanism` that the groups need.
    pub(super) fn prepared(mechanism: &S) -> [Option<Prepared<S::Group, S::GroupNumber, N, M>>; L] {
        from_fn(|group| match const { Self::IN_GROUPS } && group < L / S::GroupNumber::LANES {
            true => Some(Prepared::of(&mechanism.group(group * S::GroupNumber::LANES))),
            false => None,
        })
    }

    /// Steps one group after the other; returns the lanes that have moved, unless all have.
    #[inline(always)]
    pub(super) fn group_by_group(&mut self, from: Lanes<R, L>, to: Lanes<R, L>) -> Option<LaneMask<R, L>> {
        let mut plain = None;
        // 1 in the lanes whose step may be plain.
        let moving = Lanes::select(self.waits, Lanes::constant(0.0), Lanes::constant(1.0));
        for group in 0..L / S::GroupNumber::LANES {
            self.step_group(group, [&from, &to, &moving], &mut plain);
        }
        plain
    }

    /// Steps the lanes of `group`, and takes those out of `plain` that are to be stepped alone.
    #[inline(never)]
    fn step_group(&mut self, group: usize, lanes: [&Lanes<R, L>; 3], plain: &mut Option<LaneMask<R, L>>) {
        let first = group * S::GroupNumber::LANES;
        let [from, to, moving] = lanes.map(|lanes| S::GroupNumber::read(&lanes.0, first));
        let margin = S::GroupNumber::read(&self.margin.0, first);
        let Some(Some(prepared)) = self.groups.get(group) else { return };
        let mechanism = self.mechanism.group(first);
        let scales = mechanism.coordinate_scales(&prepared.parameters);
        let [most, _] = quick::<R>(const { link_lengths::any(S::COORDINATES) });
        let zero = S::GroupNumber::constant(0.0);
        let (mut prediction, mut all) = ([zero; N], S::GroupNumber::mask(true));
        let rates = self.q.iter().zip(&self.qd).zip(&self.qdd).zip(&scales);
        for (place, (((q, qd), qdd), scale)) in prediction.iter_mut().zip(rates) {
            let state = [q, qd, qdd].map(|lanes| S::GroupNumber::read(&lanes.0, first));
            let near;
            (*place, near) = foreseen(state, to - from, *scale, most);
            all = all & near;
            S::GroupNumber::side_by_side();
        }
        let trial = FastStep::from_prediction::<S::Group, M, PLAIN>(
            (&mechanism, &prepared.parameters),
            &Start { t: from, q: &prediction, qd: &scales, qdd: &scales, margin, weights: &prepared.weights },
            (&prediction, all),
            to,
            zero.less(moving),
        );
        if !S::GroupNumber::all(trial.quick) || self.notes.passes_in_group(first, &trial) {
            // The address of a copy, so that the trial itself stays in registers.
            let doubtful = trial;
            self.judge_group(group, &doubtful, [from, to], plain);
            return;
        }
        self.notes.follow_group(&trial, first, (margin, to - from));
        trial.margin.write(&mut self.margin.0, first);
        for (old, new) in [(&mut self.q, &trial.q), (&mut self.qd, &trial.qd), (&mut self.qdd, &trial.qdd)] {
            for (old, new) in old.iter_mut().zip(new) {
                new.write(&mut old.0, first);
                S::GroupNumber::side_by_side();
            }
        }
    }

    /// Moves on the lanes of `group` where its step is plain, and takes the others out of `plain`.
    #[cold]
    #[inline(never)]
    fn judge_group(
        &mut self,
        group: usize,
        trial: &FastStep<S::GroupNumber, N>,
        [from, to]: [S::GroupNumber; 2],
        plain: &mut Option<LaneMask<R, L>>,
    ) {
        let first = group * S::GroupNumber::LANES;
        let Some(Some(Prepared { parameters, weights })) = self.groups.get(group) else { return };
        let read =
            |lanes: &[Lanes<R, L>; N]| from_fn(|i| lanes.get(i).map_or(from, |lanes| lanes.part(first)));
        let (q, qd, qdd) = (read(&self.q), read(&self.qd), read(&self.qdd));
        let margin = self.margin.part(first);
        let start = Start { t: from, q: &q, qd: &qd, qdd: &qdd, margin, weights };
        let scales = self.mechanism.group(first).coordinate_scales(parameters);
        let moved = self.plain(trial, first, &start, to, &scales);
        self.take_over(trial, first, moved, (margin, to - from));
        let mut mask = plain.unwrap_or(Lanes::<R, L>::mask(true));
        for lane in 0..S::GroupNumber::LANES {
            if !S::GroupNumber::test(moved, lane) {
                mask = mask.with(first.saturating_add(lane), false);
            }
        }
        *plain = Some(mask);
    }

    /// Lanes from `first` on in which the step `trial` from `start` to `to` is to be taken over.
    pub(super) fn plain<P: Scalar<Real = R>>(
        &self,
        trial: &FastStep<P, N>,
        first: usize,
        start: &Start<'_, P, N>,
        to: P,
        scales: &[P; N],
    ) -> P::Mask {
        let lanes = |truth: &dyn Fn(usize) -> bool| {
            let number = |lane| R::constant(if truth(lane) { 1.0 } else { 0.0 });
            P::constant(0.0).less(P::from_lanes(number))
        };
        let place = |lane: usize| first.saturating_add(lane);
        // The homotopy decides what a passage leads to.
        let passes = lanes(&|lane| trial.orientation(lane) != self.notes.orientation(place(lane)));
        let judgement = trial.judgement(start, to, scales, const { link_lengths::any(S::COORDINATES) });
        let plain = judgement.plain & !judgement.coarse & !passes;
        if P::all(!(plain & judgement.doubtful)) {
            return plain;
        }
        // Only its own stepper knows what a lane was changed from.
        let changed = lanes(&|lane| super::at(&self.changed, place(lane), false));
        let points = &const { link_lengths::points(S::COORDINATES) };
        let settles = !changed & trial.settles((points, scales), start, to);
        plain & (!judgement.doubtful | settles)
    }

    /// Takes the step over in those lanes from `first` on that are `plain`.
    pub(super) fn take_over<P: Scalar<Real = R>>(
        &mut self,
        trial: &FastStep<P, N>,
        first: usize,
        plain: P::Mask,
        drift: (P, P),
    ) {
        let merge = |old: &mut Lanes<R, L>, new: &P| {
            P::select(plain, *new, P::read(&old.0, first)).write(&mut old.0, first);
        };
        for (old, new) in [(&mut self.q, &trial.q), (&mut self.qd, &trial.qd), (&mut self.qdd, &trial.qdd)] {
            old.iter_mut().zip(new).for_each(|(old, new)| merge(old, new));
        }
        merge(&mut self.margin, &trial.margin);
        let mut notes = self.notes;
        notes.follow_group(trial, first, drift);
        for lane in (0..P::LANES).filter(|lane| P::test(plain, *lane)) {
            let place = first.saturating_add(lane);
            self.notes.put(place, notes.drift(place), notes.statistics(place));
        }
    }
}
