//! The study of a motion from forces: two references, all settings, their errors and times.

use std::time::Duration;

use mbs_runtime::FailureKind;
use mbs_runtime::dynamics::ErrorEstimate;

use crate::cost::errors::{Sizes, apart, between, errors};
use crate::cost::points::{COARSEST, Errors, Expected, Outcome, Point, Verdict, WRONG, judge_by_order};
use crate::cost::reference::linear::worse;
use crate::cost::reference::motion::Stuck;
use crate::cost::reference::one_kind::{method as method_of, of_one_kind};
use crate::cost::reference::{Leg, Reference, Shot, reference};
use crate::double_double::DoubleDouble as D;
use crate::erased::costs::MovedCosts;
use crate::erased::timed_runs::{Effort, Seen};
use crate::setting::{FormulationName, MotionMethod, Numbers, Resolution, Setting};

/// Instants at which errors are taken.
pub const PARTS: u32 = 480;

/// Points whose error is below so many widths of the reference have its width as bar.
pub const WIDTHS: f64 = 100.0;

/// Steps over those of the coarser run from which on both tell the error.
const FINER: f64 = 1.1;

/// A run may take so many times as long as the finest of the first curve.
const DEAREST: f64 = 60.0;

/// Longest time (s) that a run may take in any case.
const CHEAP: f64 = 2e-3;

/// Runs of which the shortest time counts.
const RUNS: u32 = 5;

/// Width of a reference alone over its difference from one of coarser steps, whose tolerance is 1e3 times as large at least.
const ALONE: f64 = 1e-2;

/// Width of references of one kind over their difference: faults that both share do not show in it.
const ONE_KIND: f64 = 10.0;

/// Differences of the references up to which they agree.
const AGREED: f64 = 1e-6;

/// Least tolerance of references where a function of the caller has the digits of `f64`.
const LEAST_OF_DOUBLES: f64 = 1e-13;

/// Extent of a study.
#[derive(Clone, Debug)]
pub struct Extent {
    /// Methods to compare; all where empty.
    pub methods: Vec<MotionMethod>,
    /// Longest run (s): a curve ends where it is passed.
    pub longest: f64,
    /// Time (s) for each reference.
    pub reference: f64,
    /// Tolerance of the references' steps.
    pub tolerance: f64,
    /// Indices of the outputs that are judged in place of the coordinates.
    pub watched: Vec<usize>,
}

/// A study of a motion from forces.
#[derive(Clone, Debug)]
pub struct MovedStudy {
    /// All points, curve by curve.
    pub points: Vec<Point>,
    /// References by kind.
    pub references: Vec<(Leg, Reference)>,
    /// The first effect with modes, where the references are of one kind.
    pub effect: Option<&'static str>,
    /// Difference of the references in the judged quantity, ten times that of references of one kind. Of one alone a hundredth of its
    /// difference from one of coarser steps; none where there is no such one.
    pub width: Option<f64>,
    /// Instants (s), at equal distances.
    pub times: Vec<f64>,
    sizes: Sizes,
}

/// Reason why there is no study.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoReference {
    /// Reason in words.
    pub reason: String,
}

/// Resolutions of a curve from coarse to fine.
fn ladder(method: MotionMethod, numbers: Numbers) -> Vec<Resolution> {
    if method.is_adaptive() {
        let finest = if numbers == Numbers::Single { 6 } else { 13 };
        return (2..=finest).map(|digits| Resolution::Tolerance(10.0_f64.powi(-digits))).collect();
    }
    let most = if numbers == Numbers::Single { 8 } else { 16 };
    (0..most).map(|power| Resolution::Steps((PARTS / 8) << power)).collect()
}

/// Errors at which finer steps gain nothing more.
fn floor(numbers: Numbers) -> f64 {
    match numbers {
        Numbers::Double => 1e-12,
        Numbers::Single => 1e-4,
    }
}

