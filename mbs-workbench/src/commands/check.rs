//! `mbs check`: faults and warnings of the texts in a file, without a build.

use std::io::Write;

use clap::Args;

use super::CommandError;
use crate::text_file::{checked, is_file};

#[derive(Args)]
pub struct Arguments {
    /// File with texts: a Rust source with `mechanism!` in it, or a `.mbs` file
    file: String,
}

/// Prints the warnings of all texts in the file, and how many there are.
///
/// Faults of the texts are the failure of the command.
pub fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<(), CommandError> {
    if !is_file(&arguments.file) {
        return Err(CommandError::Usage(format!(
            "`{}` is no file: its texts are compiled, and without faults; `mbs check FILE` takes `.rs` and `.mbs`",
            arguments.file
        )));
    }
    let (texts, warnings) = checked(&arguments.file)?;
    for warning in &warnings {
        writeln!(out, "{warning}")?;
    }
    let count = |number: usize, what: &str| format!("{number} {what}{}", if number == 1 { "" } else { "s" });
    writeln!(
        out,
        "{}: {} without faults, {}",
        arguments.file,
        count(texts, "text"),
        count(warnings.len(), "warning")
    )?;
    Ok(())
}
