//! Several mechanisms in motion side by side: designs, or phases of one turn.

use core::array::from_fn;

use crate::diagnosis::Statistics;
use crate::lanes::LaneMask;
use crate::stepper::Drift;
use crate::trial::{Start, Trial, weights};
use crate::{Failure, Kinematic, Lanes, Mechanism, Real, Scalar, Stepper};

/// `L` mechanisms of one text, a lane each, each with its own design, time, state and failures.
///
/// A step is taken in all lanes at once. A lane in which something else happens than next to a regular position (no
/// convergence, the singular zone, a branch, a limit, a doubt about the assembly, changed inputs) is taken alone, by the
/// [`Stepper`] that it would have as a single mechanism; the others do not notice. So each lane is, to round-off, what it
/// is alone. Drives that prescribe a rate are taken alone in every step.
#[derive(Clone)]
pub struct Batch<S, R, const L: usize, const N: usize, const M: usize = N>
where
    S: Mechanism<Lanes<R, L>, N, M>,
    R: Real,
{
    mechanism: S,
    parameters: S::Parameters,
    /// Reciprocals of the coordinates' scales.
    weights: [Lanes<R, L>; N],
    t: Lanes<R, L>,
    q: [Lanes<R, L>; N],
    qd: [Lanes<R, L>; N],
    qdd: [Lanes<R, L>; N],
    margin: Lanes<R, L>,
    notes: Notes<R, L>,
    /// Lanes whose next step has more to do than follow the rates.
    waits: LaneMask<R, L>,
    /// What a lane has besides; what stands above is not up to date here.
    steppers: [Stepper<S::Lane, R, N, M>; L],
}

/// What the last step of each lane left behind, beside its position and rates.
#[derive(Clone, Copy)]
struct Notes<R, const L: usize> {
    drift: Drift<Lanes<R, L>>,
    residual: Lanes<R, L>,
    correction: Lanes<R, L>,
    row: [u16; L],
    evaluations: [u32; L],
    fallback: [bool; L],
    passed: [bool; L],
    passages: [u32; L],
    orientation: [u64; L],
}

/// Time, position, velocity and acceleration of a lane.
type LaneState<R, const N: usize> = (R, [R; N], [R; N], [R; N]);

