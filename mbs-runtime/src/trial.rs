//! A step as it goes next to a regular position: straight on, with one decision at the end.

use core::array::from_fn;

use crate::diagnosis::index;
use crate::instant::{is_coarse, regular_zone};
use crate::kinematics::COARSEST_RESOLUTION;
use crate::mechanism::negated;
use crate::path::{LARGEST_APPROACH, LARGEST_SECOND_ORDER_TERM};
use crate::plain::Plain;
use crate::{Kinematic, Margin, Real, Scalar, Statistics, lengths};

/// Most coordinates that stay in registers from the end of a step to its state, which are written one by one.
const FEW: usize = 8;

/// Second-order term (reference lengths) from which on a step of a mechanism with coordinates that are lengths is looked at: with less, no
/// link of a thousandth turns by half a radian.
const QUICK_SECOND_ORDER_TERM: f64 = 1e-4;

/// Way from the prediction over the margin from which on such a step is looked at, beside what rounding needs.
const QUICK_APPROACH: f64 = 1e-5;

/// Roundings of a position at which it is not looked at either.
const QUICK_ROUNDINGS: f64 = 2e3;

/// Second-order term and way from the prediction over the margin up to which nothing is to be asked of a step, `with_lengths` among the
/// coordinates or without.
#[inline(always)]
pub(crate) fn quick<R: Real>(with_lengths: bool) -> [f64; 2] {
    if with_lengths {
        return [QUICK_SECOND_ORDER_TERM, QUICK_APPROACH.max(QUICK_ROUNDINGS * R::EPSILON.to_f64())];
    }
    [LARGEST_SECOND_ORDER_TERM, lengths::APPROACH_OF_ANGLES]
}

/// Where a step begins, solved in every lane.
pub(crate) struct Start<'a, T, const N: usize> {
    pub t: T,
    pub q: &'a [T; N],
    pub qd: &'a [T; N],
    pub qdd: &'a [T; N],
    pub margin: T,
    /// Reciprocals of the coordinates' scales in the reference metric.
    pub weights: &'a [T; N],
}

/// What a step came to.
///
/// No address of what stands here is given away on the way: so it stays in registers, and in the state that it becomes every
/// number is written once.
#[derive(Clone, Copy)]
pub(crate) struct Trial<T: Scalar, const N: usize> {
    pub q: [T; N],
    pub qd: [T; N],
    pub qdd: [T; N],
    pub margin: T,
    pub orientation: T::Lanes<u64>,
    /// The way from the prediction, in the reference metric.
    pub correction: T,
    /// Largest |residual| over its tolerance.
    pub residual: T,
    /// Index in Φ of its row.
    pub row: T,
    evaluations: u32,
    /// Those of each lane, where there are several.
    counts: T,
    /// Lanes in which nothing happened but what does next to a regular position. The others are stepped with care.
    pub plain: T::Mask,
    /// Lanes in which what is left of the residual is seen in the accelerations.
    pub coarse: T::Mask,
    /// Lanes in which a link much shorter than the reference length may have turned far: [`settles`](Self::settles) tells.
    pub doubtful: T::Mask,
}

