//! The equations of motion as integrators see them.

use crate::dynamics::first_order_form::phases::{ORDER_OF_INTEGRALS, Phased, advanced};
use crate::dynamics::first_order_form::radau;
use crate::dynamics::first_order_form::radau::{Radau5, newton};
use crate::dynamics::formulations::singular::passage::Passage;
use crate::dynamics::integrators::embedded::Embedded;
use crate::dynamics::integrators::equation::{Collocated, Collocation, Equation, ErrorNorm};
use crate::dynamics::integrators::event::{Dense, Scrutiny};
use crate::dynamics::integrators::step_control::{Adaptive, Point};
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::metric::{Tolerance, worse};
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::failure::Failure;
use crate::mechanism::Mechanism;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::singular;

/// First step, of the way to an instant that the polynomial of a step does not lead to.
const SHOWN_SHARE: f64 = 0.25;

/// State vector of a mechanism that is integrated.
pub type Moving<S, R, const N: usize, const M: usize> =
    Phased<IntegratorState<R, N, <S as Dynamic<R, N, M>>::States>, <S as Mechanism<R, N, M>>::Phases>;

/// The equations of motion as an integrator sees them.
pub struct Equations<'a, S: Dynamic<R, N, M>, F, R: Real, const N: usize, const M: usize> {
    pub(crate) model: &'a Model<'a, S, R, N, M>,
    formulation: &'a F,
    tolerance: Tolerance<R>,
    /// Time (s) that phases and inputs of the mechanism belong to.
    pub(crate) start: R,
    /// The mechanism with its phases and inputs moved on to a state; none where no drive prescribes a rate and no input has one.
    moving: Option<S>,
    /// `true` if phases are integrated with the state, and not from `start` to each stage.
    integrating: bool,
    /// `true` if no step can be made smaller.
    fixed: bool,
    /// Multipliers (M) of the last evaluation.
    pub(super) lambda: [R; M],
    /// The last step's end.
    pub(crate) end: Instant<R, N, M, S::States>,
    /// Time (s) and margin of the last instant that was shown.
    seen: (R, R),
    /// The first passage since `start`.
    pub(crate) passage: Option<Passage<R>>,
    /// `end` and `passage` before the last step, once there is one that may be taken again.
    before: Option<Before<S, R, N, M>>,
    /// Resolution and bounds of the search for contacts.
    pub(super) scrutiny: Scrutiny<R>,
    /// The parameters of the present step, without the contacts that are open and with the modes of frictions, where there are any.
    pub(super) parameters: Option<S::Parameters>,
    /// Time (s) up to which all contacts stay open by the bounds that the text declares.
    quiet: R,
    /// `true` if steps end where contacts close or open.
    locates: bool,
    /// Last time (s) at which events changed, and how often they did so next to each other.
    pub(super) changed: (R, u32),
    /// Energy (J) that impacts have brought in: none, or less.
    pub(crate) gained: R,
    pub(crate) counts: Counts,
}

/// The instant at which a step begins, and the first passage before it.
type Before<S, R, const N: usize, const M: usize> =
    (Instant<R, N, M, <S as Dynamic<R, N, M>>::States>, Option<Passage<R>>);

