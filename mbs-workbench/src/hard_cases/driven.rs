//! Variants of a motion that drives prescribe, each judged by the oracle and by a run in finer steps.

use crate::erased::driven_variations::{DrivenVariants, LANES};
use crate::erased::timed_steps::{Placed, TimedSteps};
use crate::hard_cases::course::Course;
use crate::hard_cases::judge::{Bounds, exceeds, judge, less_turns, of_driven};
use crate::hard_cases::list::description::MethodKind;
use crate::hard_cases::oracle::{Oracle, OracleState};
use crate::hard_cases::similar::{compared, in_other_size, in_size};
use crate::hard_cases::study::{Clock, Extent};
use crate::hard_cases::variation::{Class, Variation, VariedParts};
use crate::hard_cases::verdict::{Outcome, Verdict, larger};
use crate::setting::{Closing, Numbers};

/// Steps over the span, and how many finer ones tell if the assembly is the same.
const STEPS: f64 = 96.0;
const FINER: u32 = 16;

/// Ends of the iterations that are compared.
const CLOSINGS: [Closing; 3] = [Closing::Closed, Closing::Evaluations(3), Closing::Evaluations(2)];

/// A mechanism that drives move, and its text, with values of a variant.
pub type Made = (Box<dyn DrivenVariants>, Oracle);

/// A mechanism with values of parameters and inputs; none that does not exist.
pub type Make<'a> = &'a dyn Fn(&[(usize, f64)]) -> Option<Made>;

/// Runs all variants of `extent`.
pub fn driven_outcomes(
    make: Make,
    subject: &VariedParts,
    extent: &Extent,
    clock: &Clock,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<Vec<Outcome>, String> {
    let mut outcomes = Vec::new();
    for (index, seed) in extent.seeds.iter().enumerate() {
        if clock.is_over() {
            break;
        }
        let variation = Variation::of(*seed, subject);
        progress(
            &format!("variant {seed}: {}", variation.class.name()),
            index as f64 / extent.seeds.len() as f64,
        );
        let (mechanism, oracle) = make(&variation.values).ok_or("the oracle cannot read the text")?;
        let numbers = if variation.class == Class::Single { Numbers::Single } else { Numbers::Double };
        let lanes = if variation.class == Class::Lanes { LANES } else { 1 };
        if variation.class == Class::Similar {
            let Some((own, _)) = make(&[]) else { continue };
            let pair = [own.as_ref(), mechanism.as_ref()];
            outcomes.extend(similar_outcomes(pair, &variation, subject, (extent, index)));
            continue;
        }
        let Some(runs) = mechanism.runs(numbers, lanes, &variation.shift) else { continue };
        let Some(fine) = mechanism.runs(Numbers::Double, 1, &variation.shift) else { continue };
        let steps = (STEPS * variation.finer).round().max(2.0) as u32;
        let fine = positions(fine.as_ref(), Closing::Closed, extent.until, FINER * steps);
        let suits =
            |closing: &Closing| (lanes == 1 || *closing == Closing::Closed) && extent.has(kind(*closing));
        for closing in closings(extent, index).filter(|closing| suits(closing)) {
            let run = positions(runs.as_ref(), *closing, extent.until, steps);
            let method = if lanes == 1 { format!("Stepper, {closing}") } else { format!("Batch of {lanes}") };
            let failed = run.as_ref().err().and_then(|(_, time)| *time);
            let states: Vec<OracleState> =
                run.iter().flat_map(|(run, _)| run.iter().map(of_driven)).collect();
            let found = outcome(&variation, method, (run, &fine), &oracle, (subject, numbers, *closing));
            outcomes.push(match &extent.description {
                Some(case) if case.refused.is_some() => case.refused(found, failed),
                Some(case) => case.judged(found, kind(*closing), &variation, (&states, &oracle)),
                None => found,
            });
        }
    }
    Ok(outcomes)
}

/// Ways of closing positions that run the variant of an index.
fn closings(extent: &Extent, index: usize) -> impl Iterator<Item = &'static Closing> {
    CLOSINGS.iter().enumerate().filter(move |(way, _)| extent.runs(*way, index)).map(|(_, closing)| closing)
}

