//! `mbs effects`.

use core::f64::consts::TAU;
use std::cell::RefCell;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use mbs_codegen::WHOLE;
use mbs_codegen::picture::{Picture, Span, picture};

use super::assignment::{Assignment, assignment, with_unit};
use super::chosen::component;
use super::cost::{above_zero, machine};
use super::document::Output;
use super::report_files::{require_writable, write_report};
use super::target::Target;
use super::{CommandError, effects_words, summary};
use crate::card::{duration, snake_case};
use crate::catalogue::Catalogue;
use crate::effects::measurement::{Measured, Order};
use crate::effects::picture::picture as drawn;
use crate::effects::result::{EffectsResult, percent};
use crate::effects::scene::{MOST_EFFECTS, Text};
use crate::effects::study::study;
use crate::forge::{Blueprint, Forge};
use crate::mismatch::{Mismatch, nearest, wrapped};
use crate::output::origin::Origin;
use crate::target_directory::target_directory;
use crate::text_file::{TextFile, is_file};

#[derive(Args)]
pub struct Arguments {
    /// Name of the mechanism, as `mbs list` prints it, or a file with its text: FILE, FILE:Name, FILE:Name:Scene
    pub name: String,
    /// Outputs that are compared [default: all]
    #[arg(long, value_name = "OUT", value_delimiter = ',', value_parser = component)]
    watch: Vec<String>,
    /// Largest change of a watched output, over its range in the motion: `1%` or `0.01`
    #[arg(long, value_name = "PART", default_value = "1%", value_parser = part, allow_negative_numbers = true)]
    within: f64,
    /// End of the motion (s) [default: that of `mbs run`]
    #[arg(long, value_name = "T", value_parser = above_zero, allow_negative_numbers = true)]
    until: Option<f64>,
    /// Compare these effects; all scenes have the others
    #[arg(long, value_name = "EFFECT", value_delimiter = ',')]
    only: Vec<String>,
    /// Set a parameter: a number in the unit that `mbs list` prints, or with a unit as `200mm`, `60rpm`, `4 [m^2]`
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = assignment)]
    parameters: Vec<Assignment>,
    /// Directory of page, picture and table [default: mbs/NAME/effects in cargo's target directory]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// A part of one, as `1%` or `0.01`.
fn part(text: &str) -> Result<f64, String> {
    let value = match text.strip_suffix('%') {
        Some(number) => above_zero(number.trim())? / 100.0,
        None => above_zero(text)?,
    };
    if value < 1.0 { Ok(value) } else { Err("less than 100 % is needed".to_string()) }
}

/// Instants of a motion behind the first.
const INSTANTS: u32 = 4000;

/// Longest time (s) of a run.
const LIMIT: f64 = 60.0;

/// Tolerance of motions: that of `mbs run`, for a small bound a hundred-thousandth of it.
fn tolerance(within: f64) -> f64 {
    (1e-5 * within).clamp(1e-12, 1e-9)
}

/// The text that the command is about.
struct StudiedText {
    name: String,
    file_name: String,
    title: String,
    mechanism: String,
    source: String,
    scene: Option<String>,
    /// Functions of its crate, which a copy of the text does not have.
    functions: Vec<String>,
    /// Parameters and inputs that differ from the defaults.
    values: Vec<(String, f64)>,
    until: f64,
}

impl StudiedText {
    fn find(catalogue: &Catalogue, arguments: &Arguments) -> Result<Self, CommandError> {
        let name = &arguments.name;
        if is_file(name) { Self::of_file(name, arguments) } else { Self::of_card(catalogue, arguments) }
    }