/// Compares all settings of `mechanism` over `until` (s). `progress` gets what is done, in words, and the part of it.
///
/// # Errors
/// [`NoReference`] where no reference reaches the end.
pub fn moved_study(
    mechanism: &mut MovedCosts,
    until: f64,
    extent: &Extent,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<MovedStudy, NoReference> {
    let times: Vec<f64> = (0..=PARTS).map(|k| until * f64::from(k) / f64::from(PARTS)).collect();
    let no_reference = |reason: String| NoReference { reason };
    let double = mechanism.runs.iter().find(|(numbers, _)| *numbers == Numbers::Double);
    let double = double.ok_or_else(|| no_reference("there are no runs in f64".to_string()))?;
    let [q, qd] = double.1.start(0.0).map_err(|failure| no_reference(failure.to_string()))?;
    let (mut references, mut coarser) = (Vec::new(), Vec::new());
    for leg in legs(mechanism) {
        progress(&format!("{} reference", leg.name()), 0.0);
        let (fine, coarse) = best(mechanism, leg, (&q, &qd), &times, extent);
        coarser.extend(coarse.map(|coarse| (leg, coarse)));
        references.push((leg, fine));
    }
    let effect = mechanism.one_kind.as_ref().map(|of| of.effect);
    let whole = |reference: &Reference| reference.stuck.is_none();
    if !references.iter().any(|(_, reference)| whole(reference)) {
        let reasons = references.iter().map(|(leg, reference)| {
            let t = reference.shots.last().map_or(0.0, |shot| shot.at.t.high);
            let why = match &reference.stuck {
                Some(Stuck::OutOfTime) => "takes too long; `--until` ends it earlier",
                Some(Stuck::Refused(failure)) => failure,
                _ => "needs steps that are too small",
            };
            format!("the {} reference {why} (it came to t = {t:.4} s)", leg.name())
        });
        let reasons = reasons.collect::<Vec<_>>().join("; ");
        return Err(no_reference(match effect {
            Some(effect) => format!("the runtime alone decides the modes of `{effect}`, and {reasons}"),
            None => reasons,
        }));
    }
    let metric = [mechanism.exact.scales(), mechanism.exact.row_scales()];
    let of = |leg: Leg| references.iter().find(|(own, reference)| *own == leg && whole(reference));
    let any = references.iter().rev().find(|(_, reference)| whole(reference)).map(|(_, reference)| reference);
    let any = any.ok_or_else(|| no_reference("no reference is whole".to_string()))?;
    let double = mechanism.runs.iter().find(|(numbers, _)| *numbers == Numbers::Double);
    let unique = |t: f64, q: &[f64]| double.map_or_else(Vec::new, |(_, runs)| runs.unique(t, q));
    let is_still = any.shots.iter().all(|shot| shot.at.qd.iter().all(|qd| qd.high == 0.0));
    if is_still {
        return Err(no_reference("nothing moves from this start".to_string()));
    }
    if !extent.watched.is_empty() && extent.watched.iter().all(|k| is_constant(any, *k)) {
        return Err(no_reference("the watched outputs keep one value, which every run has".to_string()));
    }
    let sizes = Sizes::of(any, metric, &unique);
    let [one, other] = legs(mechanism);
    let pair = match (of(one), of(other)) {
        (Some((_, a)), Some((_, b))) => Some(([a, b], if effect.is_some() { ONE_KIND } else { 1.0 })),
        (Some((leg, fine)), None) | (None, Some((leg, fine))) => {
            coarser.iter().find(|(own, _)| own == leg).map(|(_, coarse)| ([fine, coarse], ALONE))
        }
        (None, None) => None,
    };
    let apart = pair.map(|([a, b], share)| {
        apart_legs(a, b, &sizes, &extent.watched).map(|apart| share * apart).collect::<Vec<_>>()
    });
    let width = apart.as_ref().map(|apart| apart.iter().copied().fold(0.0, worse));
    if let Some(apart) = apart.filter(|_| width.is_some_and(|width| width > COARSEST || width.is_nan())) {
        let agreed = apart.iter().take_while(|apart| **apart <= AGREED).count();
        let agreed = times.get(agreed.saturating_sub(1)).copied().unwrap_or(0.0);
        return Err(no_reference(differing(agreed, &extent.watched)));
    }
    let judge = |method: MotionMethod| of(judging(mechanism, method)).map_or(any, |(_, reference)| reference);
    let mut points: Vec<Point> = Vec::new();
    let mut longest = extent.longest;
    let methods = if extent.methods.is_empty() { MotionMethod::all() } else { extent.methods.clone() };
    let curves: Vec<(Numbers, MotionMethod)> = [Numbers::Double, Numbers::Single]
        .into_iter()
        .flat_map(|numbers| methods.iter().map(move |method| (numbers, *method)))
        .collect();
    for (index, (numbers, method)) in curves.iter().enumerate() {
        let share = index as f64 / curves.len() as f64;
        let name = Setting::Motion { numbers: *numbers, method: *method, resolution: Resolution::Steps(0) };
        progress(&name.curve(), 0.7 * share);
        let own = Extent { longest, ..extent.clone() };
        let found = curve(mechanism, (*numbers, *method), &times, &own, judge(*method), &sizes, width);
        if points.is_empty() {
            let finest = found.iter().map(|point| point.effort.elapsed.as_secs_f64()).fold(0.0, f64::max);
            longest = (DEAREST * finest).max(CHEAP).min(extent.longest);
        }
        points.extend(found);
    }
    for round in 1..RUNS {
        progress("times", 0.7 + 0.3 * f64::from(round) / f64::from(RUNS));
        for point in &mut points {
            time_again(mechanism, point, &times);
        }
    }
    points.iter_mut().for_each(|point| point.time = point.effort.elapsed.as_secs_f64() * 1e6 / until);
    Ok(MovedStudy { points, references, effect, width, times, sizes })
}

/// References of a mechanism, the one that more methods are judged by last.
fn legs(mechanism: &MovedCosts) -> [Leg; 2] {
    match mechanism.one_kind {
        Some(_) => [Leg::Order8, Leg::Order5],
        None => [Leg::Extrapolated, Leg::Collocated],
    }
}

/// The reference of the other kind than a method; where both are of one kind, that of the other formulation.
fn judging(mechanism: &MovedCosts, method: MotionMethod) -> Leg {
    let [first, last] = legs(mechanism);
    let formulation = |method: MotionMethod| match method {
        MotionMethod::Explicit(name, _) => Some(name),
        MotionMethod::Implicit(_) => None,
    };
    let is_of_last = match &mechanism.one_kind {
        Some(of) => formulation(method) == formulation(method_of(of, last)),
        None => method.is_implicit(),
    };
    if is_of_last { first } else { last }
}

impl MovedStudy {
    /// The reference that runs of others are judged by.
    pub fn judge(&self) -> Option<&Reference> {
        let whole = self.references.iter().rev().find(|(_, found)| found.stuck.is_none());
        whole.map(|(_, reference)| reference)
    }

    /// Reference metric of the coordinates: N.
    pub fn scales(&self) -> &[f64] {
        &self.sizes.scales
    }

    /// Errors of coordinates and velocities at the instants. What is not given is NaN, and all of it where instants are missing.
    pub fn errors_of(&self, q: &[Vec<f64>], qd: Option<&[Vec<f64>]>) -> Errors {
        let none = f64::NAN;
        let mut errors = Errors::unknown();
        let Some(reference) = self.judge().filter(|reference| reference.shots.len() == q.len()) else {
            return errors;
        };
        let apart_of = |values: &[f64], exact: &[D]| {
            let pairs = values.iter().zip(exact).zip(&self.sizes.scales);
            pairs.map(|((value, exact), scale)| apart(*value, *exact) / scale).fold(0.0, worse)
        };
        let mut all: Vec<f64> =
            q.iter().zip(&reference.shots).map(|(q, shot)| apart_of(q, &shot.at.q)).collect();
        errors.judged = all.iter().copied().fold(0.0, worse);
        all.sort_by(f64::total_cmp);
        errors.median = all.get(all.len() / 2).copied().unwrap_or(none);
        if let Some(qd) = qd.filter(|qd| qd.len() == q.len()) {
            let rates = qd.iter().zip(&reference.shots).map(|(qd, shot)| apart_of(qd, &shot.at.qd));
            errors.rate = rates.fold(0.0, worse) / self.sizes.rate;
        }
        errors
    }
}

/// `true` where the `k`th output has one value at all instants.
fn is_constant(reference: &Reference, k: usize) -> bool {
    let mut values = reference.shots.iter().map(|shot| shot.observed.outputs[k]);
    let first = values.next();
    values.all(|value| Some(value) == first)
}

/// Reason of references that differ too much, which agree until `agreed` (s).
fn differing(agreed: f64, watched: &[usize]) -> String {
    let rounding = match watched {
        [] => "",
        _ => ", or a watched output is 0 but for rounding",
    };
    match agreed {
        0.0 => format!("the references differ from the start on: the motion is not unique{rounding}"),
        agreed => format!(
            "the references differ; they agree to {AGREED:.0e} until t = {agreed:.4} s, where `--until {agreed:.4}` ends the motion{rounding}"
        ),
    }
}

/// The reference of the finest steps that are in time, and that of coarse ones beside it.
fn best(
    mechanism: &mut MovedCosts,
    leg: Leg,
    start: (&[f64], &[f64]),
    times: &[f64],
    extent: &Extent,
) -> (Reference, Option<Reference>) {
    let budget = Duration::from_secs_f64(extent.reference);
    let least =
        if mechanism.doubles.is_empty() { extent.tolerance } else { extent.tolerance.max(LEAST_OF_DOUBLES) };
    if let Some(of) = &mechanism.one_kind {
        return of_one_kind(of, leg, times, least, budget.mul_f64(2.0));
    }
    let exact = mechanism.exact.as_mut();
    // A coarse one first tells if the fine one will be in time.
    let coarse = reference(exact, leg, start, times, 1e-10, budget);
    if coarse.stuck.is_some() {
        return (coarse, None);
    }
    let fine = reference(exact, leg, start, times, least, budget.mul_f64(2.0));
    if fine.stuck.is_none() { (fine, Some(coarse)) } else { (coarse, None) }
}

/// Differences of two references at their instants.
fn apart_legs<'a>(
    a: &'a Reference,
    b: &'a Reference,
    sizes: &'a Sizes,
    watched: &'a [usize],
) -> impl Iterator<Item = f64> {
    let difference = move |(a, b): (&Shot, &Shot)| {
        if watched.is_empty() {
            let pairs = a.at.q.iter().zip(&b.at.q).zip(&sizes.scales);
            return pairs.map(|((a, b), scale)| (*a - *b).high.abs() / scale).fold(0.0, worse);
        }
        let of = |k: &usize| (a.observed.outputs[*k] - b.observed.outputs[*k]).high.abs() / sizes.outputs[*k];
        watched.iter().map(of).fold(0.0, worse)
    };
    a.shots.iter().zip(&b.shots).map(difference)
}

