//! Homotopy in time, inputs and parameters from the last regular position, in pieces so small that they keep the assembly.

use core::f64::consts::TAU;

use crate::kinematics::link_lengths;
use crate::kinematics::position::branch_failure;
use crate::linear_algebra::vectors::largest_difference;
use crate::mechanism::{Kinematic, Margin};
use crate::scalar::number::{Real, Scalar};

/// Largest second-order term of a prediction (rad, or reference lengths) from which a step is certain in one piece.
///
/// The third-order term, by which the prediction is off, is less than a tenth of it where coordinates move by some tenths:
/// far less than a quarter of any margin outside the singular zone.
pub(crate) const LARGEST_SECOND_ORDER_TERM: f64 = 0.01;

/// Largest way from a point to the solution that it leads to, in the reference metric, over the margin there.
///
/// By Kantorovich's theorem a Newton step η converges where β κ η ≤ 1/2, and to a point not farther than 2η. Links turn
/// with curvature κ ≤ 1 in the metric and the inverse β is about 2/margin, so that a quarter is the limit: the point is
/// nearer to the solution that it leads to than to where the assemblies meet.
pub(crate) const LARGEST_APPROACH: f64 = 0.25;

/// The same from where nothing leads on for certain: rounding has a part in the prediction.
const LARGEST_APPROACH_INSIDE: f64 = 1.0 / 16.0;

/// The same where the determinant changes its sign, in addition to rounding. Of two assemblies that come as near as μ to each
/// other and do not meet, the other one is off the prediction from margin m by (μ/m)² of m.
const LARGEST_APPROACH_OF_A_PASSAGE: f64 = 1.0 / 64.0;

/// Largest movement of a coordinate in a piece (rad, or reference lengths): its third-order term is below 1e-2.
pub(crate) const LARGEST_PIECE: f64 = 0.35;

/// Largest second-order term of a piece over the margin at its end.
const LARGEST_BEND: f64 = 0.5;

/// Largest third-order term of a piece over the margin at its end: the next one is less, and a prediction that is off by more than the
/// assemblies are apart may lead to the other one, as near to it as one likes.
const LARGEST_TWIST: f64 = 0.25;

/// Largest difference of the slopes at the end of a piece, foreseen and found, over the larger one. Assemblies that cross differ by
/// as much as they have slope, at whatever distance from where they do.
const LARGEST_KINK: f64 = 0.25;

/// Evaluations before the way is given up: a turn takes some twenty pieces of four, a singular position six. Past a place of margin μ where
/// two assemblies do not meet a coordinate turns by half a turn, by ∛μ a piece: a thousand at 1e-6, and as many that are shortened.
pub(crate) const EVALUATIONS: u32 = 30_000;

/// Those of one piece: where the way begins, how long the piece is, its forecast (two), a correction and its end.
pub(crate) const LEAST_EVALUATIONS: u32 = 6;

/// Largest distance of a length from its prediction to its solution, over its movement in the piece. Also the largest Newton step
/// after the first one, over the first one. A link that turns by a radian has a sixth and a tenth, however short it is.
pub(crate) const LARGEST_PART: f64 = 0.25;

/// The same of a step so small that it need not shrink further: some rounding is in it.
const LEAST_PART: f64 = 1.0 / 64.0;

/// Newton steps of a piece. From a quarter of the margin they end in rounding; a piece that does not is halved.
const CORRECTIONS: u32 = 6;

/// A piece over the one before. Drivers may come round again within a long one, and look as if they had not moved.
const LARGEST_GROWTH: f64 = 4.0;

/// Times that an end too near to a singular position is moved: two assemblies that do not meet there allow no other.
const MOST_AIMS: u32 = 3;

/// Halvings from a whole way to where its values differ by their rounding alone.
const BISECTIONS: u32 = 64;

/// Part of a way over which its tangent is taken.
const TANGENT: f64 = 0.25;

/// Part of a piece between the points of its difference quotients, which are all in it. So they are as exact as its prediction.
/// Next to where assemblies cross, their error counts by the inverse margin, and is of the fourth order.
const THIRD: f64 = 1.0 / 3.0;

