//! All solutions of several norms that do not contract: nᵢ = |cᵢ + Σ bᵢⱼ nⱼ|, isolated by division of a simplex.
//!
//! With a scale s > 0 the equations are homogeneous in x = (s, n): the simplex x ≥ 0, Σ x = 1 holds all solutions, however large. On a
//! part of it Gᵢ = nᵢ − |wᵢ(x)| is concave: its corners bound it below, those of a tangent above. A part is done where some Gᵢ has no
//! zero in it, or where the one solution that a box around it can have is found. Others are halved.
//! Source: Moore, Kearfott & Cloud 2009, Introduction to Interval Analysis, §§5.2, 8.1, 11.1; Rivara 1984 for the halved edge.

#[cfg(test)]
mod tests;

use core::iter::once;

use crate::dynamics::linear_systems::piecewise::reduced::{Reduced, is_m_matrix};
use crate::dynamics::linear_systems::piecewise::{Given, Piecewise};
use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::lu::Lu;
use crate::linear_algebra::parts::{at, identity, transposed};
use crate::linear_algebra::vectors::{Each, dot};
use crate::mechanism::normal_forces::Term;
use crate::scalar::number::Real;
use crate::tolerances::forces;

/// Parts that wait: three norms are divided at most 78 times until their edges are [`forces::SHORTEST_EDGE`].
const MOST_WAITING: usize = 80;

/// Solutions of three equations of second degree.
const MOST_KNOWN: usize = 8;

/// The corners of a part.
type Simplex<R, const V: usize> = [[R; V]; V];

/// Norms in x: the first of V is no norm.
struct Norms<R, const V: usize, const K: usize> {
    /// wᵢ: two components, of each its slopes by x.
    sums: [[[R; V]; 2]; V],
    /// Slopes by x of sums that are at least 0, then zeros.
    signs: [[R; V]; K],
}

/// Number of solutions in a part, as far as it is known.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Verdict {
    None,
    /// In the box around it.
    AtMostOne,
    Unknown,
}

impl<R: Real, const K: usize> Piecewise<R, K> {
    /// Shows the solutions of a part with V − 1 norms open. `parts` counts down the parts of the simplex that are searched.
    /// Returns `true` if there are no others.
    #[cold]
    #[inline(never)]
    pub(super) fn isolate<const V: usize>(
        &self,
        given: Given,
        reduced: &Reduced<R, K>,
        parts: &mut u32,
        mut show: impl FnMut([R; K]),
    ) -> bool {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let open = || reduced.open.iter().enumerate().filter(|(_, open)| **open).map(|(term, _)| term);
        let offsets = || open().filter_map(|term| reduced.offset.get(term)).flatten();
        let size = offsets().fold(zero, |size, offset| size.max(offset.abs()));
        let scale = if zero < size { one / size } else { one };
        let directions = self.directions(given, &[zero; K]);
        let norms = Norms::<R, V, K>::new(&self.terms, reduced, scale, &directions);
        let place = |term: usize| open().position(|open| open == term);
        let solve = |x: &[R; V]| {
            let factor = one / (scale * at(x, 0));
            let held = |term: usize| Some(factor * *x.get(1 + place(term)?)?);
            let start = self.linear(&directions, held)?;
            let v = self.newton(given, &start).or_else(|| self.met(given, &start))?;
            let mut found = [zero; V];
            let values = once(one / scale).chain(open().filter_map(|term| v.get(term).copied()));
            found.iter_mut().zip(values).for_each(|(x, v)| *x = v);
            let sum = found.iter().fold(zero, |sum, x| sum + *x);
            Some((found.each(|x| x / sum), v))
        };
        let mut whole = identity();
        let mut show = |v: [R; K]| {
            if self.keeps(given, &v) {
                show(v);
            }
        };
        if size == zero {
            // Without c no norm is a solution, and any other would be one in every size: of s = 0 too.
            if let [first, second, ..] = whole.as_mut_slice() {
                *first = *second;
            }
            let nothing = self.linear(&directions, |term| place(term).map(|_| zero));
            return norms.isolate(whole, parts, |_| None, &mut show) && nothing.map(show).is_some();
        }
        norms.isolate(whole, parts, solve, show)
    }

