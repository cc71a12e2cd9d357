//! Motions from forces.

use std::time::Duration;

use crate::erased::dynamics::AnyDynamics;
use crate::erased::dynamics::direct_dynamics::{Approach, Simulated, Stabilization, Steps, equal};
use mbs_runtime::dynamics::{Counts, ErrorEstimate, MethodWarning, MovedStart, Tolerance};
use mbs_runtime::{Failure, FailureKind};

use super::super::summary::{significant, unit};
use super::early_end::EarlyEnd;
use super::loads::{energies, loads};
use super::{Analysed, AnalysisResult};

pub(super) fn direct(
    dynamics: &dyn AnyDynamics,
    approach: &Approach,
    times: &[f64],
    on_progress: &mut dyn FnMut(usize),
) -> Analysed {
    let found = dynamics.simulate(approach, times, on_progress).map_err(|failure| failure.to_string())?;
    let end = found.failure.map(|failure| {
        let message = ended(failure, approach.stabilization);
        let t = found.motion.time.last().copied().unwrap_or_default();
        EarlyEnd::new(t, &failure).with_message(&message)
    });
    // A start alone is no motion.
    if let Some(end) = end.as_ref().filter(|_| found.motion.time.len() < 2) {
        return Err(end.message.clone());
    }
    let mut figures = balance(&found);
    figures.extend(estimated_error(dynamics, approach, times, &found));
    figures.extend(end.iter().map(|end| ["early end".to_string(), end.line.clone()]));
    let span = times.get(1).zip(times.first()).map(|(next, first)| next - first);
    if let Some((span, longest)) = span.zip(approach.longest()) {
        let length = span / f64::from(equal(span, longest));
        figures.push(["size of the equal steps".to_string(), format!("{} s", significant(length, 4))]);
    }
    figures.extend(stiff(dynamics, approach, &found));
    figures.extend(energies(&found.motion));
    figures.extend(loads(&found.motion));
    Ok(AnalysisResult { ended: end, ..AnalysisResult::of(found.motion, figures) })
}

/// Steps for each instant shown from which on their length is chosen by the method.
const MANY_STEPS: u64 = 4;

/// Step over the time constant of a decay from which on that bounds it. Explicit pairs are stable up to 3.3 (order 5) and 6.1 (order 8);
/// where they have to follow a decay to three digits and more, steps stay below 2.
const STIFF: f64 = 2.0;

/// Coordinates up to which small motions cost less than a run: eigenvalues take the third power of their number.
const MOST_COORDINATES: usize = 60;

/// A decay of small motions about the end that bounds the mean step of an explicit method, and its cure.
fn stiff(dynamics: &dyn AnyDynamics, approach: &Approach, found: &Simulated) -> Option<[String; 2]> {
    let is_explicit = !matches!(approach.stabilization, Stabilization::Radau | Stabilization::Implicit(_));
    let (Steps::Adaptive { .. }, true, None) = (&approach.steps, is_explicit, found.failure) else {
        return None;
    };
    let times = &found.motion.time;
    let is_large = found.motion.coordinates.len() > MOST_COORDINATES;
    if is_large || found.counts.steps < MANY_STEPS * times.len() as u64 {
        return None;
    }
    let step = (times.last()? - times.first()?) / found.counts.steps as f64;
    let eigenvalues = dynamics.small_motions(&found.motion).ok()?.eigenvalues;
    let decay = eigenvalues.iter().map(|[real, _]| -real).fold(0.0, f64::max);
    let words = || {
        let (time, step) = (significant(1.0 / decay, 2), significant(step, 2));
        format!(
            "a motion decays in {time} s, which bounds the steps of an explicit method to {step} s: `--method radau` takes longer ones"
        )
    };
    (STIFF < decay * step).then(|| ["stiff".to_string(), words()])
}

/// Numbers of instants of a motion at which its estimated errors are taken, the end included: the first that divides its own.
const INSTANTS: [usize; 5] = [16, 12, 10, 4, 1];