/// ε^(1/4): rounding leaves ε/m of a position open at margin m, and ε/m² of its slope; where a piece is as long as the margin, a
/// prediction is off by rounding as much as by its own third-order term.
#[inline(always)]
fn balance<R: Real>() -> R {
    R::EPSILON.sqrt().sqrt()
}

/// Margin from which on a position leads to the next one, 4 ε^(1/4) or more; nearer to the singular position it is found from the last such
/// position. Every change of inputs asks: products take the place of roots, and no margin is below 0.
#[inline(always)]
pub(crate) fn leads<R: Real>(margin: R) -> bool {
    let square = margin * margin;
    R::constant(256.0) * R::EPSILON <= square * square
}

/// Largest margin at either end of a piece in which the determinant changes its sign.
fn passes<R: Real>() -> R {
    R::constant(8.0) * balance::<R>()
}

/// [`LARGEST_APPROACH_OF_A_PASSAGE`] with the rounding of difference quotients, some 50 ε/m² at m = [`leads`].
fn approach_of_a_passage<R: Real>() -> R {
    R::constant(LARGEST_APPROACH_OF_A_PASSAGE) + R::constant(3.0) * balance::<R>()
}

/// Square of a Newton step over the margin after which a piece is done: that much of the position is left open, ε^(3/4).
fn closed<R: Real>() -> R {
    let root = balance::<R>();
    root * root * root
}

/// Part of the way that no piece is shorter than: beyond it values of the way differ by their rounding alone.
fn shortest<R: Real>() -> R {
    R::constant(64.0) * R::EPSILON
}

/// `true` if a point at `distance` (in the reference metric) from a solution of `margin` leads to that solution for certain.
#[inline(always)]
pub(crate) fn is_near<R: Real>(distance: R, margin: R) -> bool {
    distance <= R::constant(LARGEST_APPROACH) * margin
}

/// The largest difference of those values that `angles` are the indices of.
#[inline(always)]
pub(crate) fn largest_change<T: Scalar, V: AsRef<[T]>>(angles: &[u16], old: &V, new: &V) -> T {
    let (old, new) = (old.as_ref(), new.as_ref());
    let pairs =
        angles.iter().filter_map(|index| old.get(usize::from(*index)).zip(new.get(usize::from(*index))));
    pairs.fold(T::constant(0.0), |largest, (old, new)| (*new - *old).abs().max(largest))
}

/// Puts those `kept` values that `turning` are the indices of on by as many whole turns as the short way from `before` to `now` goes
/// round: the way of their numbers is then the short one. A value before that is no number counts as the kept one.
pub(crate) fn put_short_way_round<R: Real>(turning: &[u16], kept: &mut [R], before: &[R], now: &[R]) {
    for index in turning.iter().map(|index| usize::from(*index)) {
        let (Some(kept), Some(before), Some(now)) = (kept.get_mut(index), before.get(index), now.get(index))
        else {
            continue;
        };
        let [old, from, to] = [*kept, *before, *now].map(R::to_f64);
        let from = if from.is_finite() { from } else { old };
        let turns = libm::rint((to - from) / TAU);
        if turns.is_finite() && turns != 0.0 {
            *kept = R::constant(old + turns * TAU);
        }
    }
}

/// A position as one before it foresees it.
pub(crate) struct Prediction<R, const N: usize> {
    pub q: [R; N],
    /// Movement by the first-order term, in the reference metric.
    pub first: R,
    /// The second-order term.
    pub second: R,
}

impl<R: Real, const N: usize> Prediction<R, N> {
    /// `true` if a solution of `margin` near the prediction can be in no other assembly.
    pub fn is_certain(&self, margin: R) -> bool {
        let most = R::constant(2.0 * LARGEST_PIECE);
        self.first <= most && self.second <= R::constant(LARGEST_BEND) * margin
    }
}

/// A position with all that it belongs to: time, parameters, inputs and phases.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Anchor<V, R, const N: usize> {
    /// Time (s).
    pub t: R,
    pub q: [R; N],
    /// Values of parameters, inputs and phases.
    pub values: V,
}

/// Homotopy from a regular position to time and inputs of the one that is sought.
pub(crate) struct Homotopy<'a, S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> {
    pub from: &'a Anchor<S::Values, R, N>,
    /// Its values change as the path is followed, and are those of the end before and afterwards.
    pub mechanism: &'a mut S,
    /// Values of the position that is sought.
    pub values: S::Values,
    /// Time (s) at the end.
    pub t: R,
}