    fn of_card(catalogue: &Catalogue, arguments: &Arguments) -> Result<Self, CommandError> {
        let target = Target::find(catalogue, &arguments.name)?;
        let instance = target.instance(&target.runs()[0], &arguments.parameters)?;
        let equations = instance.equations();
        let value = |(index, entry): (usize, &mbs_runtime::Entry)| {
            Some((entry.name.to_string(), equations.get(index)?))
        };
        Ok(StudiedText {
            name: target.name().to_string(),
            file_name: target.file_name(),
            title: target.title().to_string(),
            mechanism: equations.type_name().to_string(),
            source: equations.source().to_string(),
            scene: Some(equations.scene().to_string()).filter(|scene| scene != WHOLE),
            functions: equations.functions().iter().map(|function| function.name.to_string()).collect(),
            values: equations.variables().iter().enumerate().filter_map(value).collect(),
            until: arguments.until.map_or_else(|| duration(target.span(), equations), Ok)?,
        })
    }

    fn of_file(name: &str, arguments: &Arguments) -> Result<Self, CommandError> {
        let text = TextFile::read(name)?;
        super::functions::require(&text)?;
        let unread = |faults| Mismatch::Text { name: name.to_string(), faults };
        let scene = text.scene.as_deref();
        let Picture { title, presets, span, .. } = picture(&text.source, scene).map_err(unread)?;
        let known = mbs_codegen::variables(&text.source, scene).map_err(CommandError::Failed)?;
        let mut values: Vec<(String, f64)> =
            presets.first().map(|preset| preset.set.clone()).unwrap_or_default();
        for given in &arguments.parameters {
            let Some(variable) = known.iter().find(|variable| variable.name == given.name) else {
                let names: Vec<&str> = known.iter().map(|variable| variable.name.as_str()).collect();
                return Err(unknown("parameter", &given.name, &names));
            };
            let value = given.in_unit(&variable.unit)?;
            let [low, high] = variable.range;
            if !(low..=high).contains(&value) {
                let [value, low, high] = [value, low, high].map(|end| with_unit(end, &variable.unit));
                return Err(CommandError::Usage(format!(
                    "`{}` is {value}: the text allows {low} to {high}",
                    variable.name
                )));
            }
            values.push((given.name.clone(), value));
        }
        let value = |name: &str| {
            let set = values.iter().rev().find(|(known, _)| known == name).map(|(_, value)| *value);
            set.or_else(|| {
                known.iter().find(|variable| variable.name == name).map(|variable| variable.default)
            })
        };
        let until = match (arguments.until, &span) {
            (Some(until), _) => until,
            (None, None) => 1.0,
            (None, Some(Span::Seconds(seconds))) => *seconds,
            (None, Some(Span::Turn { rate })) => {
                let turn = TAU / value(rate).unwrap_or(0.0).abs();
                if !turn.is_finite() {
                    return Err(Mismatch::NoTurn { rate: rate.clone(), value: 0.0 }.into());
                }
                turn
            }
        };
        // The last of several values of a name counts.
        values.reverse();
        Ok(StudiedText {
            name: name.to_string(),
            file_name: snake_case(&text.type_name()),
            title,
            mechanism: text.name.clone(),
            source: text.source,
            scene: text.scene,
            functions: Vec::new(),
            values,
            until,
        })
    }

    /// The text with the effects that are compared.
    fn text(&self, only: &[String]) -> Result<Text, CommandError> {
        let groups = mbs_codegen::effects(&self.source);
        let of_scene = groups.scenes.iter().find(|(name, _)| Some(name) == self.scene.as_ref());
        let all: Vec<String> = match of_scene {
            Some((_, effects)) => {
                groups.effects.iter().filter(|effect| effects.contains(effect)).cloned().collect()
            }
            None => groups.effects.clone(),
        };
        if all.is_empty() {
            return Err(CommandError::Usage(format!(
                "the text of `{}` has no effects; group statements that may be left out: `effect gravity {{ … }}`",
                self.name
            )));
        }
        for name in only {
            if !all.contains(name) {
                return Err(unknown("effect", name, &all.iter().map(String::as_str).collect::<Vec<_>>()));
            }
        }
        let is_compared = |name: &&String| only.is_empty() || only.contains(name);
        let effects: Vec<String> = all.iter().filter(is_compared).cloned().collect();
        if effects.len() > MOST_EFFECTS {
            let names: Vec<&str> = all.iter().map(String::as_str).collect();
            return Err(CommandError::Usage(format!(
                "`{}` has {} effects; a comparison takes at most {MOST_EFFECTS}: name some, all scenes then have the others: \
                 `--only {}`\nknown: {}",
                self.name,
                effects.len(),
                names[..3].join(","),
                wrapped(&names)
            )));
        }
        let kept = all.into_iter().filter(|name| !effects.contains(name)).collect();
        Ok(Text { source: self.source.clone(), groups, effects, kept })
    }

