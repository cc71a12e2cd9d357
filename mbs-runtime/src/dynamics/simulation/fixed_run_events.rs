//! Events within steps of fixed size, and settings of their search.

use crate::dynamics::integrators::event::monitor::{Monitor, Stopped};
use crate::dynamics::integrators::event::{
    Direction, Function, MOST_BOUNDED_PARTS, MOST_RESOLVED, Scrutiny, Unanswered,
};
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::Counts;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::method::Method;
use crate::dynamics::model::metric::Metric;
use crate::dynamics::simulation::Simulation;
use crate::dynamics::simulation::fixed_run::{Ahead, AheadOf, end_of};
use crate::failure::{Failure, FailureKind};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::motion;

/// The failure of an event function that is NaN or infinite.
const UNDEFINED_EVENT: Failure = FailureKind::NonFinite { name: "event function", line: 0 }.without_time();

/// Steps that an event is located by: the cubic of a step misses it by little, that of a step up to there by next to nothing.
const MOST_TRIALS: u32 = 48;

/// Factor by which a trial goes further than the one before that did not reach the event either.
const GROWTH: f64 = 4.0;

/// Share of a step over which the slope of an event function is taken.
const SLOPE_SHARE: f64 = 1e-4;

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

    /// As [`step_to`](Self::step_to), but stops where `event` of time, coordinates and velocities first reaches zero, even if it
    /// turns back there. Returns `true` if it did. The step that ends there is shortened, so that the state is one of the method.
    /// The event is searched on the cubic through the ends of each step. A value of 0 at the start has been passed already, and
    /// the next call goes on after the event. An impact may take a function of velocities over zero: that does not count.
    /// A function that is zero there but for rounding of the places, and turns back, counts.
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
        self.decide_modes()?;
        let fresh = self.fresh(&mut Counts::default())?.instant;
        let mut monitor = self.monitor(direction, &fresh, &mut event)?;
        for index in 1..=steps {
            let end = end_of(from, until, (index, steps));
            let (length, most) = (end - self.now.t, self.most_parts());
            for part in 1..=most {
                self.require_parts(part)?;
                let before = if const { S::HAS_MODES } { self.value(&mut event) } else { R::constant(0.0) };
                self.decide_modes()?;
                if const { S::HAS_MODES } {
                    let after = self.value(&mut event);
                    monitor.jump(before, after, || self.rounding(&mut event));
                }
                let rest = end - self.now.t;
                let to_kink = part < most || S::HAS_MODES;
                let whole = match to_kink {
                    true => self.ahead_to_kink(self.part_of(length, rest))?,
                    false => self.ahead(rest, self.counts, false)?,
                };
                let before = monitor;
                let found = reached(&mut monitor, (&self.metric, &whole), &mut event)?;
                let (last, is_event) = match found {
                    Some((t, _)) => self.ahead_to_event((whole, to_kink), t, before, &mut event)?,
                    None => (whole, false),
                };
                self.check_ahead(&last)?;
                self.go(&last);
                let found = match found.filter(|_| is_event) {
                    Some((_, scale)) => Some(scale),
                    None => {
                        let mut at_end = if found.is_some() { before } else { monitor };
                        let reached = self.reached_by_impact(&mut at_end, &mut event);
                        monitor = if found.is_some() { monitor } else { at_end };
                        reached
                    }
                };
                if let Some(scale) = found {
                    self.stopped = Some(Stopped::new(self.now.t, self.value(&mut event), scale));
                    return Ok(true);
                }
                if end <= self.now.t {
                    break;
                }
            }
        }
        Ok(false)
    }

    /// Scale of an event function that an impact at the present instant turns back where it has reached zero but for rounding, so that it
    /// counts.
    fn reached_by_impact(
        &self,
        monitor: &mut Monitor<R>,
        event: &mut impl FnMut(R, &[R; N], &[R; N]) -> R,
    ) -> Option<R> {
        if const { !S::HAS_RIGID_CONTACTS } || self.method.steps_over_modes() {
            return None;
        }
        if !self.model().strikes(self.now.t, &self.now.y) {
            return None;
        }
        let scale = self.rounding(event);
        monitor.reaches(self.value(event), scale).then_some(scale)
    }

    /// Rounding of an event function at the present instant.
    fn rounding(&self, event: &mut impl FnMut(R, &[R; N], &[R; N]) -> R) -> R {
        self.metric.rounding_of(&self.now.y.q, |q| event(self.now.t, q, &self.now.y.qd))
    }

    /// An event function at the present instant.
    fn value(&self, event: &mut impl FnMut(R, &[R; N], &[R; N]) -> R) -> R {
        event(self.now.t, &self.now.y.q, &self.now.y.qd)
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
            if let Some((found, _)) = reached(&mut monitor.clone(), (&self.metric, &trial), event)? {
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

/// An event function of a run along the states of a step.
pub(super) struct WithinStep<'a, R, C, E, const N: usize, const M: usize> {
    pub(super) metric: &'a Metric<R, N, M>,
    /// State at a time (s).
    pub(super) course: C,
    /// The function of time, coordinates and velocities.
    pub(super) event: E,
}

impl<R, C, E, Z, const N: usize, const M: usize> Function<R> for WithinStep<'_, R, C, E, N, M>
where
    R: Real,
    C: FnMut(R) -> IntegratorState<R, N, Z>,
    E: FnMut(R, &[R; N], &[R; N]) -> R,
{
    fn value(&mut self, t: R) -> R {
        let y = (self.course)(t);
        (self.event)(t, &y.q, &y.qd)
    }

    fn rounding(&mut self, t: R) -> Option<R> {
        let y = (self.course)(t);
        Some(self.metric.rounding_of(&y.q, |q| (self.event)(t, q, &y.qd)))
    }
}

/// Time (s) at which an event is reached on the cubic of a step, and the scale of its function.
fn reached<R: Real, P, G, Z, const N: usize, const M: usize>(
    monitor: &mut Monitor<R>,
    (metric, ahead): (&Metric<R, N, M>, &Ahead<R, P, G, N, M, Z>),
    event: &mut impl FnMut(R, &[R; N], &[R; N]) -> R,
) -> Result<Option<(R, R)>, Failure>
where
    Z: Copy + AsRef<[R]> + AsMut<[R]>,
{
    let found = monitor.first(ahead.times(), &mut WithinStep { metric, course: |t| ahead.at(t), event });
    let found = found.map_err(event_failure)?;
    Ok(found.map(|reach| (reach.t, reach.scale)))
}

/// Time (s) after the end of a step at which its slope leads an event function to zero; 0 where it leads away.
fn further<R: Real, P, G, Z, const N: usize, const M: usize>(
    ahead: &Ahead<R, P, G, N, M, Z>,
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
