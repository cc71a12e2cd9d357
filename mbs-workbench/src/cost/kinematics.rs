//! The study of a motion from drives: positions solved in all digits, rates by two ways, all settings against them.

use mbs_runtime::Scalar;

use crate::cost::advice::two_digits;
use crate::cost::moved::{NoReference, WIDTHS};
use crate::cost::points::{Errors, Expected, Outcome, Point, Verdict, WRONG, judge_by_order};
use crate::cost::reference::linear::{Matrix, worse};
use crate::double_double::DoubleDouble as D;
use crate::erased::costs::DrivenCosts;
use crate::erased::timed_runs::Effort;
use crate::erased::timed_steps::{ExactPositions, Placed};
use crate::setting::{Closing, Kernel, Numbers, Setting};

/// Instants of the reference: a quarter of a degree over a turn.
pub const PARTS: u32 = 1440;

/// Steps of the settings over the span, all divisors of [`PARTS`].
const STEPS: [u32; 9] = [24, 36, 48, 72, 120, 180, 360, 720, 1440];

/// Budgets of a step, evaluations a block.
const BUDGETS: [u32; 3] = [1, 2, 3];

/// Runs of which the shortest time counts.
const RUNS: u32 = 5;

/// Digits that positions are solved in.
pub(super) struct Digits {
    /// Distance of the instants of a difference, as part of the span.
    distance: f64,
    /// Corrections that no longer fall are rounding below it.
    rounding: f64,
    /// Least width of positions, over the largest coordinate; none where all digits are known.
    width: Option<f64>,
}

impl Digits {
    /// Those of a mechanism with these functions in `f64` alone.
    pub(super) fn of(doubles: &[&str]) -> Self {
        if doubles.is_empty() { ALL } else { DOUBLES }
    }
}

/// Those of double-double numbers.
const ALL: Digits = Digits { distance: 1e-5, rounding: 1e-24, width: None };

/// Those where a function of the caller has the digits of `f64`. It jumps by a rounding half-way between two neighbours of `f64`, so a row
/// with a coordinate in its argument may be above 0 on one side and below 0 on the other one, and 0 nowhere. Corrections then lead to and
/// fro over the jump. Rounding of the rates grows with the square of the distance's inverse.
const DOUBLES: Digits = Digits { distance: 1e-4, rounding: 1e-12, width: Some(4.0 * f64::EPSILON) };

/// Weights of the central difference of order 8.
const WEIGHTS: [(f64, f64); 4] = [(4.0, 5.0), (-1.0, 5.0), (4.0, 105.0), (-1.0, 280.0)];

/// A study of a motion from drives.
#[derive(Clone, Debug)]
pub struct DrivenStudy {
    /// All points, curve by curve.
    pub points: Vec<Point>,
    /// Largest difference of the rates by the rows and by differences of positions.
    pub width: f64,
    /// Width of positions, where functions of the caller have the digits of `f64`; none of positions in all digits.
    pub width_of_positions: Option<f64>,
    /// Time (s), q and q̇ (N each) of the reference at each instant.
    pub motion: Vec<(f64, [Vec<D>; 2])>,
    /// Reference metric of the coordinates: N.
    pub scales: Vec<f64>,
}

impl DrivenStudy {
    /// The reference in words.
    pub fn reference(&self) -> String {
        let closed = match self.width_of_positions {
            None => "29 digits in double-double numbers".to_string(),
            Some(width) => {
                format!("the rounding of functions in `f64`, {} of the largest coordinate", two_digits(width))
            }
        };
        format!("positions closed to {closed}; rates by differences of positions")
    }
}

/// Exact positions and rates at an instant.
pub(super) struct Exactly {
    pub(super) q: Vec<D>,
    qd: Vec<D>,
    qdd: Vec<D>,
    /// Largest distance over which its positions stay open, in the reference metric.
    open: f64,
}

/// Corrections of a position.
const CORRECTIONS: usize = 30;

/// The position nearest to `guess` at `t` (s) that closes to all `digits`, with its last correction in the reference metric.
fn solved(exact: &dyn ExactPositions, digits: &Digits, guess: &[D], t: D) -> Option<(Vec<D>, f64)> {
    let mut q = guess.to_vec();
    let mut last = f64::INFINITY;
    for _ in 0..CORRECTIONS {
        let [phi, phi_q] = exact.rows(&q, t);
        let step = correction(exact, &phi, &phi_q)?;
        let [scales, _] = exact.scales();
        let size = step.iter().zip(&scales).map(|(step, scale)| step.high.abs() / scale).fold(0.0, worse);
        for (q, step) in q.iter_mut().zip(&step) {
            *q = *q + *step;
        }
        if size <= 1e-29 || size >= 0.5 * last && size < digits.rounding {
            return Some((q, size));
        }
        if size.is_nan() {
            return None;
        }
        last = size;
    }
    None
}

