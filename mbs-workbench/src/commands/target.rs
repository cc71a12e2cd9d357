//! A mechanism that a command works on: its card, and what its text says.

use mbs_codegen::picture::{Picture, Preset, Shape, Span};

use crate::card::{Card, DefaultMethod, duration, runs};
use crate::catalogue::Catalogue;
use crate::erased::erase::Erased;
use crate::erased::facade::AnyEquations;
use crate::mismatch::{Mismatch, set};

use super::CommandError;
use super::assignment::{Assignment, with_unit};
use super::feet;
use super::rows::with_rows;
use crate::text_file::is_file;

/// A mechanism of the list, its text read.
pub struct Target {
    card: Card,
    name: String,
    is_free: bool,
    picture: Picture,
    runs: Vec<Preset>,
}

impl Target {
    /// The mechanism called `name`.
    pub fn find(catalogue: &Catalogue, name: &str) -> Result<Self, Mismatch> {
        let card = *catalogue.find(name)?;
        let picture = card.picture()?;
        let runs = runs(&picture);
        // Messages propose commands, so a file goes by what the command line says.
        let name = if is_file(name) { name.to_string() } else { card.name() };
        Ok(Target { card, name, is_free: card.is_free(), picture, runs })
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its entry of the list.
    pub fn card(&self) -> &Card {
        &self.card
    }

    /// The name as part of a path.
    pub fn file_name(&self) -> String {
        self.card.file_name()
    }

    pub fn title(&self) -> &str {
        &self.picture.title
    }

    pub fn description(&self) -> &str {
        &self.picture.about
    }

    pub fn runs(&self) -> &[Preset] {
        &self.runs
    }

    pub fn span(&self) -> Option<&Span> {
        self.picture.span.as_ref()
    }

    /// The method that moves it where the command line names none.
    pub fn default_method(&self) -> DefaultMethod {
        self.card.default_method
    }

    pub fn picture(&self) -> &Picture {
        &self.picture
    }

    pub fn shapes(&self) -> &[Shape] {
        &self.picture.shapes
    }

    /// `true` where its rows leave coordinates free.
    pub fn is_free(&self) -> bool {
        self.is_free
    }

    /// An instance with the preset's parameters and those of the command line.
    ///
    /// Lengths, masses, moments of inertia and stiffnesses of the command line are physically possible. Bounds of feet are within the
    /// reach of curves that it gives.
    pub fn instance(&self, preset: &Preset, parameters: &[Assignment]) -> Result<Erased, CommandError> {
        let mut instance = self.card.instance(preset)?;
        for parameter in parameters {
            let equations = instance.equations_mut();
            let unit = equations.variables().iter().find(|entry| entry.name == parameter.name);
            let value = unit.map_or(Ok(0.0), |entry| parameter.in_unit(entry.unit))?;
            set(equations, &parameter.name, value).map_err(|mismatch| mismatch.of(&self.name))?;
        }
        let equations = instance.equations();
        feet::require(equations)?;
        if parameters.is_empty() {
            return Ok(instance);
        }
        let value = |name: &str| {
            let index = equations.variables().iter().position(|entry| entry.name == name)?;
            equations.get(index)
        };
        let declared = mbs_codegen::variables(equations.source(), Some(equations.scene()));
        for variable in declared.map_err(CommandError::Failed)? {
            let given = parameters.iter().any(|parameter| parameter.name == variable.name);
            let found = value(&variable.name).unwrap_or(variable.default);
            let [low, high] = variable.range;
            if given && !(low..=high).contains(&found) {
                let [found, low, high] = [found, low, high].map(|end| with_unit(end, &variable.unit));
                return Err(CommandError::Usage(format!(
                    "`{}` is {found}: the text allows {low} to {high}",
                    variable.name
                )));
            }
        }
        let found = mbs_codegen::impossible_values(equations.source(), Some(equations.scene()), value);
        match found.map_err(CommandError::Failed)?.as_slice() {
            [] => Ok(instance),
            found => Err(CommandError::Usage(format!("with these parameters {}", found.join(", ")))),
        }
    }

    /// One instance for each preset; a single one if the command line sets the parameters in which presets differ.
    pub fn instances(&self, parameters: &[Assignment]) -> Result<Vec<(Preset, Erased)>, CommandError> {
        let as_given = || Preset {
            label: "as given".to_string(),
            description: "parameters of the command line".to_string(),
            set: Vec::new(),
        };
        let given = |name: &str| parameters.iter().any(|given| given.name == name);
        let overridden = self.runs.iter().flat_map(|run| &run.set).any(|(name, _)| given(name));
        let presets = if overridden { vec![as_given()] } else { self.runs.clone() };
        let mut instances = Vec::new();
        for preset in presets {
            let instance = self.instance(&preset, parameters)?;
            instances.push((preset, instance));
        }
        Ok(instances)
    }

    /// A message with the rows that it names.
    pub fn quoted(&self, mechanism: &dyn AnyEquations, message: &str) -> String {
        let known = mbs_codegen::declarations(mechanism.source(), Some(mechanism.scene()));
        with_rows(message, &known.unwrap_or_default(), is_file(&self.name))
    }

    /// Reason of a failure with the mechanism's name, and the rows that it names.
    pub fn failed(&self, mechanism: &dyn AnyEquations, reason: &str) -> CommandError {
        let reason = self.quoted(mechanism, reason);
        CommandError::Failed(format!("{}: {reason}", self.name))
    }

    /// Duration (s) of the motion of `mechanism`.
    pub fn duration(&self, mechanism: &dyn AnyEquations) -> Result<f64, Mismatch> {
        duration(self.span(), mechanism)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::card;
    use crate::commands::assignment::assignment;

    mbs_runtime::mechanism! {
        pub mechanism Crank;
        param omega: rad/s = 1 in 0.1..600rpm, tolerance 0.01;
        param side: 1 = 1;
        coord phi: rad;
        drive motor: phi == side*omega*t;
        preset "to the left" { side: 1 }
        preset "to the right" { side: -1 }
        span turn(omega);
    }

    #[test]
    fn values_outside_of_a_range_are_refused() {
        let cards = [card!(self::Crank::default())];
        let catalogue = Catalogue { cards: &cards };
        let target = Target::find(&catalogue, &cards[0].name()).expect("in the list");
        let given = |text: &str| target.instances(&[assignment(text).expect("a number")]).map(|_| ());
        assert!(given("omega=600rpm").is_ok() && given("omega=0.1").is_ok());
        let message = given("omega=1000rpm").expect_err("too fast").to_string();
        assert_eq!(message, "`omega` is 104.72 rad/s: the text allows 0.1 rad/s to 62.8319 rad/s");
        assert!(given("omega=0").is_err());
    }

    #[test]
    fn options_of_the_command_line_overrule_the_presets() {
        let cards = [card!(self::Crank::default())];
        let catalogue = Catalogue { cards: &cards };
        let target = Target::find(&catalogue, &cards[0].name()).expect("in the list");
        let labels = |parameters: &[&str]| -> Vec<String> {
            let parameters: Vec<Assignment> =
                parameters.iter().map(|text| assignment(text).expect("a number")).collect();
            let instances = target.instances(&parameters).expect("parameters");
            instances.into_iter().map(|(preset, _)| preset.label).collect()
        };
        assert_eq!(labels(&["omega=60rpm"]).len(), target.runs().len());
        assert_eq!(labels(&["side=-1"]), ["as given"]);
    }
}
