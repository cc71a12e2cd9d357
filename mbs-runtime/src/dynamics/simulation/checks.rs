//! Conditions that a start and a step must keep: rows, branches, working ranges.

use crate::dynamics::formulations::projection::project_position;
use crate::dynamics::integrators::event::enclosure::{
    Enclosures, Functions, GroupOver, Part, can_be_enclosed,
};
use crate::dynamics::integrators::event::group::{GROUP, Watched, first_beyond};
use crate::dynamics::integrators::event::{Scrutiny, Unanswered, far_side};
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::{Counts, Model, Solved};
use crate::failure::checks::{limit_failure, passed_failure};
use crate::failure::{Failure, FailureKind};
use crate::kinematics::position;
use crate::linear_algebra::vectors::Each;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::limit::{Limit, size};
use crate::scalar::interval::Interval;
use crate::scalar::number::Real;
use crate::tolerances::positions;

/// Halvings of a step: as many digits as an `f64` has.
const MOST_HALVINGS: u32 = 53;

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Kinetic and potential energy (J).
    pub(super) fn total_energy(&self, t: R, y: &IntegratorState<R, N, S::States>) -> R {
        let energy = self.mechanism.energy(self.parameters, &self.position(t, y), &y.qd);
        energy.kinetic + energy.potential
    }

    /// Fails where a working range is left or a declared branch does not hold; `from`: the time (s) that inputs and phases are known at;
    /// `assembling`: those that pick the assembly alone count too.
    pub(in crate::dynamics) fn check_assembly(
        &self,
        from: R,
        (t, y): (R, &IntegratorState<R, N, S::States>),
        assembling: bool,
    ) -> Result<(), Failure> {
        if const { S::BRANCHES.is_empty() && S::LIMITS.is_empty() } {
            return Ok(());
        }
        let failure = self.moved(from, t, |Model { mechanism, parameters, .. }| {
            let position = mechanism.position(parameters, &y.q, t);
            position::branch_failure(*mechanism, parameters, &position, t, assembling).or_else(|| {
                limit_failure(*mechanism, parameters, &position, (t, &y.q), &self.metric.coordinates)
            })
        });
        failure.map_or(Ok(()), Err)
    }

    /// Fails where a declared branch does not hold, those apart that pick the assembly alone; `from`: the time (s) that inputs and
    /// phases are known at.
    pub(super) fn check_branches(
        &self,
        from: R,
        (t, y): (R, &IntegratorState<R, N, S::States>),
    ) -> Result<(), Failure> {
        if const { S::BRANCHES.is_empty() } {
            return Ok(());
        }
        self.moved(from, t, |Model { mechanism, parameters, .. }| {
            let position = mechanism.position(parameters, &y.q, t);
            // By reference: else the room of a failure is copied where there is none.
            match &position::branch_failure(*mechanism, parameters, &position, t, false) {
                Some(failure) => Err(*failure),
                None => Ok(()),
            }
        })
    }

    /// Fails with the first working range that is left along a step between `start` and `end` (s), with the time at which it is; `at`
    /// gives the states of the step, with the resolution (s) of the search and the `errors` (N) that the states may have.
    ///
    /// A range that is left by no more than these errors, or by states of which those on the rows leave none, is touched.
    pub(super) fn check_ranges(
        &self,
        from: R,
        (start, end): (R, R),
        at: impl Fn(R) -> IntegratorState<R, N, S::States>,
        (resolution, errors): (Option<R>, &[R; N]),
    ) -> Result<(), Failure> {
        if const { S::LIMITS.is_empty() } {
            return Ok(());
        }
        let size = [start, end].each(|t| size(&self.metric.coordinates, &at(t).q));
        let size = size.into_iter().fold(R::constant(0.0), R::max);
        let mut ranges = Ranges { model: self, from, resolution, size, errors: None, at };
        let mut touched = start;
        for _ in 0..MOST_TOUCHES {
            match first_beyond(&mut ranges, (touched, end)) {
                Ok(None) => return Ok(()),
                Ok(Some((member, t))) => match ranges.next_inside((member, t), end, errors)? {
                    Some(inside) => touched = inside,
                    None => break,
                },
                Err((member, Unanswered::Undefined(t) | Unanswered::OutOfParts(t))) => {
                    return Err(ranges.failure(member, t));
                }
            }
        }
        ranges.passed((start, end), errors)
    }

    /// [`check_branches`](Self::check_branches) at the end of a step from `start` (s), with the time at which the state passes a
    /// branch; `at` gives the states of the step. A branch is tested at the end of the step.
    pub(super) fn check_end(
        &self,
        from: R,
        (start, end): (R, R),
        at: impl Fn(R) -> IntegratorState<R, N, S::States>,
    ) -> Result<(), Failure> {
        let check = |t: R| self.check_branches(from, (t, &at(t)));
        check(end).map_err(|failure| first_failure(start, (end, failure), check))
    }

    /// Rates and multipliers `solved` at a state from which a run goes on, unless a row that no coordinate changes does not hold them.
    pub(super) fn require_held(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        solved: Result<Solved<R, N, M, S::States>, Failure>,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        self.require_no_flat_row(t, y, solved.as_ref().ok().map(|solved| &solved.rate.qd))?;
        solved
    }

    /// Fails with the row that a start violates by more than it may.
    pub(super) fn require_consistent(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
    ) -> Result<(), Failure> {
        self.require_closed(t, y)?;
        let position = self.position(t, y);
        let one = R::constant(1.0);
        let allowance = positions::OF_START.of::<R>();
        let phi_q = self.mechanism.phi_q(self.parameters, &position);
        let mut allowed = self.mechanism.phi_t(self.parameters, &position);
        for ((allowed, row), scale) in allowed.iter_mut().zip(&phi_q).zip(&self.metric.rows) {
            let reach = row.iter().zip(&y.qd).fold(*scale, |sum, (entry, qd)| sum + (*entry * *qd).abs());
            *allowed = allowance * (reach + allowed.abs());
        }
        self.require(t, &self.constraint_rates(&position, &y.qd), &allowed, one, true)
    }

    /// Fails with the row that the position of a start violates by more than it may.
    pub(super) fn require_closed(&self, t: R, y: &IntegratorState<R, N, S::States>) -> Result<(), Failure> {
        let position = self.position(t, y);
        let allowance = positions::OF_START.of::<R>();
        let phi = self.mechanism.phi(self.parameters, &position);
        let phi_q = self.mechanism.phi_q(self.parameters, &position);
        let mut allowed = self.metric.rows;
        for (allowed, row) in allowed.iter_mut().zip(&phi_q) {
            let reach = row.iter().zip(&y.q).fold(*allowed, |sum, (entry, q)| sum + (*entry * *q).abs());
            *allowed = allowance * reach;
        }
        self.require(t, &phi, &allowed, R::constant(1.0), false)
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

/// Distances to the bounds of each working range along a step: lower and upper, one after the other.
struct Ranges<'a, S: Dynamic<R, N, M>, R: Real, At, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    /// Time (s) that inputs and phases are known at.
    from: R,
    resolution: Option<R>,
    /// That of the coordinates.
    size: R,
    /// Errors (N) of the states by which the ranges are wider.
    errors: Option<&'a [R; N]>,
    at: At,
}

