//! Builds the crates of `tests/proofs`, a workspace of its own.

use std::env;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::tools;

/// The workspace of the proof crates.
pub fn directory() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs")
}

/// Build directory of the proof crates, one for each set of compiler flags, below the tests' own target directory.
pub struct Workshop {
    target: PathBuf,
    flags: &'static str,
    variables: Vec<(&'static str, OsString)>,
}

impl Workshop {
    /// A workshop below `scratch`, a test's `CARGO_TARGET_TMPDIR`; `flags` go to the Rust compiler.
    pub fn new(scratch: &str, name: &str, flags: &'static str) -> Self {
        Workshop { target: Path::new(scratch).join(name), flags, variables: Vec::new() }
    }

    /// Sets an environment variable of the build.
    pub fn set(&mut self, name: &'static str, value: &OsStr) {
        self.variables.push((name, value.to_owned()));
    }

    /// Target directory of the builds.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Runs `cargo build` with `arguments` and copies `product`, relative to the target directory, to `copy` there.
    ///
    /// The product's name does not contain its features: a copy is needed before the next build overwrites it.
    ///
    /// # Errors
    /// Messages of the compiler or the linker.
    ///
    /// # Panics
    /// If cargo does not start or a file cannot be written.
    pub fn build(&self, arguments: &[&str], product: &str, copy: &str) -> Result<PathBuf, String> {
        let made = |path: &Path, result: std::io::Result<()>| {
            result.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        };
        made(&self.target, fs::create_dir_all(&self.target));
        // Profiles have directories of their own.
        let profile = product.split('/').next().unwrap_or_default();
        let lock_file = self.target.join(format!("lock-{profile}"));
        let lock = File::create(&lock_file);
        made(&lock_file, lock.as_ref().map_or_else(|_| Ok(()), File::lock));
        tools::output(self.cargo().args(arguments), "the tests need cargo, which runs them")?;
        let copy = self.target.join(copy);
        made(&copy, fs::copy(self.target.join(product), &copy).map(drop));
        Ok(copy)
    }

    /// `cargo build` with the proof workspace's own profiles: settings of the outer run do not reach it.
    fn cargo(&self) -> Command {
        let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        command.arg("build").current_dir(directory());
        for (name, _) in env::vars_os() {
            let profile = name.to_string_lossy().starts_with("CARGO_PROFILE_");
            if profile || OUTER_SETTINGS.iter().any(|setting| name == *setting) {
                command.env_remove(&name);
            }
        }
        command.env("CARGO_TARGET_DIR", &self.target).env("RUSTFLAGS", self.flags);
        command.envs(self.variables.iter().map(|(name, value)| (name, value)));
        command
    }
}

/// Variables of cargo and rustc that would change the code under proof or its place.
const OUTER_SETTINGS: [&str; 4] =
    ["CARGO_ENCODED_RUSTFLAGS", "CARGO_BUILD_RUSTFLAGS", "CARGO_BUILD_TARGET", "CARGO_INCREMENTAL"];