    /// Newton's method until the equations are met but for rounding, where directions change by more than that.
    fn met(&self, given: Given, start: &[R; K]) -> Option<[R; K]> {
        let mut v = *start;
        for _ in 0..crate::dynamics::linear_systems::piecewise::MOST_STEPS {
            v = self.linear(&self.directions(given, &v), |_| None)?;
            if self.is_met(given, &v) {
                return Some(v);
            }
        }
        None
    }
}

impl<R: Real, const V: usize, const K: usize> Norms<R, V, K> {
    /// The open terms of a part, in s = `scale` times the scale of x; `directions` hold the signs that are given.
    fn new(terms: &[Term; K], reduced: &Reduced<R, K>, scale: R, directions: &[[R; 2]; K]) -> Self {
        let zero = R::constant(0.0);
        let slopes = |term: usize, component: usize| {
            let mut slopes = [zero; V];
            let offset = reduced.offset.get(term).and_then(|offsets| offsets.get(component));
            let by_scale = scale * offset.copied().unwrap_or(zero);
            let all = reduced.slope.get(term).and_then(|slopes| slopes.get(component));
            let open = all.into_iter().flatten().zip(&reduced.open).filter(|(_, open)| **open);
            let all = once(by_scale).chain(open.map(|(own, _)| *own));
            slopes.iter_mut().zip(all).for_each(|(slope, own)| *slope = own);
            slopes
        };
        let mut norms = Norms { sums: [[[zero; V]; 2]; V], signs: [[zero; V]; K] };
        let open = reduced.open.iter().enumerate().filter(|(_, open)| **open);
        for (sums, (term, _)) in norms.sums.iter_mut().skip(1).zip(open) {
            *sums = [slopes(term, 0), slopes(term, 1)];
        }
        for (term, (signs, [sign, _])) in norms.signs.iter_mut().zip(directions).enumerate() {
            if terms.get(term) == Some(&Term::Absolute) && reduced.open.get(term) == Some(&false) {
                *signs = slopes(term, 0).each(|slope| *sign * slope);
            }
        }
        norms
    }

    /// Shows each solution in a part once, with the result of `solve` for an x next to it: the solution in x, and in other terms.
    /// Returns `true` if there are no others.
    fn isolate<X>(
        &self,
        mut part: Simplex<R, V>,
        parts: &mut u32,
        solve: impl Fn(&[R; V]) -> Option<([R; V], X)>,
        mut show: impl FnMut(X),
    ) -> bool {
        let zero = R::constant(0.0);
        let mut known: [Option<[R; V]>; MOST_KNOWN] = [None; MOST_KNOWN];
        let (mut waiting, mut count) = ([[[zero; V]; V]; MOST_WAITING], 0_usize);
        while let Some(left) = parts.checked_sub(1) {
            *parts = left;
            let done = match self.verdict(&part) {
                Verdict::None => true,
                Verdict::Unknown => false,
                Verdict::AtMostOne if known.iter().flatten().any(|x| is_inside(&part, x)) => true,
                Verdict::AtMostOne => match solve(&centre(&part)).filter(|(x, _)| is_inside(&part, x)) {
                    None => false,
                    Some((x, shown)) => match known.iter_mut().find(|slot| slot.is_none()) {
                        None => return false,
                        Some(slot) => {
                            *slot = Some(x);
                            show(shown);
                            true
                        }
                    },
                },
            };
            if done {
                let Some(last) = count.checked_sub(1) else { return true };
                count = last;
                waiting.iter().skip(count).take(1).for_each(|next| part = *next);
            } else {
                let (Some(halves), Some(slot)) = (halved(&part), waiting.get_mut(count)) else {
                    return false;
                };
                (part, *slot) = halves;
                count += 1;
            }
        }
        false
    }