/// A similar mechanism beside the mechanism itself, from guesses that are similar.
fn similar_outcomes(
    [own, other]: [&dyn DrivenVariants; 2],
    variation: &Variation,
    subject: &VariedParts,
    (extent, index): (&Extent, usize),
) -> Vec<Outcome> {
    let mut shift = own.guess();
    in_other_size(&mut shift, variation, subject);
    shift.iter_mut().zip(other.guess()).for_each(|(shift, guess)| *shift -= guess);
    let (Some(runs), Some(own_runs)) =
        (other.runs(Numbers::Double, 1, &shift), own.runs(Numbers::Double, 1, &[]))
    else {
        return Vec::new();
    };
    let steps = STEPS as u32;
    let mut outcomes = Vec::new();
    for closing in closings(extent, index).filter(|closing| extent.has(kind(**closing))) {
        let run = positions(runs.as_ref(), *closing, extent.until, steps);
        let own_run = positions(own_runs.as_ref(), *closing, extent.until, steps);
        let refused =
            Outcome { verdict: Verdict::Refused, ..Outcome::blank(variation, format!("Stepper, {closing}")) };
        outcomes.push(match (run, own_run) {
            (Err((reason, failed)), _) => {
                let outcome = Outcome { reason, ..refused };
                match &extent.description {
                    Some(case) => case.refused(outcome, failed),
                    None => outcome,
                }
            }
            (Ok(_), Err((reason, _))) => {
                Outcome { reason: format!("the mechanism itself: {reason}"), ..refused }
            }
            (Ok((run, work)), Ok((own_run, own_work))) => {
                let places =
                    |run: &[Placed<f64>]| run.iter().map(|placed| placed.motion[0].clone()).collect();
                let mut places_of_other: Vec<Vec<f64>> = places(&run);
                places_of_other.iter_mut().for_each(|q| in_size(q, variation, subject));
                let places_of_own: Vec<Vec<f64>> = places(&own_run);
                compared(refused, (&places_of_other, &places_of_own), (work, own_work), &subject.scales)
            }
        });
    }
    outcomes
}

fn kind(closing: Closing) -> MethodKind {
    if closing == Closing::Closed { MethodKind::Drives } else { MethodKind::Bounded }
}

/// Positions with the number of evaluations, or the reason why there are none, with its time (s).
type Positions = Result<(Vec<Placed<f64>>, u64), (String, Option<f64>)>;

fn positions(runs: &dyn TimedSteps, closing: Closing, until: f64, steps: u32) -> Positions {
    let times: Vec<f64> = (0..=steps).map(|k| until * f64::from(k) / f64::from(steps)).collect();
    let mut seen = Vec::new();
    let effort = runs.run(closing, &times, Some(&mut |placed| seen.push(placed)));
    effort.map(|effort| (seen, effort.evaluations)).map_err(|failure| (failure.to_string(), failure.time))
}

fn outcome(
    variation: &Variation,
    method: String,
    (run, fine): (Positions, &Positions),
    oracle: &Oracle,
    (subject, numbers, closing): (&VariedParts, Numbers, Closing),
) -> Outcome {
    let mut outcome = Outcome::blank(variation, method);
    let (run, work) = match run {
        Ok(run) => run,
        Err((reason, _)) => return Outcome { reason, ..outcome },
    };
    outcome.work = work;
    let scales = &subject.scales;
    outcome.course = Course::of_place(
        run.iter().step_by(3).filter_map(|placed| placed.motion[0].last().copied()).collect(),
    );
    let is_closed = closing == Closing::Closed;
    let largest = run.iter().flat_map(|placed| placed.motion[0].iter().zip(scales));
    let largest = largest.map(|(q, scale)| (q / scale).abs()).fold(1.0, f64::max);
    // A bounded step says itself how far its rows are open; the assembly must be the same. Next to a singular position the root
    // of the rounding in the rows is left in the position.
    let [open, bound] = match (numbers, is_closed) {
        (Numbers::Double, true) => [1e-11, 1e-7],
        _ => [1e-3; 2],
    }
    .map(|bound| bound * largest);
    outcome.bound = Some(bound);
    let digit = numbers.epsilon() * largest;
    let bounds = Bounds { rows: open, balance: open, estimate: bound, rounding: bound, digit };
    let states: Vec<OracleState> = run.iter().map(of_driven).collect();
    let judgement = judge([&states, &[]], oracle, scales, bounds, variation.seed);
    outcome.not_made = judgement.not_made;
    let branch = states.iter().find_map(|state| {
        let values = oracle.branches(state).ok()?;
        let left = values.into_iter().find(|(_, value)| *value < -bound)?;
        Some(format!("branch `{}` is left at t = {:.4} s, and nothing was said", left.0, state.t))
    });
    let apart = fine.as_ref().ok().map(|(fine, _)| {
        let pairs = run.iter().zip(fine.iter().step_by(FINER as usize));
        let pairs =
            pairs.flat_map(|(a, b)| a.motion[0].iter().zip(&b.motion[0]).zip(scales).zip(oracle.turns()));
        pairs
            .map(|(((a, b), scale), turns)| ((if *turns { less_turns(a - b) } else { a - b }) / scale).abs())
            .fold(0.0, larger)
    });
    outcome.error = apart;
    if let Err((reason, _)) = fine {
        outcome.not_made.push(format!("steps of a sixteenth: {reason}"));
    }
    let (verdict, reason) = match (judgement.wrong.or(branch), apart) {
        (Some(reason), _) => (Verdict::Wrong, reason),
        (None, Some(apart)) if exceeds(apart, bound) => {
            (Verdict::Wrong, format!("steps of a sixteenth lead to another position, by {apart:.1e}"))
        }
        _ => (Verdict::Right, String::new()),
    };
    Outcome { verdict, reason, ..outcome }
}
