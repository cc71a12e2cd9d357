//! The Python environment with CasADi and mpmath, made on first use below cargo's target directory.
//!
//! One directory for each content of `requirements.txt` and interpreter: `mbs-oracle/<hash>/`. A lock file lets
//! one process make it while others wait. A stamp, renamed into place at the very end, marks a complete environment;
//! an incomplete one is deleted and made again.

use core::fmt;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::hash::hash;
use crate::target_directory::target_directory;

const REQUIREMENTS: &str = include_str!("../../oracle/requirements.txt");

/// Names the Python interpreter to use instead of `python3`.
pub const INTERPRETER_VARIABLE: &str = "MBS_PYTHON";

/// A Python interpreter that can import CasADi and mpmath.
#[derive(Clone, Debug)]
pub struct Environment {
    directory: PathBuf,
}

/// Reason why there is no Python environment, with the cure.
#[derive(Debug)]
pub enum EnvironmentError {
    /// The interpreter does not start.
    NoPython {
        /// The interpreter asked for.
        interpreter: String,
        /// Message of the operating system.
        reason: String,
    },
    /// The interpreter cannot make virtual environments.
    NoVenv {
        /// The interpreter.
        interpreter: String,
        /// Message of the interpreter.
        reason: String,
    },
    /// The packages could not be installed.
    NoPackages {
        /// Message of pip.
        reason: String,
    },
    /// A file or directory could not be made.
    Directory {
        /// The path.
        path: PathBuf,
        /// Message of the operating system.
        reason: String,
    },
}

impl Environment {
    /// The environment below cargo's target directory, made if it is not complete; `progress` gets messages about long actions.
    ///
    /// # Errors
    /// [`EnvironmentError`] with its cure.
    pub fn ready(progress: &dyn Fn(&str)) -> Result<Self, EnvironmentError> {
        Self::ready_for(REQUIREMENTS, progress)
    }

    /// One with other packages: `requirements` as pip reads them.
    ///
    /// # Errors
    /// [`EnvironmentError`] with its cure.
    pub fn ready_for(requirements: &str, progress: &dyn Fn(&str)) -> Result<Self, EnvironmentError> {
        let interpreter = std::env::var_os(INTERPRETER_VARIABLE)
            .filter(|value| !value.is_empty())
            .unwrap_or_else(|| OsString::from("python3"));
        Self::ready_in(&target_directory().join("mbs-oracle"), &interpreter, requirements, progress)
    }

    /// Directory for scratch files of this environment.
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// The environment's interpreter.
    pub fn python(&self) -> PathBuf {
        let program = if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" };
        self.directory.join("venv").join(program)
    }

    fn ready_in(
        base: &Path,
        interpreter: &OsString,
        requirements: &str,
        progress: &dyn Fn(&str),
    ) -> Result<Self, EnvironmentError> {
        let key = hash(&[interpreter.as_encoded_bytes(), requirements.as_bytes()]);
        let environment = Environment { directory: base.join(&key) };
        if environment.is_whole(&key) {
            return Ok(environment);
        }
        let directory = environment.directory.as_path();
        fs::create_dir_all(directory).map_err(|error| cannot_make(directory, &error))?;
        let path = directory.join("lock");
        let lock = File::create(&path).map_err(|error| cannot_make(&path, &error))?;
        lock.lock().map_err(|error| cannot_make(&path, &error))?;
        // Another process may have made it while this one waited.
        if !environment.is_whole(&key) {
            environment.make(interpreter, requirements, progress)?;
            let (draft, stamp) = (directory.join("ready.draft"), environment.stamp());
            fs::write(&draft, &key).map_err(|error| cannot_make(&draft, &error))?;
            fs::rename(&draft, &stamp).map_err(|error| cannot_make(&stamp, &error))?;
        }
        Ok(environment)
    }

    fn stamp(&self) -> PathBuf {
        self.directory.join("ready")
    }

    fn is_whole(&self, key: &str) -> bool {
        fs::read_to_string(self.stamp()).is_ok_and(|stamp| stamp == key) && self.python().exists()
    }

    fn make(
        &self,
        interpreter: &OsString,
        requirements: &str,
        progress: &dyn Fn(&str),
    ) -> Result<(), EnvironmentError> {
        let name = interpreter.to_string_lossy().into_owned();
        let venv = self.directory.join("venv");
        progress("making a Python environment");
        match fs::remove_dir_all(&venv) {
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(cannot_make(&venv, &error)),
            _ => {}
        }
        let output = Command::new(interpreter).args(["-m", "venv"]).arg(&venv).output();
        let output = output.map_err(|error| EnvironmentError::NoPython {
            interpreter: name.clone(),
            reason: error.to_string(),
        })?;
        if !output.status.success() {
            return Err(EnvironmentError::NoVenv { interpreter: name, reason: last_words(&output) });
        }
        progress("installing CasADi and mpmath");
        let list = self.directory.join("requirements.txt");
        fs::write(&list, requirements).map_err(|error| cannot_make(&list, &error))?;
        let output = Command::new(self.python())
            .args(["-m", "pip", "install", "--disable-pip-version-check", "--quiet", "-r"])
            .arg(&list)
            .output();
        match output {
            Ok(output) if output.status.success() => Ok(()),
            Ok(output) => Err(EnvironmentError::NoPackages { reason: last_words(&output) }),
            Err(error) => Err(EnvironmentError::NoPackages { reason: error.to_string() }),
        }
    }
}