impl<S, R, const L: usize, const N: usize, const M: usize> Batch<S, R, L, N, M>
where
    S: Kinematic<Lanes<R, L>, N, M>,
    S::Lane: Kinematic<R, N, M>,
    R: Real,
{
    /// Assembles each lane of `mechanism` from its `guess` (L of N) at its time `t` (L, s).
    ///
    /// # Errors
    /// The first lane that cannot be assembled, with its failure; see [`Stepper::assemble`].
    #[allow(
        clippy::result_large_err,
        reason = "once, before the motion, and there is no heap to keep a failure on"
    )]
    pub fn assemble(mechanism: S, guess: &[[R; N]; L], t: [R; L]) -> Result<Self, (usize, Failure)> {
        let assembled: [Result<_, Failure>; L] = from_fn(|lane| {
            let start = guess.get(lane).copied().unwrap_or([R::constant(0.0); N]);
            Stepper::assemble(mechanism.lane(lane), start, Lanes(t).lane(lane))
        });
        let mut first = None;
        for (lane, result) in assembled.iter().enumerate() {
            match result {
                Ok(stepper) => first = first.or(Some(stepper.clone())),
                Err(failure) => return Err((lane, *failure)),
            }
        }
        let Some(first) = first else {
            return Err((0, Failure::NonFinite { name: "t", line: 0 }));
        };
        let zero = Lanes([R::constant(0.0); L]);
        let parameters = mechanism.parameters();
        let steppers = assembled.map(|result| result.unwrap_or_else(|_| first.clone()));
        let (q, qd, qdd) = ([zero; N], [zero; N], [zero; N]);
        let (margin, notes, waits) = (zero, Notes::none(), LaneMask::new([false; L]));
        let weights = weights(&mechanism.coordinate_scales(&parameters));
        let mut batch =
            Batch { mechanism, parameters, weights, t: zero, q, qd, qdd, margin, notes, waits, steppers };
        (0..L).for_each(|lane| batch.gather(lane));
        Ok(batch)
    }

    /// Moves each lane on to its time `t` (L, s).
    ///
    /// Returns what the step of each lane cost (`evaluations` are those of the lane that needed most), or why it was not
    /// made: that lane then is bit for bit what it was, the others have moved. See [`Stepper::advance_to`].
    pub fn advance_to(&mut self, t: [R; L]) -> [Result<Statistics, Failure>; L] {
        if !S::PHASES.is_empty() {
            return from_fn(|lane| self.alone(lane, Lanes(t).lane(lane)));
        }
        let Batch { mechanism, parameters, weights, q, qd, qdd, margin, .. } = &*self;
        let start = Start { t: self.t, q, qd, qdd, margin: *margin, weights };
        let trial = Trial::of(mechanism, parameters, &start, Lanes(t));
        let plain = trial.plain & !self.waits;
        if !Lanes::<R, L>::all(plain) {
            // The address of a copy, so that the trial itself stays in registers.
            let doubtful = trial;
            return self.apart(&doubtful, plain, t);
        }
        let notes = self.notes.after(&trial, self.margin, Lanes(t) - self.t);
        self.notes = notes;
        (self.t, self.q, self.qd, self.qdd) = (Lanes(t), trial.q, trial.qd, trial.qdd);
        self.margin = trial.margin;
        from_fn(|lane| Ok(notes.statistics(lane)))
    }

    /// Takes the step over in the lanes of `plain`; the others are stepped alone.
    #[cold]
    #[inline(never)]
    fn apart(
        &mut self,
        trial: &Trial<Lanes<R, L>, N>,
        plain: LaneMask<R, L>,
        t: [R; L],
    ) -> [Result<Statistics, Failure>; L] {
        let notes = self.notes.after(trial, self.margin, Lanes(t) - self.t);
        let merge = |old: &mut Lanes<R, L>, new: &Lanes<R, L>| *old = Lanes::select(plain, *new, *old);
        for (old, new) in [(&mut self.q, &trial.q), (&mut self.qd, &trial.qd), (&mut self.qdd, &trial.qdd)] {
            old.iter_mut().zip(new).for_each(|(old, new)| merge(old, new));
        }
        merge(&mut self.t, &Lanes(t));
        merge(&mut self.margin, &trial.margin);
        from_fn(|lane| {
            if !Lanes::<R, L>::test(plain, lane) {
                return self.alone(lane, Lanes(t).lane(lane));
            }
            self.notes.put(lane, notes.drift(lane), notes.statistics(lane));
            self.notes.count(lane, notes.passages(lane), notes.orientation(lane));
            Ok(notes.statistics(lane))
        })
    }

    /// Changes parameters or inputs of any lanes; see [`Stepper::change`].
    pub fn change<X>(&mut self, change: impl FnOnce(&mut S) -> X) -> X {
        let result = change(&mut self.mechanism);
        self.parameters = self.mechanism.parameters();
        self.weights = weights(&self.mechanism.coordinate_scales(&self.parameters));
        for (lane, stepper) in self.steppers.iter_mut().enumerate() {
            stepper.change(|mechanism| *mechanism = self.mechanism.lane(lane));
        }
        self.waits = LaneMask::new([true; L]);
        result
    }

    /// The mechanism in lane `lane` alone; of the last lane where there are fewer.
    pub fn stepper(&self, lane: usize) -> Option<Stepper<S::Lane, R, N, M>> {
        let mut stepper = self.steppers.get(lane).or(self.steppers.last()).cloned()?;
        let (state, margin) = self.state(lane);
        stepper.state.set(state, margin);
        let (drift, statistics) = (self.notes.drift(lane), self.notes.statistics(lane));
        stepper.state.note(drift, statistics, self.notes.passages(lane), self.notes.orientation(lane));
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
        let (state, margin) = self.state(lane);
        let Some(stepper) = self.steppers.get_mut(lane) else {
            return Err(Failure::NonFinite { name: "t", line: 0 });
        };
        stepper.state.set(state, margin);
        let (drift, statistics) = (self.notes.drift(lane), self.notes.statistics(lane));
        stepper.state.note(drift, statistics, self.notes.passages(lane), self.notes.orientation(lane));
        let statistics = stepper.advance_to(t)?;
        self.gather(lane);
        Ok(statistics)
    }

    /// Time, position, velocity and acceleration of a lane, and its margin.
    fn state(&self, lane: usize) -> (LaneState<R, N>, R) {
        let of = |values: &[Lanes<R, L>; N]| values.map(|value| value.lane(lane));
        ((self.t.lane(lane), of(&self.q), of(&self.qd), of(&self.qdd)), self.margin.lane(lane))
    }

    /// Puts the state of a lane's stepper beside the others'.
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
        self.notes.put(lane, stepper.state.drift, stepper.statistics());
        self.notes.count(lane, stepper.passages(), stepper.signature());
        let waits = self.waits;
        let waiting = |other: usize| match other == lane {
            true => stepper.waits(),
            false => Lanes::<R, L>::test(waits, other),
        };
        self.waits = LaneMask::new(from_fn(waiting));
    }
}

