//! Steps of fixed size, with events and contacts within them.

use crate::dynamics::formulations::singular::passage::Passage;
use crate::dynamics::integrators::event::monitor::{Monitor, Stopped};
use crate::dynamics::integrators::event::{
    Direction, MOST_BOUNDED_PARTS, MOST_RESOLVED, Scrutiny, Unanswered,
};
use crate::dynamics::integrators::step_control::{MOST_RETAKES, Point, cubic};
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::method::Method;
use crate::dynamics::model::{Counts, Model};
use crate::dynamics::simulation::{Fresh, Simulation};
use crate::failure::{Failure, FailureKind};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::motion;

/// The failure of an event function that is NaN or infinite.
const UNDEFINED_EVENT: Failure = FailureKind::NonFinite { name: "event function", line: 0 }.without_time();

/// Parts that contacts may cut a step of fixed size into.
const MOST_PARTS: u32 = 8;

/// Steps that an event is located by: the cubic of a step misses it by little, that of a step up to there by next to nothing.
const MOST_TRIALS: u32 = 48;

/// Factor by which a trial goes further than the one before that did not reach the event either.
const GROWTH: f64 = 4.0;

/// Share of a step over which the slope of an event function is taken.
const SLOPE_SHARE: f64 = 1e-4;

/// A step of fixed size that is not taken yet.
struct Ahead<R, P, const N: usize, const M: usize, Z> {
    from: Fresh<R, N, M, Z>,
    next: Instant<R, N, M, Z>,
    phases: Option<P>,
    counts: Counts,
}

impl<R: Real, P, const N: usize, const M: usize, Z: Copy + AsRef<[R]> + AsMut<[R]>> Ahead<R, P, N, M, Z> {
    /// Times (s) of its beginning and of its end.
    fn times(&self) -> (R, R) {
        (self.from.instant.t, self.next.t)
    }

    /// An event function at its end.
    fn value(&self, event: &mut impl FnMut(R, &[R; N], &[R; N]) -> R) -> R {
        let Instant { t, y, .. } = &self.next;
        event(*t, &y.q, &y.qd)
    }

    /// The state at `t` (s): of the cubic through both ends.
    fn at(&self, t: R) -> IntegratorState<R, N, Z> {
        let (from, next) = (&self.from.instant, &self.next);
        if next.t <= t {
            return next.y;
        }
        let [start, end] =
            [from, next].map(|instant| Point { t: instant.t, y: instant.y, rate: instant.solved.rate });
        if t <= from.t { from.y } else { cubic(&start, &end, t) }
    }
}

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
type AheadOf<S, R, const N: usize, const M: usize> =
    Ahead<R, <S as crate::mechanism::Mechanism<R, N, M>>::Phases, N, M, <S as Dynamic<R, N, M>>::States>;