impl<T: Scalar, const N: usize> Trial<T, N> {
    /// Solves position, velocity and acceleration at `t` from the prediction q + h q̇ + h²/2 q̈.
    ///
    /// Not plain is a step from or into the singular zone, one too long to be foreseen, one that does not converge, ends so far from
    /// the prediction that it may be in another assembly, violates a branch or leaves a limit, and one that is not finite. Nor is any
    /// outside `lanes`. A passage is plain here.
    #[inline(always)]
    pub(crate) fn of<S: Kinematic<T, N, M>, const M: usize>(
        mechanism: &S,
        parameters: &S::Parameters,
        start: &Start<'_, T, N>,
        t: T,
        lanes: T::Mask,
    ) -> Self {
        let scales = mechanism.coordinate_scales(parameters);
        let [most_second, most_way] = quick::<T::Real>(const { lengths::any(S::COORDINATES) });
        let (prediction, trusted, far) = start.predicted(t, &scales, most_second);
        let most_way = T::constant(most_way);
        let mut solver = Plain::new(lanes);
        // Lanes keep a processor busy as they are, and a compiler sees them together in short stages. Each way is judged where it
        // ends: what both had to put down for one judge would be copied.
        if S::BLOCK_BY_BLOCK && T::LANES == 1 {
            let zeros = [T::constant(0.0); N];
            let mut motion = [prediction, zeros, zeros];
            let solved = &mechanism.solve_motion(parameters, &mut motion, t, &mut solver);
            let sum = solved.sum + sum_of_rates(&motion[1], &motion[2]);
            let judge = Judge {
                mechanism,
                parameters,
                start,
                prediction: &prediction,
                trusted,
                far,
                most_way,
                solver,
            };
            return judge.judged(motion, (&solved.position, &solved.margin), sum);
        }
        let mut q = prediction;
        // By reference: what is long would be moved out of the pairs.
        let (_, position) = &mechanism.solve_with_position(parameters, &mut q, t, &mut solver);
        let (factors, margin) = &mechanism.factorize(parameters, position);
        let qd = mechanism.solve_linear(factors, &negated(mechanism.phi_t(parameters, position)));
        let qdd = mechanism.solve_linear(factors, &mechanism.gamma(parameters, position, &qd));
        let sum = sum_of_rates(&qd, &qdd);
        let judge =
            Judge { mechanism, parameters, start, prediction: &prediction, trusted, far, most_way, solver };
        judge.judged([q, qd, qdd], (position, margin), sum)
    }

    /// What the step of lane `lane` cost; `passed`: whether a singular position lies before it.
    #[inline(always)]
    pub(crate) fn statistics(&self, lane: usize, passed: bool) -> Statistics {
        Statistics {
            evaluations: self.evaluations,
            fallback: false,
            residual: self.residual.lane(lane).to_f64(),
            row: index(self.row, lane),
            correction: self.correction.lane(lane).to_f64(),
            passed,
        }
    }

    /// Evaluations of residual and Jacobian until each lane closed, the most of any block: numbers, written like the others.
    #[inline(always)]
    pub(crate) fn evaluations(&self) -> T {
        if T::LANES > 1 { self.counts } else { T::constant(f64::from(self.evaluations)) }
    }

    /// Whether the links of a doubtful step from `start` to `t`, whose rates foresaw it, turned so little that it leads to no other assembly.
    #[cold]
    #[inline(never)]
    pub(crate) fn settles(
        &self,
        metric: (&lengths::Points<N>, &[T; N]),
        start: &Start<'_, T, N>,
        t: T,
    ) -> T::Mask {
        let h = t - start.t;
        let (prediction, _, far) = start.predicted_far(h, metric.1);
        let least = lengths::least(self.margin);
        let little = lengths::turn_little(metric, [start.qd, start.qdd, &self.qd], h, least);
        let mut off = self.q;
        off.iter_mut().zip(&prediction).for_each(|(off, foreseen)| *off = *off - *foreseen);
        let foreseen = lengths::are_foreseen(metric, &off, [start.qd, start.qdd], (h, self.margin));
        (!far | little) & foreseen
    }

    /// Signs of the blocks' determinants of lane `lane`.
    #[inline(always)]
    pub(crate) fn orientation(&self, lane: usize) -> u64 {
        self.orientation.as_ref().get(lane).copied().unwrap_or(0)
    }
}

/// What a step is judged with.
struct Judge<'a, S: Kinematic<T, N, M>, T: Scalar, const N: usize, const M: usize> {
    mechanism: &'a S,
    parameters: &'a S::Parameters,
    start: &'a Start<'a, T, N>,
    prediction: &'a [T; N],
    /// Lanes whose prediction has a second-order term small enough.
    trusted: T::Mask,
    /// Lanes in which that term is not so small that links cannot have turned far.
    far: T::Mask,
    /// Way from the prediction over the margin up to which nothing is to be asked.
    most_way: T,
    solver: Plain<T>,
}

