//! Corrector of the homotopy: Newton's method at the end of a piece, and the tests that it kept the assembly.

use crate::kinematics::homotopy::predictor::{Forecast, THIRD};
use crate::kinematics::homotopy::step_length::LARGEST_GROWTH;
use crate::kinematics::homotopy::walk::{Spot, Walk};
use crate::kinematics::homotopy::{LARGEST_APPROACH, LARGEST_BEND, Turned, leads};
use crate::kinematics::link_lengths;
use crate::kinematics::position::branch_failure;
use crate::linear_algebra::vectors::largest_difference;
use crate::mechanism::Kinematic;
use crate::scalar::number::Real;
use crate::tolerances::{positions, singular};

/// The same from where nothing leads on for certain: rounding has a part in the prediction.
const LARGEST_APPROACH_INSIDE: f64 = 1.0 / 16.0;

/// The same where the determinant changes its sign, in addition to rounding. Of two assemblies that come as near as μ to each
/// other and do not meet, the other one is off the prediction from margin m by (μ/m)² of m.
const LARGEST_APPROACH_OF_A_PASSAGE: f64 = 1.0 / 64.0;

/// [`LARGEST_BEND`] where the determinant changes its sign: the limit of the third-order term decides there.
const LARGEST_BEND_OF_A_PASSAGE: f64 = 2.0;

/// Largest third-order term of a piece over the margin at its end: the next one is less, and a prediction that is off by more than the
/// assemblies are apart may lead to the other one, as near to it as one likes.
const LARGEST_TWIST: f64 = 0.25;

/// Largest difference of the slopes at the end of a piece, foreseen and found, over the larger one. Assemblies that cross differ by
/// as much as they have slope, at whatever distance from where they do.
const LARGEST_KINK: f64 = 0.25;

/// Largest distance of a length from its prediction to its solution, over its movement in the piece. Also the largest Newton step
/// after the first one, over the first one. A link that turns by a radian has a sixth and a tenth, however short it is.
const LARGEST_PART: f64 = 0.25;

/// Largest difference of the margin at a prediction from that of its solution, over it. The solution of another assembly is as far from the
/// zero of the determinant on its other side: twice the margin.
const LARGEST_CHANGE_OF_MARGIN: f64 = 0.5;

/// The same of a step so small that it need not shrink further: some rounding is in it.
const LEAST_PART: f64 = 1.0 / 64.0;

/// Movement through the zero of a determinant, over its rounding, that tells two assemblies apart.
const LEAST_ROUNDINGS: f64 = 2.0;

/// Newton steps of a piece. From a quarter of the margin they end in rounding; a piece that does not is halved.
const CORRECTIONS: u32 = 6;

/// [`LARGEST_APPROACH_OF_A_PASSAGE`] with the rounding of difference quotients, some 50 ε/m² at m = [`leads`].
fn approach_of_a_passage<R: Real>() -> R {
    R::constant(LARGEST_APPROACH_OF_A_PASSAGE) + R::constant(3.0) * singular::BALANCE.of::<R>()
}

/// Square of a Newton step over the margin after which a piece is done: that much of the position is left open, ε^(3/4).
fn closed<R: Real>() -> R {
    let root = singular::BALANCE.of::<R>();
    root * root * root
}

/// End of a piece.
pub(super) enum Landing<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> {
    /// The spot that a piece leads to, and how much longer the next one may be.
    Certain(Spot<S, R, N, M>, R),
    /// Not certain; the spot at its end where a singular position in or behind the piece may be the cause.
    Doubtful(Option<Spot<S, R, N, M>>),
}

