//! Fast path of a step, scalar or SIMD: unguarded Newton's method, with all acceptance tests at the end.

use core::array::from_fn;

use crate::block_solvers::convergence::Statistics;
use crate::block_solvers::fast_newton::{FINE, FastNewton};
use crate::kinematics::homotopy::LARGEST_SECOND_ORDER_TERM;
use crate::kinematics::link_lengths;
use crate::linear_algebra::parts::at;
use crate::mechanism::margin::Margin;
use crate::mechanism::{Kinematic, negated};
use crate::scalar::lanes::REGISTER;
use crate::scalar::number::{Real, Scalar, index};
use crate::stepper::instant::{coarse_from, is_coarse};
use crate::tolerances::{positions, singular};

/// Most coordinates that stay in registers from the end of a step to its state, which are written one by one.
pub(crate) const FEW: usize = 8;

/// Second-order term (reference lengths) from which on a step of a mechanism with coordinates that are lengths is checked. With
/// less, no link of a thousandth turns by half a radian.
pub(super) const QUICK_SECOND_ORDER_TERM: f64 = 1e-4;

/// Second-order term, and distance from the prediction over the margin, up to which a step needs no test, `with_lengths` among
/// the coordinates or without.
#[inline(always)]
pub(crate) fn quick<R: Real>(with_lengths: bool) -> [f64; 2] {
    if with_lengths {
        return [QUICK_SECOND_ORDER_TERM, positions::QUICK_APPROACH.of::<R>().to_f64()];
    }
    [LARGEST_SECOND_ORDER_TERM, link_lengths::APPROACH_OF_ANGLES]
}

/// State at the start of a step, solved in every lane.
pub(crate) struct Start<'a, T, const N: usize> {
    pub t: T,
    pub q: &'a [T; N],
    pub qd: &'a [T; N],
    pub qdd: &'a [T; N],
    pub margin: T,
    /// Reciprocals of the coordinates' scales in the reference metric.
    pub weights: &'a [T; N],
}

/// Result of a step.
///
/// Never borrowed during the step, so that it stays in registers. In the state that it becomes every
/// number is written once.
#[derive(Clone, Copy)]
pub(crate) struct FastStep<T: Scalar, const N: usize> {
    pub q: [T; N],
    pub qd: [T; N],
    pub qdd: [T; N],
    pub margin: T,
    pub orientation: T::Lanes<u64>,
    /// Distance from the prediction, in the reference metric.
    pub correction: T,
    /// Largest |residual| over its tolerance.
    pub residual: T,
    /// Index in Φ of its row, in several lanes.
    pub row: T,
    /// Index in Φ of its row, in one lane.
    row_alone: u16,
    evaluations: u32,
    /// Those of each lane, where there are several.
    counts: T,
    /// Lanes whose step leaves nothing to ask but a passage; [`judgement`](Self::judgement) tells of the others.
    pub quick: T::Mask,
    /// Lanes in which every block closed, on their branches, within their limits, and regular where they began.
    pub(super) held: T::Mask,
    /// The sum of the coordinates' sizes in the reference metric, where rates and factors are finite; NaN elsewhere.
    pub(super) size: T,
    /// `false` in a single lane whose blocks need pivoting: nothing else is of use, and [`in_stages`](Self::in_stages) solves.
    pub ordered: bool,
}

impl<T: Scalar, const N: usize> FastStep<T, N> {
    /// Solves position, velocity and acceleration at `t` from the prediction q + h q̇ + h²/2 q̈.
    ///
    /// Not plain is a step from or into the singular zone, one too long to be foreseen, and one that does not converge or is not
    /// finite. Nor is one that ends so far from the prediction that it may be in another assembly, violates a branch or leaves a
    /// limit, nor any outside `lanes`. A passage is plain here. `WAY`: see [`FastNewton`].
    #[inline(always)]
    pub(crate) fn of<S: Kinematic<T, N, M>, const M: usize, const WAY: u8>(
        mechanism: &S,
        parameters: &S::Parameters,
        start: &Start<'_, T, N>,
        t: T,
        lanes: T::Mask,
    ) -> Self {
        let scales = mechanism.coordinate_scales(parameters);
        let [most_second, _] = quick::<T::Real>(const { link_lengths::any(S::COORDINATES) });
        let (prediction, foreseen) = start.predicted(t, &scales, most_second);
        Self::from_prediction::<S, M, WAY>((mechanism, parameters), start, (&prediction, foreseen), t, lanes)
    }

