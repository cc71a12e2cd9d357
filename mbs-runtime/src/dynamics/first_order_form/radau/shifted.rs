//! s − J with a real or complex s, J the slopes of the equations of motion: factorised for the coordinates alone.

use crate::dynamics::first_order_form::equations::Moving;
use crate::dynamics::first_order_form::radau::slopes::Slopes;
use crate::dynamics::first_order_form::radau::split::{Number, Numbers, SplitLu, entry, product, reciprocal};
use crate::dynamics::integrators::vector::Vector;
use crate::linear_algebra::vectors::{Each, of_each};
use crate::mechanism::dynamic::{Dynamic, StateSlope};
use crate::scalar::number::Real;

/// Factors of s − J: of PARTS = 1 for a real s, of PARTS = 2 for a complex one.
///
/// With δq̇ = s δq − r_q, and δz from (s − ż_z) δz = r_z + ż_q δq + ż_q̇ δq̇, N equations are left:
/// (s² − s ∂q̈/∂q̇ − ∂q̈/∂q − ∂q̈/∂z (s − ż_z)⁻¹ (ż_q + s ż_q̇)) δq = …
#[derive(Clone, Copy, Debug)]
pub(in crate::dynamics) struct Shifted<
    S: Dynamic<R, N, M>,
    R: Real,
    const N: usize,
    const M: usize,
    const PARTS: usize,