/// Touches of limits within a step behind each of which is looked on as closely as in front of it.
const MOST_TOUCHES: u32 = 16;

/// Part of the rest of a step at which it is looked first behind a touch: 2⁻⁵³.
const LEAST_PART: f64 = f64::EPSILON / 2.0;

/// Instants on the way to a limit at which it is looked for the last one that keeps it.
const INSTANTS: u32 = 64;

impl<S, R, At, const N: usize, const M: usize> Ranges<'_, S, R, At, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
    At: Fn(R) -> IntegratorState<R, N, S::States>,
{
    fn limits(&self, t: R) -> S::Limits {
        self.limits_at(t, &(self.at)(t).q)
    }

    /// The limits at coordinates `q` (N).
    fn limits_at(&self, t: R, q: &[R; N]) -> S::Limits {
        self.model.moved(self.from, t, |Model { mechanism, parameters, .. }| {
            mechanism.limits(parameters, &mechanism.position(parameters, q, t))
        })
    }

    /// The states of the step on the rows.
    fn closed(&self, t: R) -> IntegratorState<R, N, S::States> {
        let state = (self.at)(t);
        let closed = self.model.moved(self.from, t, |model| {
            let mut y = state;
            project_position(model, t, &mut y, &mut Counts::default()).map(|_| y)
        });
        closed.unwrap_or(state)
    }

    /// Distance to the bound of `member` at `t` (s).
    fn left(&mut self, member: usize, t: R) -> R {
        let mut values = [R::constant(0.0); GROUP];
        self.values(t, member - member % GROUP, &mut values);
        values.get(member % GROUP).copied().unwrap_or(R::constant(f64::NAN))
    }

    /// The next instant before `end` (s) at which the range of `member` is kept again that is reached at `t` (s); `None` where it is
    /// not. Fails if states on the rows leave it behind `t` by more than their `errors` (N), however short that is: the instants are
    /// twice as far from `t` as the one before.
    #[cold]
    #[inline(never)]
    fn next_inside(&self, (member, t): (usize, R), end: R, errors: &[R; N]) -> Result<Option<R>, Failure> {
        let zero = R::constant(0.0);
        let Ranges { model, from, resolution, size, .. } = *self;
        let at = |t: R| self.closed(t);
        let mut wider = Ranges { model, from, resolution, size, errors: Some(errors), at };
        let mut exact = Ranges { model, from, resolution, size, errors: None, at: |t: R| (self.at)(t) };
        let mut ahead = R::constant(LEAST_PART) * (end - t);
        while zero < ahead && ahead <= end - t {
            let after = t + ahead;
            if wider.left(member, after) < zero {
                return Err(self.failure(member, t));
            }
            if t.less(after) && zero < exact.left(member, after) {
                return Ok(Some(after));
            }
            ahead = ahead + ahead;
        }
        Ok(None)
    }

    /// Fails with the range that is left within a step by states on the rows, and by more than their `errors` (N), with the time at
    /// which it is left.
    #[cold]
    #[inline(never)]
    fn passed(&self, (start, end): (R, R), errors: &[R; N]) -> Result<(), Failure> {
        let at = |t: R| self.closed(t);
        let Ranges { model, from, resolution, size, .. } = *self;
        let mut wider = Ranges { model, from, resolution, size, errors: Some(errors), at };
        let (member, beyond) = match first_beyond(&mut wider, (start, end)) {
            Ok(None) => return Ok(()),
            Ok(Some(found)) => found,
            Err((member, Unanswered::Undefined(t) | Unanswered::OutOfParts(t))) => {
                return Err(wider.failure(member, t));
            }
        };
        let (exact, zero) = (Ranges { errors: None, ..wider }, R::constant(0.0));
        let left = |t: R| {
            let limits = exact.limits(t);
            let limit = limits.as_ref().get(member / 2).map(|limit| limit.left(size));
            limit.map_or(zero, |[low, high]| if member.is_multiple_of(2) { low } else { high })
        };
        let (mut before, mut after) = (start, beyond);
        for instant in (0..INSTANTS).rev() {
            let t = start + (beyond - start) * R::constant(f64::from(instant) / f64::from(INSTANTS));
            before = t;
            if zero <= left(t) {
                break;
            }
            after = t;
        }
        let bracket = [before, after].map(|t| (t, left(t)));
        let [(_, kept), _] = bracket;
        // A step may begin beyond its bound by the error of those before.
        let t = if kept < zero { Ok(start) } else { far_side(bracket, |t| Ok(left(t))) };
        Err(t.map_or_else(|failure| failure, |t| exact.failure(member, t)))
    }

    /// The failure of a range that is left at `t` (s).
    fn failure(&self, member: usize, t: R) -> Failure {
        let limits = self.limits(t);
        match limits.as_ref().get(member / 2) {
            Some(limit) => {
                let bound = if member.is_multiple_of(2) { limit.low } else { limit.high };
                passed_failure(S::LIMITS, member / 2, (limit, bound), t)
            }
            None => FailureKind::NonFinite { name: "limit", line: 0 }.without_time(),
        }
    }
}

