//! A mechanism as an ordinary differential equation, and the explicit methods that integrate it.

use super::adaptive::{Adaptive, Point};
use super::crossing::{MOST_ROWS, NEAR, is_next_to_singular_position};
use super::embedded::Embedded;
use super::equation::{Collocated, Collocation, Equation, Measured};
use super::event::{Dense, Scrutiny};
use super::explicit::FixedStep;
use super::implicit::require_slopes;
use super::limit_rows::ZONE;
use super::metric::{Tolerance, worse};
use super::model::{Counts, Doubt, Formulation, Model, Solved};
use super::passage::Passage;
use super::phases::{ORDER_OF_INTEGRALS, Phased, advanced, stepped, unmoved};
use super::radau::{self, MOST_UNKNOWNS, Slopes};
use super::vector::{State, Vector};
use crate::{Dynamic, Entry, Failure, Mechanism, Real};

/// Least motion of a step in the zone of a singular position, in the reference metric: smaller ones resolve how rods that
/// differ by 1e-14 turn aside there, which rounding decides.
const LEAST_MOTION: f64 = 1e-7;

/// First step, of the way to an instant that the polynomial of a step does not lead to.
const SHOWN_SHARE: f64 = 0.25;

/// One instant of a motion: state, accelerations, multipliers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant<R, const N: usize, const M: usize, Z> {
    /// Time (s).
    pub t: R,
    /// Coordinates, velocities, first-order states, work.
    pub y: State<R, N, Z>,
    /// Their rates and the multipliers.
    pub solved: Solved<R, N, M, Z>,
    /// Accelerations that a method carries from step to step beside q̈; q̈ where it carries none: N.
    pub carried: [R; N],
}

/// A way to move on: integrator and formulation in one.
pub trait Method<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    /// Accelerations and multipliers at a state.
    ///
    /// # Errors
    /// Those of [`Formulation::solve`].
    fn solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &State<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure>;

    /// One step of `h` (s), positive.
    ///
    /// # Errors
    /// Those of [`Formulation::solve`] and [`Formulation::settle`]; [`Failure::Unbalanced`] of implicit methods.
    fn step(
        &self,
        model: &Model<'_, S, R, N, M>,
        from: &Instant<R, N, M, S::States>,
        h: R,
        counts: &mut Counts,
    ) -> Result<Instant<R, N, M, S::States>, Failure>;

    /// The phases of drives that prescribe a rate after a step of `h` from `t` (s); none where they are those of
    /// [`Mechanism::advance_phases`].
    ///
    /// # Errors
    /// None but of what it calls.
    fn phases_after(
        &self,
        _model: &Model<'_, S, R, N, M>,
        _t: R,
        _h: R,
    ) -> Result<Option<S::Phases>, Failure> {
        Ok(None)
    }

    /// See [`Formulation::require_suitable`].
    ///
    /// # Errors
    /// [`Failure::Unsuitable`]; [`Failure::NotSmooth`] of a method that needs derivatives of the forces.
    fn require_suitable(&self) -> Result<(), Failure> {
        Ok(())
    }

    /// See [`Formulation::admit`].
    ///
    /// # Errors
    /// [`Failure::StepTooLong`].
    fn admit(&self, _h: R, _t: R) -> Result<(), Failure> {
        Ok(())
    }

    /// See [`Formulation::leaves_constraints`].
    fn leaves_constraints(&self) -> bool {
        false
    }

    /// See [`Formulation::doubt`].
    fn doubt(&self, _h: R, _span: R) -> Option<Doubt> {
        None
    }
}

/// A reference does what it refers to does, which may be known at run time only.
impl<S, R, X, const N: usize, const M: usize> Method<S, R, N, M> for &X
where
    S: Dynamic<R, N, M>,
    R: Real,
    X: Method<S, R, N, M> + ?Sized,
{
    fn solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &State<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        (**self).solve(model, t, y, lambda, counts)
    }

    fn step(
        &self,
        model: &Model<'_, S, R, N, M>,
        from: &Instant<R, N, M, S::States>,
        h: R,
        counts: &mut Counts,
    ) -> Result<Instant<R, N, M, S::States>, Failure> {
        (**self).step(model, from, h, counts)
    }

    fn phases_after(&self, model: &Model<'_, S, R, N, M>, t: R, h: R) -> Result<Option<S::Phases>, Failure> {
        (**self).phases_after(model, t, h)
    }

    fn require_suitable(&self) -> Result<(), Failure> {
        (**self).require_suitable()
    }

    fn admit(&self, h: R, t: R) -> Result<(), Failure> {
        (**self).admit(h, t)
    }

    fn leaves_constraints(&self) -> bool {
        (**self).leaves_constraints()
    }

    fn doubt(&self, h: R, span: R) -> Option<Doubt> {
        (**self).doubt(h, span)
    }
}

