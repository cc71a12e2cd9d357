//! `mbs newton`.

use crate::catalogue::Catalogue;
use std::io::Write;

use crate::erased::experiment::{BlockProtocol, IterateProtocol, Protocol};
use crate::erased::formulas::Formula;
use clap::Args;
use mbs_runtime::{Entry, Failure, FailureKind};
use serde_json::{Value, json};

use super::assignment::{Assignment, assignment};
use super::chosen::{Choice, Chosen, finite};
use super::document::Output;
use super::{CommandError, summary};

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    pub chosen: Chosen,
    /// Start from another value of a coordinate than the text's guess, in the unit of the text
    #[arg(long = "guess", value_name = "NAME=VALUE", value_parser = assignment)]
    guesses: Vec<Assignment>,
    /// Time (s) of the position
    #[arg(long, value_name = "T", default_value_t = 0.0, value_parser = finite, allow_negative_numbers = true)]
    at: f64,
    /// The lecture's full Newton–Raphson on all rows at once, without any safeguard
    #[arg(long)]
    plain: bool,
}

/// Largest number of coordinates of a block that are printed with its iterations: more do not fit into a line.
const SHOWN: usize = 5;

/// Prints the iterations and the assembly to which they converge.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    let choice = arguments.chosen.choice(catalogue)?;
    let mechanism = choice.mechanism.as_ref();
    let mut guess = mechanism.experiment().guess();
    for given in &arguments.guesses {
        let index = choice.coordinate(&given.name)?;
        guess[index] = given.in_unit(mechanism.coordinates()[index].unit)?;
    }
    let protocol = mechanism.experiment().iterations(&guess, arguments.at, arguments.plain);
    if let Err(
        failure @ (Failure { kind: FailureKind::Unresolved { .. }, .. }
        | Failure { kind: FailureKind::NonFinite { line: 0, .. }, .. }),
    ) = &protocol.found
    {
        return Err(choice.target.failed(mechanism, &failure.to_string()));
    }
    let all: Vec<usize> = (0..guess.len()).collect();
    describe_in(out, &choice, &protocol, (&guess, arguments.at));
    writeln!(out, "{} at t = {} s", choice.target.title(), arguments.at)?;
    writeln!(out, "guess: {}", choice.values(&all, &guess))?;
    writeln!(out, "residual and step: lengths in the reference metric (rad, or reference lengths)\n")?;
    if arguments.plain {
        writeln!(out, "full Newton–Raphson on all {} rows", guess.len())?;
        protocol.blocks.iter().try_for_each(|block| write_block(out, &choice, block))?;
    } else {
        write_blocks(out, &choice, &protocol)?;
    }
    write_formulas(out, &choice, &mechanism.experiment().formulas(&guess, arguments.at))?;
    match &protocol.found {
        Ok(q) => write_found(out, &choice, &all, q, arguments.at),
        Err(failure) => Err(choice.target.failed(mechanism, &failure.to_string())),
    }
}

/// Guess, iterations, branches and the position found as data.
fn describe_in(out: &mut Output, choice: &Choice, protocol: &Protocol, (guess, t): (&[f64], f64)) {
    let mechanism = choice.mechanism.as_ref();
    let coordinates = mechanism.coordinates();
    let position = |q: &[f64]| -> Vec<Value> {
        let value = |(entry, value): (&Entry, &f64)| json!({ "name": entry.name, "unit": entry.unit, "value": value });
        coordinates.iter().zip(q).map(value).collect()
    };
    out.put_mechanism(&choice.target, mechanism);
    out.put("t", t);
    out.put("guess", position(guess));
    out.put("blocks", json!([]));
    for block in &protocol.blocks {
        let names: Vec<&str> = block.coordinates.iter().map(|index| coordinates[*index].name).collect();
        let rows: Vec<&str> = block.rows.iter().map(|row| mechanism.rows()[*row].name).collect();
        let iterate = |(k, iterate): (usize, &IterateProtocol)| {
            json!({
                "values": iterate.x, "residual": iterate.residual, "step": iterate.step, "order": block.order(k),
            })
        };
        let iterates: Vec<Value> = block.iterates.iter().enumerate().map(iterate).collect();
        out.push("blocks", json!({ "coordinates": names, "rows": rows, "iterates": iterates }));
    }
    out.put("found", protocol.found.as_ref().ok().map(|q| position(q)));
    let experiment = mechanism.experiment();
    out.put("branches", json!([]));
    if let Ok(q) = &protocol.found {
        for (branch, value) in experiment.branches().iter().zip(experiment.branch_values(q, t)) {
            out.push("branches", json!({ "name": branch.name, "value": value, "holds": value > 0.0 }));
        }
    }
}