/// Errors of the coordinates of adaptive steps at some instants, in each unit the largest: by differences from a run of a tenth of the
/// tolerance. A run of ten times the tolerance tells if they are trusted.
fn estimated_error(
    dynamics: &dyn AnyDynamics,
    approach: &Approach,
    times: &[f64],
    found: &Simulated,
) -> Option<[String; 2]> {
    let Steps::Adaptive { pair, tolerance } = approach.steps else { return None };
    if found.failure.is_some() || times.len() < 2 {
        return None;
    }
    // Runs show instants of equal distance.
    let count = times.len() - 1;
    let parts = INSTANTS.into_iter().find(|parts| count.is_multiple_of(*parts)).unwrap_or(1);
    let instants: Vec<f64> = times.iter().step_by(count / parts).copied().collect();
    let with = |tolerance: f64| {
        let steps = Steps::Adaptive { pair, tolerance };
        let run = dynamics.simulate(&Approach { steps, ..*approach }, &instants, &mut |_| ()).ok()?;
        run.failure.is_none().then_some(run)
    };
    let name = "estimated error".to_string();
    // Relative and absolute tolerance add up.
    let finer = (0.1 * tolerance).max(0.5 * Tolerance::<f64>::least());
    let (Some(coarse), Some(fine)) = (with(10.0 * tolerance), with(finer)) else {
        return Some([
            name,
            "not known: runs of ten times and a tenth of the tolerance do not go through".to_string(),
        ]);
    };
    let accepted = |run: &Simulated| u32::try_from(run.counts.steps).unwrap_or(u32::MAX);
    let steps = [&coarse, found, &fine].map(accepted);
    let mut errors: Vec<(&str, [f64; 2])> = Vec::new();
    let coordinates = found.motion.coordinates.iter().zip(&coarse.motion.coordinates);
    for ((own, coarse), fine) in coordinates.zip(&fine.motion.coordinates) {
        let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let q: Vec<f64> = own.q.iter().step_by(count / parts).copied().collect();
        let found = [apart(&coarse.q, &q), apart(&q, &fine.q)];
        match errors.iter_mut().find(|(of, _)| *of == own.unit) {
            Some((_, largest)) => *largest = [largest[0].max(found[0]), largest[1].max(found[1])],
            None => errors.push((own.unit, found)),
        }
    }
    let words = |(of, apart): &(&str, [f64; 2])| {
        let estimate = ErrorEstimate::of(*apart, steps);
        let doubt = if estimate.trusted().is_some() { "" } else { " (untrusted)" };
        format!("{:.0e}{}{doubt}", estimate.value(), unit(of))
    };
    Some([name, errors.iter().map(words).collect::<Vec<_>>().join(", ")])
}

/// Reason why a motion from forces ended; at a singular position that its stabilisation cannot pass, also the cure.
fn ended(failure: Failure, stabilization: Stabilization) -> String {
    let how = match stabilization {
        Stabilization::None => "no stabilisation",
        Stabilization::Baumgarte(_) => "Baumgarte's stabilisation",
        Stabilization::Penalty(_) => "a penalty",
        Stabilization::Projection
        | Stabilization::Velocity
        | Stabilization::Implicit(_)
        | Stabilization::Radau => {
            return failure.to_string();
        }
    };
    let Failure { kind: FailureKind::Undecided { .. }, time: Some(time) } = failure else {
        return failure.to_string();
    };
    let before = (100.0 * time).floor() / 100.0;
    format!(
        "{failure}\n{how} leaves the rows violated by what the steps make of it: where bars come in line that decides which way they go. \
         `--method projection` or `--method velocity` lead through, `--until {before}` ends before it"
    )
}

