//! Sources of `mbs` itself, and the workspace of its caller.

use core::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Crates that a program is built from, with what they read at compile time.
const CRATES: [&str; 4] = ["mbs-codegen", "mbs-macros", "mbs-runtime", "mbs-workbench"];

/// Folder of the sources that the running program was built from.
pub fn folder() -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.parent().unwrap_or(own).to_path_buf()
}

/// The nearest folder at or above `manifest` with a `Cargo.lock`.
pub fn workspace_of(manifest: &Path) -> Option<PathBuf> {
    manifest.ancestors().find(|folder| folder.join("Cargo.lock").is_file()).map(Path::to_path_buf)
}

/// Tables of profiles in the `Cargo.toml` of a workspace: with the same settings a crate is built once.
pub fn profiles(workspace: &Path) -> String {
    let text = fs::read_to_string(workspace.join("Cargo.toml")).unwrap_or_default();
    let mut inside = false;
    let mut found = String::new();
    for line in text.lines() {
        if line.trim_start().starts_with('[') {
            inside = line.trim_start().starts_with("[profile");
        }
        if inside {
            found.push_str(line);
            found.push('\n');
        }
    }
    found
}

/// Names, sizes and times of all source files below `sources`: another state asks for another program.
pub fn state(sources: &Path) -> String {
    let mut state = String::new();
    for name in CRATES {
        let root = sources.join(name);
        describe(&root.join("Cargo.toml"), &mut state);
        // What the sources include stands beside them.
        let mut folders: Vec<PathBuf> =
            ["src", "data", "oracle", "peers", "template"].iter().map(|folder| root.join(folder)).collect();
        while let Some(folder) = folders.pop() {
            let mut entries: Vec<PathBuf> =
                fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
            entries.sort();
            for path in entries {
                if path.is_dir() { folders.push(path) } else { describe(&path, &mut state) }
            }
        }
    }
    state
}

fn describe(path: &Path, state: &mut String) {
    let Ok(data) = fs::metadata(path) else { return };
    let time = data.modified().ok().and_then(|time| time.duration_since(SystemTime::UNIX_EPOCH).ok());
    // Writing to a string succeeds.
    let _ = writeln!(state, "{} {} {:?}", path.display(), data.len(), time);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_profiles_of_a_workspace_are_its_tables_of_that_name() {
        let found = profiles(&folder());
        assert!(
            found.contains("[profile.dev]\n") && found.contains("[profile.release.package.mbs-codegen]\n")
        );
        assert!(!found.contains("[workspace") && !found.contains("members"), "{found}");
    }

    #[test]
    fn the_state_of_the_sources_names_every_file() {
        let state = state(&folder());
        for file in ["forge/sources.rs", "report/page.css", "mbs-macros/Cargo.toml"] {
            assert!(state.contains(file), "{file} is missing");
        }
    }
}