impl<S: Kinematic<T, N, M>, T: Scalar, const N: usize, const M: usize> Judge<'_, S, T, N, M> {
    /// The step that ends at `motion` (q, q̇, q̈), whether it is plain with it; `sum`: finite where rates and factors are.
    #[inline(always)]
    fn judged(
        self,
        [q, qd, qdd]: [[T; N]; 3],
        (position, margin): (&S::Position, &Margin<T>),
        sum: T,
    ) -> Trial<T, N> {
        let (correction, size) = way_and_size(&q, self.prediction, self.start.weights);
        let zone = regular_zone::<T>();
        // Written so that NaN is not plain. A sum is finite and small where its terms are; where it is not, a careful step
        // looks at them one by one.
        let mut plain =
            zone.less(margin.value) & zone.less(self.start.margin) & self.solver.closed & self.trusted;
        plain = plain & correction.less(T::constant(LARGEST_APPROACH) * margin.value);
        let doubtful = self.far | !correction.less(self.most_way * margin.value);
        plain = plain & size.less(T::constant(COARSEST_RESOLUTION / T::Real::EPSILON.to_f64()));
        plain = plain & sum.is_finite();
        for (index, branch) in self.mechanism.branches(self.parameters, position).as_ref().iter().enumerate()
        {
            if !S::BRANCHES_AT_START.get(index).copied().unwrap_or(false) {
                plain = plain & T::constant(0.0).less(*branch);
            }
        }
        for limit in self.mechanism.limits(self.parameters, position).as_ref() {
            plain = plain & limit.low.less(limit.value) & limit.value.less(limit.high);
        }
        Trial {
            q,
            qd,
            qdd,
            margin: margin.value,
            orientation: margin.orientation,
            correction,
            residual: self.solver.ratio,
            row: self.solver.row,
            evaluations: self.solver.evaluations,
            counts: self.solver.counts,
            plain,
            coarse: is_coarse(self.solver.ratio, margin.value),
            doubtful,
        }
    }
}

impl<T: Scalar, const N: usize> Start<'_, T, N> {
    /// q + h q̇ + h²/2 q̈, the lanes where the last term is small enough (elsewhere it is no prediction), and those where it is more than
    /// `most` reference lengths (or rad).
    #[inline(always)]
    fn predicted(&self, t: T, scales: &[T; N], most: f64) -> ([T; N], T::Mask, T::Mask) {
        let h = t - self.t;
        let half_square = T::constant(0.5) * h * h;
        let alone = size_of::<T>() == size_of::<T::Real>();
        if alone && N > FEW {
            return self.predicted_side_by_side(h, scales, most);
        }
        let mut predicted = *self.q;
        let mut all = T::mask(true);
        let rates = self.qd.iter().zip(self.qdd);
        for ((coordinate, (rate, acceleration)), scale) in predicted.iter_mut().zip(rates).zip(scales) {
            let first = *coordinate + h * *rate;
            let second = half_square * *acceleration;
            // A branch a coordinate, which looks at all that it is made of (nothing is added but 0, or NaN): without them the
            // compiler would load two at once, which were written one by one a moment ago, and the processor would have to
            // wait until they have reached the memory. Lanes are loaded as they were written.
            let looked_at = if alone { second + T::constant(0.0) * first } else { second };
            let trusted = trusted(looked_at, *scale, most);
            if alone && !T::all(trusted) {
                return self.predicted_far(h, scales);
            }
            all = all & trusted;
            *coordinate = first + second;
        }
        if most < LARGEST_SECOND_ORDER_TERM && !T::all(all) {
            return self.predicted_far(h, scales);
        }
        (predicted, all, T::mask(false))
    }

    /// [`predicted`](Self::predicted) for so many coordinates that the last step has put them down together, behind all blocks:
    /// they are loaded as they were written, and without decisions several at once.
    #[inline(always)]
    fn predicted_side_by_side(&self, h: T, scales: &[T; N], most: f64) -> ([T; N], T::Mask, T::Mask) {
        let half_square = T::constant(0.5) * h * h;
        let mut all = T::mask(true);
        for (acceleration, scale) in self.qdd.iter().zip(scales) {
            all = all & trusted(half_square * *acceleration, *scale, most);
        }
        if !T::all(all) {
            return self.predicted_far(h, scales);
        }
        let mut predicted = *self.q;
        for ((coordinate, rate), acceleration) in predicted.iter_mut().zip(self.qd).zip(self.qdd) {
            *coordinate = *coordinate + h * *rate + half_square * *acceleration;
        }
        (predicted, all, T::mask(false))
    }

    /// [`predicted`](Self::predicted) where the second-order term of a coordinate is not small in a lane.
    #[cold]
    #[inline(never)]
    fn predicted_far(&self, h: T, scales: &[T; N]) -> ([T; N], T::Mask, T::Mask) {
        let half_square = T::constant(0.5) * h * h;
        let mut predicted = *self.q;
        let (mut all, mut quick) = (T::mask(true), T::mask(true));
        let rates = self.qd.iter().zip(self.qdd);
        for ((coordinate, (rate, acceleration)), scale) in predicted.iter_mut().zip(rates).zip(scales) {
            let second = half_square * *acceleration;
            all = all & trusted(second, *scale, LARGEST_SECOND_ORDER_TERM);
            quick = quick & trusted(second, *scale, QUICK_SECOND_ORDER_TERM);
            *coordinate = *coordinate + h * *rate + second;
        }
        (predicted, all, !quick)
    }
}

