//! Cargo's target directory; reports and the Python environment are written there too.

use std::env;
use std::path::{Path, PathBuf};

/// The target directory that the running program was built in.
///
/// That is the nearest directory above the program with cargo's mark `CACHEDIR.TAG`, else `CARGO_TARGET_DIR`,
/// else `target` in the current directory.
pub fn target_directory() -> PathBuf {
    let program = env::current_exe().ok();
    let built_in = program.as_deref().and_then(marked_ancestor);
    built_in
        .or_else(|| env::var_os("CARGO_TARGET_DIR").filter(|path| !path.is_empty()).map(PathBuf::from))
        .unwrap_or_else(|| PathBuf::from("target"))
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