/// End of a path as far as it was followed.
pub(crate) struct Followed<R, const N: usize> {
    /// The last position: the end where `share` is 1.
    pub q: [R; N],
    /// Part of the path.
    pub share: R,
    /// Margin there.
    pub margin: R,
    /// Evaluations of rows and Jacobian.
    pub evaluations: u32,
    /// The row that jumps beyond it, if one does.
    pub jump: Option<u16>,
    /// `true` if the evaluations ended before the path did.
    pub spent: bool,
    /// The last position from which the next one can be predicted.
    pub leading: Leading<R, N>,
}

/// A position from which a path may be continued.
#[derive(Clone, Copy)]
pub(crate) struct Leading<R, const N: usize> {
    pub q: [R; N],
    /// Part of the way.
    pub share: R,
    /// Part of the rest to try next.
    pub piece: R,
}

/// Values and time at a place of the path.
struct Station<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> {
    values: S::Values,
    parameters: S::Parameters,
    t: R,
    /// Residuals of the rows there.
    left: [R; M],
}

/// A position on the path.
struct Spot<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> {
    q: [R; N],
    share: R,
    factors: S::Factors,
    /// Residuals of the rows, left by rounding.
    rest: [R; M],
    margin: R,
    orientation: u64,
}

/// Prediction of the next piece from a spot.
struct Forecast<R, const N: usize> {
    /// Position at the end of the piece.
    q: [R; N],
    /// Movement by the slope alone, and the rest of it, in the reference metric.
    first: R,
    second: R,
    /// The term of the third order, in the reference metric.
    third: R,
    /// The same of lengths over their movement.
    third_part: R,
    /// Slope where the piece begins.
    start: [R; N],
    /// Slope at the end.
    slope: [R; N],
    /// Reciprocals of the movements of lengths.
    weights: [R; N],
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Station<S, R, N, M> {
    fn open(&self, mechanism: &S, position: &S::Position) -> [R; M] {
        let mut open = mechanism.phi(&self.parameters, position);
        open.iter_mut().zip(&self.left).for_each(|(residual, left)| *residual = *residual - *left);
        open
    }
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Homotopy<'_, S, R, N, M> {
    /// Follows the path for at most `limit` evaluations; its first piece has at most the length `piece`.
    ///
    /// Solves Φ(q, θ(σ), p(σ), phases(σ), t(σ)) = (1 − σ) Φ(q₀, σ = 0) from σ = 0 to 1. Parameters, inputs, phases and time go
    /// straight from their values at q₀ to the present ones. The right-hand side is rounding, unless the caller has replaced a
    /// function. Source of the method: Allgower & Georg 2003, Introduction to Numerical Continuation Methods, ch. 2 and 6.
    ///
    /// A piece counts if it ends so near to its prediction, and with such a slope, that it can be no other assembly;
    /// else it is shortened. A determinant may change its sign only in a piece that begins and ends next to its zero. So two
    /// assemblies that do not meet there are told from two that do.
    #[cold]
    #[inline(never)]
    pub fn followed(&mut self, piece: R, limit: u32) -> Followed<R, N> {
        let (values, start) = (self.values, self.from.q);
        let mut walk = Walk { way: self, open: [R::constant(0.0); M], evaluations: 0, limit };
        let station = walk.station(R::constant(0.0));
        walk.open = walk.residuals(&station, &start);
        let followed = walk.followed(start, piece);
        self.mechanism.set_values(values);
        followed
    }

    /// Tangent of the path at its start: movement of the coordinates over the whole path at that rate.
    pub fn tangent(&mut self) -> [R; N] {
        let (values, start) = (self.values, self.from.q);
        let mut walk = Walk { way: self, open: [R::constant(0.0); M], evaluations: 0, limit: 0 };
        let station = walk.station(R::constant(0.0));
        walk.open = walk.residuals(&station, &start);
        let at = walk.spot(start, R::constant(0.0));
        let (slope, _) = walk.slope(&at, R::constant(TANGENT));
        self.mechanism.set_values(values);
        slope
    }

    /// Values and time (s) at a `share` of the way.
    pub fn place(&self, share: R) -> (S::Values, R) {
        let mut values = self.values;
        if R::constant(1.0) <= share {
            return (values, self.t);
        }
        for (value, old) in values.as_mut().iter_mut().zip(self.from.values.as_ref()) {
            *value = *old + share * (*value - *old);
        }
        (values, self.from.t + share * (self.t - self.from.t))
    }
}

/// Part of a piece from `at` to `next` after which to end instead, if one of them is too far from the zero of the determinant, or
/// an end on the path so near that nothing leads on from there. The new end is next to that zero: before it if the piece begins
/// farther away, else after it.
fn aimed<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    at: &Spot<S, R, N, M>,
    next: &Spot<S, R, N, M>,
    aims: u32,
) -> Option<R> {
    let next_to = R::constant(0.5) * passes::<R>();
    let passage = at.orientation != next.orientation;
    let fall = if passage { at.margin + next.margin } else { at.margin - next.margin };
    let far = passage && passes::<R>() < at.margin.max(next.margin);
    let near =
        next.share < R::constant(1.0) && !leads(next.margin + next.margin) && leads(at.margin + at.margin);
    if !(far || near && R::constant(0.0) < fall) {
        return None;
    }
    // Where it does not end well behind, the next one begins nearer.
    let before = passes::<R>() < at.margin || aims % 2 == 1 && leads(at.margin);
    let way = if before { at.margin - next_to } else { at.margin + next_to };
    let most = if before { R::constant(0.9) } else { R::constant(LARGEST_GROWTH) };
    Some((way / fall).min(most).max(R::constant(0.02)))
}

