//! Start of a motion from forces.

use mbs_runtime::dynamics::MovedStart;
use mbs_runtime::{Dynamic, Newton, Outcome, Partitioned};

use crate::erased::branching::Judging;
use crate::motion::Motion;

/// Residual of a row in the reference metric, or of its rate (1/s), that counts as met: numbers typed with nine digits.
const MET: f64 = 1e-8;

/// Margin of the dependent columns below which rates are not completed through them: half their digits would be lost.
const LEAST_MARGIN: f64 = 1e-6;

/// Coordinates and velocities (N each) of a start.
pub type Start<const N: usize> = ([f64; N], [f64; N]);

/// The text's start at `t` (s). If it violates the rows, dependent coordinates and velocities are solved from the independent
/// ones; if that fails, the text's numbers remain, for a projection to begin with.
pub(crate) fn start<S, const N: usize, const M: usize>(mechanism: &S, t: f64) -> Start<N>
where
    S: Dynamic<f64, N, M> + Partitioned<f64, N, M>,
{
    let parameters = mechanism.parameters();
    let scales = mechanism.row_scales(&parameters);
    let met = |residuals: &[f64; M]| residuals.iter().zip(&scales).all(|(r, scale)| (r / scale).abs() <= MET);
    let guess = mechanism.guess(&parameters);
    let mut q = guess;
    if !met(&mechanism.phi(&parameters, &mechanism.position(&parameters, &q, t))) {
        let lengths = mechanism.coordinate_scales(&parameters);
        let extent = guess.iter().zip(lengths).map(|(q, scale)| (q / scale).abs()).fold(1.0, f64::max);
        let mut newton = Newton::new(extent);
        let outcome = mechanism.solve_dependent(&parameters, &mut q, t, &mut Judging::declared(&mut newton));
        if outcome.iter().any(|outcome| *outcome != Outcome::Converged) {
            q = guess;
        }
    }
    let position = mechanism.position(&parameters, &q, t);
    let (moving, phi_q) = (mechanism.phi_t(&parameters, &position), mechanism.phi_q(&parameters, &position));
    let mut qd = mechanism.start_rates(&parameters);
    let mut rates = moving;
    for (rate, row) in rates.iter_mut().zip(&phi_q) {
        *rate += row.iter().zip(&qd).map(|(entry, qd)| entry * qd).sum::<f64>();
    }
    if !met(&rates) {
        let (partition, margin) = mechanism.partition(&parameters, &position);
        if LEAST_MARGIN < margin.value {
            mechanism.complete(&partition, &moving.map(|rate| -rate), &mut qd);
        }
    }
    (q, qd)
}

/// The text's numbers.
pub(crate) fn text_start<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    _t: f64,
) -> Start<N> {
    let parameters = mechanism.parameters();
    (mechanism.guess(&parameters), mechanism.start_rates(&parameters))
}

/// Change of a rate (1/s, in the reference metric) below which it counts as kept: one scale in 1000 seconds.
const REST: f64 = 1e-3;

/// The number declared by `start` that differs most from the beginning of `motion`: a coordinate, or, if none was moved, a rate;
/// none if all are kept to nine digits.
pub(crate) fn moved_start<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    motion: &Motion,
) -> Option<MovedStart<f64>> {
    let parameters = mechanism.parameters();
    let scales = mechanism.coordinate_scales(&parameters);
    let (q, qd) = (mechanism.guess(&parameters), mechanism.start_rates(&parameters));
    let actual: Vec<[f64; 2]> = motion
        .coordinates
        .iter()
        .map(|curve| [&curve.q, &curve.qd].map(|values| values.first().copied().unwrap_or(f64::NAN)))
        .collect();
    let most = |indices: &[u16], declared: &[f64; N], rate: bool, unit: &dyn Fn(f64, f64) -> f64| {
        let mut worst = (MET, None);
        for index in indices.iter().map(|index| usize::from(*index)) {
            let (coordinate, declared) = (*S::COORDINATES.get(index)?, *declared.get(index)?);
            let actual = actual.get(index)?[usize::from(rate)];
            let change = ((actual - declared) / unit(*scales.get(index)?, declared)).abs();
            if worst.0 < change {
                worst = (change, Some(MovedStart { coordinate, rate, declared, actual }));
            }
        }
        worst.1
    };
    let speeds = qd.iter().zip(&scales).map(|(qd, scale)| (qd / scale).abs());
    let speed = speeds.fold(REST, f64::max);
    most(S::STARTED, &q, false, &|scale, declared| scale.max(declared.abs()))
        .or_else(|| most(S::STARTED_RATES, &qd, true, &|scale, _| scale * speed))
}
