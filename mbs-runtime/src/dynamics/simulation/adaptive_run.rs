//! Runs with steps as long as a tolerance allows.

use crate::dynamics::first_order_form::equations::{Equations, Moving};
use crate::dynamics::first_order_form::explicit::{Explicit, beginning};
use crate::dynamics::formulations::singular::passage::Passage;
use crate::dynamics::integrators::embedded::Embedded;
use crate::dynamics::integrators::equation::Equation;
use crate::dynamics::integrators::event::monitor::Stopped;
use crate::dynamics::integrators::event::{Dense, Direction, MOST_RESOLVED, Reach};
use crate::dynamics::integrators::step_control::{Accepted, Adaptive};
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::metric::Tolerance;
use crate::dynamics::model::{Counts, Formulation, Model};
use crate::dynamics::simulation::fixed_run_events::{WithinStep, event_failure};
use crate::dynamics::simulation::graded_steps::ContactSteps;
use crate::dynamics::simulation::{Fresh, Simulation};
use crate::failure::Failure;
use crate::linear_algebra::vectors::Each;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::motion;

/// Event function of a run. A run without one compiles no search: `IS_ANY` is known to the compiler.
trait EventFunction<R, const N: usize> {
    /// `false` where there is none.
    const IS_ANY: bool;

    /// Its value at time `t` (s), coordinates `q` and velocities `qd` (N).
    fn at(&mut self, t: R, q: &[R; N], qd: &[R; N]) -> R;
}

/// No event.
struct NoEvent;

impl<R: Real, const N: usize> EventFunction<R, N> for NoEvent {
    const IS_ANY: bool = false;

    fn at(&mut self, t: R, _: &[R; N], _: &[R; N]) -> R {
        t
    }
}

impl<R, F: FnMut(R, &[R; N], &[R; N]) -> R, const N: usize> EventFunction<R, N> for F {
    const IS_ANY: bool = true;

    fn at(&mut self, t: R, q: &[R; N], qd: &[R; N]) -> R {
        self(t, q, qd)
    }
}

/// Figures of a run at the end of a step.
struct Progress<R, P, G> {
    /// Parameters of the step, where they may change.
    parameters: Option<G>,
    /// Phases of drives that prescribe a rate.
    phases: P,
    counts: Counts,
    /// Energy (J) that impacts have brought in.
    gained: R,
    passage: Option<Passage<R>>,
    /// Steps accepted by the control of their size.
    accepted: u32,
}

/// The next of `samples` instants at equal distances from `from` to `until`, if it is within the step.
fn grid<R: Real>(from: R, until: R, samples: u32) -> impl FnMut([R; 2]) -> Option<R> {
    let (mut index, count) = (1, R::constant(f64::from(samples)));
    move |[_, end]| {
        if index > samples {
            return None;
        }
        let share = R::constant(f64::from(index)) / count;
        let t = if index == samples { until } else { from + (until - from) * share };
        if end < t {
            return None;
        }
        index += 1;
        Some(t)
    }
}

