//! `mbs`: runs, draws, prints and checks the mechanisms of this crate.
//!
//! Exit codes: 0 done; 1 a mechanism could not be moved, a check failed, a file could not be written; 2 the
//! command line does not make sense.

mod commands;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use commands::CommandError;
use mechanisms::registry;

/// Mechanisms as exact code: run, draw, print and check them.
#[derive(Parser)]
#[command(
    name = "mbs",
    version,
    after_help = "Without a command, the four-bar with coupler point runs one turn."
)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// List the mechanisms
    List,
    /// Run a mechanism; write a report page and a table of its motion
    Run(commands::run::Arguments),
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
    /// Print how large a step the previous position bears as the guess of the next
    Next(commands::next::Arguments),
    /// Print degrees of freedom, ranks, independent and dependent coordinates
    Dof(commands::dof::Arguments),
    /// Draw how far the constraints drift by several stabilisations
    Drift(commands::drift::Arguments),
    /// Compare one linkage in several kinds of coordinates
    Compare(commands::compare::Arguments),
    /// Lay a spline along a table from a file; say how far to trust it, draw it, print it as Rust
    Table(commands::table_file::Arguments),
}

/// Dense matrices stand on the stack, of 82 coordinates with their multipliers half a megabyte each, and a build without
/// optimisation keeps every copy (bytes).
const STACK: usize = 64 << 20;

fn main() -> ExitCode {
    let command = Arguments::parse().command;
    let run = || match execute(command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => report(&error),
    };
    match std::thread::Builder::new().stack_size(STACK).spawn(run).map(std::thread::JoinHandle::join) {
        Ok(Ok(code)) => code,
        // It panicked, and has said so.
        Ok(Err(_)) => ExitCode::from(101),
        Err(error) => report(&CommandError::Failed(format!("cannot start a thread: {error}"))),
    }
}

fn execute(command: Option<Command>) -> Result<(), CommandError> {
    let mut out = io::stdout().lock();
    match command {
        None => commands::run::run(&commands::run::Arguments::defaults(registry::ALL[0].name), &mut out),
        Some(Command::List) => commands::list::run(&mut out),
        Some(Command::Run(arguments)) => commands::run::run(&arguments, &mut out),
        Some(Command::Expand(arguments)) => commands::expand::run(&arguments, &mut out),
        Some(Command::Verify(arguments)) => commands::verify::run(&arguments, &mut out),
        Some(Command::Print(arguments)) => commands::print::run(&arguments, &mut out),
        Some(Command::Latex(arguments)) => commands::latex::run(&arguments, &mut out),
        Some(Command::Structure(arguments)) => commands::structure::run(&arguments, &mut out),
        Some(Command::Newton(arguments)) => commands::newton::run(&arguments, &mut out),
        Some(Command::Basins(arguments)) => commands::basins::run(&arguments, &mut out),
        Some(Command::Next(arguments)) => commands::next::run(&arguments, &mut out),
        Some(Command::Dof(arguments)) => commands::dof::run(&arguments, &mut out),
        Some(Command::Drift(arguments)) => commands::drift::run(&arguments, &mut out),
        Some(Command::Compare(arguments)) => commands::compare::run(&arguments, &mut out),
        Some(Command::Table(arguments)) => commands::table_file::run(&arguments, &mut out),
    }?;
    out.flush().map_err(CommandError::Output)
}

fn report(error: &CommandError) -> ExitCode {
    if error.is_closed_pipe() {
        return ExitCode::SUCCESS;
    }
    // Where nobody can read the message the exit code must do.
    let _ = writeln!(io::stderr(), "error: {error}");
    ExitCode::from(error.exit_code())
}