impl<S, X, R, const N: usize, const M: usize> Simulation<S, X, R, N, M>
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    /// Nothing that lasts longer than `resolution` (s), positive, is missed of events, limits and contacts, whatever functions they
    /// are. By default that is an eighth of each step; smooth functions are found however short they pass zero.
    pub fn with_event_resolution(self, resolution: R) -> Self {
        let scrutiny = Scrutiny { resolution: Some(resolution), ..self.scrutiny };
        Simulation { scrutiny, ..self }
    }

    /// Bound of the second time derivatives |g̈| (unit of g per second squared) of the event functions g of this run,
    /// positive. With it none of their passages is missed.
    pub fn with_event_bound(self, bound: R) -> Self {
        Simulation { scrutiny: Scrutiny { bound: Some(bound), ..self.scrutiny }, ..self }
    }

    /// Moves on by one step of `h` (s), with a fixed amount of work. Exceptions are a step in which a contact closes or opens,
    /// and one next to a singular position. The first is cut there, into eight parts at most, each found by some steps. The
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
    fn length(&self, h: R) -> (R, R) {
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
        if const { !S::CONTACTS.is_empty() } {
            return self.step_with_contacts(h);
        }
        let ahead = self.ahead(h, self.counts, false)?;
        self.check_ahead(&ahead)?;
        self.go(ahead);
        Ok(())
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

    /// As [`step_to`](Self::step_to), but stops where `event` of time, coordinates and velocities first reaches zero, even if it
    /// turns back there. Returns `true` if it did. The step that ends there is shortened, so that the state is one of the method.
    /// The event is searched on the cubic through the ends of each step. A value of 0 at the start has been passed already, and
    /// the next call goes on after the event.
    ///
    /// # Errors
    /// As [`step`](Self::step); [`FailureKind::NonFinite`] where `event` is NaN or infinite; [`FailureKind::InvalidMethodParameter`] where the event bound asks for too many parts. The state is then that before the step that failed.
    pub fn step_until_event(
        &mut self,
        until: R,
        steps: u32,
        direction: Direction,
        mut event: impl FnMut(R, &[R; N], &[R; N]) -> R,
    ) -> Result<bool, Failure> {
        let from = self.now.t;
        self.require_settings()?;
        self.require_steps(until, steps)?;
        if until == from {
            return self.stand().map(|()| false);
        }
        self.require_resolution((until - from) / R::constant(f64::from(steps)))?;
        let fresh = self.fresh(&mut Counts::default())?.instant;
        let mut monitor = self.monitor(direction, &fresh, &mut event)?;
        for index in 1..=steps {
            let end = end_of(from, until, (index, steps));
            for part in 1..=MOST_PARTS {
                let h = end - self.now.t;
                let to_kink = part < MOST_PARTS;
                let whole = if to_kink { self.ahead_to_kink(h)? } else { self.ahead(h, self.counts, false)? };
                let before = monitor;
                let found = reached(&mut monitor, &whole, &mut event)?;
                let (last, is_event) = match found {
                    Some((t, _)) => self.ahead_to_event((whole, to_kink), t, before, &mut event)?,
                    None => (whole, false),
                };
                self.check_ahead(&last)?;
                self.go(last);
                if let Some((_, scale)) = found.filter(|_| is_event) {
                    let value = event(self.now.t, &self.now.y.q, &self.now.y.qd);
                    self.stopped = Some(Stopped::new(self.now.t, value, scale));
                    return Ok(true);
                }
                if end <= self.now.t {
                    break;
                }
            }
        }
        Ok(false)
    }

    /// Fails where the resolution of events would divide a step of `h` (s) into more parts than are looked at.
    fn require_resolution(&self, h: R) -> Result<(), Failure> {
        let most = R::constant(8.0 * MOST_RESOLVED);
        match self.scrutiny.resolution.map(|resolution| h / resolution).filter(|parts| most < *parts) {
            Some(parts) => {
                let (name, value) = ("length of a step over the event resolution", parts.to_f64());
                Err(FailureKind::InvalidMethodParameter { name, value, most: most.to_f64() }.without_time())
            }
            None => Ok(()),
        }
    }

    fn require_steps(&self, until: R, steps: u32) -> Result<(), Failure> {
        if steps == 0 {
            return Err(FailureKind::NoSteps { until: until.to_f64() }.at(self.now.t.to_f64()));
        }
        Ok(())
    }

    /// A step of `h` (s), with the failures of its end; `counts`: those before it; `without_open`: contacts that are open where
    /// it begins are left out.
    fn ahead(&self, h: R, counts: Counts, without_open: bool) -> Result<AheadOf<S, R, N, M>, Failure> {
        let mut open = None;
        let mut ahead = self.trial(h, counts, without_open.then_some(&mut open));
        if let Ok(known) = &ahead
            && let Err(failure) = self.judge(known)
        {
            ahead = Err(failure);
        }
        ahead
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
        let t = self.now.t + h;
        if !R::constant(0.0).less(h) || !t.is_finite() || t == self.now.t {
            return Err(FailureKind::InvalidStep { step: h.to_f64() }.at(self.now.t.to_f64()));
        }
        self.method.check_step(h, self.now.t)?;
        let fresh = self.fresh(&mut counts)?;
        let (from, rank_rises) = (&fresh.instant, fresh.rank_rises);
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
        let next = self
            .method
            .step(&model, from, h, &mut counts)
            .map_err(|failure| model.traced(failure, from.t, &from.y))?;
        let phases = self.method.phases_after(&model, from.t, h)?;
        counts.steps = self.counts.steps + 1;
        Ok(Ahead { from: fresh, next, phases, counts })
    }

    /// Fails where a step does not end as one of a motion.
    #[inline(always)]
    fn judge(&self, ahead: &AheadOf<S, R, N, M>) -> Result<(), Failure> {
        let (from, next) = (&ahead.from.instant, &ahead.next);
        let model = Model { rank_rises: ahead.from.rank_rises, ..self.model() };
        let judged = model.require_plausible((from, next.t - from.t), next);
        let judged = judged.and_then(|()| model.check(next.t, &next.y));
        judged.map_err(|failure| model.traced(failure, from.t, &from.y))
    }

    /// Fails where a step leaves a working range or a branch.
    fn check_ahead(&self, ahead: &AheadOf<S, R, N, M>) -> Result<(), Failure> {
        let (model, (start, end)) = (self.model(), ahead.times());
        let unknown = [R::constant(0.0); N];
        model.check_ranges(start, (start, end), |t| ahead.at(t), (self.scrutiny.resolution, &unknown))?;
        model.check_branches(start, (end, &ahead.next.y))
    }

    /// Takes a step.
    fn go(&mut self, ahead: AheadOf<S, R, N, M>) {
        let Ahead { from: Fresh { instant: from, gained, rank_rises }, next, phases, counts } = ahead;
        let ends = ((from.t, from.solved.margin), (next.t, next.solved.margin));
        let passage = Passage::between(ends.0, ends.1);
        self.passage = self.passage.or(passage);
        self.rank_rises = rank_rises;
        self.take(next, phases, counts);
        self.passed = passage.is_some();
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
        if const { S::CONTACTS.is_empty() } || end <= quiet {
            return Ok(None);
        }
        let evaluated = (start, S::evaluated(parameters));
        let kink = model.contact_change(evaluated, (start, end), |t| ahead.at(t), &self.scrutiny)?;
        let least = motion::LEAST_STEP.of::<R>() * start.abs().max(end.abs());
        Ok(kink.map(|kink| kink.max(start + least)).filter(|kink| least < end - *kink))
    }

    /// A step of `h` (s), or up to where a contact closes or opens. Nothing after that is judged.
    fn ahead_to_kink(&self, h: R) -> Result<AheadOf<S, R, N, M>, Failure> {
        if const { S::CONTACTS.is_empty() } {
            return self.ahead(h, self.counts, false);
        }
        let mut trial = self.trial_with_contacts(h, self.counts)?;
        for _ in 0..MOST_RETAKES {
            let Some(kink) = self.kink(&trial)? else { break };
            trial = self.trial_with_contacts(kink - self.now.t, trial.ahead.counts)?;
        }
        self.judge(&trial.ahead).map(|()| trial.ahead)
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
        let trial = self.trial_with_contacts(h, self.counts)?;
        if self.kink(&trial)?.is_some() {
            return self.step_in_parts(trial.ahead.next.t);
        }
        self.judge(&trial.ahead)?;
        self.check_ahead(&trial.ahead)?;
        self.go(trial.ahead);
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
        for part in 1..=MOST_PARTS {
            let h = until - self.now.t;
            let to_kink = part < MOST_PARTS;
            let ahead = if to_kink { self.ahead_to_kink(h)? } else { self.ahead(h, self.counts, false)? };
            self.check_ahead(&ahead)?;
            self.go(ahead);
            if until <= self.now.t {
                break;
            }
        }
        Ok(())
    }

    /// The step that ends at the event that the cubic of `whole` has at `t` (s), after it by rounding; `monitor` as it was
    /// before. Or the whole step and false, where no step within it reaches the event.
    fn ahead_to_event(
        &self,
        (whole, without_open): (AheadOf<S, R, N, M>, bool),
        mut t: R,
        monitor: Monitor<R>,
        event: &mut impl FnMut(R, &[R; N], &[R; N]) -> R,
    ) -> Result<(AheadOf<S, R, N, M>, bool), Failure> {
        let (start, end) = whole.times();
        let least = motion::LEAST_STEP.of::<R>() * start.abs().max(end.abs());
        let (half, mut before, mut growth) = (R::constant(0.5), start, R::constant(1.0));
        let (mut behind, mut shortened, mut near) = (whole, false, None);
        for _ in 0..MOST_TRIALS {
            t = t.max(start + least);
            if behind.next.t - t <= least {
                break;
            }
            let trial = self.ahead(t - start, behind.counts, without_open)?;
            let middle = |from: R, to: R| from + half * (to - from);
            if let Some((found, _)) = reached(&mut monitor.clone(), &trial, event)? {
                t = if before < found { found } else { middle(before, trial.next.t) };
                (behind, shortened, growth) = (trial, true, R::constant(1.0));
            } else {
                let last = behind.next.t;
                before = t;
                behind.counts = trial.counts;
                let further = t + growth * (further(&trial, event) + least);
                t = if further < last { further } else { middle(t, last) };
                growth = R::constant(GROWTH) * growth;
                near = Some(trial.value(event));
            }
        }
        let passed = |near: R| near * behind.value(event) <= R::constant(0.0);
        let found = shortened || near.is_none_or(passed);
        Ok((behind, found))
    }

    /// Fails if a setting of the run is not positive, or if the bound of an event's second derivative is not finite. With such a
    /// bound every step would be searched as if it could hold any number of events.
    pub(super) fn require_settings(&self) -> Result<(), Failure> {
        let Scrutiny { resolution, bound, .. } = self.scrutiny;
        let positive = |value: R| R::constant(0.0) < value;
        let settings = [
            ("largest step", Some(self.adaptive.largest), true),
            ("event resolution", resolution, true),
            ("event bound", bound, bound.is_none_or(R::is_finite)),
        ];
        for (setting, value, suits) in settings {
            if let Some(value) = value.filter(|value| !(positive(*value) && suits)) {
                return Err(FailureKind::InvalidMethodParameter {
                    name: setting,
                    value: value.to_f64(),
                    most: f64::INFINITY,
                }
                .without_time());
            }
        }
        Ok(())
    }

    /// An event function as it is where a run begins.
    pub(super) fn monitor(
        &self,
        direction: Direction,
        from: &Instant<R, N, M, S::States>,
        event: &mut impl FnMut(R, &[R; N], &[R; N]) -> R,
    ) -> Result<Monitor<R>, Failure> {
        let value = event(from.t, &from.y.q, &from.y.qd);
        if value.partial_cmp(&value).is_none() {
            return Err(UNDEFINED_EVENT);
        }
        let scrutiny = Scrutiny { touching: true, ..self.scrutiny };
        Ok(Monitor::new(direction, scrutiny, (from.t, value), (self.stopped, self.stale)))
    }
}

