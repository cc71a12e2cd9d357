//! A run of `cargo build`, its messages in the user's own terms.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;

use serde_json::Value;

use super::blueprint::Origin;
use super::{Blueprint, Forge, ForgeError, not_started};
use crate::text_file::excerpt::{Excerpt, joined};

/// Lines of cargo's own messages that are shown: enough for an error with its causes.
const LINES: usize = 12;

/// Name of the source file in messages of the compiler.
const SOURCE: &str = "src/main.rs";

/// Result of one run of cargo.
struct Built {
    /// The program, where there is one.
    program: Option<PathBuf>,
    /// Errors of the compiler.
    errors: Vec<Value>,
    /// Cargo's own messages.
    said: String,
}

impl Forge {
    /// The built program of the crate in `folder`. Cargo asks the network only for what is not on this machine.
    pub(super) fn build(
        &self,
        folder: &Path,
        blueprint: &Blueprint,
        progress: &mut dyn FnMut(&str),
    ) -> Result<PathBuf, ForgeError> {
        progress(&format!("building a program for `{}`", blueprint.name));
        let mut built = self.cargo_build(folder, blueprint, true, progress)?;
        if built.program.is_none() && built.errors.is_empty() && built.said.contains("offline") {
            progress("fetching crates");
            built = self.cargo_build(folder, blueprint, false, progress)?;
        }
        let Built { program, errors, said } = built;
        if let Some(program) = program {
            return Ok(program);
        }
        let shown: Vec<String> =
            errors.iter().filter_map(|error| shown(error, blueprint.origin.as_ref())).collect();
        if shown.is_empty() {
            let lines: Vec<&str> = said.lines().filter(|line| !line.trim().is_empty()).collect();
            return Err(ForgeError::Cargo(lines[lines.len().saturating_sub(LINES)..].join("\n")));
        }
        Err(ForgeError::Faults(joined(&shown)))
    }

    fn cargo_build(
        &self,
        folder: &Path,
        blueprint: &Blueprint,
        offline: bool,
        progress: &mut dyn FnMut(&str),
    ) -> Result<Built, ForgeError> {
        let mut command = Command::new(&self.cargo);
        let action = if blueprint.is_measured { "rustc" } else { "build" };
        command.args([action, "--message-format", "json", "--manifest-path"]).arg(folder.join("Cargo.toml"));
        command.arg("--target-dir").arg(&self.target);
        command.args(offline.then_some("--offline")).args(self.release.then_some("--release"));
        if blueprint.is_measured {
            // Of the program itself alone: what it depends on is not built anew.
            command.args(["--", "-C", "symbol-mangling-version=v0", "-C", "codegen-units=16"]);
        }
        if !self.flags.is_empty() {
            let given = std::env::var("RUSTFLAGS").unwrap_or_default();
            command.env("RUSTFLAGS", format!("{given} {}", self.flags).trim());
        }
        // Settings of cargo and the toolchain are those of the caller.
        command
            .current_dir(&self.workspace)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut child = command.spawn().map_err(|error| not_started(&self.cargo, &error))?;
        let (output, complaints) = (child.stdout.take(), child.stderr.take());
        let reader = thread::spawn(move || {
            let mut said = Vec::new();
            // What cannot be read is not shown.
            let _ = complaints.map(|mut complaints| complaints.read_to_end(&mut said));
            String::from_utf8_lossy(&said).into_owned()
        });
        let mut built = Built { program: None, errors: Vec::new(), said: String::new() };
        let mut program = None;
        for line in output.into_iter().flat_map(|output| BufReader::new(output).lines()).map_while(Result::ok)
        {
            let Ok(message) = serde_json::from_str::<Value>(&line) else { continue };
            match message["reason"].as_str() {
                Some("compiler-artifact") => {
                    if message["fresh"] == Value::Bool(false) {
                        let name = message["target"]["name"].as_str().unwrap_or_default();
                        progress(&format!("built {name}"));
                    }
                    if let Some(path) = message["executable"].as_str() {
                        program = Some(PathBuf::from(path));
                    }
                }
                Some("compiler-message") if message["message"]["level"] == "error" => {
                    built.errors.push(message["message"].clone());
                }
                _ => {}
            }
        }
        let status = child.wait().map_err(|error| not_started(&self.cargo, &error))?;
        built.said = reader.join().unwrap_or_default();
        built.program = program.filter(|_| status.success());
        Ok(built)
    }
}

/// An error of the compiler, at the line of the user's file where it has one; `None` for a summary of others.
fn shown(error: &Value, origin: Option<&Origin>) -> Option<String> {
    let message = error["message"].as_str()?;
    if message.starts_with("aborting due to") {
        return None;
    }
    let spans = error["spans"].as_array().into_iter().flatten();
    let place = spans.filter(|span| span["is_primary"] == Value::Bool(true)).find_map(in_source);
    let (Some(origin), Some(span)) = (origin, place) else {
        return error["rendered"].as_str().map(|text| text.trim_end().to_string() + "\n");
    };
    let number = |name: &str| span[name].as_u64().and_then(|number| usize::try_from(number).ok());
    let (line, start, end) = (number("line_start")?, number("column_start")?, number("column_end")?);
    let shift = if line == origin.shifted.0 { origin.shifted.1 } else { 0 };
    let is_one_line = number("line_end") == Some(line);
    let length = if is_one_line { end.saturating_sub(start).max(1) } else { 1 };
    let column = start.saturating_sub(shift).max(1);
    let notes: Vec<(&str, &str)> = error["children"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|note| Some((note["level"].as_str()?, note["message"].as_str()?)))
        .collect();
    let excerpt = Excerpt { path: &origin.path, content: &origin.content, line, column, length };
    Some(excerpt.message(message, &notes))
}

/// The place in the source file: the span itself, or the call of the macro that it comes from.
fn in_source(span: &Value) -> Option<&Value> {
    let mut span = span;
    while span["file_name"] != SOURCE {
        span = span["expansion"].get("span")?;
    }
    Some(span)
}
