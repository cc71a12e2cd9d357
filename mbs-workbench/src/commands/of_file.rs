//! Commands on the text of a file that need code: a program of that text is built, and does what the command line says.

use std::env;
use std::ffi::OsString;
use std::process::{Command, ExitCode};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use mbs_runtime::FunctionEntry;

use super::CommandError;
use crate::card::Card;
use crate::catalogue::Catalogue;
use crate::forge::{Blueprint, Forge, NameFrom, Study};
use crate::target_directory::{STARTED_FROM, target_directory};
use crate::text_file::TextFile;

/// The spinner turns while cargo works in its own process.
const TICK: Duration = Duration::from_millis(100);

/// A command that runs another one whenever the file is saved.
pub struct Watch {
    /// Its name on the command line.
    pub command: &'static str,
    /// The command that it runs, whose page loads itself anew.
    pub runs: &'static str,
}

/// Runs the command line again in a program that has the mechanism of `argument`.
pub fn run(catalogue: &Catalogue, argument: &str, watch: Option<Watch>) -> Result<ExitCode, CommandError> {
    let text = TextFile::read(argument)?;
    super::functions::require(&text)?;
    let blueprint = Blueprint::of_text(&text);
    let manifest = catalogue.first().map(|card| card.manifest.as_ref());
    let mut rest: Vec<OsString> = env::args_os().skip(1).collect();
    if let Some(Watch { command, runs }) = watch {
        // No option stands before a command.
        rest.iter_mut().filter(|word| *word == command).take(1).for_each(|word| *word = runs.into());
        rest.push("--reload".into());
    }
    started(&Forge::of_caller(manifest), &blueprint, rest)
}

/// Builds the program of a blueprint and runs it with `arguments`; its exit code.
pub fn started(
    forge: &Forge,
    blueprint: &Blueprint,
    arguments: Vec<OsString>,
) -> Result<ExitCode, CommandError> {
    let style = ProgressStyle::with_template("{spinner} {elapsed} {msg}").expect("a valid template");
    let bar = ProgressBar::new_spinner().with_style(style);
    bar.enable_steady_tick(TICK);
    let mut begun = false;
    let program = forge.program(blueprint, &mut |step| {
        // Without a terminal one line says why nothing happens yet.
        if bar.is_hidden() && !begun {
            eprintln!("{step}");
        }
        begun = true;
        bar.set_message(step.to_string());
    });
    bar.finish_and_clear();
    let program = program?;
    let target = target_directory();
    let mut command = Command::new(&program);
    command.args(arguments).env(STARTED_FROM, std::path::absolute(&target).unwrap_or(target));
    let status = command
        .status()
        .map_err(|error| CommandError::Failed(format!("{} does not start: {error}", program.display())))?;
    let code = status.code().and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(ExitCode::FAILURE, ExitCode::from))
}

/// Programs of a study of a card, those behind the first one for functions of the caller in `f64` alone. These are known by a first
/// program that does not compile.
pub(super) fn studies_of_card(
    study: Study,
    forge: &Forge,
    card: &Card,
    (own, source, functions): (&str, &str, &[FunctionEntry]),
) -> Result<Vec<Blueprint>, CommandError> {
    let others = [NameFrom::Text, NameFrom::Constructor].map(|name| study.in_doubles(name));
    let others = others.iter().filter(|_| !functions.is_empty());
    let of = |study: &Study| Blueprint::study_of_card(study, forge, card, (own, source, functions));
    Ok([study].iter().chain(others).map(of).collect::<Result<Vec<_>, _>>()?)
}

/// Builds the first program of `blueprints` that compiles and runs it. Those behind the first one take functions in `f64` alone, and are
/// tried only where such functions are the reason.
pub(super) fn first_that_compiles(
    forge: &Forge,
    blueprints: &[Blueprint],
    arguments: &[std::ffi::OsString],
) -> Result<ExitCode, CommandError> {
    let [first, others @ ..] = blueprints else { return Ok(ExitCode::FAILURE) };
    let mut ended = studied(forge, first, arguments.to_vec());
    let is_of_doubles = matches!(&ended, Err(CommandError::Failed(reason)) if reason.contains("Function<"));
    for other in others.iter().filter(|_| is_of_doubles) {
        ended = studied(forge, other, arguments.to_vec());
        if !matches!(ended, Err(CommandError::Failed(_))) {
            break;
        }
    }
    ended
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
                "the study is built in a program of its own: what the card's constructor names must be public\n{reason}"
            ))
        }
        error => error,
    })
}