/// The failure of an event function of which a step does not tell where it reaches zero.
#[cold]
pub(super) fn event_failure<R: Real>(why: Unanswered<R>) -> Failure {
    match why {
        Unanswered::Undefined(_) => UNDEFINED_EVENT,
        Unanswered::OutOfParts(_) => {
            let most = f64::from(MOST_BOUNDED_PARTS);
            let name = "number of parts that the event bound divides a step into";
            FailureKind::InvalidMethodParameter { name, value: most + 1.0, most }.without_time()
        }
    }
}

/// End (s) of one step of several.
fn end_of<R: Real>(from: R, until: R, (index, steps): (u32, u32)) -> R {
    let share = R::constant(f64::from(index)) / R::constant(f64::from(steps));
    if index == steps { until } else { from + (until - from) * share }
}

/// Time (s) at which an event is reached on the cubic of a step, and the scale of its function.
fn reached<R: Real, P, Z, const N: usize, const M: usize>(
    monitor: &mut Monitor<R>,
    ahead: &Ahead<R, P, N, M, Z>,
    event: &mut impl FnMut(R, &[R; N], &[R; N]) -> R,
) -> Result<Option<(R, R)>, Failure>
where
    Z: Copy + AsRef<[R]> + AsMut<[R]>,
{
    let found = monitor.first(ahead.times(), |t| {
        let y = ahead.at(t);
        event(t, &y.q, &y.qd)
    });
    let found = found.map_err(event_failure)?;
    Ok(found.map(|reach| (reach.t, reach.scale)))
}

/// Time (s) after the end of a step at which its slope leads an event function to zero; 0 where it leads away.
fn further<R: Real, P, Z, const N: usize, const M: usize>(
    ahead: &Ahead<R, P, N, M, Z>,
    event: &mut impl FnMut(R, &[R; N], &[R; N]) -> R,
) -> R
where
    Z: Copy + AsRef<[R]> + AsMut<[R]>,
{
    let (start, end) = ahead.times();
    let width = (end - start) * R::constant(SLOPE_SHARE);
    let mut at = |t: R| {
        let y = ahead.at(t);
        event(t, &y.q, &y.qd)
    };
    let value = at(end);
    let distance = value * width / (at(end - width) - value);
    if R::constant(0.0) < distance && distance.is_finite() { distance } else { R::constant(0.0) }
}
