//! Crates that tests write below the target directory and build there, each a workspace of its own.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Profiles of these crates and of `tests/editions`. Without debug information the macro's library is built only once, as for
/// programs.
const PROFILE: &str = r#"
[profile.dev]
debug = false

[profile.dev.package.mbs-runtime]
opt-level = 2
"#;

/// A crate of a test.
pub struct WrittenCrate {
    directory: PathBuf,
    target: PathBuf,
}

impl WrittenCrate {
    /// A crate below `scratch`, a test's `CARGO_TARGET_TMPDIR`, with this `Cargo.toml`; in it `../../` is this
    /// workspace.
    ///
    /// It has the workspace's versions of all dependencies, which are built once for all such crates.
    ///
    /// # Panics
    /// If a file cannot be written.
    pub fn new(scratch: &str, name: &str, manifest: &str) -> Self {
        let scratch = Path::new(scratch);
        let target = scratch.parent().unwrap_or(scratch).to_path_buf();
        let made = WrittenCrate { directory: scratch.join(name), target };
        let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize();
        let workspace = workspace.expect("the workspace").display().to_string().replace('\\', "/");
        made.write("Cargo.toml", &(manifest.replace("../../", &format!("{workspace}/")) + PROFILE));
        let lock_file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../Cargo.lock");
        made.write("Cargo.lock", &fs::read_to_string(lock_file).expect("the workspace's Cargo.lock"));
        made
    }

    /// Writes a file, unless it exists with this text: cargo rebuilds what is newer.
    ///
    /// # Panics
    /// If it cannot be written.
    pub fn write(&self, path: &str, text: &str) {
        let path = self.directory.join(path);
        let made = |result: std::io::Result<()>| {
            result.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        };
        if !fs::read_to_string(&path).is_ok_and(|present| present == text) {
            made(path.parent().map_or(Ok(()), fs::create_dir_all));
            made(fs::write(&path, text));
        }
    }

    /// `cargo` in this crate.
    pub fn cargo(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        command.args(arguments).current_dir(&self.directory).env("CARGO_TARGET_DIR", &self.target);
        command
    }
}
