//! `mbs run`.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use mechanisms::csv;
use mechanisms::facade::{AnyMechanism, Motion, MotionStop};
use mechanisms::registry::{self, Card, Preset, instants};
use mechanisms::report::{Report, Run, html};
use mechanisms::target_directory::target_directory;

use super::chosen::assignment;
use super::{CommandError, positive, table};

/// Half a degree a step: smooth to look at, small enough for a page.
const STEPS: usize = 720;

/// Instants of a run on the page, at most; beyond them a browser slows down and an eye sees no more.
const SHOWN: usize = 2000;

#[derive(Args)]
pub struct Arguments {
    /// Name of the mechanism, as `mbs list` prints it
    name: String,
    /// Set a parameter, in the unit that `mbs list` prints
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = assignment)]
    parameters: Vec<(String, f64)>,
    /// Equal steps that the motion is divided into
    #[arg(long, default_value_t = STEPS, value_parser = steps)]
    steps: usize,
    /// Directory for the report [default: mbs/NAME in cargo's target directory]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// A preset with the motion found.
struct Done {
    label: &'static str,
    description: &'static str,
    motion: Motion,
    step_time: Duration,
}

impl Arguments {
    /// What runs where the command line says nothing.
    pub fn defaults(name: &str) -> Self {
        Arguments { name: name.to_string(), parameters: Vec::new(), steps: STEPS, out: None }
    }

    /// The command line again.
    fn command(&self) -> String {
        let mut command = format!("mbs run {} --steps {}", self.name, self.steps);
        for (name, value) in &self.parameters {
            command.push_str(&format!(" --param {name}={value}"));
        }
        command
    }
}

/// Runs the presets, prints a table and writes the report. Nothing is written where a run fails.
pub fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<(), CommandError> {
    let card = registry::find(&arguments.name)?;
    let mechanisms = instances(card, &arguments.parameters)?;
    let mut done = Vec::new();
    for (preset, mechanism) in &mechanisms {
        done.push(follow(card, preset, mechanism.as_ref(), arguments.steps)?);
    }
    let directory =
        arguments.out.clone().unwrap_or_else(|| target_directory().join("mbs").join(card.file_name()));
    let facts = facts(&mechanisms, &done);
    // Before the table, which may meet a reader that has left.
    let written = write_report(&directory, &page(arguments, card, &done, &facts), &values(&done));
    writeln!(out, "{}", card.title)?;
    for done in &done {
        table::write(out, card, done.label, &done.motion, done.step_time)?;
    }
    let (page, values) = written?;
    writeln!(out, "\nreport  {}\nvalues  {}", page.display(), values.display())?;
    Ok(())
}

type Instances = Vec<(Preset, Box<dyn AnyMechanism>)>;

/// One instance a preset; where the command line sets what presets differ in, one as it says.
fn instances(card: &Card, parameters: &[(String, f64)]) -> Result<Instances, CommandError> {
    const AS_GIVEN: Preset =
        Preset { label: "as given", description: "parameters of the command line", set: &[] };
    let given = |name: &str| parameters.iter().any(|(given, _)| given == name);
    let own = [AS_GIVEN];
    let overridden = card.runs.iter().flat_map(|run| run.set).any(|(name, _)| given(name));
    let presets = if overridden { &own[..] } else { card.runs };
    let mut instances = Vec::new();
    for preset in presets {
        let mut mechanism = card.instance(preset)?;
        for (name, value) in parameters {
            registry::set(mechanism.as_mut(), name, *value)?;
        }
        instances.push((*preset, mechanism));
    }
    Ok(instances)
}

fn follow(
    card: &Card,
    preset: &Preset,
    mechanism: &dyn AnyMechanism,
    steps: usize,
) -> Result<Done, CommandError> {
    /// Instants timed: enough for a mean, short for any number of steps.
    const TIMED: usize = 10_000;
    let times = instants(card.duration(mechanism)?, steps);
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} steps, {msg}").expect("a valid template");
    let bar = ProgressBar::new(times.len() as u64).with_style(style).with_message(preset.label);
    let motion = mechanism.follow(&times, &mut |count| bar.set_position(count as u64));
    bar.finish_and_clear();
    let timed = &times[..times.len().min(TIMED)];
    motion
        .and_then(|motion| Ok((motion, mechanism.time_a_step(timed)?)))
        .map(|(motion, step_time)| Done {
            label: preset.label,
            description: preset.description,
            motion,
            step_time,
        })
        .map_err(|failure| {
            let stop = mechanism.stop(&times).map_or_else(String::new, |stop| described(&stop));
            CommandError::Failed(format!("{}, {}: {failure}{stop}", card.name, preset.label))
        })
}