/// The end of the next of `parts` equal parts of a step, none after the last one.
fn parts_of_steps<R: Real>(parts: u32) -> impl FnMut([R; 2]) -> Option<R> {
    let (mut index, count) = (0, R::constant(f64::from(parts)));
    move |[start, end]| {
        if index >= parts {
            index = 0;
            return None;
        }
        index += 1;
        let share = R::constant(f64::from(index)) / count;
        Some(if index == parts { end } else { start + (end - start) * share })
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

    /// With adaptive steps not longer than `step` (s), positive: for forces that set in between two steps and are over in a moment. A
    /// run with another is [`InvalidMethodParameter`](crate::FailureKind::InvalidMethodParameter).
    pub fn with_largest_step(self, step: R) -> Self {
        Simulation { adaptive: self.adaptive.with_largest(step), ..self }
    }

    /// Steps accepted and rejected by the control of their size, and the size that it will try next.
    pub fn adaptive(&self) -> &Adaptive<R> {
        &self.adaptive
    }

    /// Moves on to `until` (s) with steps as long as the tolerance allows; not at all where `until` is the present time.
    ///
    /// # Errors
    /// [`InvalidStep`](crate::FailureKind::InvalidStep), [`UnresolvedTolerance`](crate::FailureKind::UnresolvedTolerance), [`StepTooSmall`](crate::FailureKind::StepTooSmall), [`OutOfReach`](crate::FailureKind::OutOfReach), those of
    /// the method; [`BeyondLimit`](crate::FailureKind::BeyondLimit) and [`WrongBranch`](crate::FailureKind::WrongBranch) with the time at which the limit is passed within a
    /// step. The state is then that at the end of the last step that was accepted.
    pub fn advance_to(&mut self, until: R) -> Result<(), Failure> {
        self.advance(until, |_| None, None::<(Direction, NoEvent)>, |_, _| Ok(())).map(|_| ())
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
        self.advance(until, breakpoints, None::<(Direction, NoEvent)>, |_, _| Ok(())).map(|_| ())
    }

    /// As [`advance_to`](Self::advance_to), but stops where `event` of time, coordinates and velocities first reaches zero, even
    /// if it turns back there. Returns `true` if it did. A value of 0 at the start has been passed already, and the next call
    /// goes on after the event.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to); [`NonFinite`](crate::FailureKind::NonFinite) where `event` is NaN or infinite; [`InvalidMethodParameter`](crate::FailureKind::InvalidMethodParameter) where the event bound asks for too many parts.
    pub fn advance_until_event(
        &mut self,
        until: R,
        direction: Direction,
        event: impl FnMut(R, &[R; N], &[R; N]) -> R,
    ) -> Result<bool, Failure> {
        self.advance(until, |_| None, Some((direction, event)), |_, _| Ok(()))
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
        self.sampled(until, (samples, grid(self.now.t, until, samples)), |instant, _| see(instant))
    }

    /// As [`sample`](Self::sample), and shows the whole simulation as it is at each of these instants: its outputs, loads and
    /// balance. Its [`counts`](Self::counts) are those of the steps, without the cost of the instants between them.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to).
    pub fn watch(&mut self, until: R, samples: u32, see: impl FnMut(&Self)) -> Result<(), Failure>
    where
        F: Clone,
    {
        let instants = (samples, grid(self.now.t, until, samples));
        self.watched(until, instants, see)
    }

    /// As [`watch`](Self::watch) up to `until` (s), at `parts` equal parts of each step, its end included. Steps are short where forces
    /// change fast, so largest values are seen that a grid of instants misses. Shown once where `until` is the present time.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to).
    pub fn watch_steps(&mut self, until: R, parts: u32, see: impl FnMut(&Self)) -> Result<(), Failure>
    where
        F: Clone,
    {
        self.watched(until, (1, parts_of_steps(parts)), see)
    }

    /// Shows the whole simulation at `instants`, as [`sampled`](Self::sampled) has them.
    fn watched(
        &mut self,
        until: R,
        instants: (u32, impl FnMut([R; 2]) -> Option<R>),
        mut see: impl FnMut(&Self),
    ) -> Result<(), Failure>
    where
        F: Clone,
    {
        let mut shown = self.clone();
        if self.stale {
            let gained = self.fresh(&mut Counts::default())?.gained;
            shown.reference = shown.reference + gained;
        }
        let (steps, reference) = (self.adaptive.accepted, shown.reference);
        self.sampled(until, instants, |instant, run| {
            let mut counts = run.counts;
            counts.steps += u64::from(run.accepted.wrapping_sub(steps));
            shown.take_modes(run.parameters.as_ref());
            shown.take(instant, Some(run.phases), counts);
            shown.passage = shown.passage.or(run.passage);
            shown.reference = reference + run.gained;
            see(&shown);
        })
    }

    /// Shows instants on the way to `until` (s), with the results of the run. The second of `instants` has the next one within the step
    /// between two times, or none; the first is how often a run that does not move is shown.
    ///
    /// The samples do not change the run: rates between its steps are kept apart from it.
    fn sampled(
        &mut self,
        until: R,
        (standing, mut next): (u32, impl FnMut([R; 2]) -> Option<R>),
        mut see: impl FnMut(&Instant<R, N, M, S::States>, &Progress<R, S::Phases, S::Parameters>),
    ) -> Result<(), Failure> {
        let mut accepted_steps = self.adaptive.accepted;
        let method = self.method.integrator;
        if until == self.now.t {
            self.stand()?;
            let (phases, counts) = (self.mechanism.phases(), self.counts);
            let (gained, accepted) = (R::constant(0.0), accepted_steps);
            let progress = Progress { parameters: None, phases, counts, gained, passage: None, accepted };
            (0..standing).for_each(|_| see(&self.now, &progress));
            return Ok(());
        }
        self.advance(
            until,
            |_| None,
            None::<(Direction, NoEvent)>,
            |equations, accepted| {
                let mut polynomial = None;
                accepted_steps = accepted_steps.wrapping_add(1);
                while let Some(t) = next([accepted.start.t, accepted.end.t]) {
                    let (instant, phases) = equations.apart(|equations| {
                        let known = *polynomial.get_or_insert_with(|| accepted.polynomial(equations).ok());
                        let between = || known.map_or_else(|| accepted.cubic(t), |known| known.at(t));
                        let mut y = if t < accepted.end.t { between() } else { accepted.end.y };
                        let solved = equations.shown(method, t, &accepted.start, &mut y)?;
                        let phases = equations.phases(t, &y.phases);
                        Ok((Instant { t, y: y.y, solved, carried: solved.rate.qd }, phases))
                    })?;
                    equations.pass(&instant);
                    let (counts, passage, gained) = (equations.counts, equations.passage, equations.gained);
                    let (parameters, accepted) = (equations.parameters(), accepted_steps);
                    see(&instant, &Progress { parameters, phases, counts, gained, passage, accepted });
                }
                Ok(())
            },
        )
        .map(|_| ())
    }

    /// Runs to `until`, or to the first `event`; returns `true` if it was an event. `see` is shown each step.
    fn advance<E: EventFunction<R, N>>(
        &mut self,
        until: R,
        breakpoints: impl FnMut(R) -> Option<R>,
        mut event: Option<(Direction, E)>,
        mut see: impl FnMut(
            &mut Equations<'_, S, F, R, N, M>,
            &Accepted<I, R, Moving<S, R, N, M>>,
        ) -> Result<(), Failure>,
    ) -> Result<bool, Failure> {
        self.require_settings()?;
        if until == self.now.t {
            return self.stand().map(|()| false);
        }
        let (mut counts, mut adaptive) = (self.counts, self.adaptive);
        if let Some(resolution) = self.scrutiny.resolution {
            adaptive.largest = adaptive.largest.min(R::constant(8.0 * MOST_RESOLVED) * resolution);
        }
        self.tolerance.require_resolved(self.now.t)?;
        self.decide_modes_anew()?;
        let Fresh { instant: from, gained, rank_rises } = self.fresh(&mut counts)?;
        let mut monitor = match &mut event {
            Some((direction, event)) => {
                Some(self.monitor(*direction, &from, &mut |t, q, qd| event.at(t, q, qd))?)
            }
            None => None,
        };
        let model = Model { rank_rises, ..self.model() };
        let (method, formulation) = (self.method.integrator, &self.method.formulation);
        let mut equations = Equations::new(&model, formulation, &from, counts).with_tolerance(self.tolerance);
        equations = equations.with_resolution(self.scrutiny.resolution);
        if self.contact_steps == ContactSteps::Unlocated {
            equations = equations.without_located_contacts();
        }
        let start = beginning(model.mechanism, &from);
        let (mut stopped, mut last, mut errors) = (None, start, self.errors);
        let (taken, resolution, tolerance) = (adaptive.accepted, self.scrutiny.resolution, self.tolerance);
        let run = adaptive.run(method, &mut equations, start, until, breakpoints, |equations, accepted| {
            let (start, mut end) = (accepted.start.t, accepted.end.t);
            errors = errors + accepted.error;
            model.check(end, &accepted.end.y.y)?;
            if const { !E::IS_ANY && S::LIMITS.is_empty() && S::BRANCHES.is_empty() } {
                see(equations, accepted)?;
                last = accepted.end;
                return Ok(true);
            }
            let ends = model.check_assembly(from.t, (end, &accepted.end.y.y), false);
            if monitor.is_none() && S::LIMITS.is_empty() && ends.is_ok() {
                see(equations, accepted)?;
                last = accepted.end;
                return Ok(true);
            }
            let course = equations.apart(|equations| accepted.course(equations));
            if E::IS_ANY
                && let (Some(monitor), Some((_, event))) = (&mut monitor, &mut event)
            {
                if const { S::HAS_MODES } {
                    let [before, after] =
                        [&last.y.y, &accepted.start.y.y].map(|y| event.at(start, &y.q, &y.qd));
                    let y = &accepted.start.y.y;
                    monitor.jump(before, after, || {
                        model.metric.rounding_of(&y.q, |q| event.at(start, q, &y.qd))
                    });
                }
                let mut watched = WithinStep {
                    metric: model.metric,
                    course: |t| course.at(t).y,
                    event: |t, q: &_, qd: &_| event.at(t, q, qd),
                };
                let found = monitor.first((start, end), &mut watched);
                if let Some(reach) = found.map_err(event_failure)? {
                    stopped = Some((reach, course.at(reach.t)));
                    end = reach.t;
                } else if equations.strikes(end, &accepted.end.y) {
                    let y = &accepted.end.y.y;
                    let mut value = |q: &[R; N]| event.at(end, q, &y.qd);
                    let scale = model.metric.rounding_of(&y.q, &mut value);
                    if monitor.reaches(value(&y.q), scale) {
                        stopped = Some((Reach { t: end, scale }, accepted.end.y));
                    }
                }
            }
            let at = |t| course.at(t).y;
            let (before, after) = (&accepted.start.y.y.q, &accepted.end.y.y.q);
            let touched = errors.min(motion::TOUCHED.of());
            let allowed = model.metric.allowed(&tolerance, before, after).each(|one| touched * one);
            model.check_ranges(from.t, (start, end), at, (resolution, &allowed))?;
            model.check_end(from.t, (start, end), at)?;
            see(equations, accepted)?;
            last = accepted.end;
            Ok(stopped.is_none())
        });
        let failure = run.err();
        if let (Some(failure), true) = (failure, last.t == from.t) {
            return Err(failure);
        }
        let (t, mut y) = stopped.map_or((last.t, last.y), |(reach, y)| (reach.t, y));
        if stopped.is_some() && t < last.t {
            Equation::project(&mut equations, t, &mut y)?;
        }
        equations.with_all_contacts();
        let solved = equations.solve(t, &y)?;
        let phases = equations.phases(t, &y.phases);
        counts = equations.counts;
        let (passage, parameters, struck) = (equations.passage, equations.parameters(), equations.gained);
        counts.steps += u64::from(adaptive.accepted.wrapping_sub(taken));
        self.adaptive = adaptive.with_largest(self.adaptive.largest);
        self.errors = errors;
        self.passage = self.passage.or(passage);
        self.rank_rises = rank_rises;
        self.take_modes(parameters.as_ref());
        self.take(&Instant { t, y: y.y, solved, carried: solved.rate.qd }, Some(phases), counts);
        self.passed = passage.is_some();
        self.reference = self.reference + gained + struck;
        if let (Some((reach, _)), Some((_, event))) = (stopped, &mut event) {
            self.stopped = Some(Stopped::new(t, event.at(t, &self.now.y.q, &self.now.y.qd), reach.scale));
        }
        failure.map_or(Ok(stopped.is_some()), Err)
    }
}
