//! A mechanism that a command works on: its card, and what its text says.

use mbs_codegen::picture::{Picture, Preset, Shape, Span};

use crate::card::{Card, DefaultMethod, duration, runs};
use crate::catalogue::Catalogue;
use crate::erased::erase::Erased;
use crate::erased::facade::AnyEquations;
use crate::mismatch::{Mismatch, set};

use super::CommandError;
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
    pub fn instance(&self, preset: &Preset, parameters: &[(String, f64)]) -> Result<Erased, Mismatch> {
        let mut instance = self.card.instance(preset)?;
        for (name, value) in parameters {
            set(instance.equations_mut(), name, *value).map_err(|mismatch| mismatch.of(&self.name))?;
        }
        Ok(instance)
    }

    /// [`instance`](Self::instance), if every mass, moment of inertia and stiffness is physically possible.
    pub fn sound_instance(
        &self,
        preset: &Preset,
        parameters: &[(String, f64)],
    ) -> Result<Erased, CommandError> {
        let instance = self.instance(preset, parameters)?;
        let equations = instance.equations();
        if parameters.is_empty() || equations.tables().is_none() {
            return Ok(instance);
        }
        let value = |name: &str| {
            let index = equations.variables().iter().position(|entry| entry.name == name)?;
            equations.get(index)
        };
        let found = mbs_codegen::impossible_values(equations.source(), Some(equations.scene()), value);
        match found.map_err(CommandError::Failed)?.as_slice() {
            [] => Ok(instance),
            found => Err(CommandError::Usage(format!("with these parameters {}", found.join(", ")))),
        }
    }

    /// One instance for each preset; a single one if the command line sets the parameters in which presets differ.
    pub fn instances(&self, parameters: &[(String, f64)]) -> Result<Vec<(Preset, Erased)>, CommandError> {
        let as_given = || Preset {
            label: "as given".to_string(),
            description: "parameters of the command line".to_string(),
            set: Vec::new(),
        };
        let given = |name: &str| parameters.iter().any(|(given, _)| given == name);
        let overridden = self.runs.iter().flat_map(|run| &run.set).any(|(name, _)| given(name));
        let presets = if overridden { vec![as_given()] } else { self.runs.clone() };
        let mut instances = Vec::new();
        for preset in presets {
            let instance = self.sound_instance(&preset, parameters)?;
            instances.push((preset, instance));
        }
        Ok(instances)
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

    mbs_runtime::mechanism! {
        pub mechanism Crank;
        param omega: rad/s = 1;
        param side: 1 = 1;
        coord phi: rad;
        drive motor: phi == side*omega*t;
        preset "to the left" { side: 1 }
        preset "to the right" { side: -1 }
        span turn(omega);
    }

    #[test]
    fn what_the_command_line_sets_overrules_the_presets() {
        let cards = [card!(self::Crank::default())];
        let catalogue = Catalogue { cards: &cards };
        let target = Target::find(&catalogue, &cards[0].name()).expect("in the list");
        let labels = |parameters: &[(String, f64)]| -> Vec<String> {
            let instances = target.instances(parameters).expect("parameters");
            instances.into_iter().map(|(preset, _)| preset.label).collect()
        };
        assert_eq!(labels(&[("omega".to_string(), 1.0)]).len(), target.runs().len());
        assert_eq!(labels(&[("side".to_string(), -1.0)]), ["as given"]);
    }
}
