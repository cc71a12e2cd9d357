//! Multipliers that a position determines, and rows that follow from others there.
//!
//! If rows depend on each other, Φ_qᵀ λ = Q − M q̈ has many solutions. Their sum on the coordinates is unique, and so is the
//! motion. The force of a single row or joint is not, however many digits it is printed with.

use crate::dynamics::linear_systems::kkt::{Factors, System};
use crate::dynamics::model::metric::Metric;
use crate::failure::Failure;
use crate::linear_algebra::vectors::{Each, dot};
use crate::mechanism::dynamic::{Dynamic, DynamicState};
use crate::mechanism::{Entry, Mechanism};
use crate::scalar::number::Real;
use crate::tolerances::{forces, singular};

/// Multipliers that the position determines, and rows that follow from the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Determinacy<R, const M: usize> {
    entries: &'static [Entry],
    /// Rank of Φ_q in the reference metric, drives included.
    pub rank: usize,
    /// `true` for each multiplier that is unique; the others are the shortest choice of many: M.
    pub unique: [bool; M],
    /// `true` for each row that follows from the others. Of rows that follow from each other it is the later one, a row of a
    /// constraint marked `redundant` before any other: M.
    pub dependent: [bool; M],
    /// Combinations of multipliers without effect on any coordinate, M less the rank of them, then zeros.
    idle: [[R; M]; M],
}

impl<R: Real, const M: usize> Determinacy<R, M> {
    /// That of `mechanism` at its `position`, by the decision that its accelerations are solved by; gradients of rows are measured by
    /// those about the guess.
    ///
    /// Source: Wojtyra 2009 for the reactions that redundant rows leave determined.
    ///
    /// # Errors
    /// [`SingularMass`](crate::FailureKind::SingularMass) where Φ_q is no number.
    pub fn of<S: Mechanism<R, N, M>, const N: usize>(
        mechanism: &S,
        parameters: &S::Parameters,
        position: &S::Position,
        t: R,
    ) -> Result<Self, Failure> {
        let metric = Metric::next_to(mechanism, parameters, t, &mechanism.guess(parameters));
        Self::measured(mechanism, parameters, position, (t, &metric), None)
    }

    /// Determinacy of a position in a known metric. If `weakest` is given, multipliers of rows that the position holds more
    /// weakly are not defined.
    pub(crate) fn measured<S: Mechanism<R, N, M>, const N: usize>(
        mechanism: &S,
        parameters: &S::Parameters,
        position: &S::Position,
        (t, metric): (R, &Metric<R, N, M>),
        weakest: Option<R>,
    ) -> Result<Self, Failure> {
        let phi_q = mechanism.phi_q(parameters, position);
        let system = System::new(&metric.mass(), &phi_q, metric);
        let factors = match weakest {
            Some(weakest) => system.factorize_rank_revealing(weakest, S::COORDINATES, t)?,
            None => system.factorize(S::COORDINATES, t)?,
        };
        Ok(Self::by(&factors, S::ROWS, S::REDUNDANT))
    }

    /// That of a factorised position.
    pub(crate) fn by<const N: usize>(
        factors: &Factors<R, N, M>,
        entries: &'static [Entry],
        marked: &[bool],
    ) -> Self {
        let (rank, unique) = (factors.rank(), factors.unique_multipliers());
        let (dependent, idle) = ([false; M], factors.idle_multipliers());
        let mut found = Determinacy { entries, rank, unique, dependent, idle };
        found.name(&factors.idle_shares(), marked);
        found
    }

    /// Before: `shares` of the rows in the combinations without effect, in the metric. After: as many rows are named
    /// dependent as there are combinations, such that the others are independent of each other.
    fn name(&mut self, shares: &[[R; M]; M], marked: &[bool]) {
        let zero = R::constant(0.0);
        let (mut basis, mut named) = ([[zero; M]; M], 0);
        for first in [true, false] {
            for (row, dependent) in self.dependent.iter_mut().enumerate().rev() {
                if marked.get(row).copied().unwrap_or(false) != first {
                    continue;
                }
                let mut own = shares.map(|shares| shares.get(row).copied().unwrap_or(zero));
                for direction in &basis {
                    let part = dot(&own, direction);
                    own.iter_mut().zip(direction).for_each(|(own, along)| *own = *own - part * *along);
                }
                let length = dot(&own, &own).sqrt();
                if let (true, Some(slot)) = (singular::OWN_PART.of::<R>().less(length), basis.get_mut(named))
                {
                    *slot = own.each(|part| part / length);
                    *dependent = true;
                    named += 1;
                }
            }
        }
    }

    /// `true` if every multiplier is unique.
    pub fn is_whole(&self) -> bool {
        self.rank >= M
    }

    /// The dependent rows, each once, in the order of Φ.
    pub fn dependent_rows(&self) -> impl Iterator<Item = Entry> + '_ {
        self.picked(&self.dependent, true)
    }

    /// The rows whose multipliers are one choice of many, in the order of Φ.
    pub fn shared_rows(&self) -> impl Iterator<Item = Entry> + '_ {
        self.picked(&self.unique, false)
    }

    fn picked<'a>(&'a self, marks: &'a [bool; M], mark: bool) -> impl Iterator<Item = Entry> + 'a {
        self.entries.iter().zip(marks).filter(move |(_, found)| **found == mark).map(|(entry, _)| *entry)
    }

    /// Marks in `unique`, one a load, those that are the same for every choice of the multipliers of `motion`. The whole
    /// force of a joint may be, where its rows share it in many ways.
    pub fn mark_loads<S: Dynamic<R, N, M>, const N: usize>(
        &self,
        mechanism: &S,
        parameters: &S::Parameters,
        position: &S::Position,
        motion: &DynamicState<'_, R, N, M, S::States>,
        unique: &mut [bool],
    ) {
        unique.fill(true);
        let loads =
            |lambda: &[R; M]| mechanism.loads(parameters, position, &DynamicState { lambda, ..*motion });
        let before = loads(motion.lambda);
        let size = motion.lambda.iter().fold(R::constant(1.0), |size, lambda| size.max(lambda.abs()));
        for combination in self.idle.iter().take(M.saturating_sub(self.rank)) {
            let mut moved = *motion.lambda;
            moved.iter_mut().zip(combination).for_each(|(lambda, share)| *lambda = *lambda + size * *share);
            let whole = loads(&moved);
            for (index, mark) in unique.iter_mut().enumerate() {
                let of = |loads: &S::Loads| loads.as_ref().get(index).copied().unwrap_or(R::constant(0.0));
                let mut parts = R::constant(0.0);
                for (row, share) in combination.iter().enumerate() {
                    let mut alone = *motion.lambda;
                    alone.iter_mut().skip(row).take(1).for_each(|lambda| *lambda = *lambda + size * *share);
                    parts = parts + (of(&loads(&alone)) - of(&before)).abs();
                }
                *mark &= !(forces::CANCELLED.of::<R>() * parts).less((of(&whole) - of(&before)).abs());
            }
        }
    }
}
