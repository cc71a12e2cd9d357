//! Command line of `mbs`: runs, draws, prints and checks the mechanisms of a list.
//!
//! Exit codes: 0 done; 1 a mechanism could not be moved, a check failed, a file could not be written; 2 the
//! command line does not make sense.

use std::io::{self, Read, Write};
use std::process::ExitCode;
use std::thread;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Parser, Subcommand};

use crate::card::Card;
use crate::catalogue::Catalogue;
use crate::commands::document::Output;
use crate::commands::run::Arguments as Analysis;
use crate::commands::{self, CommandError, STACK};
use crate::effects::measurement::{NamedScene, Order, measure};
use crate::erased::costs::Comparable;
use crate::erased::variations::Variable;
use crate::hard_cases::list::Listed;
use crate::mismatch::nearest;
use crate::tables::valley::NamedLaw;
use crate::target_directory::is_started;
use crate::text_file::is_file;

/// Mechanisms as exact code: run, draw, print and check them.
#[derive(Parser)]
#[command(name = "mbs", version, after_help = "Without a command, the first mechanism of the list runs.")]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Print the results as one JSON document
    #[arg(long, global = true)]
    json: bool,
    /// Function of a text in a file: a CSV table, with units as `lift.csv:deg,mm` or in its header, or a law as `mbs cam` takes it
    // Read again from the command line, by this program and by the one that is built for the file.
    #[arg(long, global = true, value_name = "NAME=FILE.csv|LAW", allow_hyphen_values = true)]
    function: Vec<String>,
}

#[derive(Subcommand)]
enum Command {
    /// Write a crate with a mechanism to begin from
    New(commands::new::Arguments),
    /// List the mechanisms, or those in a file
    List(commands::list::Arguments),
    /// Print faults and warnings of the texts in a file
    Check(commands::check::Arguments),
    /// Lay out the texts in files: blanks, lines, indentation
    Fmt(commands::fmt::Arguments),
    /// Run the analysis that suits a mechanism; write a report page and a table of its motion
    Run(commands::run::MotionArguments),
    /// Compute positions, velocities and accelerations that drives prescribe
    Kinematics(commands::run::DrivenArguments),
    /// Integrate the motion that forces cause
    Simulate(commands::run::MotionArguments),
    /// Compute efforts of drives and loads of the motion that drives prescribe
    Inverse(commands::run::DrivenArguments),
    /// Find the position of rest and its stability
    Equilibrium(commands::run::EquilibriumArguments),
    /// Compute eigenvalues and modes of small motions about the equilibrium, or about a state
    Modes(commands::run::ModesArguments),
    /// Run the text of a file whenever it is saved; the page loads itself anew
    Watch(commands::run::MotionArguments),
    /// Print the code that a mechanism's text becomes
    Expand(commands::expand::Arguments),
    /// Compare a mechanism's derivatives with CasADi's
    Verify(commands::verify::Arguments),
    /// Print Φ, Φ_q, Φ_t, γ with names on rows and columns: numbers at a time, or formulas
    Print(commands::print::Arguments),
    /// Write Φ, Φ_q, Φ_t, γ as a LaTeX document
    Latex(commands::latex::Arguments),
    /// Print sparsity, matching and the order of solution; draw the ordered Jacobian
    Structure(commands::structure::Arguments),
    /// Print Newton's iterations from a guess and the assembly that they end in
    Newton(commands::newton::Arguments),
    /// Draw which assembly is found from which guess
    Basins(commands::basins::Arguments),
    /// Print the largest time step for which Newton converges from the previous position, with and without the predictor
    Next(commands::next::Arguments),
    /// Print degrees of freedom, ranks, independent and dependent coordinates
    Dof(commands::dof::Arguments),
    /// Draw how far the constraints drift by several stabilisations
    Drift(commands::drift::Arguments),
    /// Compare one linkage in several kinds of coordinates
    Compare(commands::compare::Arguments),
    /// Show what accuracy costs: the true error of each method, step and type of number over its time
    Cost(commands::cost::Arguments),
    /// Show which effects of a text a scene needs: what each one changes and costs, and the cheapest scene that is near enough
    Effects(commands::effects::Arguments),
    /// Run a mechanism in many hard variants by every method: right, refused, late or wrong, judged by the text itself
    HardCases(commands::hard_cases::Arguments),
    /// Make the profile of a cam from its lift law; say which limits it breaks, find the least cam
    Cam(Box<commands::cam::Arguments>),
    /// Run the study that a mechanism brings: a chain of computations with one page; without a name, list the studies
    Study(commands::study::Arguments),
    /// Lay a spline along a table from a file; say how far to trust it, draw it, print it as Rust
    Table(commands::table::Arguments),
}