/// The length to try instead of `length` if a forecast moves by more than twice the limit of a piece; a `first` that is NaN is
/// too much.
fn shortened<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    at: &Spot<S, R, N, M>,
    first: R,
    length: R,
) -> Option<R> {
    let most = R::constant(LARGEST_PIECE).min(at.margin.abs().sqrt());
    if first <= most + most {
        return None;
    }
    let (shorter, half) = (length * most / first, R::constant(0.5) * length);
    Some(if shorter <= half { shorter.max(length * R::constant(1e-3)) } else { half })
}

/// False for a piece that moves by `first`, no more than rounding, while its margin rises without a passage from where nothing leads on. A
/// way turns back there where two assemblies do not meet; rounding turns back any other.
fn is_resolved<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    at: &Spot<S, R, N, M>,
    next: &Spot<S, R, N, M>,
    first: R,
) -> bool {
    let rises =
        next.orientation == at.orientation && at.margin <= next.margin && !leads(at.margin + at.margin);
    !(const { link_lengths::any(S::COORDINATES) } && rises) || link_lengths::rounding(at.margin) < first
}

/// Length of the piece after one from `at` to `next`, which moved by `first`: limited by the margin and by `growth`.
fn next_piece<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    at: &Spot<S, R, N, M>,
    next: &Spot<S, R, N, M>,
    first: R,
    length: R,
    growth: R,
) -> R {
    let most = R::constant(LARGEST_PIECE).min(next.margin.abs().sqrt());
    let piece = length * (most / first.max(shortest())).min(growth);
    if next.orientation == at.orientation && next.margin < passes() && next.margin < at.margin {
        // Next to where the determinant is 0 if its margin falls as it did: just beyond.
        let slope = (at.margin - next.margin) / length;
        return piece.min((next.margin + R::constant(0.5) * passes()) / slope);
    }
    piece
}

/// −c₂ and −c₃ of c₂ s² + c₃ s³ + c₄ s⁴ from its values at s = 0, 1/3, 2/3 and 1; the first is rounding and in all of them.
const SECOND_ORDER: [f64; 4] = [21.25, -27.0, 6.75, -1.0];
const THIRD_ORDER: [f64; 4] = [-45.0, 67.5, -27.0, 4.5];

/// A linear combination.
fn combined<R: Real, const M: usize>(weights: [R; 4], of: [&[R; M]; 4]) -> [R; M] {
    let mut sum = [R::constant(0.0); M];
    for (weight, values) in weights.into_iter().zip(of) {
        sum.iter_mut().zip(values).for_each(|(sum, value)| *sum = *sum + weight * *value);
    }
    sum
}