impl<S, R, At, const N: usize, const M: usize> Watched<R> for Ranges<'_, S, R, At, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
    At: Fn(R) -> IntegratorState<R, N, S::States>,
{
    fn count(&self) -> usize {
        2 * S::LIMITS.len()
    }

    fn positive(&self, _: usize) -> bool {
        true
    }

    fn scrutiny(&mut self, _: usize, _: R) -> Scrutiny<R> {
        Scrutiny { resolution: self.resolution, ..Scrutiny::beyond() }
    }

    fn enclosures(&mut self, first: usize, times: (R, R)) -> Option<Enclosures<R>> {
        if self.errors.is_some() || !can_be_enclosed(self.model.mechanism) {
            return None;
        }
        let part = Part::of(self.from, times, &self.at)?;
        self.model.mechanism.enclosed(GroupOver { part, first, functions: Left { size: self.size } })
    }

    fn values(&mut self, t: R, first: usize, values: &mut [R; GROUP]) {
        let limits = self.limits(t);
        let left = limits.as_ref().iter().skip(first / 2).map(|limit| limit.left(self.size));
        for (pair, left) in values.as_chunks_mut::<2>().0.iter_mut().zip(left) {
            pair.iter_mut().zip(left).for_each(|(value, left)| *value = left);
        }
        let Some(errors) = self.errors else { return };
        let q = (self.at)(t).q;
        for (index, error) in errors.iter().enumerate().filter(|(_, error)| R::constant(0.0) < **error) {
            let mut aside = q;
            aside.iter_mut().skip(index).take(1).for_each(|q| *q = *q + *error);
            let moved = self.limits_at(t, &aside);
            let changes = limits.as_ref().iter().zip(moved.as_ref()).skip(first / 2).map(|(limit, moved)| {
                let value = moved.value - limit.value;
                [value - (moved.low - limit.low), value - (moved.high - limit.high)]
            });
            for (pair, changes) in values.as_chunks_mut::<2>().0.iter_mut().zip(changes) {
                pair.iter_mut().zip(changes).for_each(|(value, change)| *value = *value + change.abs());
            }
        }
    }
}

/// Distances to the limits of all working ranges, below and above.
struct Left<R> {
    /// That of the coordinates.
    size: R,
}

impl<R: Real> Functions<R> for Left<R> {
    fn show<S: Dynamic<Interval<R>, N, M>, const N: usize, const M: usize>(
        &self,
        mechanism: &S,
        parameters: &S::Parameters,
        position: &S::Position,
        qd: &[Interval<R>; N],
        mut see: impl FnMut(Interval<R>, Interval<R>),
    ) {
        let limits = mechanism.limits(parameters, position);
        let mut left = limits.as_ref().iter().flat_map(|limit| limit.left(Interval::of(self.size)));
        mechanism.limit_rates(parameters, position, qd, |Limit { low, value, high }| {
            for rate in [value - low, high - value] {
                left.next().into_iter().for_each(|left| see(left, rate));
            }
        });
    }
}
