//! `mbs hard-cases`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::assignment::{Assignment, assignment};
use super::cost::{above_zero, machine, methods};
use super::document::Output;
use super::of_file::{first_that_compiles, studies_of_card};
use super::report_files::{require_writable, write_report};
use super::target::Target;
use super::{CommandError, hard_case_list, summary};
use crate::catalogue::Catalogue;
use crate::erased::variations::Variable;
use crate::forge::{Blueprint, Forge, Study};
use crate::hard_cases::result::MatrixResult;
use crate::hard_cases::study::{Clock, Extent, Own, study as studied_variants};
use crate::hard_cases::verdict::Verdict;
use crate::setting::{FormulationName, ImplicitName, IntegratorName, MotionMethod};
use crate::target_directory::target_directory;
use crate::text_file::{TextFile, is_file};

#[derive(Args)]
pub struct Arguments {
    /// Name of the mechanism, as `mbs list` prints it, or a file with its text: FILE, FILE:Name, FILE:Name:Scene
    /// [default: the built-in list of cases]
    pub name: Option<String>,
    /// Cases of the built-in list by their names [default: all but the long ones]
    #[arg(long, value_name = "CASE", value_delimiter = ',', conflicts_with = "name")]
    pub(super) cases: Vec<String>,
    /// Run the long cases of the built-in list too: minutes each
    #[arg(long, conflicts_with = "name")]
    pub(super) long: bool,
    /// Set a parameter: a number in the unit that `mbs list` prints, or with a unit as `200mm`, `60rpm`, `4 [m^2]`
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = assignment, requires = "name")]
    parameters: Vec<Assignment>,
    /// End of the motion (s) [default: that of `mbs run`]
    #[arg(long, value_name = "T", value_parser = above_zero, allow_negative_numbers = true, requires = "name")]
    until: Option<f64>,
    /// Methods of a motion from forces, by parts of their names: `projection`, `radau5` [default: all]
    #[arg(long, value_name = "METHOD", value_delimiter = ',')]
    pub(super) methods: Vec<String>,
    /// Number of variants [default: 100]
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub(super) variants: Option<u64>,
    /// Six methods, and at most 45 s of computation; of the built-in list each method runs one of 8 kinds of variants, in turn
    #[arg(long)]
    pub(super) quick: bool,
    /// Run the one variant with this seed, and print each verdict with its figures
    #[arg(long, value_name = "SEED")]
    pub(super) replay: Option<u64>,
    /// Directory of page and table [default: mbs/NAME/hard-cases in cargo's target directory]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
}

/// Longest time of a study: whole, and of an overview.
pub(super) const WHOLE: Duration = Duration::from_secs(1800);
pub(super) const QUICK: Duration = Duration::from_secs(45);

/// Variants of a mechanism.
pub(super) const VARIANTS: u64 = 100;

/// Methods of an overview.
pub(super) const FEW: [MotionMethod; 6] = [
    MotionMethod::Explicit(FormulationName::Projection, IntegratorName::DormandPrince8),
    MotionMethod::Explicit(FormulationName::Projection, IntegratorName::Radau5),
    MotionMethod::Explicit(FormulationName::Projection, IntegratorName::RungeKutta4),
    MotionMethod::Explicit(FormulationName::VelocityTransformation, IntegratorName::DormandPrince5),
    MotionMethod::Explicit(FormulationName::Baumgarte, IntegratorName::DormandPrince8),
    MotionMethod::Implicit(ImplicitName::Extrapolated),
];

