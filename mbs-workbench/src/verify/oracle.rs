//! CasADi or mpmath in a child process: a definition and states in, values of all functions out.

use core::fmt;
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio, id};
use std::sync::atomic::{AtomicU32, Ordering};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::environment::{Environment, EnvironmentError};
use super::states::Sample;

const SCRIPT: &str = include_str!("../../oracle/oracle.py");
const WITH_CASADI: &str = include_str!("../../oracle/with_casadi.py");
const WITH_MPMATH: &str = include_str!("../../oracle/with_mpmath.py");
const PRECISELY: &str = include_str!("../../oracle/precisely.py");

/// CasADi and mpmath, ready to run.
#[derive(Debug)]
pub struct Oracle {
    environment: Environment,
}

/// Reason why there are no values.
#[derive(Debug)]
pub enum OracleError {
    /// The child process did not run or did not end well.
    Process {
        /// Last lines of its messages.
        reason: String,
    },
    /// The answer does not fit the mechanism.
    Answer {
        /// Description of the difference.
        reason: String,
    },
}

/// Values of one function: a line a state, an entry a component; `None` where the definition has no such derivative.
pub type Table<E> = Vec<Vec<Option<E>>>;

/// Values in double precision.
pub type Values = Table<f64>;

/// Values of all functions at all states.
#[derive(Debug, Deserialize)]
pub struct Answer<E> {
    /// Name in the definition.
    pub name: String,
    /// Number of coordinates.
    pub n: usize,
    /// Number of rows.
    pub m: usize,
    /// Number of variables.
    pub v: usize,
    /// Values by function.
    #[serde(flatten)]
    pub functions: BTreeMap<String, Table<E>>,
}

/// A number of 50 digits, rounded to 32, with a bound of the rounding errors of double precision.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(from = "[Option<f64>; 3]")]
pub struct Precise {
    /// The nearest double.
    pub value: f64,
    /// Remainder: the number less the nearest double.
    pub rest: f64,
    /// Sum of the absolute values that are rounded, one rounding being 2⁻⁵³ of it; `None` where rounding decides on
    /// which side of a kink the number is.
    pub bound: Option<f64>,
}

impl From<[Option<f64>; 3]> for Precise {
    fn from([value, rest, bound]: [Option<f64>; 3]) -> Self {
        let number = |number: Option<f64>| number.unwrap_or(f64::NAN);
        Precise { value: number(value), rest: number(rest), bound }
    }
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
    z: &'a [f64],
    l: &'a [f64],
}

/// JSON has no NaN: numbers that are not finite come as words, which Rust parses as it does digits.
#[derive(Deserialize)]
#[serde(untagged)]
enum Number {
    Finite(f64),
    Word(String),
}

impl Number {
    fn value(self) -> f64 {
        match self {
            Number::Finite(value) => value,
            Number::Word(word) => word.parse().unwrap_or(f64::NAN),
        }
    }
}

impl Oracle {
    /// Finds or makes the Python environment; `progress` gets messages about long actions.
    ///
    /// # Errors
    /// [`EnvironmentError`] with its cure.
    pub fn new(progress: &dyn Fn(&str)) -> Result<Self, EnvironmentError> {
        Ok(Oracle { environment: Environment::ready(progress)? })
    }

    /// Lets CasADi differentiate the definition (Python text) and evaluate it at the samples.
    ///
    /// # Errors
    /// [`OracleError`] with Python's message.
    pub fn evaluate(&self, definition: &str, samples: &[Sample]) -> Result<Answer<f64>, OracleError> {
        let Answer { name, n, m, v, functions } =
            self.ask::<Number>(("with_casadi", WITH_CASADI), definition, samples)?;
        let line =
            |line: Vec<Option<Number>>| line.into_iter().map(|entry| entry.map(Number::value)).collect();
        let table = |table: Table<Number>| table.into_iter().map(line).collect();
        let functions = functions.into_iter().map(|(name, values)| (name, table(values))).collect();
        Ok(Answer { name, n, m, v, functions })
    }

    /// Evaluates the definition (Python text) and its derivatives at the samples in 50-digit arithmetic.
    ///
    /// # Errors
    /// [`OracleError`] with Python's message.
    pub fn evaluate_digits(
        &self,
        definition: &str,
        samples: &[Sample],
    ) -> Result<Answer<Precise>, OracleError> {
        self.ask(("with_mpmath", WITH_MPMATH), definition, samples)
    }

    /// Lets CasADi differentiate the definition (Python text) and evaluates its expressions at the samples in 50-digit arithmetic.
    /// The bound of a value is the sum of the absolute values that they round on the way.
    ///
    /// # Errors
    /// [`OracleError`] with Python's message.
    pub fn evaluate_precisely(
        &self,
        definition: &str,
        samples: &[Sample],
    ) -> Result<Answer<Precise>, OracleError> {
        let casadi = ScratchFile::new(self.environment.directory(), "with_casadi", WITH_CASADI)?;
        let back_end = PRECISELY.replace("WITH_CASADI", &casadi.0.display().to_string());
        self.ask(("precisely", &back_end), definition, samples)
    }

    fn ask<E: DeserializeOwned>(
        &self,
        (name, back_end): (&str, &str),
        definition: &str,
        samples: &[Sample],
    ) -> Result<Answer<E>, OracleError> {
        let directory = self.environment.directory();
        let script = ScratchFile::new(directory, "oracle", SCRIPT)?;
        let back_end = ScratchFile::new(directory, name, back_end)?;
        let definition = ScratchFile::new(directory, "definition", definition)?;
        let states = samples
            .iter()
            .map(|Sample { state, variables, loads }| QuestionState {
                q: &state.q,
                qd: &state.qd,
                qdd: &state.qdd,
                t: state.t,
                v: variables,
                z: &loads.states,
                l: &loads.lambda,
            })
            .collect();
        let question = serde_json::to_vec(&Question { states }).map_err(process)?;
        let text = self.run([&script.0, &back_end.0, &definition.0], question)?;
        serde_json::from_slice(&text).map_err(|error| OracleError::Answer { reason: error.to_string() })
    }

    fn run(&self, files: [&PathBuf; 3], question: Vec<u8>) -> Result<Vec<u8>, OracleError> {
        let mut child = Command::new(self.environment.python())
            // Definitions are scratch files; no bytecode of theirs is worth keeping.
            .args(["-I", "-B"])
            .args(files)
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

/// A file that is removed with its owner; no two processes or threads share it.
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
            OracleError::Process { reason } => write!(f, "the Python process failed:\n{reason}"),
            OracleError::Answer { reason } => {
                write!(f, "the oracle's answer does not fit the mechanism: {reason}")
            }
        }
    }
}

impl core::error::Error for OracleError {}
