//! Steps of fixed size, with contacts within them.

use crate::dynamics::formulations::singular::passage::Passage;
use crate::dynamics::integrators::step_control::{MOST_RETAKES, Point, cubic};
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::method::{Method, SteppedInModes};
use crate::dynamics::model::{Counts, Model};
use crate::dynamics::simulation::graded_steps::ContactSteps;
use crate::dynamics::simulation::{Began, Fresh, Simulation, Start};
use crate::failure::{Failure, FailureKind};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::motion;

/// A step of fixed size that is not taken yet.
pub(super) struct Ahead<R, P, G, const N: usize, const M: usize, Z> {
    pub(super) from: Fresh<R, N, M, Z>,
    pub(super) next: Instant<R, N, M, Z>,
    phases: Option<P>,
    pub(super) counts: Counts,
    /// Parameters with the modes at its end and the energy (J) that impacts brought in, of a step that goes over them.
    modes: Option<(G, R)>,
}

impl<R: Real, P, G, const N: usize, const M: usize, Z: Copy + AsRef<[R]> + AsMut<[R]>>
    Ahead<R, P, G, N, M, Z>
{
    /// Times (s) of its beginning and of its end.
    pub(super) fn times(&self) -> (R, R) {
        (self.from.instant.t, self.next.t)
    }

    /// An event function at its end.
    pub(super) fn value(&self, event: &mut impl FnMut(R, &[R; N], &[R; N]) -> R) -> R {
        let Instant { t, y, .. } = &self.next;
        event(*t, &y.q, &y.qd)
    }

    /// The state at `t` (s): of the cubic through both ends.
    pub(super) fn at(&self, t: R) -> IntegratorState<R, N, Z> {
        between((&self.from.instant, &self.next), t)
    }

    /// Its beginning and its end.
    fn ends(&self) -> Ends<'_, R, N, M, Z> {
        (self.from.start(), &self.next)
    }
}

/// The state at `t` (s) of a step: of the cubic through both ends.
fn between<R: Real, const N: usize, const M: usize, Z: Copy + AsRef<[R]> + AsMut<[R]>>(
    (from, next): (&Instant<R, N, M, Z>, &Instant<R, N, M, Z>),
    t: R,
) -> IntegratorState<R, N, Z> {
    if next.t <= t {
        return next.y;
    }
    let [start, end] =
        [from, next].map(|instant| Point { t: instant.t, y: instant.y, rate: instant.solved.rate });
    if t <= from.t { from.y } else { cubic(&start, &end, t) }
}

/// Beginning and end of a step, where they are stored.
type Ends<'a, R, const N: usize, const M: usize, Z> = (Start<'a, R, N, M, Z>, &'a Instant<R, N, M, Z>);

/// Parameters without the contacts that are open where a step begins, and the time (s) up to which all stay open by the bounds of the
/// text.
type LeftOut<S, R, const N: usize, const M: usize> =
    (<S as crate::mechanism::Mechanism<R, N, M>>::Parameters, R);

/// A step of a simulation that is not judged yet.
struct FixedStepAttempt<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    ahead: AheadOf<S, R, N, M>,
    open: Option<LeftOut<S, R, N, M>>,
}

/// A step of a simulation.
pub(super) type AheadOf<S, R, const N: usize, const M: usize> = Ahead<
    R,
    <S as crate::mechanism::Mechanism<R, N, M>>::Phases,
    <S as crate::mechanism::Mechanism<R, N, M>>::Parameters,
    N,
    M,
    <S as Dynamic<R, N, M>>::States,
>;

