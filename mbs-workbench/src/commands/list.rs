//! `mbs list`.

use std::io::Write;

use clap::Args;
use mbs_codegen::Variable;
use mbs_runtime::Entry;
use serde_json::json;

use super::CommandError;
use super::document::Output;
use super::summary::{short, unit};
use crate::catalogue::Catalogue;
use crate::output::origin::Origin;
use crate::text_file::{Listed, is_file, listed};

#[derive(Args, Default)]
pub struct Arguments {
    /// List the mechanisms and scenes in a file instead
    file: Option<String>,
}

/// Names, headings and parameters of all mechanisms of the list, or of those in a file.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    if let Some(file) = &arguments.file {
        return of_file(file, out);
    }
    let width = catalogue.names().map(|name| name.len()).max().unwrap_or(0);
    out.put("mechanisms", json!([]));
    for card in catalogue.iter() {
        let free = if card.is_free() { " (free to move)" } else { "" };
        writeln!(out, "{:width$}  {}{free}", card.name(), card.picture()?.title)?;
        let mechanism = card.equations();
        let parameters = mechanism.variables().iter().enumerate().map(|(index, entry)| {
            let value = mechanism.get(index).unwrap_or(f64::NAN);
            format!("{}={}{}", entry.name, short(value), unit(entry.unit))
        });
        writeln!(out, "{:width$}  {}", "", parameters.collect::<Vec<_>>().join(", "))?;
        let variable = |(index, entry): (usize, &Entry)| json!({ "name": entry.name, "unit": entry.unit, "value": mechanism.get(index) });
        let variables: Vec<_> = mechanism.variables().iter().enumerate().map(variable).collect();
        let origin = Origin::of_text(&card.name(), mechanism.source());
        out.push(
            "mechanisms",
            json!({
                "name": card.name(), "title": card.picture()?.title, "is_free": card.is_free(), "hash": origin.hash,
                "variables": variables,
            }),
        );
    }
    Ok(())
}

/// Those in a file, as the command line names them, with the ranges of their parameters.
fn of_file(file: &str, out: &mut Output) -> Result<(), CommandError> {
    if !is_file(file) {
        let message = format!("`{file}` is no file; `mbs list` alone prints the mechanisms of the list");
        return Err(CommandError::Usage(message));
    }
    for Listed { argument, title, variables, hash } in listed(file)? {
        writeln!(out, "{argument}  {title}")?;
        let described = variables.iter().map(|variable| {
            let Variable { name, unit, default, range, tolerance, is_input } = variable;
            json!({
                "name": name, "unit": unit, "value": default, "range": range, "tolerance": tolerance, "is_input": is_input,
            })
        });
        let described: Vec<_> = described.collect();
        out.push(
            "mechanisms",
            json!({ "name": argument, "title": title, "hash": hash, "variables": described }),
        );
        let parameters = variables.iter().map(|variable| {
            let [low, high] = variable.range.map(short);
            let range =
                if variable.range[1].is_finite() { format!(" ({low} to {high})") } else { String::new() };
            format!("{}={}{}{range}", variable.name, short(variable.default), unit(&variable.unit))
        });
        let parameters = parameters.collect::<Vec<_>>().join(", ");
        if !parameters.is_empty() {
            writeln!(out, "  {parameters}")?;
        }
    }
    Ok(())
}