/// Builds a program that has the mechanism in all variants, and runs the command line again in it.
pub fn run(catalogue: &Catalogue, arguments: &Arguments) -> Result<ExitCode, CommandError> {
    let caller = Forge::of_caller(catalogue.first().map(|card| card.manifest.as_ref()));
    let forge = Forge { release: true, ..caller };
    // What is wrong on the command line is said before anything is built.
    methods(&arguments.methods)?;
    let blueprints = if let Some(name) = arguments.name.as_deref().filter(|name| is_file(name)) {
        let text = TextFile::read(name)?;
        super::functions::require(&text)?;
        vec![Blueprint::study_of_text(&Study::HARD_CASES, &text)]
    } else if let Some(name) = &arguments.name {
        let target = Target::find(catalogue, name)?;
        let instance = target.instance(&target.runs()[0], &arguments.parameters)?;
        if !target.is_free() && !arguments.methods.is_empty() {
            return Err(driven(&target));
        }
        let equations = instance.equations();
        let text = (equations.path(), equations.source(), equations.functions());
        studies_of_card(Study::HARD_CASES, &forge, target.card(), (&text.0, text.1, text.2))?
    } else {
        vec![hard_case_list::blueprint(arguments)?]
    };
    if let Some(directory) = &arguments.out {
        require_writable(directory)?;
    }
    let words: Vec<_> = std::env::args_os().skip(1).collect();
    first_that_compiles(&forge, &blueprints, &words)
}

/// The refusal of methods where drives move the mechanism.
fn driven(target: &Target) -> CommandError {
    CommandError::Usage(format!("drives move `{}`: `--methods` is for motions from forces", target.name()))
}

/// The study itself, in a program that has the mechanism of `catalogue` in all variants.
pub fn study(
    catalogue: &Catalogue,
    arguments: &Arguments,
    make: fn(&[(usize, f64)]) -> Variable,
    out: &mut Output,
) -> Result<ExitCode, CommandError> {
    let target = Target::find(catalogue, arguments.name.as_deref().unwrap_or_default())?;
    let instance = target.instance(&target.runs()[0], &arguments.parameters)?;
    let equations = instance.equations();
    if !target.is_free() && !arguments.methods.is_empty() {
        return Err(driven(&target));
    }
    let until = arguments.until.map_or_else(|| target.duration(equations), Ok)?;
    let directory = arguments
        .out
        .clone()
        .unwrap_or_else(|| target_directory().join("mbs").join(target.file_name()).join("hard-cases"));
    require_writable(&directory)?;
    let methods = match methods(&arguments.methods)? {
        given if !given.is_empty() => given,
        _ if arguments.quick => FEW.to_vec(),
        _ => MotionMethod::all(),
    };
    let seeds = match arguments.replay {
        Some(seed) => vec![seed],
        None => (0..arguments.variants.unwrap_or(VARIANTS)).collect(),
    };
    let extent = Extent { methods, seeds, until, in_turn: None, description: None };
    let allowed = if arguments.quick { QUICK } else { WHOLE };
    let style = ProgressStyle::with_template("{bar:30} {percent}% {msg}").expect("a valid template");
    let bar = ProgressBar::new(1000).with_style(style);
    let mut progress = |words: &str, share: f64| {
        bar.set_message(words.to_string());
        bar.set_position((1000.0 * share) as u64);
    };
    let own = Own { make, equations };
    let found = studied_variants(&own, &extent, &Clock::of(allowed), &mut progress)
        .map_err(|reason| CommandError::Failed(format!("{}: {reason}", target.name())))?;
    bar.finish_and_clear();
    let mut result = MatrixResult::of(found, target.name().to_string(), target.title().to_string());
    let origin = out.put_mechanism(&target, equations);
    result.origin = origin.line();
    result.command = command(arguments, true);
    result.replay = format!("{} --replay ", command(arguments, false));
    let references = match target.is_free() {
        true => "projection at tolerance 1e-11, and a formulation of another kind",
        false => "steps of a sixteenth",
    };
    result.facts = [
        ("motion", format!("to t = {} s", summary::short(until))),
        ("variants", format!("{}, each from its seed", extent.seeds.len())),
        ("oracle", "the statements of the text, interpreted: rows, energies, forces".to_string()),
        ("references", references.to_string()),
        ("elimination", result.elimination()),
        ("machine", machine()),
        ("text", origin.hash.clone()),
    ]
    .map(|(name, value)| [name.to_string(), value])
    .into_iter()
    .chain(super::functions::facts())
    .collect();
    print(&result, arguments, out)?;
    out.put("result", result.document());
    let files = [("hard-cases.html", result.page()), ("hard-cases.csv", origin.csv(&result.csv()))];
    for (kind, path) in ["page", "table"].iter().zip(write_report(&directory, &files)?) {
        out.put_file(kind, &path);
        writeln!(out, "{kind:<8} {}", path.display())?;
    }
    out.flush()?;
    verdict(&result)
}