/// The shortest x with Φ_q x = −`open`, in the reference metric.
fn correction(exact: &dyn ExactPositions, open: &[D], phi_q: &[D]) -> Option<Vec<D>> {
    let [n, m] = exact.sizes();
    let [scales, _] = exact.scales();
    let mut metric = vec![D::constant(0.0); n * n];
    for (j, scale) in scales.iter().enumerate() {
        metric[j * n + j] = D::constant(1.0) / (D::constant(*scale) * D::constant(*scale));
    }
    let matrix = Matrix::saddle(n, m, &metric, |i, j| phi_q[j * n + i], phi_q);
    let mut right = vec![D::constant(0.0); n];
    right.extend(open.iter().map(|open| -*open));
    matrix.solve(&matrix.factors(), &right).map(|found| found[..n].to_vec())
}

/// The derivative of `value` at `t` (s) by differences over `h` (s).
fn derivative(value: &dyn Fn(D) -> Option<Vec<D>>, t: D, h: D) -> Option<Vec<D>> {
    let mut sum: Option<Vec<D>> = None;
    for (k, (over, under)) in WEIGHTS.iter().enumerate() {
        let distance = h * D::constant((k + 1) as f64);
        let (ahead, behind) = (value(t + distance)?, value(t - distance)?);
        let weight = D::constant(*over) / D::constant(*under) / h;
        let part = ahead.iter().zip(&behind).map(|(a, b)| weight * (*a - *b));
        sum = Some(match sum {
            None => part.collect(),
            Some(sum) => sum.iter().zip(part).map(|(sum, part)| *sum + part).collect(),
        });
    }
    sum
}

/// Reason why there is no exact position at `t` (s), where the row `wide` may contradict others by a width.
pub(super) fn open_rows(t: f64, wide: Option<&str>) -> String {
    let open = format!("a position at t = {t:.4} s does not close to all digits");
    match wide {
        Some(row) => format!(
            "{open}: `{row}` follows from other rows within a width, so nothing fulfils all of them; compare a scene without it"
        ),
        None => open,
    }
}

/// Exact motion at `t` (s) next to the position `q`: rates by differences of positions over `h` (s), and the largest difference of the
/// rates that Φ_t and γ give.
fn exactly(
    exact: &dyn ExactPositions,
    digits: &Digits,
    q: &[f64],
    t: f64,
    h: D,
) -> Option<(Exactly, [f64; 2])> {
    let t = D::constant(t);
    let guess: Vec<D> = q.iter().map(|q| D::constant(*q)).collect();
    let (q, open) = solved(exact, digits, &guess, t)?;
    let position = |at: D| solved(exact, digits, &q, at).map(|(q, _)| q);
    let qd = derivative(&position, t, h)?;
    let rate = |at: D| derivative(&position, at, h);
    let qdd = derivative(&rate, t, h)?;
    let [_, phi_q] = exact.rows(&q, t);
    let [phi_t, _] = exact.rates(&q, &qd, t);
    let by_rows = correction(exact, &phi_t, &phi_q)?;
    let [_, gamma] = exact.rates(&q, &by_rows, t);
    let minus_gamma: Vec<D> = gamma.iter().map(|gamma| -*gamma).collect();
    let second = correction(exact, &minus_gamma, &phi_q)?;
    let apart = |a: &[D], b: &[D]| {
        let [scales, _] = exact.scales();
        a.iter().zip(b).zip(&scales).map(|((a, b), scale)| (*a - *b).high.abs() / scale).fold(0.0, worse)
    };
    let apart = [apart(&qd, &by_rows), apart(&qdd, &second)];
    Some((Exactly { q, qd, qdd, open }, apart))
}

/// Exact positions and rates at the instants of a run.
pub(super) struct ExactMotion {
    pub(super) reference: Vec<Exactly>,
    /// Largest differences of q̇ and q̈ by differences of positions and by the rows.
    pub(super) apart: [f64; 2],
}

/// The exact motion next to a run over `until` (s), which was begun at its first position.
pub(super) fn exact_motion(
    exact: &dyn ExactPositions,
    digits: &Digits,
    followed: &[Placed<f64>],
    until: f64,
    progress: &mut dyn FnMut(f64),
) -> Result<ExactMotion, NoReference> {
    let h = D::constant(until * digits.distance);
    let mut found = ExactMotion { reference: Vec::new(), apart: [0.0; 2] };
    for (index, placed) in followed.iter().enumerate() {
        if index % 16 == 0 {
            progress(index as f64 / followed.len() as f64);
        }
        let known = exactly(exact, digits, &placed.motion[0], placed.t, h);
        let no_reference = || NoReference { reason: open_rows(placed.t, exact.row_with_width()) };
        let (exactly, apart) = known.ok_or_else(no_reference)?;
        found.apart = [0, 1].map(|k| worse(found.apart[k], apart[k]));
        found.reference.push(exactly);
    }
    Ok(found)
}

