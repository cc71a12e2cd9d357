//! The commands of `mbs`: one file each, but for the six analyses, whose options and reports are in `run.rs`.

mod analysis;
mod assignment;
mod atlas;
pub mod basins;
pub mod cam;
mod cam_options;
pub mod check;
pub mod chosen;
pub mod compare;
pub mod cost;
mod cost_extras;
mod cost_kernels;
mod cost_known;
mod cost_words;
pub mod document;
pub mod dof;
pub mod drift;
pub mod effects;
mod effects_words;
pub mod expand;
mod feet;
pub mod fmt;
pub mod functions;
mod given_file;
pub mod hard_case_list;
pub mod hard_cases;
pub mod latex;
mod law_options;
pub mod list;
mod measured;
pub mod new;
pub mod newton;
pub mod next;
pub mod of_file;
pub mod print;
mod report_files;
mod rows;
pub mod run;
mod run_files;
mod slide;
pub mod structure;
pub mod study;
mod summary;
pub mod table;
mod target;
mod text;
pub mod verify;
pub mod watch;

use core::fmt::{Display, Formatter, Result as Written};
use std::io::{self, ErrorKind};

use crate::forge::ForgeError;
use crate::mismatch::Mismatch;
use crate::text_file::TextFileError;

/// Stack of a thread that runs mechanisms (bytes). Dense matrices are on it, for 82 coordinates with their multipliers half a megabyte
/// each, and a build without optimisation keeps every copy.
pub const STACK: usize = 64 << 20;

/// Failure of a command.
#[derive(Debug)]
pub enum CommandError {
    /// The command line names something that does not exist or cannot be.
    Usage(String),
    /// The mechanism, the check or the file system reports a failure.
    Failed(String),
    /// The output could not be written.
    Output(io::Error),
}

impl CommandError {
    pub fn exit_code(&self) -> u8 {
        match self {
            CommandError::Usage(_) => 2,
            CommandError::Failed(_) | CommandError::Output(_) => 1,
        }
    }

    /// `true` if the reader of the output has closed it, as `head` does: no failure of the command.
    pub fn is_closed_pipe(&self) -> bool {
        matches!(self, CommandError::Output(error) if error.kind() == ErrorKind::BrokenPipe)
    }
}

impl Display for CommandError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Written {
        match self {
            CommandError::Usage(text) | CommandError::Failed(text) => f.write_str(text),
            CommandError::Output(error) => write!(f, "cannot write the output: {error}"),
        }
    }
}

impl From<io::Error> for CommandError {
    fn from(error: io::Error) -> Self {
        CommandError::Output(error)
    }
}

impl From<Mismatch> for CommandError {
    fn from(mismatch: Mismatch) -> Self {
        CommandError::Usage(mismatch.to_string())
    }
}

impl From<TextFileError> for CommandError {
    fn from(error: TextFileError) -> Self {
        let text = error.to_string();
        if error.is_usage() { CommandError::Usage(text) } else { CommandError::Failed(text) }
    }
}

impl From<ForgeError> for CommandError {
    fn from(error: ForgeError) -> Self {
        CommandError::Failed(error.to_string())
    }
}

/// A whole number of at least one.
fn positive(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(0) => Err("at least 1 is needed".to_string()),
        Ok(number) => Ok(number),
        Err(_) => Err("a whole number is needed".to_string()),
    }
}
