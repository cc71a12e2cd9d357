//! The analyses of the command line: `mbs run`, `kinematics`, `simulate`, `inverse`, `equilibrium`, `modes`.

use crate::catalogue::Catalogue;
use std::io::Write;
use std::path::PathBuf;

use crate::card::DefaultMethod;
use crate::motion::drop_idle;
use crate::output::reload::{VERSION, reloading};
use crate::target_directory::target_directory;
use clap::{Args, ValueEnum};

use super::analysis::{
    Analysis, Damping, IntegratorName, MethodName, Request, RunResult, UsedOptions, above_zero,
    at_least_zero, tolerance,
};
use super::assignment::{Assignment, assignment};
use super::chosen::{require_named, svg_file, write_file};
use super::document::Output;
use super::measured::{Tables, compared, decimate};
use super::report_files::{announce_size, require_writable, write_report};
use super::run_files::{PageContent, animated, described, facts, modes, page, values};
use super::slide::{Slide, Slider, slide};
use super::target::Target;
use super::{CommandError, positive, summary};

/// Default number of steps: half a degree each, smooth in a picture and few enough for a page.
const STEPS: usize = 720;

/// Default tolerance: two digits more than a picture or a comparison needs, at little cost for the integrator of order 8.
const TOLERANCE: f64 = 1e-10;

/// Step (s) of implicit methods with which the stiff mechanisms of the list are correct to four digits.
const STEP: f64 = 1e-3;

/// Step (s) of RK4 with which a swing of one second is correct to six digits.
const EQUAL_STEP: f64 = 2.5e-3;

/// Mechanism, its parameters and the files to write: options of every analysis.
#[derive(Args, Clone, Default)]
pub struct Selection {
    /// Name of the mechanism, as `mbs list` prints it, or a file with its text: FILE, FILE:Name, FILE:Name:Scene
    name: String,
    /// Set a parameter: a number in the unit that `mbs list` prints, or with a unit as `200mm`, `60rpm`, `4 [m^2]`
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = assignment)]
    parameters: Vec<Assignment>,
    /// Directory for the report [default: mbs/NAME in cargo's target directory]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Give the page a slider for a parameter with a range in the text, with runs at N values from end to end [default: 11]
    #[arg(long, value_name = "NAME[=N]", value_parser = slide)]
    slide: Option<Slide>,
    /// Let the page load itself anew when it is written again
    #[arg(long)]
    reload: bool,
    /// Also write the first motion as an SVG file that moves by itself
    #[arg(long, value_name = "FILE.svg", value_parser = svg_file)]
    svg: Option<PathBuf>,
}

/// End and instants of a motion.
#[derive(Args, Clone, Default)]
pub struct Span {
    /// End of the motion (s) [default: one turn, or as long as is worth seeing]
    #[arg(long, value_name = "T", value_parser = above_zero, allow_negative_numbers = true)]
    until: Option<f64>,
    /// Equal steps that the motion is divided into; equal ones of the integrator end there too, adaptive ones are interpolated [default: 720]
    #[arg(long, value_parser = steps, allow_negative_numbers = true)]
    steps: Option<usize>,
}

/// Integration of a motion from forces.
#[derive(Args, Clone, Default)]
pub struct Integration {
    /// Method that keeps a motion from forces on its constraints [default: projection, of many rows velocity, of stiff mechanisms extrapolated]
    #[arg(long, value_enum)]
    method: Option<MethodName>,
    /// Integrator, where the method has no steps of its own [default: order8, of forty four-bars rk4]
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
}

/// Options of `mbs run` and `mbs simulate`.
#[derive(Args)]
pub struct MotionArguments {
    #[command(flatten)]
    pub selection: Selection,
    #[command(flatten)]
    span: Span,
    #[command(flatten)]
    tables: Tables,
    #[command(flatten)]
    integration: Integration,
}

