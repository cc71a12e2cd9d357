//! What `mbs run` needs of a mechanism, whether its rows fix it or forces move it.

use mechanisms::drawing::Shape;
use mechanisms::facade::{AnyEquations, AnyMechanism};
use mechanisms::registry::{self, Card, FREE, FreeCard, Mismatch, Preset, Usual};

use super::CommandError;

/// A mechanism of the list.
#[derive(Clone, Copy)]
pub enum Subject {
    /// Its rows fix it.
    Fixed(&'static Card),
    /// Forces move it.
    Free(&'static FreeCard),
}

/// A mechanism with parameters.
pub enum Instance {
    /// Its rows fix it.
    Fixed(Box<dyn AnyMechanism>),
    /// Forces move it.
    Free(Box<dyn AnyEquations>),
}

impl Subject {
    /// The mechanism called `name`.
    pub fn find(name: &str) -> Result<Self, Mismatch> {
        match FREE.iter().find(|card| card.name == name) {
            Some(card) => Ok(Subject::Free(card)),
            None => registry::find(name).map(Subject::Fixed),
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Subject::Fixed(card) => card.name,
            Subject::Free(card) => card.name,
        }
    }

    pub fn title(self) -> &'static str {
        match self {
            Subject::Fixed(card) => card.title,
            Subject::Free(card) => card.title,
        }
    }

    pub fn description(self) -> &'static str {
        match self {
            Subject::Fixed(card) => card.description,
            Subject::Free(card) => card.description,
        }
    }

    pub fn runs(self) -> &'static [Preset] {
        match self {
            Subject::Fixed(card) => card.runs,
            Subject::Free(card) => card.runs,
        }
    }

    /// What moves it where the command line says nothing.
    pub fn usual(self) -> Usual {
        match self {
            Subject::Fixed(_) => Usual::Projection,
            Subject::Free(card) => card.usual,
        }
    }

    pub fn drawing(self) -> &'static [Shape] {
        match self {
            Subject::Fixed(card) => card.drawing,
            Subject::Free(card) => card.drawing,
        }
    }

    /// An instance with the preset's parameters and those of the command line.
    pub fn instance(self, preset: &Preset, parameters: &[(String, f64)]) -> Result<Instance, Mismatch> {
        let mut instance = match self {
            Subject::Fixed(card) => Instance::Fixed(card.instance(preset)?),
            Subject::Free(card) => Instance::Free(card.instance(preset)?),
        };
        for (name, value) in parameters {
            let set = match &mut instance {
                Instance::Fixed(mechanism) => registry::set(mechanism.as_mut(), name, *value),
                Instance::Free(mechanism) => registry::set(mechanism.as_mut(), name, *value),
            };
            set.map_err(|mismatch| mismatch.of(self.name()))?;
        }
        Ok(instance)
    }

    /// [`instance`](Self::instance), where every mass, moment of inertia or stiffness is one that something can have.
    pub fn sound_instance(
        self,
        preset: &Preset,
        parameters: &[(String, f64)],
    ) -> Result<Instance, CommandError> {
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

    /// One instance a preset; where the command line sets what presets differ in, one as it says.
    pub fn instances(self, parameters: &[(String, f64)]) -> Result<Vec<(Preset, Instance)>, CommandError> {
        const AS_GIVEN: Preset =
            Preset { label: "as given", description: "parameters of the command line", set: &[] };
        let given = |name: &str| parameters.iter().any(|(given, _)| given == name);
        let own = [AS_GIVEN];
        let overridden = self.runs().iter().flat_map(|run| run.set).any(|(name, _)| given(name));
        let presets = if overridden { &own[..] } else { self.runs() };
        let mut instances = Vec::new();
        for preset in presets {
            instances.push((*preset, self.sound_instance(preset, parameters)?));
        }
        Ok(instances)
    }

    /// Duration (s) of the motion of `instance`.
    pub fn duration(self, instance: &Instance) -> Result<f64, Mismatch> {
        match (self, instance) {
            (Subject::Fixed(card), Instance::Fixed(mechanism)) => card.duration(mechanism.as_ref()),
            (Subject::Fixed(card), Instance::Free(_)) => Err(Mismatch::Free { name: card.name.to_string() }),
            (Subject::Free(card), _) => Ok(card.duration),
        }
    }
}

impl Instance {
    /// Names and functions, whatever the analysis.
    pub fn equations(&self) -> &dyn AnyEquations {
        match self {
            Instance::Fixed(mechanism) => mechanism.as_ref(),
            Instance::Free(mechanism) => mechanism.as_ref(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_command_line_sets_overrules_the_presets() {
        let subject = Subject::find(registry::ALL[0].name).expect("in the list");
        let labels = |parameters: &[(String, f64)]| -> Vec<&str> {
            let instances = subject.instances(parameters).expect("parameters");
            instances.iter().map(|(preset, _)| preset.label).collect()
        };
        assert_eq!(labels(&[("omega".to_string(), 1.0)]).len(), subject.runs().len());
        assert_eq!(labels(&[("side".to_string(), -1.0)]), ["as given"]);
    }
}
