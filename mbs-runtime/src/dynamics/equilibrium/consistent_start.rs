//! The start of a text: declared values stay as declared, the rows give the rest.

use crate::block_solvers::multistart::displaced;
use crate::dynamics::equilibrium::dead_centre;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::{Factors, System};
use crate::dynamics::model::metric::{Metric, worse};
use crate::dynamics::model::{Counts, Model};
use crate::failure::{Failure, FailureKind, checks};
use crate::linear_algebra::vectors::dot;
use crate::mechanism::Entry;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{motion, positions, singular};

/// Corrections of a start. Next to a position where the coordinates that may move lose rank each halves the distance alone: half
/// the digits of an `f64` take 26, and as many lead there.
const MOST_CORRECTIONS: u32 = 60;

/// Largest change of an angle in one correction (rad), as in the search for an assembly.
const LARGEST_STEP: f64 = 0.5;

/// Halvings of a correction that does not lower the residual, before the search is given up.
const HALVINGS: u32 = 10;

/// Starts tried besides the text's guess for the coordinates without a declaration, as in the search for an assembly.
const OTHER_STARTS: u32 = 32;

/// The declared number of a start that differs most from the one that the motion begins with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedStart<R> {
    /// The coordinate.
    pub coordinate: Entry,
    /// `true` if its rate was changed, and not the coordinate itself.
    pub rate: bool,
    /// As declared, in the coordinate's unit (per second).
    pub declared: R,
    /// As the motion begins, in the same unit.
    pub actual: R,
}

/// Entry of a start that was moved most: of the coordinates `q` or, if none of them was moved, of the rates `qd`. `None` if all
/// were kept to nine digits.
///
/// `declared`: as the start was given; `y`: as the motion begins.
pub(crate) fn moved<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    declared: &IntegratorState<R, N, S::States>,
    y: &IntegratorState<R, N, S::States>,
    (q, qd): (&[u16], &[u16]),
) -> Option<MovedStart<R>> {
    let speed = motion::AT_REST.of::<R>().max(model.largest(&declared.qd)).max(model.largest(&y.qd));
    let place = |scale: R, declared: R| scale.max(declared.abs());
    most_moved(model, (&declared.q, &y.q), q, place).or_else(|| {
        let moved = most_moved(model, (&declared.qd, &y.qd), qd, |scale, _| scale * speed)?;
        Some(MovedStart { rate: true, ..moved })
    })
}

/// The entry of `indices` that was moved most from `before` to `after` (N each), in the unit that `unit` makes of its
/// scale and its value before.
fn most_moved<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (before, after): (&[R; N], &[R; N]),
    indices: &[u16],
    unit: impl Fn(R, R) -> R,
) -> Option<MovedStart<R>> {
    let allowed = positions::OF_START.of::<R>();
    let mut worst = (allowed, None);
    for index in indices {
        let at = |values: &[R; N]| values.get(usize::from(*index)).copied();
        let Some(((declared, actual), scale)) = at(before).zip(at(after)).zip(at(&model.metric.coordinates))
        else {
            continue;
        };
        let change = ((actual - declared) / unit(scale, declared)).abs();
        if worst.0 < change {
            let coordinate = checks::entry(S::COORDINATES, *index);
            worst = (change, Some(MovedStart { coordinate: *coordinate, rate: false, declared, actual }));
        }
    }
    worst.1
}

/// Before: the text's guesses and rates. After: the rows hold as far as coordinates and rates without a declaration can
/// do it, the shortest way in the reference metric. If they cannot, the state is unchanged.
///
/// If the guess leads to no position of the declared branches, other starts are tried, as in the search for an assembly.
pub(crate) fn complete<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut IntegratorState<R, N, S::States>,
    counts: &mut Counts,
) -> Result<(), Failure> {
    if const { S::STARTED.is_empty() } {
        return Ok(());
    }
    if let Some(q) = completed(model, t, y, counts) {
        y.q = q;
    }
    if const { !S::STARTED_RATES.is_empty() } {
        let position = model.position(t, y);
        let rates = model.constraint_rates(&position, &y.qd);
        let (q, qd) = completed_rates(model, t, y, (&position, &rates))?;
        let before = model.worst(&rates, &model.rate_tolerances(&position, &y.qd)).0;
        let position = model.mechanism.position(model.parameters, &q, t);
        let left =
            model.worst(&model.constraint_rates(&position, &qd), &model.rate_tolerances(&position, &qd)).0;
        // As far off as before is a rate that nothing can take back, but for the rounding of the others.
        if left <= before * (R::constant(1.0) + positions::OF_START.of()) {
            (y.q, y.qd) = (q, qd);
        }
        require_decided(model, t, y)?;
    }
    Ok(())
}

