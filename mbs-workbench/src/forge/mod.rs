//! The forge: programs for mechanisms that the running program does not have, built on demand.
//!
//! It writes a crate below `mbs/` in cargo's target directory, one folder for each content. The build has the lock file, the
//! profiles and the target directory of the caller. So what both need is built once. No source tree is written to.

mod blueprint;
mod build;
mod sources;

use core::fmt;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

pub use self::blueprint::{Blueprint, NameFrom, Study};
use crate::hash::hash;
use crate::target_directory::{known_target_directory, target_directory};

/// Programs of one name that are kept: as many as texts one goes to and fro between.
const KEPT: usize = 8;

/// Builds programs on behalf of a caller.
#[derive(Clone, Debug)]
pub struct Forge {
    /// The program `cargo`.
    pub cargo: OsString,
    /// Cargo's target directory, that of the caller.
    pub target: PathBuf,
    /// Folder whose `Cargo.lock` and profiles hold, the caller's workspace.
    pub workspace: PathBuf,
    /// `true` for an optimised program.
    pub release: bool,
    /// Flags of the compiler for all crates, beside those of the environment; empty: none.
    pub flags: &'static str,
}

/// Reason why there is no program, with the cure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ForgeError {
    /// `cargo` does not start.
    NoCargo {
        /// The program asked for.
        cargo: String,
        /// Message of the operating system.
        reason: String,
    },
    /// The sources that `mbs` was built from are not there.
    NoSources {
        /// Their folder.
        path: PathBuf,
    },
    /// The constructor of a card does not begin with a library.
    NoLibrary {
        /// The constructor.
        constructor: String,
    },
    /// A file could not be written.
    File {
        /// The file.
        path: PathBuf,
        /// Message of the operating system.
        reason: String,
    },
    /// Errors of the compiler, with lines of the user's file.
    Faults(String),
    /// Cargo failed before it compiled the text.
    Cargo(String),
}

impl Forge {
    /// The forge of the running program, whose mechanisms are declared in the crate in folder `manifest`; without one it has the
    /// lock file of `mbs` itself.
    pub fn of_caller(manifest: Option<&Path>) -> Self {
        let own = sources::folder();
        let workspace = manifest.and_then(sources::workspace_of).unwrap_or_else(|| own.clone());
        // A program that is installed has no target directory; that of its sources holds what it was built from.
        let target = known_target_directory()
            .or_else(|| Some(own.join("target")).filter(|path| path.is_dir()))
            .unwrap_or_else(target_directory);
        Forge {
            cargo: std::env::var_os("CARGO")
                .filter(|path| !path.is_empty())
                .unwrap_or_else(|| "cargo".into()),
            target: std::path::absolute(&target).unwrap_or(target),
            workspace,
            release: !cfg!(debug_assertions),
            flags: "",
        }
    }

    /// The program of a blueprint, built unless it is there. `progress` gets one phrase for each action that takes time.
    ///
    /// # Errors
    /// [`ForgeError`]; errors of the compiler are those of the user's file.
    pub fn program(
        &self,
        blueprint: &Blueprint,
        progress: &mut dyn FnMut(&str),
    ) -> Result<PathBuf, ForgeError> {
        let own = sources::folder();
        if !own.join("mbs-runtime").is_dir() {
            return Err(ForgeError::NoSources { path: own });
        }
        let lock_file = fs::read_to_string(self.workspace.join("Cargo.lock")).unwrap_or_default();
        let profiles = sources::profiles(&self.workspace);
        let state = sources::state(&own);
        let key = hash(&[
            blueprint.manifest.as_bytes(),
            blueprint.main.as_bytes(),
            lock_file.as_bytes(),
            profiles.as_bytes(),
            state.as_bytes(),
            &[u8::from(self.release)],
            self.flags.as_bytes(),
        ]);
        let works = self.target.join("mbs");
        let package = format!("{}-{key}", blueprint.name);
        let folder = works.join(&package);
        let program = folder.join(format!("program{}", std::env::consts::EXE_SUFFIX));
        fs::create_dir_all(&folder).map_err(|error| cannot_write(&folder, &error))?;
        let path = folder.join("lock");
        let lock = File::create(&path).map_err(|error| cannot_write(&path, &error))?;
        lock.lock().map_err(|error| cannot_write(&path, &error))?;
        // Another process may have built it while this one waited.
        if blueprint.is_closed && program.is_file() {
            let used = File::open(&program).and_then(|file| file.set_modified(SystemTime::now()));
            // Only the order in which old programs are deleted depends on it.
            drop(used);
            return Ok(program);
        }
        write(&folder.join("src").join("main.rs"), &blueprint.main)?;
        write(&folder.join("Cargo.toml"), &format!("{}\n{profiles}", blueprint.manifest(&package)))?;
        if !lock_file.is_empty() && !folder.join("Cargo.lock").is_file() {
            write(&folder.join("Cargo.lock"), &lock_file)?;
        }
        let built = self.build(&folder, blueprint, progress).inspect_err(|_| {
            let profile = if self.release { "release" } else { "debug" };
            clean(&self.target.join(profile), &package);
        })?;
        let draft = folder.join("program.draft");
        fs::copy(&built, &draft).map_err(|error| cannot_write(&draft, &error))?;
        fs::rename(&draft, &program).map_err(|error| cannot_write(&program, &error))?;
        if let (true, Some(profile)) = (blueprint.is_closed, built.parent()) {
            clean(profile, &package);
        }
        retire(&works, &blueprint.name, &package);
        Ok(program)
    }
}

