//! The start of a text: what it declares stays as declared, the rows give the rest.

use super::kkt::System;
use super::metric::Metric;
use super::model::{Counts, Model};
use super::vector::{State, Vector};
use crate::{Dynamic, Failure, Real};

/// Corrections of a start: quadratic from guesses that are right to a few digits, with a margin for capped steps.
const MOST_CORRECTIONS: u32 = 25;

/// Largest change of a coordinate in one correction, in the metric (rad, or reference lengths): half a radian, as in the
/// search for an assembly.
const LARGEST_STEP: f64 = 0.5;

/// Singular value in the metric below which a direction of the free columns is not corrected: what is declared may leave
/// rows without any column.
const WEAKEST: f64 = 1e-6;

/// Before: the text's guesses and rates. After: the rows hold as far as coordinates and rates without a declaration can
/// do it, the shortest way in the reference metric; where they cannot, the state is what it was.
pub(super) fn complete<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut State<R, N, S::States>,
    counts: &mut Counts,
) -> Result<(), Failure> {
    if S::STARTED.is_empty() {
        return Ok(());
    }
    let mut found = *y;
    if close(model, t, &mut found, S::STARTED, counts).is_ok() {
        y.q = found.q;
    }
    if !S::STARTED_RATES.is_empty() {
        let position = model.position(t, y);
        let rates = model.constraint_rates(&position, &y.qd);
        let step = correction(model, t, &position, S::STARTED_RATES, &rates)?;
        let qd = y.qd.plus(R::constant(-1.0), &[1.0], [&step]);
        let left =
            model.worst(&model.constraint_rates(&position, &qd), &model.rate_tolerances(&position, &qd)).0;
        if left <= model.worst(&rates, &model.rate_tolerances(&position, &y.qd)).0 {
            y.qd = qd;
        }
    }
    Ok(())
}

/// The position next to `q` (N) at `t` (s) in which the rows hold, the coordinates `held` as they are and the others moved
/// the shortest way in the reference metric.
///
/// # Errors
/// [`Failure::NonFinite`]; [`Failure::OffConstraints`] where the others cannot meet the rows.
pub fn closed<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    q: &[R; N],
    held: &[u16],
) -> Result<[R; N], Failure> {
    let parameters = mechanism.parameters();
    let metric = Metric::next_to(mechanism, &parameters, t, q);
    let model =
        Model { mechanism, parameters: &parameters, metric: &metric, balanced: false, rank_rises: false };
    let (zero, states) = (R::constant(0.0), mechanism.start_states(&parameters));
    let mut y = State { q: *q, qd: [zero; N], states, work: zero };
    model.check(t, &y)?;
    close(&model, t, &mut y, held, &mut Counts::default())?;
    Ok(y.q)
}

/// Before: coordinates next to the rows. After: the rows hold as far as rounding lets them, the coordinates `held` are as they
/// were and the others moved the shortest way in the reference metric.
///
/// # Errors
/// [`Failure::OffConstraints`] where the others cannot meet the rows; the coordinates are then of no use.
pub(super) fn close<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut State<R, N, S::States>,
    held: &[u16],
    counts: &mut Counts,
) -> Result<(), Failure> {
    for _ in 0..MOST_CORRECTIONS {
        let position = model.position(t, y);
        let phi = model.mechanism.phi(model.parameters, &position);
        if model.worst(&phi, &model.position_tolerances(&position, &y.q)).0 <= R::constant(1.0) {
            break;
        }
        let step = correction(model, t, &position, held, &phi)?;
        let mut largest = R::constant(LARGEST_STEP);
        for (step, scale) in step.iter().zip(&model.metric.coordinates) {
            largest = largest.max((*step / *scale).abs());
        }
        counts.corrections += 1;
        y.q = y.q.plus(-R::constant(LARGEST_STEP) / largest, &[1.0], [&step]);
    }
    let position = model.position(t, y);
    let phi = model.mechanism.phi(model.parameters, &position);
    model.require(t, &phi, &model.position_tolerances(&position, &y.q), R::constant(1.0), false)
}

/// The shortest step (N) in the metric that takes `residuals` (M) away and leaves the coordinates `held`.
fn correction<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    position: &S::Position,
    held: &[u16],
    residuals: &[R; M],
) -> Result<[R; N], Failure> {
    let zero = R::constant(0.0);
    let mut phi_q = model.mechanism.phi_q(model.parameters, position);
    for row in &mut phi_q {
        for column in held {
            if let Some(entry) = row.get_mut(usize::from(*column)) {
                *entry = zero;
            }
        }
    }
    let system = System::new(&model.metric.mass(), &phi_q, model.metric);
    let factors = system.factorize_rank_revealing(R::constant(WEAKEST), S::COORDINATES, t)?;
    Ok(factors.solve(&[zero; N], residuals).0)
}