/// An integrator `I` of equations that are explicit in the accelerations, with the formulation `F` that solves for these.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Explicit<I, F> {
    /// The integrator.
    pub integrator: I,
    /// How accelerations follow from a state.
    pub formulation: F,
}

impl<I, F> Explicit<I, F> {
    /// Both parts.
    pub fn new(integrator: I, formulation: F) -> Self {
        Explicit { integrator, formulation }
    }
}

impl<S, R, I, F, const N: usize, const M: usize> Method<S, R, N, M> for Explicit<I, F>
where
    S: Dynamic<R, N, M>,
    R: Real,
    I: FixedStep,
    F: Formulation<S, R, N, M>,
{
    fn solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &State<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        self.formulation.solve(model, t, y, lambda, counts)
    }

    fn step(
        &self,
        model: &Model<'_, S, R, N, M>,
        from: &Instant<R, N, M, S::States>,
        h: R,
        counts: &mut Counts,
    ) -> Result<Instant<R, N, M, S::States>, Failure> {
        let mut motion = Equations::new(model, &self.formulation, from, *counts).of_fixed_steps(I::ORDER);
        let t = from.t + h;
        let start = beginning(model.mechanism, from);
        let stepped = I::step(&mut motion, from.t, h, &start.y, &start.rate);
        let ended = stepped.and_then(|mut end| match motion.settle_and_solve(t, &mut end) {
            Ok(solved) => Ok((end.y, solved)),
            Err(failure) => model.require_bounded(t, &from.y, &end.y).and(Err(failure)),
        });
        let margin = ended.as_ref().map_or(from.solved.margin, |(_, solved)| solved.margin);
        let entered = motion.counts.singular != counts.singular;
        if entered || margin.min(from.solved.margin) < R::constant(NEAR) {
            let divisible = M <= MOST_ROWS && !(I::USES_SLOPES || self.formulation.leaves_constraints());
            if divisible && (entered || is_next_to_singular_position(model, from, h)) {
                // What the step itself failed with says more than its parts do.
                let next = motion.in_parts(start, t).map_err(|failure| ended.err().unwrap_or(failure))?;
                *counts = motion.counts;
                return Ok(next);
            }
        }
        let (y, solved) = ended?;
        *counts = motion.counts;
        Ok(Instant { t, y, solved, carried: solved.rate.qd })
    }

    fn phases_after(&self, model: &Model<'_, S, R, N, M>, t: R, h: R) -> Result<Option<S::Phases>, Failure> {
        if S::PHASES.is_empty() || I::ORDER <= ORDER_OF_INTEGRALS {
            return Ok(None);
        }
        stepped::<I, S, R, N, M>(model.mechanism, t, h).map(Some)
    }

    fn require_suitable(&self) -> Result<(), Failure> {
        if I::USES_SLOPES {
            require_slopes::<S, R, N, M>()?;
        }
        self.formulation.require_suitable()
    }

    fn admit(&self, h: R, t: R) -> Result<(), Failure> {
        self.formulation.admit(h, t)
    }

    fn leaves_constraints(&self) -> bool {
        self.formulation.leaves_constraints()
    }

    fn doubt(&self, h: R, span: R) -> Option<Doubt> {
        self.formulation.doubt(h, span)
    }
}

/// What is integrated of a mechanism.
pub type Moving<S, R, const N: usize, const M: usize> =
    Phased<State<R, N, <S as Dynamic<R, N, M>>::States>, <S as Mechanism<R, N, M>>::Phases>;

/// Where a run of `mechanism` begins that continues `from`.
pub(super) fn beginning<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    from: &Instant<R, N, M, S::States>,
) -> Point<R, Moving<S, R, N, M>> {
    let y = Phased { y: from.y, phases: unmoved(mechanism.phases()) };
    let rate = Phased { y: from.solved.rate, phases: mechanism.phase_rates(from.t) };
    Point { t: from.t, y, rate }
}

