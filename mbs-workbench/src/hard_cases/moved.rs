//! Variants of a motion from forces by every method, each against two references and the oracle.

use crate::erased::timed_runs::{Effort, Seen};
use crate::erased::variations::{Change, MovedVariants};
use crate::hard_cases::course::Course;
use crate::hard_cases::instants::{Instants, PARTS};
use crate::hard_cases::judge::{Bounds, exceeds, judge, of_moved};
use crate::hard_cases::list::description::MethodKind;
use crate::hard_cases::oracle::Oracle;
use crate::hard_cases::references::{FIRST, References, Run, Varied, apart, references};
use crate::hard_cases::sensitivity::Sensitivity;
use crate::hard_cases::similar::{compared, in_other_size, in_size, positions};
use crate::hard_cases::study::{Clock, Extent};
use crate::hard_cases::variation::{Class, Variation, VariedParts};
use crate::hard_cases::verdict::{Outcome, Verdict, larger};
use crate::setting::{FormulationName, MotionMethod, Numbers, Resolution};

/// Tolerance of adaptive runs in `f64` and `f32`.
const TOLERANCES: [f64; 2] = [1e-8, 1e-4];

/// Estimate that the reference step of equal steps must reach, in the reference metric.
const FINE: f64 = 3e-5;

/// Error of the coarsest variant of equal steps over that of half the reference step's number, which the reference step is judged by.
const COARSEST: f64 = 2.0;

/// Most steps of equal size.
const MOST_STEPS: u32 = PARTS << 10;

/// Part of the motion that a run's own estimate must stay below.
const CLAIMED: f64 = 1e-3;

/// Bound of the error over the run's own estimate.
const TRUSTED: f64 = 30.0;

/// Rounding of a position or velocity in ε.
const DIGITS: f64 = 4.0;

/// Largest way of a coordinate from its start, at most 1 in the reference metric.
fn motion(run: &[Seen], scales: &[f64]) -> f64 {
    let ways = run.iter().flat_map(|seen| seen.q.iter().zip(&run[0].q).zip(scales));
    ways.map(|((a, b), scale)| ((a - b) / scale).abs()).fold(0.0, larger).clamp(1e-12, 1.0)
}

fn finer(resolution: Resolution, factor: f64) -> Resolution {
    match resolution {
        Resolution::Tolerance(tolerance) => Resolution::Tolerance(tolerance / factor.powi(4)),
        Resolution::Steps(steps) => Resolution::Steps(((f64::from(steps) * factor).round() as u32).max(1)),
    }
}

/// A mechanism that forces move, and its text, with values of parameters and inputs; none that does not exist.
pub type Make<'a> = &'a dyn Fn(&[(usize, f64)]) -> Option<(Box<dyn MovedVariants>, Oracle)>;

