//! `mbs structure`.

use crate::catalogue::Catalogue;
use std::io::Write;
use std::path::PathBuf;

use crate::output::matrix::Named;
use crate::output::svg;
use clap::Args;
use mbs_codegen::{BlockReport, EntryKind, StructureReport};
use serde_json::json;

use super::CommandError;
use super::chosen::{Chosen, require_named, svg_file, write_file};
use super::document::Output;
use super::text::Text;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    pub chosen: Chosen,
    /// Draw the ordered Jacobian with its blocks
    #[arg(long, value_name = "FILE.svg", value_parser = svg_file)]
    out: Option<PathBuf>,
}

/// Sparsity, matching and the order of solution.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    require_named(arguments.out.as_ref())?;
    let text = Text::find(catalogue, &arguments.chosen)?;
    let report = text.structure()?;
    let origin = text.put(out);
    describe_in(out, &report);
    let entries: usize = report.rows.iter().map(|row| row.entries.len()).sum();
    let (m, n) = (report.rows.len(), report.coordinates.len());
    writeln!(out, "{}\n", text.title)?;
    let title = format!(
        "Phi_q: {m} × {n}, {entries} of {} entries (1: a number, p: parameters alone, x: varies; in brackets: \
         the coordinate that a row is matched with)",
        m * n
    );
    for line in sparsity(&report, title).lines() {
        writeln!(out, "{line}")?;
    }
    if report.blocks.is_empty() && m > 0 {
        writeln!(
            out,
            "\nsolved together: all {m} rows for what moves on {n} coordinates, by orthogonal factors of any rank; of rows that may \
             follow from others no square blocks are made"
        )?;
    } else {
        writeln!(out, "\nsolved block after block")?;
    }
    for (number, block) in report.blocks.iter().enumerate() {
        writeln!(out, "  {}. {}", number + 1, describe(&report, block))?;
    }
    let solved: Vec<usize> =
        report.blocks.iter().flat_map(|block| block.coordinates.iter().copied()).collect();
    let given: Vec<&str> = (0..n)
        .filter(|index| !solved.contains(index))
        .map(|index| report.coordinates[index].name.as_str())
        .collect();
    if !given.is_empty() && !report.blocks.is_empty() {
        writeln!(out, "independent: {}, which forces move", given.join(", "))?;
    }
    if let Some(path) = &arguments.out {
        write_file(path, &origin.svg(&svg::structure(&report)))?;
        out.put_file("picture", path);
        writeln!(out, "\npicture  {}", path.display())?;
    }
    Ok(())
}

/// Rows, coordinates and blocks as data; blocks in the order in which they are solved.
fn describe_in(out: &mut Output, report: &StructureReport) {
    let name = |index: &usize| report.coordinates[*index].name.as_str();
    let kind = |kind: &EntryKind| match kind {
        EntryKind::Number => "number",
        EntryKind::Parameters => "parameters",
        EntryKind::Varies => "varies",
    };
    for coordinate in &report.coordinates {
        out.push("coordinates", json!({ "name": coordinate.name, "unit": coordinate.unit }));
    }
    for row in &report.rows {
        let entry =
            |(column, of): &(usize, EntryKind)| json!({ "coordinate": name(column), "kind": kind(of) });
        out.push(
            "rows",
            json!({
                "name": row.name, "unit": row.unit, "is_drive": row.driven, "is_redundant": row.redundant,
                "matched": row.matched.as_ref().map(name), "entries": row.entries.iter().map(entry).collect::<Vec<_>>(),
            }),
        );
    }
    out.put("blocks", json!([]));
    for block in &report.blocks {
        let rows: Vec<&str> = block.rows.iter().map(|row| report.rows[*row].name.as_str()).collect();
        let coordinates: Vec<&str> = block.coordinates.iter().map(name).collect();
        out.push(
            "blocks",
            json!({ "rows": rows, "coordinates": coordinates, "is_explicit": block.explicit, "dyad": block.dyad }),
        );
    }
    out.put("operations", report.operations);
}

fn sparsity(report: &StructureReport, title: String) -> Named {
    let cell = |row: usize, column: usize| {
        let row = &report.rows[row];
        let mark = match row.entries.iter().find(|(known, _)| *known == column) {
            None => ".",
            Some((_, EntryKind::Number)) => "1",
            Some((_, EntryKind::Parameters)) => "p",
            Some((_, EntryKind::Varies)) => "x",
        };
        if row.matched == Some(column) { format!("[{mark}]") } else { format!("{mark} ") }
    };
    let columns = report.coordinates.len();
    Named {
        title,
        rows: report.rows.iter().map(|row| row.name.clone()).collect(),
        columns: report.coordinates.iter().map(|coordinate| coordinate.name.clone()).collect(),
        cells: (0..report.rows.len())
            .map(|row| (0..columns).map(|column| cell(row, column)).collect())
            .collect(),
        ..Named::default()
    }
}

fn describe(report: &StructureReport, block: &BlockReport) -> String {
    let coordinates: Vec<&str> =
        block.coordinates.iter().map(|index| report.coordinates[*index].name.as_str()).collect();
    let rows: Vec<&str> = block.rows.iter().map(|index| report.rows[*index].name.as_str()).collect();
    let (size, unknowns) = (block.rows.len(), block.coordinates.len());
    let how = match (block.explicit, size) {
        (true, _) => "explicit: assigned".to_string(),
        (false, _) if size > unknowns => {
            format!("{size} × {unknowns}: rows may follow from others; Gauss–Newton, by orthogonal factors")
        }
        (false, 1..=2) if block.dyad.is_some() => {
            let name = block.dyad.unwrap_or_default();
            format!(
                "{size} × {size}: {name}, assembled from both its positions; Newton, linear step in closed form"
            )
        }
        (false, 1..=3) => format!("{size} × {size}: Newton, linear step in closed form"),
        (false, _) => format!("{size} × {size}: Newton, linear step by {}", block.elimination),
    };
    format!("{} from {} ({how})", coordinates.join(", "), rows.join(", "))
}
