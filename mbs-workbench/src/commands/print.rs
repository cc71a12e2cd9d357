//! `mbs print`.

use crate::catalogue::Catalogue;
use std::io::Write;

use crate::erased::facade::{AnyEquations, State};
use crate::erased::masses::{Loads, Masses};
use crate::motion::multiplier_unit;
use crate::output::matrix::Named;
use clap::{Args, ValueEnum};
use serde_json::json;

use super::CommandError;
use super::chosen::{Chosen, finite};
use super::document::Output;
use super::text::Text;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    pub chosen: Chosen,
    /// Quantities to print
    #[arg(value_enum, default_values = ["Phi", "Phi_q", "Phi_t", "gamma"])]
    quantities: Vec<Quantity>,
    /// Time (s) of the position
    #[arg(long, value_name = "T", default_value_t = 0.0, value_parser = finite, allow_negative_numbers = true)]
    at: f64,
    /// Formulas instead of numbers
    #[arg(long, conflicts_with = "numbers")]
    pub symbols: bool,
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
    #[value(name = "Phi", aliases = ["phi", "PHI"], help = "constraints and drives")]
    Phi,
    #[value(name = "Phi_q", aliases = ["phi_q", "PHI_Q"], help = "Jacobian")]
    Jacobian,
    #[value(name = "Phi_t", aliases = ["phi_t", "PHI_T"], help = "partial time derivative")]
    PhiT,
    #[value(name = "Phi_tt", aliases = ["phi_tt", "PHI_TT"], help = "second partial time derivative")]
    PhiTt,
    #[value(name = "gamma", aliases = ["Gamma", "GAMMA"], help = "right-hand side of the accelerations")]
    Gamma,
    #[value(name = "M", help = "mass matrix")]
    Mass,
    #[value(name = "Q", help = "generalized forces, those of the velocities included")]
    Force,
    #[value(name = "lambda", aliases = ["Lambda", "LAMBDA"], help = "multipliers: M qdd + Phi_q^T lambda = Q")]
    Multipliers,
    #[value(name = "energy", help = "kinetic and potential energy")]
    Energy,
}

impl Quantity {
    /// `true` if the quantity depends on masses and forces.
    fn is_dynamic(self) -> bool {
        matches!(self, Quantity::Mass | Quantity::Force | Quantity::Multipliers | Quantity::Energy)
    }
}

/// The matrices, names on rows and columns.
pub fn run(catalogue: &Catalogue, arguments: &Arguments, out: &mut Output) -> Result<(), CommandError> {
    let dynamic = arguments.quantities.iter().any(|quantity| quantity.is_dynamic());
    if arguments.symbols {
        return formulas(&Text::find(catalogue, &arguments.chosen)?, &arguments.quantities, dynamic, out);
    }
    let choice = arguments.chosen.described(catalogue)?;
    let mechanism = choice.equations();
    if dynamic && mechanism.dynamics().is_none() {
        return Err(massless(choice.target.name()));
    }
    let state = choice.state(arguments.at)?;
    out.put_mechanism(&choice.target, mechanism);
    out.put("t", arguments.at);
    writeln!(out, "{} at t = {} s", choice.target.title(), arguments.at)?;
    let (loads, masses) = match mechanism.dynamics().filter(|_| dynamic) {
        None => (Loads::default(), Masses::default()),
        Some(dynamics) => {
            if arguments.at > 0.0 && mechanism.tables().is_some_and(|tables| !tables.states.is_empty()) {
                let reason = "the text's first-order states are known at 0 s alone: leave out `--at`";
                return Err(CommandError::Usage(reason.to_string()));
            }
            let loads = dynamics.multipliers(&state).map_err(CommandError::Failed)?;
            let masses = mechanism.masses(&state, &loads).unwrap_or_default();
            (loads, masses)
        }
    };
    for quantity in &arguments.quantities {
        match quantity.is_dynamic() {
            true => write(out, &numeric_dynamic(mechanism, (&loads, &masses), *quantity))?,
            false => write(out, &numeric(mechanism, &state, *quantity))?,
        }
    }
    Ok(())
}

fn massless(name: &str) -> CommandError {
    CommandError::Usage(format!("`{name}` has neither masses nor forces: no M, Q, lambda or energy"))
}

