//! `mbs hard-cases` without a name: the built-in list of cases by every method.

use std::io::Write;
use std::num::NonZero;
use std::panic::resume_unwind;
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{Builder, available_parallelism, scope};

use indicatif::{ProgressBar, ProgressStyle};

use super::cost::{machine, methods};
use super::document::Output;
use super::hard_cases::{Arguments, FEW, VARIANTS, WHOLE, command, print, verdict};
use super::report_files::{require_writable, write_report};
use super::{CommandError, STACK};
use crate::forge::{Blueprint, Study};
use crate::hard_cases::course::Course;
use crate::hard_cases::list::{Case, Listed, cases};
use crate::hard_cases::matrix::svg;
use crate::hard_cases::result::{MatrixResult, in_order};
use crate::hard_cases::study::{Clock, Extent, Own, Study as Found, study as studied};
use crate::hard_cases::variation::Class;
use crate::hard_cases::verdict::{Outcome, Verdict};
use crate::mismatch::nearest;
use crate::output::origin::Origin;
use crate::setting::MotionMethod;
use crate::target_directory::target_directory;

/// Variants of a case in an overview.
const FEW_VARIANTS: u64 = 8;

/// Cases that are asked for.
fn chosen(arguments: &Arguments) -> Result<Vec<Case>, CommandError> {
    let all = cases().map_err(CommandError::Failed)?;
    let is_known = |name: &&String| all.iter().any(|case| case.name == **name);
    if let Some(unknown) = arguments.cases.iter().find(|name| !is_known(name)) {
        let names: Vec<&str> = all.iter().map(|case| case.name.as_str()).collect();
        let near = nearest(unknown, names.iter().copied());
        let proposal = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
        return Err(CommandError::Usage(format!(
            "no case is called `{unknown}`{proposal}\nthe cases: {}",
            names.join(", ")
        )));
    }
    let is_asked = |case: &Case| match arguments.cases.as_slice() {
        [] => arguments.long || !case.description.long,
        names => names.contains(&case.name),
    };
    Ok(all.into_iter().filter(is_asked).collect())
}

/// The program that has all cases that are asked for.
pub fn blueprint(arguments: &Arguments) -> Result<Blueprint, CommandError> {
    let cases = chosen(arguments)?;
    let texts: Vec<_> =
        cases.iter().map(|case| (case.name.as_str(), case.type_name(), case.text.as_str())).collect();
    Ok(Blueprint::study_of_texts(&Study::HARD_CASES, "list", &texts))
}

/// The study itself, in a program that has the mechanisms of `listed`.
pub fn study(arguments: &Arguments, listed: &[Listed], out: &mut Output) -> Result<ExitCode, CommandError> {
    let cases = chosen(arguments)?;
    let default = || target_directory().join("mbs").join("hard-cases");
    let directory = arguments.out.clone().unwrap_or_else(default);
    require_writable(&directory)?;
    let methods = match methods(&arguments.methods)? {
        given if !given.is_empty() => given,
        _ if arguments.quick => FEW.to_vec(),
        _ => MotionMethod::all(),
    };
    let variants = arguments.variants.unwrap_or(if arguments.quick { FEW_VARIANTS } else { VARIANTS });
    let seeds: Vec<u64> = arguments.replay.map_or_else(|| (0..variants).collect(), |seed| vec![seed]);
    let style = ProgressStyle::with_template("{bar:30} {percent}% {msg}").expect("a valid template");
    let bar = ProgressBar::new(1000 * cases.len() as u64).with_style(style);
    let in_turn = arguments.quick && arguments.variants.is_none() && arguments.replay.is_none();
    let work = Work { listed, methods: &methods, seeds: &seeds, in_turn, bar: &bar };
    let (mut outcomes, mut left_out) = (Vec::new(), Vec::new());
    for found in work.all(&cases) {
        let found = found?;
        outcomes.extend(found.outcomes);
        left_out.extend(found.left_out);
    }
    let titles: Vec<String> = cases.iter().map(|case| case.name.clone()).collect();
    bar.finish_and_clear();
    let mut columns: Vec<String> = methods.iter().map(ToString::to_string).collect();
    columns.extend(in_order(outcomes.iter().map(|outcome| outcome.method.as_str())));
    let columns: Vec<String> = in_order(columns.iter().map(String::as_str))
        .into_iter()
        .filter(|column| outcomes.iter().any(|outcome| outcome.method == *column))
        .collect();
    let mut result = MatrixResult::of_cases(outcomes, titles, columns);
    let texts: String = cases.iter().map(|case| case.text.as_str()).collect();
    let origin = Origin::of_text("hard cases", &texts);
    result.name = "hard-cases".to_string();
    result.title = "Hard cases".to_string();
    result.origin = origin.line();
    result.command = command(arguments, true);
    let quick = if arguments.quick { " --quick" } else { "" };
    result.replay = format!("mbs hard-cases --cases CASE{quick} --replay ");
    result.left_out = left_out;
    result.facts = [
        ("cases", cases.len().to_string()),
        ("variants", {
            let by = if in_turn { ", one by each method" } else { "" };
            format!("{} of each case, each from its seed{by}", seeds.len())
        }),
        ("bounds", "stored with each case before the run".to_string()),
        ("elimination", result.elimination()),
        ("machine", machine()),
        ("texts", origin.hash.clone()),
    ]
    .map(|(name, value)| [name.to_string(), value])
    .to_vec();
    print(&result, arguments, out)?;
    for (case, method, count) in result.refusing() {
        writeln!(out, "  not foreseen: {count} refused or late runs of {case}, {method}")?;
    }
    out.put("result", result.document());
    let picture = svg(&result.picture(), &result.sentence());
    let files = [
        ("hard-cases.html", result.page()),
        ("hard-cases.csv", origin.csv(&result.csv())),
        ("hard-cases.svg", origin.svg(&picture)),
    ];
    for (kind, path) in ["page", "table", "picture"].iter().zip(write_report(&directory, &files)?) {
        out.put_file(kind, &path);
        writeln!(out, "{kind:<8} {}", path.display())?;
    }
    out.flush()?;
    verdict(&result)
}