    /// The step from its prediction, and the lanes where its second-order term is small. Of `start` margin and weights are read alone.
    #[inline(always)]
    pub(crate) fn from_prediction<S: Kinematic<T, N, M>, const M: usize, const WAY: u8>(
        (mechanism, parameters): (&S, &S::Parameters),
        start: &Start<'_, T, N>,
        (prediction, foreseen): (&[T; N], T::Mask),
        t: T,
        lanes: T::Mask,
    ) -> Self {
        let [_, most_way] = quick::<T::Real>(const { link_lengths::any(S::COORDINATES) });
        let most_way = T::constant(most_way);
        // Block after block, rates keep a processor busy that waits for the next position. More lanes than fill a register do so as
        // they are, and a compiler sees them together in short stages. Each way is judged where it ends: what both had to put down for
        // one judge would be copied.
        if const { S::BLOCK_BY_BLOCK && (T::LANES == 1 || size_of::<T>() <= REGISTER) } {
            let zeros = [T::constant(0.0); N];
            let (mut motion, mut solver) =
                ([*prediction, zeros, zeros], FastNewton::<T, WAY>::finer(lanes, start.finer::<WAY>()));
            let solved = &mechanism.solve_motion(parameters, &mut motion, t, &mut solver);
            // No way leads to other code in one lane: what it needed would be put down for it.
            if const { T::LANES == 1 || !S::HAS_ORDERS } || T::all(solved.ordered | !lanes) {
                let sum = solved.sum + sum_of_rates(&motion[1], &motion[2]);
                let judge = Judge { mechanism, parameters, start, prediction, foreseen, most_way, solver };
                let mut step = judge.judged(motion, (&solved.position, &solved.margin), sum);
                if T::LANES == 1 {
                    (step.ordered, step.quick) = (T::all(solved.ordered), step.quick & solved.ordered);
                }
                return step;
            }
            // The addresses of copies.
            let (prediction, t, foreseen) = (*prediction, t, foreseen);
            return Self::by_stages::<S, M, WAY>(
                (mechanism, parameters),
                start,
                (&prediction, foreseen),
                &t,
                lanes,
            );
        }
        Self::in_stages::<S, M, WAY>((mechanism, parameters), start, (prediction, foreseen), t, lanes)
    }

    /// [`in_stages`](Self::in_stages), out of the way.
    #[cold]
    #[inline(never)]
    fn by_stages<S: Kinematic<T, N, M>, const M: usize, const WAY: u8>(
        mechanism: (&S, &S::Parameters),
        start: &Start<'_, T, N>,
        prediction: (&[T; N], T::Mask),
        t: &T,
        lanes: T::Mask,
    ) -> Self {
        Self::in_stages::<S, M, WAY>(mechanism, start, prediction, *t, lanes)
    }

    /// The step from its prediction, all positions before all rates; with pivoting where a block asks for it.
    #[inline(always)]
    pub(crate) fn in_stages<S: Kinematic<T, N, M>, const M: usize, const WAY: u8>(
        (mechanism, parameters): (&S, &S::Parameters),
        start: &Start<'_, T, N>,
        (prediction, foreseen): (&[T; N], T::Mask),
        t: T,
        lanes: T::Mask,
    ) -> Self {
        let [_, most_way] = quick::<T::Real>(const { link_lengths::any(S::COORDINATES) });
        let most_way = T::constant(most_way);
        let (mut q, mut solver) = (*prediction, FastNewton::<T, WAY>::finer(lanes, start.finer::<WAY>()));
        // By reference: what is long would be moved out of the pairs.
        let (_, position) = &mechanism.solve_with_position(parameters, &mut q, t, &mut solver);
        let (factors, margin) = &mechanism.factorize(parameters, position);
        let qd = mechanism.solve_linear(factors, &negated(mechanism.phi_t(parameters, position)));
        let qdd = mechanism.solve_linear(factors, &mechanism.gamma(parameters, position, &qd));
        let sum = sum_of_rates(&qd, &qdd);
        let judge = Judge { mechanism, parameters, start, prediction, foreseen, most_way, solver };
        judge.judged([q, qd, qdd], (position, margin), sum)
    }

    /// Effort and residual of the step in lane `lane`; `passed`: a singular position lies before it.
    #[inline(always)]
    pub(crate) fn statistics(&self, lane: usize, passed: bool) -> Statistics {
        Statistics {
            evaluations: self.evaluations,
            fallback: false,
            residual_over_tolerance: self.residual.lane(lane).to_f64(),
            row: if T::LANES > 1 { index(self.row, lane) } else { self.row_alone },
            correction: self.correction.lane(lane).to_f64(),
            passed,
        }
    }