    /// Refuses outputs that the text does not have.
    fn require_outputs(&self, watched: &[String]) -> Result<(), CommandError> {
        let known =
            mbs_codegen::outputs(&self.source, self.scene.as_deref()).map_err(CommandError::Failed)?;
        let known: Vec<&str> = known.iter().map(|[name, _]| name.as_str()).collect();
        if known.is_empty() {
            return Err(CommandError::Usage(format!(
                "`{}` has no outputs to compare; declare one: `out side_load: N = lambda(liner);`",
                self.name
            )));
        }
        for name in watched {
            let is_meant = |known: &&str| {
                known == name || known.strip_prefix(name.as_str()).is_some_and(|rest| rest.starts_with('.'))
            };
            if !known.iter().any(is_meant) {
                return Err(unknown("output", name, &known));
            }
        }
        Ok(())
    }
}

fn unknown(kind: &str, name: &str, known: &[&str]) -> CommandError {
    let near = nearest(name, known.iter().copied());
    let near = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
    let list = if known.is_empty() { "none".to_string() } else { wrapped(known) };
    CommandError::Usage(format!("there is no {kind} `{name}`{near}\nknown: {list}"))
}

/// Compares scenes of a text, prints the table, writes page, picture and table.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    let subject = StudiedText::find(catalogue, arguments)?;
    if !subject.functions.is_empty() {
        return Err(CommandError::Usage(format!(
            "`{}` calls functions of its crate ({}), which scenes of a copy do not have; give the effect its law in the text",
            subject.name,
            subject.functions.join(", ")
        )));
    }
    let text = subject.text(&arguments.only)?;
    subject.require_outputs(&arguments.watch)?;
    let directory = arguments
        .out
        .clone()
        .unwrap_or_else(|| target_directory().join("mbs").join(&subject.file_name).join("effects"));
    require_writable(&directory)?;
    let order = Order {
        values: subject.values.clone(),
        until: subject.until,
        instants: INSTANTS,
        tolerance: tolerance(arguments.within),
        watched: arguments.watch.clone(),
        limit: LIMIT,
    };
    let caller = Forge::of_caller(catalogue.first().map(|card| card.manifest.as_ref()));
    // Times of a program that is not optimised say nothing.
    let forge = Forge { release: true, ..caller };
    let count = text.effects.len();
    let progress = Progress::new();
    let mut workshop = |round: usize, copy: &str, scenes: &[String]| {
        let head = format!("round {round} of at most {count}, {} scenes", scenes.len());
        let blueprint = Blueprint::of_scenes(&subject.mechanism, copy, scenes, round);
        let program = forge.program(&blueprint, &mut |step| progress.tell(&format!("{head}: {step}")));
        let program = program.map_err(|error| error.to_string())?;
        progress.tell(&format!("{head}: runs"));
        measured_by(&program, &order)
    };
    let found = study(text, &order, arguments.within, &mut workshop);
    progress.end();
    let found = found.map_err(|reason| CommandError::Failed(format!("{}: {reason}", subject.name)))?;
    let origin = Origin::of_text(&subject.name, &subject.source);
    out.put_text(&origin, &subject.title, subject.scene.as_deref());
    let forces = found.candidate(found.whole()).and_then(|whole| whole.measured.as_ref());
    let by_forces = forces.is_some_and(|measured| measured.is_moved_by_forces);
    let method = match by_forces {
        true => format!(
            "DormandPrince8 with Projection at tolerance {:.0e}; errors from runs of ten times that",
            order.tolerance
        ),
        false => format!("{INSTANTS} steps of the stepper, each closed"),
    };
    let facts = [
        (
            "motion",
            format!(
                "to t = {} s by {}",
                summary::short(order.until),
                if by_forces { "forces" } else { "drives" }
            ),
        ),
        ("method", method),
        ("change", format!("at {} instants, over the range of the output in the whole", INSTANTS + 1)),
        ("times", "the shortest of up to 25 runs, scenes in turns".to_string()),
        ("elimination", format!("{} scenes, rounds of programs: {}", found.candidates.len(), found.rounds)),
        ("machine", machine()),
        ("text", origin.hash.clone()),
    ];
    let result = EffectsResult {
        study: found,
        within: arguments.within,
        title: subject.title.clone(),
        origin: origin.line(),
        command: command(arguments),
        facts: facts
            .map(|(name, value)| [name.to_string(), value])
            .into_iter()
            .chain(super::functions::facts())
            .collect(),
    };
    out.put("result", result.document());
    effects_words::print(&result, out)?;
    let files = [
        ("effects.html", result.page()),
        ("effects.svg", origin.svg(&drawn(&result))),
        ("effects.csv", origin.csv(&result.csv())),
    ];
    for (kind, path) in ["page", "picture", "table"].iter().zip(write_report(&directory, &files)?) {
        out.put_file(kind, &path);
        writeln!(out, "{kind:<8} {}", path.display())?;
    }
    writeln!(out, "\n{}\n{}", result.sentence(), result.to_paste())?;
    Ok(())
}

