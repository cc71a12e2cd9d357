//! `mbs run`.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use mechanisms::analyses::linear::SmallMotions;
use mechanisms::csv;
use mechanisms::facade::{AnyEquations, Motion};
use mechanisms::motion::drop_idle;
use mechanisms::registry::{Preset, Usual, file_name};
use mechanisms::report::{Report, Run, html};
use mechanisms::target_directory::target_directory;

use super::analysis::{
    Analysis, Damping, Done, Given, IntegratorName, MethodName, Wish, above_zero, at_least_zero, tolerance,
};
use super::chosen::assignment;
use super::subject::{Instance, Subject};
use super::{CommandError, positive, table};

/// Half a degree a step: smooth to look at, small enough for a page.
const STEPS: usize = 720;

/// Two digits more than a picture or a comparison needs; the integrator of order 8 hardly notices.
const TOLERANCE: f64 = 1e-10;

/// A step that the stiff mechanisms of the list are right to four digits with (s).
const STEP: f64 = 1e-3;

/// A step of RK4 that a swing of a second is right to six digits with (s).
const EQUAL_STEP: f64 = 2.5e-3;

/// Instants of a run on the page, at most; beyond them a browser slows down and an eye sees no more.
const SHOWN: usize = 2000;

/// Numbers of all runs on the page, at most: two megabytes of text, which a page opens with at once.
const NUMBERS: usize = 170_000;

/// Instants of a run on the page, however many columns it has: twenty-four a second of a motion of ten.
const LEAST_SHOWN: usize = 240;