impl Command {
    /// Name of the document with its results; the analyses have one of the same fields.
    fn schema(&self) -> &'static str {
        match self {
            Command::New(_) => "new",
            Command::List(_) => "list",
            Command::Check(_) => "check",
            Command::Fmt(_) => "fmt",
            Command::Run(_)
            | Command::Kinematics(_)
            | Command::Simulate(_)
            | Command::Inverse(_)
            | Command::Equilibrium(_)
            | Command::Modes(_)
            | Command::Watch(_) => "run",
            Command::Expand(_) => "expand",
            Command::Verify(_) => "verify",
            Command::Print(_) => "print",
            Command::Latex(_) => "latex",
            Command::Structure(_) => "structure",
            Command::Newton(_) => "newton",
            Command::Basins(_) => "basins",
            Command::Next(_) => "next",
            Command::Dof(_) => "dof",
            Command::Drift(_) => "drift",
            Command::Compare(_) => "compare",
            Command::Cost(_) => "cost",
            Command::Effects(_) => "effects",
            Command::HardCases(_) => "hard-cases",
            Command::Cam(_) => "cam",
            Command::Study(_) => "study",
            Command::Table(_) => "table",
        }
    }

    /// `true` if the command is about a text in a file, and does without a program of it or builds one of its own.
    fn is_about_a_file(&self) -> bool {
        match self {
            Command::Print(of) => is_file(of.chosen.name()),
            Command::Latex(of) => is_file(of.chosen.name()),
            Command::Structure(of) => is_file(of.chosen.name()),
            Command::Dof(of) => is_file(of.chosen.name()),
            Command::Cost(of) => is_file(of.name()),
            Command::Effects(of) => is_file(&of.name),
            Command::HardCases(of) => of.name.as_deref().is_some_and(is_file),
            Command::Watch(of) => is_file(of.selection.name()),
            _ => false,
        }
    }

    /// The file that the command line names in place of a mechanism, where the command needs code for it.
    fn file_to_build(&self) -> Option<&str> {
        let chosen = |chosen: &'_ commands::chosen::Chosen, is_text: bool| !(is_text && chosen.is_plain());
        let (name, needs_code) = match self {
            Command::Run(of) | Command::Simulate(of) => (of.selection.name(), true),
            Command::Kinematics(of) | Command::Inverse(of) => (of.selection.name(), true),
            Command::Equilibrium(of) => (of.selection.name(), true),
            Command::Modes(of) => (of.selection.name(), true),
            Command::Verify(of) => (of.name.as_deref()?, true),
            Command::Drift(of) => (of.name.as_str(), true),
            Command::Newton(of) => (of.chosen.name(), true),
            Command::Basins(of) => (of.chosen.name(), true),
            Command::Next(of) => (of.chosen.name(), true),
            Command::Print(of) => (of.chosen.name(), chosen(&of.chosen, of.symbols)),
            Command::Latex(of) => (of.chosen.name(), chosen(&of.chosen, true)),
            Command::Structure(of) => (of.chosen.name(), chosen(&of.chosen, true)),
            Command::Dof(of) => (of.chosen.name(), chosen(&of.chosen, of.at.is_none())),
            // It builds as often as the file changes.
            Command::Watch(_) => return None,
            Command::New(_)
            | Command::List(_)
            | Command::Check(_)
            | Command::Fmt(_)
            | Command::Expand(_)
            | Command::Compare(_)
            // They build a program of their own.
            | Command::Cost(_)
            | Command::Effects(_)
            | Command::HardCases(_)
            | Command::Cam(_)
            | Command::Study(_)
            | Command::Table(_) => return None,
        };
        (needs_code && is_file(name) && !is_started()).then_some(name)
    }
}

/// Runs the command line on mechanisms, as `program(&[card!(Wiper::default())])`.
///
/// Exit codes: 0 done; 1 a mechanism could not be moved, a check failed, a file could not be written; 2 the command line
/// or the list of mechanisms does not make sense.
pub fn program(cards: &[Card]) -> ExitCode {
    let catalogue = Catalogue { cards };
    let Arguments { command, json, .. } = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            let typed = typed_command();
            let hint = mechanism_as_command(&catalogue, &error)
                .or_else(|| option_elsewhere(&error, &typed))
                .or_else(|| value_elsewhere(&error, &typed));
            put_usage(&error, hint.as_deref());
            match hint {
                Some(hint) => return report(&CommandError::Usage(hint)),
                None => error.exit(),
            }
        }
    };
    on_large_stack(|| execute(&catalogue, command, json))
}

