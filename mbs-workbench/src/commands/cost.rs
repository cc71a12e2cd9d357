//! `mbs cost`.

use std::cell::RefCell;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::assignment::{Assignment, assignment};
use super::chosen::finite;
use super::document::Output;
use super::of_file::started;
use super::report_files::{require_writable, write_report};
use super::target::Target;
use super::{CommandError, atlas, cost_words, summary};
use crate::catalogue::Catalogue;
use crate::cost::advice::two_digits;
use crate::cost::kinematics::driven_study;
use crate::cost::moved::{Extent, MovedStudy, NoReference, moved_study};
use crate::cost::peers::{Described, PeerPoint, Question, ask_all};
use crate::cost::perturbed::perturb;
use crate::cost::picture::picture;
use crate::cost::result::CostResult;
use crate::cost::splines;
use crate::double_double::DoubleDouble;
use crate::erased::costs::Comparable;
use crate::erased::facade::AnyEquations;
use crate::forge::{Blueprint, Forge, Study};
use crate::mismatch::{nearest, wrapped};
use crate::setting::MotionMethod;
use crate::tables::valley::{NamedLaw, Valley};
use crate::target_directory::target_directory;
use crate::text_file::{TextFile, is_file};
use crate::verify::generated_definition;

#[derive(Args)]
pub struct Arguments {
    /// Name of the mechanism, as `mbs list` prints it, or a file with its text: FILE, FILE:Name, FILE:Name:Scene
    #[arg(required_unless_present = "all")]
    name: Option<String>,
    /// Study all mechanisms of the list, and write an index of their pictures
    #[arg(long, conflicts_with_all = ["name", "parameters", "until", "watch", "rust", "peers"])]
    all: bool,
    /// Set a parameter: a number in the unit that `mbs list` prints, or with a unit as `200mm`, `60rpm`, `4 [m^2]`
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = assignment)]
    parameters: Vec<Assignment>,
    /// End of the motion (s) [default: that of `mbs run`]
    #[arg(long, value_name = "T", value_parser = above_zero, allow_negative_numbers = true)]
    until: Option<f64>,
    /// Error that the advice is for: in the reference metric (rad, reference lengths), of outputs relative to their largest
    #[arg(long, value_name = "E", default_value = "1e-6", value_parser = above_zero, allow_negative_numbers = true)]
    error: f64,
    /// Judge these outputs in place of the coordinates
    #[arg(long, value_name = "OUT", value_delimiter = ',')]
    watch: Vec<String>,
    /// Methods to compare, by parts of their names: `projection`, `dormandprince8`, `radau5` [default: all]
    #[arg(long, value_name = "METHOD", value_delimiter = ',')]
    methods: Vec<String>,
    /// Fewer and shorter runs: an overview
    #[arg(long)]
    quick: bool,
    /// Compare with other programs, which pip installs: SciPy, CVODES, IDAS on CasADi's equations; MuJoCo, Exudyn, Drake, Pinocchio
    #[arg(long)]
    peers: bool,
    /// Print the advice as Rust to paste
    #[arg(long)]
    rust: bool,
    /// Directory of page, picture and table [default: mbs/NAME/cost in cargo's target directory]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub(super) fn above_zero(text: &str) -> Result<f64, String> {
    finite(text).and_then(|number| {
        if number > 0.0 { Ok(number) } else { Err("a number above 0 is needed".to_string()) }
    })
}

/// Builds a program that has the mechanism in all numbers, and runs the command line again in it.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut Output) -> Result<ExitCode, CommandError> {
    if arguments.all {
        methods(&arguments.methods)?;
        return atlas::run(catalogue, &options(arguments), arguments.out.clone(), out);
    }
    let caller = Forge::of_caller(catalogue.first().map(|card| card.manifest.as_ref()));
    // Times of a program that is not optimised say nothing.
    let forge = Forge { release: true, ..caller };
    let blueprint = if is_file(arguments.name()) {
        methods(&arguments.methods)?;
        Blueprint::study_of_text(&Study::COST, &TextFile::read(arguments.name())?)?
    } else {
        // What is wrong on the command line is said before anything is built.
        let target = Target::find(catalogue, arguments.name())?;
        let instance = target.instance(&target.runs()[0], &arguments.parameters)?;
        if !target.is_free() && arguments.is_for_forces() {
            return Err(driven(&target));
        }
        watched(instance.equations(), &arguments.watch)?;
        methods(&arguments.methods)?;
        let source = instance.equations().source();
        let functions = instance.equations().functions();
        Blueprint::study_of_card(&Study::COST, &forge, target.card(), (source, functions))?
    };
    if let Some(directory) = &arguments.out {
        require_writable(directory)?;
    }
    let arguments = std::env::args_os().skip(1).collect();
    studied(&forge, &blueprint, arguments)
}