/// Runs all variants of `extent` by all methods.
///
/// # Errors
/// The mechanism does not move as the text has it.
pub fn moved_outcomes(
    make: Make,
    subject: &VariedParts,
    extent: &Extent,
    clock: &Clock,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<Vec<Outcome>, String> {
    let scales = &subject.scales;
    let varied = |variation: Option<&Variation>| -> Result<Varied<'static>, String> {
        let values = variation.map_or(&[][..], |variation| &variation.values);
        let (mechanism, oracle) = make(values).ok_or("the oracle cannot read the text")?;
        let numbers = match variation.map(|variation| variation.class) {
            Some(Class::Single) => Numbers::Single,
            _ => Numbers::Double,
        };
        let start = match variation.map(|variation| variation.class) {
            Some(Class::Rows | Class::Frame) => {
                Some(mechanism.start_of_text().map_err(|failure| format!("the start: {failure}"))?)
            }
            Some(Class::Guess) => {
                let [mut q, qd] = mechanism.guess();
                let shift = variation.map_or(&[][..], |variation| &variation.shift);
                q.iter_mut().zip(shift).for_each(|(q, shift)| *q += shift);
                let found = mechanism.start(&[q, qd]);
                Some(found.map_err(|failure| format!("the start: {failure}"))?)
            }
            // A guess in metres would be a far one.
            Some(Class::Similar) => {
                let [similar, own] =
                    [values, &[][..]].map(|values| make(values).map(|(made, _)| made.guess()));
                let mut asked = own.ok_or("the oracle cannot read the text")?;
                if let Some(variation) = variation {
                    asked.iter_mut().for_each(|values| in_other_size(values, variation, subject));
                }
                let found =
                    if similar.as_ref() == Some(&asked) { None } else { Some(mechanism.start(&asked)) };
                found.transpose().map_err(|failure| format!("the start: {failure}"))?
            }
            _ => None,
        };
        let change = variation.map_or_else(Change::default, |variation| variation.change.clone());
        Ok(Varied { mechanism, oracle, change, start, numbers })
    };
    let plain = varied(None)?;
    if extent.is_refused() {
        return Ok(refused_outcomes(&varied, subject, extent));
    }
    let times = extent.instants(Resolution::Tolerance(1.0));
    let of = |varied: &Varied<'_>| references(varied, &times, scales);
    progress("references", 0.0);
    let mut usual = of(&plain)?;
    if extent.seeds.iter().any(|seed| Variation::of(*seed, subject).class == Class::Single) {
        // Beside a start that has no neighbours a run in single precision is judged to its end.
        let epsilon = Numbers::Single.epsilon();
        usual.sensitivity = Sensitivity::of(&plain, &usual.first, &times, (epsilon, scales)).ok();
    }
    let methods: Vec<MotionMethod> = extent
        .methods
        .iter()
        .copied()
        .filter(|method| {
            plain.mechanism.admits(*method, Numbers::Double) && extent.has(MethodKind::of(*method))
        })
        .collect();
    // Of a small motion as many digits are claimed by the coarsest variant.
    let fine = FINE.min(CLAIMED * motion(&usual.first, scales) / COARSEST);
    let mut bases = Vec::new();
    for method in &methods {
        bases.push(base(&plain, (*method, fine), extent.until, scales, clock));
    }
    let mut outcomes = Vec::new();
    for (index, seed) in extent.seeds.iter().enumerate() {
        let variation = Variation::of(*seed, subject);
        progress(
            &format!("variant {seed}: {}", variation.class.name()),
            index as f64 / extent.seeds.len() as f64,
        );
        if clock.is_over() {
            break;
        }
        let running: Vec<_> = methods
            .iter()
            .zip(&bases)
            .enumerate()
            .filter(|(method, _)| extent.runs(*method, index))
            .map(|(_, running)| running)
            .collect();
        if running.is_empty() {
            continue;
        }
        let made = varied(Some(&variation));
        let own = match variation.class {
            Class::Parameters | Class::Guess => made.as_ref().ok().map(&of),
            // The same start as in the coordinates of the text, so the same motion.
            Class::Rows | Class::Frame => made.as_ref().ok().map(|made| {
                of(&Varied { change: Change::default(), start: made.start.clone(), ..varied(None)? })
            }),
            _ => None,
        };
        if variation.class == Class::Similar {
            let Ok(made) = &made else { continue };
            // Both take the way of the text, or both that of a given start.
            let mut own = varied(None)?;
            if made.start.is_some() {
                let started = own.mechanism.start(&own.mechanism.guess());
                own.start = Some(started.map_err(|failure| failure.to_string())?);
            }
            for (method, base) in running {
                outcomes.push(similar_outcome([&own, made], &variation, (*method, base), (subject, extent)));
            }
            continue;
        }
        for (method, base) in running {
            if let Some(references) = judged(&made, &usual, own.as_ref()) {
                outcomes.push(outcome(&variation, *method, base, references, (extent, scales)));
            }
        }
    }
    Ok(outcomes)
}

/// A variant that can be run with its references, or the reason why it is refused.
type Judged<'a> = Result<(&'a Varied<'a>, &'a References), String>;

fn judged<'a>(
    made: &'a Result<Varied<'static>, String>,
    usual: &'a References,
    own: Option<&'a Result<References, String>>,
) -> Option<Judged<'a>> {
    Some(match (made, own) {
        (Err(reason), _) => Err(reason.clone()),
        (Ok(_), Some(Err(reason))) => Err(reason.clone()),
        (Ok(made), Some(Ok(own))) => Ok((made, own)),
        (Ok(made), None) => Ok((made, usual)),
    })
}

/// The reference resolution of a method in both types of number; a reason where no step reaches the estimate.
fn base(
    plain: &Varied<'_>,
    (method, fine): (MotionMethod, f64),
    until: f64,
    scales: &[f64],
    clock: &Clock,
) -> Result<[Resolution; 2], String> {
    if method.is_adaptive() {
        return Ok(TOLERANCES.map(Resolution::Tolerance));
    }
    let times = Instants::of(until, Resolution::Steps(PARTS), PARTS);
    let mut steps = PARTS;
    let mut last: Option<Run> = None;
    let mut reason = String::new();
    while steps <= MOST_STEPS && !clock.is_over() {
        match plain.run(method, Resolution::Steps(steps), &times) {
            Ok((run, _)) => {
                if last.as_ref().is_some_and(|last| apart(last, &run, scales) < fine) {
                    return Ok([Resolution::Steps(steps), Resolution::Steps(steps / 2)]);
                }
                reason = format!("{steps} steps still change the motion by more than {fine:.0e}");
                last = Some(run);
            }
            Err(failure) => (reason, last) = (failure, None),
        }
        steps *= 2;
    }
    Err(reason)
}