/// Before: a state of which the coordinates `carried` and their rates come from another motion. After: the rows hold as far as the
/// other coordinates and their rates can do it, the shortest way in the reference metric.
///
/// # Errors
/// [`NonFinite`](FailureKind::NonFinite), [`SingularMass`](FailureKind::SingularMass).
pub(crate) fn follow<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut IntegratorState<R, N, S::States>,
    carried: &[u16],
    counts: &mut Counts,
) -> Result<(), Failure> {
    if carried.len() == N {
        return Ok(());
    }
    let mut closed = *y;
    if close(model, t, &mut closed, carried, counts).is_ok() {
        y.q = closed.q;
    }
    let position = model.position(t, y);
    let system = free_columns(model, &position, carried);
    let factors = system.factorize_rank_revealing(singular::DOUBTFUL.of(), S::COORDINATES, t)?;
    let rates = model.constraint_rates(&position, &y.qd);
    y.qd = y.qd.plus(R::constant(-1.0), &[1.0], [&factors.solve(&[R::constant(0.0); N], &rates).0]);
    Ok(())
}

/// Position and rates (N each) with the rates without a declaration such that the rows' `rates` (M) vanish.
///
/// If the columns of the others have a singular value σ, rounding leaves ε/σ of the position open, and ε/σ² of the rate along
/// its direction is in doubt. There the second derivative of the rows decides. With ν the left singular vector, νᵀγ is σ times an
/// acceleration, 0 but for σ itself. The position is then the one at which this rate meets the rows, within their rounding.
///
/// Along the way out of a [dead centre](dead_centre) that rounding does not tell from the position no rate is taken.
fn completed_rates<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
    (position, rates): (&S::Position, &[R; M]),
) -> Result<([R; N], [R; N]), Failure> {
    let (zero, one, back) = (R::constant(0.0), R::constant(1.0), R::constant(-1.0));
    let none = [zero; N];
    let system = free_columns(model, position, S::STARTED_RATES);
    let truncation = dead_centre::truncation(model, t, y, &system, rates)?;
    let factors = system.factorize_rank_revealing(truncation, S::COORDINATES, t)?;
    let found = y.qd.plus(back, &[1.0], [&factors.solve(&none, rates).0]);
    let without = system.factorize_rank_revealing(singular::DOUBTFUL.of(), S::COORDINATES, t)?;
    if without.rank() + 1 != factors.rank() {
        return Ok((y.q, found));
    }
    let certain = y.qd.plus(back, &[1.0], [&without.solve(&none, rates).0]);
    let along = found.plus(back, &[1.0], [&certain]);
    let weak = weak_combination(&factors, &without);
    let weighed = |values: [R; M]| dot(&weak, &weighed(values, &factors));
    let bent = |share: R| {
        let qd = certain.plus(share, &[1.0], [&along]);
        weighed(model.mechanism.gamma(model.parameters, position, &qd))
    };
    let share = root_next_to_one(bent(zero), bent(one), bent(back));
    let qd = certain.plus(share, &[1.0], [&along]);
    let mut direction = along;
    for index in S::STARTED.iter().map(|index| usize::from(*index)) {
        direction.iter_mut().skip(index).take(1).for_each(|component| *component = zero);
    }
    let reach = R::EPSILON.sqrt() / model.largest(&direction);
    let displaced = |share: R| y.q.plus(share, &[1.0], [&direction]);
    let open = |share: R| {
        let position = model.mechanism.position(model.parameters, &displaced(share), t);
        weighed(model.constraint_rates(&position, &qd))
    };
    let (here, beside) = (open(zero), open(reach));
    let q = displaced(reach * here / (here - beside));
    let position = model.mechanism.position(model.parameters, &q, t);
    let phi = model.mechanism.phi(model.parameters, &position);
    let closes = model.worst(&phi, &model.position_tolerances(&position, &q)).0 <= one;
    Ok(if closes { (q, qd) } else { (y.q, found) })
}