/// Blocks in the order of solution; those that are assigned come from no solver.
fn write_blocks(out: &mut dyn Write, choice: &Choice, protocol: &Protocol) -> Result<(), CommandError> {
    let report = choice.structure()?;
    let mut solved = protocol.blocks.iter();
    for (number, block) in report.blocks.iter().enumerate() {
        let rows: Vec<&str> = block.rows.iter().map(|row| report.rows[*row].name.as_str()).collect();
        let names: Vec<&str> =
            block.coordinates.iter().map(|index| report.coordinates[*index].name.as_str()).collect();
        let (number, rows, names) = (number + 1, rows.join(", "), names.join(", "));
        if block.explicit {
            let value =
                protocol.found.as_ref().map(|q| choice.values(&block.coordinates, q)).unwrap_or(names);
            writeln!(out, "{number}. {value}, assigned from {rows}")?;
        } else if let Some(block) = solved.next() {
            writeln!(out, "{number}. {names} from {rows}")?;
            write_block(out, choice, block)?;
        }
    }
    Ok(())
}

fn write_block(out: &mut dyn Write, choice: &Choice, block: &BlockProtocol) -> Result<(), CommandError> {
    let coordinates = choice.mechanism.coordinates();
    let shown = if block.coordinates.len() > SHOWN { &[][..] } else { &block.coordinates[..] };
    let names: String = shown.iter().map(|index| format!("  {:>11}", coordinates[*index].name)).collect();
    writeln!(out, "   iteration   residual       step   order{names}")?;
    for (k, iterate) in block.iterates.iter().enumerate() {
        if k > 0 && iterate.x == block.iterates[0].x {
            writeln!(out, "   from the start again by Levenberg–Marquardt, rejected trials included")?;
        }
        let step = iterate.step.map_or_else(String::new, |step| format!("{step:.2e}"));
        let order = block.order(k).map_or_else(String::new, |order| format!("{order:.2}"));
        let values: String = match shown {
            [] => String::new(),
            _ => iterate.x.iter().map(|value| format!("  {value:>11.7}")).collect(),
        };
        writeln!(
            out,
            "   {k:>9}   {:>8} {step:>10}   {order:>5}{values}",
            format!("{:.2e}", iterate.residual)
        )?;
    }
    Ok(())
}

/// Formulas that `assemble` evaluates in place of iterations, from the same guess.
fn write_formulas(out: &mut dyn Write, choice: &Choice, formulas: &[Formula]) -> Result<(), CommandError> {
    if formulas.is_empty() {
        return Ok(());
    }
    let report = choice.structure()?;
    writeln!(out, "\n`assemble` needs no start value where formulas give both positions of a block")?;
    for Formula { coordinates, positions, taken } in formulas {
        let block = report.blocks.iter().find(|block| block.coordinates == *coordinates);
        let kind = block.and_then(|block| block.dyad).unwrap_or("dyad");
        let Some(positions) = positions else {
            let names: Vec<&str> =
                coordinates.iter().map(|index| report.coordinates[*index].name.as_str()).collect();
            writeln!(out, "   {kind}: {} have no position, its ends do not meet", names.join(", "))?;
            continue;
        };
        let distances = positions.each_ref().map(|position| distance(position, taken));
        for (index, position) in positions.iter().enumerate() {
            let word = if distances[index] <= distances[1 - index] { "taken" } else { "the other" };
            writeln!(out, "   {kind}: {} ({word})", choice.block_values(coordinates, position))?;
        }
    }
    Ok(())
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn write_found(
    out: &mut dyn Write,
    choice: &Choice,
    all: &[usize],
    q: &[f64],
    t: f64,
) -> Result<(), CommandError> {
    writeln!(out, "\nfound: {}", choice.values(all, q))?;
    let experiment = choice.mechanism.experiment();
    let values = experiment.branch_values(q, t);
    for (branch, value) in experiment.branches().iter().zip(&values) {
        let verdict = if *value > 0.0 { "holds" } else { "does not hold: another assembly" };
        let (value, unit) = (summary::short(*value), summary::unit(branch.unit));
        writeln!(out, "branch {} = {value}{unit}, required positive: {verdict}", branch.name)?;
    }
    if values.is_empty() {
        writeln!(out, "no branch is declared: any assembly is right")?;
    }
    Ok(())
}