/// Cases to run, by the cores of the machine.
struct Work<'a> {
    listed: &'a [Listed],
    methods: &'a [MotionMethod],
    seeds: &'a [u64],
    /// Each method runs one of the variants.
    in_turn: bool,
    bar: &'a ProgressBar,
}

impl Work<'_> {
    /// All cases, in their order; what is found does not depend on the number of cores.
    fn all(&self, cases: &[Case]) -> Vec<Result<Found, CommandError>> {
        let next = AtomicUsize::new(0);
        let cores = available_parallelism().map_or(1, NonZero::get).min(cases.len());
        let some = || {
            let mut found = Vec::new();
            while let Some((index, case)) = cases.iter().enumerate().nth(next.fetch_add(1, Ordering::Relaxed))
            {
                found.push((index, self.one(index, case)));
            }
            found
        };
        let mut found: Vec<_> = scope(|threads| {
            let spawned = |_| Builder::new().stack_size(STACK).spawn_scoped(threads, some);
            let started: Vec<_> = (1..cores).map(spawned).collect();
            // A thread that does not start leaves its cases to the others, this one among them.
            let own = some();
            let ended = started.into_iter().flatten().map(|thread| thread.join());
            let others = ended.flat_map(|found| found.unwrap_or_else(|panic| resume_unwind(panic)));
            own.into_iter().chain(others).collect()
        });
        found.sort_by_key(|(index, _)| *index);
        found.into_iter().map(|(_, found)| found).collect()
    }

    /// The case of an index by all methods.
    fn one(&self, index: usize, case: &Case) -> Result<Found, CommandError> {
        let description = &case.description;
        let Some((_, card, make)) = self.listed.iter().find(|(name, ..)| *name == case.name) else {
            return Err(CommandError::Failed(format!("this program was built without `{}`", case.name)));
        };
        let mut done = 0;
        let mut progress = |words: &str, share: f64| {
            self.bar.set_message(format!("{}: {words}", case.name));
            let reached = (1000.0 * share) as u64;
            self.bar.inc(reached.saturating_sub(done));
            done = done.max(reached);
        };
        let equations = card.equations();
        let until = match description.until {
            Some(until) => until,
            None => card.duration(equations.as_ref())?,
        };
        let own = Own { make: *make, equations: equations.as_ref() };
        let (mut methods, mut seeds) = (self.methods.to_vec(), self.seeds.to_vec());
        if let Some(few) = &description.few {
            methods.retain(|method| few.methods.contains(&method.to_string()));
            // A seed that is asked for by itself is run.
            if seeds.len() > 1 {
                seeds.retain(|seed| few.seeds.contains(seed));
            }
        }
        let extent = Extent {
            methods: methods.clone(),
            seeds,
            in_turn: self.in_turn.then_some(index),
            until,
            description: Some(description.clone()),
        };
        // What is run does not depend on the machine.
        let found = studied(&own, &extent, &Clock::of(WHOLE), &mut progress);
        self.bar.inc(1000_u64.saturating_sub(done));
        let found = found.unwrap_or_else(|reason| not_moved(&methods, reason));
        let mut left_out = Vec::new();
        if found.not_run > 0 {
            left_out.push(format!("{}: {} variants, for which there was no time", case.name, found.not_run));
        }
        if let Some(few) = &description.few {
            left_out.push(format!("{}: all but {}: {}", case.name, few.words(), few.why));
        }
        left_out.extend(description.outside.iter().map(|outside| {
            let all = |names: &[String], whole: &str| {
                if names.is_empty() { whole.to_string() } else { names.join(", ") }
            };
            format!(
                "{}, outside of the range, {}, {}: {}",
                case.name,
                all(&outside.methods, "all methods"),
                all(&outside.variants, "all variants"),
                outside.why
            )
        }));
        let outcomes = found.outcomes.into_iter().map(|outcome| {
            // A run that is right may turn out late beside the others.
            let is_foreseen =
                description.is_outside(&outcome.method, outcome.class) && outcome.verdict != Verdict::Wrong;
            let is_expected = outcome.is_expected || is_foreseen;
            Outcome { case: case.name.clone(), is_expected, ..outcome }
        });
        Ok(Found { outcomes: outcomes.collect(), left_out, not_run: found.not_run })
    }
}

/// A case without a motion: all methods are refused.
fn not_moved(methods: &[MotionMethod], reason: String) -> Found {
    let refused = |method: &MotionMethod| Outcome {
        case: String::new(),
        seed: 0,
        class: Class::Steps,
        method: method.to_string(),
        variant: "as the text has it".to_string(),
        verdict: Verdict::Refused,
        error: None,
        bound: None,
        reason: reason.clone(),
        is_expected: false,
        not_made: Vec::new(),
        work: 0,
        course: Course::default(),
    };
    Found { outcomes: methods.iter().map(refused).collect(), left_out: Vec::new(), not_run: 0 }
}
