//! `mbs dof`.

use crate::catalogue::Catalogue;
use std::io::Write;

use crate::teaching::freedom::{Freedom, freedom};
use crate::text_file::is_file;
use clap::Args;
use mbs_codegen::{Mobility, StructureReport};
use serde_json::json;

use super::CommandError;
use super::chosen::{Chosen, finite};
use super::document::Output;
use super::text::Text;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    pub chosen: Chosen,
    /// Time (s) of the position [default: 0; of a file none, and ranks are those that the sparsity allows]
    #[arg(long, value_name = "T", value_parser = finite, allow_negative_numbers = true)]
    pub at: Option<f64>,
}

/// Reason why coordinates less constraints equal Grübler's count.
const GRUBLER: &str = "Grübler counts 3 a body less 2 a joint; each set of coordinates leaves out as many freedoms of bodies as \
                       equations\nof joints, so that n − constraints is that count. Rows that follow from others count too.";

/// Counts, ranks, independent and dependent coordinates.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    if is_file(arguments.chosen.name()) && arguments.chosen.is_plain() && arguments.at.is_none() {
        return counts(&Text::find(catalogue, &arguments.chosen)?, out);
    }
    let at = arguments.at.unwrap_or(0.0);
    let choice = arguments.chosen.described(catalogue)?;
    let mechanism = choice.equations();
    let report = choice.structure()?;
    let state = choice.state(at)?;
    let found = freedom(mechanism, &report, &state.q, at);
    out.put_mechanism(&choice.target, mechanism);
    writeln!(out, "{} at t = {} s\n", choice.target.title(), at)?;
    let Freedom { coordinates: n, constraints, drives, structural_rank, rank, whole_rank, .. } = found;
    writeln!(out, "coordinates n                {n}")?;
    let named = |indices: &[usize]| -> Vec<&str> {
        indices.iter().map(|index| mechanism.coordinates()[*index].name).collect()
    };
    let follows: Vec<&str> = found.redundant.iter().map(|row| mechanism.rows()[*row].name).collect();
    for (field, value) in [
        ("t", json!(at)),
        ("coordinates", json!(n)),
        ("constraints", json!(constraints)),
        ("drives", json!(drives)),
        ("rank_of_constraints", json!(rank)),
        ("largest_rank_of_constraints", json!(structural_rank)),
        ("rank", json!(whole_rank)),
        ("freedom", json!(n - rank)),
        ("grubler", json!(report.mobility.grubler())),
        ("independent", json!(named(&found.independent))),
        ("dependent", json!(named(&found.dependent))),
        ("redundant_rows", json!(follows)),
    ] {
        out.put(field, value);
    }
    writeln!(
        out,
        "rows m                       {} ({constraints} of constraints, {drives} of drives)",
        constraints + drives
    )?;
    writeln!(out, "rank of the constraints      {rank} here; their sparsity allows {structural_rank}")?;
    // Rows that may follow from others have less rank than their sparsity allows; the missing rank is freedom.
    let redundant = drives == 0 && report.rows.iter().any(|row| row.redundant);
    let free = whole_rank == report.mobility.rank || redundant;
    writeln!(out, "rank with the drives         {whole_rank}{}", whole(whole_rank == n, free))?;
    writeln!(out, "degrees of freedom           {n} − {rank} = {}", n - rank)?;
    writeln!(out, "Grübler's count              {n} − {constraints} = {}", report.mobility.grubler())?;
    let entries = mechanism.coordinates();
    let names = |indices: &[usize]| match indices {
        [] => "none".to_string(),
        _ => indices.iter().map(|index| entries[*index].name).collect::<Vec<_>>().join(", "),
    };
    writeln!(out, "independent coordinates      {}", names(&found.independent))?;
    writeln!(out, "dependent coordinates        {}", names(&found.dependent))?;
    let rows = mechanism.rows();
    for row in &found.redundant {
        writeln!(out, "row {} (line {}) follows from the others here", rows[*row].name, rows[*row].line)?;
    }
    writeln!(out, "\n{}", reason(found.declared, &report, &names(&report.independent)))?;
    writeln!(out, "{GRUBLER}")?;
    if let Some(taken) = report.mobility.taken() {
        writeln!(out, "{}", apart(&report.mobility, taken))?;
    }
    Ok(())
}

