//! Commands on the text of a file that need code: a program of that text is built, and does what the command line says.

use std::env;
use std::ffi::OsString;
use std::process::{Command, ExitCode};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::CommandError;
use crate::catalogue::Catalogue;
use crate::forge::{Blueprint, Forge};
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
