//! `mbs cost`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::assignment::{Assignment, assignment};
use super::chosen::{component, finite};
use super::cost_extras::{ask_peers, valleys};
use super::document::Output;
use super::of_file::{first_that_compiles, studies_of_card};
use super::report_files::{require_writable, write_report};
use super::target::Target;
use super::{CommandError, atlas, cost_words, summary};
use super::{cost_kernels, cost_known};
use crate::catalogue::Catalogue;
use crate::cost::advice::two_digits;
use crate::cost::kinematics::driven_study;
use crate::cost::moved::{Extent, NoReference, moved_study};
use crate::cost::perturbed::perturb;
use crate::cost::picture::picture;
use crate::cost::result::CostResult;
use crate::cost::splines;
use crate::erased::costs::Comparable;
use crate::erased::facade::AnyEquations;
use crate::forge::{Blueprint, Forge, Study};
use crate::mismatch::{nearest, wrapped};
use crate::setting::{Kernel, MotionMethod};
use crate::tables::valley::NamedLaw;
use crate::target_directory::target_directory;
use crate::text_file::{TextFile, is_file};

#[derive(Args)]
pub struct Arguments {
    /// Name of the mechanism, as `mbs list` prints it, or a file with its text: FILE, FILE:Name, FILE:Name:Scene
    #[arg(required_unless_present = "all")]
    pub(super) name: Option<String>,
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
    #[arg(long, value_name = "OUT", value_delimiter = ',', value_parser = component)]
    watch: Vec<String>,
    /// Methods to compare, by parts of their names: `projection`, `dormandprince8`, `radau5` [default: all]
    #[arg(long, value_name = "METHOD", value_delimiter = ',')]
    methods: Vec<String>,
    /// Fewer and shorter runs: an overview
    #[arg(long)]
    pub(super) quick: bool,
    /// Compare the sines of motions from drives too, in programs of their own: the features `fma` and `libm` of the runtime
    #[arg(long, conflicts_with = "all")]
    kernels: bool,
    /// Writes points of kinematics to a file, in place of a study
    #[arg(long, hide = true, value_name = "FILE")]
    points: Option<PathBuf>,
    /// Reads points of other sines
    #[arg(long, hide = true, value_name = "DIR")]
    points_from: Option<PathBuf>,
    /// Reads a closed form or published digits
    #[arg(long, hide = true, value_name = "FILE")]
    known: Option<PathBuf>,
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
    let mut words: Vec<_> = std::env::args_os().skip(1).collect();
    let mut is_driven = is_file(arguments.name());
    let mut known = None;
    let blueprints = if is_file(arguments.name()) {
        methods(&arguments.methods)?;
        let text = TextFile::read(arguments.name())?;
        super::functions::require(&text)?;
        vec![Blueprint::study_of_text(&Study::COST, &text)]
    } else {
        // What is wrong on the command line is said before anything is built.
        let target = Target::find(catalogue, arguments.name())?;
        let instance = target.instance(&target.runs()[0], &arguments.parameters)?;
        is_driven = !target.is_free();
        if is_driven && arguments.is_for_forces() {
            return Err(driven(&target));
        }
        if !is_driven && arguments.kernels {
            let name = target.name();
            return Err(CommandError::Usage(format!(
                "forces move `{name}`: `--kernels` is for motions from drives"
            )));
        }
        watched(instance.equations(), &arguments.watch)?;
        methods(&arguments.methods)?;
        let equations = instance.equations();
        let until = arguments.until.map_or_else(|| target.duration(equations), Ok)?;
        known = cost_known::written(&target, equations, !arguments.parameters.is_empty(), until)?;
        let own = equations.path();
        let functions = equations.functions();
        studies_of_card(Study::COST, &forge, target.card(), (&own, equations.source(), functions))?
    };
    if let Some(directory) = &arguments.out {
        require_writable(directory)?;
    }
    if arguments.kernels && is_driven {
        let directory = cost_kernels::compared(&forge, &blueprints, &words)?;
        words.extend(["--points-from".into(), directory.into_os_string()]);
    }
    if let Some(path) = known {
        words.extend(["--known".into(), path.into_os_string()]);
    }
    first_that_compiles(&forge, &blueprints, &words)
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
    pub fn name(&self) -> &str {
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
        CommandError::Failed(without(format!("{}: no comparison: {}", target.name(), found.reason)))
    };
    let mut facts = Vec::new();
    let mut fact = |name: &str, value: String| facts.push([name.to_string(), value]);
    let mut peers = Vec::new();
    let known = arguments.known.as_deref().map(cost_known::read).transpose()?;
    let third_leg;
    let compared = make(&values);
    let doubles = match &compared {
        Comparable::Still => Vec::new(),
        Comparable::Driven(mechanism) => mechanism.doubles.clone(),
        Comparable::Moved(mechanism) => mechanism.doubles.clone(),
    };
    if !doubles.is_empty() {
        let words = format!(
            "{}: both references have its digits, so their width is that of `f64`",
            doubles.join(", ")
        );
        fact("functions in `f64` alone", words);
    }
    let (points, width, second) = match compared {
        Comparable::Still => {
            let name = target.name();
            return Err(CommandError::Usage(without(format!(
                "`{name}` has no motion: its rows leave coordinates free, and it has no masses"
            ))));
        }
        Comparable::Driven(_) if arguments.is_for_forces() => return Err(driven(&target)),
        Comparable::Driven(mut mechanism) => {
            let own = (until, longest);
            let mut found = driven_study(&mut mechanism, own, Kernel::Own, &mut progress).map_err(failed)?;
            if let Some(path) = &arguments.points {
                bar.finish_and_clear();
                return cost_kernels::write(path, &found.points);
            }
            if let Some(directory) = &arguments.points_from {
                for (name, words) in cost_kernels::read(directory, &mut found.points) {
                    fact(&name, words);
                }
            }
            fact("reference", found.reference());
            fact(
                "width of rates",
                format!("{}, by the rows against differences of positions", two_digits(found.width)),
            );
            third_leg = known.map(|known| cost_known::of_driven(&known, &found));
            (found.points, found.width_of_positions, "acceleration")
        }
        Comparable::Moved(mut mechanism) => {
            let mut found = moved_study(&mut mechanism, until, &extent, &mut progress).map_err(failed)?;
            progress("perturbed parameters", 1.0);
            perturb(&mut found.points, make, &values, until, &extent);
            for (leg, reference) in &found.references {
                let events = match reference.contacts.len() {
                    0 => String::new(),
                    events => format!(", {events} changes of contacts and events"),
                };
                let words = match &reference.stuck {
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
            if let Some(effect) = found.effect {
                let words = format!(
                    "of one kind: two explicit methods of the runtime, of different order and formulation. The runtime alone decides \
                     the modes of `{effect}`"
                );
                fact("references", words);
            }
            let alone = found.references.iter().any(|(_, reference)| reference.stuck.is_some());
            let how = match (alone, found.effect) {
                (true, _) => ", by coarser steps: one reference alone",
                (false, Some(_)) => ", ten times the difference of legs of one kind",
                (false, None) => "",
            };
            let words = found.width.map_or_else(
                || "not known: one reference alone".to_string(),
                |width| format!("{}{how}", two_digits(width)),
            );
            fact("width of the reference", words);
            third_leg = known.map(|known| cost_known::of_moved(&known, &found));
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
    if let Some(leg) = &third_leg {
        fact("third leg", leg.words());
    }
    let valleys = valleys(equations, laws, &mut progress);
    bar.finish_and_clear();
    fact("instants", "each run is compared at the ends of its steps that are instants of the reference, at most 480 (motion from forces) or 1440".to_string());
    fact("times", "the shortest of five runs, settings interleaved".to_string());
    fact("machine", machine());
    fact("program", format!("mbs {}, release profile", env!("CARGO_PKG_VERSION")));
    fact("text", origin.hash.clone());
    facts.extend(super::functions::facts());
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
    if let Some(contradiction) = third_leg.and_then(|leg| leg.contradiction()) {
        return Err(CommandError::Failed(contradiction));
    }
    match result.wrong().count() {
        0 => Ok(ExitCode::SUCCESS),
        wrong => Err(CommandError::Failed(format!(
            "{wrong} of {} settings are wrong: they answered with more than ten times the error that is expected",
            result.points.len()
        ))),
    }
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
    let given =
        [("--quick", arguments.quick), ("--peers", arguments.peers), ("--kernels", arguments.kernels)];
    for (name, is_given) in given {
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
