//! Several mechanisms in motion side by side: designs, or phases of one turn.

mod assembly;
mod changes;
mod groups;
pub(crate) mod lane_state;
pub(crate) mod statistics;

use core::array::from_fn;
use core::f64::consts::PI;

use crate::batch::groups::Prepared;
use crate::batch::lane_state::Standing;
use crate::batch::statistics::Notes;
use crate::block_solvers::convergence::Statistics;
use crate::block_solvers::fast_newton::PLAIN;
use crate::failure::{Failure, FailureKind};
use crate::mechanism::phase::Phase;
use crate::mechanism::{Kinematic, Mechanism};
use crate::scalar::lanes::{LaneMask, Lanes};
use crate::scalar::number::{Real, Scalar};
use crate::stepper::Stepper;
use crate::stepper::fast_step::{FastStep, Start};
use crate::stepper::whole_turns::second;

/// `L` mechanisms of one text, a lane each, each with its own design, time, state and failures.
///
/// A step is taken in all lanes at once. An exceptional lane is stepped alone, by the [`Stepper`] that it would have as a
/// single mechanism, without effect on the others. Exceptions are no convergence, the singular zone, a passage, a branch, a
/// limit, and an uncertain assembly, as after an input that jumps. So each lane has, to round-off, the results of a single
/// mechanism. Phases of drives that prescribe a rate move on in all lanes at once too. Where a coordinate turns, a lane is
/// stepped alone only to take a whole turn off.
///
/// ```
/// use mbs_runtime::{Batch, Lanes, mechanism};
///
/// # mechanism! {
/// #     /// A crank and a rod that slides along x.
/// #     pub mechanism Crank;
/// #     param r: m = 50mm;
/// #     coord theta: rad = 0;
/// #     coord phi: rad = 0;
/// #     coord x: m = 0.23;
/// #     constraint closure { r*unit(theta) + 180mm*unit(phi) == [x, 0]; }
/// #     drive motor: theta == 30 [rad/s]*t;
/// #     branch ahead: cos(phi) > 0;
/// # }
///
/// let designs = Crank { r: Lanes([0.03, 0.05, 0.07, 0.2]), ..Crank::default() };
/// let batch = Batch::assemble_each(designs, &[[0.0, 0.0, 0.23]; 4], [0.0; 4]);
/// let mut batch = batch.expect("one of the designs can be assembled");
/// for step in 1..=100 {
///     for (lane, result) in batch.advance_to([0.002 * f64::from(step); 4]).into_iter().enumerate() {
///         if let Err(failure) = result {
///             batch.retire(lane, failure); // a crank longer than its rod cannot turn around
///         }
///     }
/// }
/// assert!(batch.failures().map(|failure| failure.is_some()) == [false, false, false, true]);
/// assert!((batch.q()[0].0[1] - 6.0).abs() < 1e-12);
/// ```
#[derive(Clone)]
pub struct Batch<S, R, const L: usize, const N: usize, const M: usize = N>
where
    S: Kinematic<Lanes<R, L>, N, M>,
    R: Real,
{
    /// With the phases of drives that prescribe a rate, of all lanes.
    mechanism: S,
    parameters: S::Parameters,
    /// Reciprocals of the coordinates' scales.
    weights: [Lanes<R, L>; N],
    /// Both, of each group, where lanes are computed in groups.
    groups: [Option<Prepared<S::Group, S::GroupNumber, N, M>>; L],
    t: Lanes<R, L>,
    /// The time of lanes with coordinates that turn, with the part that its rounding has left out.
    clock: Phase<Lanes<R, L>>,
    q: [Lanes<R, L>; N],
    qd: [Lanes<R, L>; N],
    qdd: [Lanes<R, L>; N],
    margin: Lanes<R, L>,
    notes: Notes<R, L>,
    /// Lanes that are out.
    out: LaneMask<R, L>,
    /// Lanes whose next step cannot be plain: those that are out, and those with an input that is none.
    waits: LaneMask<R, L>,
    /// Lanes whose parameters or inputs were changed since they were solved.
    changed: [bool; L],
    /// Changed lanes in which rows may have come back: their steppers tell.
    folds: [bool; L],
    /// Lanes whose steppers do not have the parameters and inputs of the fields above.
    outdated: [bool; L],
    /// In changed lanes, parameters, inputs and phases as they were when the lane was solved.
    solved: S::Values,
    /// Failures of the lanes that are out.
    retired: [Option<Failure>; L],
    /// Scalar steppers of the lanes; the fields above are not up to date in them.
    steppers: [Stepper<S::Lane, R, N, M>; L],
}

