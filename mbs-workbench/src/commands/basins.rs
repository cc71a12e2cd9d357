//! `mbs basins`.

use crate::catalogue::Catalogue;
use std::io::Write;
use std::path::PathBuf;

use crate::target_directory::target_directory;
use crate::teaching::basins::{Axis, BasinMethod, Basins, basins};
use crate::teaching::basins_picture::{self, describe, heading};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use super::CommandError;
use super::chosen::{Choice, Chosen, finite, require_named, svg_file, write_file};
use super::document::Output;

/// Guesses along an axis, at most: the picture stays below 2 MB.
const LARGEST: usize = 400;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    pub chosen: Chosen,
    /// Coordinate across [default: the first of the largest block]
    #[arg(long, value_name = "NAME")]
    x: Option<String>,
    /// Coordinate upwards [default: the second of the largest block]
    #[arg(long, value_name = "NAME")]
    y: Option<String>,
    /// Guesses along each axis
    #[arg(long, default_value_t = 200, value_parser = size)]
    size: usize,
    /// Time (s) of the position
    #[arg(long, value_name = "T", default_value_t = 0.0, value_parser = finite, allow_negative_numbers = true)]
    at: f64,
    /// File of the picture [default: mbs/NAME/basins.svg in cargo's target directory]
    #[arg(long, value_name = "FILE.svg", value_parser = svg_file)]
    out: Option<PathBuf>,
}

fn size(text: &str) -> Result<usize, String> {
    match super::positive(text)? {
        size if size > LARGEST => Err(format!("at most {LARGEST} guesses along an axis")),
        size => Ok(size),
    }
}

/// Shares of the assemblies by each method, and the picture.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    require_named(arguments.out.as_ref())?;
    let choice = arguments.chosen.choice(catalogue)?;
    let mechanism = choice.mechanism.as_ref();
    let axes = axes(arguments, &choice)?.map(|coordinate| Axis::of(mechanism, coordinate));
    let maps = if mechanism.experiment().branches().is_empty() { 2 } else { 3 };
    let style =
        ProgressStyle::with_template("{bar:30} {pos}/{len} rows of guesses").expect("a valid template");
    let bar = ProgressBar::new((maps * arguments.size) as u64).with_style(style);
    let found =
        basins(mechanism, axes, arguments.size, arguments.at, &mut |row| bar.set_position(row as u64));
    bar.finish_and_clear();
    let standard = || target_directory().join("mbs").join(choice.target.file_name()).join("basins.svg");
    let path = arguments.out.clone().unwrap_or_else(standard);
    // Before the table, which may meet a reader that has left.
    let origin = out.put_mechanism(&choice.target, mechanism);
    let written = write_file(&path, &origin.svg(&basins_picture::basins(mechanism, &found)));
    let [across, up] = axes.map(|axis| mechanism.coordinates()[axis.coordinate].name);
    writeln!(out, "{} at t = {} s", choice.target.title(), arguments.at)?;
    writeln!(
        out,
        "{0} × {0} guesses of {across} and {up}; the other coordinates start as the text says\n",
        arguments.size
    )?;
    out.put("t", arguments.at);
    out.put("size", arguments.size);
    out.put("axes", json!([across, up]));
    let shares = |solution: Option<usize>| -> serde_json::Map<String, serde_json::Value> {
        found.maps.iter().map(|map| (word(map.method).to_string(), json!(map.share(solution)))).collect()
    };
    for (index, solution) in found.solutions.iter().enumerate() {
        out.push(
            "assemblies",
            json!({ "q": solution.q, "is_declared": solution.is_declared(), "shares": shares(Some(index)) }),
        );
    }
    out.put("not_found", shares(None));
    write_shares(out, &choice, &found)?;
    written?;
    out.put_file("picture", &path);
    writeln!(out, "\npicture  {}", path.display())?;
    Ok(())
}

/// Name of a method in the document.
fn word(method: BasinMethod) -> &'static str {
    match method {
        BasinMethod::Plain => "newton_raphson",
        BasinMethod::Assemble => "assemble",
        BasinMethod::Declared => "assemble_declared",
    }
}

/// Coordinates of the axes: those of the command line, else the first two of the largest block, filled up from the others.
fn axes(arguments: &Arguments, choice: &Choice) -> Result<[usize; 2], CommandError> {
    let report = choice.structure()?;
    let largest = report.blocks.iter().filter(|block| !block.explicit).max_by_key(|block| block.rows.len());
    let mut order: Vec<usize> = largest.map(|block| block.coordinates.clone()).unwrap_or_default();
    order.extend((0..report.coordinates.len()).filter(|index| !order.contains(index)).collect::<Vec<_>>());
    let named = |name: &Option<String>| name.as_ref().map(|name| choice.coordinate(name)).transpose();
    let (x, y) = (named(&arguments.x)?, named(&arguments.y)?);
    let free = |taken: Option<usize>| order.iter().copied().find(|index| Some(*index) != taken);
    let x = x.or_else(|| free(y));
    let y = y.or_else(|| free(x));
    match (x, y) {
        (Some(x), Some(y)) if x != y => Ok([x, y]),
        (Some(_), Some(_)) => Err(CommandError::Usage("`--x` and `--y` must be two coordinates".into())),
        _ => Err(CommandError::Usage(format!(
            "`{}` has only one coordinate; a picture needs two",
            choice.target.name()
        ))),
    }
}

fn write_shares(out: &mut dyn Write, choice: &Choice, found: &Basins) -> Result<(), CommandError> {
    let mechanism = choice.mechanism.as_ref();
    let solutions = (0..found.solutions.len()).map(|index| (Some(index), describe(mechanism, found, index)));
    let lines: Vec<_> = solutions.chain([(None, "no assembly found".to_string())]).collect();
    let width = lines.iter().map(|(_, text)| text.chars().count()).max().unwrap_or(0);
    write!(out, "{:width$}", "assembly")?;
    for map in &found.maps {
        write!(out, "  {:>24}", heading(map.method))?;
    }
    writeln!(out)?;
    for (solution, text) in lines {
        write!(out, "{text:width$}")?;
        for map in &found.maps {
            write!(out, "  {:>24}", format!("{:.1} %", 100.0 * map.share(solution)))?;
        }
        writeln!(out)?;
    }
    Ok(())
}
