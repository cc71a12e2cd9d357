//! CasADi as a child process: a definition and states in, values of all functions out.

use core::fmt;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio, id};
use std::sync::atomic::{AtomicU32, Ordering};

use serde::{Deserialize, Serialize};

use super::environment::{Environment, EnvironmentError};
use super::states::Sample;

const SCRIPT: &str = include_str!("../../oracle/oracle.py");

/// CasADi, ready to run.
#[derive(Debug)]
pub struct Oracle {
    environment: Environment,
}

/// Why CasADi gave no values.
#[derive(Debug)]
pub enum OracleError {
    /// The child process did not run or did not end well.
    Process {
        /// What it said last.
        reason: String,
    },
    /// The answer does not fit the mechanism.
    Answer {
        /// What does not fit.
        reason: String,
    },
}

/// Values of one function: a row a state, an entry a component; `None` where the definition has no such derivative.
pub type Values = Vec<Vec<Option<f64>>>;

/// Values of all functions at all states.
#[derive(Debug, Deserialize)]
pub struct Answer {
    /// Name in the definition.
    pub name: String,
    /// Number of coordinates.
    pub n: usize,
    /// Number of variables.
    pub v: usize,
    /// Values by function.
    #[serde(flatten, deserialize_with = "functions")]
    pub functions: std::collections::BTreeMap<String, Values>,
}

#[derive(Serialize)]
struct Question<'a> {
    states: Vec<QuestionState<'a>>,
}

#[derive(Serialize)]
struct QuestionState<'a> {
    q: &'a [f64],
    qd: &'a [f64],
    qdd: &'a [f64],
    t: f64,
    v: &'a [f64],
}

/// JSON has no NaN: numbers that are not finite come as words, which Rust parses as it does digits.
#[derive(Deserialize)]
#[serde(untagged)]
enum Number {
    Finite(f64),
    Word(String),
}

fn functions<'de, D>(deserializer: D) -> Result<std::collections::BTreeMap<String, Values>, D::Error>
where
    D: serde::Deserializer<'de>,
{
    let raw = std::collections::BTreeMap::<String, Vec<Vec<Option<Number>>>>::deserialize(deserializer)?;
    let number = |number: Number| match number {
        Number::Finite(value) => value,
        Number::Word(word) => word.parse().unwrap_or(f64::NAN),
    };
    let row = |row: Vec<Option<Number>>| row.into_iter().map(|entry| entry.map(number)).collect();
    Ok(raw.into_iter().map(|(name, table)| (name, table.into_iter().map(row).collect())).collect())
}

impl Oracle {
    /// Finds or makes the Python environment; `progress` hears what takes long.
    ///
    /// # Errors
    /// [`EnvironmentError`] with its cure.
    pub fn new(progress: &dyn Fn(&str)) -> Result<Self, EnvironmentError> {
        Ok(Oracle { environment: Environment::ready(progress)? })
    }

    /// Lets CasADi differentiate the definition (Python text) and evaluate it at the samples.
    ///
    /// # Errors
    /// [`OracleError`] with what Python said.
    pub fn evaluate(&self, definition: &str, samples: &[Sample]) -> Result<Answer, OracleError> {
        let script = ScratchFile::new(self.environment.directory(), "oracle", SCRIPT)?;
        let definition = ScratchFile::new(self.environment.directory(), "definition", definition)?;
        let states = samples
            .iter()
            .map(|Sample { state, variables }| QuestionState {
                q: &state.q,
                qd: &state.qd,
                qdd: &state.qdd,
                t: state.t,
                v: variables,
            })
            .collect();
        let question = serde_json::to_vec(&Question { states }).map_err(process)?;
        let text = self.run(&script.0, &definition.0, question)?;
        serde_json::from_slice(&text).map_err(|error| OracleError::Answer { reason: error.to_string() })
    }

    fn run(&self, script: &Path, definition: &Path, question: Vec<u8>) -> Result<Vec<u8>, OracleError> {
        let mut child = Command::new(self.environment.python())
            // Definitions are scratch files; no bytecode of theirs is worth keeping.
            .args(["-I", "-B"])
            .args([script, definition])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(process)?;
        let pipe = child.stdin.take();
        // The child reads all before it writes, but may fail and write errors while it is still being fed.
        let feeder = std::thread::spawn(move || pipe.map(|mut pipe| pipe.write_all(&question)));
        let output = child.wait_with_output().map_err(process)?;
        // A child that ends without reading breaks the pipe; its own words are the better message.
        let _ = feeder.join();
        if output.status.success() {
            Ok(output.stdout)
        } else {
            Err(OracleError::Process { reason: String::from_utf8_lossy(&output.stderr).trim().to_string() })
        }
    }
}

fn process(error: impl fmt::Display) -> OracleError {
    OracleError::Process { reason: error.to_string() }
}

/// A file that is removed with its owner; processes and threads do not meet in it.
struct ScratchFile(PathBuf);

impl ScratchFile {
    fn new(directory: &Path, name: &str, text: &str) -> Result<Self, OracleError> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = directory.join(format!("{name}-{}-{count}.py", id()));
        fs::write(&path, text)
            .map_err(|error| process(format!("cannot write {}: {error}", path.display())))?;
        Ok(ScratchFile(path))
    }
}

impl Drop for ScratchFile {
    fn drop(&mut self) {
        // A file left behind does no harm: its name is never used again by a living process.
        let _ = fs::remove_file(&self.0);
    }
}

impl fmt::Display for OracleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OracleError::Process { reason } => write!(f, "the CasADi process failed:\n{reason}"),
            OracleError::Answer { reason } => {
                write!(f, "CasADi's answer does not fit the mechanism: {reason}")
            }
        }
    }
}

impl core::error::Error for OracleError {}
