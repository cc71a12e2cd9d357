//! Φ and its derivatives, masses and forces as a LaTeX document, ready to compile.

use std::fmt::Write;

use mbs_codegen::{DynamicFormulas, Formulas};
use mbs_runtime::Entry;

use super::matrix::short;
use crate::erased::facade::AnyEquations;

/// A matrix that is wider than the line is shrunk to it.
const PREAMBLE: &str = "\\documentclass[a4paper]{article}
\\usepackage[utf8]{inputenc}
\\usepackage{amsmath}
\\usepackage{graphicx}
\\usepackage[margin=20mm]{geometry}
\\setlength{\\parindent}{0pt}
\\newsavebox{\\wide}
\\newcommand{\\fitted}[1]{\\sbox{\\wide}{$\\displaystyle #1$}%
  \\ifdim\\wd\\wide>\\linewidth\\resizebox{\\linewidth}{!}{\\usebox{\\wide}}\\else\\usebox{\\wide}\\fi}
";

/// Value of a parameter or input.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// Unit as the text declares it.
    pub unit: String,
    /// The value in that unit, where there is one.
    pub value: Option<f64>,
}

/// Values of a mechanism's parameters and inputs, in the order of its formulas.
pub fn values(equations: &dyn AnyEquations) -> Vec<Value> {
    let value =
        |(index, entry): (usize, &Entry)| Value { unit: entry.unit.to_string(), value: equations.get(index) };
    equations.variables().iter().enumerate().map(value).collect()
}

/// The document of a mechanism from its formulas in LaTeX's spelling, with `dynamic` ones where it has masses. `values` are in the
/// order of the formulas' variables; `title` is plain text.
pub fn document(
    values: &[Value],
    formulas: &Formulas,
    dynamic: Option<&DynamicFormulas>,
    title: &str,
) -> String {
    let n = formulas.coordinates.len();
    let mut text = String::from(PREAMBLE);
    // amsmath stops at ten columns.
    let _ = writeln!(text, "\\setcounter{{MaxMatrixCols}}{{{}}}\n\\begin{{document}}", n.max(10));
    let _ = writeln!(text, "\\section*{{{}}}\n", escaped(title));
    let transposed = format!("\\begin{{bmatrix}} {} \\end{{bmatrix}}", formulas.coordinates.join(" & "));
    display(&mut text, "Generalized coordinates", &format!("\\mathbf{{q}}^T = {transposed}"));
    parameters(&mut text, values, formulas);
    let rows = formulas.rows.iter().enumerate().map(|(k, row)| format!("{}:~${row}$", k + 1));
    let _ = writeln!(text, "Rows: {}.\n\n\\bigskip", rows.collect::<Vec<_>>().join(", "));
    abbreviations(&mut text, &formulas.definitions);
    let sections = [
        ("Constraints", "\\boldsymbol{\\Phi}(\\mathbf{q}, t) =", column(&formulas.phi), " = \\mathbf{0}"),
        ("Jacobian", "\\boldsymbol{\\Phi}_{\\mathbf{q}} =", shortened("\\Phi", &formulas.phi_q), ""),
        ("Velocities", "\\boldsymbol{\\Phi}_t =", column(&formulas.phi_t), VELOCITY),
        ("Accelerations", "\\boldsymbol{\\gamma} =", column(&formulas.gamma), ACCELERATION),
    ];
    for (heading, left, middle, right) in sections {
        display(&mut text, heading, &format!("{left} {middle}{right}"));
    }
    entries(&mut text, "Jacobian", "\\Phi", &formulas.phi_q);
    display(&mut text, "with", GAMMA);
    if let Some(dynamic) = dynamic {
        masses(&mut text, dynamic);
    }
    text.push_str("\\end{document}\n");
    text
}

const VELOCITY: &str =
    ",\\qquad \\boldsymbol{\\Phi}_{\\mathbf{q}}\\,\\dot{\\mathbf{q}} = -\\boldsymbol{\\Phi}_t";
const ACCELERATION: &str =
    ",\\qquad \\boldsymbol{\\Phi}_{\\mathbf{q}}\\,\\ddot{\\mathbf{q}} = \\boldsymbol{\\gamma}";
const GAMMA: &str = "\\boldsymbol{\\gamma} = -\\left(\\boldsymbol{\\Phi}_{\\mathbf{q}}\\,\\dot{\\mathbf{q}}\\right)_{\\mathbf{q}}\\dot{\\mathbf{q}} \
     - 2\\,\\boldsymbol{\\Phi}_{\\mathbf{q}t}\\,\\dot{\\mathbf{q}} - \\boldsymbol{\\Phi}_{tt}";

const MOTION: &str = "\\mathbf{M}\\,\\ddot{\\mathbf{q}} + \\boldsymbol{\\Phi}_{\\mathbf{q}}^T\\,\\boldsymbol{\\lambda} = \\mathbf{Q}";

/// M, Q and the energies, with the equations of motion.
fn masses(text: &mut String, formulas: &DynamicFormulas) {
    display(text, "Motion", MOTION);
    abbreviations(text, &formulas.definitions);
    display(text, "Mass matrix", &format!("\\mathbf{{M}} = {}", shortened("M", &formulas.mass)));
    entries(text, "mass matrix", "M", &formulas.mass);
    display(
        text,
        "Forces, those of inertia from velocities included",
        &format!("\\mathbf{{Q}} = {}", column(&formulas.force)),
    );
    display(text, "Kinetic energy", &format!("T = {}", formulas.kinetic));
    display(text, "Potential energy", &format!("V = {}", formulas.potential));
}