impl<'a, S, F, R, const N: usize, const M: usize> Equations<'a, S, F, R, N, M>
where
    S: Dynamic<R, N, M>,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    /// `true` if a text has contacts, frictions with stiction, or events.
    const MAY_CHANGE: bool = !S::CONTACTS.is_empty() || S::HAS_MODES;

    /// `true` if a drive prescribes a rate, or an input has one.
    const MOVES: bool = !S::PHASES.is_empty() || S::HAS_SIGNALS;

    /// Those of a motion that continues `from`.
    pub(crate) fn new(
        model: &'a Model<'a, S, R, N, M>,
        formulation: &'a F,
        from: &Instant<R, N, M, S::States>,
        counts: Counts,
    ) -> Self {
        let (tolerance, start) = (radau::of_fixed_steps(), from.t);
        let seen = (from.t, from.solved.margin);
        let (lambda, end) = (from.solved.lambda, *from);
        let moving = if const { Self::MOVES } { Some(model.mechanism.clone()) } else { None };
        Equations {
            model,
            formulation,
            tolerance,
            start,
            moving,
            integrating: true,
            fixed: false,
            lambda,
            end,
            seen,
            passage: None,
            before: None,
            scrutiny: Scrutiny::beyond(),
            parameters: None,
            quiet: start,
            locates: true,
            changed: (start, 0),
            gained: R::constant(0.0),
            counts,
        }
    }

    /// Nothing of a contact is missed that lasts longer than `resolution` (s).
    pub(crate) fn with_resolution(self, resolution: Option<R>) -> Self {
        Equations { scrutiny: Scrutiny { resolution, ..self.scrutiny }, ..self }
    }

    /// Steps go over touches and lift-offs of contacts.
    pub(crate) fn without_located_contacts(self) -> Self {
        Equations { locates: false, ..self }
    }

    /// Of steps that are controlled with `tolerance`.
    pub(crate) fn with_tolerance(mut self, tolerance: Tolerance<R>) -> Self {
        self.divide(tolerance);
        self
    }

    /// Result of `look`, which leaves no trace in the run but the count of its evaluations, kept apart. No step can be made
    /// smaller for it.
    pub(crate) fn apart<X>(&mut self, look: impl FnOnce(&mut Self) -> X) -> X {
        let (counts, lambda, fixed) = (self.counts, self.lambda, self.fixed);
        let (end, passage) = (self.end, self.passage);
        let open = Self::MAY_CHANGE.then_some((self.parameters, self.quiet));
        self.fixed = true;
        let found = look(self);
        (self.fixed, self.end, self.passage) = (fixed, end, passage);
        if let Some(open) = open {
            (self.parameters, self.quiet) = open;
        }
        let shown = counts.shown + self.counts.evaluations.wrapping_sub(counts.evaluations);
        (self.counts, self.lambda) = (Counts { shown, ..counts }, lambda);
        found
    }

    /// [`project_and_solve`](Self::project_and_solve) of a state on the polynomial of a step from `from`. Where that is too far
    /// off the constraints to be projected, of the state that smaller steps lead to.
    pub(crate) fn shown<I: Embedded>(
        &mut self,
        method: I,
        t: R,
        from: &Point<R, Moving<S, R, N, M>>,
        y: &mut Moving<S, R, N, M>,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        let before = *y;
        let failure = match self.project_and_solve(t, y) {
            Err(failure) if from.t < t => failure,
            settled => return settled,
        };
        self.fixed = false;
        let first = R::constant(SHOWN_SHARE) * (t - from.t);
        let mut steps = Adaptive::default().with_first(first);
        let run = steps.run(method, self, *from, t, |_| None, |_, _| Ok(true));
        self.fixed = true;
        *y = run.map_err(|_| failure).map_or(before, |point| point.y);
        self.project_and_solve(t, y)
    }

    /// Takes an instant between the ends of steps for where a singular position may be passed.
    pub(crate) fn pass(&mut self, instant: &Instant<R, N, M, S::States>) {
        self.passage = self.passage.or(Passage::between(self.seen, (instant.t, instant.solved.margin)));
        self.seen = (instant.t, instant.solved.margin);
    }

    /// Steps can be made smaller from now on, and are controlled with `tolerance`.
    pub(crate) fn divide(&mut self, tolerance: Tolerance<R>) {
        (self.fixed, self.tolerance) = (false, tolerance);
        if const { Self::MAY_CHANGE } {
            self.parameters = self.parameters.or(Some(*self.model.parameters));
        }
    }

    /// Of steps of a method of `order` that cannot be made smaller.
    pub(crate) fn keep_steps(&mut self, order: u32) {
        (self.fixed, self.integrating) = (true, order > ORDER_OF_INTEGRALS);
    }

    /// The phases at time `t` (s) that have moved on by `increments`.
    pub(crate) fn phases(&mut self, t: R, increments: &S::Phases) -> S::Phases {
        let rates = self.phase_rates(t);
        advanced(self.model.mechanism.phases(), increments, &rates)
    }

    /// The rates that drives prescribe at time `t` (s), with inputs as they are then.
    #[inline(always)]
    fn phase_rates(&mut self, t: R) -> S::Phases {
        let start = self.model.mechanism;
        match &mut self.moving {
            Some(mechanism) if S::HAS_SIGNALS => {
                mechanism.carry_signals(start, t - self.start);
                mechanism.phase_rates(t)
            }
            _ => start.phase_rates(t),
        }
    }

    /// Calls `solve` with the mechanism as it is at time `t` (s), its inputs carried on and its phases moved on by `increments`.
    #[inline(always)]
    pub(super) fn at<X>(
        &mut self,
        t: R,
        increments: &S::Phases,
        solve: impl FnOnce(&Model<'_, S, R, N, M>, &F, &mut [R; M], &mut Counts) -> X,
    ) -> X {
        let phases = if const { S::PHASES.is_empty() } { *increments } else { self.phases(t, increments) };
        let Equations { model, formulation, start, moving, integrating, parameters, lambda, counts, .. } =
            self;
        let present;
        let model = match parameters {
            Some(parameters) if const { Self::MAY_CHANGE } => {
                present = Model { parameters, ..**model };
                &present
            }
            _ => *model,
        };
        let (parameters, moved);
        // `solve` at one place, so that it is compiled into it.
        let model = match moving {
            Some(mechanism) if const { Self::MOVES } => {
                mechanism.carry_signals(model.mechanism, t - *start);
                if *integrating {
                    mechanism.set_phases(phases);
                } else {
                    mechanism.set_phases(model.mechanism.phases());
                    mechanism.advance_phases(*start, t);
                }
                parameters = model.alike(mechanism.parameters());
                moved = Model { mechanism, parameters: &parameters, ..*model };
                &moved
            }
            _ => model,
        };
        solve(model, formulation, lambda, counts)
    }

    /// Rates and multipliers of a state.
    #[inline(always)]
    pub(crate) fn solve(
        &mut self,
        t: R,
        y: &Moving<S, R, N, M>,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        self.at(t, &y.phases, |model, formulation, lambda, counts| {
            // Handed on as it is: what is taken out and wrapped again is copied twice.
            let solved = formulation.solve(model, t, &y.y, lambda, counts);
            if let Ok(solved) = &solved {
                *lambda = solved.lambda;
            }
            solved
        })
    }

    /// Scales of the coordinates: N.
    pub(crate) fn scales(&self) -> &'a [R; N] {
        &self.model.metric.coordinates
    }

    /// The smaller of the tolerances that are not 0.
    pub(crate) fn narrowest(&self) -> R {
        let Tolerance { relative, absolute } = self.tolerance;
        let zero = R::constant(0.0);
        if zero < relative && zero < absolute { relative.min(absolute) } else { relative.max(absolute) }
    }

    /// `true` if no step can be made smaller.
    pub(crate) fn is_fixed(&self) -> bool {
        self.fixed
    }

    /// The failure of an iteration for the stages of a step with the last correction of them.
    pub(crate) fn unbalanced(
        &self,
        step: &Collocation<'_, R, Moving<S, R, N, M>>,
        (correction, iterations): (&Moving<S, R, N, M>, u32),
    ) -> Failure {
        self.model.unbalanced(&correction.y.qd, step.t + step.h, iterations)
    }

    /// The rate of a state whose coordinates, velocities and first-order states have the rate `y`.
    #[inline(always)]
    pub(super) fn phased(&mut self, t: R, y: IntegratorState<R, N, S::States>) -> Moving<S, R, N, M> {
        Phased { y, phases: self.phase_rates(t) }
    }

    /// Rates and multipliers of a state that a step ended in, which is put back onto the constraints.
    #[inline]
    pub(crate) fn project_and_solve(
        &mut self,
        t: R,
        y: &mut Moving<S, R, N, M>,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        let Phased { y, phases } = y;
        self.at(t, phases, |model, formulation, lambda, counts| {
            let mut solved = if const { S::SET_VALUED.is_empty() } {
                formulation.project_and_solve(model, t, y, lambda, counts)
            } else {
                model.settle(formulation, t, y, counts)?;
                formulation.solve(model, t, y, lambda, counts)
            };
            if let Ok(solved) = &mut solved {
                *lambda = solved.lambda;
                solved.margin = model.margin_beside_rows(t, y, solved.margin);
            }
            solved
        })
    }

    /// See [`Model::with_margin_of_rows`].
    pub(crate) fn with_margin_of_rows(
        &mut self,
        t: R,
        y: &Moving<S, R, N, M>,
        solved: Solved<R, N, M, S::States>,
    ) -> Solved<R, N, M, S::States> {
        self.at(t, &y.phases, |model, _, _, _| model.with_margin_of_rows(t, &y.y, solved))
    }
}