/// Failure of the command where a run is wrong.
pub(super) fn verdict(result: &MatrixResult) -> Result<ExitCode, CommandError> {
    match result.count(Verdict::Wrong) {
        0 => Ok(ExitCode::SUCCESS),
        wrong => Err(CommandError::Failed(format!(
            "{wrong} of {} runs are wrong: they answered, and the answer is not right",
            result.outcomes.len()
        ))),
    }
}

/// The command line that makes the same study; `whole`: with the number of variants.
pub(super) fn command(arguments: &Arguments, whole: bool) -> String {
    let mut words = vec!["mbs".to_string(), "hard-cases".to_string()];
    words.extend(arguments.name.clone());
    words.extend(arguments.parameters.iter().flat_map(|given| ["--param".to_string(), given.written()]));
    if let Some(until) = arguments.until {
        words.extend(["--until".to_string(), summary::short(until)]);
    }
    if arguments.long {
        words.push("--long".to_string());
    }
    if !arguments.methods.is_empty() {
        words.extend(["--methods".to_string(), arguments.methods.join(",")]);
    }
    if let (true, Some(variants)) = (whole, arguments.variants) {
        words.extend(["--variants".to_string(), variants.to_string()]);
    }
    if arguments.quick {
        words.push("--quick".to_string());
    }
    if let (true, Some(seed)) = (whole, arguments.replay) {
        words.extend(["--replay".to_string(), seed.to_string()]);
    }
    words.join(" ")
}

/// Reasons of a verdict that are printed.
const SHOWN: usize = 12;

pub(super) fn print(
    result: &MatrixResult,
    arguments: &Arguments,
    out: &mut dyn Write,
) -> Result<(), CommandError> {
    writeln!(out, "{}", result.title)?;
    for [name, value] in &result.facts {
        writeln!(out, "  {name}: {value}")?;
    }
    writeln!(out, "\n{}", result.matrix())?;
    if arguments.replay.is_some() {
        for outcome in &result.outcomes {
            let figure =
                |value: Option<f64>| value.map_or_else(|| "–".to_string(), |value| format!("{value:.1e}"));
            writeln!(
                out,
                "{}{}seed {}, {}: {}, {}: {}, error {}, bound {}, work {}{}{}",
                outcome.case,
                if outcome.case.is_empty() { "" } else { ", " },
                outcome.seed,
                outcome.class.name(),
                outcome.variant,
                outcome.method,
                outcome.verdict.name(),
                figure(outcome.error),
                figure(outcome.bound),
                outcome.work,
                if outcome.reason.is_empty() { "" } else { ": " },
                outcome.reason
            )?;
        }
        writeln!(out)?;
    }
    writeln!(out, "{}", result.sentence())?;
    for verdict in [Verdict::Wrong, Verdict::Refused, Verdict::Late] {
        let reasons = result.reasons(verdict);
        for (words, count, replay) in reasons.iter().take(SHOWN) {
            writeln!(out, "  {} {count}: {words}\n    {replay}", verdict.name())?;
        }
        if reasons.len() > SHOWN {
            writeln!(out, "  {} …: {} more reasons on the page", verdict.name(), reasons.len() - SHOWN)?;
        }
    }
    for (words, count) in result.not_made() {
        writeln!(out, "  not checked in {count} runs: {words}")?;
    }
    for words in &result.left_out {
        writeln!(out, "  left out: {words}")?;
    }
    if result.not_run > 0 {
        writeln!(out, "  left out: {} variants, for which there was no time", result.not_run)?;
    }
    Ok(())
}