> {
    s: Number<R, PARTS>,
    /// In the scales of the coordinates.
    factors: SplitLu<R, N, PARTS>,
    scales: [R; N],
    /// Of each state, by its parts: its row of (s − ż_z)⁻¹, and in the place of ż_q that of (s − ż_z)⁻¹ (ż_q + s ż_q̇).
    states: Option<[S::StateSlopes; PARTS]>,
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize, const PARTS: usize>
    Shifted<S, R, N, M, PARTS>
{
    /// Those of `slopes`, in the scales (N) of the coordinates; none where s is an eigenvalue.
    #[inline(never)]
    pub(in crate::dynamics) fn of(
        slopes: &Slopes<S, R, N, M>,
        scales: &[R; N],
        s: Number<R, PARTS>,
    ) -> Option<Self> {
        let states = match &slopes.states {
            Some(states) if const { !S::STATES.is_empty() } => Some(eliminated(states, s)?),
            _ => None,
        };
        let square = product(s, s);
        let mut rows = [[[R::constant(0.0); N]; PARTS]; N];
        for (i, (row, row_scale)) in rows.iter_mut().zip(scales).enumerate() {
            for (part, ((row, s), square)) in row.iter_mut().zip(s).zip(square).enumerate() {
                let columns = slopes.q.iter().zip(&slopes.qd).zip(scales);
                for (j, (place, ((q, qd), scale))) in row.iter_mut().zip(columns).enumerate() {
                    let of = |column: &[R; N]| column.get(i).copied().unwrap_or(R::constant(0.0));
                    let real = if part == 0 { of(q) } else { R::constant(0.0) };
                    let diagonal = if i == j { square } else { R::constant(0.0) };
                    *place = (diagonal - s * of(qd) - real) * (*scale / *row_scale);
                }
            }
        }
        if let (Some(texts), Some(states)) = (&slopes.states, &states) {
            for (part, followers) in states.iter().enumerate() {
                for (text, follower) in texts.as_ref().iter().zip(followers.as_ref()) {
                    let forces = text.force.iter().zip(scales);
                    for (row, (force, row_scale)) in rows.iter_mut().zip(forces) {
                        let places = row.iter_mut().skip(part).take(1).flatten();
                        for ((place, q), scale) in places.zip(&follower.q).zip(scales) {
                            *place = *place - *force * *q * (*scale / *row_scale);
                        }
                    }
                }
            }
        }
        Some(Shifted { s, factors: SplitLu::factorize(rows)?, scales: *scales, states })
    }

    /// (s − J)⁻¹ `right`. Work and phases, which nothing depends on, are divided by s.
    pub(in crate::dynamics) fn solve(
        &self,
        slopes: &Slopes<S, R, N, M>,
        right: [&Moving<S, R, N, M>; PARTS],
    ) -> [Moving<S, R, N, M>; PARTS] {
        let zero = R::constant(0.0);
        let inverse = reciprocal(self.s);
        // Work and phases; the other parts are written below.
        let mut found = times(inverse, right);
        let (q, qd) = (right.map(|right| right.y.q), right.map(|right| right.y.qd));
        let states = match &self.states {
            Some(states) if const { !S::STATES.is_empty() } => Some(followed(slopes, states, right)),
            _ => None,
        };
        let mut open = [[zero; N]; PARTS];
        for (part, (open, (q, qd))) in open.iter_mut().zip(q.iter().zip(&qd)).enumerate() {
            *open = *qd;
            for (column, q) in slopes.qd.iter().zip(q) {
                open.iter_mut().zip(column).for_each(|(open, slope)| *open = *open - *slope * *q);
            }
            let (Some(texts), Some(states)) = (&slopes.states, &states) else { continue };
            let values = states.iter().skip(part).take(1).flat_map(|states| states.as_ref());
            for (text, value) in texts.as_ref().iter().zip(values) {
                open.iter_mut().zip(&text.force).for_each(|(open, force)| *open = *open + *force * *value);
            }
        }
        add_times(&mut open, self.s, &q);
        for open in &mut open {
            open.iter_mut().zip(&self.scales).for_each(|(open, scale)| *open = *open / *scale);
        }
        let mut place = self.factors.solve(open);
        for place in &mut place {
            place.iter_mut().zip(&self.scales).for_each(|(place, scale)| *place = *place * *scale);
        }
        let mut speed = q.map(|q| q.each(|q| -q));
        add_times(&mut speed, self.s, &place);
        let states = match (&self.states, states) {
            (Some(rows), Some(states)) if const { !S::STATES.is_empty() } => {
                Some(carried(rows, states, &place))
            }
            _ => None,
        };
        for (index, (found, (place, speed))) in found.iter_mut().zip(place.iter().zip(&speed)).enumerate() {
            (found.y.q, found.y.qd) = (*place, *speed);
            if let Some(states) = states.as_ref().and_then(|states| states.get(index)) {
                found.y.states = *states;
            }
        }
        found
    }
}

/// `sum` + s x.
fn add_times<R: Real, const N: usize, const PARTS: usize>(
    sum: &mut Numbers<R, N, PARTS>,
    s: Number<R, PARTS>,
    x: &Numbers<R, N, PARTS>,
) {
    for k in 0..N {
        let change = product(s, entry(x, k));
        for (sum, change) in sum.iter_mut().zip(change) {
            sum.iter_mut().skip(k).take(1).for_each(|sum| *sum = *sum + change);
        }
    }
}

/// `factor` x.
fn times<R: Real, Y: Vector<R>, const PARTS: usize>(factor: Number<R, PARTS>, x: [&Y; PARTS]) -> [Y; PARTS] {
    let mut result = x.map(|x| x.zero());
    match (result.as_mut_slice(), factor.as_slice(), x.as_slice()) {
        ([re], [factor], [x]) => *re = re.plus(*factor, &[1.0], [*x]),
        ([re, im], [a, b], [x, y]) => {
            *re = re.plus(*a, &[1.0], [*x]).plus(-*b, &[1.0], [*y]);
            *im = im.plus(*a, &[1.0], [*y]).plus(*b, &[1.0], [*x]);
        }
        _ => {}
    }
    result
}

/// The states by their parts: (s − ż_z)⁻¹ (r_z − ż_q̇ r_q).
fn followed<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize, const PARTS: usize>(
    slopes: &Slopes<S, R, N, M>,
    rows: &[S::StateSlopes; PARTS],
    right: [&Moving<S, R, N, M>; PARTS],
) -> [S::States; PARTS] {
    let mut open = right.map(|right| right.y.states);
    if let Some(texts) = &slopes.states {
        for (open, right) in open.iter_mut().zip(right) {
            for (open, text) in open.as_mut().iter_mut().zip(texts.as_ref()) {
                let moved = text.qd.iter().zip(&right.y.q);
                *open = moved.fold(*open, |open, (slope, q)| open - *slope * *q);
            }
        }
    }
    let mut found = open;
    for index in 0..count(&open) {
        let mut sum = [R::constant(0.0); PARTS];
        for column in 0..count(&open) {
            let factor = of_each(rows, |rows| at(rows, index, column));
            let change = product(factor, value(&open, column));
            sum.iter_mut().zip(change).for_each(|(sum, change)| *sum = *sum + change);
        }
        write(&mut found, index, sum);
    }
    found
}

/// The states by their parts, with the changes by which `place` of the coordinates carries them along.
fn carried<R: Real, Z, P, const N: usize, const PARTS: usize>(
    rows: &[P; PARTS],
    mut states: [Z; PARTS],
    place: &Numbers<R, N, PARTS>,
) -> [Z; PARTS]
where
    Z: Copy + AsRef<[R]> + AsMut<[R]>,
    P: AsRef<[StateSlope<R, N, Z>]>,
{
    for index in 0..count(&states) {
        let mut sum = value(&states, index);
        for column in 0..N {
            let factor = of_each(rows, |rows| {
                let row = rows.as_ref().get(index).and_then(|row| row.q.get(column));
                row.copied().unwrap_or(R::constant(0.0))
            });
            let change = product(factor, entry(place, column));
            sum.iter_mut().zip(change).for_each(|(sum, change)| *sum = *sum + change);
        }
        write(&mut states, index, sum);
    }
    states
}

/// Of each state, by its parts: its row of (s − ż_z)⁻¹, and of (s − ż_z)⁻¹ (ż_q + s ż_q̇). Gauss–Jordan with pivots by size.
fn eliminated<R: Real, Z, P, const N: usize, const PARTS: usize>(
    text: &P,
    s: Number<R, PARTS>,
) -> Option<[P; PARTS]>
where
    Z: Copy + AsRef<[R]> + AsMut<[R]>,
    P: Copy + AsRef<[StateSlope<R, N, Z>]> + AsMut<[StateSlope<R, N, Z>]>,
{
    let (zero, one) = (R::constant(0.0), R::constant(1.0));
    // The matrix, and beside it what becomes its inverse with the right-hand sides.
    let (mut matrix, mut result) = ([*text; PARTS], [*text; PARTS]);
    for (part, ((matrix, result), s)) in matrix.iter_mut().zip(&mut result).zip(s).enumerate() {
        let real = if part == 0 { one } else { zero };
        let rows = matrix.as_mut().iter_mut().zip(result.as_mut());
        for (index, (row, result)) in rows.enumerate() {
            for (q, qd) in result.q.iter_mut().zip(&row.qd) {
                *q = real * *q + s * *qd;
            }
            let entries = row.states.as_mut().iter_mut().zip(result.states.as_mut()).enumerate();
            for (column, (entry, unit)) in entries {
                *unit = if index == column { real } else { zero };
                *entry = if index == column { s - real * *entry } else { -(real * *entry) };
            }
        }
    }
    let states = text.as_ref().len();
    for column in 0..states {
        let mut best = (column, -one);
        for index in column..states {
            let size = of_each(&matrix, |rows| at(rows, index, column));
            let size = size.iter().fold(zero, |size, part| size + part.abs());
            if best.1 < size {
                best = (index, size);
            }
        }
        let pivot = reciprocal(of_each(&matrix, |rows| at(rows, best.0, column)));
        if !pivot.iter().all(|part| part.is_finite()) {
            return None;
        }
        for rows in [&mut matrix, &mut result] {
            exchange(rows, column, best.0);
            scale(rows, column, pivot);
        }
        for index in (0..states).filter(|index| *index != column) {
            let factor = of_each(&matrix, |rows| at(rows, index, column));
            for rows in [&mut matrix, &mut result] {
                subtract(rows, index, factor, column);
            }
        }
    }
    Some(result)
}

fn count<R, Z: AsRef<[R]>, const PARTS: usize>(states: &[Z; PARTS]) -> usize {
    states.first().map_or(0, |states| states.as_ref().len())
}

/// Entry of row `index` and column `column` among the states.
fn at<R: Real, Z, P, const N: usize>(rows: &P, index: usize, column: usize) -> R
where
    Z: AsRef<[R]> + AsMut<[R]>,
    P: AsRef<[StateSlope<R, N, Z>]>,
{
    rows.as_ref().get(index).map_or(R::constant(0.0), |row| row.entry(column))
}

fn value<R: Real, Z: AsRef<[R]>, const PARTS: usize>(states: &[Z; PARTS], index: usize) -> Number<R, PARTS> {
    of_each(states, |states| states.as_ref().get(index).copied().unwrap_or(R::constant(0.0)))
}

fn write<R: Real, Z: AsMut<[R]>, const PARTS: usize>(
    states: &mut [Z; PARTS],
    index: usize,
    value: Number<R, PARTS>,
) {
    for (states, value) in states.iter_mut().zip(value) {
        states.as_mut().iter_mut().skip(index).take(1).for_each(|state| *state = value);
    }
}

fn exchange<R: Real, Z, P, const N: usize, const PARTS: usize>(
    rows: &mut [P; PARTS],
    first: usize,
    second: usize,
) where
    Z: Copy,
    P: AsMut<[StateSlope<R, N, Z>]>,
{
    for rows in rows {
        let rows = rows.as_mut();
        if let (Some(one), Some(other)) = (rows.get(first).copied(), rows.get(second).copied()) {
            rows.iter_mut().skip(first).take(1).for_each(|row| *row = other);
            rows.iter_mut().skip(second).take(1).for_each(|row| *row = one);
        }
    }
}

/// `factor` times row `index`.
fn scale<R: Real, Z, P, const N: usize, const PARTS: usize>(
    rows: &mut [P; PARTS],
    index: usize,
    factor: Number<R, PARTS>,
) where
    Z: Copy + AsRef<[R]> + AsMut<[R]>,
    P: Copy + AsRef<[StateSlope<R, N, Z>]> + AsMut<[StateSlope<R, N, Z>]>,
{
    let mut less = factor.each(|part| -part);
    if let Some(real) = less.first_mut() {
        *real = *real + R::constant(1.0);
    }
    subtract(rows, index, less, index);
}

/// Row `index` less `factor` times row `other`.
fn subtract<R: Real, Z, P, const N: usize, const PARTS: usize>(
    rows: &mut [P; PARTS],
    index: usize,
    factor: Number<R, PARTS>,
    other: usize,
) where
    Z: Copy + AsRef<[R]> + AsMut<[R]>,
    P: Copy + AsRef<[StateSlope<R, N, Z>]> + AsMut<[StateSlope<R, N, Z>]>,
{
    let (mut read, mut taken) = ([None; PARTS], [None; PARTS]);
    for ((read, taken), rows) in read.iter_mut().zip(&mut taken).zip(rows.iter()) {
        (*read, *taken) = (rows.as_ref().get(other).copied(), rows.as_ref().get(index).copied());
    }
    match (taken.as_mut_slice(), read.as_slice(), factor.as_slice()) {
        ([Some(row)], [Some(other)], [factor]) => row.subtract(*factor, other),
        ([Some(re), Some(im)], [Some(other_re), Some(other_im)], [a, b]) => {
            re.subtract(*a, other_re);
            re.subtract(-*b, other_im);
            im.subtract(*a, other_im);
            im.subtract(*b, other_re);
        }
        _ => {}
    }
    for (rows, taken) in rows.iter_mut().zip(taken) {
        let place = rows.as_mut().get_mut(index);
        if let (Some(place), Some(row)) = (place, taken) {
            *place = row;
        }
    }
}
