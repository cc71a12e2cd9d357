//! `mbs verify`.

use crate::catalogue::Catalogue;
use std::io::Write;
use std::time::Duration;

use crate::output::origin::Origin;
use crate::verify::agreement::Absence;
use crate::verify::states::SEED;
use crate::verify::{
    Agreement, DIGITS_STATES, Oracle, Summary, states_of, verify_equations, verify_equations_digits,
};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};

use super::document::Output;
use super::{CommandError, positive};

/// The spinner turns while pip and CasADi work in their own processes.
const TICK: Duration = Duration::from_millis(100);

#[derive(Args)]
pub struct Arguments {
    /// Name of the mechanism, as `mbs list` prints it, or a file with its text: FILE, FILE:Name, FILE:Name:Scene
    #[arg(required_unless_present = "all", conflicts_with = "all")]
    pub name: Option<String>,
    /// All mechanisms
    #[arg(long)]
    all: bool,
    /// Compare with 50-digit arithmetic instead of CasADi
    #[arg(long)]
    digits: bool,
    /// Random states a mechanism [default: 1000, of more than 24 coordinates fewer, with --digits 20]
    #[arg(long, value_parser = positive)]
    states: Option<usize>,
}

/// Prints the largest error of each function; fails if one is above the bound.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    let cards = match &arguments.name {
        Some(name) => vec![*catalogue.find(name)?],
        None => catalogue.to_vec(),
    };
    let style =
        ProgressStyle::with_template("{spinner} {bar:30} {pos}/{len} {msg}").expect("a valid template");
    let bar = ProgressBar::new(cards.len() as u64).with_style(style);
    bar.enable_steady_tick(TICK);
    let oracle = Oracle::new(&|step| bar.set_message(step.to_string()));
    let oracle = oracle.map_err(|error| failed(&bar, error.to_string()))?;
    let compare = if arguments.digits { verify_equations_digits } else { verify_equations };
    let mut summary = Summary::default();
    out.put("seed", SEED);
    out.put("mechanisms", json!([]));
    for card in cards {
        let name = card.name();
        bar.set_message(name.clone());
        let mut mechanism = card.comparable();
        let usual = if arguments.digits { DIGITS_STATES } else { states_of(mechanism.coordinates().len()) };
        let states = arguments.states.unwrap_or(usual);
        let agreement = compare(mechanism.as_mut(), &oracle, states);
        let agreement = agreement.map_err(|error| failed(&bar, format!("{name}: {error}")))?;
        bar.suspend(|| writeln!(out, "{agreement}"))?;
        let source = mechanism.source();
        out.push("mechanisms", described(&agreement, &Origin::of_text(&name, source).hash));
        summary.add(agreement);
        bar.inc(1);
    }
    bar.finish_and_clear();
    if arguments.all {
        writeln!(out, "{summary}")?;
    }
    match summary.differing().as_slice() {
        [] => Ok(()),
        names => Err(CommandError::Failed(format!("not confirmed: {}", names.join(", ")))),
    }
}

/// The comparison as data.
fn described(agreement: &Agreement, hash: &str) -> Value {
    let Agreement { mechanism, states, values, functions, compared, .. } = agreement;
    let function = |(name, values, absence): &(&'static str, usize, Option<Absence>)| {
        let largest = functions.iter().find(|found| found.function == *name);
        json!({
            "name": name, "values": values, "reason": absence.map(|absence| absence.to_string()),
            "largest_error": largest.map(|largest| largest.error), "entry": largest.map(|largest| &largest.entry),
            "state": largest.map(|largest| largest.state),
        })
    };
    json!({
        "name": mechanism, "hash": hash, "states": states, "values": values, "bound": agreement.reference.bound(),
        "holds": agreement.holds(), "functions": compared.iter().map(function).collect::<Vec<_>>(),
    })
}

fn failed(bar: &ProgressBar, reason: String) -> CommandError {
    bar.finish_and_clear();
    CommandError::Failed(reason)
}