    /// wᵢ at x.
    fn sum(&self, norm: usize, x: &[R; V]) -> [R; 2] {
        let zero = R::constant(0.0);
        self.sums.get(norm).map_or([zero; 2], |sums| sums.map(|slopes| dot(&slopes, x)))
    }

    /// Bounds of the rounding of Gᵢ, one a norm.
    fn roundings(&self, part: &Simplex<R, V>) -> [R; V] {
        let zero = R::constant(0.0);
        let mut roundings = [zero; V];
        for (norm, (rounding, sums)) in roundings.iter_mut().zip(&self.sums).enumerate() {
            for x in part {
                let own = x.get(norm).copied().unwrap_or(zero);
                let terms = sums.iter().flat_map(|slopes| slopes.iter().zip(x));
                *rounding = rounding.max(terms.fold(own, |sum, (slope, x)| sum + (*slope * *x).abs()));
            }
            *rounding = *rounding * (forces::OF_PIECEWISE.of::<R>() * R::constant(V as f64));
        }
        roundings
    }

    fn verdict(&self, part: &Simplex<R, V>) -> Verdict {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let centre = centre(part);
        let breaks = |slopes: &[R; V]| {
            let size = |x: &[R; V]| slopes.iter().zip(x).fold(zero, |sum, (a, b)| sum + (*a * *b).abs());
            let rounding = forces::OF_PIECEWISE.of::<R>() * R::constant(V as f64);
            part.iter().all(|x| dot(slopes, x) < -(rounding * size(x)))
        };
        if self.signs.iter().any(breaks) {
            return Verdict::None;
        }
        let roundings = self.roundings(part);
        // Rows of ∂G/∂μ at the centre, their largest change in the box, and G there.
        let (mut slope, mut change, mut value) = ([[zero; V]; V], [[zero; V]; V], [zero; V]);
        slope.iter_mut().flatten().take(1).for_each(|entry| *entry = one);
        let rows = slope.iter_mut().zip(&mut change).zip(value.iter_mut().zip(&roundings)).enumerate();
        for (i, ((slope, change), (value, rounding))) in rows.skip(1) {
            let (middle, rounding) = (self.sum(i, &centre), *rounding);
            let length = middle[0].hypot(middle[1]);
            let corners = part.map(|x| self.sum(i, &x));
            let (Some([first_x, first_y]), Some(first)) = (corners.first(), part.first()) else {
                return Verdict::Unknown;
            };
            let mut radius = zero;
            for [x, y] in corners.iter().skip(1) {
                radius = radius + (*x - *first_x).hypot(*y - *first_y);
            }
            // Elsewhere the direction of the norm may be any.
            let directed = radius < length;
            let u = if zero < length { middle.each(|w| w / length) } else { [zero; 2] };
            let (mut above, mut below) = (true, true);
            for (x, [wx, wy]) in part.iter().zip(&corners) {
                above &= rounding < at(x, i) - wx.hypot(*wy);
                below &= at(x, i) - (u[0] * *wx + u[1] * *wy) < -rounding;
            }
            if above || below {
                return Verdict::None;
            }
            let share = if directed { radius / length } else { one };
            let u = if directed { u } else { [zero; 2] };
            // The chord of the angle of that sine.
            let half = R::constant(0.5) * (one + (one - share * share).max(zero).sqrt());
            let turned = if directed { share / half.sqrt() } else { one };
            *value = at(&centre, i) - length;
            let columns = slope.iter_mut().zip(change).zip(part.iter().zip(&corners));
            for ((slope, change), (corner, [x, y])) in columns.skip(1) {
                let [x, y] = [*x - *first_x, *y - *first_y];
                *slope = at(corner, i) - at(first, i) - (u[0] * x + u[1] * y);
                *change = turned * x.hypot(y) + rounding + rounding;
            }
        }
        judged(&slope, &change, &value, &roundings)
    }
}