/// The largest way of a coordinate from its prediction, and the sum of the coordinates' sizes, in the reference metric.
#[inline(always)]
fn way_and_size<T: Scalar, const N: usize>(q: &[T; N], predicted: &[T; N], weights: &[T; N]) -> (T, T) {
    if T::LANES > 1 {
        let places = q.iter().zip(predicted).zip(weights);
        // Straight away: the sum that each coordinate waits for keeps its lanes together.
        let start = (T::constant(0.0), T::constant(0.0));
        return places.fold(start, |(way, size), ((place, predicted), weight)| {
            (way.max(((*place - *predicted) * *weight).abs()), size + place.abs() * *weight)
        });
    }
    let ways: [T; N] = from_fn(|index| ((q[index] - predicted[index]) * weights[index]).abs());
    let sizes: [T; N] = from_fn(|index| q[index].abs() * weights[index]);
    (in_four_parts(&ways, T::max), in_four_parts(&sizes, T::add))
}

/// The sum of all velocities and accelerations: finite where they are.
#[inline(always)]
fn sum_of_rates<T: Scalar, const N: usize>(qd: &[T; N], qdd: &[T; N]) -> T {
    if T::LANES > 1 {
        let rates = qd.iter().zip(qdd);
        // As in [`way_and_size`].
        return rates.fold(T::constant(0.0), |sum, (rate, change)| sum + (*rate + *change));
    }
    let changes: [T; N] = from_fn(|index| qd[index] + qdd[index]);
    in_four_parts(&changes, T::add)
}

/// All `values` put together by `operation`, in four parts that need not wait for each other; from 0 on.
#[inline(always)]
fn in_four_parts<T: Scalar, const N: usize>(values: &[T; N], operation: impl Fn(T, T) -> T) -> T {
    let mut parts = [T::constant(0.0); 4];
    let (fours, rest) = values.as_chunks::<4>();
    for four in fours {
        parts.iter_mut().zip(four).for_each(|(part, value)| *part = operation(*part, *value));
    }
    parts.iter_mut().zip(rest).for_each(|(part, value)| *part = operation(*part, *value));
    let [a, b, c, d] = parts;
    operation(operation(a, b), operation(c, d))
}

/// Reciprocals of scales.
#[inline(always)]
pub(crate) fn weights<T: Scalar, const N: usize>(scales: &[T; N]) -> [T; N] {
    let mut weights = *scales;
    for weight in &mut weights {
        *weight = T::constant(1.0) / *weight;
    }
    weights
}

/// Whether the second-order term of a coordinate of this scale is less than `most`; false for NaN.
#[inline(always)]
fn trusted<T: Scalar>(term: T, scale: T, most: f64) -> T::Mask {
    term.abs().less(T::constant(most) * scale)
}
