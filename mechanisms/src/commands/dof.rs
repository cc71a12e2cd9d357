//! `mbs dof`.

use std::io::Write;

use clap::Args;
use mbs_codegen::StructureReport;
use mechanisms::lecture::freedom::{Freedom, freedom};

use super::CommandError;
use super::chosen::{Chosen, finite};

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    chosen: Chosen,
    /// Time (s) of the position
    #[arg(long, value_name = "T", default_value_t = 0.0, value_parser = finite, allow_negative_numbers = true)]
    at: f64,
}

/// Counts, ranks, independent and dependent coordinates.
pub fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<(), CommandError> {
    let choice = arguments.chosen.choice()?;
    let mechanism = choice.mechanism.as_ref();
    let report = mbs_codegen::structure_of(mechanism.source(), Some(mechanism.scene()))
        .map_err(CommandError::Failed)?;
    let state = choice.state(arguments.at)?;
    let found = freedom(mechanism, &report, &state.q, arguments.at);
    writeln!(out, "{} at t = {} s\n", choice.card.title, arguments.at)?;
    let Freedom { coordinates: n, constraints, drives, structural_rank, rank, whole_rank, .. } = found;
    writeln!(out, "coordinates n                {n}")?;
    writeln!(
        out,
        "rows m                       {} ({constraints} of constraints, {drives} of drives)",
        constraints + drives
    )?;
    writeln!(out, "rank of the constraints      {rank} here; their sparsity allows {structural_rank}")?;
    writeln!(out, "rank with the drives         {whole_rank}{}", whole(whole_rank, n))?;
    writeln!(out, "degrees of freedom           {n} − {rank} = {}", n - rank)?;
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
    let count = i64::try_from(n).unwrap_or(i64::MAX) - i64::try_from(constraints).unwrap_or(i64::MAX);
    writeln!(
        out,
        "Grübler's count needs bodies and joints, which the text does not name; its rows count in their place:\n\
         n − constraints = {n} − {constraints} = {count}, the degrees of freedom where no row follows from the others."
    )?;
    Ok(())
}

/// Where the choice of the independent coordinates comes from.
fn reason(declared: bool, report: &StructureReport, named: &str) -> String {
    match (declared, report.independent.is_empty()) {
        (true, _) => "Independent as the text declares them.".into(),
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

fn whole(rank: usize, n: usize) -> &'static str {
    if rank == n { ": every coordinate is determined" } else { ": the position is singular" }
}
