//! A mechanism that moves by its forces: state and mechanism in one place, one call a step.

pub(crate) mod accuracy;
#[cfg(test)]
mod accuracy_tests;
pub(crate) mod adaptive_run;
pub(crate) mod checks;
pub(crate) mod contact;
pub(crate) mod continued;
pub(crate) mod events;
pub(crate) mod fixed_run;
pub(crate) mod fixed_run_events;
pub(crate) mod graded_steps;
pub(crate) mod modes;
pub(crate) mod reading;
pub(crate) mod sleep;

use crate::dynamics::equilibrium::consistent_start;
use crate::dynamics::equilibrium::consistent_start::MovedStart;
use crate::dynamics::first_order_form::phases::at_present;
use crate::dynamics::formulations::projection::Projection;
use crate::dynamics::formulations::singular::passage::Passage;
use crate::dynamics::formulations::singular::rank::rank_rises;
use crate::dynamics::integrators::event::Scrutiny;
use crate::dynamics::integrators::event::monitor::Stopped;
use crate::dynamics::integrators::step_control::Adaptive;
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::method::Method;
use crate::dynamics::model::metric::{Metric, Tolerance, require_position_tolerance};
use crate::dynamics::model::sign_checks::parameter_failure;
use crate::dynamics::model::{Counts, Formulation, Model};
use crate::dynamics::simulation::graded_steps::ContactSteps;
use crate::failure::Failure;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{motion, positions};

/// A mechanism in motion with method `X`. It owns everything, allocates nothing, and a failed call leaves it as it was.
///
/// For a control loop: [`change`](Self::change) the inputs, [`step`](Self::step), read.
///
/// ```
/// use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, RungeKutta4, Simulation, Tolerance};
/// use mbs_runtime::mechanism;
///
/// # mechanism! {
/// #     /// A pendulum of a rod.
/// #     pub mechanism Pendulum;
/// #     coord phi: rad = -1;
/// #     body rod { mass: 1, com: 0.5m*unit(phi), inertia: 1/12, angle: phi }
/// #     gravity weight { acceleration: [0, -9.81] }
/// #     start phi = -60deg rate 0;
/// # }
///
/// // Adaptive steps, as long as the tolerance allows.
/// let method = Explicit::new(DormandPrince8, Projection::default());
/// let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
/// let mut run = run.with_tolerance(Tolerance::new(1e-10));
/// run.advance_to(1.0)?;
/// assert!(run.balance().defect.abs() < 1e-8);
///
/// // Steps of a fixed size and cost, for a control loop.
/// let method = Explicit::new(RungeKutta4, Projection::default());
/// let mut fixed = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
/// for _ in 0..1000 {
///     fixed.step(1e-3)?;
/// }
/// assert!((fixed.q()[0] - run.q()[0]).abs() < 1e-8);
/// # Ok::<(), mbs_runtime::Failure>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Simulation<S: Dynamic<R, N, M>, X, R: Real, const N: usize, const M: usize> {
    mechanism: S,
    parameters: S::Parameters,
    metric: Metric<R, N, M>,
    method: X,
    fault: Option<Failure>,
    now: Instant<R, N, M, S::States>,
    /// `true` if parameters or inputs have changed since the instant was solved.
    stale: bool,
    start: R,
    /// A time (s) at which a step ended, and the part of the requested steps that its rounding leaves out.
    clock: (R, R),
    balanced: bool,
    /// `true` if rows follow from others on the constraints alone, as found at the start, after changes and singular positions.
    rank_rises: bool,
    /// `true` if a singular position was passed since then.
    passed: bool,
    /// Energy (J) at the start, moved along where parameters change it.
    reference: R,
    /// Energy (J) before a change that made it no number.
    known: Option<R>,
    tolerance: Tolerance<R>,
    /// Residual over the row's scale at which a projection of positions ends.
    position_tolerance: R,
    adaptive: Adaptive<R>,
    /// Steps where contacts close or open.
    contact_steps: ContactSteps<R>,
    /// Resolution and bounds of the search for events, limits and contacts.
    scrutiny: Scrutiny<R>,
    /// The event that the last run ended at.
    stopped: Option<Stopped<R>>,
    passage: Option<Passage<R>>,
    moved_start: Option<MovedStart<R>>,
    /// Estimated errors of all adaptive steps together, each over its tolerance.
    errors: R,
    counts: Counts,
}