fn curve(
    mechanism: &MovedCosts,
    (numbers, method): (Numbers, MotionMethod),
    times: &[f64],
    extent: &Extent,
    reference: &Reference,
    sizes: &Sizes,
    width: Option<f64>,
) -> Vec<Point> {
    let Some((_, runs)) = mechanism.runs.iter().find(|(own, _)| *own == numbers) else { return Vec::new() };
    if !runs.admits(method) {
        return Vec::new();
    }
    let mut points: Vec<Point> = Vec::new();
    let mut coarser = Coarser::default();
    let mut gained_nothing = 0;
    for resolution in ladder(method, numbers) {
        let setting = Setting::Motion { numbers, method, resolution };
        let mut seen = Vec::new();
        let ran = runs.run(method, resolution, times, Some(&mut |state| seen.push(state)));
        let timed = ran.and_then(|_| runs.run(method, resolution, times, None));
        let effort = match timed {
            Ok(effort) => effort,
            Err(failure) => {
                let outcome = Outcome::Refused(failure.to_string());
                points.push(Point {
                    setting,
                    outcome,
                    effort: Effort::default(),
                    time: f64::NAN,
                    perturbed: None,
                });
                coarser = Coarser::default();
                // Finer steps do not change what a method knows of the text.
                if matches!(
                    failure.kind,
                    FailureKind::SetValuedForce { .. } | FailureKind::EventOfMotion { .. }
                ) {
                    break;
                }
                continue;
            }
        };
        // What a run makes of a contact that it misses shows in its times alone.
        let contacts = runs.contacts(method, resolution, times).unwrap_or_default();
        let Some(mut errors) = errors(&seen, &contacts, reference, sizes, &extent.watched) else { continue };
        let expected = coarser.expected((seen, effort.steps), method.is_adaptive(), sizes, &extent.watched);
        let verdict = verdict((numbers, method), effort.is_warned(), errors.judged, expected, width);
        errors.width = width.filter(|_| verdict == Verdict::Hollow).unwrap_or(0.0);
        let before = points.last().and_then(|point| match point.outcome {
            Outcome::Done { errors, .. } => Some(errors.judged),
            Outcome::Refused(_) => None,
        });
        let gains = before.is_none_or(|before| errors.judged < 0.7 * before);
        gained_nothing = if gains || errors.judged > floor(numbers) { 0 } else { gained_nothing + 1 };
        points.push(Point {
            setting,
            outcome: Outcome::Done { errors, expected, verdict },
            effort,
            time: f64::NAN,
            perturbed: None,
        });
        // The next one takes at least as long again.
        if effort.elapsed.as_secs_f64() > extent.longest || gained_nothing >= 2 {
            break;
        }
    }
    if let Some(order) = method.order() {
        let steps = |point: &Point| match point.setting {
            Setting::Motion { resolution: Resolution::Steps(steps), .. } => f64::from(steps),
            _ => f64::NAN,
        };
        let is_warned = |point: &Point| changes_the_problem(method) || point.effort.is_warned();
        judge_by_order(&mut points, order, rounding(numbers), steps, is_warned);
    }
    points
}