#[derive(Args)]
pub struct Arguments {
    /// Name of the mechanism, as `mbs list` prints it
    name: String,
    /// Set a parameter, in the unit that `mbs list` prints
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = assignment)]
    parameters: Vec<(String, f64)>,
    /// What is computed [default: kinematic, of a mechanism that is free to move dynamic]
    #[arg(long, value_enum)]
    analysis: Option<Analysis>,
    /// Start the search for the position of rest from another value of a coordinate, in the unit of the text
    #[arg(long = "guess", value_name = "NAME=VALUE", value_parser = assignment)]
    guesses: Vec<(String, f64)>,
    /// Time (s) of the state that small motions are about, followed there from the start [default: the position of rest]
    #[arg(long, value_name = "T", value_parser = at_least_zero, allow_negative_numbers = true)]
    at: Option<f64>,
    /// End of the motion (s) [default: one turn, or as long as is worth seeing]
    #[arg(long, value_name = "T", value_parser = above_zero, allow_negative_numbers = true)]
    until: Option<f64>,
    /// Equal steps that the motion is divided into; equal ones of the integrator end there too, adaptive ones are interpolated [default: 720]
    #[arg(long, value_parser = steps, allow_negative_numbers = true)]
    steps: Option<usize>,
    /// How a motion from forces stays on its constraints [default: projection, of many rows velocity, of stiff mechanisms extrapolated]
    #[arg(long, value_enum)]
    method: Option<MethodName>,
    /// What integrates it, where the method has no steps of its own [default: order8, of forty four-bars rk4]
    #[arg(long, value_enum)]
    integrator: Option<IntegratorName>,
    /// Longest of equal steps (s), which end at instants: without `--steps` these are so few that it is reached [default: 1e-3 of an implicit method, 2.5e-3 of another]
    #[arg(long, value_name = "H", value_parser = above_zero, allow_negative_numbers = true)]
    step: Option<f64>,
    /// Tolerance of adaptive steps [default: 1e-10]
    #[arg(long, value_parser = tolerance, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    #[command(flatten)]
    damping: Damping,
    /// Directory for the report [default: mbs/NAME in cargo's target directory]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Arguments {
    /// What runs where the command line says nothing.
    pub fn defaults(name: &str) -> Self {
        Arguments {
            name: name.to_string(),
            parameters: Vec::new(),
            analysis: None,
            guesses: Vec::new(),
            at: None,
            until: None,
            steps: None,
            method: None,
            integrator: None,
            step: None,
            tolerance: None,
            damping: Damping::default(),
            out: None,
        }
    }

    fn wish(&self, subject: Subject) -> Wish {
        let method = self.method.unwrap_or(match subject.usual() {
            Usual::Projection => MethodName::Projection,
            Usual::Velocity | Usual::VelocityInEqualSteps => MethodName::Velocity,
            Usual::Extrapolated => MethodName::Extrapolated,
        });
        let usual = match subject.usual() {
            Usual::VelocityInEqualSteps if self.method.is_none() && self.tolerance.is_none() => {
                IntegratorName::Rk4
            }
            _ => IntegratorName::Order8,
        };
        let integrator = self.integrator.unwrap_or(usual);
        let tolerance = self.tolerance.unwrap_or(TOLERANCE);
        Wish {
            analysis: self.analysis,
            stabilization: self.damping.stabilization(method, self.step.unwrap_or(STEP)),
            steps_of_method: integrator.steps(tolerance, self.step.unwrap_or(EQUAL_STEP)),
            guesses: self.guesses.clone(),
            at: self.at,
            until: self.until,
            steps: self.steps.unwrap_or(STEPS),
            given: Given {
                steps: self.steps.is_some(),
                method: self.method.is_some(),
                integrator: self.integrator.is_some(),
                step: self.step.is_some(),
                tolerance: self.tolerance.is_some(),
                damping: self.damping.is_given(),
                alpha: self.damping.is_penalty_given(),
                penalty: method == MethodName::Penalty,
                implicit: method.is_implicit(),
                radau: method == MethodName::Radau,
                damped: method.is_damped(),
                adaptive: integrator.rule().is_none(),
            },
        }
    }

    /// The command line again.
    fn command(&self) -> String {
        let mut command = format!("mbs run {}", self.name);
        if let Some(steps) = self.steps {
            command.push_str(&format!(" --steps {steps}"));
        }
        let named = |value: &dyn Fn() -> Option<clap::builder::PossibleValue>| {
            value().map_or_else(String::new, |value| value.get_name().to_string())
        };
        if let Some(analysis) = self.analysis {
            command.push_str(&format!(" --analysis {}", named(&|| analysis.to_possible_value())));
        }
        if let Some(until) = self.until {
            command.push_str(&format!(" --until {until}"));
        }
        if let Some(method) = self.method {
            command.push_str(&format!(" --method {}", named(&|| method.to_possible_value())));
        }
        if let Some(integrator) = self.integrator {
            command.push_str(&format!(" --integrator {}", named(&|| integrator.to_possible_value())));
        }
        command.push_str(&self.damping.command());
        if let Some(step) = self.step {
            command.push_str(&format!(" --step {step:e}"));
        }
        if let Some(tolerance) = self.tolerance {
            command.push_str(&format!(" --tolerance {tolerance:e}"));
        }
        if let Some(at) = self.at {
            command.push_str(&format!(" --at {at}"));
        }
        for (name, value) in &self.guesses {
            command.push_str(&format!(" --guess {name}={value}"));
        }
        for (name, value) in &self.parameters {
            command.push_str(&format!(" --param {name}={value}"));
        }
        command
    }
}

/// Runs the presets, prints a table and writes the report. Nothing is written where a run fails.
pub fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<(), CommandError> {
    let subject = Subject::find(&arguments.name)?;
    let instances = subject.instances(&arguments.parameters)?;
    let wish = arguments.wish(subject);
    let (mut done, mut left_out) = (Vec::new(), Vec::new());
    for instance in &instances {
        match wish.done(subject, instance) {
            Ok(found) => done.extend(found),
            // Of several loads some may have no position of rest.
            Err(CommandError::Failed(reason)) if wish.is_of_rest(subject) => left_out.push(reason),
            Err(error) => return Err(error),
        }
    }
    if done.is_empty() {
        return Err(CommandError::Failed(left_out.join("\n")));
    }
    drop_idle(&mut done.iter_mut().map(|done| &mut done.motion).collect::<Vec<_>>());
    let standard = || target_directory().join("mbs").join(file_name(subject.name()));
    let directory = arguments.out.clone().unwrap_or_else(standard);
    let mut facts = facts(&instances, &done);
    facts.extend(left_out.iter().map(|reason| ["left out".to_string(), reason.clone()]));
    // Before the table, which may meet a reader that has left.
    let mut files = vec![
        ("report.html", page(arguments, subject, &instances, &done, &facts)),
        ("motion.csv", values(&done)),
    ];
    files.extend(modes(&done).map(|modes| ("modes.csv", modes)));
    let written = write_report(&directory, &files);
    writeln!(out, "{}", subject.title())?;
    for done in &done {
        table::write(out, subject.drawing(), &done.label, &done.motion, &done.figures)?;
    }
    for reason in &left_out {
        writeln!(out, "\nleft out: {reason}")?;
    }
    writeln!(out)?;
    for (name, path) in ["report", "values", "modes "].iter().zip(written?) {
        writeln!(out, "{name}  {}", path.display())?;
    }
    Ok(())
}

