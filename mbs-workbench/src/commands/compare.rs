//! `mbs compare`.

use crate::catalogue::Catalogue;
use std::io::Write;

use crate::card::Card;
use crate::catalogue::KINDS;
use crate::mismatch::Mismatch;
use crate::output::origin::Origin;
use crate::teaching::comparison::{Candidate, ComparisonFault, candidate, difference};
use crate::text_file::is_file;
use clap::Args;
use serde_json::json;

use super::document::Output;
use super::{CommandError, positive};

/// The point whose motion is compared.
const POINT: &str = "P";

#[derive(Args)]
pub struct Arguments {
    /// Name of the mechanism, as `mbs list` prints it
    pub name: String,
    /// Kinds of coordinates: `natural` stands for the mechanism NAME_natural, `relative` for NAME itself where there
    /// is no NAME_relative
    #[arg(long, value_delimiter = ',', default_values = KINDS)]
    coordinates: Vec<String>,
    /// Equal steps that the motion is divided into
    #[arg(long, default_value_t = 720, value_parser = positive)]
    steps: usize,
}

/// Prints the cost of each set of coordinates and the differences between their motions.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    if is_file(&arguments.name) {
        let reason = "kinds of coordinates are variants in the list of mechanisms, and a file has one text of them; name one of `mbs list`";
        return Err(CommandError::Usage(reason.to_string()));
    }
    let cards = arguments.coordinates.iter().map(|kind| catalogue.variant(&arguments.name, kind));
    let cards = cards.collect::<Result<Vec<&Card>, Mismatch>>()?;
    let mut candidates = Vec::new();
    for card in cards {
        candidates.push(candidate(card, arguments.steps).map_err(|fault| explain(card, fault))?);
    }
    let width = candidates.iter().map(|c| c.name.len()).max().unwrap_or(0);
    writeln!(
        out,
        "{:width$}   n   m  entries  largest block  operations  time a step  condition   margin",
        "coordinates"
    )?;
    for candidate in &candidates {
        write_line(out, candidate, width)?;
        let Candidate { name, coordinates, rows, entries, largest_block, operations, .. } = candidate;
        let source = catalogue.find(name)?.equations().source();
        out.push(
            "candidates",
            json!({
                "name": name, "hash": Origin::of_text(name, source).hash, "coordinates": coordinates, "rows": rows,
                "entries": entries, "largest_block": largest_block, "operations": operations,
                "step_time": candidate.step_time.as_secs_f64(), "condition": candidate.condition,
                "margin": candidate.margin,
            }),
        );
    }
    writeln!(
        out,
        "\nentries: of Phi_q that are not structurally zero; operations: of a step with one iteration of every block;\n\
         condition: the largest of Phi_q over the motion, in the reference metric; margin: the smallest to singularity"
    )?;
    let Some((first, others)) = candidates.split_first() else { return Ok(()) };
    for other in others {
        if let Some([place, velocity, acceleration]) = difference(&first.motion, &other.motion, POINT) {
            out.push(
                "differences",
                json!({
                    "of": other.name, "against": first.name, "point": POINT, "position": place, "velocity": velocity,
                    "acceleration": acceleration,
                }),
            );
        }
        match difference(&first.motion, &other.motion, POINT) {
            Some([place, velocity, acceleration]) => writeln!(
                out,
                "{POINT} in {} against {}: position {place:.1e}, velocity {velocity:.1e}, acceleration {acceleration:.1e} \
                 of the largest",
                other.name, first.name
            )?,
            None => writeln!(out, "{} or {} has no output {POINT} to compare", first.name, other.name)?,
        }
    }
    Ok(())
}

fn explain(card: &Card, fault: ComparisonFault) -> CommandError {
    match fault {
        ComparisonFault::Mismatch(mismatch) => mismatch.into(),
        ComparisonFault::Failure(failure) => CommandError::Failed(format!("{}: {failure}", card.name())),
        ComparisonFault::Text(text) => CommandError::Failed(text),
    }
}

fn write_line(out: &mut dyn Write, candidate: &Candidate, width: usize) -> std::io::Result<()> {
    let Candidate { name, coordinates, rows, entries, largest_block, operations, .. } = candidate;
    let time = format!("{:.2} µs", candidate.step_time.as_secs_f64() * 1e6);
    writeln!(
        out,
        "{name:width$}  {coordinates:>2}  {rows:>2}  {entries:>7}  {largest_block:>13}  {operations:>10}  {time:>11}  \
         {:>9.1}  {:>7.3}",
        candidate.condition, candidate.margin
    )
}