/// Counts that the text alone gives, without a position.
fn counts(text: &Text, out: &mut Output) -> Result<(), CommandError> {
    let report = text.structure()?;
    let Mobility { coordinates: n, constraints, drives, constraint_rank, rank, .. } = report.mobility;
    text.put(out);
    let independent: Vec<&str> =
        report.independent.iter().map(|index| report.coordinates[*index].name.as_str()).collect();
    for (field, value) in [
        ("t", json!(null)),
        ("coordinates", json!(n)),
        ("constraints", json!(constraints)),
        ("drives", json!(drives)),
        ("largest_rank_of_constraints", json!(constraint_rank)),
        ("largest_rank", json!(rank)),
        ("least_freedom", json!(n - constraint_rank)),
        ("grubler", json!(report.mobility.grubler())),
        ("independent", json!(independent)),
    ] {
        out.put(field, value);
    }
    writeln!(out, "{}\n", text.title)?;
    writeln!(out, "coordinates n                {n}")?;
    writeln!(
        out,
        "rows m                       {} ({constraints} of constraints, {drives} of drives)",
        constraints + drives
    )?;
    writeln!(out, "rank of the constraints      at most {constraint_rank}, by their sparsity")?;
    writeln!(out, "rank with the drives         at most {rank}, by their sparsity")?;
    writeln!(out, "degrees of freedom           at least {n} − {constraint_rank} = {}", n - constraint_rank)?;
    writeln!(out, "Grübler's count              {n} − {constraints} = {}", report.mobility.grubler())?;
    let named: Vec<&str> =
        report.independent.iter().map(|index| report.coordinates[*index].name.as_str()).collect();
    let named = if named.is_empty() { "none are named".to_string() } else { named.join(", ") };
    writeln!(out, "independent coordinates      {named}")?;
    writeln!(out, "\n{GRUBLER}")?;
    if let Some(taken) = report.mobility.taken() {
        writeln!(out, "{}", apart(&report.mobility, taken))?;
    }
    writeln!(out, "Ranks at a position: `mbs dof {} --at 0`.", text.name)?;
    Ok(())
}

/// Degrees of freedom of the declared bodies without joints, of which joints and guides take `taken`.
fn apart(mobility: &Mobility, taken: usize) -> String {
    let Mobility { bodies, points, apart, energies, .. } = *mobility;
    let some = |count: usize, one: &str, many: &str| match count {
        0 => None,
        1 => Some(format!("1 {one}")),
        _ => Some(format!("{count} {many}")),
    };
    let counted =
        [some(bodies, "body that turns", "bodies that turn"), some(points, "point mass", "point masses")];
    let counted: Vec<String> = counted.into_iter().flatten().collect();
    let have = if bodies + points == 1 { "has" } else { "have" };
    let counted = counted.join(" and ");
    let mut text = format!(
        "Of the bodies that the text declares {counted} {have} {apart} freedoms apart; joints and guides take {taken}."
    );
    if points > 0 && energies > 0 {
        text.push_str(
            "\nA point mass has no angle: where its body turns with an energy of its own (`kinetic`), the freedom of turning \
             and the\nequation that ties it to the coordinates are in neither number.",
        );
    }
    text
}

/// Origin of the choice of independent coordinates: the text, the drives or the program.
fn reason(declared: bool, report: &StructureReport, named: &str) -> String {
    match (declared, report.independent.is_empty()) {
        (true, _) => "Independent as the text declares them.".into(),
        (false, true) if report.mobility.drives == 0 => {
            "Chosen, for the text names none and no drive prescribes one.".into()
        }
        (false, true) => {
            "Chosen, for the text names none: the coordinates that drives prescribe, as far as the others \
                          then follow."
                .into()
        }
        (false, false) => format!(
            "Chosen, for those that the text names ({named}) do not determine the others at this position: as many of \
             them as do."
        ),
    }
}

fn whole(determined: bool, free: bool) -> &'static str {
    match (determined, free) {
        (true, _) => ": every coordinate is determined",
        (false, true) => ": forces move the others",
        (false, false) => ": the position is singular",
    }
}
