//! A mechanism that moves by its forces: state and mechanism in one place, one call a step.

use super::adaptive::{Accepted, Adaptive};
use super::determinacy::Determinacy;
use super::embedded::Embedded;
use super::event::{Direction, passage};
use super::metric::{Metric, Tolerance};
use super::model::{Counts, Doubt, Formulation, Model};
use super::motion::{Equations, Explicit, Instant, Method, Moving, beginning};
use super::passage::Passage;
use super::phases::at_present;
use super::projection::Projection;
use super::rank::rank_rises;
use super::signed::parameter_failure;
use super::text_start;
use super::vector::State;
use crate::limit::limit_failure;
use crate::{Dynamic, Energy, Failure, Motion, Real, kinematics};

/// Violation of a row that a start may have, in the reference metric and of the coordinates (per second for its rate): numbers typed
/// with nine digits. What it has is projected out.
const START_ALLOWANCE: f64 = 1e-8;

/// Tolerance of an adaptive integration where none is given, unless the number type has fewer digits.
const TOLERANCE: f64 = 1e-9;

/// Parts of an adaptive step at whose ends working ranges are looked at.
const PARTS: u32 = 8;

/// Halvings of such a part: as many digits as an `f64` has.
const MOST_HALVINGS: u32 = 53;

/// A mechanism in motion with method `X`. It owns everything, allocates nothing, and a failed call leaves it as it was.
///
/// For a control loop: [`change`](Self::change) the inputs, [`step`](Self::step), read.
#[derive(Clone, Copy, Debug)]
pub struct Simulation<S: Dynamic<R, N, M>, X, R: Real, const N: usize, const M: usize> {
    mechanism: S,
    parameters: S::Parameters,
    metric: Metric<R, N, M>,
    method: X,
    fault: Option<Failure>,
    now: Instant<R, N, M, S::States>,
    /// Whether parameters or inputs have changed since the instant was solved.
    stale: bool,
    start: R,
    balanced: bool,
    /// Whether rows follow from others on the constraints alone, as found at the start, behind changes and singular positions.
    rank_rises: bool,
    /// Whether a singular position was passed since then.
    passed: bool,
    /// Energy (J) at the start, moved along where parameters change it.
    reference: R,
    /// Energy (J) before a change that made it no number.
    known: Option<R>,
    tolerance: Tolerance<R>,
    adaptive: Adaptive<R>,
    passage: Option<Passage<R>>,
    counts: Counts,
}

/// Where a start comes from.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Origin {
    /// On the constraints.
    Consistent,
    /// Next to them.
    Near,
    /// Of the text.
    Text,
}

/// What a run has come to at the end of a step.
struct Progress<R, P> {
    /// Phases of drives that prescribe a rate.
    phases: P,
    counts: Counts,
    passage: Option<Passage<R>>,
    /// Steps accepted by the control of their size.
    accepted: u32,
}

/// Where a step or an adaptive run begins.
struct Fresh<R, const N: usize, const M: usize, Z> {
    instant: Instant<R, N, M, Z>,
    /// Energy (J) that came in as the state was put onto changed rows.
    gained: R,
    /// Whether rows follow from others on the constraints alone.
    rank_rises: bool,
}

/// How a run went so far: energy that is not accounted for, rows that are violated, what it cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance<R> {
    /// Kinetic and potential energy (J).
    pub energy: Energy<R>,
    /// What forces and drives have done since the start (J).
    pub work: R,
    /// Energy less work less the energy at the start (J): 0 of an exact integration.
    pub defect: R,
    /// Largest |Φᵢ| over its row's scale: about the distance (rad, or reference lengths) from where it holds.
    pub phi: R,
    /// Largest |Φ̇ᵢ| over its row's scale (1/s).
    pub phi_d: R,
}