/// `true` for a penalty: its error stays whatever the steps.
fn changes_the_problem(method: MotionMethod) -> bool {
    matches!(method, MotionMethod::Explicit(FormulationName::Penalty, _))
}

/// Coarser runs of a curve, each with its steps, the last one last.
#[derive(Default)]
struct Coarser {
    runs: Vec<(Vec<Seen>, u64)>,
    /// Difference of the last two.
    difference: Option<f64>,
}

impl Coarser {
    /// The error of the coarser one of the last run and `run`, and `run` is the last one from then on. Of adaptive steps it is trusted as
    /// [`ErrorEstimate`] is, whose runs are the last three of the curve. Runs of the same steps tell nothing of their error.
    fn expected(
        &mut self,
        run: (Vec<Seen>, u64),
        is_adaptive: bool,
        sizes: &Sizes,
        watched: &[usize],
    ) -> Option<Expected> {
        let Some((last, steps)) = self.runs.last() else {
            self.runs.push(run);
            return None;
        };
        if run.1 as f64 <= FINER * *steps as f64 {
            return None;
        }
        let error = between(last, &run.0, sizes, watched)?;
        let before = self.difference.replace(error);
        self.runs.push(run);
        let of_three = before.zip(self.runs.last_chunk::<3>()).map(|(before, last)| {
            let steps = last.each_ref().map(|(_, steps)| u32::try_from(*steps).unwrap_or(u32::MAX));
            ErrorEstimate::of([before, error], steps).trusted().is_some()
        });
        if self.runs.len() > 2 {
            self.runs.remove(0);
        }
        Some(Expected { error, is_trusted: !is_adaptive || of_three == Some(true) })
    }
}