/// State of a path that is being followed.
struct Walk<'a, 'b, S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> {
    way: &'a mut Homotopy<'b, S, R, N, M>,
    /// Residuals of the rows at the start of the path.
    open: [R; M],
    evaluations: u32,
    /// Most of them.
    limit: u32,
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Walk<'_, '_, S, R, N, M> {
    /// [`Homotopy::followed`] from `start`.
    fn followed(&mut self, start: [R; N], piece: R) -> Followed<R, N> {
        let (one, half) = (R::constant(1.0), R::constant(0.5));
        let mut at = self.spot(start, R::constant(0.0));
        // One that was tried before is known better.
        let mut piece = if piece < one { piece } else { self.first_piece(&at) };
        let mut leading = Leading { q: start, share: at.share, piece };
        let (mut failed, mut aims) = (piece, 0);
        // A forecast takes two evaluations.
        while at.share < one && self.evaluations.saturating_add(1) < self.limit && shortest::<R>() <= piece {
            let rest = one - at.share;
            let length = piece.min(rest);
            let share = if length < rest { at.share + length } else { one };
            let forecast = self.forecast(&at, length);
            if let Some(shorter) = shortened(&at, forecast.first, length) {
                (piece, failed) = (shorter, length);
                continue;
            }
            let Some((next, growth)) = self.landed(&at, &forecast, share, length) else {
                (piece, failed) = (half * length, length);
                continue;
            };
            if let Some(part) =
                aimed(&at, &next, aims).filter(|_| aims < MOST_AIMS || next.orientation != at.orientation)
            {
                aims += 1;
                (piece, failed) = (part * length, length);
                continue;
            }
            aims = 0;
            piece = next_piece(&at, &next, forecast.first, length, growth);
            (at, failed) = (next, piece);
            if leads(at.margin) {
                leading = Leading { q: at.q, share: at.share, piece };
            }
        }
        let lost = at.share < one && piece < shortest();
        let jump = if lost { self.jump(&at, failed) } else { None };
        let spent = at.share < one && !lost;
        if at.share <= leading.share {
            leading.piece = piece;
        }
        // A part of what is left of the way from there.
        leading.piece = leading.piece / (one - leading.share).max(shortest());
        let Spot { q, share, margin, .. } = at;
        Followed { q, share, margin, evaluations: self.evaluations, jump, spent, leading }
    }

    fn is_spent(&self) -> bool {
        self.limit <= self.evaluations
    }

    /// Length of the first piece, from the slope over a short one.
    fn first_piece(&mut self, at: &Spot<S, R, N, M>) -> R {
        self.evaluations = self.evaluations.saturating_add(1);
        let (slope, _) = self.slope(at, balance());
        let most = R::constant(LARGEST_PIECE).min(at.margin.abs().sqrt());
        let piece = most / self.size(&slope).max(most);
        if piece.is_finite() { piece } else { balance() }
    }

    fn station(&mut self, share: R) -> Station<S, R, N, M> {
        let (values, t) = self.way.place(share);
        self.way.mechanism.set_values(values);
        let parameters = self.way.mechanism.parameters();
        let left = self.open.map(|residual| (R::constant(1.0) - share) * residual);
        Station { values, parameters, t, left }
    }

    /// The mechanism at a station, with its position there.
    fn position(&mut self, station: &Station<S, R, N, M>, q: &[R; N]) -> (&S, S::Position) {
        self.way.mechanism.set_values(station.values);
        (self.way.mechanism, self.way.mechanism.position(&station.parameters, q, station.t))
    }

    fn residuals(&mut self, station: &Station<S, R, N, M>, q: &[R; N]) -> [R; M] {
        let (mechanism, position) = self.position(station, q);
        station.open(mechanism, &position)
    }

    /// Position `q` at a `share` of the way, with its factors.
    fn spot(&mut self, q: [R; N], share: R) -> Spot<S, R, N, M> {
        self.evaluations = self.evaluations.saturating_add(1);
        let station = self.station(share);
        let (mechanism, position) = self.position(&station, &q);
        let (factors, Margin { value: margin, orientation, .. }) =
            mechanism.factorize(&station.parameters, &position);
        let rest = station.open(mechanism, &position);
        let orientation = orientation.as_ref().first().copied().unwrap_or(0);
        Spot { q, share, factors, rest, margin, orientation }
    }

    /// dq/dσ at a spot, by a one-sided difference quotient over `length`, and the stations that it was taken at.
    fn slope(&mut self, at: &Spot<S, R, N, M>, length: R) -> ([R; N], [Station<S, R, N, M>; 3]) {
        let third = R::constant(THIRD) * length;
        let stations = [third, third + third, length].map(|ahead| self.station(at.share + ahead));
        let [one, two, three] = stations.each_ref().map(|station| self.residuals(station, &at.q));
        let weights = [-11.0, 18.0, -9.0, 2.0].map(|weight| R::constant(-weight / 6.0) / third);
        let rate = combined(weights, [&at.rest, &one, &two, &three]);
        (self.way.mechanism.solve_linear(&at.factors, &rate), stations)
    }

    /// Taylor's polynomial of the third order: the slope, then the curvature from the residuals of the rows along it, then the
    /// term from those along the parabola. Counts as two evaluations.
    fn forecast(&mut self, at: &Spot<S, R, N, M>, length: R) -> Forecast<R, N> {
        self.evaluations = self.evaluations.saturating_add(2);
        let (slope, stations) = self.slope(at, length);
        let third = R::constant(THIRD) * length;
        let along = |times: R| {
            let mut q = at.q;
            q.iter_mut().zip(slope).for_each(|(coordinate, rate)| *coordinate = *coordinate + times * rate);
            q
        };
        let [first, second, last] = &stations;
        let one = self.residuals(first, &along(third));
        let two = self.residuals(second, &along(third + third));
        let three = self.residuals(last, &along(length));
        // Half the second derivative times the square of three thirds.
        let weights = [2.0, -5.0, 4.0, -1.0].map(|weight| R::constant(-4.5 * weight));
        let right = combined(weights, [&at.rest, &one, &two, &three]);
        let mut bend = self.way.mechanism.solve_linear(&at.factors, &right);
        let more = self.beyond_parabola(at, &stations, [&slope, &bend], length, SECOND_ORDER);
        bend.iter_mut().zip(more).for_each(|(bend, more)| *bend = *bend + more);
        let twist = self.beyond_parabola(at, &stations, [&slope, &bend], length, THIRD_ORDER);
        let mut q = along(length);
        let mut tip = slope;
        let (twice, thrice) = (R::constant(2.0) / length, R::constant(3.0) / length);
        let terms = bend.iter().zip(&twist);
        for ((q, rate), (bend, twist)) in q.iter_mut().zip(&mut tip).zip(terms) {
            *q = *q + *bend + *twist;
            *rate = *rate + twice * *bend + thrice * *twist;
        }
        let first = self.size(&slope) * length;
        let scales = self.way.mechanism.coordinate_scales(&stations[2].parameters);
        let straight = slope.map(|rate| length * rate);
        let points = const { link_lengths::points(S::COORDINATES) };
        let weights = link_lengths::weights(&points, &scales, [&straight, &bend], at.margin);
        let (second, third) = (self.size(&bend), self.size(&twist));
        let third_part = link_lengths::weighted(&twist, &weights);
        Forecast { q, first, second, third, third_part, start: slope, slope: tip, weights }
    }

    /// Term at the end of a piece of `length` from the residuals of the rows along a parabola, with the `weights` of its order.
    ///
    /// `parabola`: slope, and the second-order term at the end. Difference quotients leave c₂ s² of the second order there in
    /// addition to c₃ s³ + c₄ s⁴. Where the piece is as long as the margin, c₂ over the margin counts as much as the third-order
    /// term.
    fn beyond_parabola(
        &mut self,
        at: &Spot<S, R, N, M>,
        [first, second, last]: &[Station<S, R, N, M>; 3],
        [slope, bend]: [&[R; N]; 2],
        length: R,
        weights: [f64; 4],
    ) -> [R; N] {
        let along = |part: R| {
            let mut q = at.q;
            q.iter_mut().zip(slope).zip(bend).for_each(|((coordinate, slope), bend)| {
                *coordinate = *coordinate + part * (length * *slope + part * *bend);
            });
            q
        };
        let one = self.residuals(first, &along(R::constant(THIRD)));
        let two = self.residuals(second, &along(R::constant(2.0 * THIRD)));
        let three = self.residuals(last, &along(R::constant(1.0)));
        let right = combined(weights.map(R::constant), [&at.rest, &one, &two, &three]);
        self.way.mechanism.solve_linear(&at.factors, &right)
    }

    /// The spot at `share` that a piece of `length` from `at` leads to, if it is certain, and how much longer the next one may be.
    fn landed(
        &mut self,
        at: &Spot<S, R, N, M>,
        forecast: &Forecast<R, N>,
        share: R,
        length: R,
    ) -> Option<(Spot<S, R, N, M>, R)> {
        let (q, off) = self.corrected(forecast, share)?;
        let mut way = q;
        way.iter_mut().zip(&forecast.q).for_each(|(way, from)| *way = *way - *from);
        let part = link_lengths::weighted(&way, &forecast.weights);
        if self.is_spent() {
            return None;
        }
        let next = self.spot(q, share);
        if !self.holds(&q, share) {
            return None;
        }
        let passage = next.orientation != at.orientation;
        // One that begins or ends too far away is not taken, but shows where the next one is to end.
        let tight = passage && at.margin.max(next.margin) <= passes();
        let approach = match (tight, leads(at.margin + at.margin)) {
            (true, _) => approach_of_a_passage(),
            (_, true) => R::constant(LARGEST_APPROACH),
            _ => R::constant(LARGEST_APPROACH_INSIDE),
        };
        let parts = [approach, R::constant(LARGEST_BEND), R::constant(LARGEST_TWIST)];
        let allowed = parts.map(|part| part * next.margin);
        let most_part = if tight { approach } else { R::constant(LARGEST_PART) };
        // Written so that NaN is not near.
        let near = off <= allowed[0] && forecast.second <= allowed[1] && forecast.third <= allowed[2];
        let foreseen = part <= most_part && forecast.third_part <= R::constant(LARGEST_PART);
        if !(near && foreseen && is_resolved(at, &next, forecast.first)) {
            return None;
        }
        // What is beyond a forecast's second order grows with the third power of the length at least.
        let ratio = (off / allowed[0]).max(forecast.second / allowed[1]).max(forecast.third / allowed[2]);
        let growth = R::constant(0.8) * ratio.max(shortest()).powf(R::constant(-THIRD));
        // Nearer to a singular position the difference quotients are no slope.
        let square = forecast.first * forecast.first;
        if leads(R::constant(8.0) * next.margin) && square <= R::constant(4.0) * next.margin {
            let (slope, _) = self.slope(&next, -length);
            let mut kink = slope;
            kink.iter_mut().zip(&forecast.slope).for_each(|(rate, foreseen)| *rate = *rate - *foreseen);
            let largest = self.size(&slope).max(self.size(&forecast.slope));
            let smooth = self.size(&kink) <= R::constant(LARGEST_KINK) * largest;
            if !smooth && next.margin < forecast.first
                || !self.turns_little(forecast, &slope, length, next.margin)
            {
                return None;
            }
        }
        Some((next, growth.min(R::constant(LARGEST_GROWTH))))
    }

    /// `true` if the declared branches hold at `q` (N). Where two assemblies come nearer to each other than a piece is long, a
    /// step may jump to the other one; the branches detect it.
    fn holds(&mut self, q: &[R; N], share: R) -> bool {
        if S::BRANCHES.is_empty() {
            return true;
        }
        let station = self.station(share);
        let (mechanism, position) = self.position(&station, q);
        branch_failure(mechanism, &station.parameters, &position, station.t, false).is_none()
    }

    /// Newton's method from a `prediction` at a `share` of the path, if it ends nearby, with its distance from there.
    fn corrected(&mut self, forecast: &Forecast<R, N>, share: R) -> Option<([R; N], R)> {
        let station = self.station(share);
        let scales = self.way.mechanism.coordinate_scales(&station.parameters);
        let prediction = &forecast.q;
        let (mut q, mut most) = (*prediction, R::constant(LARGEST_PART));
        for _ in 0..CORRECTIONS {
            if self.is_spent() {
                return None;
            }
            self.evaluations = self.evaluations.saturating_add(1);
            let (mechanism, position) = self.position(&station, &q);
            let (factors, margin) = mechanism.factorize(&station.parameters, &position);
            let step = mechanism.solve_linear(&factors, &station.open(mechanism, &position));
            q.iter_mut().zip(&step).for_each(|(coordinate, change)| *coordinate = *coordinate - *change);
            let off = largest_difference(&q, prediction, &scales);
            let part = link_lengths::weighted(&step, &forecast.weights);
            // Written so that NaN is not near.
            let near = off <= margin.value && part <= most;
            if !near {
                return None;
            }
            most = most.min((R::constant(LARGEST_PART) * part).max(R::constant(LEAST_PART)));
            let last = largest_difference(&step, &[R::constant(0.0); N], &scales);
            if last * last <= closed::<R>() * margin.value {
                return Some((q, off));
            }
        }
        None
    }

    /// `true` if the rates of lengths at the end of a piece are those predicted.
    fn turns_little(&self, forecast: &Forecast<R, N>, slope: &[R; N], length: R, margin: R) -> bool {
        let mut change = forecast.slope;
        change.iter_mut().zip(&forecast.start).for_each(|(tip, start)| *tip = (*tip - *start) / length);
        let scales = self.way.mechanism.coordinate_scales(&self.way.mechanism.parameters());
        let points = const { link_lengths::points(S::COORDINATES) };
        let least = link_lengths::rounding(margin);
        link_lengths::turn_little((&points, &scales), [&forecast.start, &change, slope], length, least)
    }

    /// The row that jumps within `failed` after a spot, if one does. The interval is halved until values of the path differ by
    /// their rounding alone: the place of the largest change then holds all of the change.
    fn jump(&mut self, at: &Spot<S, R, N, M>, failed: R) -> Option<u16> {
        let one = R::constant(1.0);
        let mut ends = [at.share, (at.share + failed + failed).min(one)];
        let mut row = None;
        for _ in 0..BISECTIONS {
            let middle = R::constant(0.5) * (ends[0] + ends[1]);
            if ends[1] - ends[0] <= shortest::<R>() {
                break;
            }
            if self.limit < self.evaluations.saturating_add(4) {
                return None;
            }
            let [first, second] = [[ends[0], middle], [middle, ends[1]]].map(|ends| self.change(at, ends));
            let (half, changed) =
                if first.1 < second.1 { ([middle, ends[1]], second) } else { ([ends[0], middle], first) };
            (ends, row) = (half, Some(changed.0));
        }
        let wide = (ends[1] - ends[0]) * R::constant(4.0);
        let around = [(ends[0] - wide).max(R::constant(0.0)), (ends[1] + wide).min(one)];
        let [near, far] = [ends, around].map(|ends| self.change(at, ends).1);
        // What is continuous changes several times as much over nine times the way.
        row.filter(|_| R::EPSILON.sqrt() < near && far <= near + near)
    }

    /// The row that changes most between two places of the way at the position of a spot, and by how much in the reference metric.
    fn change(&mut self, at: &Spot<S, R, N, M>, ends: [R; 2]) -> (u16, R) {
        self.evaluations = self.evaluations.saturating_add(1);
        let [from, to] = ends.map(|share| self.station(share));
        let scales = self.way.mechanism.row_scales(&from.parameters);
        let [from, to] = [from, to].map(|station| self.residuals(&station, &at.q));
        let changes =
            from.iter().zip(&to).zip(&scales).map(|((from, to), scale)| ((*to - *from) / *scale).abs());
        let none = (0, R::constant(0.0));
        (0_u16..)
            .zip(changes)
            .fold(none, |most, (row, change)| if most.1 < change { (row, change) } else { most })
    }

    fn size(&self, difference: &[R; N]) -> R {
        let scales = self.way.mechanism.coordinate_scales(&self.way.mechanism.parameters());
        largest_difference(difference, &[R::constant(0.0); N], &scales)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_is_not_near() {
        let nan = f64::NAN;
        assert!(is_near(0.01, 0.1) && !is_near(0.03, 0.1));
        assert!(
            !is_near(nan, 0.1) && !is_near(0.01, nan) && !is_near(nan, nan) && !is_near(f64::INFINITY, 1.0)
        );
    }
}