/// The equations of motion as an integrator sees them.
pub struct Equations<'a, S: Dynamic<R, N, M>, F, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    formulation: &'a F,
    tolerance: Tolerance<R>,
    /// Time (s) that phases and inputs of the mechanism belong to.
    pub(super) start: R,
    /// The mechanism with its phases and inputs moved on to a state; none where no drive prescribes a rate and no input has one.
    moving: Option<S>,
    /// Whether phases are integrated with the state, and not from `start` to each stage.
    integrating: bool,
    /// Whether no step can be made smaller.
    fixed: bool,
    /// Multipliers (M) of the last evaluation.
    lambda: [R; M],
    /// Time (s), margin and state of the last step's end.
    end: (R, R, State<R, N, S::States>),
    /// Time (s) and margin of the last instant that was shown.
    seen: (R, R),
    /// The first passage since `start`.
    pub(super) passage: Option<Passage<R>>,
    /// `end` and `passage` before the last step, where steps may be taken again.
    before: Before<S, R, N, M>,
    /// How closely contacts are looked at.
    scrutiny: Scrutiny<R>,
    /// The parameters without the contacts that are open in the present step, where there are contacts.
    parameters: Option<S::Parameters>,
    /// Time (s) up to which all contacts stay open by the bounds that the text declares.
    quiet: R,
    pub(super) counts: Counts,
}

/// Time (s), margin and state where a step begins, and the first passage before it.
type Before<S, R, const N: usize, const M: usize> =
    ((R, R, State<R, N, <S as Dynamic<R, N, M>>::States>), Option<Passage<R>>);