/// A document about a command line that makes no sense, where it asks for one.
fn put_usage(error: &clap::Error, hint: Option<&str>) {
    if !error.use_stderr() || std::env::args_os().all(|word| word != "--json") {
        return;
    }
    let text = error.to_string();
    let message = hint.unwrap_or_else(|| text.strip_prefix("error: ").unwrap_or(&text).trim_end());
    let usage = CommandError::Usage(message.to_string());
    // If it cannot be written, the message and the exit code say it.
    let _ = Output::new(&mut io::stdout().lock(), Some("usage")).end(Some(&usage));
}

/// The study of `mbs cost` in a program that was built for one mechanism. `card` names it; `make` makes it in all numbers from
/// parameters and inputs by their indices, `laws` the functions of its caller.
pub fn cost_program(
    card: Card,
    make: fn(&[(usize, f64)]) -> Comparable,
    laws: fn() -> Vec<NamedLaw>,
) -> ExitCode {
    study_program(&[card], "cost", |command, catalogue, out| match command {
        Command::Cost(arguments) => Some(commands::cost::study(catalogue, arguments, make, &laws(), out)),
        _ => None,
    })
}

/// The study of `mbs hard-cases` in such a program.
pub fn hard_cases_program(card: Card, make: fn(&[(usize, f64)]) -> Variable) -> ExitCode {
    study_program(&[card], "hard-cases", |command, catalogue, out| match command {
        Command::HardCases(arguments) => Some(commands::hard_cases::study(catalogue, arguments, make, out)),
        _ => None,
    })
}

/// The study of the list of hard cases, in a program that was built for its texts.
pub fn hard_cases_program_list(cases: &[Listed]) -> ExitCode {
    study_program(&[], "hard-cases", |command, _, out| match command {
        Command::HardCases(arguments) => Some(commands::hard_case_list::study(arguments, cases, out)),
        _ => None,
    })
}

/// A program that measures scenes: it reads an order as JSON and prints what it measured.
pub fn effects_program(scenes: &[NamedScene]) -> ExitCode {
    on_large_stack(|| {
        let mut text = String::new();
        let read = io::stdin().read_to_string(&mut text).map_err(|error| error.to_string());
        let order =
            read.and_then(|_| serde_json::from_str::<Order>(&text).map_err(|error| error.to_string()));
        match order {
            Ok(order) => match serde_json::to_writer(io::stdout().lock(), &measure(scenes, &order)) {
                Ok(()) => ExitCode::SUCCESS,
                Err(error) => report(&CommandError::Failed(format!("cannot write: {error}"))),
            },
            Err(error) => report(&CommandError::Usage(format!(
                "this program measures scenes for `mbs effects`: {error}"
            ))),
        }
    })
}

/// A program with one command for one mechanism; `study` gives none for another command.
fn study_program(
    cards: &[Card],
    name: &str,
    study: impl FnOnce(&Command, &Catalogue, &mut Output) -> Option<Result<ExitCode, CommandError>> + Send,
) -> ExitCode {
    let catalogue = Catalogue { cards };
    match Arguments::try_parse() {
        Ok(Arguments { command: Some(command), json, .. }) if command.schema() == name => {
            on_large_stack(|| {
                let mut stdout = io::stdout().lock();
                let mut out = Output::new(&mut stdout, json.then_some(name));
                let Some(found) = study(&command, &catalogue, &mut out) else { return ExitCode::FAILURE };
                let ended = out.end(found.as_ref().err());
                let code = found.unwrap_or_else(|error| report(&error));
                ended.map_or_else(|error| report(&CommandError::Output(error)), |()| code)
            })
        }
        Ok(_) => report(&CommandError::Usage(format!("this program has the command `{name}` alone"))),
        Err(error) => error.exit(),
    }
}

/// Runs `run` in a thread with room for matrices of all unknowns.
fn on_large_stack(run: impl FnOnce() -> ExitCode + Send) -> ExitCode {
    thread::scope(|scope| {
        let started = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, run);
        match started.map(thread::ScopedJoinHandle::join) {
            Ok(Ok(code)) => code,
            // It panicked, with a message.
            Ok(Err(_)) => ExitCode::from(101),
            Err(error) => report(&CommandError::Failed(format!("cannot start a thread: {error}"))),
        }
    })
}