/// The formulas of a text.
fn formulas(
    text: &Text,
    quantities: &[Quantity],
    dynamic: bool,
    out: &mut Output,
) -> Result<(), CommandError> {
    text.put(out);
    let formulas = mbs_codegen::formulas(&text.source, text.scene()).map_err(CommandError::Failed)?;
    let of_masses = match dynamic {
        true => mbs_codegen::dynamic_formulas(&text.source, text.scene()).map_err(CommandError::Failed)?,
        false => None,
    };
    if dynamic && of_masses.is_none() {
        return Err(massless(&text.name));
    }
    writeln!(out, "{}", text.title)?;
    for quantity in quantities.iter().filter(|quantity| !quantity.is_dynamic()) {
        write(out, &symbolic(&formulas, *quantity))?;
    }
    define(out, &formulas.definitions)?;
    if let Some(of_masses) = of_masses {
        for quantity in quantities.iter().filter(|quantity| quantity.is_dynamic()) {
            write(out, &symbolic_dynamic(&formulas.rows, &of_masses, *quantity))?;
        }
        define(out, &of_masses.definitions)?;
    }
    Ok(())
}

fn define(out: &mut Output, definitions: &[(String, String)]) -> Result<(), CommandError> {
    for (name, meaning) in definitions {
        out.push("definitions", json!({ "name": name, "formula": meaning }));
        writeln!(out, "\n{name} = {meaning}")?;
    }
    Ok(())
}

fn write(out: &mut Output, matrix: &Named) -> Result<(), CommandError> {
    let Named { title, rows, columns, cells, values } = matrix;
    let columns = (!columns.is_empty()).then(|| columns.iter().map(|name| name.trim()).collect::<Vec<_>>());
    let quantity = json!({ "name": title.split(':').next(), "rows": rows, "columns": columns });
    let cells: Vec<Vec<&str>> =
        cells.iter().map(|row| row.iter().map(|cell| cell.trim()).collect()).collect();
    let content = match values.is_empty() {
        true => json!({ "formulas": cells }),
        false => json!({ "values": values }),
    };
    let both = [quantity, content].into_iter().filter_map(|part| part.as_object().cloned()).flatten();
    out.push("quantities", both.collect::<serde_json::Map<_, _>>());
    writeln!(out)?;
    for line in matrix.lines() {
        writeln!(out, "{line}")?;
    }
    Ok(())
}

fn symbolic_dynamic(rows: &[String], formulas: &mbs_codegen::DynamicFormulas, quantity: Quantity) -> Named {
    let mbs_codegen::DynamicFormulas { coordinates, mass, force, kinetic, potential, .. } = formulas;
    match quantity {
        Quantity::Mass => Named {
            title: "M".into(),
            rows: coordinates.clone(),
            columns: coordinates.clone(),
            cells: mass.clone(),
            ..Named::default()
        },
        Quantity::Force => Named::vector("Q", coordinates, force),
        Quantity::Energy => {
            let names = ["kinetic", "potential"].map(str::to_string);
            Named::vector("energy", &names, &[kinetic.clone(), potential.clone()])
        }
        _ => {
            let names: Vec<String> = (0..rows.len()).map(|row| format!("lambda.{row}")).collect();
            Named::vector("lambda: M qdd + Phi_q^T lambda = Q", rows, &names)
        }
    }
    .aligned_left()
}

fn numeric_dynamic(
    mechanism: &dyn AnyEquations,
    (loads, masses): (&Loads, &Masses),
    quantity: Quantity,
) -> Named {
    let names =
        |entries: &[mbs_runtime::Entry]| entries.iter().map(|e| e.name.to_string()).collect::<Vec<_>>();
    let coordinates = names(mechanism.coordinates());
    match quantity {
        Quantity::Mass => Named {
            title: "M".into(),
            rows: coordinates.clone(),
            columns: coordinates.clone(),
            ..Named::default()
        }
        .with_values(&masses.mass),
        Quantity::Force => Named::vector("Q", &coordinates, &[]).with_values(&masses.force),
        Quantity::Energy => {
            let names = ["kinetic (J)", "potential (J)"].map(str::to_string);
            Named::vector("energy", &names, &[]).with_values(&masses.energy)
        }
        _ => {
            let unit = |row: &mbs_runtime::Entry| format!("{} ({})", row.name, multiplier_unit(row.unit));
            let rows: Vec<String> = mechanism.rows().iter().map(unit).collect();
            Named::vector("lambda", &rows, &[]).with_values(&loads.lambda)
        }
    }
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
            ..Named::default()
        },
        // Printed with masses and forces.
        Quantity::Mass | Quantity::Force | Quantity::Multipliers | Quantity::Energy => Named::default(),
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
    let of_rows = |title, per, values: &[f64]| {
        Named::vector(title, &names(mechanism.rows(), per), &[]).with_values(values)
    };
    let of_columns = |title, per, values: &[f64]| {
        Named::vector(title, &names(mechanism.coordinates(), per), &[]).with_values(values)
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
            ..Named::default()
        }
        .with_values(&functions.phi_q),
        // Printed with masses and forces.
        Quantity::Mass | Quantity::Force | Quantity::Multipliers | Quantity::Energy => Named::default(),
    }
}