/// Builds the program of a study and runs it.
pub(super) fn studied(
    forge: &Forge,
    blueprint: &Blueprint,
    arguments: Vec<std::ffi::OsString>,
) -> Result<ExitCode, CommandError> {
    started(forge, blueprint, arguments).map_err(|error| match error {
        CommandError::Failed(reason) if blueprint.origin.is_none() && reason.starts_with("error:") => {
            CommandError::Failed(format!(
                "the study is built in a program of its own: what the card's constructor names must be public, and a function that \
                 it passes must take every `Scalar`\n{reason}"
            ))
        }
        error => error,
    })
}

/// The refusal of options that a motion from drives has no use for.
fn driven(target: &Target) -> CommandError {
    let name = target.name();
    CommandError::Usage(format!(
        "drives move `{name}`: `--methods`, `--watch` and `--peers` are for motions from forces"
    ))
}

impl Arguments {
    /// The mechanism or file.
    fn name(&self) -> &str {
        self.name.as_deref().unwrap_or_default()
    }

    /// `true` where all mechanisms are studied.
    pub fn is_index(&self) -> bool {
        self.all
    }

    /// `true` with options for motions from forces alone.
    fn is_for_forces(&self) -> bool {
        !(self.methods.is_empty() && self.watch.is_empty()) || self.peers
    }
}

/// Methods with one of the words in their names; all where there are none.
pub(super) fn methods(words: &[String]) -> Result<Vec<MotionMethod>, CommandError> {
    let all = MotionMethod::all();
    let plain = |text: &str| text.to_lowercase().replace(['-', '_', ' '], "");
    let mut known: Vec<String> = all
        .iter()
        .flat_map(|method| method.to_string().split(" with ").map(plain).collect::<Vec<_>>())
        .collect();
    known.sort();
    known.dedup();
    for word in words {
        if !known.iter().any(|name| name.contains(&plain(word))) {
            let near = nearest(&plain(word), known.iter().map(String::as_str));
            let near = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            let names: Vec<&str> = known.iter().map(String::as_str).collect();
            return Err(CommandError::Usage(format!(
                "there is no method `{word}`{near}\nknown: {}",
                wrapped(&names)
            )));
        }
    }
    let is_meant =
        |method: &MotionMethod| words.iter().any(|word| plain(&method.to_string()).contains(&plain(word)));
    Ok(if words.is_empty() { Vec::new() } else { all.into_iter().filter(is_meant).collect() })
}

/// Indices of components of the outputs of these names; loads stand behind outputs.
fn watched(equations: &dyn AnyEquations, names: &[String]) -> Result<Vec<usize>, CommandError> {
    let mut known: Vec<&str> = equations.outputs().iter().map(|entry| entry.name).collect();
    known.extend(equations.tables().iter().flat_map(|tables| tables.loads.iter().map(|entry| entry.name)));
    let mut found = Vec::new();
    for name in names {
        let is_meant = |known: &str| {
            known == name || known.strip_prefix(name.as_str()).is_some_and(|rest| rest.starts_with('.'))
        };
        let before = found.len();
        found.extend(known.iter().enumerate().filter(|(_, known)| is_meant(known)).map(|(index, _)| index));
        if found.len() == before {
            let near = nearest(name, known.iter().copied());
            let near = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            let list = if known.is_empty() { "none".to_string() } else { wrapped(&known) };
            return Err(CommandError::Usage(format!("there is no output `{name}`{near}\nknown: {list}")));
        }
    }
    Ok(found)
}

/// Longest runs and times of references: whole, and for an overview.
const WHOLE: (f64, f64, f64) = (0.25, 40.0, 1e-17);
const QUICK: (f64, f64, f64) = (0.02, 8.0, 1e-14);