/// Options of `mbs kinematics` and `mbs inverse`.
#[derive(Args)]
pub struct DrivenArguments {
    #[command(flatten)]
    pub selection: Selection,
    #[command(flatten)]
    span: Span,
    #[command(flatten)]
    tables: Tables,
}

/// Options of `mbs equilibrium`.
#[derive(Args)]
pub struct EquilibriumArguments {
    #[command(flatten)]
    pub selection: Selection,
    /// Start the search for the equilibrium from another value of a coordinate, in the unit of the text
    #[arg(long = "guess", value_name = "NAME=VALUE", value_parser = assignment)]
    guesses: Vec<Assignment>,
}

/// Options of `mbs modes`.
#[derive(Args)]
pub struct ModesArguments {
    #[command(flatten)]
    pub selection: Selection,
    /// Start the search for the equilibrium from another value of a coordinate, in the unit of the text
    #[arg(long = "guess", value_name = "NAME=VALUE", value_parser = assignment)]
    guesses: Vec<Assignment>,
    /// Time (s) of the state that small motions are about, followed there from the start [default: the equilibrium]
    #[arg(long, value_name = "T", value_parser = at_least_zero, allow_negative_numbers = true, conflicts_with = "guesses")]
    at: Option<f64>,
    /// Equal steps that the motion up to `--at` is divided into [default: 720]
    #[arg(long, value_parser = steps, allow_negative_numbers = true, requires = "at")]
    steps: Option<usize>,
    #[command(flatten)]
    integration: Integration,
}

/// An analysis with its options, whichever command they come from.
#[derive(Default)]
pub struct Arguments {
    /// Command of the program.
    command: &'static str,
    selection: Selection,
    analysis: Option<Analysis>,
    guesses: Vec<Assignment>,
    at: Option<f64>,
    span: Span,
    tables: Tables,
    integration: Integration,
}

impl Selection {
    /// Name or file as it is written.
    pub fn name(&self) -> &str {
        &self.name
    }
}

impl Arguments {
    /// `mbs run` with default options for the mechanism called `name`.
    pub fn defaults(name: &str) -> Self {
        let selection = Selection { name: name.to_string(), ..Selection::default() };
        Arguments { command: "run", selection, ..Arguments::default() }
    }

    /// `mbs run`: the analysis that suits the mechanism.
    pub fn run(arguments: MotionArguments) -> Self {
        let MotionArguments { selection, span, tables, integration } = arguments;
        Arguments { command: "run", selection, span, tables, integration, ..Arguments::default() }
    }

    /// `mbs simulate`.
    pub fn simulate(arguments: MotionArguments) -> Self {
        Arguments { command: "simulate", analysis: Some(Analysis::Simulation), ..Arguments::run(arguments) }
    }

    /// `mbs kinematics`.
    pub fn kinematics(DrivenArguments { selection, span, tables }: DrivenArguments) -> Self {
        let analysis = Some(Analysis::Kinematics);
        Arguments { command: "kinematics", analysis, selection, span, tables, ..Arguments::default() }
    }

    /// `mbs inverse`.
    pub fn inverse(arguments: DrivenArguments) -> Self {
        Arguments {
            command: "inverse",
            analysis: Some(Analysis::Inverse),
            ..Arguments::kinematics(arguments)
        }
    }

    /// `mbs equilibrium`.
    pub fn equilibrium(EquilibriumArguments { selection, guesses }: EquilibriumArguments) -> Self {
        let analysis = Some(Analysis::Equilibrium);
        Arguments { command: "equilibrium", analysis, selection, guesses, ..Arguments::default() }
    }

    /// `mbs modes`.
    pub fn modes(arguments: ModesArguments) -> Self {
        let ModesArguments { selection, guesses, at, steps, integration } = arguments;
        let (analysis, span) = (Some(Analysis::Modes), Span { until: None, steps });
        let tables = Tables::default();
        Arguments { command: "modes", selection, analysis, guesses, at, span, tables, integration }
    }

