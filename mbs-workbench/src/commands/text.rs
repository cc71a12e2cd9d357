//! The text of a mechanism, for commands that need no code: of a file it is read without a build.

use mbs_codegen::picture::{Picture, picture};
use mbs_codegen::{StructureReport, WHOLE};

use super::CommandError;
use super::chosen::Chosen;
use super::document::Output;
use crate::catalogue::Catalogue;
use crate::mismatch::Mismatch;
use crate::output::latex::{Value, values};
use crate::output::origin::Origin;
use crate::text_file::{TextFile, is_file};

/// A text without faults in a scene.
pub struct Text {
    /// Name as it was asked for.
    pub name: String,
    pub title: String,
    pub source: String,
    scene: Option<String>,
    /// Parameters and inputs in the order of the formulas: those of the first preset and of the command line.
    pub values: Vec<Value>,
}

impl Text {
    /// The text of a mechanism of the list, or of one in a file.
    pub fn find(catalogue: &Catalogue, chosen: &Chosen) -> Result<Self, CommandError> {
        if is_file(chosen.name()) && chosen.is_plain() {
            return Self::of_file(chosen.name());
        }
        let described = chosen.described(catalogue)?;
        let mechanism = described.equations();
        Ok(Text {
            name: described.target.name().to_string(),
            title: described.target.title().to_string(),
            source: mechanism.source().to_string(),
            scene: Some(mechanism.scene().to_string()),
            values: values(mechanism),
        })
    }

    fn of_file(argument: &str) -> Result<Self, CommandError> {
        let TextFile { source, scene, .. } = TextFile::read(argument)?;
        let unread = |faults| Mismatch::Text { name: argument.to_string(), faults };
        let Picture { title, presets, .. } = picture(&source, scene.as_deref()).map_err(unread)?;
        let variables = mbs_codegen::variables(&source, scene.as_deref()).map_err(CommandError::Failed)?;
        let preset = presets.first().map(|preset| preset.set.as_slice()).unwrap_or_default();
        let value = |variable: mbs_codegen::Variable| {
            let set = preset.iter().find(|(name, _)| *name == variable.name);
            Value { unit: variable.unit, value: Some(set.map_or(variable.default, |(_, value)| *value)) }
        };
        let name = argument.to_string();
        Ok(Text { name, title, source, scene, values: variables.into_iter().map(value).collect() })
    }

    /// Names the text in the output; its origin is that of the files.
    pub fn put(&self, out: &mut Output) -> Origin {
        let origin = Origin::of_text(&self.name, &self.source);
        let scene = self.scene().filter(|scene| *scene != WHOLE);
        out.put_text(&origin, &self.title, scene);
        origin
    }

    pub fn scene(&self) -> Option<&str> {
        self.scene.as_deref()
    }

    /// Sparsity, matching and order of solution.
    pub fn structure(&self) -> Result<StructureReport, CommandError> {
        mbs_codegen::structure_of(&self.source, self.scene()).map_err(CommandError::Failed)
    }
}
