//! Pictures as SVG: their common elements, and the permuted Jacobian with its blocks.

use std::fmt::Write;

use mbs_codegen::{EntryKind, StructureReport};

use crate::output::page::escaped;

/// Okabe and Ito's colours, which the colour-blind can tell apart; grey is kept for failures.
pub(crate) const COLOURS: [&str; 7] =
    ["#0072b2", "#e69f00", "#009e73", "#d55e00", "#56b4e9", "#f0e442", "#cc79a7"];
pub(crate) const FAILURE: &str = "#999999";

/// Side of an entry of the Jacobian, in pixels.
const CELL: usize = 24;

pub(crate) fn open(width: usize, height: usize) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" \
         fill=\"white\"/>\n"
    )
}

pub(crate) fn label(svg: &mut String, x: usize, y: usize, attributes: &str, text: &str) {
    let _ = writeln!(svg, "<text x=\"{x}\" y=\"{y}\" {attributes}>{}</text>", escaped(text));
}

/// Φ_q with rows and columns in the order of solution, each diagonal block in a frame.
pub fn structure(report: &StructureReport) -> String {
    let mut rows: Vec<usize> = report.blocks.iter().flat_map(|block| block.rows.iter().copied()).collect();
    let mut columns: Vec<usize> =
        report.blocks.iter().flat_map(|block| block.coordinates.iter().copied()).collect();
    let solved = columns.len();
    // Independent coordinates, and rows that no block has.
    columns
        .extend((0..report.coordinates.len()).filter(|index| !columns.contains(index)).collect::<Vec<_>>());
    rows.extend((0..report.rows.len()).filter(|index| !rows.contains(index)).collect::<Vec<_>>());
    let longest =
        |names: &mut dyn Iterator<Item = &String>| names.map(|n| n.chars().count()).max().unwrap_or(0);
    // Eight pixels a letter at 13 pixels' height.
    let left = 20 + 8 * longest(&mut report.rows.iter().map(|row| &row.name));
    let top = 20 + 8 * longest(&mut report.coordinates.iter().map(|coordinate| &coordinate.name));
    let (width, side) = (CELL * columns.len(), CELL * rows.len());
    let mut svg = open((left + width + 20).max(300), top + side + 60);
    for (place, column) in columns.iter().enumerate() {
        let (x, y) = (left + CELL * place + CELL / 2 + 4, top - 8);
        let turned = format!("transform=\"rotate(-90 {x} {y})\"");
        label(&mut svg, x, y, &turned, &report.coordinates[*column].name);
    }
    for (place, row) in rows.iter().enumerate() {
        let y = top + CELL * place;
        label(&mut svg, left - 8, y + 17, "text-anchor=\"end\"", &report.rows[*row].name);
        for (column, kind) in &report.rows[*row].entries {
            let at = columns.iter().position(|known| known == column).unwrap_or(0);
            entry(&mut svg, left + CELL * at, y, *kind);
        }
    }
    blocks(&mut svg, report, left, top);
    label(
        &mut svg,
        10,
        top + side + 25,
        "font-size=\"11\"",
        "light: a number; medium: parameters; dark: varies",
    );
    let order = match (report.blocks.is_empty(), solved < columns.len()) {
        (true, _) => {
            "rows that may follow from others: all are solved together, by orthogonal factors of any rank"
        }
        (false, true) => "framed: diagonal blocks, solved downwards; to the right of them what forces move",
        (false, false) => "framed: diagonal blocks, solved downwards",
    };
    label(&mut svg, 10, top + side + 42, "font-size=\"11\"", order);
    svg + "</svg>\n"
}

fn entry(svg: &mut String, x: usize, y: usize, kind: EntryKind) {
    let fill = match kind {
        EntryKind::Number => "#bdd7e7",
        EntryKind::Parameters => "#6baed6",
        EntryKind::Varies => "#08519c",
    };
    let size = CELL - 4;
    let _ = writeln!(
        svg,
        "<rect x=\"{}\" y=\"{}\" width=\"{size}\" height=\"{size}\" fill=\"{fill}\"/>",
        x + 2,
        y + 2
    );
}

fn blocks(svg: &mut String, report: &StructureReport, left: usize, top: usize) {
    let (width, height) = (CELL * report.coordinates.len(), CELL * report.rows.len());
    let _ = writeln!(
        svg,
        "<rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" fill=\"none\" stroke=\"#888888\"/>"
    );
    let (mut x, mut y) = (left, top);
    for block in &report.blocks {
        let (width, height) = (CELL * block.coordinates.len(), CELL * block.rows.len());
        let _ = writeln!(
            svg,
            "<rect class=\"block\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"none\" \
             stroke=\"#d55e00\" stroke-width=\"2\"/>"
        );
        (x, y) = (x + width, y + height);
    }
}