fn abbreviations(text: &mut String, definitions: &[(String, String)]) {
    for (name, meaning) in definitions {
        display(text, "Abbreviation", &format!("{name} = {meaning}"));
    }
}

fn display(text: &mut String, heading: &str, formula: &str) {
    let _ =
        writeln!(text, "{heading}:\\par\\nobreak\\smallskip\\nobreak\n\\fitted{{{formula}}}\n\n\\bigskip");
}

fn column(entries: &[String]) -> String {
    format!("\\begin{{bmatrix}}\n  {}\n\\end{{bmatrix}}", entries.join(" \\\\\n  "))
}

fn matrix(rows: &[Vec<String>]) -> String {
    column(&rows.iter().map(|row| row.join(" & ")).collect::<Vec<_>>())
}

/// Letters of a line that a matrix may fill before it becomes too small to read.
const WIDEST: usize = 160;

/// `true` if a matrix written out is too wide for a page.
fn is_wide(rows: &[Vec<String>]) -> bool {
    let column = |k: usize| rows.iter().filter_map(|row| row.get(k)).map(|entry| letters(entry)).max();
    let columns = rows.first().map_or(0, Vec::len);
    (0..columns).filter_map(column).map(|width| width + 2).sum::<usize>() > WIDEST
}

/// Number of visible letters of a formula: a command counts as one, braces as none.
fn letters(formula: &str) -> usize {
    let mut count = 0;
    let mut command = false;
    for character in formula.chars() {
        command = match character {
            '\\' => true,
            c => command && c.is_ascii_alphabetic(),
        };
        count += usize::from(character == '\\' || (!command && !"{}_^, ".contains(character)));
    }
    count
}

/// A matrix written out, or, if that is too wide, with `symbol` for each entry that is not zero.
fn shortened(symbol: &str, rows: &[Vec<String>]) -> String {
    if !is_wide(rows) {
        return matrix(rows);
    }
    let sign = |row: usize, column: usize, entry: &str| match entry {
        "0" | "1" | "-1" => entry.to_string(),
        _ => format!("{symbol}_{{{},{}}}", row + 1, column + 1),
    };
    let rows = rows.iter().enumerate().map(|(row, entries)| {
        entries.iter().enumerate().map(|(column, entry)| sign(row, column, entry)).collect::<Vec<_>>()
    });
    matrix(&rows.collect::<Vec<_>>())
}

/// The entries for which a wide matrix has symbols.
fn entries(text: &mut String, name: &str, symbol: &str, rows: &[Vec<String>]) {
    if !is_wide(rows) {
        return;
    }
    let _ = writeln!(text, "Entries of the {name}:\n\n\\smallskip");
    for (row, entries) in rows.iter().enumerate() {
        for (column, entry) in
            entries.iter().enumerate().filter(|(_, e)| !matches!(e.as_str(), "0" | "1" | "-1"))
        {
            let _ = writeln!(text, "\\fitted{{{symbol}_{{{},{}}} = {entry}}}\n", row + 1, column + 1);
        }
    }
    text.push_str("\\bigskip\n");
}

fn parameters(text: &mut String, values: &[Value], formulas: &Formulas) {
    let entries = values.iter().zip(&formulas.variables);
    let list: Vec<String> = entries
        .filter_map(|(entry, symbol)| {
            let value = short(entry.value?);
            let value = match value.split_once('e') {
                Some((digits, exponent)) => format!("{digits} \\cdot 10^{{{exponent}}}"),
                None => value,
            };
            let unit = if entry.unit == "1" { String::new() } else { format!("\\,{}", unit(&entry.unit)) };
            Some(format!("${symbol} = {value}{unit}$"))
        })
        .collect();
    if !list.is_empty() {
        let _ = writeln!(text, "Parameters: {}.\n\n\\bigskip", list.join(", "));
    }
}

/// `kg*m^2/s` → `\mathrm{kg\,m^{2}/s}`.
fn unit(unit: &str) -> String {
    let mut text = String::from("\\mathrm{");
    let mut characters = unit.chars().peekable();
    while let Some(character) = characters.next() {
        match character {
            '*' => text.push_str("\\,"),
            '^' => {
                text.push_str("^{");
                while let Some(digit) = characters.next_if(|c| c.is_ascii_digit() || *c == '-') {
                    text.push(digit);
                }
                text.push('}');
            }
            other => text.push(other),
        }
    }
    text + "}"
}

/// Plain text in LaTeX.
fn escaped(text: &str) -> String {
    text.chars()
        .map(|character| match character {
            '\\' => "\\textbackslash{}".to_string(),
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => format!("\\{character}"),
            '~' => "\\textasciitilde{}".to_string(),
            '^' => "\\textasciicircum{}".to_string(),
            other => other.to_string(),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wide_jacobian_is_written_with_signs() {
        let rows = |width: usize| [vec!["a".repeat(width), "0".into()], vec!["1".into(), "\\sin x".into()]];
        assert!(!is_wide(&rows(20)) && shortened("\\Phi", &rows(20)).contains("aaa"));
        let wide = shortened("\\Phi", &rows(200));
        assert!(wide.contains("\\Phi_{1,1} & 0") && wide.contains("1 & \\Phi_{2,2}"), "{wide}");
        assert_eq!(letters("L_{1}\\,\\sin \\varphi_{1}"), 6);
    }

    #[test]
    fn units_and_titles_are_spelled_for_latex() {
        assert_eq!(unit("kg*m^2/s"), "\\mathrm{kg\\,m^{2}/s}");
        assert_eq!(escaped("a_b & 5%"), "a\\_b \\& 5\\%");
    }
}
