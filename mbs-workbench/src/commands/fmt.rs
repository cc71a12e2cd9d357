//! `mbs fmt`: texts of files laid out.

use std::fs;
use std::io::Write;

use clap::Args;
use serde_json::json;

use super::CommandError;
use super::document::{Output, fault};
use crate::layout::{Layout, bare, rust};
use crate::text_file::{TextFileError, excerpt, is_file};

#[derive(Args)]
pub struct Arguments {
    /// Files with texts: Rust sources with `mechanism!` in them, or `.mbs` files
    #[arg(required = true, value_name = "FILE")]
    files: Vec<String>,
    /// Change no file: print the first line that would change in each, and fail if there is one
    #[arg(long)]
    check: bool,
}

/// Lays out the texts of all files. One that cannot be read stays as it is, and is the failure of the command.
pub fn run(arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    let (mut reasons, mut differing) = (Vec::new(), 0_usize);
    for path in &arguments.files {
        match laid_out(path, arguments.check, out)? {
            Outcome::Same => {}
            Outcome::Changed => differing += usize::from(arguments.check),
            Outcome::Faulty(faults) => reasons.push(format!("error: {faults}")),
        }
    }
    if differing > 0 {
        let files = if differing == 1 { "1 file is" } else { &format!("{differing} files are") };
        reasons.push(format!(
            "error: {files} laid out in another way; `mbs fmt` without `--check` changes that"
        ));
    }
    if reasons.is_empty() { Ok(()) } else { Err(CommandError::Failed(excerpt::joined(&reasons))) }
}

enum Outcome {
    Same,
    Changed,
    /// Faults of the texts that stay as they are; the others of the file are laid out.
    Faulty(String),
}

fn laid_out(path: &str, is_check: bool, out: &mut Output) -> Result<Outcome, CommandError> {
    if !is_file(path) {
        return Err(CommandError::Usage(format!(
            "`{path}` is no file: `mbs fmt FILE` takes `.rs` and `.mbs`"
        )));
    }
    let content = fs::read_to_string(path)
        .map_err(|error| TextFileError::Unreadable { path: path.to_string(), reason: error.to_string() })?;
    let Layout { content: laid, faults } = match path {
        _ if path.ends_with(".mbs") => bare(&content),
        _ if path.ends_with(".rs") => match rust(&content) {
            Ok(layout) => layout,
            Err(found) => {
                out.push("laid_out", json!({ "path": path, "is_same": true, "faults": [fault(&found)] }));
                return Ok(Outcome::Faulty(excerpt::faults(path, &content, &[found])));
            }
        },
        _ => return Err(TextFileError::Suffix { path: path.to_string() }.into()),
    };
    let is_same = laid == content;
    out.push(
        "laid_out",
        json!({ "path": path, "is_same": is_same, "faults": faults.iter().map(fault).collect::<Vec<_>>() }),
    );
    if !is_same && is_check {
        let (line, [before, after]) = first_difference(&content, &laid);
        writeln!(out, "{path}:{line}\n- {before}\n+ {after}")?;
    } else if !is_same {
        fs::write(path, laid)
            .map_err(|error| CommandError::Failed(format!("cannot write {path}: {error}")))?;
        writeln!(out, "{path}: laid out")?;
    }
    Ok(match faults.is_empty() {
        false => Outcome::Faulty(excerpt::faults(path, &content, &faults)),
        true if is_same => Outcome::Same,
        true => Outcome::Changed,
    })
}

/// The first line, from 1, that differs, before and after.
fn first_difference<'a>(before: &'a str, after: &'a str) -> (usize, [&'a str; 2]) {
    let mut lines = before.split('\n').zip(after.split('\n')).enumerate();
    let differing = lines.find(|(_, (before, after))| before != after);
    // One of both goes on where the other one ends.
    let common = before.lines().count().min(after.lines().count());
    let beyond =
        || [before.lines().nth(common).unwrap_or_default(), after.lines().nth(common).unwrap_or_default()];
    match differing {
        Some((index, (before, after))) => (index + 1, [before, after]),
        None => (common + 1, beyond()),
    }
}
