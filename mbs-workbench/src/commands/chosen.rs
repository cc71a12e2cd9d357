//! Arguments that the teaching commands share: mechanism, parameters, time and output file.

use std::convert::Infallible;
use std::fs;
use std::path::{Path, PathBuf};

use crate::catalogue::Catalogue;
use crate::erased::dynamics::direct_dynamics::moved_to;
use crate::erased::erase::Erased;
use crate::erased::experiment::state_at;
use crate::erased::facade::{AnyEquations, AnyMechanism, State};
use crate::mismatch::{Mismatch, array, listed, nearest, wrapped};
use clap::Args;
use mbs_codegen::StructureReport;

use super::assignment::{Assignment, assignment};
use super::report_files::require_place;
use super::target::Target;
use super::{CommandError, summary};

#[derive(Args)]
pub struct Chosen {
    /// Name of the mechanism, as `mbs list` prints it, or a file with its text: FILE, FILE:Name, FILE:Name:Scene
    name: String,
    /// Set a parameter: a number in the unit that `mbs list` prints, or with a unit as `200mm`, `60rpm`, `4 [m^2]`
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = assignment)]
    parameters: Vec<Assignment>,
}

/// A mechanism with the parameters of its first preset and of the command line.
pub struct Choice {
    pub target: Target,
    pub mechanism: Box<dyn AnyMechanism>,
}

/// A mechanism that its rows fix or that forces move, with the same parameters.
pub struct Described {
    pub target: Target,
    instance: Erased,
}

impl Chosen {
    /// Name or file as it is written.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// `true` where no parameter is set.
    pub fn is_plain(&self) -> bool {
        self.parameters.is_empty()
    }

    pub fn described(&self, catalogue: &Catalogue) -> Result<Described, CommandError> {
        let target = Target::find(catalogue, &self.name)?;
        let instance = target.instance(&target.runs()[0], &self.parameters)?;
        Ok(Described { target, instance })
    }

    pub fn choice(&self, catalogue: &Catalogue) -> Result<Choice, CommandError> {
        let target = Target::find(catalogue, &self.name)?;
        let instance = target.instance(&target.runs()[0], &self.parameters)?;
        let free = || Mismatch::Free { name: self.name.clone() };
        let mechanism = instance.into_mechanism().ok_or_else(free)?;
        Ok(Choice { target, mechanism })
    }
}

/// Sparsity, matching and order of solution.
fn structure(mechanism: &dyn AnyEquations) -> Result<StructureReport, CommandError> {
    mbs_codegen::structure_of(mechanism.source(), Some(mechanism.scene())).map_err(CommandError::Failed)
}

impl Described {
    /// Names and functions.
    pub fn equations(&self) -> &dyn AnyEquations {
        self.instance.equations()
    }

    /// Sparsity, matching and order of solution.
    pub fn structure(&self) -> Result<StructureReport, CommandError> {
        structure(self.equations())
    }

    /// The state at `t` (s): followed there from the assembly at 0, or moved there by forces from the text's start.
    pub fn state(&self, t: f64) -> Result<State, CommandError> {
        let state = match &self.instance {
            Erased::Fixed(mechanism) => {
                state_at(mechanism.as_ref(), self.target.duration(mechanism.as_ref())?, t)
            }
            Erased::Free(mechanism) if t >= 0.0 => match mechanism.dynamics() {
                Some(dynamics) => moved_to(dynamics, t),
                None => Ok(State::default()),
            },
            Erased::Free(_) => {
                return Err(CommandError::Usage(
                    "forces move a mechanism on from 0 s; `--at` is before".into(),
                ));
            }
        };
        state.map_err(|failure| self.target.failed(self.equations(), &failure.to_string()))
    }
}

impl Choice {
    /// Sparsity, matching and order of solution.
    pub fn structure(&self) -> Result<StructureReport, CommandError> {
        structure(self.mechanism.as_ref())
    }

    /// Index of the coordinate called `name`.
    pub fn coordinate(&self, name: &str) -> Result<usize, CommandError> {
        coordinate(self.mechanism.as_ref(), self.target.name(), name)
    }

    /// `phi2 = 2.5 rad, …` for coordinates by their indices.
    pub fn values(&self, indices: &[usize], q: &[f64]) -> String {
        let of_block: Vec<f64> = indices.iter().map(|index| q[*index]).collect();
        self.block_values(indices, &of_block)
    }

    /// The same where `x` holds the values of these coordinates alone.
    pub fn block_values(&self, indices: &[usize], x: &[f64]) -> String {
        let coordinates = self.mechanism.coordinates();
        let value = |(index, value): (&usize, &f64)| {
            let entry = coordinates[*index];
            format!("{} = {}{}", entry.name, summary::short(*value), summary::unit(entry.unit))
        };
        indices.iter().zip(x).map(value).collect::<Vec<_>>().join(", ")
    }
}

/// Index of the coordinate called `name` of the mechanism that was asked for as `card`.
pub fn coordinate(mechanism: &dyn AnyEquations, card: &str, name: &str) -> Result<usize, CommandError> {
    let (name, coordinates) = (&listed(name), mechanism.coordinates());
    coordinates.iter().position(|entry| entry.name == name).ok_or_else(|| {
        let known: Vec<&str> = coordinates.iter().map(|entry| entry.name).collect();
        if let Some(array) = array(name, &known) {
            return CommandError::Usage(format!(
                "`{card}` has no coordinate `{name}`: it is an array, {array}"
            ));
        }
        let near = nearest(name, known.iter().copied());
        let near = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
        let list = wrapped(&known);
        CommandError::Usage(format!("`{card}` has no coordinate `{name}`{near}\nknown: {list}"))
    })
}

/// A component of an array as lists name it, or as a text does.
pub fn component(text: &str) -> Result<String, Infallible> {
    Ok(listed(text.trim()))
}

/// A finite number.
pub fn finite(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(format!("`{text}` is not a finite number")),
        Err(_) => Err(format!("`{text}` is not a number")),
    }
}

/// The path of a picture, whose suffix says what it is.
pub fn svg_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_svg = path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("svg"));
    is_svg.then_some(path).ok_or_else(|| "the picture is SVG: name it FILE.svg".to_string())
}

/// Refuses a file that cannot be written where the command line names one, before anything is computed.
pub fn require_named(path: Option<&PathBuf>) -> Result<(), CommandError> {
    path.map_or(Ok(()), |path| require_place(path))
}

/// Writes a file, its directory included.
pub fn write_file(path: &Path, text: &str) -> Result<(), CommandError> {
    let fail =
        |error: std::io::Error| CommandError::Failed(format!("cannot write {}: {error}", path.display()));
    if let Some(directory) = path.parent().filter(|directory| !directory.as_os_str().is_empty()) {
        fs::create_dir_all(directory).map_err(fail)?;
    }
    fs::write(path, text).map_err(fail)
}