/// Command that was meant where the name of a mechanism or a file stands in its place.
fn mechanism_as_command(catalogue: &Catalogue, error: &clap::Error) -> Option<String> {
    let is_unknown = error.kind() == ErrorKind::InvalidSubcommand;
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand).filter(|_| is_unknown)
    else {
        return None;
    };
    // A command that is nearly written so is meant before a mechanism.
    let has_proposal = error.get(ContextKind::SuggestedSubcommand).is_some();
    // Of a word of a few letters the parser knows no command that is near.
    let commands = Arguments::command();
    let is_near = |command: &&str| strsim::damerau_levenshtein(word, command) == 1;
    let near_command = commands.get_subcommands().map(clap::Command::get_name).find(is_near);
    if let Some(command) = near_command.filter(|_| !has_proposal) {
        return Some(format!(
            "`{word}` is no command; did you mean `{command}`?\n`mbs --help` lists the commands"
        ));
    }
    let names: Vec<String> = catalogue.names().collect();
    let same = names.iter().find(|name| name.eq_ignore_ascii_case(word));
    let near = || nearest(word, names.iter().map(String::as_str)).map(str::to_owned);
    let name = match same {
        Some(name) => name.clone(),
        None if is_file(word) => word.clone(),
        None if has_proposal => return None,
        None => near()?,
    };
    Some(format!(
        "`{word}` is no command; a mechanism runs by `mbs run {name}`\n`mbs --help` lists the commands"
    ))
}

/// The command that the command line begins with; `run` where it names none.
fn typed_command() -> String {
    let words = std::env::args_os().skip(1).filter_map(|word| word.into_string().ok());
    words.into_iter().find(|word| !word.starts_with('-')).unwrap_or_else(|| "run".into())
}

/// Commands that have an option which the one that was typed lacks.
fn option_elsewhere(error: &clap::Error, typed: &str) -> Option<String> {
    let is_unknown = error.kind() == ErrorKind::UnknownArgument;
    let Some(ContextValue::String(option)) = error.get(ContextKind::InvalidArg).filter(|_| is_unknown) else {
        return None;
    };
    let long = option.strip_prefix("--")?;
    // An option that is nearly written so is meant before another command.
    if error.get(ContextKind::SuggestedArg).is_some() {
        return None;
    }
    let commands = Arguments::command();
    let has = |command: &&clap::Command| command.get_arguments().any(|known| known.get_long() == Some(long));
    let with: Vec<String> = commands
        .get_subcommands()
        .filter(has)
        .map(|command| format!("`mbs {}`", command.get_name()))
        .collect();
    let reason = match with.is_empty() {
        true => String::from("no command has it"),
        false => format!("it is an option of {}", with.join(", ")),
    };
    Some(format!(
        "unexpected argument '{option}': `mbs {typed}` has no such option, {reason}\n\
         `mbs {typed} --help` lists those that it has"
    ))
}

/// Option of the command `typed` that has the value which another one lacks.
fn value_elsewhere(error: &clap::Error, typed: &str) -> Option<String> {
    let is_unknown =
        error.kind() == ErrorKind::InvalidValue && error.get(ContextKind::SuggestedValue).is_none();
    let string = |kind: ContextKind| match error.get(kind).filter(|_| is_unknown)? {
        ContextValue::String(text) => Some(text.as_str()),
        _ => None,
    };
    let (option, word) = (string(ContextKind::InvalidArg)?, string(ContextKind::InvalidValue)?);
    let commands = Arguments::command();
    let command = commands.find_subcommand(typed)?;
    let has = |known: &&clap::Arg| known.get_possible_values().iter().any(|value| value.matches(word, true));
    let long = command.get_arguments().find(has)?.get_long()?;
    let option = option.split(' ').next().unwrap_or(option);
    Some(format!(
        "`{word}` is no value of `{option}`; write `--{long} {word}`\n`mbs {typed} --help` lists the values of both"
    ))
}

/// Runs the command; its results, and its error, are one document where that is asked for.
fn execute(catalogue: &Catalogue, command: Option<Command>, is_document: bool) -> ExitCode {
    // Without a command the first mechanism runs, and without mechanisms there is an empty list.
    let standard = if catalogue.is_empty() { "list" } else { "run" };
    let schema = command.as_ref().map_or(standard, Command::schema);
    let mut stdout = io::stdout().lock();
    let mut out = Output::new(&mut stdout, is_document.then_some(schema));
    let done = dispatch(catalogue, command, &mut out);
    // What was built for a file has printed the document itself.
    let ended = if let Ok(RunResult::Elsewhere(_)) = &done { Ok(()) } else { out.end(done.as_ref().err()) };
    let code = match done {
        Ok(RunResult::Here) => ExitCode::SUCCESS,
        Ok(RunResult::Elsewhere(code)) => code,
        Err(error) => report(&error),
    };
    ended.map_or_else(|error| report(&CommandError::Output(error)), |()| code)
}

