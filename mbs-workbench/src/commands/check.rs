//! `mbs check`: faults and warnings of the texts in a file, without a build.

use std::io::Write;

use clap::Args;

use super::CommandError;
use super::document::{Output, fault};
use crate::text_file::{checked, is_file};

#[derive(Args)]
pub struct Arguments {
    /// File with texts: a Rust source with `mechanism!` in it, or a `.mbs` file
    file: String,
}

/// Prints the warnings of all texts in the file, and how many there are.
///
/// Faults of the texts are the failure of the command.
pub fn run(arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    if !is_file(&arguments.file) {
        return Err(CommandError::Usage(format!(
            "`{}` is no file: its texts are compiled, and without faults; `mbs check FILE` takes `.rs` and `.mbs`",
            arguments.file
        )));
    }
    let found = checked(&arguments.file)?;
    out.put("file", &arguments.file);
    out.put("texts", found.texts.len());
    out.put("hashes", &found.texts);
    out.put("faults", found.faults.iter().map(fault).collect::<Vec<_>>());
    out.put("warnings", found.warnings.iter().map(fault).collect::<Vec<_>>());
    if let Some(error) = found.error() {
        return Err(error.into());
    }
    let (texts, warnings) = (found.texts.len(), found.shown_warnings());
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