/// Deletes what cargo keeps of a crate that will not be built again, below the folder of its profile.
fn clean(profile: &Path, package: &str) {
    let crate_name = package.replace('-', "_");
    for folder in ["", "deps", ".fingerprint", "incremental"] {
        let entries = fs::read_dir(profile.join(folder)).into_iter().flatten().flatten();
        for entry in entries {
            if entry.file_name().to_string_lossy().replace('-', "_").starts_with(&crate_name) {
                remove(&entry.path());
            }
        }
    }
}

/// Writes a file unless it has this text: cargo builds anew what is newer.
fn write(path: &Path, text: &str) -> Result<(), ForgeError> {
    if fs::read_to_string(path).is_ok_and(|present| present == text) {
        return Ok(());
    }
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|error| cannot_write(folder, &error))?;
    }
    fs::write(path, text).map_err(|error| cannot_write(path, &error))
}

/// Deletes the programs of this name that were not used for longest, those of other processes left alone.
fn retire(works: &Path, name: &str, package: &str) {
    let entries = fs::read_dir(works).into_iter().flatten().flatten();
    let others = entries.filter(|entry| {
        let folder = entry.file_name().to_string_lossy().into_owned();
        let key = folder.strip_prefix(name).and_then(|rest| rest.strip_prefix('-'));
        folder != package && key.is_some_and(|key| key.len() == 16 && u64::from_str_radix(key, 16).is_ok())
    });
    let used = |folder: &Path| {
        let program = folder.join(format!("program{}", std::env::consts::EXE_SUFFIX));
        fs::metadata(program).and_then(|data| data.modified()).unwrap_or(SystemTime::UNIX_EPOCH)
    };
    let mut others: Vec<_> = others.map(|entry| (used(&entry.path()), entry.path())).collect();
    others.sort();
    let most = others.len().saturating_sub(KEPT.saturating_sub(1));
    for (_, folder) in others.into_iter().take(most) {
        let lock = File::create(folder.join("lock"));
        if lock.as_ref().is_ok_and(|lock| lock.try_lock().is_ok()) {
            remove(&folder);
        }
    }
}

/// Deletes a file or a folder; one that stays costs space alone.
fn remove(path: &Path) {
    let removed = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    drop(removed);
}

fn cannot_write(path: &Path, error: &std::io::Error) -> ForgeError {
    ForgeError::File { path: path.to_path_buf(), reason: error.to_string() }
}

fn not_started(cargo: &OsString, error: &std::io::Error) -> ForgeError {
    let reason = match error.kind() {
        ErrorKind::NotFound => "it is not installed, or not on the path".to_string(),
        _ => error.to_string(),
    };
    ForgeError::NoCargo { cargo: cargo.to_string_lossy().into_owned(), reason }
}

impl fmt::Display for ForgeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ForgeError::NoCargo { cargo, reason } => write!(
                f,
                "a program for this text must be built, but `{cargo}` does not start: {reason}\n\
                 install Rust (https://rustup.rs), or use a command that needs the text alone: \
                 `mbs structure`, `latex`, `expand`, `print --symbols`"
            ),
            ForgeError::NoSources { path } => write!(
                f,
                "the sources that `mbs` was built from are no longer in {}\n\
                 install it again from where they are: `cargo install --locked --path mbs-workbench`",
                path.display()
            ),
            ForgeError::NoLibrary { constructor } => write!(
                f,
                "`{constructor}` is declared in the program itself; move it to a library that the program depends on, \
                 and name that in the card: `card!(my_crate::{constructor})`"
            ),
            ForgeError::File { path, reason } => write!(
                f,
                "cannot write {}: {reason}\nset CARGO_TARGET_DIR to a directory that can be written to",
                path.display()
            ),
            ForgeError::Faults(text) => f.write_str(text),
            ForgeError::Cargo(text) => write!(f, "cargo could not build the program of this text\n{text}"),
        }
    }
}

impl core::error::Error for ForgeError {}

#[cfg(all(test, unix))]
mod tests;