/// Program that ran a command.
enum RunResult {
    Here,
    /// One that was built for the text of a file, with its exit code.
    Elsewhere(ExitCode),
}

fn dispatch(
    catalogue: &Catalogue,
    command: Option<Command>,
    out: &mut Output,
) -> Result<RunResult, CommandError> {
    if let Some(name) = catalogue.repeated() {
        return Err(CommandError::Usage(format!(
            "two mechanisms are called `{name}`; put each in a module of its own, or make it by a function of its own name"
        )));
    }
    if let Some(file) = command.as_ref().and_then(Command::file_to_build) {
        return commands::of_file::run(catalogue, file, None).map(RunResult::Elsewhere);
    }
    if !is_started() && !command.as_ref().is_some_and(Command::is_about_a_file) {
        commands::functions::refuse_without_file()?;
    }
    let analysis = |of: Analysis, out: &mut Output| commands::run::run(catalogue, &of, out);
    match command {
        None => match catalogue.first() {
            Some(card) => analysis(Analysis::defaults(&card.name()), out),
            None => commands::list::run(catalogue, &commands::list::Arguments::default(), out),
        },
        Some(Command::New(arguments)) => commands::new::run(&arguments, out),
        Some(Command::List(arguments)) => commands::list::run(catalogue, &arguments, out),
        Some(Command::Check(arguments)) => commands::check::run(&arguments, out),
        Some(Command::Fmt(arguments)) => commands::fmt::run(&arguments, out),
        Some(Command::Run(arguments)) => analysis(Analysis::run(arguments), out),
        Some(Command::Kinematics(arguments)) => analysis(Analysis::kinematics(arguments), out),
        Some(Command::Simulate(arguments)) => analysis(Analysis::simulate(arguments), out),
        Some(Command::Inverse(arguments)) => analysis(Analysis::inverse(arguments), out),
        Some(Command::Equilibrium(arguments)) => analysis(Analysis::equilibrium(arguments), out),
        Some(Command::Modes(arguments)) => analysis(Analysis::modes(arguments), out),
        Some(Command::Watch(_)) if out.is_document() => Err(CommandError::Usage(
            "`mbs watch` does not end, so it has no document; use `mbs run --json`".to_string(),
        )),
        Some(Command::Watch(arguments)) => commands::watch::run(catalogue, &arguments),
        Some(Command::Expand(arguments)) => commands::expand::run(catalogue, &arguments, out),
        Some(Command::Verify(arguments)) => commands::verify::run(catalogue, &arguments, out),
        Some(Command::Print(arguments)) => commands::print::run(catalogue, &arguments, out),
        Some(Command::Latex(arguments)) => commands::latex::run(catalogue, &arguments, out),
        Some(Command::Structure(arguments)) => commands::structure::run(catalogue, &arguments, out),
        Some(Command::Newton(arguments)) => commands::newton::run(catalogue, &arguments, out),
        Some(Command::Basins(arguments)) => commands::basins::run(catalogue, &arguments, out),
        Some(Command::Next(arguments)) => commands::next::run(catalogue, &arguments, out),
        Some(Command::Dof(arguments)) => commands::dof::run(catalogue, &arguments, out),
        Some(Command::Drift(arguments)) => commands::drift::run(catalogue, &arguments, out),
        Some(Command::Compare(arguments)) => commands::compare::run(catalogue, &arguments, out),
        Some(Command::HardCases(arguments)) => {
            return commands::hard_cases::run(catalogue, &arguments).map(RunResult::Elsewhere);
        }
        Some(Command::Cost(arguments)) => {
            let code = commands::cost::run(catalogue, &arguments, out)?;
            // An index is this program's own document.
            return Ok(if arguments.is_index() { RunResult::Here } else { RunResult::Elsewhere(code) });
        }
        Some(Command::Effects(arguments)) => commands::effects::run(catalogue, &arguments, out),
        Some(Command::Cam(arguments)) => commands::cam::run(&arguments, out),
        Some(Command::Study(arguments)) => commands::study::run(catalogue, &arguments, out),
        Some(Command::Table(arguments)) => commands::table::run(&arguments, out),
    }?;
    out.flush().map_err(CommandError::Output)?;
    Ok(RunResult::Here)
}

fn report(error: &CommandError) -> ExitCode {
    if error.is_closed_pipe() {
        return ExitCode::SUCCESS;
    }
    // If the message cannot be written, the exit code alone reports the failure.
    let _ = writeln!(io::stderr(), "error: {error}");
    ExitCode::from(error.exit_code())
}
