//! The matrix of a list of cases as a picture in SVG.

use core::fmt::Write;

use crate::hard_cases::result::{Picture, Shown};
use crate::hard_cases::verdict::Verdict;
use crate::output::page::escaped;

/// Height of a row and width of a column.
const ROW: usize = 20;
const COLUMN: usize = 46;

/// Width of a letter, and how far it rises in a name that leans by 35°.
const LETTER: f64 = 7.0;
const RISE: f64 = 4.1;

/// Characters of the longest name.
fn longest(names: &[String]) -> f64 {
    names.iter().map(|name| name.chars().count()).max().unwrap_or(0) as f64
}

/// Colour and mark of a place: colours that differ for the colour-blind, marks without them.
fn look(verdict: Verdict, is_expected: bool) -> (&'static str, &'static str) {
    match (verdict, is_expected) {
        (Verdict::Right, _) => ("#0072b2", "✓"),
        (Verdict::Late, _) => ("#e69f00", "◷"),
        (Verdict::Refused, true) => ("#8a8f99", "–"),
        (Verdict::Refused, false) => ("#b8bcc4", "?"),
        (Verdict::Wrong, _) => ("#d55e00", "✗"),
    }
}

/// The picture.
pub fn svg(picture: &Picture<'_>, sentence: &str) -> String {
    // Room for the names of rows and of columns.
    let names = (LETTER * longest(picture.rows)) as usize + 20;
    let heads = (RISE * longest(picture.columns)) as usize + 24;
    let width = (names + COLUMN * picture.columns.len() + 130).max(520);
    let height = heads + ROW * picture.rows.len() + 54;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"system-ui, sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    for (column, name) in picture.columns.iter().enumerate() {
        let x = names + COLUMN * column + COLUMN / 2;
        let y = heads - 8;
        // Writing to a string succeeds.
        let _ = writeln!(
            text,
            "<text x=\"{x}\" y=\"{y}\" transform=\"rotate(-35 {x} {y})\" fill=\"#1c2330\">{}</text>",
            escaped(name)
        );
    }
    for (row, name) in picture.rows.iter().enumerate() {
        let y = heads + ROW * row;
        let _ = writeln!(
            text,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"end\" fill=\"#1c2330\">{}</text>",
            names - 8,
            y + 14,
            escaped(name)
        );
        for (column, cell) in picture.cells[row].iter().enumerate() {
            let x = names + COLUMN * column;
            let Some(Shown { worst, is_expected, counts: [count, all] }) = cell else { continue };
            let (colour, mark) = look(*worst, *is_expected);
            let is_part = count < all;
            let mark = if is_part { format!("{count}/{all}") } else { mark.to_string() };
            // All variants as its width, those with the worst verdict on the right.
            let wide = COLUMN - 2;
            let part = if is_part { (wide * count).div_ceil((*all).max(1)) } else { wide };
            let parts = [(look(Verdict::Right, true).0, 0, wide), (colour, wide - part, part)];
            for (colour, left, width) in parts.into_iter().skip(usize::from(!is_part)) {
                let _ = writeln!(
                    text,
                    "<rect x=\"{}\" y=\"{}\" width=\"{width}\" height=\"{}\" rx=\"3\" fill=\"{colour}\"/>",
                    x + 1 + left,
                    y + 1,
                    ROW - 2
                );
            }
            let _ = writeln!(
                text,
                "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\" fill=\"#fff\" font-weight=\"700\">{mark}</text>",
                x + COLUMN / 2,
                y + 14
            );
        }
    }
    let y = heads + ROW * picture.rows.len() + 22;
    let legend = [
        (Verdict::Right, true, "right"),
        (Verdict::Late, true, "late"),
        (Verdict::Refused, true, "refused, as foreseen; 2/8: two of eight variants"),
        (Verdict::Refused, false, "refused"),
        (Verdict::Wrong, true, "wrong"),
    ];
    let mut x = 12;
    for (verdict, is_expected, name) in legend {
        let (colour, mark) = look(verdict, is_expected);
        let _ = writeln!(
            text,
            "<rect x=\"{x}\" y=\"{}\" width=\"20\" height=\"18\" rx=\"3\" fill=\"{colour}\"/>\
             <text x=\"{}\" y=\"{y}\" text-anchor=\"middle\" fill=\"#fff\" font-weight=\"700\">{mark}</text>\
             <text x=\"{}\" y=\"{y}\" fill=\"#66707f\">{name}</text>",
            y - 14,
            x + 10,
            x + 26
        );
        x += 44 + 6 * name.len();
    }
    let _ = writeln!(text, "<text x=\"12\" y=\"{}\" fill=\"#66707f\">{}</text>", y + 24, escaped(sentence));
    text + "</svg>\n"
}
