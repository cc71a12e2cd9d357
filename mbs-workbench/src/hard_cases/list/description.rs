//! Descriptions beside the texts of cases: difficulty, references and bounds, variants outside of the range.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::hard_cases::variation::Class;
use crate::setting::{FormulationName, ImplicitName, IntegratorName, MotionMethod};

/// Description of a case.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Description {
    /// Title in the matrix.
    pub title: String,
    /// Source of the case.
    pub origin: String,
    /// Reason of its difficulty.
    pub why: String,
    /// Failure of other programs or methods.
    pub elsewhere: String,
    /// Cure of this library.
    pub here: String,
    /// End of the motion (s); else that of the text's `span`.
    pub until: Option<f64>,
    /// `true` for a case that takes minutes.
    #[serde(default)]
    pub long: bool,
    /// Methods and variants of a case whose runs are dear; without it all that are asked for.
    pub few: Option<Few>,
    /// Intervals between the instants of a run, 64 without it; of more than 640 the first four of each 64th part are looked at.
    pub instants: Option<u32>,
    /// Largest error of each kind of method, as a part of the size of what is compared. Methods of other kinds are not run.
    #[serde(default)]
    pub bounds: BTreeMap<MethodKind, f64>,
    /// Values that are known.
    #[serde(default)]
    pub known: Vec<Known>,
    /// Tables of values that are known at some instants.
    #[serde(default)]
    pub tables: Vec<Table>,
    /// Samples of an encoder that move the mechanism in place of the time.
    pub samples: Option<Samples>,
    /// The refusal that is right, where there is no answer.
    pub refused: Option<Refusal>,
    /// Methods and variants that may be refused more often than one in twenty.
    #[serde(default)]
    pub outside: Vec<Outside>,
}

/// Some of the methods and variants.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Few {
    /// Whole names of the methods that run.
    pub methods: Vec<String>,
    /// Seeds of the variants that run.
    pub seeds: Vec<u64>,
    /// Reason for leaving out the others.
    pub why: String,
}

impl Few {
    /// Extent in words: `2 variants by 3 methods`.
    pub fn words(&self) -> String {
        let counted =
            |count: usize, noun: &str| format!("{count} {noun}{}", if count == 1 { "" } else { "s" });
        format!("{} by {}", counted(self.seeds.len(), "variant"), counted(self.methods.len(), "method"))
    }
}

/// Kind of a method, by the bound that it can keep.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, PartialOrd, Ord)]
#[serde(rename_all = "kebab-case")]
pub enum MethodKind {
    /// Steps that a tolerance of 1e-8 allows, rows closed.
    Adaptive,
    /// Equal steps of order 4, rows closed.
    Equal,
    /// Equal steps of order 1.
    Euler,
    /// Implicit equal steps.
    Implicit,
    /// Rows closed by Baumgarte's oscillators, or not at all.
    Drift,
    /// Springs in place of rows.
    Soft,
    /// Positions of drives, closed.
    Drives,
    /// The same in steps of bounded work.
    Bounded,
    /// Any of these in single precision.
    Single,
}

/// A value that is known beforehand.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Known {
    /// An output of the text, a coordinate (`B.0`), or `energy` less that of the start.
    pub value: String,
    /// The number that it is.
    #[serde(default)]
    pub is: f64,
    /// Instants at which it is that.
    #[serde(default)]
    pub when: When,
    /// Time (s) at which it is that, where that is an instant of the run.
    #[serde(skip)]
    pub at: Option<f64>,
    /// Size that its error is a part of.
    #[serde(default = "one")]
    pub size: f64,
    /// Largest rate (1/s) of the motion; with it the two time derivatives are compared as well.
    pub rate: Option<f64>,
    /// Angular velocity (rad/s) of an angle that is this times the time, exactly, less whole turns; `is` and `rate` are left out.
    pub turning: Option<f64>,
    /// Source of the number.
    pub source: String,
    /// Kinds of variants that have another one: `parameters`, `guess`.
    #[serde(default)]
    pub except: Vec<String>,
}

