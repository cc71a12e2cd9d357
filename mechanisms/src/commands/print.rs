//! `mbs print`.

use std::io::Write;

use clap::{Args, ValueEnum};
use mechanisms::facade::{AnyEquations, State};
use mechanisms::lecture::matrix::{Named, number};

use super::CommandError;
use super::chosen::{Chosen, finite};

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    chosen: Chosen,
    /// What to print
    #[arg(value_enum, ignore_case = true, default_values = ["Phi", "Phi_q", "Phi_t", "gamma"])]
    quantities: Vec<Quantity>,
    /// Time (s) of the position
    #[arg(long, value_name = "T", default_value_t = 0.0, value_parser = finite, allow_negative_numbers = true)]
    at: f64,
    /// Formulas instead of numbers
    #[arg(long, conflicts_with = "numbers")]
    symbols: bool,
    /// Numbers at the solved position: the default
    #[arg(long)]
    numbers: bool,
}

/// Vectors and matrices of a mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Quantity {
    #[value(name = "q", help = "coordinates")]
    Position,
    #[value(name = "qd", help = "velocities")]
    Velocity,
    #[value(name = "qdd", help = "accelerations")]
    Acceleration,
    #[value(name = "Phi", help = "constraints and drives")]
    Phi,
    #[value(name = "Phi_q", help = "Jacobian")]
    Jacobian,
    #[value(name = "Phi_t", help = "partial time derivative")]
    PhiT,
    #[value(name = "Phi_tt", help = "second partial time derivative")]
    PhiTt,
    #[value(name = "gamma", help = "right-hand side of the accelerations")]
    Gamma,
}

/// The matrices, names on rows and columns.
pub fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<(), CommandError> {
    let choice = arguments.chosen.described()?;
    let mechanism = choice.equations();
    if arguments.symbols {
        let formulas = mbs_codegen::formulas(mechanism.source(), Some(mechanism.scene()))
            .map_err(CommandError::Failed)?;
        writeln!(out, "{}", choice.subject.title())?;
        for quantity in &arguments.quantities {
            write(out, &symbolic(&formulas, *quantity))?;
        }
        for (name, meaning) in &formulas.definitions {
            writeln!(out, "\n{name} = {meaning}")?;
        }
        return Ok(());
    }
    let state = choice.state(arguments.at)?;
    writeln!(out, "{} at t = {} s", choice.subject.title(), arguments.at)?;
    for quantity in &arguments.quantities {
        write(out, &numeric(mechanism, &state, *quantity))?;
    }
    Ok(())
}

fn write(out: &mut dyn Write, matrix: &Named) -> Result<(), CommandError> {
    writeln!(out)?;
    for line in matrix.lines() {
        writeln!(out, "{line}")?;
    }
    Ok(())
}

fn symbolic(formulas: &mbs_codegen::Formulas, quantity: Quantity) -> Named {
    let mbs_codegen::Formulas { rows, coordinates, .. } = formulas;
    let rates = |mark: &str| coordinates.iter().map(|name| format!("{name}{mark}")).collect::<Vec<_>>();
    match quantity {
        Quantity::Position => Named::vector("q", coordinates, coordinates),
        Quantity::Velocity => Named::vector("qd", coordinates, &rates("'")),
        Quantity::Acceleration => Named::vector("qdd", coordinates, &rates("''")),
        Quantity::Phi => Named::vector("Phi", rows, &formulas.phi),
        Quantity::PhiT => Named::vector("Phi_t", rows, &formulas.phi_t),
        Quantity::PhiTt => Named::vector("Phi_tt", rows, &formulas.phi_tt),
        Quantity::Gamma => Named::vector("gamma", rows, &formulas.gamma),
        Quantity::Jacobian => Named {
            title: "Phi_q".into(),
            rows: rows.clone(),
            columns: coordinates.clone(),
            cells: formulas.phi_q.clone(),
        },
    }
    .aligned_left()
}

fn numeric(mechanism: &dyn AnyEquations, state: &State, quantity: Quantity) -> Named {
    let functions = mechanism.evaluate(state);
    let names = |entries: &[mbs_runtime::Entry], per: &str| {
        let with_unit = |entry: &mbs_runtime::Entry| match (entry.unit, per) {
            ("1", "") => entry.name.to_string(),
            (unit, per) => format!("{} ({unit}{per})", entry.name),
        };
        entries.iter().map(with_unit).collect::<Vec<_>>()
    };
    let cells = |values: &[f64]| values.iter().copied().map(number).collect::<Vec<_>>();
    let of_rows =
        |title, per, values: &[f64]| Named::vector(title, &names(mechanism.rows(), per), &cells(values));
    let of_columns = |title, per, values: &[f64]| {
        Named::vector(title, &names(mechanism.coordinates(), per), &cells(values))
    };
    match quantity {
        Quantity::Position => of_columns("q", "", &state.q),
        Quantity::Velocity => of_columns("qd", "/s", &state.qd),
        Quantity::Acceleration => of_columns("qdd", "/s^2", &state.qdd),
        Quantity::Phi => of_rows("Phi", "", &functions.phi),
        Quantity::PhiT => of_rows("Phi_t", "/s", &functions.phi_t),
        Quantity::PhiTt => of_rows("Phi_tt", "/s^2", &functions.phi_tt),
        Quantity::Gamma => of_rows("gamma", "/s^2", &functions.gamma),
        Quantity::Jacobian => Named {
            title: "Phi_q".into(),
            rows: names(mechanism.rows(), ""),
            columns: mechanism.coordinates().iter().map(|entry| entry.name.to_string()).collect(),
            cells: functions.phi_q.chunks(state.q.len().max(1)).map(cells).collect(),
        },
    }
}