fn facts(instances: &[(Preset, Instance)], done: &[Done]) -> Vec<[String; 2]> {
    let first = instances[0].1.equations();
    let mut facts = vec![["coordinates".to_string(), first.coordinates().len().to_string()]];
    for (index, entry) in first.variables().iter().enumerate() {
        let written = |mechanism: &dyn AnyEquations| {
            let value = mechanism.get(index).unwrap_or(f64::NAN);
            format!("{}{}", table::short(value), table::unit(entry.unit))
        };
        if instances.iter().all(|(_, other)| other.equations().get(index) == first.get(index)) {
            facts.push([entry.name.to_string(), written(first)]);
            continue;
        }
        for (preset, instance) in instances {
            facts.push([format!("{}, {}", entry.name, preset.label), written(instance.equations())]);
        }
    }
    for done in done {
        facts.push([format!("instants, {}", done.label), done.motion.time.len().to_string()]);
        for [name, value] in &done.figures {
            facts.push([format!("{name}, {}", done.label), value.clone()]);
        }
    }
    facts
}

fn page(
    arguments: &Arguments,
    subject: Subject,
    instances: &[(Preset, Instance)],
    done: &[Done],
    facts: &[[String; 2]],
) -> String {
    let columns: usize = done.iter().map(|done| done.motion.columns()).sum();
    let shown = (NUMBERS / columns.max(1)).clamp(LEAST_SHOWN, SHOWN);
    let shown: Vec<Motion> = done.iter().map(|done| done.motion.thinned(shown)).collect();
    let mut runs = Vec::new();
    for (done, motion) in done.iter().zip(&shown) {
        runs.push(Run {
            label: &done.label,
            description: done.description,
            motion,
            small: done.small.as_ref(),
        });
    }
    html(&Report {
        name: subject.name(),
        title: subject.title(),
        description: subject.description(),
        source: instances[0].1.equations().source(),
        command: &arguments.command(),
        facts,
        runs: &runs,
        drawing: subject.drawing(),
    })
}

fn values(done: &[Done]) -> String {
    csv::write(&done.iter().map(|done| (done.label.as_str(), &done.motion)).collect::<Vec<_>>())
}

/// Small motions as values, where they were asked for.
fn modes(done: &[Done]) -> Option<String> {
    let small: Vec<(&str, &Motion, &SmallMotions)> = done
        .iter()
        .filter_map(|done| Some((done.label.as_str(), &done.motion, done.small.as_ref()?)))
        .collect();
    (!small.is_empty()).then(|| csv::write_modes(&small))
}

/// Writes the files, names and texts, beside their places first, so that a full disk leaves no part of them.
fn write_report(directory: &Path, files: &[(&str, String)]) -> Result<Vec<PathBuf>, CommandError> {
    let fail = |path: &Path, error: std::io::Error| {
        CommandError::Failed(format!("cannot write {}: {error}", path.display()))
    };
    fs::create_dir_all(directory).map_err(|error| fail(directory, error))?;
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
    placed.map(|()| files.iter().map(|(name, _)| directory.join(name)).collect())
}

/// Most steps of a run: its motion is held in memory and written as text.
const MOST_STEPS: usize = 1_000_000;

/// A number of steps that memory and disk can take.
pub fn steps(text: &str) -> Result<usize, String> {
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
    fn a_report_that_cannot_be_written_leaves_nothing() {
        let directory = target_directory().join("tmp").join(format!("report-{}", std::process::id()));
        fs::create_dir_all(directory.join("motion.csv")).expect("a directory in the way");
        let files = [("report.html", "page".to_string()), ("motion.csv", "values".to_string())];
        assert!(write_report(&directory, &files).is_err());
        let left = fs::read_dir(&directory).expect("the directory").flatten();
        assert!(left.into_iter().all(|file| !file.file_name().to_string_lossy().ends_with("draft")));
        fs::remove_dir_all(directory).expect("scratch");
    }
}
