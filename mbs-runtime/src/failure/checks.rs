//! Checks of values, limits and times, with the failure that names the first one that does not hold.

use crate::failure::{Failure, FailureKind};
use crate::mechanism::limit::{Limit, size};
use crate::mechanism::{Entry, Mechanism};
use crate::scalar::number::{Real, Scalar};
use crate::tolerances::positions;

/// The first limit that is passed, if any.
#[inline(always)]
pub(crate) fn limit_failure<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    position: &S::Position,
    (t, q): (R, &[R; N]),
    scales: &[R; N],
) -> Option<Failure> {
    if const { S::LIMITS.is_empty() } {
        return None;
    }
    let limits = mechanism.limits(parameters, position);
    let passed = |(index, limit): (usize, &Limit<R>)| {
        limit.passed(|| size(scales, q)).map(|bound| (index, *limit, bound))
    };
    let (index, limit, bound) = limits.as_ref().iter().enumerate().find_map(passed)?;
    Some(passed_failure(S::LIMITS, index, (&limit, bound), t))
}

/// The failure of the limit at `index` whose bound is passed.
pub(crate) fn passed_failure<R: Real>(
    limits: &'static [Entry],
    index: usize,
    (Limit { value, .. }, bound): (&Limit<R>, R),
    t: R,
) -> Failure {
    let limit = entry(limits, u16::try_from(index).unwrap_or(u16::MAX));
    match value.is_finite() {
        true => {
            FailureKind::BeyondLimit { limit, value: value.to_f64(), bound: bound.to_f64() }.at(t.to_f64())
        }
        false => FailureKind::NonFinite { name: limit.name, line: limit.line }.without_time(),
    }
}

/// The parameter or input that is not finite, or the width of a redundant row that is below 0, if any.
#[inline]
pub(crate) fn variable_failure<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
) -> Option<Failure> {
    if are_valid(mechanism) { None } else { broken_variable(mechanism) }
}

/// `true` if all parameters and inputs are finite, and no width of a redundant row below 0, lane by lane.
#[inline(always)]
pub(crate) fn are_valid<S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize>(
    mechanism: &S,
) -> T::Mask {
    let finite = |index| mechanism.get(index).map_or(T::mask(true), |value| value.is_finite());
    let all = (0..S::VARIABLES.len()).fold(T::mask(true), |all, index| all & finite(index));
    if !S::REDUNDANT.contains(&true) {
        return all;
    }
    let widths = mechanism.widths(&mechanism.parameters());
    widths.iter().fold(all, |all, width| all & !width.less(T::constant(0.0)))
}

/// Stands for the parameter of a width that is below 0: no parameter has such a name.
pub(crate) const WIDTH: &str = "redundant within";

#[cold]
#[inline(never)]
pub(crate) fn broken_variable<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
) -> Option<Failure> {
    let broken = |index: &usize| mechanism.get(*index).is_some_and(|value| !value.is_finite());
    if let Some(variable) = (0..S::VARIABLES.len()).find(broken).and_then(|index| S::VARIABLES.get(index)) {
        return Some(FailureKind::NonFinite { name: variable.name, line: variable.line }.without_time());
    }
    let widths = mechanism.widths(&mechanism.parameters());
    let (row, width) = S::ROWS.iter().zip(&widths).find(|(_, width)| **width < R::constant(0.0))?;
    Some(
        FailureKind::Negative { name: row.name, line: row.line, parameter: WIDTH, value: width.to_f64() }
            .without_time(),
    )
}

/// The time as a failure where it is not finite.
#[inline(always)]
pub(crate) fn time_failure<R: Real>(t: R) -> Option<Failure> {
    (!t.is_finite()).then_some(FailureKind::NonFinite { name: "t", line: 0 }.without_time())
}

/// The first value that is not finite, under the name that `entries` gives it.
#[inline]
pub(crate) fn non_finite<R: Real, const K: usize>(values: &[R; K], entries: &[Entry]) -> Option<Failure> {
    non_finite_among(values, entries)
}

/// The first coordinate that is not finite, or too large to be resolved.
#[inline(always)]
pub(crate) fn coordinate_failure<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    q: &[R; N],
    scales: &[R; N],
    t: R,
) -> Option<Failure> {
    if are_resolved(q, scales) {
        return None;
    }
    unresolved::<S, R, N, M>(q, q.iter().zip(scales).position(|pair| !is_resolved(pair)), t)
}

/// `true` if all coordinates are finite, and none is too large to be resolved.
#[inline(always)]
pub(crate) fn are_resolved<R: Real, const N: usize>(q: &[R; N], scales: &[R; N]) -> bool {
    q.iter().zip(scales).fold(true, |all, pair| all & is_resolved(pair))
}

/// Written so that NaN is not resolved.
#[inline(always)]
fn is_resolved<R: Real>((coordinate, scale): (&R, &R)) -> bool {
    R::EPSILON * coordinate.abs() <= positions::COARSEST_RESOLUTION.of::<R>() * *scale
}

/// The first coordinate that is not finite, or the one at `index`, which is too large.
#[cold]
#[inline(never)]
fn unresolved<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    q: &[R; N],
    index: Option<usize>,
    t: R,
) -> Option<Failure> {
    non_finite(q, S::COORDINATES).or_else(|| {
        let coordinate = entry(S::COORDINATES, u16::try_from(index?).unwrap_or(u16::MAX));
        Some(FailureKind::Unresolved { coordinate, value: q.get(index?)?.to_f64() }.at(t.to_f64()))
    })
}

/// The first of `values` that is not finite, under the name that `entries` gives it.
pub(crate) fn non_finite_among<R: Real>(values: &[R], entries: &[Entry]) -> Option<Failure> {
    let index = values.iter().position(|value| !value.is_finite())?;
    let named = entries
        .get(index)
        .map(|entry| FailureKind::NonFinite { name: entry.name, line: entry.line }.without_time());
    Some(named.unwrap_or(UNNAMED))
}

#[inline(always)]
pub(crate) fn all_finite<R: Real, const N: usize>(values: &[R; N]) -> bool {
    values.iter().fold(true, |all, value| all & value.is_finite())
}

/// Only a hand-written mechanism with too short tables can bring it out.
pub(crate) const UNNAMED: Failure = FailureKind::NonFinite { name: "?", line: 0 }.without_time();

/// The entry at `index`, by reference: a failure that holds two of them stays small.
pub(crate) fn entry(entries: &'static [Entry], index: u16) -> &'static Entry {
    entries.get(usize::from(index)).unwrap_or(&Entry { name: "?", unit: "", line: 0 })
}
