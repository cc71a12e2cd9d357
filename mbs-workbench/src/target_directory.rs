//! Cargo's target directory; reports and the Python environment are written there too.

use std::env;
use std::path::{Path, PathBuf};

/// Names the target directory of the program that starts another one, which has been built for a text of a file.
pub const STARTED_FROM: &str = "MBS_STARTED_FROM";

/// `true` if the program was built for the text of a file, and started by another one.
pub fn is_started() -> bool {
    env::var_os(STARTED_FROM).is_some_and(|path| !path.is_empty())
}

/// The target directory that the running program was built in, else `target` in the current directory.
pub fn target_directory() -> PathBuf {
    known_target_directory().unwrap_or_else(|| PathBuf::from("target"))
}

/// The target directory that the running program was built in.
///
/// That is the one in [`STARTED_FROM`], else the nearest directory above the program with cargo's mark `CACHEDIR.TAG`, else
/// `CARGO_TARGET_DIR`.
pub fn known_target_directory() -> Option<PathBuf> {
    let named = |name: &str| env::var_os(name).filter(|path| !path.is_empty()).map(PathBuf::from);
    let built_in = || env::current_exe().ok().as_deref().and_then(marked_ancestor);
    named(STARTED_FROM).or_else(built_in).or_else(|| named("CARGO_TARGET_DIR"))
}

fn marked_ancestor(program: &Path) -> Option<PathBuf> {
    program.ancestors().skip(1).find(|path| path.join("CACHEDIR.TAG").is_file()).map(Path::to_path_buf)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tests_program_was_built_in_the_target_directory() {
        let program = env::current_exe().expect("a path");
        let directory = marked_ancestor(&program).expect("cargo marks its directory");
        assert!(program.starts_with(&directory));
        assert_eq!(directory, target_directory());
    }
}
