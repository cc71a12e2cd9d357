//! Rows that follow from others: which they are at a position, and whether their rates do too.

use crate::failure::Holding;
use crate::kinematics::largest_difference;
use crate::linear::least_margin;
use crate::redundant::{largest_width, product};
use crate::{Entry, Failure, Kinematic, Level, Mechanism, Real, Stepper};

/// The rank of Φ_q at a position and the rows that follow from the others there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Redundancy<const M: usize> {
    entries: &'static [Entry],
    dependent: [bool; M],
    /// Rank of Φ_q in the reference metric, drives included.
    pub rank: usize,
}

impl<const M: usize> Redundancy<M> {
    /// The dependent rows in the order of Φ; of rows that follow from each other the later one, a row of a constraint
    /// marked `redundant` before any other.
    pub fn rows(&self) -> impl Iterator<Item = Entry> + '_ {
        let rows = self.entries.iter().zip(&self.dependent);
        rows.filter(|(_, dependent)| **dependent).map(|(entry, _)| *entry)
    }
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// Which rows follow from the others at the present position, to be asked once behind the assembly.
    ///
    /// A row counts as dependent where less than √ε of its length in the reference metric is left beside the rows
    /// before it: marked rows are held against all others and earlier marked ones. A dead centre makes rows
    /// dependent too, so ask at a regular position.
    pub fn redundancy(&self) -> Redundancy<M> {
        let phi_q = self.mechanism.phi_q(&self.parameters, &self.position());
        let scales = self.mechanism.coordinate_scales(&self.parameters);
        let mut basis = [[R::constant(0.0); N]; N];
        let (mut dependent, mut rank) = ([false; M], 0);
        for marked in [false, true] {
            for (index, (row, dependent)) in phi_q.iter().zip(&mut dependent).enumerate() {
                if S::REDUNDANT.get(index).copied().unwrap_or(false) != marked {
                    continue;
                }
                let mut scaled = *row;
                scaled.iter_mut().zip(&scales).for_each(|(entry, scale)| *entry = *entry * *scale);
                match (remainder(scaled, &basis), basis.get_mut(rank)) {
                    (Some(direction), Some(slot)) => {
                        *slot = direction;
                        rank += 1;
                    }
                    _ => *dependent = true,
                }
            }
        }
        Redundancy { entries: S::ROWS, dependent, rank }
    }
}

/// The unit vector along what `row` has beside the span of `basis`; `None` where that is rounding.
///
/// Source: Golub & Van Loan 2013, §5.2.8 (modified Gram–Schmidt), done twice.
fn remainder<R: Real, const N: usize>(row: [R; N], basis: &[[R; N]; N]) -> Option<[R; N]> {
    let mut rest = unit(row, R::constant(0.0))?;
    for _ in 0..2 {
        for direction in basis {
            let part = dot(&rest, direction);
            rest.iter_mut().zip(direction).for_each(|(entry, along)| *entry = *entry - part * *along);
        }
    }
    unit(rest, R::EPSILON.sqrt())
}

/// `vector` made of length 1; `None` where it is no longer than `least`.
fn unit<R: Real, const N: usize>(vector: [R; N], least: R) -> Option<[R; N]> {
    let length = dot(&vector, &vector).sqrt();
    (length > least && length.is_finite()).then(|| vector.map(|entry| entry / length))
}

fn dot<R: Real, const N: usize>(a: &[R; N], b: &[R; N]) -> R {
    a.iter().zip(b).fold(R::constant(0.0), |sum, (a, b)| sum + *a * *b)
}

/// What rows may be off in their rates, in widths times the rates of the coordinates: what a text allows a position to be open
/// changes as fast as the links turn, twice as fast in accelerations.
const RATES_OF_WIDTH: f64 = 8.0;

/// Rates that solve `Φ_q x = b` in the mean, and what they are measured by.
struct RateEquations<'a, R, const N: usize, const M: usize> {
    /// x: N.
    rates: &'a [R; N],
    /// b: M.
    right: &'a [R; M],
    /// Which derivative of the position x is.
    level: Level,
    /// Size in the reference metric of what `right` was computed from, whose parts may have cancelled.
    known: R,
    /// Margin to singularity of Φ_q.
    margin: R,
    /// Largest width that the text states, in the reference metric.
    width: R,
}

/// Why the rows of a mechanism with more of them than coordinates contradict each other in their rates `qd` and `qdd` (N
/// each), if they do, at `margin` to singularity.
#[inline(never)]
pub(crate) fn disagreement<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    position: &S::Position,
    (qd, qdd): (&[R; N], &[R; N]),
    margin: R,
    t: R,
) -> Option<Failure> {
    let zero = R::constant(0.0);
    let speed = largest_difference(qd, &[zero; N], &mechanism.coordinate_scales(parameters));
    let width = largest_width(&mechanism.widths(parameters), &mechanism.row_scales(parameters));
    let (phi_t, gamma) = (mechanism.phi_t(parameters, position), mechanism.gamma(parameters, position, qd));
    let right = &phi_t.map(|rate| -rate);
    let velocities = RateEquations { rates: qd, right, level: Level::Velocity, known: zero, margin, width };
    let known = speed * speed;
    let accelerations =
        RateEquations { rates: qdd, right: &gamma, level: Level::Acceleration, known, margin, width };
    rate_failure(mechanism, parameters, position, &velocities, t)
        .or_else(|| rate_failure(mechanism, parameters, position, &accelerations, t))
}

/// [`Failure::Inconsistent`] where the rows contradict each other in a time derivative, though not in position:
/// dimensions that fit at one instant alone.
///
/// Rates are promised with half their digits at margin 1 (see [`least_margin`]) and with fewer as it falls; that is
/// what the surplus rows may be off.
fn rate_failure<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    position: &S::Position,
    rates: &RateEquations<'_, R, N, M>,
    t: R,
) -> Option<Failure> {
    let (row_scales, scales) = (mechanism.row_scales(parameters), mechanism.coordinate_scales(parameters));
    let mut open = product(&mechanism.phi_q(parameters, position), rates.rates);
    open.iter_mut().zip(rates.right).zip(&row_scales).for_each(|((open, right), scale)| {
        *open = ((*open - *right) / *scale).abs();
    });
    let mut size = rates.known;
    rates.rates.iter().zip(&scales).for_each(|(rate, scale)| size = size.max((*rate / *scale).abs()));
    rates.right.iter().zip(&row_scales).for_each(|(right, scale)| size = size.max((*right / *scale).abs()));
    let allowed = (least_margin::<R>() + R::constant(RATES_OF_WIDTH) * rates.width) / rates.margin * size;
    let (mut worst, mut unit) = (R::constant(0.0), R::constant(1.0));
    for (open, scale) in open.iter().zip(&row_scales) {
        if worst < *open {
            (worst, unit) = (*open, *scale);
        }
    }
    (allowed < worst).then(|| Failure::Inconsistent {
        rows: Holding::of(S::ROWS, open.iter().map(|open| open.to_f64())),
        level: rates.level,
        residual: (worst * unit).to_f64(),
        required: (allowed * unit).to_f64(),
        time: t.to_f64(),
    })
}