impl<R: Real, const L: usize> Notes<R, L> {
    /// Before the first step.
    fn none() -> Self {
        let zero = Lanes([R::constant(0.0); L]);
        let (row, evaluations, passages, orientation) = ([0; L], [0; L], [0; L], [0; L]);
        let (fallback, passed) = ([false; L], [false; L]);
        let (residual, correction) = (zero, zero);
        let drift = Drift { change: zero, time: Lanes([R::constant(1.0); L]) };
        Notes { drift, residual, correction, row, evaluations, fallback, passed, passages, orientation }
    }

    /// Those after the step that `trial` made in `time` (s) from where the margin was `margin`.
    #[inline(always)]
    fn after<const N: usize>(
        &self,
        trial: &Trial<Lanes<R, L>, N>,
        margin: Lanes<R, L>,
        time: Lanes<R, L>,
    ) -> Self {
        let zero = Lanes::constant(0.0);
        let moves = time.less(zero) | zero.less(time);
        let passed = from_fn(|lane| self.orientation(lane) != trial.orientation(lane));
        Notes {
            drift: Drift {
                change: Lanes::select(moves, trial.margin - margin, self.drift.change),
                time: Lanes::select(moves, time, self.drift.time),
            },
            residual: trial.residual,
            correction: trial.correction,
            row: from_fn(|lane| trial.row(lane)),
            evaluations: [trial.evaluations; L],
            fallback: [false; L],
            passed,
            passages: from_fn(|lane| self.passages(lane).saturating_add(u32::from(at(&passed, lane, false)))),
            orientation: trial.orientation,
        }
    }

    #[inline(always)]
    fn statistics(&self, lane: usize) -> Statistics {
        Statistics {
            evaluations: at(&self.evaluations, lane, 0),
            fallback: at(&self.fallback, lane, false),
            residual: self.residual.lane(lane).to_f64(),
            row: at(&self.row, lane, 0),
            correction: self.correction.lane(lane).to_f64(),
            passed: at(&self.passed, lane, false),
        }
    }

    #[inline(always)]
    fn drift(&self, lane: usize) -> Drift<R> {
        Drift { change: self.drift.change.lane(lane), time: self.drift.time.lane(lane) }
    }

    /// How many singular positions the lane has passed.
    #[inline(always)]
    fn passages(&self, lane: usize) -> u32 {
        at(&self.passages, lane, 0)
    }

    /// Signs of the blocks' determinants in the lane.
    #[inline(always)]
    fn orientation(&self, lane: usize) -> u64 {
        at(&self.orientation, lane, 0)
    }

    fn put(&mut self, lane: usize, drift: Drift<R>, statistics: Statistics) {
        let Statistics { evaluations, fallback, residual, row, correction, passed } = statistics;
        set(&mut self.drift.change.0, lane, drift.change);
        set(&mut self.drift.time.0, lane, drift.time);
        set(&mut self.residual.0, lane, R::constant(residual));
        set(&mut self.correction.0, lane, R::constant(correction));
        set(&mut self.row, lane, row);
        set(&mut self.evaluations, lane, evaluations);
        set(&mut self.fallback, lane, fallback);
        set(&mut self.passed, lane, passed);
    }

    fn count(&mut self, lane: usize, passages: u32, orientation: u64) {
        set(&mut self.passages, lane, passages);
        set(&mut self.orientation, lane, orientation);
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