impl<S, X, R, const N: usize, const M: usize> Simulation<S, X, R, N, M>
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    /// Starts from `q` (N) and `qd` (N) at `t` (s), which must be on the constraints to nine digits; the rest is
    /// projected.
    ///
    /// # Errors
    /// [`Failure::NonFinite`]; [`Failure::Negative`]; [`Failure::OffConstraints`] with the row that is violated most; those of the method.
    pub fn start(
        mechanism: S,
        method: X,
        t: R,
        q: impl Into<[R; N]>,
        qd: impl Into<[R; N]>,
    ) -> Result<Self, Failure> {
        Self::starting(mechanism, method, t, (q.into(), qd.into()), Origin::Consistent)
    }

    /// Starts next to `q` (N) and `qd` (N) at `t` (s): from the positions and velocities on the constraints that are
    /// nearest in the mass's measure.
    ///
    /// # Errors
    /// [`Failure::NonFinite`]; [`Failure::Negative`]; [`Failure::OffConstraints`] where the constraints cannot be met from there; those of the
    /// method.
    pub fn start_near(
        mechanism: S,
        method: X,
        t: R,
        q: impl Into<[R; N]>,
        qd: impl Into<[R; N]>,
    ) -> Result<Self, Failure> {
        Self::starting(mechanism, method, t, (q.into(), qd.into()), Origin::Near)
    }

    /// Starts next to the text's guess with the text's start rates at `t` (s). What the text declares by `start` stays as
    /// declared where the rows can be met by the other coordinates; otherwise the nearest positions and velocities are
    /// taken as in [`start_near`](Self::start_near).
    ///
    /// # Errors
    /// As [`start_near`](Self::start_near).
    pub fn start_from_text(mechanism: S, method: X, t: R) -> Result<Self, Failure> {
        let parameters = mechanism.parameters();
        let (q, qd) = (mechanism.guess(&parameters), mechanism.start_rates(&parameters));
        Self::starting(mechanism, method, t, (q, qd), Origin::Text)
    }

    fn starting(
        mut mechanism: S,
        method: X,
        t: R,
        (q, qd): ([R; N], [R; N]),
        origin: Origin,
    ) -> Result<Self, Failure> {
        if let Some(failure) = parameter_failure(&mechanism) {
            return Err(failure);
        }
        method.require_suitable()?;
        mechanism.start_phases(&q, t);
        let parameters = mechanism.parameters();
        let metric = Metric::next_to(&mechanism, &parameters, t, &q);
        let mut model = Model {
            mechanism: &mechanism,
            parameters: &parameters,
            metric: &metric,
            balanced: true,
            rank_rises: false,
        };
        let mut counts = Counts::default();
        let states = mechanism.start_states(&parameters);
        let mut y = State { q, qd, states, work: R::constant(0.0) };
        model.check(t, &y)?;
        match origin {
            Origin::Consistent => model
                .require_consistent(t, &y)
                .map_err(|failure| model.contradiction(t, &y, &mut counts).unwrap_or(failure))?,
            Origin::Near => {}
            Origin::Text => text_start::complete(&model, t, &mut y, &mut counts)?,
        }
        let near = y;
        Projection::default()
            .settle(&model, t, &mut y, &mut counts)
            .map_err(|failure| model.contradiction(t, &near, &mut counts).unwrap_or(failure))?;
        // What a row's gradient is where the guess was counts no more.
        let metric = Metric::next_to(&mechanism, &parameters, t, &y.q);
        model.metric = &metric;
        Projection::default().settle(&model, t, &mut y, &mut counts)?;
        model.require_no_flat_row(t, &y)?;
        model.rank_rises = rank_rises(&model, t, &y);
        let solved = method.solve(&model, t, &y, &[R::constant(0.0); M], &mut counts)?;
        let now = Instant { t, y, solved, carried: solved.rate.qd };
        model.check_assembly(t, (t, &y), true)?;
        let rank_rises = model.rank_rises;
        let tolerance = R::constant(TOLERANCE).max(Tolerance::least());
        let reference = model.total_energy(t, &y);
        Ok(Simulation {
            mechanism,
            parameters,
            metric,
            method,
            fault: None,
            now,
            stale: false,
            start: t,
            balanced: true,
            rank_rises,
            passed: false,
            reference,
            known: None,
            tolerance: Tolerance { relative: tolerance, absolute: tolerance },
            adaptive: Adaptive::default(),
            passage: None,
            counts,
        })
    }

    /// Without the integral of the forces' work, which costs an evaluation of every power a stage.
    pub fn without_work(self) -> Self {
        Simulation { balanced: false, ..self }
    }

    /// Moves on by one step of `h` (s): a fixed amount of work.
    ///
    /// # Errors
    /// [`Failure::InvalidStep`], [`Failure::StepTooLong`], [`Failure::Unbounded`], those of the method,
    /// [`Failure::WrongBranch`]; [`Failure::Flat`] and [`Failure::Inertialess`] where the state itself shows why. It is
    /// then bit for bit what it was.
    pub fn step(&mut self, h: R) -> Result<(), Failure> {
        let t = self.now.t + h;
        if !R::constant(0.0).less(h) || !t.is_finite() || t == self.now.t {
            return Err(Failure::InvalidStep { step: h.to_f64(), time: self.now.t.to_f64() });
        }
        self.method.admit(h, self.now.t)?;
        let mut counts = self.counts;
        let Fresh { instant: from, gained, rank_rises } = self.fresh(&mut counts)?;
        let model = Model { rank_rises, ..self.model() };
        let stepped = self.method.step(&model, &from, h, &mut counts);
        let stepped = stepped.and_then(|next| {
            model.require_bounded(next.t, &from.y, &next.y)?;
            model.check(next.t, &next.y).map(|()| next)
        });
        let next = stepped.map_err(|failure| model.traced(failure, from.t, &from.y))?;
        model.check_assembly(from.t, (next.t, &next.y), false)?;
        let phases = self.method.phases_after(&model, from.t, h)?;
        counts.steps += 1;
        let ends = ((from.t, from.solved.margin), (next.t, next.solved.margin));
        let passage = Passage::between(ends.0, ends.1);
        self.passage = self.passage.or(passage);
        self.rank_rises = rank_rises;
        self.take(next, phases, counts);
        self.passed = passage.is_some();
        self.reference = self.reference + gained;
        Ok(())
    }

    /// Moves on to `until` (s) in `steps` equal steps.
    ///
    /// # Errors
    /// As [`step`](Self::step); the state is then that before the step that failed.
    pub fn step_to(&mut self, until: R, steps: u32) -> Result<(), Failure> {
        let (from, count) = (self.now.t, R::constant(f64::from(steps)));
        if steps == 0 {
            let step = ((until - from) / count).to_f64();
            return Err(Failure::InvalidStep { step, time: from.to_f64() });
        }
        for index in 1..=steps {
            let share = R::constant(f64::from(index)) / count;
            let end = if index == steps { until } else { from + (until - from) * share };
            self.step(end - self.now.t)?;
        }
        Ok(())
    }

    /// The instant, solved anew where parameters or inputs have changed.
    fn fresh(&self, counts: &mut Counts) -> Result<Fresh<R, N, M, S::States>, Failure> {
        if let Some(failure) = self.fault {
            return Err(failure);
        }
        let (Instant { t, mut y, solved, .. }, mut model) = (self.now, self.model());
        if !self.stale {
            let rank_rises = self.rank_rises || self.passed && rank_rises(&model, t, &y);
            return Ok(Fresh { instant: self.now, gained: R::constant(0.0), rank_rises });
        }
        Projection::default().settle(&model, t, &mut y, counts)?;
        model.require_no_flat_row(t, &y)?;
        model.rank_rises = model.rank_rises || rank_rises(&model, t, &y);
        let solved = self.method.solve(&model, t, &y, &solved.lambda, counts)?;
        let gained = model.total_energy(t, &y) - model.total_energy(t, &self.now.y);
        let instant = Instant { t, y, solved, carried: solved.rate.qd };
        Ok(Fresh { instant, gained, rank_rises: model.rank_rises })
    }

    /// Goes on from `next`, with `phases` or with those that kinematics moves on.
    fn take(&mut self, next: Instant<R, N, M, S::States>, phases: Option<S::Phases>, counts: Counts) {
        if S::HAS_SIGNALS {
            let start = self.mechanism.clone();
            self.mechanism.carry_signals(&start, next.t - self.now.t);
        }
        if !S::PHASES.is_empty() {
            match phases {
                Some(phases) => self.mechanism.set_phases(phases),
                None => self.mechanism.advance_phases(self.now.t, next.t),
            }
        }
        if S::HAS_SIGNALS || !S::PHASES.is_empty() {
            self.parameters = self.mechanism.parameters();
        }
        self.now = next;
        self.counts = counts;
        self.stale = false;
        self.passed = false;
    }

    fn model(&self) -> Model<'_, S, R, N, M> {
        Model {
            mechanism: &self.mechanism,
            parameters: &self.parameters,
            metric: &self.metric,
            balanced: self.balanced,
            rank_rises: self.rank_rises,
        }
    }

    /// Changes parameters or inputs; the next step solves with the new values, which are those at the present time. Inputs with
    /// rates are carried on from there within each step, and from step to step, as if their acceleration lasted; what a new value
    /// differs from that is a jump. Energy that the change brings in or
    /// takes out is not counted as a defect.
    ///
    /// A value that is NaN or infinite, or a mass that is negative, is reported by that step; change it back, and go on.
    pub fn change<Y>(&mut self, change: impl FnOnce(&mut S) -> Y) -> Y {
        let before = self.model().total_energy(self.now.t, &self.now.y);
        let before = self.known.unwrap_or(before);
        let result = change(&mut self.mechanism);
        if !S::PHASES.is_empty() {
            self.mechanism.set_phases(at_present(&self.mechanism, self.now.t));
        }
        self.parameters = self.mechanism.parameters();
        self.metric = Metric::next_to(&self.mechanism, &self.parameters, self.now.t, &self.now.y.q);
        self.fault = parameter_failure(&self.mechanism);
        let after = self.model().total_energy(self.now.t, &self.now.y);
        if (after - before).is_finite() {
            self.reference = self.reference + after - before;
            self.known = None;
        } else {
            self.known = Some(before);
        }
        self.stale = true;
        self.adaptive.step = None;
        result
    }

    /// Time (s).
    pub fn t(&self) -> R {
        self.now.t
    }

    /// Coordinates: N.
    pub fn q(&self) -> &[R; N] {
        &self.now.y.q
    }

    /// Velocities: N, in coordinate unit per second.
    pub fn qd(&self) -> &[R; N] {
        &self.now.y.qd
    }

    /// Accelerations: N, in coordinate unit per second squared.
    pub fn qdd(&self) -> &[R; N] {
        &self.now.solved.rate.qd
    }

    /// Multipliers λ: M; a row's force on the coordinates is −Φ_qᵀ λ. Where rows follow from others they are one choice of
    /// many, see [`determinacy`](Self::determinacy).
    pub fn lambda(&self) -> &[R; M] {
        &self.now.solved.lambda
    }

    /// First-order states of the text.
    pub fn states(&self) -> &S::States {
        &self.now.y.states
    }

    /// State, rates and multipliers together.
    pub fn instant(&self) -> &Instant<R, N, M, S::States> {
        &self.now
    }

    /// How near Φ_q is to losing rank: 0 where it does, at most 1.
    pub fn margin(&self) -> R {
        self.now.solved.margin
    }

    /// Where the run came so near to a singular position for the first time that it may have passed it.
    pub fn passage(&self) -> Option<&Passage<R>> {
        self.passage.as_ref()
    }

    /// The mechanism with its parameters and inputs.
    pub fn mechanism(&self) -> &S {
        &self.mechanism
    }

    /// What the run has spent.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// What is doubtful about steps of `h` (s) from the start until now.
    pub fn doubt(&self, h: R) -> Option<Doubt> {
        if self.rank_rises && self.method.leaves_constraints() {
            return Some(Doubt::RisingRank);
        }
        self.method.doubt(h, self.now.t - self.start)
    }

    /// Outputs with their time derivatives.
    pub fn outputs(&self) -> S::Outputs {
        let position = self.model().position(self.now.t, &self.now.y);
        self.mechanism.outputs(&self.parameters, &position, self.qd(), self.qdd())
    }

    /// Outputs that use multipliers or states: reactions, efforts.
    pub fn loads(&self) -> S::Loads {
        let position = self.model().position(self.now.t, &self.now.y);
        let motion =
            Motion { qd: self.qd(), qdd: self.qdd(), lambda: self.lambda(), states: &self.now.y.states };
        self.mechanism.loads(&self.parameters, &position, &motion)
    }

    /// Which multipliers are the only ones that move the mechanism so, and which rows follow from others here.
    ///
    /// # Errors
    /// Those of [`Determinacy::of`].
    pub fn determinacy(&self) -> Result<Determinacy<R, M>, Failure> {
        let position = self.model().position(self.now.t, &self.now.y);
        Determinacy::measured(&self.mechanism, &self.parameters, &position, (self.now.t, &self.metric))
    }

    /// Marks in `unique`, one of each of [`loads`](Self::loads), those that are the same whichever multipliers bear the
    /// forces.
    ///
    /// # Errors
    /// Those of [`Determinacy::of`].
    pub fn mark_unique_loads(&self, unique: &mut [bool]) -> Result<(), Failure> {
        let position = self.model().position(self.now.t, &self.now.y);
        let found = self.determinacy()?;
        let motion =
            Motion { qd: self.qd(), qdd: self.qdd(), lambda: self.lambda(), states: &self.now.y.states };
        found.mark_loads(&self.mechanism, &self.parameters, &position, &motion, unique);
        Ok(())
    }

    /// Energy balance and constraint norms.
    pub fn balance(&self) -> Balance<R> {
        let model = self.model();
        let Instant { t, y, .. } = &self.now;
        let position = model.position(*t, y);
        let energy = self.mechanism.energy(&self.parameters, &position, &y.qd);
        let largest = |values: [R; M]| {
            let over = values.iter().zip(&self.metric.rows).map(|(value, scale)| (*value / *scale).abs());
            over.fold(R::constant(0.0), |largest, value| largest.max(value))
        };
        Balance {
            energy,
            work: y.work,
            defect: energy.kinetic + energy.potential - y.work - self.reference,
            phi: largest(self.mechanism.phi(&self.parameters, &position)),
            phi_d: largest(model.constraint_rates(&position, &y.qd)),
        }
    }
}