    /// Evaluations of residual and Jacobian until each lane closed, the most of any block: numbers, written like the others.
    #[inline(always)]
    pub(crate) fn evaluations(&self) -> T {
        if T::LANES > 1 { self.counts } else { T::constant(f64::from(self.evaluations)) }
    }

    /// Signs of the blocks' determinants of lane `lane`.
    #[inline(always)]
    pub(crate) fn orientation(&self, lane: usize) -> u64 {
        self.orientation.as_ref().get(lane).copied().unwrap_or(0)
    }
}

/// Data by which a step is judged.
struct Judge<'a, S: Kinematic<T, N, M>, T: Scalar, const N: usize, const M: usize, const WAY: u8> {
    mechanism: &'a S,
    parameters: &'a S::Parameters,
    start: &'a Start<'a, T, N>,
    prediction: &'a [T; N],
    /// Lanes whose prediction has a second-order term so small that no link can have turned far.
    foreseen: T::Mask,
    /// Largest distance from the prediction, over the margin, that needs no further test.
    most_way: T,
    solver: FastNewton<T, WAY>,
}

impl<S: Kinematic<T, N, M>, T: Scalar, const N: usize, const M: usize, const WAY: u8>
    Judge<'_, S, T, N, M, WAY>
{
    /// The step that ends at `motion` (q, q̇, q̈), with its tests; `sum`: finite where rates and factors are.
    #[inline(always)]
    fn judged(
        self,
        [q, qd, qdd]: [[T; N]; 3],
        (position, margin): (&S::Position, &Margin<T>),
        sum: T,
    ) -> FastStep<T, N> {
        let (correction, size) = way_and_size(&q, self.prediction, self.start.weights);
        // Written so that NaN is not quick. A sum is finite and small where its terms are; where it is not, a careful step
        // looks at them one by one.
        let size = size + T::constant(0.0) * sum;
        let mut held = self.solver.closed;
        // A single mechanism is asked before its step.
        if T::LANES > 1 {
            held = held & singular::ZONE.of::<T>().less(self.start.margin);
        }
        for (index, branch) in self.mechanism.branches(self.parameters, position).as_ref().iter().enumerate()
        {
            if !S::BRANCHES_AT_START.get(index).copied().unwrap_or(false) {
                held = held & T::constant(0.0).less(*branch);
            }
        }
        for limit in self.mechanism.limits(self.parameters, position).as_ref() {
            held = held & limit.low.less(limit.value) & limit.value.less(limit.high);
        }
        let few = size.less(largest_size()) & !is_coarse(self.solver.ratio, margin.value);
        // The limits of a quick step are within those of a plain one. Products are compared by one comparison for two: both are
        // less than that of the margin.
        let zone = self.most_way * singular::ZONE.of::<T>();
        let near = correction.max(zone).less(self.most_way * margin.value);
        let quick = held & self.foreseen & few & near;
        FastStep {
            q,
            qd,
            qdd,
            margin: margin.value,
            orientation: margin.orientation,
            correction,
            residual: self.solver.ratio,
            row: self.solver.row,
            row_alone: self.solver.row_alone,
            evaluations: self.solver.evaluations,
            counts: self.solver.counts,
            quick,
            held,
            size,
            ordered: true,
        }
    }
}

impl<'a, T: Scalar, const N: usize> Start<'a, T, N> {
    /// q, q̇, q̈.
    #[inline(always)]
    pub(super) fn rates(&self) -> [&'a [T; N]; 3] {
        [self.q, self.qd, self.qdd]
    }

    /// Part of a row's tolerance within which a single step must close, where the whole tolerance would be seen in its accelerations.
    /// The margin at its end, by which it is judged, may be a tenth less.
    #[inline(always)]
    fn finer<const WAY: u8>(&self) -> Option<T> {
        if const { WAY != FINE || T::LANES > 1 } {
            return None;
        }
        let part = coarse_from(T::constant(0.9) * self.margin);
        T::all(part.less(T::constant(1.0))).then_some(part)
    }