/// Origin of a start.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Origin {
    /// On the constraints.
    Consistent,
    /// Next to them.
    Near,
    /// Of the text.
    Text,
    /// Of another scene, next to values of the text.
    Carried,
}

/// Start of a step or of an adaptive run.
struct Fresh<R, const N: usize, const M: usize, Z> {
    instant: Instant<R, N, M, Z>,
    /// Energy (J) that came in as the state was put onto changed rows.
    gained: R,
    /// `true` if rows follow from others on the constraints alone.
    rank_rises: bool,
}

impl<R: Copy, const N: usize, const M: usize, Z> Fresh<R, N, M, Z> {
    fn start(&self) -> Start<'_, R, N, M, Z> {
        let Fresh { instant, gained, rank_rises } = self;
        Start { instant, gained: *gained, rank_rises: *rank_rises }
    }
}

/// [`Fresh`] where the instant is: it is long.
#[derive(Clone, Copy)]
struct Start<'a, R, const N: usize, const M: usize, Z> {
    instant: &'a Instant<R, N, M, Z>,
    gained: R,
    rank_rises: bool,
}

impl<R: Copy, const N: usize, const M: usize, Z: Copy> Start<'_, R, N, M, Z> {
    fn fresh(&self) -> Fresh<R, N, M, Z> {
        Fresh { instant: *self.instant, gained: self.gained, rank_rises: self.rank_rises }
    }

    fn began(&self) -> Began<R> {
        let Instant { t, solved, .. } = self.instant;
        Began { at: (*t, solved.margin), gained: self.gained, rank_rises: self.rank_rises }
    }
}

/// [`Fresh`] without its state.
struct Began<R> {
    /// Time (s) and margin.
    at: (R, R),
    gained: R,
    rank_rises: bool,
}