    fn request(&self, target: &Target) -> Request {
        let method = self.integration.method.unwrap_or(match target.default_method() {
            DefaultMethod::Projection => MethodName::Projection,
            DefaultMethod::Velocity | DefaultMethod::VelocityInEqualSteps => MethodName::Velocity,
            DefaultMethod::Extrapolated => MethodName::Extrapolated,
        });
        let default_method = match target.default_method() {
            DefaultMethod::VelocityInEqualSteps
                if self.integration.method.is_none() && self.integration.tolerance.is_none() =>
            {
                IntegratorName::Rk4
            }
            _ => IntegratorName::Order8,
        };
        let integrator = self.integration.integrator.unwrap_or(default_method);
        let tolerance = self.integration.tolerance.unwrap_or(TOLERANCE);
        Request {
            analysis: self.analysis,
            stabilization: self
                .integration
                .damping
                .stabilization(method, self.integration.step.unwrap_or(STEP)),
            steps_of_method: integrator.steps(tolerance, self.integration.step.unwrap_or(EQUAL_STEP)),
            guesses: self.guesses.clone(),
            at: self.at,
            until: self.span.until,
            steps: self.span.steps.unwrap_or(STEPS),
            used_options: UsedOptions {
                steps: self.span.steps.is_some(),
                method: self.integration.method.is_some(),
                integrator: self.integration.integrator.is_some(),
                step: self.integration.step.is_some(),
                tolerance: self.integration.tolerance.is_some(),
                damping: self.integration.damping.is_given(),
                alpha: self.integration.damping.is_penalty_given(),
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
        let mut command = format!("mbs {} {}", self.command, self.selection.name);
        if let Some(steps) = self.span.steps {
            command.push_str(&format!(" --steps {steps}"));
        }
        let named = |value: &dyn Fn() -> Option<clap::builder::PossibleValue>| {
            value().map_or_else(String::new, |value| value.get_name().to_string())
        };
        if let Some(until) = self.span.until {
            command.push_str(&format!(" --until {until}"));
        }
        if let Some(method) = self.integration.method {
            command.push_str(&format!(" --method {}", named(&|| method.to_possible_value())));
        }
        if let Some(integrator) = self.integration.integrator {
            command.push_str(&format!(" --integrator {}", named(&|| integrator.to_possible_value())));
        }
        command.push_str(&self.tables.command());
        command.push_str(&self.integration.damping.command());
        if let Some(step) = self.integration.step {
            command.push_str(&format!(" --step {step:e}"));
        }
        if let Some(tolerance) = self.integration.tolerance {
            command.push_str(&format!(" --tolerance {tolerance:e}"));
        }
        if let Some(at) = self.at {
            command.push_str(&format!(" --at {at}"));
        }
        if let Some(slide) = &self.selection.slide {
            command.push_str(&slide.command());
        }
        for guess in &self.guesses {
            command.push_str(&format!(" --guess {}", guess.written()));
        }
        for parameter in &self.selection.parameters {
            command.push_str(&format!(" --param {}", parameter.written()));
        }
        command
    }
}

/// Runs the presets, prints a table and writes the report. Nothing is written if a run fails at its start; one that ends before its time
/// has its page up to there, and the command fails.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    let target = Target::find(catalogue, &arguments.selection.name)?;
    let mut instances = target.instances(&arguments.selection.parameters)?;
    let mut request = arguments.request(&target);
    if let Some(range) = arguments.tables.feed(&target, &mut instances)? {
        let until = *request.until.get_or_insert(range[1]);
        arguments.tables.require_data(range, until)?;
    }
    let overlays = arguments.tables.overlays(instances[0].1.equations(), &target)?;
    let standard = || target_directory().join("mbs").join(target.file_name());
    let directory = arguments.selection.out.clone().unwrap_or_else(standard);
    require_writable(&directory)?;
    require_named(arguments.selection.svg.as_ref())?;
    let (mut done, mut left_out) = (Vec::new(), Vec::new());
    for (index, instance) in instances.iter().enumerate() {
        match request.done(&target, instance) {
            Ok(found) => done.extend(found.into_iter().map(|done| RunResult { instance: index, ..done })),
            // Under some of several loads there may be no equilibrium.
            Err(CommandError::Failed(reason)) if request.is_of_rest(&target) => left_out.push(reason),
            Err(error) => return Err(error),
        }
    }
    if done.is_empty() {
        return Err(CommandError::Failed(left_out.join("\n")));
    }
    let slider = arguments.selection.slide.as_ref().map(|slide| {
        slide.slider(&target, &request, || {
            let mut instances = target.instances(&arguments.selection.parameters)?;
            arguments.tables.feed(&target, &mut instances)?;
            Ok(instances)
        })
    });
    let mut slider: Option<Slider> = slider.transpose()?;
    let stops = slider
        .iter_mut()
        .flat_map(|slider| slider.stops.iter_mut().flat_map(|stop| stop.runs.iter_mut().flatten()));
    drop_idle(&mut done.iter_mut().chain(stops).map(|done| &mut done.motion).collect::<Vec<_>>());
    for done in &mut done {
        done.figures.extend(overlays.iter().filter_map(|overlay| compared(overlay, &done.motion)));
    }
    announce_size(done.iter().map(|done| &done.motion));
    let mut facts = facts(&instances, &done, &arguments.tables);
    facts.extend(left_out.iter().map(|reason| ["left out".to_string(), reason.clone()]));
    // Written before the table: printing fails if the reader of the output has left.
    let content = PageContent {
        command: &arguments.command(),
        analysis: request.analysis_of(&target).word(),
        facts: &facts,
        overlays: &decimate(&overlays),
        slider: slider.as_ref(),
    };
    let page = page(&target, &instances, &done, &content);
    let origin = out.put_mechanism(&target, instances[0].1.equations());
    let (page, version) = match arguments.selection.reload {
        true => {
            let (page, version) = reloading(&page);
            (page, Some(version))
        }
        false => (page, None),
    };
    let mut files = vec![("report.html", page), ("motion.csv", origin.csv(&values(&done)))];
    files.extend(modes(&done).map(|modes| ("modes.csv", origin.csv(&modes))));
    files.extend(version.map(|version| (VERSION, version)));
    if let Some(path) = &arguments.selection.svg {
        let picture = animated(&target, instances[done[0].instance].1.equations(), &done[0].motion)?;
        write_file(path, &origin.svg(&picture))?;
        out.put_file("picture", path);
    }
    let written = write_report(&directory, &files);
    out.put("analysis", request.analysis_of(&target).word());
    out.put("command", arguments.command());
    out.put("left_out", &left_out);
    if out.is_document() {
        done.iter().for_each(|done| out.push("runs", described(done, &instances[done.instance].1)));
    }
    writeln!(out, "{}", target.title())?;
    for done in &done {
        summary::write(out, target.shapes(), &done.label, &done.motion, &done.figures)?;
    }
    for reason in &left_out {
        writeln!(out, "\nleft out: {reason}")?;
    }
    writeln!(out)?;
    for path in written? {
        let of = |file: &str| path.ends_with(file);
        let name = match () {
            () if of("report.html") => "report",
            () if of("motion.csv") => "values",
            () if of("modes.csv") => "modes ",
            () => continue,
        };
        out.put_file(name.trim(), &path);
        writeln!(out, "{name}  {}", path.display())?;
    }
    let ended = done.iter().filter_map(|done| {
        let message = &done.ended.as_ref()?.message;
        Some(format!("{}, {}: {message}", target.name(), done.label))
    });
    match ended.collect::<Vec<_>>().as_slice() {
        [] => Ok(()),
        // Rows of all runs stand below them once.
        ended => Err(CommandError::Failed(target.quoted(instances[0].1.equations(), &ended.join("\n")))),
    }
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
}
