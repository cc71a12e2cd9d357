//! Projection: positions and velocities put back onto the constraints by the shortest way in the mass's measure.

use crate::dynamics::formulations::block_elimination;
use crate::dynamics::formulations::block_elimination::PlaceOf;
use crate::dynamics::formulations::singular::limit_rows::{Passing, at_limit};
use crate::dynamics::formulations::unstabilized::{factorize, solve};
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::{Factors, System};
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::failure::Failure;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{positions, singular};

/// Corrections of one position: two do after a step, a start off the constraints needs a few more.
const MOST_CORRECTIONS: u32 = 25;

/// A correction with old factors that leaves more than this share of the residual is worth new factors.
const STALE: f64 = 0.1;

/// Stages of a step that are put onto the constraints before they are evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProjectedStages {
    /// All if rows follow from others on the constraints alone, none otherwise: off the constraints the rank of Φ_q
    /// rises, and accelerations grow with the inverse of the distance. Decided at the start, and again after changed parameters
    /// and singular positions.
    #[default]
    WhereNeeded,
    /// None: a step's end alone is.
    None,
    /// All, at twice the cost and a fifth of the error. Next to a singular position a stage may be too far off. An adaptive
    /// step is then tried again smaller; in one of fixed size the stage is taken as it is, unless the rank rises there.
    All,
}

/// Index 1 with projection of q and q̇ after each step: the accurate default.
///
/// Δq solves M Δq + Φ_qᵀ μ = 0, Φ_q Δq = −Φ, repeated to rounding; then Δq̇ solves the same with
/// −(Φ_q q̇ + Φ_t). Nothing is divided by M, which may be singular.
///
/// Accelerations and projections are solved through the factorised blocks of the rows, as by
/// [`VelocityTransformation`](crate::dynamics::VelocityTransformation), where the independent coordinates determine the others well.
/// Elsewhere M and all rows are factorised together; [`Counts::rechosen`] has the number of such evaluations. That is at turning
/// points of the independent coordinates and next to singular positions. Texts with redundant rows have no blocks.
/// Source: Eich 1993; García de Jalón & Gutiérrez-López 2013 for singular M.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Projection {
    /// Stages that are projected too.
    pub stages: ProjectedStages,
}

impl Projection {
    /// Stages of `model` that are projected.
    fn stages_of<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
        &self,
        model: &Model<'_, S, R, N, M>,
    ) -> ProjectedStages {
        match self.stages {
            ProjectedStages::WhereNeeded if model.rank_rises => ProjectedStages::All,
            ProjectedStages::WhereNeeded => ProjectedStages::None,
            chosen => chosen,
        }
    }

    /// Rates and multipliers at `(t, y)`, whose place is known: by blocks where it is regular.
    #[inline(never)]
    fn solve_at<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
        &self,
        model: &Model<'_, S, R, N, M>,
        (t, y): (R, &IntegratorState<R, N, S::States>),
        place: &PlaceOf<S, R, N, M>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        if place.is_regular() {
            // By reference: `?` would move the rates once more.
            match &block_elimination::solve(model, (t, y), place, lambda, counts) {
                Ok(Some(solved)) => return Ok(*solved),
                Ok(None) => {}
                Err(failure) => return Err(*failure),
            }
        }
        self.solve_by_rows(model, (t, y), lambda, counts)
    }

    /// Rates alone of [`solve_by_rows`](Self::solve_by_rows).
    #[cold]
    #[inline(never)]
    fn rate_by_rows<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
        &self,
        model: &Model<'_, S, R, N, M>,
        state: (R, &IntegratorState<R, N, S::States>),
        lambda: &mut [R; M],
        counts: &mut Counts,
    ) -> Option<IntegratorState<R, N, S::States>> {
        let before = *counts;
        match &self.solve_by_rows(model, state, lambda, counts) {
            Ok(solved) => {
                *lambda = solved.lambda;
                Some(solved.rate)
            }
            Err(_) => {
                *counts = before;
                None
            }
        }
    }

    /// Rates and multipliers at `(t, y)` by all rows together, with the limits of those that lose their hold.
    #[inline(never)]
    pub(crate) fn solve_by_rows<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
        &self,
        model: &Model<'_, S, R, N, M>,
        (t, y): (R, &IntegratorState<R, N, S::States>),
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        let position = model.position(t, y);
        let factors = factorize(model, t, &position, counts)?;
        let gamma = model.mechanism.gamma(model.parameters, &position, &y.qd);
        let zone = singular::ZONE_OF_FORCES.of();
        let margin = if factors.loses_rank(S::REDUNDANT) { R::constant(0.0) } else { factors.margin() };
        if margin < zone && margin < model.zone(self.stages_of(model)) {
            let rows = (&gamma, margin);
            let found = at_limit(model, (t, y), &position, lambda, rows, counts)?;
            if let Some(Passing { solved, .. }) = found {
                return Ok(solved);
            }
        }
        // A text without blocks has never left them.
        counts.rechosen += u64::from(has_blocks(model) && zone < factors.margin());
        solve(model, (t, y), &position, lambda, &factors, &gamma)
    }
}