impl<S, F, R, const N: usize, const M: usize> Equation<R> for Equations<'_, S, F, R, N, M>
where
    S: Dynamic<R, N, M>,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    type State = Moving<S, R, N, M>;

    #[inline]
    fn rate(&mut self, t: R, y: &Self::State) -> Result<Self::State, Failure> {
        match self.rate_of_stage(t, y) {
            Some(rate) => Ok(rate),
            None => self.rate_solved(t, y),
        }
    }

    #[inline(always)]
    fn rate_of_stage(&mut self, t: R, y: &Self::State) -> Option<Self::State> {
        if const { !S::IS_PARTITIONED } {
            return None;
        }
        let rate = self.at(
            t,
            &y.phases,
            #[inline(always)]
            |model, formulation, lambda, counts| formulation.rate(model, t, &y.y, lambda, counts),
        );
        rate.map(|rate| self.phased(t, rate))
    }

    fn collocate(
        &mut self,
        step: &Collocation<'_, R, Self::State>,
    ) -> Result<Collocated<Self::State>, Failure> {
        const {
            assert!(
                N + M <= Radau5::MOST_UNKNOWNS,
                "an implicit step takes at most 120 coordinates and rows together: its matrices are on the stack"
            );
        }
        newton::collocate(self, step)
    }

    #[inline]
    fn project(&mut self, t: R, y: &mut Self::State) -> Result<(), Failure> {
        let Phased { y, phases } = y;
        self.at(t, phases, |model, formulation, _, counts| model.settle(formulation, t, y, counts))
    }

    #[inline]
    fn settled_rate(&mut self, t: R, y: &mut Self::State) -> Result<Self::State, Failure> {
        let singular = self.counts.singular;
        let solved = self.project_and_solve(t, y)?;
        let (before, margin) = (self.end.t, self.end.solved.margin);
        let next = Instant { t, y: y.y, solved, carried: solved.rate.qd };
        self.require_branch_of_step(&next, self.counts.singular != singular)?;
        if const { Self::MAY_CHANGE } {
            self.before = Some((self.end, self.passage));
        }
        self.passage = self.passage.or(Passage::between((before, margin), (t, solved.margin)));
        self.end = next;
        Ok(self.phased(t, solved.rate))
    }
}