/// `true` for methods whose rows are open by design: their drift is part of the error.
fn drifts(method: MotionMethod) -> bool {
    use FormulationName::{Baumgarte, Penalty, Unstabilized};
    matches!(
        method,
        MotionMethod::Explicit(Baumgarte | Penalty | Unstabilized, _) | MotionMethod::Implicit(_)
    )
}

fn outcome(
    variation: &Variation,
    method: MotionMethod,
    base: &Result<[Resolution; 2], String>,
    judged: Judged<'_>,
    (extent, scales): (&Extent, &[f64]),
) -> Outcome {
    let mut outcome = Outcome::blank(variation, method.to_string());
    let base = match base {
        Ok(base) => base,
        Err(reason) => return Outcome { reason: reason.clone(), ..outcome },
    };
    let (varied, references) = match judged {
        Ok(judged) => judged,
        Err(reason) => return Outcome { reason, ..outcome },
    };
    let is_single = varied.numbers == Numbers::Single;
    let resolution = finer(base[usize::from(is_single)], variation.finer);
    let times = extent.instants(resolution);
    let (run, effort) = match varied.run(method, resolution, &times) {
        Ok(ran) => ran,
        Err(reason) => return Outcome { reason, ..outcome },
    };
    outcome.work = effort.evaluations + effort.corrections;
    outcome.course = Course::of_run(&run, scales);
    let fine = match varied.run(method, finer(resolution, 2.0), &times) {
        Ok((fine, _)) => fine,
        Err(reason) => return Outcome { reason: format!("at half the step: {reason}"), ..outcome },
    };
    let finest = match eighth_of_the_step(varied, method, (resolution, &times)).transpose() {
        Ok(finest) => finest,
        Err(reason) => {
            return Outcome { reason: format!("at an eighth of the step: {reason}"), ..outcome };
        }
    };
    let moved = references.first.first().map_or(0.0, |first| {
        let shifts = first.q.iter().zip(scales).map(|(q, scale)| (q / scale).abs());
        let frame = variation.change.shift.iter().zip(scales).map(|(b, scale)| (b / scale).abs());
        shifts.chain(frame).fold(1.0, f64::max)
    });
    let epsilon = varied.numbers.epsilon();
    // Rounding adds up over the steps, and acts on distances from the origin of the frame.
    let rounding = 1e3 * epsilon * moved * (effort.steps.max(1) as f64).sqrt();
    // Where rounding of the start leads elsewhere, a run in single precision shows nothing.
    let whole = &run;
    let end = references.sensitivity.as_ref().filter(|_| is_single).and_then(|found| found.end(rounding));
    let [run, fine, finest] = [&run[..], &fine[..], finest.as_deref().unwrap_or_default()].map(|run| {
        let count = end.map_or(run.len(), |end| run.partition_point(|seen| seen.t < end));
        &run[..count]
    });
    if let Some(end) = end {
        let words =
            format!("; judged before t = {end:.4} s: rounding of the start leads elsewhere from there on");
        outcome.variant += &words;
        if run.len() < 2 {
            return Outcome {
                reason: "rounding of the start leads elsewhere: no digits are claimed".to_string(),
                ..outcome
            };
        }
    }
    let estimate = match finest.is_empty() {
        true => apart(run, fine, scales),
        false => apart(run, fine, scales).max(apart(fine, finest, scales)),
    };
    let width =
        references.estimate + references.other.as_ref().map_or(0.0, |(apart, own, _)| apart.min(*own));
    let bound = TRUSTED * estimate + 10.0 * width + rounding;
    outcome.bound = Some(bound);
    let is_soft = matches!(method, MotionMethod::Explicit(FormulationName::Penalty, _));
    let mut bounds = Bounds {
        rows: if is_single { 2e-4 } else { 1e-8 } * moved,
        balance: if is_single { 2e-3 } else { 1e-7 } * moved.sqrt(),
        estimate,
        rounding: 10.0 * rounding,
        digit: DIGITS * epsilon * moved,
    };
    if drifts(method) {
        bounds.rows += 100.0 * estimate + 1e-6;
        bounds.balance = bounds.balance.max(1e-5);
    }
    let [states, fine_states] = [run, fine].map(|run| run.iter().map(of_moved).collect::<Vec<_>>());
    let judgement = if is_soft {
        Default::default()
    } else {
        judge([&states, &fine_states], &varied.oracle, scales, bounds, variation.seed)
    };
    outcome.not_made = judgement.not_made;
    if is_soft {
        outcome
            .not_made
            .push("rows, balance and formulations: springs in place of rows are another problem".to_string());
    }
    if references.other.is_none() {
        outcome.not_made.push(format!("two formulations: {}", references.alone));
    }
    let error = apart(run, &references.first, scales);
    outcome.error = Some(error);
    let disagree = references.other.as_ref().filter(|(apart, own, _)| {
        *apart > TRUSTED * (references.estimate + own) + 10.0 * rounding && method == FIRST
    });
    let (verdict, reason) = if let Some(reason) = judgement.wrong {
        (Verdict::Wrong, reason)
    } else if let Some((apart, own, name)) = disagree {
        let words = format!(
            "{FIRST} and {name} differ by {apart:.1e}, their estimates are {:.1e} and {own:.1e}",
            references.estimate
        );
        (Verdict::Wrong, words)
    } else if exceeds(error, bound) && !is_soft {
        (Verdict::Wrong, format!("an error of {error:.1e} where {bound:.1e} is expected"))
    } else if exceeds(estimate, CLAIMED * motion(&references.first, scales)) && !is_single {
        (
            Verdict::Refused,
            format!("half the step changes the motion by {estimate:.1e}: no digits are claimed"),
        )
    } else {
        (Verdict::Right, String::new())
    };
    let outcome = Outcome { verdict, reason, ..outcome };
    match &extent.description {
        Some(case) => {
            // Bounds of known values hold for the whole run.
            let states: Vec<_> = whole.iter().map(of_moved).collect();
            case.judged(outcome, MethodKind::of(method), variation, (&states, &varied.oracle))
        }
        None => outcome,
    }
}