/// `true` if blocks of the rows can take the place of all rows together. Where the rank rises off the constraints they fix
/// nothing. Callers ask for `IS_PARTITIONED` themselves: what the compiler does not see there it compiles in vain.
#[inline(always)]
fn has_blocks<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
) -> bool {
    S::IS_PARTITIONED && !model.rank_rises
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Formulation<S, R, N, M> for Projection {
    #[inline]
    fn solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        if self.stages_of(model) == ProjectedStages::All {
            return self.project_and_solve(model, t, &mut { *y }, lambda, counts);
        }
        if S::IS_PARTITIONED && has_blocks(model) {
            let place = block_elimination::place(model, t, y);
            return self.solve_at(model, (t, y), &place, lambda, counts);
        }
        self.solve_by_rows(model, (t, y), lambda, counts)
    }

    #[inline(always)]
    fn rate(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        lambda: &mut [R; M],
        counts: &mut Counts,
    ) -> Option<IntegratorState<R, N, S::States>> {
        if !S::IS_PARTITIONED || !has_blocks(model) || self.stages_of(model) == ProjectedStages::All {
            return None;
        }
        let place = block_elimination::place(model, t, y);
        let evaluations = counts.evaluations;
        if place.is_regular() {
            match block_elimination::solve(model, (t, y), &place, lambda, counts) {
                Ok(Some(solved)) => {
                    *lambda = solved.lambda;
                    return Some(solved.rate);
                }
                Ok(None) => {}
                Err(_) => {
                    counts.evaluations = evaluations;
                    return None;
                }
            }
        }
        // By reference: it would be written where the rates above are, which then were no registers.
        match &self.rate_by_rows(model, (t, y), lambda, counts) {
            Some(rate) => Some(*rate),
            None => {
                counts.evaluations = evaluations;
                None
            }
        }
    }

    fn solve_as_it_is(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        let rises = model.rank_rises && self.stages != ProjectedStages::None;
        let stages = if rises { ProjectedStages::All } else { ProjectedStages::None };
        Projection { stages }.solve(model, t, y, lambda, counts)
    }

    fn leaves_constraints(&self) -> bool {
        self.stages == ProjectedStages::None
    }

    #[inline]
    fn project(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &mut IntegratorState<R, N, S::States>,
        counts: &mut Counts,
    ) -> Result<(), Failure> {
        let before = *y;
        if S::IS_PARTITIONED && has_blocks(model) && block_elimination::settled(model, t, y, counts).is_some()
        {
            return Ok(());
        }
        *y = before;
        project_by_rows(model, t, y, counts)
    }

    #[inline]
    fn project_and_solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &mut IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        counts.projected_stages += u64::from(self.stages_of(model) == ProjectedStages::All);
        let before = *y;
        let settled = if S::IS_PARTITIONED && has_blocks(model) {
            block_elimination::settled(model, t, y, counts)
        } else {
            None
        };
        if let Some(place) = &settled {
            return self.solve_at(model, (t, y), place, lambda, counts);
        }
        *y = before;
        project_by_rows(model, t, y, counts)?;
        self.solve_by_rows(model, (t, y), lambda, counts)
    }
}

/// Puts `y` onto Φ(q, t) = 0 and Φ_q q̇ = −Φ_t by all rows together, but for directions that they determine too weakly.
#[inline(never)]
pub(crate) fn project_by_rows<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut IntegratorState<R, N, S::States>,
    counts: &mut Counts,
) -> Result<(), Failure> {
    let factors = project_position(model, t, y, counts)?;
    project_velocity(model, t, y, factors, counts)
}

/// Puts `y.q` onto Φ(q, t) = 0; returns the last factors, which are those of a position next to it.
pub(crate) fn project_position<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut IntegratorState<R, N, S::States>,
    counts: &mut Counts,
) -> Result<Option<Factors<R, N, M>>, Failure> {
    let none = [R::constant(0.0); N];
    let mut progress = Progress::new();
    let mut own = positions::OF_TERMS.of();
    if model.is_loosened() {
        let factors = correction_factors(model, t, &model.position(t, y))?;
        // Rows that depend on others, or nearly so, are met to rounding: off the constraints they may do no more.
        own = if factors.rank() < M { own } else { model.closing(factors.margin()) };
        progress.factors = Some(factors);
    }
    for _ in 0..MOST_CORRECTIONS {
        let position = model.position(t, y);
        let phi = model.mechanism.phi(model.parameters, &position);
        let ratio = model.worst(&phi, &model.tolerances(&position, &y.q, model.metric.rows, own)).0;
        if progress.ends(ratio, &y.q) {
            break;
        }
        let factors = progress.factors(|| correction_factors(model, t, &position))?;
        let (step, _) = factors.solve(&none, &phi);
        counts.corrections += 1;
        progress.moved(&step, &y.q, &model.metric.coordinates);
        y.q = y.q.plus(R::constant(-1.0), &[1.0], [&step]);
    }
    y.q = progress.best.unwrap_or(y.q);
    let position = model.position(t, y);
    let phi = model.mechanism.phi(model.parameters, &position);
    model.require(t, &phi, &model.position_tolerances(&position, &y.q), unmet(), false)?;
    Ok(progress.factors)
}

