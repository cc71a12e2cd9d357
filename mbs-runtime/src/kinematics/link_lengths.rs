//! Movements of coordinates that are lengths, judged by themselves. The movement of an angle is its number. Points of a link
//! move by the turn times its length, which may be any part of the reference length.

use crate::linear_algebra::vectors::weights as reciprocals;
use crate::mechanism::Entry;
use crate::scalar::number::{Real, Scalar};
use crate::tolerances::positions;

/// Largest difference of a rate from the one foreseen, over the sizes of both and of their change.
///
/// A link that turns by φ changes the rates of its points by 1 − cos φ. The limit is reached at 1.3 rad, and by rates that fall
/// to three fifths.
const LARGEST_KINK: f64 = 0.25;

/// Largest part of a movement that is not foreseen by its tangent, where a link turns by a quarter of a radian, or by its first two terms.
const LARGEST_BEND: f64 = 0.125;

/// The same over the margin, where that is less: the other assembly is off by twice the margin times the link, which moved by its length
/// times an angle.
const LARGEST_BEND_OF_MARGIN: f64 = 0.5;

/// Bend of an angle over the margin that is ignored. Where the other assembly is next to the former angle, it is off by twice the
/// margin.
const LEAST_BEND: f64 = 1.0 / 32.0;

/// Movement over the margin up to which the forecast of other coordinates says what a point is off by. The other assembly of a link is off
/// by twice the margin times its length, which counts above a thousandth.
const LARGEST_SHARE: f64 = 1e-3;

/// Distance of an angle from its prediction over the margin up to which it needs no test.
pub(crate) const APPROACH_OF_ANGLES: f64 = 1.0 / 256.0;

/// Of each coordinate that is a length, the first one of its point; of all others, none.
pub(crate) type Points<const N: usize> = [Option<usize>; N];

/// `true` if there are coordinates that are neither angles nor pure numbers.
pub(crate) const fn any(coordinates: &[Entry]) -> bool {
    let mut rest = coordinates;
    while let [first, others @ ..] = rest {
        if is_length(first.unit) {
            return true;
        }
        rest = others;
    }
    false
}

/// The points that coordinates belong to: components of a vector, or such lengths that are declared side by side. Asked while a mechanism
/// is compiled.
pub(crate) const fn points<const N: usize>(coordinates: &[Entry]) -> Points<N> {
    let mut points = [None; N];
    let mut last: Option<(&[u8], usize)> = None;
    let (mut rest, mut open, mut index): (_, &mut [_], _) = (coordinates, &mut points, 0);
    while let ([entry, others @ ..], [point, behind @ ..]) = (rest, open) {
        if is_length(entry.unit) {
            let name = name_of_vector(entry.name.as_bytes());
            let first = match last {
                Some((before, first)) if are_equal(before, name) => first,
                _ => index,
            };
            *point = Some(first);
            last = Some((name, first));
        } else {
            last = None;
        }
        (rest, open, index) = (others, behind, index + 1);
    }
    points
}

/// The name before the last dot; nothing where there is none.
const fn name_of_vector(name: &[u8]) -> &[u8] {
    let mut rest = name;
    while let [before @ .., last] = rest {
        if *last == b'.' {
            return before;
        }
        rest = before;
    }
    &[]
}

const fn are_equal(mut a: &[u8], mut b: &[u8]) -> bool {
    while let ([first, a_rest @ ..], [second, b_rest @ ..]) = (a, b) {
        if *first != *second {
            return false;
        }
        (a, b) = (a_rest, b_rest);
    }
    a.is_empty() && b.is_empty()
}

const fn is_length(unit: &str) -> bool {
    !matches!(unit.as_bytes(), b"rad" | b"1" | b"")
}

/// The largest of a point's `values`, in the reference metric, at its first coordinate; `weights`: reciprocals of the scales.
#[inline(always)]
fn sizes<T: Scalar, const N: usize>(points: &Points<N>, weights: &[T; N], values: &[T; N]) -> [T; N] {
    let mut sizes = [T::constant(0.0); N];
    for ((first, value), weight) in points.iter().zip(values).zip(weights) {
        if let Some(size) = first.and_then(|first| sizes.get_mut(first)) {
            *size = size.max((*value * *weight).abs());
        }
    }
    sizes
}

/// Movement over the margin that is rounding.
pub(crate) fn rounding<R: Real>(margin: R) -> R {
    positions::ROUNDED_MOVEMENT.of::<R>() / margin
}

/// Movement that is not looked at.
pub(crate) fn least<T: Scalar>(margin: T) -> T {
    positions::LEAST_MOVEMENT.of::<T>() * margin
}

