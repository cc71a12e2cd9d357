//! `mbs list`.

use std::io::Write;

use mechanisms::registry::{ALL, FREE, equations};

use super::CommandError;

/// Names, headings and parameters of all mechanisms.
pub fn run(out: &mut dyn Write) -> Result<(), CommandError> {
    let fixed = ALL.iter().map(|card| (card.name, card.title.to_owned()));
    let free = FREE.iter().map(|card| (card.name, format!("{} (free to move)", card.title)));
    let cards: Vec<(&str, String)> = fixed.chain(free).collect();
    let width = cards.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    for (name, title) in cards {
        writeln!(out, "{name:width$}  {title}")?;
        let mechanism = equations(name)?;
        let parameters = mechanism.variables().iter().enumerate().map(|(index, entry)| {
            let value = mechanism.get(index).unwrap_or(f64::NAN);
            format!("{}={}{}", entry.name, super::table::short(value), super::table::unit(entry.unit))
        });
        writeln!(out, "{:width$}  {}", "", parameters.collect::<Vec<_>>().join(", "))?;
    }
    Ok(())
}