/// A run at an eighth of equal steps, where contacts end steps: a contact that is shorter than half a step is one step for both, and
/// their difference shows nothing of it.
fn eighth_of_the_step(
    varied: &Varied<'_>,
    method: MotionMethod,
    (resolution, times): (Resolution, &Instants),
) -> Option<Result<Run, String>> {
    (varied.oracle.has_contacts() && !method.is_adaptive())
        .then(|| varied.run(method, finer(resolution, 8.0), times).map(|(run, _)| run))
}

/// A similar mechanism beside the mechanism itself.
fn similar_outcome(
    [own, other]: [&Varied<'_>; 2],
    variation: &Variation,
    (method, base): (MotionMethod, &Result<[Resolution; 2], String>),
    (subject, extent): (&VariedParts, &Extent),
) -> Outcome {
    let refused = Outcome::blank(variation, method.to_string());
    let base = match base {
        Ok(base) => base,
        Err(reason) => return Outcome { reason: reason.clone(), ..refused },
    };
    let times = extent.instants(base[0]);
    let runs = [other, own].map(|varied| varied.run(method, base[0], &times));
    match runs {
        [Err(reason), _] => Outcome { reason, ..refused },
        [Ok(_), Err(reason)] => Outcome { reason: format!("the mechanism itself: {reason}"), ..refused },
        [Ok((run, effort)), Ok((own_run, own_effort))] => {
            let mut places = positions(&run);
            places.iter_mut().for_each(|q| in_size(q, variation, subject));
            let work = |effort: &Effort| effort.evaluations + effort.corrections;
            let work = (work(&effort), work(&own_effort));
            compared(refused, (&places, &positions(&own_run)), work, &subject.scales)
        }
    }
}

/// Variants of a motion that there is none of.
fn refused_outcomes(
    varied: &dyn Fn(Option<&Variation>) -> Result<Varied<'static>, String>,
    subject: &VariedParts,
    extent: &Extent,
) -> Vec<Outcome> {
    let Some(case) = &extent.description else { return Vec::new() };
    let mut outcomes = Vec::new();
    for (index, seed) in extent.seeds.iter().enumerate() {
        let variation = Variation::of(*seed, subject);
        let methods = extent.methods.iter().enumerate().filter(|(method, _)| extent.runs(*method, index));
        for (_, method) in methods {
            let run = varied(Some(&variation)).map(|varied| {
                let resolution = match method.is_adaptive() {
                    true => Resolution::Tolerance(TOLERANCES[usize::from(varied.numbers == Numbers::Single)]),
                    false => Resolution::Steps(8 * PARTS),
                };
                let times = extent.instants(resolution);
                let is_suited = varied.mechanism.admits(*method, varied.numbers);
                is_suited.then(|| varied.ran(*method, finer(resolution, variation.finer), &times).map(|_| ()))
            });
            let (verdict, reason, failed) = match run {
                Ok(None) => continue,
                Ok(Some(Ok(()))) => (Verdict::Right, String::new(), None),
                Ok(Some(Err(failure))) => (Verdict::Refused, failure.to_string(), failure.time),
                Err(reason) => (Verdict::Refused, reason, None),
            };
            outcomes.push(case.refused(
                Outcome { verdict, reason, ..Outcome::blank(&variation, method.to_string()) },
                failed,
            ));
        }
    }
    outcomes
}