/// Puts `y.qd` onto Φ_q q̇ = −Φ_t.
fn project_velocity<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut IntegratorState<R, N, S::States>,
    factors: Option<Factors<R, N, M>>,
    counts: &mut Counts,
) -> Result<(), Failure> {
    let none = [R::constant(0.0); N];
    let position = model.position(t, y);
    let tolerances = model.rate_tolerances(&position, &y.qd);
    let mut progress = Progress { factors, ..Progress::new() };
    for _ in 0..MOST_CORRECTIONS {
        let phi_d = model.constraint_rates(&position, &y.qd);
        let ratio = model.worst(&phi_d, &tolerances).0;
        if progress.ends(ratio, &y.qd) {
            break;
        }
        let factors = progress.factors(|| correction_factors(model, t, &position))?;
        let (step, _) = factors.solve(&none, &phi_d);
        counts.corrections += 1;
        progress.moved(&step, &y.qd, &[R::constant(0.0); N]);
        y.qd = y.qd.plus(R::constant(-1.0), &[1.0], [&step]);
    }
    y.qd = progress.best.unwrap_or(y.qd);
    let (phi_d, rest) = (model.constraint_rates(&position, &y.qd), unmet());
    if model.worst(&phi_d, &tolerances).0 <= rest {
        return Ok(());
    }
    model.require(t, &phi_d, &model.frame_free_rate_tolerances(&position, &y.qd), rest, true)
}

/// Largest residual over its tolerance with which the rows still are met.
fn unmet<R: Real>() -> R {
    positions::UNMET.of::<R>() / positions::OF_TERMS.of()
}

/// The factors that corrections are solved with: without the directions that the rows determine too weakly.
pub(crate) fn correction_factors<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    position: &S::Position,
) -> Result<Factors<R, N, M>, Failure> {
    let mass = model.mechanism.mass(model.parameters, position);
    let phi_q = model.mechanism.phi_q(model.parameters, position);
    let system = System::new(&mass, &phi_q, model.metric);
    let factors = system.factorize(S::COORDINATES, t)?;
    let weakest = singular::ZONE_OF_FORCES.of();
    if weakest < factors.margin() {
        return Ok(factors);
    }
    system.factorize_rank_revealing(weakest, S::COORDINATES, t)
}

/// The way of a projection to its end: corrections with the same factors as long as those are good enough.
struct Progress<R, const N: usize, const M: usize> {
    factors: Option<Factors<R, N, M>>,
    /// The point with the least residual so far, and that residual over its tolerance.
    best: Option<[R; N]>,
    least: R,
    /// `true` if the last correction was made with factors of its own point.
    fresh: bool,
    /// `true` if the last correction was no more than rounding.
    still: bool,
}

impl<R: Real, const N: usize, const M: usize> Progress<R, N, M> {
    fn new() -> Self {
        Progress { factors: None, best: None, least: R::constant(f64::MAX), fresh: false, still: false }
    }

    /// Takes up the residual of a point; `true` if no further correction is worthwhile.
    fn ends(&mut self, ratio: R, x: &[R; N]) -> bool {
        let first = self.best.is_none();
        let falls = |share: f64| ratio < R::constant(share) * self.least;
        let (stale, stuck) = (!falls(STALE), !falls(0.5));
        if ratio < self.least {
            (self.least, self.best) = (ratio, Some(*x));
        }
        if !first && stale {
            if self.fresh && (stuck || self.still) {
                return true;
            }
            self.factors = None;
        }
        ratio <= R::constant(1.0) || self.still
    }

    fn factors(
        &mut self,
        make: impl FnOnce() -> Result<Factors<R, N, M>, Failure>,
    ) -> Result<Factors<R, N, M>, Failure> {
        self.fresh = self.factors.is_none();
        let factors = match self.factors {
            Some(factors) => factors,
            None => make()?,
        };
        self.factors = Some(factors);
        Ok(factors)
    }

    /// Takes up a correction from `x`; `scales` (N) measure a coordinate in addition to its own size.
    fn moved(&mut self, step: &[R; N], x: &[R; N], scales: &[R; N]) {
        let zero = R::constant(0.0);
        let largest = |values: &[R; N]| values.iter().fold(zero, |largest, x| largest.max(x.abs()));
        let size = largest(x).max(largest(scales));
        self.still = largest(step) <= positions::OF_COORDINATES.of::<R>() * size;
    }
}
