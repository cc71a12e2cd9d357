//! The built-in list of hard cases: a text and its description each, in the folder `hard_cases` of the crate.

pub mod description;
#[cfg(test)]
mod pages;
mod refusals;
pub mod sampled;
mod stored;
#[cfg(test)]
mod tests;

use std::fs;
use std::path::{Path, PathBuf};

use self::description::Description;
use crate::card::Card;
use crate::hard_cases::study::Make;

/// A case in the program that was built for it: name, card, and what makes its variants.
pub type Listed = (&'static str, Card, Make);

/// A hard case.
#[derive(Clone, Debug)]
pub struct Case {
    /// Name of its two files.
    pub name: String,
    /// Text of its mechanism.
    pub text: String,
    /// Its references, bounds and range.
    pub description: Description,
}

/// Folder of the cases: that of the sources, which a program for their texts needs as well.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("hard_cases")
}

/// All cases by their names.
///
/// # Errors
/// A file that cannot be read, or the fault of a description, with its line.
pub fn cases() -> Result<Vec<Case>, String> {
    let folder = folder();
    let unreadable = |path: &Path, error: std::io::Error| format!("cannot read {}: {error}", path.display());
    let entries = fs::read_dir(&folder).map_err(|error| unreadable(&folder, error))?;
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|suffix| suffix == "mbs"));
    paths.sort();
    paths
        .into_iter()
        .map(|path| {
            let read = |path: &Path| fs::read_to_string(path).map_err(|error| unreadable(path, error));
            let beside = path.with_extension("toml");
            let description = Description::read(&read(&beside)?);
            let mut description = description.map_err(|fault| format!("{}: {fault}", beside.display()))?;
            for table in &mut description.tables {
                table.fill(&read(&path.with_file_name(&table.file))?)?;
            }
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            Ok(Case { name, text: read(&path)?, description })
        })
        .collect()
}

impl Case {
    /// Name of its type: `ChangePoint` of `change_point`.
    pub fn type_name(&self) -> String {
        let capital = |word: &str| {
            let mut letters = word.chars();
            letters.next().map(|first| first.to_ascii_uppercase().to_string() + letters.as_str())
        };
        self.name.split('_').filter_map(capital).collect()
    }
}