/// `values` (M) of the rows in the metric of `factors`.
pub(crate) fn weighed<R: Real, const N: usize, const M: usize>(
    mut values: [R; M],
    factors: &Factors<R, N, M>,
) -> [R; M] {
    values.iter_mut().zip(factors.row_scales()).for_each(|(value, scale)| *value = *value / *scale);
    values
}

/// Fails where the rows lose rank and no accelerations belong to the rates: motions part there, and the rates are of none of them.
pub(crate) fn require_decided<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
) -> Result<(), Failure> {
    let zero = R::constant(0.0);
    let position = model.position(t, y);
    let system = free_columns(model, &position, &[]);
    let factors = system.factorize_rank_revealing(singular::DOUBTFUL.of(), S::COORDINATES, t)?;
    let gamma = weighed(model.mechanism.gamma(model.parameters, &position, &y.qd), &factors);
    let speed = model.largest(&y.qd);
    let allowed = singular::UNANSWERED.of::<R>() * dot(&gamma, &gamma).sqrt()
        + singular::DOUBTFUL.of::<R>() * speed * speed;
    let shares = factors.idle_shares();
    if shares.iter().any(|share| allowed < dot(share, &gamma).abs()) {
        let margin = system.factorize_rank_revealing(zero, S::COORDINATES, t)?.margin();
        return Err(FailureKind::undecided(margin).at(t.to_f64()));
    }
    Ok(())
}

/// The combination of rows (M, in the metric) that is dependent in `without` and not in `factors`, of which there is one.
fn weak_combination<R: Real, const N: usize, const M: usize>(
    factors: &Factors<R, N, M>,
    without: &Factors<R, N, M>,
) -> [R; M] {
    let zero = R::constant(0.0);
    let (known, mut longest) = (factors.idle_shares(), (zero, [zero; M]));
    for share in without.idle_shares() {
        let own = known.iter().fold(share, |own, known| own.plus(-dot(&own, known), &[1.0], [known]));
        let length = dot(&own, &own);
        if longest.0 < length {
            longest = (length, own);
        }
    }
    longest.1
}

/// Of a quadratic with these values at 0, 1 and −1 the root nearest to 1, if it is within 1 of it; else 1.
fn root_next_to_one<R: Real>(at_zero: R, at_one: R, at_back: R) -> R {
    let (half, one) = (R::constant(0.5), R::constant(1.0));
    let (linear, square) = (half * (at_one - at_back), half * (at_one + at_back) - at_zero);
    let root = (linear * linear - R::constant(4.0) * square * at_zero).max(R::constant(0.0)).sqrt();
    // Without cancellation: the sum of two numbers of one sign.
    let sum = -half * if linear < R::constant(0.0) { linear - root } else { linear + root };
    [sum / square, at_zero / sum]
        .into_iter()
        .fold((one, one), |nearest, root| {
            let distance = (root - one).abs();
            if distance < nearest.1 { (root, distance) } else { nearest }
        })
        .0
}

/// The position that [`complete`] looks for; of several the first in the declared branches, else the first.
fn completed<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
    counts: &mut Counts,
) -> Option<[R; N]> {
    let mut first = None;
    let mut angles = [false; N];
    angles.iter_mut().zip(S::COORDINATES).for_each(|(angle, entry)| *angle = entry.is_angle());
    for start in 0..=OTHER_STARTS {
        let mut from = *y;
        if start > 0 {
            from.q = displaced(&y.q, &angles, &model.metric.coordinates, start, OTHER_STARTS);
            for index in S::STARTED.iter().map(|index| usize::from(*index)) {
                if let Some((place, declared)) = from.q.get_mut(index).zip(y.q.get(index)) {
                    *place = *declared;
                }
            }
        }
        if close(model, t, &mut from, S::STARTED, counts).is_err() {
            continue;
        }
        if model.check_assembly(t, (t, &from), true).is_ok() {
            return Some(from.q);
        }
        first = first.or(Some(from.q));
    }
    first
}

