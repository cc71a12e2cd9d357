//! Crates that the forge builds: their `Cargo.toml` and their one source file.

use std::path::Path;
use std::process::Command;

use super::{Forge, ForgeError, not_started, sources};
use crate::card::{Card, snake_case};
use crate::text_file::TextFile;

/// Head of the source file.
const HEAD: &str = "use std::process::ExitCode;";

/// A crate with one source file.
#[derive(Clone, Debug)]
pub struct Blueprint {
    /// Name of its folder before the hash: letters, digits and `_`.
    pub name: String,
    /// Dependencies, as lines of `Cargo.toml`.
    pub manifest: String,
    /// `src/main.rs`.
    pub main: String,
    /// The user's file, whose lines are those of `src/main.rs`.
    pub origin: Option<Origin>,
    /// `true` if the blueprint holds all but the sources of `mbs`: the same one always gives the same program.
    pub is_closed: bool,
}

/// The user's file that a source file was made from.
#[derive(Clone, Debug)]
pub struct Origin {
    /// Its path.
    pub path: String,
    /// Its content.
    pub content: String,
    /// A line that has a prefix in the source file, and the prefix's length in characters.
    pub shifted: (usize, usize),
}

impl Blueprint {
    /// `mbs` for the mechanism of a text.
    ///
    /// # Errors
    /// [`ForgeError::Functions`] where the text calls functions of the caller.
    pub fn of_text(text: &TextFile) -> Result<Self, ForgeError> {
        if !text.functions.is_empty() {
            let functions = text.functions.clone();
            return Err(ForgeError::Functions { mechanism: text.type_name(), functions });
        }
        let plain = snake_case(&text.name);
        // Words of Rust name no module.
        let is_word = syn::parse_str::<syn::Ident>(&plain).is_err();
        let module = if is_word { format!("{plain}_") } else { plain };
        let lines = text.source.chars().take_while(|c| *c == '\n').count();
        let (before, source) = text.source.split_at(lines);
        let prefix = format!("mod {module} {{ ::mbs_runtime::mechanism! {{ ");
        let card = format!("::mbs_workbench::card!({}::default())", text.type_name());
        // The user's lines keep their numbers, so nothing stands above them.
        let main = format!(
            "{before}{prefix}{source}\n}} pub const CARD: ::mbs_workbench::card::Card = {card}; }}\n\n{HEAD}\n\n\
             fn main() -> ExitCode {{\n    mbs_workbench::program(&[{module}::CARD])\n}}\n"
        );
        let shifted = (lines + 1, prefix.chars().count());
        Ok(Blueprint {
            name: snake_case(&text.type_name()),
            manifest: dependencies(&[]),
            main,
            origin: Some(Origin { path: text.path.clone(), content: text.content.clone(), shifted }),
            is_closed: true,
        })
    }

    /// A program called `name` on top of the library that declares the mechanism of `card`; `main` makes its source from the
    /// constructor. It is built with what the library is at that time.
    ///
    /// # Errors
    /// [`ForgeError::NoLibrary`] where the constructor does not begin with a library that the card's crate depends on by path.
    pub fn of_card(
        forge: &Forge,
        card: &Card,
        name: &str,
        main: impl FnOnce(&str) -> String,
    ) -> Result<Self, ForgeError> {
        let constructor = card.constructor;
        let no_library = || ForgeError::NoLibrary { constructor: constructor.to_string() };
        let first = constructor.trim_start_matches("::").split("::").next().unwrap_or_default().trim();
        let library = libraries(forge, Path::new(card.manifest))?
            .into_iter()
            .find(|library| library.name.replace('-', "_") == first)
            .ok_or_else(no_library)?;
        Ok(Blueprint {
            name: name.to_string(),
            manifest: dependencies(&[library]),
            main: main(constructor),
            origin: None,
            is_closed: false,
        })
    }

    /// `Cargo.toml` of the crate called `package`.
    pub(super) fn manifest(&self, package: &str) -> String {
        format!(
            "# Written by `mbs`, which deletes it again.\n[package]\nname = {}\nversion = \"0.0.0\"\nedition = \"2024\"\npublish = false\n\n\
             [dependencies]\n{}\n[workspace]\n",
            quoted(package),
            self.manifest
        )
    }
}

/// A library that a crate depends on by path.
struct Library {
    /// Name in the dependent crate.
    name: String,
    /// Name of its package.
    package: String,
    /// Its folder.
    path: String,
}

fn libraries(forge: &Forge, manifest: &Path) -> Result<Vec<Library>, ForgeError> {
    let mut command = Command::new(&forge.cargo);
    command.args(["metadata", "--no-deps", "--offline", "--format-version", "1", "--manifest-path"]);
    let manifest = manifest.join("Cargo.toml");
    let output = command.arg(&manifest).output().map_err(|error| not_started(&forge.cargo, &error))?;
    if !output.status.success() {
        return Err(ForgeError::Cargo(String::from_utf8_lossy(&output.stderr).trim().to_string()));
    }
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout)
        .map_err(|error| ForgeError::Cargo(format!("`cargo metadata` printed no JSON: {error}")))?;
    let packages = metadata["packages"].as_array().into_iter().flatten();
    let own = packages.filter(|package| {
        let path = package["manifest_path"].as_str().map(Path::new);
        path.is_some_and(|path| path == manifest || path.canonicalize().ok() == manifest.canonicalize().ok())
    });
    let dependencies = own.filter_map(|package| package["dependencies"].as_array()).flatten();
    let library = |dependency: &serde_json::Value| {
        let package = dependency["name"].as_str()?.to_string();
        let name = dependency["rename"].as_str().map_or_else(|| package.clone(), str::to_string);
        Some(Library { name, package, path: dependency["path"].as_str()?.to_string() })
    };
    Ok(dependencies.filter_map(library).collect())
}

/// The runtime, the program and libraries, as a program of the same sources has them.
fn dependencies(libraries: &[Library]) -> String {
    let path = |name: &str| quoted(&sources::folder().join(name).display().to_string());
    let mut lines = format!(
        "mbs-runtime = {{ path = {}, default-features = false }}\nmbs-workbench = {{ path = {} }}\n",
        path("mbs-runtime"),
        path("mbs-workbench")
    );
    for Library { name, package, path } in libraries {
        lines += &format!("{name} = {{ package = {}, path = {} }}\n", quoted(package), quoted(path));
    }
    lines
}

/// A string of TOML.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