/// Errors that rounding alone explains.
fn rounding(numbers: Numbers) -> f64 {
    match numbers {
        Numbers::Double => 1e-10,
        Numbers::Single => 1e-2,
    }
}

fn verdict(
    (numbers, method): (Numbers, MotionMethod),
    is_warned: bool,
    error: f64,
    expected: Option<Expected>,
    width: Option<f64>,
) -> Verdict {
    let width = width.unwrap_or(0.0);
    match expected {
        _ if error <= WIDTHS * width => Verdict::Hollow,
        _ if error.is_nan() => Verdict::Wrong,
        Some(expected) if error > (WRONG * expected.error).max(rounding(numbers)) => {
            if changes_the_problem(method) || is_warned || !expected.is_trusted {
                Verdict::Untrusted
            } else {
                Verdict::Wrong
            }
        }
        _ => Verdict::Right,
    }
}

fn time_again(mechanism: &MovedCosts, point: &mut Point, times: &[f64]) {
    let Setting::Motion { numbers, method, resolution } = point.setting else { return };
    let Some((_, runs)) = mechanism.runs.iter().find(|(own, _)| *own == numbers) else { return };
    if matches!(point.outcome, Outcome::Refused(_)) {
        return;
    }
    if let Ok(effort) = runs.run(method, resolution, times, None) {
        point.effort.elapsed = point.effort.elapsed.min(effort.elapsed);
    }
}