impl<S, X, R, const N: usize, const M: usize> Simulation<S, X, R, N, M>
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    /// Starts from `q` (N) and `qd` (N) at `t` (s). They must be on the constraints to nine digits, or to the rounding of `R`;
    /// the rest is projected.
    ///
    /// # Errors
    /// [`NonFinite`](crate::FailureKind::NonFinite); [`Negative`](crate::FailureKind::Negative); [`OffConstraints`](crate::FailureKind::OffConstraints) with the row that is violated most; those of the method.
    pub fn start(
        mechanism: S,
        method: X,
        t: R,
        q: impl Into<[R; N]>,
        qd: impl Into<[R; N]>,
    ) -> Result<Self, Failure> {
        Self::starting(mechanism, method, t, (q.into(), qd.into()), (Origin::Consistent, &[], |_| ()))
    }

    /// Starts next to `q` (N) and `qd` (N) at `t` (s). The positions and velocities are those on the constraints that are
    /// nearest in the mass's measure. [`moved_start`](Self::moved_start) gives the largest difference.
    ///
    /// # Errors
    /// [`NonFinite`](crate::FailureKind::NonFinite); [`Negative`](crate::FailureKind::Negative); [`OffConstraints`](crate::FailureKind::OffConstraints) where the constraints cannot be met from there; those of the
    /// method.
    pub fn start_near(
        mechanism: S,
        method: X,
        t: R,
        q: impl Into<[R; N]>,
        qd: impl Into<[R; N]>,
    ) -> Result<Self, Failure> {
        Self::starting(mechanism, method, t, (q.into(), qd.into()), (Origin::Near, &[], |_| ()))
    }

    /// Starts next to the text's guess with the text's start rates at `t` (s). Values that the text declares by `start` stay as
    /// declared if the rows can be met by the other coordinates. Otherwise the nearest positions and velocities are
    /// taken as in [`start_near`](Self::start_near), and [`moved_start`](Self::moved_start) gives the largest difference.
    ///
    /// # Errors
    /// As [`start_near`](Self::start_near).
    pub fn start_from_text(mechanism: S, method: X, t: R) -> Result<Self, Failure> {
        let parameters = mechanism.parameters();
        let (q, qd) = (mechanism.guess(&parameters), mechanism.start_rates(&parameters));
        Self::starting(mechanism, method, t, (q, qd), (Origin::Text, &[], |_| ()))
    }

    fn starting(
        mut mechanism: S,
        method: X,
        t: R,
        (q, qd): ([R; N], [R; N]),
        (origin, carried, set): (Origin, &[u16], impl FnOnce(&mut S::States)),
    ) -> Result<Self, Failure> {
        if let Some(failure) = parameter_failure(&mechanism) {
            return Err(failure);
        }
        method.require_suitable()?;
        mechanism.start_phases(&q, t);
        let parameters = mechanism.parameters();
        let metric = Metric::next_to(&mechanism, &parameters, t, &q);
        let mut model = Model { balanced: true, ..Model::of_states(&mechanism, &parameters, &metric) };
        let mut counts = Counts::default();
        let mut states = mechanism.start_states(&parameters);
        set(&mut states);
        let mut y = IntegratorState { q, qd, states, work: R::constant(0.0) };
        model.check(t, &y)?;
        match origin {
            Origin::Consistent => model
                .require_consistent(t, &y)
                .map_err(|failure| model.contradiction(t, &y, &mut counts).unwrap_or(failure))?,
            Origin::Near => {}
            Origin::Text => consistent_start::complete(&model, t, &mut y, &mut counts)?,
            Origin::Carried => {
                consistent_start::follow(&model, t, &mut y, carried, &mut counts)?;
                model.require_closed(t, &y)?;
            }
        }
        let declared = IntegratorState { q, qd, ..y };
        let near = y;
        Projection::default()
            .project(&model, t, &mut y, &mut counts)
            .map_err(|failure| model.contradiction(t, &near, &mut counts).unwrap_or(failure))?;
        // What a row's gradient is where the guess was counts no more.
        let metric = Metric::next_to(&mechanism, &parameters, t, &y.q);
        model.metric = &metric;
        Projection::default().project(&model, t, &mut y, &mut counts)?;
        model.rank_rises = rank_rises(&model, t, &y);
        let parameters = events::anew(&method, &model, (t, &y), (&mut counts, true))?;
        let model = Model { parameters: &parameters, ..model };
        let mut parameters = modes::anew(&method, &model, (t, &y), &mut counts)?;
        S::set_valued_modes_mut(&mut parameters).iter_mut().for_each(|mode| mode.since = t);
        let model = Model { parameters: &parameters, ..model };
        let solved = method.solve(&model, t, &y, &[R::constant(0.0); M], &mut counts);
        let solved = model.with_margin_of_rows(t, &y, model.require_held(t, &y, solved)?);
        consistent_start::require_decided(&model, t, &y)?;
        let now = Instant { t, y, solved, carried: solved.rate.qd };
        model.check_assembly(t, (t, &y), true)?;
        let rank_rises = model.rank_rises;
        let tolerance = motion::DEFAULT.of();
        let reference = model.total_energy(t, &y);
        let all = core::array::from_fn::<u16, N, _>(|index| u16::try_from(index).unwrap_or(u16::MAX));
        let numbers: (&[u16], &[u16]) = match origin {
            Origin::Consistent => (&[], &[]),
            Origin::Near => (&all, &all),
            Origin::Text => (S::STARTED, S::STARTED_RATES),
            Origin::Carried => (carried, carried),
        };
        let moved_start = consistent_start::moved(&model, &declared, &y, numbers);
        Ok(Simulation {
            mechanism,
            parameters,
            metric,
            method,
            fault: None,
            now,
            stale: false,
            start: t,
            clock: (t, R::constant(0.0)),
            balanced: true,
            rank_rises,
            passed: false,
            reference,
            known: None,
            tolerance: Tolerance { relative: tolerance, absolute: tolerance },
            position_tolerance: positions::OF_TERMS.of(),
            adaptive: Adaptive::default(),
            contact_steps: ContactSteps::Located,
            scrutiny: Scrutiny::beyond(),
            stopped: None,
            passage: None,
            moved_start,
            errors: R::constant(0.0),
            counts,
        })
    }

    /// Without the integral of the forces' work, which costs an evaluation of every power a stage.
    pub fn without_work(self) -> Self {
        Simulation { balanced: false, ..self }
    }

    /// Lets the projection of a step leave the rows open by `tolerance`, for fewer corrections. Without it projections end at rounding,
    /// 64 ε.
    ///
    /// The tolerance τ is a residual over the scale of its row in the reference metric: a distance in reference lengths, an angle in
    /// rad. [`balance`](Self::balance) has the largest one. Next to a position of margin μ a projection ends at 2.5e-7 μ² where that
    /// is less; at rounding in the zone of singular positions, where rows follow from others, and at the start. The velocities are projected to rounding
    /// everywhere. The estimate of the error of adaptive steps does not see τ, which should be below
    /// [their tolerance](Self::with_tolerance). Formulations that do not project positions are as without.
    ///
    /// ```
    /// use mbs_runtime::dynamics::{Explicit, Projection, RungeKutta4, Simulation};
    /// use mbs_runtime::mechanism;
    ///
    /// # mechanism! {
    /// #     /// A point mass on a rod.
    /// #     pub mechanism Pendulum;
    /// #     coord p: [m; 2] = [1, 0];
    /// #     body bob { mass: 1, com: p }
    /// #     gravity weight { acceleration: [0, -9.81] }
    /// #     constraint rod { dot(p, p) == 1 [m^2]; }
    /// #     start p = [1, 0] rate [0, 0];
    /// # }
    ///
    /// let method = Explicit::new(RungeKutta4, Projection::default());
    /// let mut exact = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64)?;
    /// let mut loose = exact.with_position_tolerance(1e-8)?;
    /// for _ in 0..200 {
    ///     exact.step(5e-3)?;
    ///     loose.step(5e-3)?;
    /// }
    /// assert!(loose.counts().corrections < exact.counts().corrections && loose.balance().phi < 1.01e-8);
    /// assert!(exact.with_position_tolerance(0.1).is_err()); // a tenth of a reference length
    /// # Ok::<(), mbs_runtime::Failure>(())
    /// ```
    ///
    /// # Errors
    /// [`UnresolvedTolerance`](crate::FailureKind::UnresolvedTolerance) below 64 ε;
    /// [`InvalidMethodParameter`](crate::FailureKind::InvalidMethodParameter) for NaN, for 0 and less, and above 2.5e-7 (in `f32` 64 ε).
    pub fn with_position_tolerance(self, tolerance: R) -> Result<Self, Failure> {
        require_position_tolerance(tolerance)?;
        Ok(Simulation { position_tolerance: tolerance, ..self })
    }

    /// The instant, solved anew where parameters or inputs have changed.
    fn fresh(&self, counts: &mut Counts) -> Result<Fresh<R, N, M, S::States>, Failure> {
        self.start_in(&mut None, counts).map(|start| start.fresh())
    }

    /// The present instant, or that in `anew` where parameters or inputs have changed.
    #[inline]
    fn start_in<'a>(
        &'a self,
        anew: &'a mut Option<Fresh<R, N, M, S::States>>,
        counts: &mut Counts,
    ) -> Result<Start<'a, R, N, M, S::States>, Failure> {
        if let Some(failure) = self.fault {
            return Err(failure);
        }
        if self.stale {
            return self.solved_anew(counts).map(|fresh| anew.insert(fresh).start());
        }
        let (Instant { t, y, .. }, passed) = (&self.now, self.passed);
        let rank_rises = self.rank_rises || passed && rank_rises(&self.model(), *t, y);
        Ok(Start { instant: &self.now, gained: R::constant(0.0), rank_rises })
    }

    /// The instant after parameters or inputs have changed.
    #[inline(never)]
    fn solved_anew(&self, counts: &mut Counts) -> Result<Fresh<R, N, M, S::States>, Failure> {
        let (Instant { t, mut y, solved, .. }, mut model) = (self.now, self.model());
        Projection::default().project(&model, t, &mut y, counts)?;
        model.rank_rises = model.rank_rises || rank_rises(&model, t, &y);
        let solved = self.method.solve(&model, t, &y, &solved.lambda, counts);
        let solved = model.with_margin_of_rows(t, &y, model.require_held(t, &y, solved)?);
        let gained = model.total_energy(t, &y) - model.total_energy(t, &self.now.y);
        let instant = Instant { t, y, solved, carried: solved.rate.qd };
        Ok(Fresh { instant, gained, rank_rises: model.rank_rises })
    }

    /// Solves the present instant anew where parameters or inputs have changed: a run of no length.
    fn stand(&mut self) -> Result<(), Failure> {
        self.decide_modes_anew()?;
        let mut counts = self.counts;
        let Fresh { instant, gained, rank_rises } = self.fresh(&mut counts)?;
        if self.stale {
            let phases = self.mechanism.phases();
            self.take(&instant, Some(phases), counts);
            (self.rank_rises, self.reference) = (rank_rises, self.reference + gained);
        }
        Ok(())
    }

    /// Goes on from `next`, with `phases` or with those that kinematics moves on.
    fn take(&mut self, next: &Instant<R, N, M, S::States>, phases: Option<S::Phases>, counts: Counts) {
        if S::HAS_SIGNALS {
            let start = self.mechanism.clone();
            self.mechanism.carry_signals(&start, next.t - self.now.t);
        }
        if const { !S::PHASES.is_empty() } {
            match phases {
                Some(phases) => self.mechanism.set_phases(phases),
                None => self.mechanism.advance_phases(self.now.t, next.t),
            }
        }
        if const { S::HAS_SIGNALS || !S::PHASES.is_empty() } {
            self.parameters = self.model().with_modes_of(self.mechanism.parameters());
        }
        // Part after part, each as long as a register or two. As a whole it goes through the memory once more, in pieces that wait for those
        // in which it was written.
        let Instant { t, y, solved, carried } = &mut self.now;
        *t = next.t;
        *y = next.y;
        *solved = next.solved;
        *carried = next.carried;
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
            first_order: false,
            position_tolerance: self.position_tolerance,
            springs: None,
        }
    }

    /// Changes parameters or inputs; the next step solves with the new values, which are those at the present time. Inputs with
    /// rates are carried on from there within each step, and from step to step, at constant acceleration. The difference of a new
    /// value from that is a jump. Energy that the change brings in or
    /// takes out is not counted as a defect.
    ///
    /// A value that is NaN or infinite, or a mass that is negative, is reported by that step; change it back, and go on.
    pub fn change<Y>(&mut self, change: impl FnOnce(&mut S) -> Y) -> Y {
        let before = self.model().total_energy(self.now.t, &self.now.y);
        let before = self.known.unwrap_or(before);
        let result = change(&mut self.mechanism);
        if const { !S::PHASES.is_empty() } {
            self.mechanism.set_phases(at_present(&self.mechanism, self.now.t));
        }
        self.parameters = self.model().with_modes_of(self.mechanism.parameters());
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
}