impl<S, R, const L: usize, const N: usize, const M: usize> Batch<S, R, L, N, M>
where
    S: Kinematic<Lanes<R, L>, N, M>,
    S::Lane: Kinematic<R, N, M>,
    R: Real,
{
    /// Moves each lane on to its time `t` (L, s).
    ///
    /// Returns the statistics of each lane's step, or its failure. A lane that failed is bit for bit what it was, the others
    /// have moved. See [`Stepper::advance_to`].
    #[inline]
    pub fn advance_to(&mut self, t: [R; L]) -> [Result<Statistics, Failure>; L] {
        match self.moved(t) {
            None => from_fn(|lane| Ok(self.notes.statistics(lane))),
            Some(steps) => steps,
        }
    }

    /// Moves all lanes on to their times; returns their results, unless all steps were plain.
    ///
    /// Called, so that the cost of a step is read out of the notes only on request.
    #[inline(never)]
    fn moved(&mut self, t: [R; L]) -> Option<[Result<Statistics, Failure>; L]> {
        let before = self.mechanism.phases();
        let (from, to) = self.span(t);
        if const { !S::PHASES.is_empty() } {
            self.mechanism.advance_phases(from, to);
        }
        let plain = if const { Self::IN_GROUPS } {
            self.group_by_group(from, to)
        } else {
            self.together([from, to], &t)
        };
        if let Some(plain) = plain {
            return Some(self.apart(plain, &before, t));
        }
        self.changed = [false; L];
        self.pass_time(Lanes::<R, L>::mask(true), Lanes(t));
        if const { !S::TURNS.is_empty() } {
            self.take_turns_off();
        }
        None
    }

    /// Steps all lanes at once to their times `t` (s); returns the lanes that have moved, unless all have.
    #[inline(always)]
    fn together(&mut self, [from, to]: [Lanes<R, L>; 2], t: &[R; L]) -> Option<LaneMask<R, L>> {
        let Batch { mechanism, parameters, weights, q, qd, qdd, margin, .. } = &*self;
        let start = Start { t: from, q, qd, qdd, margin: *margin, weights };
        let trial = FastStep::of::<S, M, PLAIN>(mechanism, parameters, &start, to, !self.waits);
        if !Lanes::<R, L>::all(trial.quick) || self.notes.passes(&trial.orientation) {
            // The address of a copy, so that the trial itself stays in registers.
            let doubtful = trial;
            return Some(self.judged(&doubtful, t));
        }
        self.notes.follow(&trial, self.margin, to - from);
        self.margin = trial.margin;
        for (old, new) in [(&mut self.q, &trial.q), (&mut self.qd, &trial.qd), (&mut self.qdd, &trial.qdd)] {
            for (old, new) in old.iter_mut().zip(new) {
                Lanes::<R, L>::side_by_side();
                *old = *new;
            }
        }
        None
    }

    /// Moves on the lanes of a step of all lanes that is plain there; returns these.
    #[cold]
    #[inline(never)]
    fn judged(&mut self, trial: &FastStep<Lanes<R, L>, N>, t: &[R; L]) -> LaneMask<R, L> {
        // The times themselves stay in registers, too.
        let (from, to) = self.span(*t);
        let Batch { q, qd, qdd, margin, weights, .. } = &*self;
        let start = Start { t: from, q, qd, qdd, margin: *margin, weights };
        let scales = self.mechanism.coordinate_scales(&self.parameters);
        let plain = self.plain(trial, 0, &start, to, &scales);
        self.take_over(trial, 0, plain, (self.margin, to - from));
        plain
    }

    /// The times between which the lanes step to `t` (L, s). If coordinates turn, no function knows the time, and a step is one
    /// from 0 on.
    #[inline(always)]
    fn span(&self, t: [R; L]) -> (Lanes<R, L>, Lanes<R, L>) {
        match S::TURNS {
            [] => (self.t, Lanes(t)),
            _ => (Lanes::constant(0.0), Lanes(t) - self.t),
        }
    }

    /// Lets the time of the lanes of `moved` be `t` (s).
    #[inline(always)]
    fn pass_time(&mut self, moved: LaneMask<R, L>, t: Lanes<R, L>) {
        if const { S::TURNS.is_empty() } {
            self.t = Lanes::select(moved, t, self.t);
            return;
        }
        let clock = self.clock.advanced(t - self.t, second());
        self.clock = clock.where_true(moved, self.clock);
        self.t = self.clock.value;
    }

    /// Takes whole turns off in the lanes where a coordinate that turns has left its own.
    #[inline(always)]
    fn take_turns_off(&mut self) {
        let half = Lanes::constant(PI);
        let beyond = |mask, turning: &u16| match self.q.get(usize::from(*turning)) {
            Some(angle) => mask | half.less(angle.abs()),
            None => mask,
        };
        let beyond = S::TURNS.iter().fold(Lanes::<R, L>::mask(false), beyond);
        if !Lanes::<R, L>::all(!beyond) {
            self.take_turns_off_alone(beyond);
        }
    }

    #[cold]
    #[inline(never)]
    fn take_turns_off_alone(&mut self, beyond: LaneMask<R, L>) {
        for lane in (0..L).filter(|lane| Lanes::<R, L>::test(beyond, *lane)) {
            if let Some(stepper) = self.up_to_date(lane) {
                stepper.take_turns_off();
            }
            self.gather(lane);
        }
    }

    /// Steps alone what is not among the lanes `plain`, which have moved to their times `t`, with phases that were `before`.
    #[cold]
    #[inline(never)]
    fn apart(
        &mut self,
        plain: LaneMask<R, L>,
        before: &S::Phases,
        t: [R; L],
    ) -> [Result<Statistics, Failure>; L] {
        let mut phases = self.mechanism.phases();
        for (phase, before) in phases.as_mut().iter_mut().zip(before.as_ref()) {
            *phase = phase.where_true(plain, *before);
        }
        self.mechanism.set_phases(phases);
        self.changed = from_fn(|lane| at(&self.changed, lane, false) && !Lanes::<R, L>::test(plain, lane));
        self.pass_time(plain, Lanes(t));
        if const { !S::TURNS.is_empty() } {
            self.take_turns_off();
        }
        from_fn(|lane| {
            if !Lanes::<R, L>::test(plain, lane) {
                return self.alone(lane, Lanes(t).lane(lane));
            }
            Ok(self.notes.statistics(lane))
        })
    }

    /// The mechanism in lane `lane` alone; `None` where there is no such lane, or it has never been assembled.
    pub fn stepper(&self, lane: usize) -> Option<Stepper<S::Lane, R, N, M>> {
        let mut stepper = self.steppers.get(lane).cloned()?;
        let standing = self.standing(lane);
        if standing.t.to_f64().is_nan() {
            return None;
        }
        standing.hand_over(&mut stepper, &self.mechanism, &self.solved, lane);
        Some(stepper)
    }

    /// Times (s).
    pub fn t(&self) -> Lanes<R, L> {
        self.t
    }

    /// Coordinates: N.
    pub fn q(&self) -> &[Lanes<R, L>; N] {
        &self.q
    }

    /// Velocities: N, in coordinate unit per second.
    pub fn qd(&self) -> &[Lanes<R, L>; N] {
        &self.qd
    }

    /// Accelerations: N, in coordinate unit per second squared.
    pub fn qdd(&self) -> &[Lanes<R, L>; N] {
        &self.qdd
    }

    /// The step of one lane as if it were alone.
    #[cold]
    #[inline(never)]
    fn alone(&mut self, lane: usize, t: R) -> Result<Statistics, Failure> {
        if let Some(failure) = at(&self.retired, lane, None) {
            return Err(failure);
        }
        let Some(stepper) = self.up_to_date(lane) else {
            return Err(FailureKind::NonFinite { name: "t", line: 0 }.without_time());
        };
        let statistics = stepper.advance_to(t)?;
        self.gather(lane);
        Ok(statistics)
    }

    /// The stepper of a lane, where the lane is.
    fn up_to_date(&mut self, lane: usize) -> Option<&mut Stepper<S::Lane, R, N, M>> {
        let standing = self.standing(lane);
        let stepper = self.steppers.get_mut(lane)?;
        standing.hand_over(stepper, &self.mechanism, &self.solved, lane);
        set(&mut self.outdated, lane, false);
        Some(stepper)
    }

    /// State of a lane.
    fn standing(&self, lane: usize) -> Standing<R, N> {
        let of = |values: &[Lanes<R, L>; N]| values.map(|value| value.lane(lane));
        Standing {
            t: self.t.lane(lane),
            clock: self.clock.lane(lane),
            q: of(&self.q),
            qd: of(&self.qd),
            qdd: of(&self.qdd),
            margin: self.margin.lane(lane),
            drift: self.notes.drift(lane),
            statistics: self.notes.statistics(lane),
            passages: self.notes.passages(lane),
            orientation: self.notes.orientation(lane),
            changed: at(&self.changed, lane, false),
            folds: at(&self.folds, lane, false),
            outdated: at(&self.outdated, lane, false),
        }
    }

    /// Copies the state of a lane's stepper into the lanes.
    fn gather(&mut self, lane: usize) {
        let Some(stepper) = self.steppers.get(lane) else { return };
        let put = |lanes: &mut Lanes<R, L>, value: R| set(&mut lanes.0, lane, value);
        for (vector, values) in
            [(&mut self.q, stepper.q()), (&mut self.qd, stepper.qd()), (&mut self.qdd, stepper.qdd())]
        {
            vector.iter_mut().zip(values).for_each(|(lanes, value)| put(lanes, *value));
        }
        put(&mut self.t, stepper.t());
        put(&mut self.margin, stepper.margin());
        self.clock.put(lane, stepper.turns.clock);
        let mut phases = self.mechanism.phases();
        for (phase, own) in phases.as_mut().iter_mut().zip(stepper.mechanism().phases().as_ref()) {
            phase.put(lane, *own);
        }
        self.mechanism.set_phases(phases);
        self.notes.put(lane, stepper.state.drift, stepper.statistics());
        self.notes.count(lane, stepper.passages(), stepper.signature());
        set(&mut self.changed, lane, stepper.changed);
        self.note_waiting(lane);
    }

    /// Records if lane `lane` is out, and if its next step can be plain.
    fn note_waiting(&mut self, lane: usize) {
        let out = at(&self.retired, lane, None).is_some();
        let waits = self.steppers.get(lane).is_none_or(Stepper::waits);
        self.out = self.out.with(lane, out);
        self.waits = self.waits.with(lane, out || waits);
    }
}

/// The value of lane `lane`, of which there is one; `none` could not be.
#[inline(always)]
fn at<X: Copy, const L: usize>(values: &[X; L], lane: usize, none: X) -> X {
    values.get(lane).copied().unwrap_or(none)
}

fn set<X, const L: usize>(values: &mut [X; L], lane: usize, value: X) {
    if let Some(slot) = values.get_mut(lane) {
        *slot = value;
    }
}
