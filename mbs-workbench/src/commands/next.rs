//! `mbs next`.

use crate::catalogue::Catalogue;
use std::io::Write;

use crate::teaching::next_position::{ReferenceMotion, STEP_METHODS, StepAttempts, StepMethod};
use clap::Args;
use mbs_codegen::picture::Span;
use serde_json::json;

use super::chosen::{Choice, Chosen};
use super::document::Output;
use super::{CommandError, positive};

/// Steps of the table, in parts of the motion's duration.
const PARTS: [u32; 15] = [720, 360, 180, 120, 90, 72, 60, 36, 24, 18, 12, 9, 6, 4, 3];

/// Positions over the motion from which each step is tried.
const STARTS: usize = 24;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    pub chosen: Chosen,
    /// Positions, spread over the motion, from which each step is tried
    #[arg(long, default_value_t = STARTS, value_parser = positive)]
    starts: usize,
}

/// Prints the result of every step size and the largest safe step of each way.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    let choice = arguments.chosen.choice(catalogue)?;
    let duration = choice.target.duration(choice.mechanism.as_ref())?;
    let course = ReferenceMotion::new(choice.mechanism.as_ref(), duration, arguments.starts)
        .map_err(|failure| choice.target.failed(choice.mechanism.as_ref(), &failure.to_string()))?;
    let steps: Vec<f64> = PARTS.map(|part| duration / f64::from(part)).to_vec();
    out.put_mechanism(&choice.target, choice.mechanism.as_ref());
    writeln!(out, "{}\n", choice.target.title())?;
    writeln!(out, "previous   full Newton–Raphson from the previous position")?;
    writeln!(out, "predicted  full Newton–Raphson from q + h·q̇ + h²/2·q̈")?;
    writeln!(
        out,
        "stepper    the runtime's step: the same prediction, then block by block with capped steps\n"
    )?;
    writeln!(
        out,
        "each step from {} positions over the motion: mean iterations of the right",
        arguments.starts
    )?;
    writeln!(
        out,
        "ones (the stepper's: of the block that needs the most), right/wrong assembly/no position\n"
    )?;
    let head: String = STEP_METHODS.iter().map(|way| format!("  {:>22}", name(*way))).collect();
    writeln!(out, "{:>24}{head}", "step")?;
    for h in &steps {
        let trials: String =
            STEP_METHODS.iter().map(|way| format!("  {:>22}", cell(&course.trial(*way, *h)))).collect();
        writeln!(out, "{:>24}{trials}", step(&choice, duration, *h))?;
        for way in STEP_METHODS {
            let StepAttempts { count, right, wrong, iterations } = course.trial(way, *h);
            out.push(
                "trials",
                json!({
                    "way": name(way), "step": h, "starts": count, "right": right, "wrong": wrong, "iterations": iterations,
                }),
            );
        }
    }
    writeln!(out, "\nlargest step up to which all are right")?;
    for way in STEP_METHODS {
        let safe = course.largest_safe_step(way, &steps);
        out.push("largest_steps", json!({ "way": name(way), "step": safe }));
        let more = if steps.last().is_some_and(|last| safe >= *last) { " or more" } else { "" };
        writeln!(out, "  {:9}  {}{more}", name(way), step(&choice, duration, safe))?;
    }
    Ok(())
}

fn name(way: StepMethod) -> &'static str {
    match way {
        StepMethod::Previous => "previous",
        StepMethod::Predicted => "predicted",
        StepMethod::Stepper => "stepper",
    }
}

fn cell(trial: &StepAttempts) -> String {
    let mean = match trial.right {
        0 => "–".to_string(),
        right => format!("{:.1}", f64::from(trial.iterations) / right as f64),
    };
    format!("{mean}  {:>3}/{}/{}", trial.right, trial.wrong, trial.failed())
}

/// A step in time, and of the driver where it turns at a constant rate.
fn step(choice: &Choice, duration: f64, h: f64) -> String {
    match choice.target.span() {
        Some(Span::Turn { .. }) => format!("{:.5} s = {:>6.2}°", h, 360.0 * h / duration),
        Some(Span::Seconds(_)) | None => format!("{h:.5} s"),
    }
}