/// Values that are known at some instants, in a file beside the description: a line a time, `t` (s) and outputs or coordinates.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// Name of the file.
    pub file: String,
    /// Size that errors are a part of.
    #[serde(default = "one")]
    pub size: f64,
    /// Source of the numbers.
    pub source: String,
    /// Its values.
    #[serde(skip)]
    pub known: Vec<Known>,
}

impl Table {
    /// Takes the values of `text`, numbers with commas between them below a line of names.
    ///
    /// # Errors
    /// The line that is no row of the table.
    pub fn fill(&mut self, text: &str) -> Result<(), String> {
        let mut lines = text.lines().zip(1..);
        let names: Vec<&str> = lines.next().map(|(line, _)| line.split(',').collect()).unwrap_or_default();
        for (line, number) in lines {
            let values: Result<Vec<f64>, _> = line.split(',').map(str::parse).collect();
            let values = values.map_err(|error| format!("{}:{number}: {error}", self.file))?;
            let (Some(at), true) = (values.first(), values.len() == names.len()) else {
                return Err(format!(
                    "{}:{number}: {} values for {} names",
                    self.file,
                    values.len(),
                    names.len()
                ));
            };
            let rows = names.iter().zip(&values).skip(1);
            self.known.extend(rows.map(|(name, value)| Known {
                value: name.to_string(),
                is: *value,
                when: When::Always,
                at: Some(*at),
                size: self.size,
                rate: None,
                turning: None,
                source: self.source.clone(),
                except: Vec::new(),
            }));
        }
        Ok(())
    }
}

fn one() -> f64 {
    1.0
}

/// Instants at which a value is known.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum When {
    /// All.
    #[default]
    Always,
    /// The last one.
    End,
}

/// Samples of an encoder.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Samples {
    /// The angle that it measures: an input of the text.
    pub input: String,
    /// Course of the angle: an output of the text that depends on the time alone.
    pub course: String,
    /// Samples in a second.
    pub rate: f64,
    /// Bits of a turn.
    pub bits: i32,
    /// Share of samples that are lost.
    pub dropped: f64,
    /// Share of samples that come twice.
    pub doubled: f64,
    /// Share of samples whose time stamp is that of two samples before.
    pub backwards: f64,
}

/// A refusal that is right.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Refusal {
    /// Words that the reason has.
    pub words: String,
    /// Time of the failure (s).
    pub at: Option<f64>,
    /// Distance of the time that is allowed (s).
    #[serde(default)]
    pub within: f64,
    /// Why there is no answer.
    pub source: String,
}

/// Runs that are outside of the range of a method.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outside {
    /// Parts of the names of methods; all without them.
    #[serde(default)]
    pub methods: Vec<String>,
    /// Names of kinds of variants; all without them.
    #[serde(default)]
    pub variants: Vec<String>,
    /// Why.
    pub why: String,
}

impl Description {
    /// Reads a description.
    ///
    /// # Errors
    /// The fault, with its line.
    pub fn read(text: &str) -> Result<Self, String> {
        toml::from_str(text).map_err(|fault| fault.to_string())
    }

    /// `true` where runs by a method may be refused.
    pub fn is_outside(&self, method: &str, class: Class) -> bool {
        self.outside.iter().any(|outside| {
            let any = |names: &[String], is: &dyn Fn(&str) -> bool| {
                names.is_empty() || names.iter().any(|name| is(name))
            };
            any(&outside.methods, &|name| method.contains(name))
                && any(&outside.variants, &|name| name == class.name())
        })
    }
}

impl MethodKind {
    /// Kind of a method for motions from forces.
    pub fn of(method: MotionMethod) -> Self {
        use FormulationName::{Baumgarte, Penalty, Unstabilized};
        match method {
            MotionMethod::Implicit(ImplicitName::MoreauJean) => MethodKind::Euler,
            MotionMethod::Implicit(_) => MethodKind::Implicit,
            MotionMethod::Explicit(Penalty, _) => MethodKind::Soft,
            MotionMethod::Explicit(_, IntegratorName::SemiImplicitEuler) => MethodKind::Euler,
            MotionMethod::Explicit(Baumgarte | Unstabilized, _) => MethodKind::Drift,
            _ if method.is_adaptive() => MethodKind::Adaptive,
            _ => MethodKind::Equal,
        }
    }
}
