//! A path that is being followed: its places, and the pieces one after the other.

use crate::kinematics::homotopy::corrector::Landing;
use crate::kinematics::homotopy::response::Response;
use crate::kinematics::homotopy::step_length::{aimed, beyond, is_far, next_piece, reach, shortened};
use crate::kinematics::homotopy::{Followed, Homotopy, Leading, leads};
use crate::linear_algebra::vectors::largest_difference;
use crate::mechanism::Kinematic;
use crate::mechanism::margin::Margin;
use crate::scalar::number::Real;
use crate::tolerances::positions;

/// Times that an end too near to a singular position is moved: two assemblies that do not meet there allow no other.
const MOST_AIMS: u32 = 3;

/// The same of a piece with a singular position in it.
const MOST_AIMS_OF_A_PASSAGE: u32 = 16;

/// Values and time at a place of the path.
pub(super) struct Station<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> {
    pub(super) values: S::Values,
    pub(super) parameters: S::Parameters,
    pub(super) t: R,
    /// Residuals of the rows there.
    left: [R; M],
}

/// A position on the path.
pub(super) struct Spot<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> {
    pub(super) q: [R; N],
    pub(super) share: R,
    pub(super) factors: S::Factors,
    /// Residuals of the rows, left by rounding.
    pub(super) rest: [R; M],
    pub(super) margin: R,
    pub(super) orientation: u64,
    /// Answers of the coordinates to open rows.
    pub(super) response: Response<R, N>,
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Station<S, R, N, M> {
    pub(super) fn open(&self, mechanism: &S, position: &S::Position) -> [R; M] {
        let mut open = mechanism.phi(&self.parameters, position);
        open.iter_mut().zip(&self.left).for_each(|(residual, left)| *residual = *residual - *left);
        open
    }
}

/// State of a path that is being followed.
pub(super) struct Walk<'a, 'b, S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> {
    pub(super) way: &'a mut Homotopy<'b, S, R, N, M>,
    /// Residuals of the rows at the start of the path.
    pub(super) open: [R; M],
    pub(super) evaluations: u32,
    /// Most of them.
    pub(super) limit: u32,
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Walk<'_, '_, S, R, N, M> {
    /// [`Homotopy::followed`] from `start`.
    pub(super) fn followed(&mut self, start: [R; N], piece: R) -> Followed<R, N> {
        let (one, half) = (R::constant(1.0), R::constant(0.5));
        let mut at = self.spot(start, R::constant(0.0));
        // One that was tried before is known better.
        let mut piece = if piece < one { piece } else { self.first_piece(&at) };
        let mut leading = Leading { q: start, share: at.share, piece };
        let (mut failed, mut aims) = (piece, 0);
        // A forecast takes two evaluations.
        while at.share < one
            && self.evaluations.saturating_add(1) < self.limit
            && positions::SHORTEST_PIECE.of::<R>() <= piece
        {
            let rest = one - at.share;
            let length = piece.min(rest);
            let share = if length < rest { at.share + length } else { one };
            let forecast = self.forecast(&at, length);
            if let Some(shorter) = shortened(&at, forecast.first, length) {
                (piece, failed) = (shorter, length);
                continue;
            }
            let reach = reach(at.margin, forecast.first);
            let (next, growth) = match self.landed(&at, &forecast, share, length) {
                Landing::Certain(next, growth) => (next, growth),
                Landing::Doubtful(next) => {
                    // Farther behind a singular position the assemblies are farther apart.
                    let part = next.filter(|_| aims == 0).map(|next| beyond(&at, &next).min(reach));
                    aims += u32::from(part.is_some());
                    (piece, failed) = (part.filter(|part| one < *part).unwrap_or(half) * length, length);
                    continue;
                }
            };
            let passage = next.orientation != at.orientation;
            if let Some(part) = aimed(&at, &next, aims).filter(|_| aims < MOST_AIMS || passage) {
                aims += 1;
                // No longer piece is tried, or this one was tried before.
                let held = reach <= part.min(one) || MOST_AIMS_OF_A_PASSAGE < aims;
                if !held || is_far(&at, &next) {
                    (piece, failed) = (if held { half } else { part.min(reach) } * length, length);
                    continue;
                }
            }
            aims = 0;
            piece = next_piece(&at, &next, forecast.first, length, growth);
            (at, failed) = (next, piece);
            if leads(at.margin) {
                leading = Leading { q: at.q, share: at.share, piece };
            }
        }
        let lost = at.share < one && piece < positions::SHORTEST_PIECE.of();
        let jump = if lost { self.jump(&at, failed) } else { None };
        let spent = at.share < one && !lost;
        if at.share <= leading.share {
            leading.piece = piece;
        }
        // A part of what is left of the way from there.
        leading.piece = leading.piece / (one - leading.share).max(positions::SHORTEST_PIECE.of());
        let Spot { q, share, margin, .. } = at;
        Followed { q, share, margin, evaluations: self.evaluations, jump, spent, leading }
    }

    pub(super) fn is_spent(&self) -> bool {
        self.limit <= self.evaluations
    }

    pub(super) fn station(&mut self, share: R) -> Station<S, R, N, M> {
        let (values, t) = self.way.place(share);
        self.way.mechanism.set_values(values);
        let parameters = self.way.mechanism.parameters();
        let left = self.open.map(|residual| (R::constant(1.0) - share) * residual);
        Station { values, parameters, t, left }
    }

    /// The mechanism at a station, with its position there.
    pub(super) fn position(&mut self, station: &Station<S, R, N, M>, q: &[R; N]) -> (&S, S::Position) {
        self.way.mechanism.set_values(station.values);
        (self.way.mechanism, self.way.mechanism.position(&station.parameters, q, station.t))
    }

    pub(super) fn residuals(&mut self, station: &Station<S, R, N, M>, q: &[R; N]) -> [R; M] {
        let (mechanism, position) = self.position(station, q);
        station.open(mechanism, &position)
    }

    /// Position `q` at a `share` of the way, with its factors.
    pub(super) fn spot(&mut self, q: [R; N], share: R) -> Spot<S, R, N, M> {
        self.evaluations = self.evaluations.saturating_add(1);
        let station = self.station(share);
        let (mechanism, position) = self.position(&station, &q);
        let (factors, Margin { value: margin, orientation, .. }) =
            mechanism.factorize(&station.parameters, &position);
        let rest = station.open(mechanism, &position);
        let orientation = orientation.as_ref().first().copied().unwrap_or(0);
        let response = Response::of(mechanism, &station.parameters, &factors);
        Spot { q, share, factors, rest, margin, orientation, response }
    }

    pub(super) fn size(&self, difference: &[R; N]) -> R {
        let scales = self.way.mechanism.coordinate_scales(&self.way.mechanism.parameters());
        largest_difference(difference, &[R::constant(0.0); N], &scales)
    }
}