impl<S, X, R, const N: usize, const M: usize> Simulation<S, X, R, N, M>
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    /// Moves on by one step of `h` (s), with a fixed amount of work. Exceptions are a step in which a contact closes or opens and
    /// one next to a singular position. A third one is a step of [`Extrapolated`](crate::dynamics::Extrapolated) that does not resolve the forces. The
    /// first is cut there, into eight parts at most, each found by some steps. The
    /// second is taken in parts with an estimate of their error, by
    /// [`DormandPrince8`](crate::dynamics::integrators::dormand_prince8::DormandPrince8). The time is that of all steps in a row
    /// together, to rounding: the rounding of one step is made up for in the next.
    ///
    /// A step that gains energy is refused. One that is inaccurate without that is not, because its error would take a second
    /// step to tell. A long step of a uniform motion is exact, even over many turns. `advance_to` keeps to a tolerance.
    ///
    /// # Errors
    /// [`FailureKind::InvalidStep`], [`FailureKind::StepTooLong`], [`FailureKind::Unbounded`], [`FailureKind::EnergyGain`], those of the method,
    /// [`FailureKind::WrongBranch`], [`FailureKind::BeyondLimit`]; [`FailureKind::VanishingGradient`] and [`FailureKind::SingularMass`] where the state itself
    /// shows the cause. The state is then bit for bit as before.
    pub fn step(&mut self, h: R) -> Result<(), Failure> {
        let (length, rest) = self.length(h);
        self.stepped(length)?;
        self.clock = (self.now.t, rest);
        Ok(())
    }

    /// The length (s) of a step of `h` (s) as times have it, with the rounding of earlier ones, and its own rounding.
    pub(super) fn length(&self, h: R) -> (R, R) {
        let (zero, from) = (R::constant(0.0), self.now.t);
        let wanted = if self.clock.0 == from { h + self.clock.1 } else { h };
        let length = (from + wanted) - from;
        // A step that is none is named as it was given.
        if zero.less(h) && from + h != from && zero.less(length) {
            (length, wanted - length)
        } else {
            (h, zero)
        }
    }

    /// A step of `h` (s), as it is.
    fn stepped(&mut self, h: R) -> Result<(), Failure> {
        if const { S::HAS_MODES } {
            return self.step_in_parts(self.now.t + h);
        }
        if const { !S::CONTACTS.is_empty() } && !self.method.steps_over_modes() {
            return self.step_with_contacts(h);
        }
        self.whole_step(h)
    }

    /// A step of `h` (s) that ends at no contact. Each instant stays where it was made: it is long.
    #[inline(always)]
    fn whole_step(&mut self, h: R) -> Result<(), Failure> {
        let mut counts = self.counts;
        let mut anew = None;
        let from = self.beginning(h, &mut anew, &mut counts)?;
        let model = Model { rank_rises: from.rank_rises, first_order: true, ..self.model() };
        match &self.method.step(&model, from.instant, h, &mut counts) {
            Ok(next) => {
                let phases = self.method.phases_after(&model, from.instant.t, h)?;
                counts.steps = self.counts.steps + 1;
                self.judge(&model, (from, next))?;
                self.check_ends((from, next))?;
                let began = from.began();
                self.go_on(began, next, phases, counts);
                Ok(())
            }
            Err(failure) => Err(model.traced(*failure, from.instant.t, &from.instant.y)),
        }
    }

    /// The instant at which a step of `h` (s) begins; `anew`: room for one that is solved anew.
    #[inline(always)]
    fn beginning<'a>(
        &'a self,
        h: R,
        anew: &'a mut Option<Fresh<R, N, M, S::States>>,
        counts: &mut Counts,
    ) -> Result<Start<'a, R, N, M, S::States>, Failure> {
        let t = self.now.t + h;
        if !R::constant(0.0).less(h) || !t.is_finite() || t == self.now.t {
            return Err(FailureKind::InvalidStep { step: h.to_f64() }.at(self.now.t.to_f64()));
        }
        self.method.check_step(h, self.now.t)?;
        self.start_in(anew, counts)
    }

    /// Moves on to `until` (s) in `steps` equal steps; not at all where `until` is the present time.
    ///
    /// # Errors
    /// [`FailureKind::NoSteps`] for 0 `steps`, else as [`step`](Self::step); the state is then that before the step that failed.
    pub fn step_to(&mut self, until: R, steps: u32) -> Result<(), Failure> {
        let from = self.now.t;
        self.require_steps(until, steps)?;
        if until == from {
            return self.stand();
        }
        for index in 1..=steps {
            self.stepped(end_of(from, until, (index, steps)) - self.now.t)?;
        }
        Ok(())
    }

    pub(super) fn require_steps(&self, until: R, steps: u32) -> Result<(), Failure> {
        if steps == 0 {
            return Err(FailureKind::NoSteps { until: until.to_f64() }.at(self.now.t.to_f64()));
        }
        Ok(())
    }

    /// A step of `h` (s), with the failures of its end; `counts`: those before it; `without_open`: contacts that are open where
    /// it begins are left out.
    pub(super) fn ahead(
        &self,
        h: R,
        counts: Counts,
        without_open: bool,
    ) -> Result<AheadOf<S, R, N, M>, Failure> {
        let mut open = None;
        let ahead = self.trial(h, counts, without_open.then_some(&mut open));
        match ahead.as_ref().map_or(Ok(()), |known| self.judge(&self.model(), known.ends())) {
            Ok(()) => ahead,
            Err(failure) => Err(failure),
        }
    }

    /// A step of `h` (s) of which the end is not judged yet. Contacts that are open where it begins are left out where `open` is asked
    /// for.
    #[inline(always)]
    fn trial(
        &self,
        h: R,
        mut counts: Counts,
        open: Option<&mut Option<LeftOut<S, R, N, M>>>,
    ) -> Result<AheadOf<S, R, N, M>, Failure> {
        let mut anew = None;
        let start = self.beginning(h, &mut anew, &mut counts)?;
        let Start { instant: from, rank_rises, .. } = start;
        let model = Model { rank_rises, first_order: true, ..self.model() };
        let mut parameters = &self.parameters;
        if const { !S::CONTACTS.is_empty() }
            && let Some(open) = open
        {
            let (left_out, quiet) = open.insert((self.parameters, from.t));
            *quiet = model.leave_out(from.t, (from.t, &from.y), left_out).until;
            parameters = left_out;
        }
        let model = Model { parameters, ..model };
        let mut modes = None;
        // No `map_err`, which would move the whole instant once more.
        let next = if const { S::HAS_MODES } && self.method.steps_over_modes() {
            match self.method.step_in_modes(&model, from, h, &mut counts) {
                Ok(SteppedInModes { next, parameters, gained }) => {
                    modes = parameters.map(|parameters| (parameters, gained));
                    next
                }
                Err(failure) => return Err(model.traced(failure, from.t, &from.y)),
            }
        } else {
            match self.method.step(&model, from, h, &mut counts) {
                Ok(next) => next,
                Err(failure) => return Err(model.traced(failure, from.t, &from.y)),
            }
        };
        let phases = self.method.phases_after(&model, from.t, h)?;
        counts.steps = self.counts.steps + 1;
        Ok(Ahead { from: start.fresh(), next, phases, counts, modes })
    }

    /// Fails where a step does not end as one of a motion.
    #[inline(always)]
    fn judge(
        &self,
        model: &Model<'_, S, R, N, M>,
        (start, next): Ends<'_, R, N, M, S::States>,
    ) -> Result<(), Failure> {
        let from = start.instant;
        let judged = model.require_plausible((from, next.t - from.t), next);
        let judged = judged.and_then(|()| model.check(next.t, &next.y));
        judged.map_err(|failure| {
            let model = Model { rank_rises: start.rank_rises, ..self.model() };
            model.traced(failure, from.t, &from.y)
        })
    }

    /// Fails where a step leaves a working range or a branch.
    pub(super) fn check_ahead(&self, ahead: &AheadOf<S, R, N, M>) -> Result<(), Failure> {
        self.check_ends(ahead.ends())
    }

    /// [`check_ahead`](Self::check_ahead) of a step by its ends.
    fn check_ends(&self, (from, next): Ends<'_, R, N, M, S::States>) -> Result<(), Failure> {
        let (model, from) = (self.model(), from.instant);
        let (start, end, unknown) = (from.t, next.t, [R::constant(0.0); N]);
        let at = |t| between((from, next), t);
        model.check_ranges(start, (start, end), at, (self.scrutiny.resolution, &unknown))?;
        model.check_branches(start, (end, &next.y))
    }

    /// Takes a step.
    pub(super) fn go(&mut self, ahead: &AheadOf<S, R, N, M>) {
        if const { S::HAS_MODES }
            && let Some((parameters, gained)) = &ahead.modes
        {
            self.take_modes(Some(parameters));
            self.reference = self.reference + *gained;
        }
        self.go_on(ahead.from.start().began(), &ahead.next, ahead.phases, ahead.counts);
    }

    /// [`go`](Self::go), of a step by its ends.
    fn go_on(
        &mut self,
        Began { at, gained, rank_rises }: Began<R>,
        next: &Instant<R, N, M, S::States>,
        phases: Option<S::Phases>,
        counts: Counts,
    ) {
        self.rank_rises = rank_rises;
        self.take(next, phases, counts);
        if let Some(passage) = Passage::between(at, (next.t, next.solved.margin)) {
            (self.passage, self.passed) = (self.passage.or(Some(passage)), true);
        }
        self.reference = self.reference + gained;
    }

    /// The first time (s) within a step at which a contact closes or opens, unless that is its end.
    fn kink(
        &self,
        FixedStepAttempt { ahead, open }: &FixedStepAttempt<S, R, N, M>,
    ) -> Result<Option<R>, Failure> {
        let (model, (start, end)) = (self.model(), ahead.times());
        let (parameters, quiet) =
            open.as_ref().map_or((&self.parameters, start), |(parameters, quiet)| (parameters, *quiet));
        let mut kink = None;
        if const { !S::CONTACTS.is_empty() } && quiet < end && self.contact_steps != ContactSteps::Unlocated {
            let evaluated = (start, S::evaluated(parameters));
            kink = model.contact_change(evaluated, (start, end), |t| ahead.at(t), &self.scrutiny)?;
        }
        let least = motion::LEAST_STEP.of::<R>() * start.abs().max(end.abs());
        // A step into a contact says nothing of speeds: its curve has the end's acceleration. The one up to the contact does.
        if const { !S::EVENTS.is_empty() } && kink.is_none_or(|kink| !least.less(end - kink)) {
            let model = Model { parameters, ..model };
            kink = self.event(&model, ahead, kink.unwrap_or(end))?.or(kink);
        }
        if const { !S::SET_VALUED.is_empty() } && kink.is_none_or(|kink| !least.less(end - kink)) {
            let model = Model { parameters, ..model };
            kink = self.slip(&model, ahead, kink.unwrap_or(end))?.or(kink);
        }
        Ok(kink.map(|kink| kink.max(start + least)).filter(|kink| least < end - *kink))
    }

    /// The first time (s) of a step, up to `end` (s), at which a friction changes its mode.
    #[inline(never)]
    fn slip(
        &self,
        model: &Model<'_, S, R, N, M>,
        ahead: &AheadOf<S, R, N, M>,
        end: R,
    ) -> Result<Option<R>, Failure> {
        let (start, from) = (ahead.times().0, &ahead.from.instant);
        let lambda = from.solved.lambda;
        model.first_slip((start, end), self.scrutiny.resolution, |t, first, values| {
            let y = ahead.at(t);
            model.moved(start, t, |model| {
                let solved = match model.sticks() {
                    true => self.method.solve(model, t, &y, &lambda, &mut Counts::default()).map(Some),
                    false => Ok(None),
                };
                match solved {
                    Ok(solved) => model.slip_values((t, &y), solved.as_ref(), (first, values)),
                    Err(_) => values.fill(R::constant(f64::NAN)),
                }
            });
        })
    }

    /// A step of `h` (s), or up to where a contact closes or opens. Nothing after that is judged.
    pub(super) fn ahead_to_kink(&self, h: R) -> Result<AheadOf<S, R, N, M>, Failure> {
        let over = S::CONTACTS.is_empty() || self.contact_steps == ContactSteps::Unlocated;
        if !S::HAS_MODES && over || self.method.steps_over_modes() {
            return self.ahead(h, self.counts, false);
        }
        let mut trial = self.trial_with_contacts(h, self.counts)?;
        for _ in 0..MOST_RETAKES {
            let Some(kink) = self.kink(&trial)? else { break };
            trial = self.trial_with_contacts(kink - self.now.t, trial.ahead.counts)?;
        }
        self.judge(&self.model(), trial.ahead.ends()).map(|()| trial.ahead)
    }

    /// A step of `h` (s) that does not feel the contacts that it runs into; one that does, where there is none without them.
    fn trial_with_contacts(&self, h: R, counts: Counts) -> Result<FixedStepAttempt<S, R, N, M>, Failure> {
        let mut open = None;
        match self.trial(h, counts, Some(&mut open)) {
            Ok(ahead) => Ok(FixedStepAttempt { ahead, open }),
            Err(_) => self.trial(h, counts, None).map(|ahead| FixedStepAttempt { ahead, open: None }),
        }
    }

    /// A step of `h` (s) of a text with contacts.
    fn step_with_contacts(&mut self, h: R) -> Result<(), Failure> {
        match self.contact_steps {
            ContactSteps::Located => {}
            ContactSteps::Graded(_) => return self.step_in_parts(self.now.t + h),
            ContactSteps::Unlocated => return self.whole_step(h),
        }
        let trial = self.trial_with_contacts(h, self.counts)?;
        if self.kink(&trial)?.is_some() {
            return self.step_in_parts(trial.ahead.next.t);
        }
        self.judge(&self.model(), trial.ahead.ends())?;
        self.check_ahead(&trial.ahead)?;
        self.go(&trial.ahead);
        Ok(())
    }

    /// Moves on to `until` (s) by a step in which contacts close or open, part after part.
    #[cold]
    #[inline(never)]
    fn step_in_parts(&mut self, until: R) -> Result<(), Failure> {
        let (mechanism, parameters, now) = (self.mechanism.clone(), self.parameters, self.now);
        let (marks, sums) =
            ((self.stale, self.rank_rises, self.passed), (self.reference, self.passage, self.counts));
        let result = self.parts(until);
        if result.is_err() {
            (self.mechanism, self.parameters, self.now) = (mechanism, parameters, now);
            (self.stale, self.rank_rises, self.passed) = marks;
            (self.reference, self.passage, self.counts) = sums;
        } else {
            // The parts of one step count as one.
            self.counts.steps = sums.2.steps + 1;
        }
        result
    }

    fn parts(&mut self, until: R) -> Result<(), Failure> {
        let (whole, most) = (until - self.now.t, self.most_parts());
        for part in 1..=most {
            self.require_parts(part)?;
            self.decide_modes()?;
            let rest = until - self.now.t;
            let ahead = match part < most || S::HAS_MODES {
                true => self.ahead_to_kink(self.part_of(whole, rest))?,
                false => self.ahead(rest, self.counts, false)?,
            };
            self.check_ahead(&ahead)?;
            self.go(&ahead);
            if until <= self.now.t {
                break;
            }
        }
        Ok(())
    }
}

/// End (s) of one step of several.
pub(super) fn end_of<R: Real>(from: R, until: R, (index, steps): (u32, u32)) -> R {
    let share = R::constant(f64::from(index)) / R::constant(f64::from(steps));
    if index == steps { until } else { from + (until - from) * share }
}
