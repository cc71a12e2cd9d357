//! `mbs list`.

use crate::catalogue::Catalogue;
use std::io::Write;

use super::CommandError;

/// Names, headings and parameters of all mechanisms.
pub fn run(catalogue: &Catalogue, out: &mut dyn Write) -> Result<(), CommandError> {
    let width = catalogue.names().map(|name| name.len()).max().unwrap_or(0);
    for card in catalogue.iter() {
        let free = if card.is_free() { " (free to move)" } else { "" };
        writeln!(out, "{:width$}  {}{free}", card.name(), card.picture()?.title)?;
        let mechanism = card.equations();
        let parameters = mechanism.variables().iter().enumerate().map(|(index, entry)| {
            let value = mechanism.get(index).unwrap_or(f64::NAN);
            format!("{}={}{}", entry.name, super::summary::short(value), super::summary::unit(entry.unit))
        });
        writeln!(out, "{:width$}  {}", "", parameters.collect::<Vec<_>>().join(", "))?;
    }
    Ok(())
}