impl ExactMotion {
    /// Width of positions over `size`, the largest coordinate; none of positions in all digits.
    pub(super) fn width(&self, digits: &Digits, size: f64) -> Option<f64> {
        let open = self.reference.iter().map(|exact| exact.open).fold(0.0, worse);
        digits.width.map(|least| worse(least, open / size))
    }
}

/// Compares all settings of `mechanism` over `until` (s), in a program that was built with `kernel`.
///
/// # Errors
/// [`NoReference`] where the motion cannot be followed, or a position cannot be solved to all digits.
pub fn driven_study(
    mechanism: &mut DrivenCosts,
    (until, longest): (f64, f64),
    kernel: Kernel,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<DrivenStudy, NoReference> {
    let no_reference = |reason: String| NoReference { reason };
    let times: Vec<f64> = (0..=PARTS).map(|k| until * f64::from(k) / f64::from(PARTS)).collect();
    let single = |(numbers, lanes, _): &&(Numbers, u32, _)| *numbers == Numbers::Double && *lanes == 1;
    let path = mechanism.runs.iter().find(single);
    let (_, _, path) = path.ok_or_else(|| no_reference("there are no runs in f64".to_string()))?;
    let mut followed: Vec<Placed<f64>> = Vec::new();
    path.run(Closing::Closed, &times, Some(&mut |placed| followed.push(placed)))
        .map_err(|failure| no_reference(failure.to_string()))?;
    let first = followed.first().map(|placed| placed.motion[0].clone()).unwrap_or_default();
    mechanism.exact.begin(0.0, &first);
    let digits = Digits::of(&mechanism.doubles);
    let exact = mechanism.exact.as_ref();
    let known =
        exact_motion(exact, &digits, &followed, until, &mut |share| progress("reference", 0.3 * share));
    let known = known?;
    let (reference, apart) = (&known.reference, known.apart);
    let [scales, _] = mechanism.exact.scales();
    let largest = |of: &dyn Fn(&Exactly) -> &Vec<D>| {
        let values = reference.iter().flat_map(|exact| of(exact).iter().zip(&scales));
        let largest = values.map(|(value, scale)| value.high.abs() / scale).fold(0.0, f64::max);
        if largest > 0.0 { largest } else { 1.0 }
    };
    let sizes = [largest(&|exact| &exact.q), largest(&|exact| &exact.qd), largest(&|exact| &exact.qdd)];
    let width = worse(apart[0] / sizes[1], apart[1] / sizes[2]);
    let width_of_positions = known.width(&digits, sizes[0]);
    let judge = |run: &[Placed<f64>]| -> Option<Errors> {
        let stride = reference.len().checked_sub(1)? / run.len().checked_sub(1)?.max(1);
        let mut all = Vec::new();
        let mut found = [0.0_f64; 3];
        for (placed, exact) in run.iter().zip(reference.iter().step_by(stride.max(1))) {
            let of = |values: &[f64], exact: &[D], size: f64| {
                let pairs = values.iter().zip(exact).zip(&scales);
                pairs
                    .map(|((value, exact), scale)| ((value - exact.high) - exact.low).abs() / scale / size)
                    .fold(0.0, worse)
            };
            let here = [
                of(&placed.motion[0], &exact.q, sizes[0]),
                of(&placed.motion[1], &exact.qd, sizes[1]),
                of(&placed.motion[2], &exact.qdd, sizes[2]),
            ];
            all.push(here[0]);
            found = [0, 1, 2].map(|k| worse(found[k], here[k]));
        }
        all.sort_by(f64::total_cmp);
        let median = all.get(all.len() / 2).copied().unwrap_or(0.0);
        Some(Errors {
            judged: found[0],
            median,
            rate: found[1],
            second: found[2],
            energy: 0.0,
            violation: 0.0,
            ..Errors::unknown()
        })
    };
    let mut points = Vec::new();
    for (index, (numbers, lanes, run)) in mechanism.runs.iter().enumerate() {
        let closings: Vec<Closing> = match lanes {
            1 => BUDGETS.map(Closing::Evaluations).into_iter().chain([Closing::Closed]).collect(),
            _ => vec![Closing::Closed],
        };
        for closing in closings {
            let share = 0.3 + 0.4 * index as f64 / mechanism.runs.len() as f64;
            let setting =
                |steps| Setting::Kinematics { numbers: *numbers, lanes: *lanes, closing, steps, kernel };
            progress(&setting(0).curve(), share);
            let mut last: Option<(f64, u32)> = None;
            let first = points.len();
            for steps in STEPS {
                let stride = PARTS / steps;
                let own: Vec<f64> = times.iter().copied().step_by(stride as usize).collect();
                let mut seen = Vec::new();
                let ran = run.run(closing, &own, Some(&mut |placed| seen.push(placed)));
                let timed = ran.and_then(|_| run.run(closing, &own, None));
                match timed {
                    Err(failure) => {
                        let outcome = Outcome::Refused(failure.to_string());
                        let effort = Effort::default();
                        points.push(Point {
                            setting: setting(steps),
                            outcome,
                            effort,
                            time: f64::NAN,
                            perturbed: None,
                        });
                        last = None;
                    }
                    Ok(effort) => {
                        let Some(mut errors) = judge(&seen) else { continue };
                        let expected = expected(closing, last, steps);
                        let before = last.map_or(0.0, |(error, _)| error);
                        let verdict =
                            verdict(*numbers, closing, &errors, (before, expected), width_of_positions);
                        errors.width =
                            width_of_positions.filter(|_| verdict == Verdict::Hollow).unwrap_or(0.0);
                        let expected = expected.map(|error| Expected { error, is_trusted: true });
                        let outcome = Outcome::Done { errors, expected, verdict };
                        let too_long = effort.elapsed.as_secs_f64() > longest;
                        points.push(Point {
                            setting: setting(steps),
                            outcome,
                            effort,
                            time: f64::NAN,
                            perturbed: None,
                        });
                        last = Some((errors.judged, steps));
                        if too_long {
                            break;
                        }
                    }
                }
            }
            if let Some(order) = closing.order() {
                let steps = |point: &Point| match point.setting {
                    Setting::Kinematics { steps, .. } => f64::from(steps),
                    Setting::Motion { .. } => f64::NAN,
                };
                judge_by_order(&mut points[first..], order, rounding(*numbers), steps, |_| false);
            }
        }
    }
    for round in 1..RUNS {
        progress("times", 0.7 + 0.3 * f64::from(round) / f64::from(RUNS));
        points.iter_mut().for_each(|point| time_again(mechanism, point, &times));
    }
    for point in &mut points {
        point.time = point.effort.elapsed.as_secs_f64() * 1e9 / point.effort.steps.max(1) as f64;
    }
    let motion = times.into_iter().zip(known.reference).map(|(t, exact)| (t, [exact.q, exact.qd])).collect();
    Ok(DrivenStudy { points, width, width_of_positions, motion, scales })
}

/// Errors that rounding alone explains.
fn rounding(numbers: Numbers) -> f64 {
    match numbers {
        Numbers::Double => 1e-10,
        Numbers::Single => 1e-3,
    }
}

/// Error that the next coarser point lets expect of a step that a budget ends: of order 3 in its length, that of its prediction.
fn expected(closing: Closing, last: Option<(f64, u32)>, steps: u32) -> Option<f64> {
    let last = last.filter(|_| closing != Closing::Closed);
    last.map(|(before, coarser)| before * (f64::from(coarser) / f64::from(steps)).powi(3))
}

/// A step that closes has an error of rounding at any length. Of one that a budget ends, ten times the `expected` error, and more than
/// that of the coarser point `before`, is wrong.
fn verdict(
    numbers: Numbers,
    closing: Closing,
    errors: &Errors,
    (before, expected): (f64, Option<f64>),
    width: Option<f64>,
) -> Verdict {
    let is_wrong = match (closing, expected) {
        (Closing::Closed, _) => errors.judged > rounding(numbers),
        (Closing::Evaluations(_), Some(expected)) => {
            errors.judged > (WRONG * expected).max(before).max(rounding(numbers))
        }
        (Closing::Evaluations(_), None) => false,
    };
    // Positions are known to 29 digits but where functions of the caller are not.
    match width {
        _ if is_wrong => Verdict::Wrong,
        Some(width) if errors.judged <= WIDTHS * width => Verdict::Hollow,
        _ => Verdict::Right,
    }
}

fn time_again(mechanism: &DrivenCosts, point: &mut Point, times: &[f64]) {
    let Setting::Kinematics { numbers, lanes, closing, steps, .. } = point.setting else { return };
    let found = mechanism.runs.iter().find(|(own, count, _)| *own == numbers && *count == lanes);
    let (Some((_, _, run)), Outcome::Done { .. }) = (found, &point.outcome) else { return };
    let own: Vec<f64> = times.iter().copied().step_by((PARTS / steps) as usize).collect();
    if let Ok(effort) = run.run(closing, &own, None) {
        point.effort.elapsed = point.effort.elapsed.min(effort.elapsed);
    }
}