impl<S, I, F, R, const N: usize, const M: usize> Simulation<S, Explicit<I, F>, R, N, M>
where
    S: Dynamic<R, N, M>,
    I: Embedded,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    /// With other tolerances than 1e-9 for adaptive steps.
    pub fn with_tolerance(self, tolerance: Tolerance<R>) -> Self {
        Simulation { tolerance, ..self }
    }

    /// With adaptive steps not longer than `step` (s): for what happens between two steps and is over in a moment.
    pub fn with_largest_step(self, step: R) -> Self {
        Simulation { adaptive: self.adaptive.with_largest(step), ..self }
    }

    /// Steps accepted and rejected by the control of their size, and the size that it will try next.
    pub fn adaptive(&self) -> &Adaptive<R> {
        &self.adaptive
    }

    /// Moves on to `until` (s) with steps as long as the tolerance allows.
    ///
    /// # Errors
    /// [`Failure::InvalidStep`], [`Failure::UnresolvedTolerance`], [`Failure::StepTooSmall`], [`Failure::OutOfReach`], those of
    /// the method; [`Failure::BeyondLimit`] and [`Failure::WrongBranch`] with the time at which the limit is passed within a
    /// step. The state is then that at the end of the last step that was accepted.
    pub fn advance_to(&mut self, until: R) -> Result<(), Failure> {
        self.advance(until, |_| None, |_, _| Ok(None)).map(|_| ())
    }

    /// As [`advance_to`](Self::advance_to), hitting the times that `breakpoints` gives: the next one after its
    /// argument where a force or a drive is not smooth. So the order of the method is kept.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to).
    pub fn advance_through(
        &mut self,
        until: R,
        breakpoints: impl FnMut(R) -> Option<R>,
    ) -> Result<(), Failure> {
        self.advance(until, breakpoints, |_, _| Ok(None)).map(|_| ())
    }

    /// As [`advance_to`](Self::advance_to), but stops where `event` of time, coordinates and velocities passes zero.
    /// Returns whether it did.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to).
    pub fn advance_until_event(
        &mut self,
        until: R,
        direction: Direction,
        mut event: impl FnMut(R, &[R; N], &[R; N]) -> R,
    ) -> Result<bool, Failure> {
        self.advance(
            until,
            |_| None,
            |equations, accepted| {
                let polynomial = accepted.polynomial(equations)?;
                let found = passage(accepted, &polynomial, direction, |t, y| event(t, &y.y.q, &y.y.qd));
                Ok(found.map(|t| (t, if t < accepted.end.t { polynomial.at(t) } else { accepted.end.y })))
            },
        )
    }

    /// As [`advance_to`](Self::advance_to), and shows the instants at `samples` equal distances on the way, the end
    /// included, each on the constraints.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to).
    pub fn sample(
        &mut self,
        until: R,
        samples: u32,
        mut see: impl FnMut(&Instant<R, N, M, S::States>),
    ) -> Result<(), Failure> {
        self.sampled(until, samples, |instant, _| see(instant))
    }

    /// As [`sample`](Self::sample), and shows the whole simulation as it is at each of these instants: its outputs, loads and
    /// balance. What the steps have spent is in its [`counts`](Self::counts) without what the instants between them cost.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to).
    pub fn watch(&mut self, until: R, samples: u32, mut see: impl FnMut(&Self)) -> Result<(), Failure>
    where
        F: Clone,
    {
        let mut shown = self.clone();
        if self.stale {
            let gained = self.fresh(&mut Counts::default())?.gained;
            shown.reference = shown.reference + gained;
        }
        let steps = self.adaptive.accepted;
        self.sampled(until, samples, |instant, run| {
            let mut counts = run.counts;
            counts.steps += u64::from(run.accepted.wrapping_sub(steps));
            shown.take(*instant, Some(run.phases), counts);
            shown.passage = shown.passage.or(run.passage);
            see(&shown);
        })
    }

    /// Shows the instants at `samples` equal distances to `until` (s), with what the run has come to.
    ///
    /// The run goes on as if nobody had looked: rates between its steps are apart from it.
    fn sampled(
        &mut self,
        until: R,
        samples: u32,
        mut see: impl FnMut(&Instant<R, N, M, S::States>, &Progress<R, S::Phases>),
    ) -> Result<(), Failure> {
        let (from, count) = (self.now.t, R::constant(f64::from(samples)));
        let (mut index, mut accepted_steps) = (1, self.adaptive.accepted);
        self.advance(
            until,
            |_| None,
            |equations, accepted| {
                let mut polynomial = None;
                accepted_steps = accepted_steps.wrapping_add(1);
                while index <= samples {
                    let share = R::constant(f64::from(index)) / count;
                    let t = if index == samples { until } else { from + (until - from) * share };
                    if accepted.end.t < t {
                        break;
                    }
                    let (instant, phases) = equations.apart(|equations| {
                        let known = *polynomial.get_or_insert_with(|| accepted.polynomial(equations).ok());
                        let between = || known.map_or_else(|| accepted.cubic(t), |known| known.at(t));
                        let mut y = if t < accepted.end.t { between() } else { accepted.end.y };
                        super::equation::Equation::settle(equations, t, &mut y)?;
                        let solved = equations.solve(t, &y)?;
                        let phases = equations.phases(t, &y.phases);
                        Ok((Instant { t, y: y.y, solved, carried: solved.rate.qd }, phases))
                    })?;
                    equations.pass(&instant);
                    let (counts, passage) = (equations.counts, equations.passage);
                    see(&instant, &Progress { phases, counts, passage, accepted: accepted_steps });
                    index += 1;
                }
                Ok(None)
            },
        )
        .map(|_| ())
    }

    /// Runs to `until`, or to the instant that `stop` gives for a step; returns whether it was such an instant.
    fn advance(
        &mut self,
        until: R,
        breakpoints: impl FnMut(R) -> Option<R>,
        mut stop: impl FnMut(
            &mut Equations<'_, S, F, R, N, M>,
            &Accepted<I, R, Moving<S, R, N, M>>,
        ) -> Result<Option<(R, Moving<S, R, N, M>)>, Failure>,
    ) -> Result<bool, Failure> {
        let (mut counts, mut adaptive) = (self.counts, self.adaptive);
        self.tolerance.require_resolved(self.now.t)?;
        let Fresh { instant: from, gained, rank_rises } = self.fresh(&mut counts)?;
        let model = Model { rank_rises, ..self.model() };
        let formulation = &self.method.formulation;
        let mut equations = Equations::new(&model, formulation, &from, counts).with_tolerance(self.tolerance);
        let start = beginning(model.mechanism, &from);
        let (mut stopped, mut last) = (None, start);
        let taken = adaptive.accepted;
        let run = adaptive.run::<I, _>(&mut equations, start, until, breakpoints, |equations, accepted| {
            model.check(accepted.end.t, &accepted.end.y.y)?;
            model.check_step(equations, accepted)?;
            stopped = stop(equations, accepted)?;
            last = accepted.end;
            Ok(stopped.is_none())
        });
        let failure = run.err();
        if let (Some(failure), true) = (failure, last.t == from.t) {
            return Err(failure);
        }
        let (t, mut y) = stopped.unwrap_or((last.t, last.y));
        if stopped.is_some() {
            super::equation::Equation::settle(&mut equations, t, &mut y)?;
        }
        let solved = equations.solve(t, &y)?;
        let phases = equations.phases(t, &y.phases);
        counts = equations.counts;
        let passage = equations.passage;
        counts.steps += u64::from(adaptive.accepted.wrapping_sub(taken));
        self.adaptive = adaptive;
        self.passage = self.passage.or(passage);
        self.rank_rises = rank_rises;
        self.take(Instant { t, y: y.y, solved, carried: solved.rate.qd }, Some(phases), counts);
        self.passed = passage.is_some();
        self.reference = self.reference + gained;
        failure.map_or(Ok(stopped.is_some()), Err)
    }
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Kinetic and potential energy (J).
    fn total_energy(&self, t: R, y: &State<R, N, S::States>) -> R {
        let energy = self.mechanism.energy(self.parameters, &self.position(t, y), &y.qd);
        energy.kinetic + energy.potential
    }

    /// Fails where a working range is left or a declared branch does not hold; `from`: the time (s) that inputs and phases are known at;
    /// `assembling`: those that pick the assembly alone count too.
    fn check_assembly(
        &self,
        from: R,
        (t, y): (R, &State<R, N, S::States>),
        assembling: bool,
    ) -> Result<(), Failure> {
        if S::BRANCHES.is_empty() && S::LIMITS.is_empty() {
            return Ok(());
        }
        let failure = self.moved(from, t, |Model { mechanism, parameters, .. }| {
            let position = mechanism.position(parameters, &y.q, t);
            kinematics::branch_failure(*mechanism, parameters, &position, t, assembling)
                .or_else(|| limit_failure(*mechanism, parameters, &position, t))
        });
        failure.map_or(Ok(()), Err)
    }

    /// [`check_assembly`](Self::check_assembly) along an accepted step, with the time at which the state passes what it may not
    /// pass. A range may be left and entered again within a step, a branch is looked at where the step ends.
    fn check_step<F, I>(
        &self,
        equations: &mut Equations<'_, S, F, R, N, M>,
        accepted: &Accepted<I, R, Moving<S, R, N, M>>,
    ) -> Result<(), Failure>
    where
        F: Formulation<S, R, N, M>,
        I: Embedded,
    {
        let (start, end) = (accepted.start.t, &accepted.end);
        let from = equations.start;
        let ends = self.check_assembly(from, (end.t, &end.y.y), false);
        if S::LIMITS.is_empty() && ends.is_ok() {
            return Ok(());
        }
        let Ok(polynomial) = accepted.polynomial(equations) else { return ends };
        let at = |t: R| self.check_assembly(from, (t, &polynomial.at(t).y), false);
        let mut inside = start;
        for part in 1..PARTS {
            let t = start + (end.t - start) * R::constant(f64::from(part) / f64::from(PARTS));
            match at(t) {
                Ok(()) => inside = t,
                Err(failure) => return Err(first_failure(inside, (t, failure), at)),
            }
        }
        ends.map_err(|failure| first_failure(inside, (end.t, failure), at))
    }

    /// Fails with the row that a start violates by more than it may.
    fn require_consistent(&self, t: R, y: &State<R, N, S::States>) -> Result<(), Failure> {
        let position = self.position(t, y);
        let (one, allowance) = (R::constant(1.0), R::constant(START_ALLOWANCE));
        let phi = self.mechanism.phi(self.parameters, &position);
        let phi_q = self.mechanism.phi_q(self.parameters, &position);
        let mut allowed = self.metric.rows;
        for (allowed, row) in allowed.iter_mut().zip(&phi_q) {
            let reach = row.iter().zip(&y.q).fold(*allowed, |sum, (entry, q)| sum + (*entry * *q).abs());
            *allowed = allowance * reach;
        }
        self.require(t, &phi, &allowed, one, false)?;
        let mut allowed = self.mechanism.phi_t(self.parameters, &position);
        for ((allowed, row), scale) in allowed.iter_mut().zip(&phi_q).zip(&self.metric.rows) {
            let reach = row.iter().zip(&y.qd).fold(*scale, |sum, (entry, qd)| sum + (*entry * *qd).abs());
            *allowed = allowance * (reach + allowed.abs());
        }
        self.require(t, &self.constraint_rates(&position, &y.qd), &allowed, one, true)
    }
}

/// The failure of `at` at the earliest time after `inside` (s), where it has none, up to `beyond`, a time (s) with a failure.
fn first_failure<R: Real>(
    mut inside: R,
    mut beyond: (R, Failure),
    at: impl Fn(R) -> Result<(), Failure>,
) -> Failure {
    for _ in 0..MOST_HALVINGS {
        let t = inside + R::constant(0.5) * (beyond.0 - inside);
        if !inside.less(t) || !t.less(beyond.0) {
            break;
        }
        match at(t) {
            Ok(()) => inside = t,
            Err(failure) => beyond = (t, failure),
        }
    }
    beyond.1
}