/// `true` if no point's `differences` are more than `part` of its `movements` together and `most` (N, at its first coordinate); false for
/// NaN.
#[inline(always)]
fn are_parts<T: Scalar, const N: usize, const K: usize>(
    (points, scales): (&Points<N>, &[T; N]),
    differences: &[T; N],
    movements: [&[T; N]; K],
    part: T,
    mut most: [T; N],
) -> T::Mask {
    let weights = reciprocals(scales);
    for movement in movements {
        let sizes = sizes(points, &weights, movement);
        most.iter_mut().zip(sizes).for_each(|(most, size)| *most = *most + part * size);
    }
    let all = points.iter().zip(differences).zip(&weights).map(|((first, difference), weight)| {
        let most = first.and_then(|first| most.get(first).copied());
        most.map_or(T::mask(true), |most| (*difference * *weight).abs().less(most))
    });
    all.fold(T::mask(true), |all, one| all & one)
}

/// Largest part of a movement that may be unforeseen at a `margin`.
fn largest_bend<T: Scalar>(margin: T) -> T {
    T::constant(LARGEST_BEND).min(T::constant(LARGEST_BEND_OF_MARGIN) * margin)
}

/// `true` if the rates of points agree to a quarter with those predicted from the rates before and their change over `h` (s): no
/// link turned by much more than a radian. `before` and `change`: rate and acceleration, N; movements of points up to `least` (N) are
/// ignored.
#[inline(always)]
pub(crate) fn turn_little<T: Scalar, const N: usize>(
    metric: (&Points<N>, &[T; N]),
    [before, change, after]: [&[T; N]; 3],
    h: T,
    least: [T; N],
) -> T::Mask {
    let moved = |rates: &[T; N]| rates.map(|rate| h * rate);
    let [before, change, after] = [moved(before), moved(&moved(change)), moved(after)];
    let mut kink = after;
    for ((kink, before), change) in kink.iter_mut().zip(&before).zip(&change) {
        *kink = *kink - *before - *change;
    }
    are_parts(metric, &kink, [&before, &change, &after], T::constant(LARGEST_KINK), least)
}

/// [`turn_little`] of one coordinate by itself, and its movements by the rate before, by its change and by the rate after.
#[inline(always)]
pub(crate) fn turns_little<T: Scalar>([before, change, after]: [T; 3], least: T) -> T::Mask {
    let sizes = before.abs() + change.abs() + after.abs();
    (after - before - change).abs().less(T::constant(LARGEST_KINK) * sizes + least)
}

/// `true` if the `tangent` of a path leads to its end within an eighth or less, at a `margin`. `way`: from its start to its end.
pub(crate) fn bend_little<T: Scalar, const N: usize>(
    metric: (&Points<N>, &[T; N]),
    tangent: &[T; N],
    way: &[T; N],
    margin: T,
) -> T::Mask {
    let mut bend = *way;
    bend.iter_mut().zip(tangent).for_each(|(bend, tangent)| *bend = *bend - *tangent);
    let slight = T::constant(LEAST_BEND) * margin;
    let angles = metric.0.iter().zip(&bend).filter(|(point, _)| point.is_none());
    let angles = angles.fold(T::mask(true), |all, (_, bend)| all & bend.abs().less(slight));
    angles & are_parts(metric, &bend, [tangent, way], largest_bend(margin), [least(margin); N])
}

/// `true` if coordinates are at their prediction but for `off`, within an eighth of their movement over `h` (s) by rates and
/// their change: no function jumped.
#[inline(always)]
pub(crate) fn are_foreseen<T: Scalar, const N: usize>(
    metric: (&Points<N>, &[T; N]),
    off: &[T; N],
    [rate, change]: [&[T; N]; 2],
    (h, margin): (T, T),
) -> T::Mask {
    let half_square = T::constant(0.5) * h * h;
    let terms = [rate.map(|rate| h * rate), change.map(|change| half_square * change)];
    let (part, slight) = (T::constant(LARGEST_BEND), T::constant(APPROACH_OF_ANGLES) * margin);
    let angles = metric.0.iter().zip(off).zip(terms[0].iter().zip(&terms[1]));
    let angles =
        angles.filter(|((point, _), _)| point.is_none()).fold(T::mask(true), |all, ((_, off), terms)| {
            all & off.abs().less(part * (terms.0.abs() + terms.1.abs()) + slight)
        });
    angles & are_parts(metric, off, [&terms[0], &terms[1]], largest_bend(margin), [least(margin); N])
}