/// Where the motion ends, as lines below the failure.
fn described(stop: &MotionStop) -> String {
    let MotionStop { reachable, refused, failure } = stop;
    format!(
        "\nthe motion ends between t = {reachable} s and t = {refused} s; at the end of that step\n{failure}"
    )
}

fn facts(mechanisms: &Instances, done: &[Done]) -> Vec<[String; 2]> {
    let first = mechanisms[0].1.as_ref();
    let mut facts = vec![["coordinates".to_string(), first.coordinates().len().to_string()]];
    for (index, entry) in first.variables().iter().enumerate() {
        let written = |mechanism: &dyn AnyMechanism| {
            let value = mechanism.get(index).unwrap_or(f64::NAN);
            format!("{}{}", table::short(value), table::unit(entry.unit))
        };
        if mechanisms.iter().all(|(_, other)| other.get(index) == first.get(index)) {
            facts.push([entry.name.to_string(), written(first)]);
            continue;
        }
        for (preset, mechanism) in mechanisms {
            facts.push([format!("{}, {}", entry.name, preset.label), written(mechanism.as_ref())]);
        }
    }
    for done in done {
        facts.push([format!("steps, {}", done.label), (done.motion.time.len() - 1).to_string()]);
        for [name, value] in table::figures(&done.motion, done.step_time) {
            facts.push([format!("{name}, {}", done.label), value]);
        }
    }
    facts
}

fn page(arguments: &Arguments, card: &Card, done: &[Done], facts: &[[String; 2]]) -> String {
    let shown: Vec<Motion> = done.iter().map(|done| done.motion.thinned(SHOWN)).collect();
    let mut runs = Vec::new();
    for (done, motion) in done.iter().zip(&shown) {
        runs.push(Run { label: done.label, description: done.description, motion });
    }
    html(&Report {
        name: card.name,
        title: card.title,
        description: card.description,
        source: (card.make)().source(),
        command: &arguments.command(),
        facts,
        runs: &runs,
        drawing: card.drawing,
    })
}

fn values(done: &[Done]) -> String {
    csv::write(&done.iter().map(|done| (done.label, &done.motion)).collect::<Vec<_>>())
}

/// Writes both files beside their places first, so that a full disk leaves no half of them.
fn write_report(directory: &Path, page: &str, values: &str) -> Result<(PathBuf, PathBuf), CommandError> {
    let fail = |path: &Path, error: std::io::Error| {
        CommandError::Failed(format!("cannot write {}: {error}", path.display()))
    };
    fs::create_dir_all(directory).map_err(|error| fail(directory, error))?;
    let files = [("report.html", page), ("motion.csv", values)];
    let draft = |name: &str| directory.join(format!(".{name}.{}.draft", std::process::id()));
    let written = files
        .iter()
        .try_for_each(|(name, text)| fs::write(draft(name), text).map_err(|error| fail(&draft(name), error)));
    let placed = written.and_then(|()| {
        files.iter().try_for_each(|(name, _)| {
            let place = directory.join(name);
            fs::rename(draft(name), &place).map_err(|error| fail(&place, error))
        })
    });
    if placed.is_err() {
        // What is left of them; those already in place are whole.
        files.iter().for_each(|(name, _)| drop(fs::remove_file(draft(name))));
    }
    placed.map(|()| (directory.join(files[0].0), directory.join(files[1].0)))
}

/// Most steps of a run: its motion is held in memory and written as text.
const MOST_STEPS: usize = 1_000_000;

/// A number of steps that memory and disk can take.
fn steps(text: &str) -> Result<usize, String> {
    match positive(text)? {
        steps if steps <= MOST_STEPS => Ok(steps),
        _ => Err(format!("at most {MOST_STEPS} are possible")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_bounded() {
        assert_eq!(steps("720"), Ok(720));
        for bad in ["0", "-1", "1.5", "1000001", "99999999999", "two"] {
            assert!(steps(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn what_the_command_line_sets_overrules_the_presets() {
        let card = registry::ALL[0];
        let labels = |parameters: &[(String, f64)]| -> Vec<&str> {
            instances(card, parameters).expect("parameters").iter().map(|(preset, _)| preset.label).collect()
        };
        assert_eq!(labels(&[("omega".to_string(), 1.0)]).len(), card.runs.len());
        assert_eq!(labels(&[("side".to_string(), -1.0)]), ["as given"]);
    }

    #[test]
    fn a_report_that_cannot_be_written_leaves_nothing() {
        let directory = target_directory().join("tmp").join(format!("report-{}", std::process::id()));
        fs::create_dir_all(directory.join("motion.csv")).expect("a directory in the way");
        assert!(write_report(&directory, "page", "values").is_err());
        let left = fs::read_dir(&directory).expect("the directory").flatten();
        assert!(left.into_iter().all(|file| !file.file_name().to_string_lossy().ends_with("draft")));
        fs::remove_dir_all(directory).expect("scratch");
    }
}