fn cannot_make(path: &Path, error: &std::io::Error) -> EnvironmentError {
    EnvironmentError::Directory { path: path.to_path_buf(), reason: error.to_string() }
}

/// The last lines of a process's output, on either channel: Python's `venv` writes its errors to the first.
fn last_words(output: &Output) -> String {
    /// Enough for pip's error without its retries.
    const LINES: usize = 6;
    let both = [output.stdout.as_slice(), output.stderr.as_slice()].concat();
    let text = String::from_utf8_lossy(&both);
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    if lines.is_empty() {
        return output.status.to_string();
    }
    lines[lines.len().saturating_sub(LINES)..].join("\n")
}

impl fmt::Display for EnvironmentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EnvironmentError::NoPython { interpreter, reason } => write!(
                f,
                "the cross-check needs Python 3, but `{interpreter}` does not start: {reason}\n\
                 install Python 3, or name an interpreter in {INTERPRETER_VARIABLE}"
            ),
            EnvironmentError::NoVenv { interpreter, reason } => write!(
                f,
                "`{interpreter}` cannot make a virtual environment:\n{reason}\n\
                 install its `venv` module (Debian, Ubuntu: package `python3-venv`), or name another interpreter \
                 in {INTERPRETER_VARIABLE}"
            ),
            EnvironmentError::NoPackages { reason } => write!(
                f,
                "pip could not install {}:\n{reason}\n\
                 check the network, or tell pip where packages are (PIP_INDEX_URL, PIP_FIND_LINKS); Python 3.11 or \
                 newer is needed",
                REQUIREMENTS.split_whitespace().collect::<Vec<_>>().join(", ")
            ),
            EnvironmentError::Directory { path, reason } => {
                write!(
                    f,
                    "cannot make {}: {reason}\nset CARGO_TARGET_DIR to a writable directory",
                    path.display()
                )
            }
        }
    }
}

impl core::error::Error for EnvironmentError {}

#[cfg(test)]
mod tests {
    use super::*;

    fn scratch(name: &str) -> PathBuf {
        let directory =
            target_directory().join("tmp").join(format!("environment-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&directory);
        directory
    }

    fn make(base: &Path, interpreter: &str, requirements: &str) -> Result<Environment, EnvironmentError> {
        Environment::ready_in(base, &OsString::from(interpreter), requirements, &|_| ())
    }

    #[test]
    fn a_missing_interpreter_is_named_with_the_cure() {
        let base = scratch("missing");
        let text = make(&base, "no-such-python", "").expect_err("no such program").to_string();
        assert!(text.contains("no-such-python") && text.contains("MBS_PYTHON"), "{text}");
        let _ = fs::remove_dir_all(base);
    }

    #[cfg(unix)]
    #[test]
    fn an_interpreter_without_venv_is_told_from_a_missing_one() {
        let base = scratch("venv");
        let error = make(&base, "false", "").expect_err("no Python");
        assert!(matches!(error, EnvironmentError::NoVenv { .. }), "{error}");
        assert!(error.to_string().contains("python3-venv"));
        let _ = fs::remove_dir_all(base);
    }

    #[test]
    fn a_half_made_environment_is_made_again_and_a_whole_one_kept() {
        let base = scratch("half");
        let first = make(&base, "python3", "").expect("Python 3 with venv");
        let mark = first.directory.join("venv").join("mark");
        fs::write(&mark, "").expect("a file");
        make(&base, "python3", "").expect("it is there");
        assert!(mark.exists(), "a whole environment was made again");
        fs::remove_file(first.stamp()).expect("the stamp");
        make(&base, "python3", "").expect("Python 3 with venv");
        assert!(!mark.exists(), "a half-made environment was kept");
        let _ = fs::remove_dir_all(base);
    }

    #[test]
    fn packages_that_cannot_be_had_are_no_environment() {
        let base = scratch("packages");
        let text = make(&base, "python3", "./no-such-package.whl\n").expect_err("no such file").to_string();
        assert!(text.contains("pip could not install") && text.contains("PIP_INDEX_URL"), "{text}");
        let _ = fs::remove_dir_all(base);
    }

    #[test]
    fn threads_that_come_together_make_one_environment() {
        let base = scratch("together");
        let made = std::sync::atomic::AtomicU32::new(0);
        std::thread::scope(|scope| {
            for _ in 0..3 {
                scope.spawn(|| {
                    let count = |step: &str| {
                        made.fetch_add(
                            u32::from(step.starts_with("making")),
                            std::sync::atomic::Ordering::Relaxed,
                        );
                    };
                    Environment::ready_in(&base, &OsString::from("python3"), "", &count).expect("Python 3");
                });
            }
        });
        assert_eq!(made.into_inner(), 1);
        let _ = fs::remove_dir_all(base);
    }
}
