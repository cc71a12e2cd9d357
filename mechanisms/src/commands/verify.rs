//! `mbs verify`.

use std::io::Write;
use std::time::Duration;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use mechanisms::registry::{self, ALL, Card};
use mechanisms::verify::{Oracle, STATES, verify};

use super::{CommandError, positive};

/// The spinner turns while pip and CasADi work in their own processes.
const TICK: Duration = Duration::from_millis(100);

#[derive(Args)]
pub struct Arguments {
    /// Name of the mechanism, as `mbs list` prints it
    #[arg(required_unless_present = "all", conflicts_with = "all")]
    name: Option<String>,
    /// All mechanisms
    #[arg(long)]
    all: bool,
    /// Random states a mechanism
    #[arg(long, default_value_t = STATES, value_parser = positive)]
    states: usize,
}

/// The largest error of each function; an error where one is above the bound.
pub fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<(), CommandError> {
    let cards: Vec<&Card> = match &arguments.name {
        Some(name) => vec![registry::find(name)?],
        None => ALL.to_vec(),
    };
    let style =
        ProgressStyle::with_template("{spinner} {bar:30} {pos}/{len} {msg}").expect("a valid template");
    let bar = ProgressBar::new(cards.len() as u64).with_style(style);
    bar.enable_steady_tick(TICK);
    let oracle = Oracle::new(&|step| bar.set_message(step.to_string()));
    let oracle = oracle.map_err(|error| failed(&bar, error.to_string()))?;
    let mut differing = Vec::new();
    for card in cards {
        bar.set_message(card.name);
        let agreement = verify(card, &oracle, arguments.states);
        let agreement = agreement.map_err(|error| failed(&bar, format!("{}: {error}", card.name)))?;
        bar.suspend(|| writeln!(out, "{agreement}"))?;
        if !agreement.holds() {
            differing.push(card.name);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    match differing.as_slice() {
        [] => Ok(()),
        names => Err(CommandError::Failed(format!("CasADi does not confirm: {}", names.join(", ")))),
    }
}

fn failed(bar: &ProgressBar, reason: String) -> CommandError {
    bar.finish_and_clear();
    CommandError::Failed(reason)
}