/// The study itself, in a program that has the mechanism of `catalogue` in all numbers.
pub fn study(
    catalogue: &Catalogue,
    arguments: &Arguments,
    make: fn(&[(usize, f64)]) -> Comparable,
    laws: &[NamedLaw],
    out: &mut Output,
) -> Result<ExitCode, CommandError> {
    let target = Target::find(catalogue, arguments.name())?;
    let instance = target.instance(&target.runs()[0], &arguments.parameters)?;
    let equations = instance.equations();
    let watched = watched(equations, &arguments.watch)?;
    let until = arguments.until.map_or_else(|| target.duration(equations), Ok)?;
    let directory = arguments
        .out
        .clone()
        .unwrap_or_else(|| target_directory().join("mbs").join(target.file_name()).join("cost"));
    require_writable(&directory)?;
    let values: Vec<(usize, f64)> =
        (0..equations.variables().len()).filter_map(|index| Some((index, equations.get(index)?))).collect();
    let (longest, reference, tolerance) = if arguments.quick { QUICK } else { WHOLE };
    let extent = Extent {
        methods: methods(&arguments.methods)?,
        longest,
        reference,
        tolerance,
        watched: watched.clone(),
    };
    let style = ProgressStyle::with_template("{bar:30} {percent}% {msg}").expect("a valid template");
    let bar = ProgressBar::new(1000).with_style(style);
    let mut progress = |words: &str, share: f64| {
        bar.set_message(words.to_string());
        bar.set_position((1000.0 * share) as u64);
    };
    let origin = out.put_mechanism(&target, equations);
    let mut without = |reason: String| {
        out.put("no_study", &reason);
        reason
    };
    let failed = |found: NoReference| {
        CommandError::Failed(without(format!(
            "{}: no true solution to compare with: {}",
            target.name(),
            found.reason
        )))
    };
    let mut facts = Vec::new();
    let mut fact = |name: &str, value: String| facts.push([name.to_string(), value]);
    let mut peers = Vec::new();
    let (points, width, second) = match make(&values) {
        Comparable::Still => {
            let name = target.name();
            return Err(CommandError::Usage(without(format!(
                "`{name}` has no motion: its rows leave coordinates free, and it has no masses"
            ))));
        }
        Comparable::Driven(_) if arguments.is_for_forces() => return Err(driven(&target)),
        Comparable::Driven(mut mechanism) => {
            let found = driven_study(&mut mechanism, until, longest, &mut progress).map_err(failed)?;
            fact(
                "reference",
                "positions closed to 29 digits in double-double numbers; rates by differences of positions"
                    .to_string(),
            );
            fact(
                "width of rates",
                format!("{}, by the rows against differences of positions", two_digits(found.width)),
            );
            (found.points, None, "acceleration")
        }
        Comparable::Moved(mut mechanism) => {
            let mut found = moved_study(&mut mechanism, until, &extent, &mut progress).map_err(failed)?;
            progress("perturbed parameters", 1.0);
            perturb(&mut found.points, make, &values, until, &extent);
            for (leg, reference) in &found.references {
                let events = match reference.events {
                    0 => String::new(),
                    events => format!(", {events} contacts"),
                };
                let words = match reference.stuck {
                    None => {
                        format!("{} steps of tolerance {:.0e}{events}", reference.steps, reference.tolerance)
                    }
                    Some(_) => format!(
                        "not used: it ended at t = {:.4} s",
                        reference.shots.last().map_or(0.0, |shot| shot.at.t.high)
                    ),
                };
                fact(&format!("{} reference", leg.name()), words);
            }
            let words = found.width.map_or_else(|| "not known: one reference alone".to_string(), two_digits);
            fact("width of the reference", words);
            if arguments.peers {
                peers = ask_peers(&found, &target, equations, arguments, &mut progress);
                fact(
                    "other programs",
                    "in processes of their own, one core, the shortest of five runs".to_string(),
                );
            }
            (found.points, found.width, "reaction")
        }
    };
    let valleys = valleys(equations, laws, &mut progress);
    bar.finish_and_clear();
    fact("instants", "each run is compared at the ends of its steps that are instants of the reference, at most 480 (motion from forces) or 1440".to_string());
    fact("times", "the shortest of five runs, settings interleaved".to_string());
    fact("machine", machine());
    fact("program", format!("mbs {}, release profile", env!("CARGO_PKG_VERSION")));
    fact("text", origin.hash.clone());
    let judged =
        if arguments.watch.is_empty() { "coordinates".to_string() } else { arguments.watch.join(", ") };
    let result = CostResult {
        origin: origin.line(),
        name: target.name().to_string(),
        title: target.title().to_string(),
        command: command(arguments),
        constructor: target.card().constructor.to_string(),
        until,
        asked: arguments.error,
        points,
        peers,
        valleys,
        width,
        judged,
        second,
        facts,
    };
    cost_words::print(&result, arguments.rust, out)?;
    out.put("result", result.document());
    let mut files = vec![
        ("cost.html", result.page()),
        ("cost.svg", origin.svg(&picture(&result))),
        ("cost.csv", origin.csv(&result.csv())),
    ];
    let mut kinds = vec!["page", "picture", "table"];
    if !result.valleys.is_empty() {
        files.push(("splines.svg", origin.svg(&splines::picture(&result.valleys))));
        files.push(("splines.csv", origin.csv(&splines::csv(&result.valleys))));
        kinds.extend(["picture", "table"]);
    }
    for (kind, path) in kinds.iter().zip(write_report(&directory, &files)?) {
        out.put_file(kind, &path);
        writeln!(out, "{kind:<8} {}", path.display())?;
    }
    out.flush()?;
    match result.wrong().count() {
        0 => Ok(ExitCode::SUCCESS),
        wrong => Err(CommandError::Failed(format!(
            "{wrong} of {} settings are wrong: they answered with more than ten times the error that is expected",
            result.points.len()
        ))),
    }
}

