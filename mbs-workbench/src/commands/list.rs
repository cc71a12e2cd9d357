//! `mbs list`.

use std::io::Write;

use clap::Args;

use super::CommandError;
use super::summary::{short, unit};
use crate::catalogue::Catalogue;
use crate::text_file::{Listed, is_file, listed};

#[derive(Args, Default)]
pub struct Arguments {
    /// List the mechanisms and scenes in a file instead
    file: Option<String>,
}

/// Names, headings and parameters of all mechanisms of the list, or of those in a file.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut dyn Write) -> Result<(), CommandError> {
    if let Some(file) = &arguments.file {
        return of_file(file, out);
    }
    let width = catalogue.names().map(|name| name.len()).max().unwrap_or(0);
    for card in catalogue.iter() {
        let free = if card.is_free() { " (free to move)" } else { "" };
        writeln!(out, "{:width$}  {}{free}", card.name(), card.picture()?.title)?;
        let mechanism = card.equations();
        let parameters = mechanism.variables().iter().enumerate().map(|(index, entry)| {
            let value = mechanism.get(index).unwrap_or(f64::NAN);
            format!("{}={}{}", entry.name, short(value), unit(entry.unit))
        });
        writeln!(out, "{:width$}  {}", "", parameters.collect::<Vec<_>>().join(", "))?;
    }
    Ok(())
}

/// Those in a file, as the command line names them, with the ranges of their parameters.
fn of_file(file: &str, out: &mut dyn Write) -> Result<(), CommandError> {
    if !is_file(file) {
        let message = format!("`{file}` is no file; `mbs list` alone prints the mechanisms of the list");
        return Err(CommandError::Usage(message));
    }
    for Listed { argument, title, variables } in listed(file)? {
        writeln!(out, "{argument}  {title}")?;
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