/// Energy, constraints and cost of a motion from forces.
fn balance(found: &Simulated) -> Vec<[String; 2]> {
    let Some(forces) = &found.motion.dynamics else { return Vec::new() };
    let pair = |name: &str, value: String| [name.to_string(), value];
    let kinetic = largest(&forces.kinetic);
    let margin = found.motion.margin.iter().copied().fold(f64::INFINITY, f64::min);
    let mut figures = vec![
        pair(
            "largest energy defect",
            format!("{:.1e} J, largest kinetic energy {kinetic:.4} J", largest(&forces.defect)),
        ),
        pair("largest |Φ|", format!("{:.1e} of the reference length", largest(&found.motion.closure))),
        pair("largest |Φ̇|", format!("{:.1e} 1/s of the reference length", largest(&forces.closure_rate))),
        pair("steps", format!("{}, {} rejected", found.counts.steps, found.rejected)),
        pair("evaluations", evaluations(&found.counts)),
        pair("smallest margin to singularity", format!("{margin:.3}")),
        pair("time of computation", milliseconds(found.elapsed)),
    ];
    if found.replaced {
        let reason =
            "projection onto all rows together: of rows that may follow from others no blocks are made";
        figures.push(pair("method", reason.to_string()));
    }
    if found.counts.rechosen > 0 {
        let (rechosen, all) = (found.counts.rechosen, found.counts.evaluations);
        let reason = "the independent coordinates hardly determine the others there";
        figures.push(pair(
            "independent motions chosen anew",
            format!("{rechosen} of {all} evaluations: {reason}"),
        ));
    }
    if found.counts.handed_over > 0 {
        let (handed, all) = (found.counts.handed_over, found.counts.evaluations);
        let reason = "the rows lose rank there";
        figures.push(pair("handed over to projection", format!("{handed} of {all} evaluations: {reason}")));
    }
    if found.counts.rank_revealing > 0 {
        figures.push(pair("rank-revealing factorizations", found.counts.rank_revealing.to_string()));
    }
    if let Some(start) = &found.moved_start {
        figures.push(pair("start moved", moved(start)));
    }
    if let Some(t) = found.undetermined {
        figures.push(pair("not determined", undetermined(t)));
    }
    if let Some(doubt) = found.doubt {
        figures.push(pair("doubtful", doubtful(doubt).to_string()));
    }
    figures
}

/// Change of a declared coordinate or rate by which the start meets the rows.
fn moved(start: &MovedStart<f64>) -> String {
    let MovedStart { coordinate, rate, declared, actual } = start;
    let (what, per) = if *rate { ("the rate of ", "/s") } else { ("", "") };
    format!(
        "{what}`{}` (line {}) from {} to {} {}{per}: the other numbers of the start do not meet the rows with it",
        coordinate.name,
        coordinate.line,
        significant(*declared, 9),
        significant(*actual, 9),
        coordinate.unit
    )
}

/// Evaluations by the steps, and by the instants between them.
fn evaluations(counts: &Counts) -> String {
    match counts.shown {
        0 => counts.evaluations.to_string(),
        shown => format!("{} of the steps, {shown} of the instants between them", counts.evaluations),
    }
}

/// Largest magnitude.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()))
}

/// Phrase for the motion after `t` (s), which a method that does not pass singular positions leaves undetermined.
pub fn undetermined(t: f64) -> String {
    format!(
        "the motion behind t = {t} s: it passes a singular position there, where this method may leave on another branch; use \
         `--method projection`"
    )
}

/// Warning about a stabilisation, in one phrase.
pub fn doubtful(doubt: MethodWarning) -> &'static str {
    match doubt {
        MethodWarning::StiffStabilization => {
            "frequency times step above 0.3: the stabilisation costs accuracy"
        }
        MethodWarning::IdleStabilization => {
            "frequency times duration below 5: violations have no time to decay"
        }
        MethodWarning::RisingRank => {
            "rows that follow from others on the constraints do not beside them, where stages are: accelerations there are wrong \
             by their own size; use `--method projection`"
        }
    }
}

fn milliseconds(elapsed: Duration) -> String {
    format!("{:.1} ms", elapsed.as_secs_f64() * 1e3)
}

#[cfg(test)]
mod tests {
    use mbs_runtime::dynamics::Baumgarte;

    use super::*;

    #[test]
    fn a_stabilisation_that_stops_names_one_that_goes_on() {
        let failure = FailureKind::Undecided { margin: 1e-3, single: false }.at(7.061);
        let of = |stabilization| ended(failure, stabilization);
        for lost in [Stabilization::None, Stabilization::Baumgarte(Baumgarte::default())] {
            let message = of(lost);
            assert!(message.starts_with(&failure.to_string()), "{message}");
            assert!(
                message.contains("`--method projection`") && message.contains("--until 7.06`"),
                "{message}"
            );
        }
        assert_eq!(of(Stabilization::Projection), failure.to_string());
        let other = FailureKind::InvalidStep { step: 0.0 }.at(1.0);
        assert_eq!(ended(other, Stabilization::None), other.to_string());
    }
}