    /// q + h q̇ + h²/2 q̈, and the lanes in which the last term is less than `most` reference lengths (or rad).
    #[inline(always)]
    pub(crate) fn predicted(&self, t: T, scales: &[T; N], most: f64) -> ([T; N], T::Mask) {
        let h = t - self.t;
        let half_square = T::constant(0.5) * h * h;
        let alone = size_of::<T>() == size_of::<T::Real>();
        if const { N > FEW } && alone {
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
                // The address of a copy: scales that are numbers of the text stay such where they are used.
                let scales = *scales;
                let (predicted, _) = predicted_far(self.rates(), h, &scales, most);
                return (predicted, T::mask(false));
            }
            all = all & trusted;
            *coordinate = first + second;
            if const { N > FEW } {
                T::side_by_side();
            }
        }
        (predicted, all)
    }

    /// [`predicted`](Self::predicted) for so many coordinates that the last step has stored them together, after all blocks.
    /// They are loaded as they were written, and without decisions several at once.
    #[inline(always)]
    fn predicted_side_by_side(&self, h: T, scales: &[T; N], most: f64) -> ([T; N], T::Mask) {
        let half_square = T::constant(0.5) * h * h;
        let mut all = T::mask(true);
        for (acceleration, scale) in self.qdd.iter().zip(scales) {
            all = all & trusted(half_square * *acceleration, *scale, most);
        }
        let mut predicted = *self.q;
        for ((coordinate, rate), acceleration) in predicted.iter_mut().zip(self.qd).zip(self.qdd) {
            *coordinate = *coordinate + h * *rate + half_square * *acceleration;
        }
        (predicted, all)
    }
}

/// The prediction of a coordinate (its value, rate and acceleration) of this `scale` after `h`, and the lanes in which its second-order
/// term is less than `most`.
#[inline(always)]
pub(crate) fn foreseen<T: Scalar>(
    [place, rate, acceleration]: [T; 3],
    h: T,
    scale: T,
    most: f64,
) -> (T, T::Mask) {
    let second = T::constant(0.5) * h * h * acceleration;
    (place + h * rate + second, trusted(second, scale, most))
}

/// The prediction from q, q̇ and q̈ where its second-order term is not small in a lane: lanes where it is small enough to be one, and
/// those where it is less than `most`.
#[cold]
#[inline(never)]
fn predicted_far<T: Scalar, const N: usize>(
    [q, qd, qdd]: [&[T; N]; 3],
    h: T,
    scales: &[T; N],
    most: f64,
) -> ([T; N], [T::Mask; 2]) {
    let half_square = T::constant(0.5) * h * h;
    let mut predicted = *q;
    let (mut all, mut near) = (T::mask(true), T::mask(true));
    for ((coordinate, (rate, acceleration)), scale) in
        predicted.iter_mut().zip(qd.iter().zip(qdd)).zip(scales)
    {
        let second = half_square * *acceleration;
        all = all & trusted(second, *scale, LARGEST_SECOND_ORDER_TERM);
        near = near & trusted(second, *scale, most);
        *coordinate = *coordinate + h * *rate + second;
    }
    (predicted, [all, near])
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
    // Each number from its place: copies that are changed one by one would be written and loaded again.
    let ways: [T; N] = from_fn(|index| ((at(q, index) - at(predicted, index)) * at(weights, index)).abs());
    let sizes: [T; N] = from_fn(|index| at(q, index).abs() * at(weights, index));
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
    let changes: [T; N] = from_fn(|index| at(qd, index) + at(qdd, index));
    in_four_parts(&changes, T::add)
}

/// All `values` put together by `operation`, in four parts that need not wait for each other; 0 for none.
#[inline(always)]
fn in_four_parts<T: Scalar, const N: usize>(values: &[T; N], operation: impl Fn(T, T) -> T) -> T {
    let mut parts = [T::constant(0.0); 4];
    parts.iter_mut().zip(values).for_each(|(part, value)| *part = *value);
    let (fours, rest) = values.as_chunks::<4>();
    for four in fours.iter().skip(1) {
        parts.iter_mut().zip(four).for_each(|(part, value)| *part = operation(*part, *value));
    }
    if !fours.is_empty() {
        parts.iter_mut().zip(rest).for_each(|(part, value)| *part = operation(*part, *value));
    }
    let [a, b, c, d] = parts;
    operation(operation(a, b), operation(c, d))
}

/// `true` if the second-order term of a coordinate of this scale is less than `most`; false for NaN.
#[inline(always)]
pub(super) fn trusted<T: Scalar>(term: T, scale: T, most: f64) -> T::Mask {
    term.abs().less(T::constant(most) * scale)
}

/// Sum of the coordinates' sizes in the reference metric up to which their rounding leaves digits enough.
#[inline(always)]
pub(super) fn largest_size<T: Scalar>() -> T {
    T::splat(positions::COARSEST_RESOLUTION.of::<T::Real>() / T::Real::EPSILON)
}