/// Distances of points (N, at their first coordinates) from where a forecast has them that others cause. A point at rest is off by what
/// the forecast of those leaves out, a part of their term of the `second` order (N): pieces move by the root of the margin at most.
pub(crate) fn caused_by_others<R: Real, const N: usize>(
    points: &Points<N>,
    scales: &[R; N],
    second: &[R; N],
    margin: R,
) -> [R; N] {
    let (weights, most) = (reciprocals(scales), R::constant(LARGEST_SHARE) * margin);
    let mut caused = [R::constant(0.0); N];
    for (place, caused) in caused.iter_mut().enumerate() {
        let terms = points.iter().zip(second).zip(&weights);
        let others = terms.filter(|((point, _), _)| **point != Some(place));
        let largest =
            others.fold(*caused, |largest, ((_, term), weight)| largest.max((*term * *weight).abs()));
        *caused = largest.min(most);
    }
    caused
}

/// Reciprocals of the movements of points in a piece of a way, N, which differences are measured by; 0 for all that is no length.
/// `first`, `second`: the terms of its prediction; `caused`: distances that are others'; `margin` where it begins.
pub(crate) fn weights<R: Real, const N: usize>(
    points: &Points<N>,
    scales: &[R; N],
    [first, second, caused]: [&[R; N]; 3],
    margin: R,
) -> [R; N] {
    let least = rounding(margin).max(least(margin));
    let reciprocals = reciprocals(scales);
    let [first, second] = [first, second].map(|term| sizes(points, &reciprocals, term));
    let mut weights = [R::constant(0.0); N];
    for ((weight, point), scale) in weights.iter_mut().zip(points).zip(scales) {
        let terms = point.and_then(|point| first.get(point).zip(second.get(point)).zip(caused.get(point)));
        if let Some(((first, second), caused)) = terms {
            *weight = R::constant(1.0) / ((*first + *second).max(least).max(*caused) * *scale);
        }
    }
    weights
}

/// The largest of N differences times their weights; NaN where one is.
pub(crate) fn weighted<R: Real, const N: usize>(differences: &[R; N], weights: &[R; N]) -> R {
    let mut largest = R::constant(0.0);
    for (difference, weight) in differences.iter().zip(weights) {
        let size = (*difference * *weight).abs();
        let stays = largest.to_f64().is_nan() || size <= largest;
        largest = if stays { largest } else { size };
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::sequence::Sequence;

    const fn entry(name: &'static str, unit: &'static str) -> Entry {
        Entry { name, unit, line: 0 }
    }

    #[test]
    fn components_of_a_vector_are_one_point() {
        let entries =
            [entry("A.0", "m"), entry("A.1", "m"), entry("B.0", "m"), entry("p", "rad"), entry("s", "m")];
        assert_eq!(points(&entries), [Some(0), Some(0), Some(2), None, Some(4)]);
        assert!(any(&entries) && !any(&entries[3..4]));
        assert_eq!(points(&[entry("x", "m"), entry("y", "m")]), [Some(0), Some(0)]);
    }

    #[test]
    fn a_link_that_turns_far_is_told_whatever_its_length() {
        let points = [Some(0), Some(0), Some(2), Some(2)];
        for length in [1.0, 1e-3] {
            for (turn, little) in [(0.3_f64, true), (0.8, true), (1.8, false), (3.0, false)] {
                for start in [0.0_f64, 0.7, 1.5] {
                    // A point at rest stands beside it, then one that moves a hundred times as far.
                    for other in [0.0, 100.0 * length] {
                        let rate = |angle: f64| [-length * angle.sin(), length * angle.cos(), other, other];
                        let change = [-length * start.cos(), -length * start.sin(), 0.0, 0.0];
                        let [before, after] = [start, start + turn].map(rate);
                        // One second for a turn at 1 rad/s.
                        let [before, after] = [before, after].map(|rates| rates.map(|rate| turn * rate));
                        let change = change.map(|change| turn * turn * change);
                        let told =
                            turn_little((&points, &[1.0; 4]), [&before, &change, &after], 1.0, [1e-9; 4]);
                        assert_eq!(told, little, "{length} {turn} {start} {other}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_turns_little_by_each_coordinate_turns_little() {
        let (mut sequence, points, least) = (Sequence::new(29), [Some(0), Some(0)], 1e-9);
        let (mut each, mut all) = (0, 0);
        for _ in 0..2000 {
            let [before, change, mut after]: [[f64; 2]; 3] = sequence.matrix();
            after.iter_mut().zip(before.iter().zip(&change)).for_each(|(after, (b, c))| *after += b + c);
            let single = |k: usize| turns_little([before[k], change[k], after[k]], least);
            let point = turn_little((&points, &[1.0; 2]), [&before, &change, &after], 1.0, [least; 2]);
            assert!(point || !(single(0) && single(1)), "{before:?} {change:?} {after:?}");
            (each, all) = (each + u32::from(single(0) && single(1)), all + u32::from(point));
        }
        assert!(each > 100 && all > each, "{each} {all}");
    }
}