/// False for a piece that moves by `first` and leaves open which way it takes where two assemblies come near: rounding turns it back.
///
/// Points of links so short that rounding is all of their movement to the zero of the determinant tell no passage from its opposite.
/// The same holds for a margin that rises without a passage from where nothing leads on.
fn is_resolved<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    at: &Spot<S, R, N, M>,
    next: &Spot<S, R, N, M>,
    first: R,
) -> bool {
    if next.orientation != at.orientation {
        return true;
    }
    if at.margin <= next.margin {
        return leads(at.margin + at.margin) || link_lengths::rounding(at.margin) < first;
    }
    let through = first * (at.margin + next.margin) / (at.margin - next.margin);
    let short = const { link_lengths::any(S::COORDINATES) } && next.margin < singular::PASSES.of();
    !short || R::constant(LEAST_ROUNDINGS) * link_lengths::rounding(next.margin) < through
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Walk<'_, '_, S, R, N, M> {
    /// End of a piece of `length` from `at` to `share`.
    pub(super) fn landed(
        &mut self,
        at: &Spot<S, R, N, M>,
        forecast: &Forecast<R, N>,
        share: R,
        length: R,
    ) -> Landing<S, R, N, M> {
        let Some((q, off, turned)) = self.corrected(forecast, share) else { return Landing::Doubtful(None) };
        let mut way = q;
        way.iter_mut().zip(&forecast.q).for_each(|(way, from)| *way = *way - *from);
        let part = link_lengths::weighted(&way, &forecast.weights);
        if self.is_spent() {
            return Landing::Doubtful(None);
        }
        let next = self.spot(q, share);
        if !self.holds(&q, share) {
            return Landing::Doubtful(None);
        }
        let passage = next.orientation != at.orientation;
        // One that begins or ends too far away is not taken, but shows where the next one is to end.
        let tight = passage && at.margin.max(next.margin) <= singular::PASSES.of();
        let approach = match (tight, leads(at.margin + at.margin)) {
            (true, _) => approach_of_a_passage(),
            (_, true) => R::constant(LARGEST_APPROACH),
            _ => R::constant(LARGEST_APPROACH_INSIDE),
        };
        let bend = if tight { LARGEST_BEND_OF_A_PASSAGE } else { LARGEST_BEND };
        let parts = [approach, R::constant(bend), R::constant(LARGEST_TWIST)];
        let allowed = parts.map(|part| part * next.margin);
        let change = if tight { approach } else { R::constant(LARGEST_CHANGE_OF_MARGIN) };
        // Answers to open redundant rows are those of a choice of them, which is another one next to a change point.
        let square = const { M == N };
        let most_part = if tight && !square { approach } else { R::constant(LARGEST_PART) };
        // Written so that NaN is not near.
        let near = off <= allowed[0] && forecast.second <= allowed[1] && forecast.third <= allowed[2];
        let turns_little =
            !square || forecast.drives_little && turned.is_within(change, next.margin, next.orientation);
        let foreseen = turns_little && part <= most_part && forecast.third_part <= R::constant(LARGEST_PART);
        let alike = !square
            || next.response.is_like(&at.response, passage)
            || forecast.first <= link_lengths::rounding(next.margin);
        // The end of the way may be as near to a change point as it likes: nothing is continued from there.
        let told = is_resolved(at, &next, forecast.first)
            && (!square || R::constant(1.0) <= share || self.is_resolved(&next));
        if !(near && foreseen && alike && told) {
            let falls = next.margin < at.margin && !leads(at.margin + at.margin);
            return Landing::Doubtful(Some(next).filter(|_| tight || falls && !passage));
        }
        // What is beyond a forecast's second order grows with the third power of the length at least.
        let ratio = (off / allowed[0]).max(forecast.second / allowed[1]).max(forecast.third / allowed[2]);
        let growth = R::constant(0.8) * ratio.max(positions::SHORTEST_PIECE.of()).powf(R::constant(-THIRD));
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
                return Landing::Doubtful(None);
            }
        }
        Landing::Certain(next, growth.min(R::constant(LARGEST_GROWTH)))
    }

    /// `true` if the declared branches hold at `q` (N). Where two assemblies come nearer to each other than a piece is long, a
    /// step may jump to the other one; the branches detect it.
    fn holds(&mut self, q: &[R; N], share: R) -> bool {
        if const { S::BRANCHES.is_empty() } {
            return true;
        }
        let station = self.station(share);
        let (mechanism, position) = self.position(&station, q);
        branch_failure(mechanism, &station.parameters, &position, station.t, false).is_none()
    }

    /// Newton's method from a `prediction` at a `share` of the path, if it ends nearby, with its distance from there and the margin there.
    fn corrected(&mut self, forecast: &Forecast<R, N>, share: R) -> Option<([R; N], R, Turned<R>)> {
        let station = self.station(share);
        let scales = self.way.mechanism.coordinate_scales(&station.parameters);
        let prediction = &forecast.q;
        let (mut q, mut most, mut turned) = (*prediction, R::constant(LARGEST_PART), None);
        for _ in 0..CORRECTIONS {
            if self.is_spent() {
                return None;
            }
            self.evaluations = self.evaluations.saturating_add(1);
            let (mechanism, position) = self.position(&station, &q);
            let (factors, margin) = mechanism.factorize(&station.parameters, &position);
            let turned = *turned.get_or_insert(Turned::of(&margin));
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
            if last * last <= closed::<R>() * margin.value && part <= R::constant(LEAST_PART) {
                return Some((q, off, turned));
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
        let rounding = link_lengths::rounding(margin);
        let least = forecast.caused.map(|caused| caused.max(rounding));
        link_lengths::turn_little((&points, &scales), [&forecast.start, &change, slope], length, least)
    }
}