/// The command line that makes the same comparison.
fn command(arguments: &Arguments) -> String {
    let mut words = vec!["mbs".to_string(), "effects".to_string(), arguments.name.clone()];
    for (name, values) in [("--watch", &arguments.watch), ("--only", &arguments.only)] {
        if !values.is_empty() {
            words.extend([name.to_string(), values.join(",")]);
        }
    }
    words.extend(["--within".to_string(), percent(arguments.within).replace(' ', "")]);
    if let Some(until) = arguments.until {
        words.extend(["--until".to_string(), summary::short(until)]);
    }
    words.extend(arguments.parameters.iter().flat_map(|given| ["--param".to_string(), given.written()]));
    words.join(" ")
}

/// Scenes as the program that has them measured them.
fn measured_by(program: &Path, order: &Order) -> Result<Vec<Measured>, String> {
    let functions =
        super::functions::options().into_iter().flat_map(|given| ["--function".to_string(), given]);
    let mut child = Command::new(program)
        .args(functions)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| format!("{} does not start: {error}", program.display()))?;
    let text = serde_json::to_vec(order).map_err(|error| error.to_string())?;
    // A program that ends before it has read tells why.
    let written = child.stdin.take().map(|mut stdin| stdin.write_all(&text));
    drop(written);
    let output = child.wait_with_output().map_err(|error| error.to_string())?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(format!("the program of the scenes failed: {}", said.trim()));
    }
    serde_json::from_slice(&output.stdout)
        .map_err(|error| format!("the program of the scenes printed no result: {error}"))
}

/// The spinner turns while other processes work.
const TICK: Duration = Duration::from_millis(100);

/// Progress with its time; without a terminal one line an action that takes long.
struct Progress {
    bar: ProgressBar,
    last: RefCell<String>,
}

impl Progress {
    fn new() -> Self {
        let style = ProgressStyle::with_template("{spinner} {elapsed} {msg}").expect("a valid template");
        let bar = ProgressBar::new_spinner().with_style(style);
        bar.enable_steady_tick(TICK);
        Progress { bar, last: RefCell::default() }
    }

    fn tell(&self, words: &str) {
        self.bar.set_message(words.to_string());
        // Each round says once why nothing happens yet.
        let round = words.split(':').next().unwrap_or_default().to_string();
        if self.bar.is_hidden() && self.last.replace(round.clone()) != round {
            eprintln!("{words}");
        }
    }

    fn end(&self) {
        self.bar.finish_and_clear();
    }
}