/// Tables of the periodic functions of the caller.
fn valleys(
    equations: &dyn AnyEquations,
    laws: &[NamedLaw],
    progress: &mut dyn FnMut(&str, f64),
) -> Vec<Valley> {
    let mut found = Vec::new();
    for (name, law) in laws {
        let entry = equations.functions().iter().find(|entry| entry.name == *name);
        let Some((entry, period)) = entry.and_then(|entry| Some((entry, entry.period?))) else { continue };
        progress(&format!("tables of {name}"), 1.0);
        found.push(Valley::of(name, [entry.unit, entry.argument_unit], law, period));
    }
    found
}

/// Runs of other programs on the motion of a study.
fn ask_peers(
    study: &MovedStudy,
    target: &Target,
    equations: &dyn AnyEquations,
    arguments: &Arguments,
    progress: &mut dyn FnMut(&str, f64),
) -> Vec<PeerPoint> {
    let Some(start) = study.judge().and_then(|reference| reference.shots.first()) else { return Vec::new() };
    let doubles = |values: &[DoubleDouble]| values.iter().map(|value| value.high).collect::<Vec<f64>>();
    let variables = equations.variables();
    let v: Vec<f64> = (0..variables.len()).map(|index| equations.get(index).unwrap_or_default()).collect();
    let parameters =
        variables.iter().zip(&v).map(|(entry, value)| (entry.name.to_string(), (*value).into())).collect();
    // Each pair of decades; of an overview fewer.
    let digits = if arguments.quick { vec![4, 6, 8] } else { vec![4, 6, 8, 10, 12] };
    let question = Question {
        name: target.file_name().to_string(),
        times: study.times.clone(),
        q: doubles(&start.at.q),
        qd: doubles(&start.at.qd),
        z: doubles(&start.at.states),
        v,
        parameters,
        digits,
        longest: if arguments.quick { 0.3 } else { 1.5 },
    };
    let functions = equations.functions().iter().map(|function| function.name).collect::<Vec<_>>();
    let definition = match functions[..] {
        [] => generated_definition(equations).map_err(|error| error.to_string()),
        _ => Err(format!("it calls functions of its crate ({})", functions.join(", "))),
    };
    // Beside the crate's manifest, or beside the file with the text.
    let place = match is_file(arguments.name()) {
        true => {
            Path::new(arguments.name().split(':').next().unwrap_or_default()).parent().map(Path::to_path_buf)
        }
        false => Some(PathBuf::from(target.card().manifest)),
    };
    let tree = place.unwrap_or_default().join("peers").join(format!("{}.py", target.file_name()));
    let progress = RefCell::new(progress);
    ask_all(&question, &Described { definition, tree }, &|q, qd| study.errors_of(q, qd), &|words| {
        progress.borrow_mut()(words, 1.0)
    })
}

/// The command line that makes the same study.
fn command(arguments: &Arguments) -> String {
    let mut words = vec!["mbs".to_string(), "cost".to_string(), arguments.name().to_string()];
    words.extend(options(arguments));
    words.join(" ")
}

/// The options that a study depends on.
fn options(arguments: &Arguments) -> Vec<String> {
    let mut words = Vec::new();
    words.extend(arguments.parameters.iter().flat_map(|given| ["--param".to_string(), given.written()]));
    if let Some(until) = arguments.until {
        words.extend(["--until".to_string(), summary::short(until)]);
    }
    words.extend(["--error".to_string(), format!("{:e}", arguments.error)]);
    for (name, values) in [("--watch", &arguments.watch), ("--methods", &arguments.methods)] {
        if !values.is_empty() {
            words.extend([name.to_string(), values.join(",")]);
        }
    }
    for (name, is_given) in [("--quick", arguments.quick), ("--peers", arguments.peers)] {
        if is_given {
            words.push(name.to_string());
        }
    }
    words
}

/// The processor's name where the system tells it, and its architecture.
pub(super) fn machine() -> String {
    let told = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = told
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':').map(|(_, name)| name.trim()));
    match model {
        Some(model) => format!("{model}, {}", std::env::consts::ARCH),
        None => std::env::consts::ARCH.to_string(),
    }
}