impl<'a, S, F, R, const N: usize, const M: usize> Equations<'a, S, F, R, N, M>
where
    S: Dynamic<R, N, M>,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    /// Those of a motion that continues `from`.
    pub(super) fn new(
        model: &'a Model<'a, S, R, N, M>,
        formulation: &'a F,
        from: &Instant<R, N, M, S::States>,
        counts: Counts,
    ) -> Self {
        let (tolerance, start) = (radau::of_fixed_steps(), from.t);
        let seen = (from.t, from.solved.margin);
        let (lambda, end) = (from.solved.lambda, (seen.0, seen.1, from.y));
        let moving = (!S::PHASES.is_empty() || S::HAS_SIGNALS).then(|| model.mechanism.clone());
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
            before: (end, None),
            scrutiny: Scrutiny::beyond(),
            parameters: (!S::CONTACTS.is_empty()).then_some(*model.parameters),
            quiet: start,
            counts,
        }
    }

    /// Nothing of a contact is missed that lasts longer than `resolution` (s).
    pub(super) fn with_resolution(self, resolution: Option<R>) -> Self {
        Equations { scrutiny: Scrutiny { resolution, ..self.scrutiny }, ..self }
    }

    pub(super) fn with_tolerance(self, tolerance: Tolerance<R>) -> Self {
        Equations { tolerance, ..self }
    }

    /// What `look` finds without a trace in the run but that its evaluations are counted by themselves. No step can be made
    /// smaller for it.
    pub(super) fn apart<X>(&mut self, look: impl FnOnce(&mut Self) -> X) -> X {
        let (counts, lambda, fixed) = (self.counts, self.lambda, self.fixed);
        let (end, passage) = (self.end, self.passage);
        let open = (!S::CONTACTS.is_empty()).then_some((self.parameters, self.quiet));
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

    /// [`settle_and_solve`](Self::settle_and_solve) of a state on the polynomial of a step from `from`, or of the one that smaller steps
    /// lead to where that is too far beside the constraints to be put onto them.
    pub(super) fn shown<I: Embedded>(
        &mut self,
        t: R,
        from: &Point<R, Moving<S, R, N, M>>,
        y: &mut Moving<S, R, N, M>,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        let before = *y;
        let failure = match self.settle_and_solve(t, y) {
            Err(failure) if from.t < t => failure,
            settled => return settled,
        };
        self.fixed = false;
        let first = R::constant(SHOWN_SHARE) * (t - from.t);
        let mut steps = Adaptive::default().with_first(first);
        let run = steps.run::<I, _>(self, *from, t, |_| None, |_, _| Ok(true));
        self.fixed = true;
        *y = run.map_err(|_| failure).map_or(before, |point| point.y);
        self.settle_and_solve(t, y)
    }

    /// Evaluates all contacts, as at an instant by itself.
    pub(super) fn with_all_contacts(&mut self) {
        if !S::CONTACTS.is_empty() {
            self.parameters = Some(*self.model.parameters);
        }
    }

    /// Takes an instant between the ends of steps for where a singular position may be passed.
    pub(super) fn pass(&mut self, instant: &Instant<R, N, M, S::States>) {
        self.passage = self.passage.or(Passage::between(self.seen, (instant.t, instant.solved.margin)));
        self.seen = (instant.t, instant.solved.margin);
    }

    /// Steps can be made smaller from now on, and are controlled with `tolerance`.
    pub(super) fn divide(&mut self, tolerance: Tolerance<R>) {
        (self.fixed, self.tolerance) = (false, tolerance);
    }

    /// Of steps of a method of `order` that cannot be made smaller.
    pub(super) fn of_fixed_steps(self, order: u32) -> Self {
        Equations { fixed: true, integrating: order > ORDER_OF_INTEGRALS, ..self }
    }

    /// The phases at time `t` (s) that have moved on by `increments`.
    pub(super) fn phases(&mut self, t: R, increments: &S::Phases) -> S::Phases {
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
    fn at<X>(
        &mut self,
        t: R,
        increments: &S::Phases,
        solve: impl FnOnce(&Model<'_, S, R, N, M>, &F, &mut [R; M], &mut Counts) -> X,
    ) -> X {
        let phases = if S::PHASES.is_empty() { *increments } else { self.phases(t, increments) };
        let Equations { model, formulation, start, moving, integrating, parameters, lambda, counts, .. } =
            self;
        let model = *model;
        let parameters = match parameters {
            Some(parameters) if !S::CONTACTS.is_empty() => parameters,
            _ => model.parameters,
        };
        let present = Model { parameters, ..*model };
        let Some(mechanism) = moving else {
            let model = if S::CONTACTS.is_empty() { model } else { &present };
            return solve(model, formulation, lambda, counts);
        };
        mechanism.carry_signals(model.mechanism, t - *start);
        if *integrating {
            mechanism.set_phases(phases);
        } else {
            mechanism.set_phases(model.mechanism.phases());
            mechanism.advance_phases(*start, t);
        }
        let parameters = present.alike(mechanism.parameters());
        let moved = Model { mechanism, parameters: &parameters, ..*model };
        solve(&moved, formulation, lambda, counts)
    }

    /// Rates and multipliers of a state.
    #[inline]
    pub(super) fn solve(
        &mut self,
        t: R,
        y: &Moving<S, R, N, M>,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        self.at(t, &y.phases, |model, formulation, lambda, counts| {
            let solved = formulation.solve(model, t, &y.y, lambda, counts)?;
            *lambda = solved.lambda;
            Ok(solved)
        })
    }

    /// Slopes of accelerations and of the rates of first-order states about the beginning of a step, of positions in its middle: stiff
    /// directions turn with the mechanism, and the iteration gains a fifth.
    pub(super) fn slopes(
        &mut self,
        step: &Collocation<'_, R, Moving<S, R, N, M>>,
    ) -> Result<Slopes<S, R, N, M>, Failure> {
        let mut middle = step.y.y;
        middle.q = middle.q.plus(step.h, &[0.5], [&middle.qd]);
        self.at(step.t, &step.y.phases, |model, _, lambda, _| {
            Slopes::of(model, (step.t, &middle), &step.rate.y.qd, lambda)
        })
    }

    /// Scales of the coordinates: N.
    pub(super) fn scales(&self) -> &'a [R; N] {
        &self.model.metric.coordinates
    }

    /// The smaller of the tolerances that are not 0.
    pub(super) fn narrowest(&self) -> R {
        let Tolerance { relative, absolute } = self.tolerance;
        let zero = R::constant(0.0);
        if zero < relative && zero < absolute { relative.min(absolute) } else { relative.max(absolute) }
    }

    /// Whether no step can be made smaller.
    pub(super) fn is_fixed(&self) -> bool {
        self.fixed
    }

    /// The failure of an iteration for the stages of a step with the last correction of them.
    pub(super) fn unbalanced(
        &self,
        step: &Collocation<'_, R, Moving<S, R, N, M>>,
        (correction, iterations): (&Moving<S, R, N, M>, u32),
    ) -> Failure {
        self.model.unbalanced(&correction.y.qd, step.t + step.h, iterations)
    }

    /// The rate of a state whose coordinates, velocities and first-order states have the rate `y`.
    #[inline(always)]
    fn phased(&mut self, t: R, y: State<R, N, S::States>) -> Moving<S, R, N, M> {
        Phased { y, phases: self.phase_rates(t) }
    }

    /// Rates and multipliers of a state that a step ended in, which is put back onto the constraints.
    #[inline]
    pub(super) fn settle_and_solve(
        &mut self,
        t: R,
        y: &mut Moving<S, R, N, M>,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        let Phased { y, phases } = y;
        self.at(t, phases, |model, formulation, lambda, counts| {
            let solved = formulation.settle_and_solve(model, t, y, lambda, counts)?;
            *lambda = solved.lambda;
            Ok(solved)
        })
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
        match self.solve(t, y) {
            Err(failure) if self.fixed => {
                self.model.require_bounded(t, &self.end.2, &y.y)?;
                if !matches!(failure, Failure::OffConstraints { .. }) {
                    return Err(failure);
                }
            }
            solved => return Ok(self.phased(t, solved?.rate)),
        }
        let solved = self.at(t, &y.phases, |model, formulation, lambda, counts| {
            let solved = formulation.solve_as_it_is(model, t, &y.y, lambda, counts)?;
            *lambda = solved.lambda;
            Ok(solved)
        })?;
        Ok(self.phased(t, solved.rate))
    }

    fn collocate(
        &mut self,
        step: &Collocation<'_, R, Self::State>,
    ) -> Result<Collocated<Self::State>, Failure> {
        const {
            assert!(
                N + M <= MOST_UNKNOWNS,
                "an implicit step takes at most 120 coordinates and rows together: its matrices are on the stack"
            );
        }
        radau::collocate(self, step)
    }

    #[inline]
    fn settle(&mut self, t: R, y: &mut Self::State) -> Result<(), Failure> {
        let Phased { y, phases } = y;
        self.at(t, phases, |model, formulation, _, counts| formulation.settle(model, t, y, counts))
    }

    #[inline]
    fn settled_rate(&mut self, t: R, y: &mut Self::State) -> Result<Self::State, Failure> {
        let solved = self.settle_and_solve(t, y)?;
        let (before, margin, _) = self.end;
        if !S::CONTACTS.is_empty() {
            self.before = (self.end, self.passage);
        }
        self.passage = self.passage.or(Passage::between((before, margin), (t, solved.margin)));
        self.end = (t, solved.margin, y.y);
        Ok(self.phased(t, solved.rate))
    }
}

impl<S, F, R, const N: usize, const M: usize> Measured<R> for Equations<'_, S, F, R, N, M>
where
    S: Dynamic<R, N, M>,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    /// In the zone of a singular position a ten-millionth of a radian, or of a reference length.
    fn least_step(&self) -> R {
        let (_, margin, y) = &self.end;
        let speed = self.model.largest(&y.qd);
        let step = R::constant(LEAST_MOTION) / speed;
        if *margin < R::constant(ZONE) && step.is_finite() { step } else { R::constant(0.0) }
    }

    #[inline(always)]
    fn begin(&mut self, t: R, y: &Self::State) -> bool {
        if S::CONTACTS.is_empty() {
            return false;
        }
        let Some(parameters) = &mut self.parameters else { return false };
        let open = self.model.leave_out(self.start, (t, &y.y), parameters);
        self.quiet = open.until;
        open.changes
    }

    #[inline(always)]
    fn may_kink(&mut self, to: R) -> bool {
        let is_quiet = to <= self.quiet;
        !S::CONTACTS.is_empty() && !is_quiet
    }

    fn kink(&mut self, step: &impl Dense<R, State = Self::State>) -> Result<Option<R>, Failure> {
        let ends = (step.start(), step.end());
        let evaluated = S::evaluated(self.parameters.as_ref().unwrap_or(self.model.parameters));
        self.model.contact_change((self.start, evaluated), ends, |t| step.at(t).y, &self.scrutiny)
    }

    fn retake(&mut self) {
        (self.end, self.passage) = self.before;
    }

    fn obstacle(&self) -> Option<Failure> {
        let (t, _, y) = &self.end;
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

impl<S, F, R, const N: usize, const M: usize> Equations<'_, S, F, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    /// Reference metric of a phase: that of rows of its unit, of which its drive is one.
    fn scale(&self, phase: &Entry) -> R {
        let scales = self.model.mechanism.row_scales(self.model.parameters);
        let mut rows = S::ROWS.iter().zip(scales);
        rows.find(|(row, _)| row.unit == phase.unit).map_or(R::constant(1.0), |(_, scale)| scale)
    }
}
