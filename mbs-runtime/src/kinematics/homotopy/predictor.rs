//! Predictor of the homotopy: a polynomial of the third order from difference quotients along the path.

use crate::kinematics::homotopy::walk::{Spot, Station, Walk};
use crate::kinematics::link_lengths;
use crate::mechanism::Kinematic;
use crate::scalar::number::Real;
use crate::tolerances::positions;

/// Part of a piece between the points of its difference quotients, which are all in it. So they are as exact as its prediction.
/// Next to where assemblies cross, their error counts by the inverse margin, and is of the fourth order.
pub(super) const THIRD: f64 = 1.0 / 3.0;

/// −c₂ and −c₃ of c₂ s² + c₃ s³ + c₄ s⁴ from its values at s = 0, 1/3, 2/3 and 1; the first is rounding and in all of them.
const SECOND_ORDER: [f64; 4] = [21.25, -27.0, 6.75, -1.0];
const THIRD_ORDER: [f64; 4] = [-45.0, 67.5, -27.0, 4.5];

/// Part of a piece at which its drives are looked at between the thirds, and the weights of the cubic through those there.
const PROBE: f64 = 0.382;
const AT_PROBE: [f64; 4] = [-0.038_527_356, 0.907_240_068, 0.155_101_932, -0.023_814_644];

/// Largest part of the way of drives in a third of a piece that is beyond a parabola: that of a crank which turns by 1.5 rad.
const LARGEST_TURN: f64 = 0.25;

/// Prediction of the next piece from a spot.
pub(super) struct Forecast<R, const N: usize> {
    /// Position at the end of the piece.
    pub(super) q: [R; N],
    /// Movement by the slope alone, and the rest of it, in the reference metric.
    pub(super) first: R,
    pub(super) second: R,
    /// The term of the third order, in the reference metric.
    pub(super) third: R,
    /// The same of lengths over their movement.
    pub(super) third_part: R,
    /// Slope where the piece begins.
    pub(super) start: [R; N],
    /// Slope at the end.
    pub(super) slope: [R; N],
    /// Reciprocals of the movements of lengths.
    pub(super) weights: [R; N],
    /// Distances of points from the forecast that others cause, at their first coordinates.
    pub(super) caused: [R; N],
    /// `true` if what drives the rows turns little on the way.
    pub(super) drives_little: bool,
}

/// A linear combination.
fn combined<R: Real, const M: usize>(weights: [R; 4], of: [&[R; M]; 4]) -> [R; M] {
    let mut sum = [R::constant(0.0); M];
    for (weight, values) in weights.into_iter().zip(of) {
        sum.iter_mut().zip(values).for_each(|(sum, value)| *sum = *sum + weight * *value);
    }
    sum
}

/// `true` if the rows, opened by their drives alone, open nearly along a parabola, or by rounding (to a hundredth). `open`: residuals (M) at the ends of the
/// thirds of a piece, `probed`: at [`PROBE`] of it; `scales`: those of the rows.
///
/// A crank that turns by φ in a piece has (2 sin(φ/6))² of its way in a third beyond the parabola. No Jacobian is in it: a short crank is
/// told where rounding over the margin hides the movement of its end. One that turns by as many turns as there are thirds is told between.
fn drives_turn_little<R: Real, const M: usize>(open: [&[R; M]; 4], probed: &[R; M], scales: &[R; M]) -> bool {
    let (mut way, mut beyond) = (R::constant(0.0), R::constant(0.0));
    let foreseen = combined(AT_PROBE.map(R::constant), open);
    let [zero, one, two, three] = open;
    let ends = zero.iter().zip(one).zip(two.iter().zip(three));
    for ((((zero, one), (two, three)), scale), (probed, foreseen)) in
        ends.zip(scales).zip(probed.iter().zip(&foreseen))
    {
        let parts = [*one - *zero, *two - *one, *three - *two, *probed - *zero].map(|part| part / *scale);
        way = parts.iter().fold(way, |way, part| way.max(part.abs()));
        let third = parts[2] - parts[1] - (parts[1] - parts[0]);
        beyond = beyond.max(third.abs()).max(((*probed - *foreseen) / *scale).abs());
    }
    // Written so that NaN is no little turn.
    way <= positions::ROUNDED_MOVEMENT.of() || beyond <= R::constant(LARGEST_TURN) * way
}

/// Stations at the thirds of a piece.
type Thirds<S, R, const N: usize, const M: usize> = [Station<S, R, N, M>; 3];

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Walk<'_, '_, S, R, N, M> {
    /// dq/dσ at a spot, by a one-sided difference quotient over `length`, and the stations that it was taken at.
    pub(super) fn slope(&mut self, at: &Spot<S, R, N, M>, length: R) -> ([R; N], Thirds<S, R, N, M>) {
        let (slope, stations, _) = self.slope_and_openings(at, length);
        (slope, stations)
    }

    /// [`slope`](Self::slope), with the residuals of the rows at its stations.
    fn slope_and_openings(
        &mut self,
        at: &Spot<S, R, N, M>,
        length: R,
    ) -> ([R; N], Thirds<S, R, N, M>, [[R; M]; 3]) {
        let third = R::constant(THIRD) * length;
        let stations = [third, third + third, length].map(|ahead| self.station(at.share + ahead));
        let [one, two, three] = stations.each_ref().map(|station| self.residuals(station, &at.q));
        let weights = [-11.0, 18.0, -9.0, 2.0].map(|weight| R::constant(-weight / 6.0) / third);
        let rate = combined(weights, [&at.rest, &one, &two, &three]);
        (self.way.mechanism.solve_linear(&at.factors, &rate), stations, [one, two, three])
    }

    /// Taylor's polynomial of the third order: the slope, then the curvature from the residuals of the rows along it, then the
    /// term from those along the parabola. Counts as two evaluations.
    pub(super) fn forecast(&mut self, at: &Spot<S, R, N, M>, length: R) -> Forecast<R, N> {
        self.evaluations = self.evaluations.saturating_add(2);
        let (slope, stations, [one, two, three]) = self.slope_and_openings(at, length);
        let probe = self.station(at.share + R::constant(PROBE) * length);
        let probed = self.residuals(&probe, &at.q);
        let row_scales = self.way.mechanism.row_scales(&probe.parameters);
        let drives_little = drives_turn_little([&at.rest, &one, &two, &three], &probed, &row_scales);
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
        let caused = link_lengths::caused_by_others(&points, &scales, &bend, at.margin);
        let weights = link_lengths::weights(&points, &scales, [&straight, &bend, &caused], at.margin);
        let (second, third) = (self.size(&bend), self.size(&twist));
        let third_part = link_lengths::weighted(&twist, &weights);
        Forecast {
            q,
            first,
            second,
            third,
            third_part,
            start: slope,
            slope: tip,
            weights,
            caused,
            drives_little,
        }
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
}