/// The verdict on G with the slopes and the value (± `roundings`) at the centre of a part, where its slopes differ from those by `change`.
fn judged<R: Real, const V: usize>(
    slope: &Simplex<R, V>,
    change: &Simplex<R, V>,
    value: &[R; V],
    roundings: &[R; V],
) -> Verdict {
    let (zero, one) = (R::constant(0.0), R::constant(1.0));
    let (factors, margin) = Lu::factorize(slope, &[one; V], &[one; V]);
    if !zero.less(margin) {
        return Verdict::Unknown;
    }
    // |J⁻¹| times the changes, and times the roundings.
    let (mut spread, mut rounding) = ([[zero; V]; V], [zero; V]);
    let units = identity::<R, V>();
    for (unit, (change, own)) in units.iter().zip(change.iter().zip(roundings)).skip(1) {
        let column = factors.solve(unit);
        let rows = column.iter().zip(rounding.iter_mut().zip(&mut spread));
        for (entry, (rounding, spread)) in rows.skip(1) {
            let size = entry.abs();
            *rounding = *rounding + size * *own;
            for (spread, change) in spread.iter_mut().zip(change).skip(1) {
                *spread = *spread + size * *change;
            }
        }
    }
    // Every solution in the part is as near to the step of Newton's method, in shares of the corners.
    let reach = R::constant((V as f64 - 1.0) / V as f64);
    let step = factors.solve(value);
    let (mut first, mut room) = (one, zero);
    let mut outside = false;
    for (step, (rounding, spread)) in step.iter().zip(rounding.iter().zip(&spread)).skip(1) {
        let share = R::constant(1.0 / V as f64) - *step;
        let near = *rounding + reach * spread.iter().fold(zero, |sum, spread| sum + *spread);
        outside |= share < -near;
        (first, room) = (first - share, room + near);
    }
    if outside || first < -room {
        return Verdict::None;
    }
    if is_m_matrix(&spread) { Verdict::AtMostOne } else { Verdict::Unknown }
}

/// The mean of the corners.
fn centre<R: Real, const V: usize>(part: &Simplex<R, V>) -> [R; V] {
    let mut centre = [R::constant(0.0); V];
    for (component, mean) in centre.iter_mut().enumerate() {
        let corners = part.iter().filter_map(|x| x.get(component));
        *mean = corners.fold(*mean, |sum, x| sum + *x) * R::constant(1.0 / V as f64);
    }
    centre
}

/// `true` if x is in the box around a part: its shares of all corners but the first differ from those of the centre by at most 1.
fn is_inside<R: Real, const V: usize>(part: &Simplex<R, V>, x: &[R; V]) -> bool {
    let (zero, one) = (R::constant(0.0), R::constant(1.0));
    let (factors, margin) = Lu::factorize(&transposed(part), &[one; V], &[one; V]);
    let shares = factors.solve(x);
    let middle = R::constant(1.0 / V as f64);
    zero < margin && shares.iter().skip(1).all(|share| (*share - middle).abs() <= one)
}

/// Both halves of a part, divided at its longest edge; none where that is short.
fn halved<R: Real, const V: usize>(part: &Simplex<R, V>) -> Option<(Simplex<R, V>, Simplex<R, V>)> {
    let (mut longest, mut ends) = (forces::SHORTEST_EDGE.of::<R>() * forces::SHORTEST_EDGE.of::<R>(), None);
    for (a, from) in part.iter().enumerate() {
        for (b, to) in part.iter().enumerate().skip(a + 1) {
            let edge = from.iter().zip(to).map(|(a, b)| (*a - *b) * (*a - *b));
            let length = edge.fold(R::constant(0.0), |sum, square| sum + square);
            if longest < length {
                (longest, ends) = (length, Some((a, b)));
            }
        }
    }
    let (a, b) = ends?;
    let (mut middle, other) = (*part.get(a)?, part.get(b)?);
    middle.iter_mut().zip(other).for_each(|(a, b)| *a = (*a + *b) * R::constant(0.5));
    let (mut first, mut second) = (*part, *part);
    *first.get_mut(a)? = middle;
    *second.get_mut(b)? = middle;
    Some((first, second))
}