/// The position next to `q` (N) at `t` (s) in which the rows hold. The coordinates `held` stay as they are, the others
/// move the shortest way in the reference metric.
///
/// # Errors
/// [`FailureKind::NonFinite`]; [`FailureKind::OffConstraints`] where the others cannot meet the rows.
pub fn closed<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    q: &[R; N],
    held: &[u16],
) -> Result<[R; N], Failure> {
    let parameters = mechanism.parameters();
    let metric = Metric::next_to(mechanism, &parameters, t, q);
    let model = Model::of_states(mechanism, &parameters, &metric);
    let (zero, states) = (R::constant(0.0), mechanism.start_states(&parameters));
    let mut y = IntegratorState { q: *q, qd: [zero; N], states, work: zero };
    model.check(t, &y)?;
    close(&model, t, &mut y, held, &mut Counts::default())?;
    Ok(y.q)
}

/// Before: coordinates next to the rows. After: the rows hold as far as rounding lets them, the coordinates `held` are as they
/// were and the others moved the shortest way in the reference metric.
///
/// # Errors
/// [`FailureKind::OffConstraints`] where the others cannot meet the rows; the coordinates are then of no use.
pub(crate) fn close<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut IntegratorState<R, N, S::States>,
    held: &[u16],
    counts: &mut Counts,
) -> Result<(), Failure> {
    let one = R::constant(1.0);
    for _ in 0..MOST_CORRECTIONS {
        let position = model.position(t, y);
        let phi = model.mechanism.phi(model.parameters, &position);
        let closed = model.worst(&phi, &model.position_tolerances(&position, &y.q)).0 <= one;
        let system = free_columns(model, &position, held);
        let factors = system.factorize_rank_revealing(singular::WEAKEST_OF_START.of(), S::COORDINATES, t)?;
        if closed && singular::ZONE_OF_FORCES.of::<R>() < factors.margin() {
            return Ok(());
        }
        let (step, _) = factors.solve(&[R::constant(0.0); N], &phi);
        counts.corrections += 1;
        let Some(q) = corrected(model, t, y, &step, open(model, &phi)) else { break };
        y.q = q;
    }
    let position = model.position(t, y);
    let phi = model.mechanism.phi(model.parameters, &position);
    model.require(t, &phi, &model.position_tolerances(&position, &y.q), one, false)
}

/// `y.q` less `step` or a part of it, with a residual below `before`; `None` where no part has one.
fn corrected<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
    step: &[R; N],
    before: R,
) -> Option<[R; N]> {
    let limit = R::constant(LARGEST_STEP);
    let angles = step.iter().zip(S::COORDINATES).filter(|(_, entry)| entry.is_angle());
    let largest = angles.fold(limit, |largest, (step, _)| largest.max(step.abs()));
    let mut share = limit / largest;
    for _ in 0..=HALVINGS {
        let q = y.q.plus(-share, &[1.0], [step]);
        let position = model.mechanism.position(model.parameters, &q, t);
        if open(model, &model.mechanism.phi(model.parameters, &position)) < before {
            return Some(q);
        }
        share = share * R::constant(0.5);
    }
    None
}

/// The largest residual over its row's scale.
fn open<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    phi: &[R; M],
) -> R {
    let ratios = phi.iter().zip(&model.metric.rows).map(|(residual, scale)| (*residual / *scale).abs());
    ratios.fold(R::constant(0.0), worse)
}

/// The rows in the reference metric without the columns of the coordinates `held`.
fn free_columns<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    position: &S::Position,
    held: &[u16],
) -> System<R, N, M> {
    let zero = R::constant(0.0);
    let mut phi_q = model.mechanism.phi_q(model.parameters, position);
    for row in &mut phi_q {
        for column in held {
            if let Some(entry) = row.get_mut(usize::from(*column)) {
                *entry = zero;
            }
        }
    }
    System::new(&model.metric.mass(), &phi_q, model.metric)
}