impl<S, F, R, const N: usize, const M: usize> ErrorNorm<R> for Equations<'_, S, F, R, N, M>
where
    S: Dynamic<R, N, M>,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    const MAY_KINK: bool = Self::MAY_CHANGE;

    /// In the zone of a singular position a ten-millionth of a radian, or of a reference length.
    fn least_step(&self) -> R {
        let Instant { y, solved: Solved { margin, .. }, .. } = &self.end;
        let speed = self.model.largest(&y.qd);
        let step = singular::LEAST_MOTION.of::<R>() / speed;
        if *margin < singular::ZONE_OF_FORCES.of() && step.is_finite() { step } else { R::constant(0.0) }
    }

    #[inline(always)]
    fn begin(&mut self, t: R, y: &mut Self::State) -> Result<bool, Failure> {
        let mut changes = false;
        if const { !S::CONTACTS.is_empty() }
            && self.locates
            && let Some(parameters) = &mut self.parameters
        {
            let open = self.model.leave_out(self.start, (t, &y.y), parameters);
            self.quiet = open.until;
            changes = open.changes;
        }
        if const { S::HAS_MODES } {
            changes = self.settle_modes(t, y, changes)?;
        }
        Ok(changes)
    }

    #[inline(always)]
    fn may_kink(&mut self, to: R) -> bool {
        let is_quiet = S::CONTACTS.is_empty() || to <= self.quiet || !self.locates;
        Self::MAY_KINK && (S::HAS_MODES || !is_quiet)
    }

    fn kink(&mut self, step: &impl Dense<R, State = Self::State>) -> Result<Option<R>, Failure> {
        let (start, mut end) = (step.start(), step.end());
        let mut first = None;
        if const { !S::CONTACTS.is_empty() } && self.locates {
            let evaluated = S::evaluated(self.parameters.as_ref().unwrap_or(self.model.parameters));
            let at = |t| step.at(t).y;
            first = self.model.contact_change((self.start, evaluated), (start, end), at, &self.scrutiny)?;
            end = first.unwrap_or(end);
        }
        if const { S::HAS_MODES } && !self.model.first_order {
            return self.change_of_modes(step, (start, end), first);
        }
        Ok(first)
    }

    fn retake(&mut self) {
        (self.end, self.passage) = self.before.unwrap_or((self.end, self.passage));
    }

    fn obstacle(&self) -> Option<Failure> {
        let Instant { t, y, .. } = &self.end;
        self.model.moved(self.start, *t, |model| model.obstacle(*t, y))
    }

    /// The worst of coordinates, velocities, states and phases. Work is watched, not controlled: that it is watched changes no
    /// step.
    #[inline]
    fn measure<const K: usize>(
        &self,
        before: &Self::State,
        after: &Self::State,
        errors: [&Self::State; K],
    ) -> [R; K] {
        let (metric, tolerance) = (self.model.metric, &self.tolerance);
        let (old, new) = (&before.y, &after.y);
        let q = metric.measure(tolerance, &old.q, &new.q, errors.map(|error| &error.y.q));
        let mut largest = metric.measure(tolerance, &old.qd, &new.qd, errors.map(|error| &error.y.qd));
        for ((largest, q), error) in largest.iter_mut().zip(q).zip(errors) {
            let states = old.states.as_ref().iter().zip(new.states.as_ref()).zip(error.y.states.as_ref());
            *largest = states.fold(worse(q, *largest), |largest, ((before, after), error)| {
                let size = before.abs().max(after.abs());
                worse(largest, error.abs() / (tolerance.relative * size + tolerance.absolute))
            });
            let phases = before
                .phases
                .as_ref()
                .iter()
                .zip(after.phases.as_ref())
                .zip(error.phases.as_ref())
                .zip(S::PHASES);
            *largest = phases.fold(*largest, |largest, (((before, after), error), entry)| {
                let size = before.value.abs().max(after.value.abs());
                let allowed = tolerance.relative * size + tolerance.absolute * self.scale(entry);
                worse(largest, error.value.abs() / allowed)
            });
        }
        largest
    }
}
