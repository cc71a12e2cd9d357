//! `mbs list`.

use std::io::Write;

use mechanisms::registry::ALL;

use super::CommandError;

/// Names, headings and parameters of all mechanisms.
pub fn run(out: &mut dyn Write) -> Result<(), CommandError> {
    let width = ALL.iter().map(|card| card.name.len()).max().unwrap_or(0);
    for card in ALL {
        writeln!(out, "{:width$}  {}", card.name, card.title)?;
        let mechanism = (card.make)();
        let parameters = mechanism.variables().iter().enumerate().map(|(index, entry)| {
            let value = mechanism.get(index).unwrap_or(f64::NAN);
            format!("{}={}{}", entry.name, super::table::short(value), super::table::unit(entry.unit))
        });
        writeln!(out, "{:width$}  {}", "", parameters.collect::<Vec<_>>().join(", "))?;
    }
    Ok(())
}
