//! Motions that are known without the library: closed forms and published digits, the third leg of `mbs cost`.

use serde::{Deserialize, Serialize};

use crate::erased::facade::AnyEquations;

/// A motion of a mechanism that is known without the library.
#[derive(Clone, Copy, Debug)]
pub struct KnownMotion {
    /// Origin, in words.
    pub source: &'static str,
    /// Its own error, in the reference metric of the coordinates (rad, reference lengths).
    pub error: f64,
    /// Its states.
    pub course: KnownCourse,
}

/// States of a known motion.
#[derive(Clone, Copy, Debug)]
pub enum KnownCourse {
    /// The state at a time (s) for the parameters of an instance; none where these have no closed form.
    Form(fn(&dyn AnyEquations, f64) -> Option<KnownState>),
    /// Rows for the parameters of the text.
    Table(fn() -> Vec<KnownState>),
}

/// A state of a known motion. A coordinate that is not known is NaN.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KnownState {
    /// Time (s).
    pub t: f64,
    /// Coordinates: N.
    #[serde(with = "unknown")]
    pub q: Vec<f64>,
    /// Velocities: N; empty where they are not known.
    #[serde(with = "unknown")]
    pub qd: Vec<f64>,
}

/// States of a known motion at the instants of a study, for another process.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KnownStates {
    /// Origin, in words.
    pub source: String,
    /// Their own error, in the reference metric of the coordinates.
    pub error: f64,
    /// States in the order of time.
    pub states: Vec<KnownState>,
}

impl KnownMotion {
    /// The states of `equations` at `times` (s), or those of a table. `is_changed`: parameters differ from those of the text. None where
    /// nothing is known of them.
    pub fn states(
        &self,
        equations: &dyn AnyEquations,
        is_changed: bool,
        times: &[f64],
    ) -> Option<KnownStates> {
        let states: Vec<KnownState> = match self.course {
            KnownCourse::Form(form) => times.iter().map_while(|t| form(equations, *t)).collect(),
            KnownCourse::Table(_) if is_changed => Vec::new(),
            KnownCourse::Table(rows) => rows(),
        };
        let found = KnownStates { source: self.source.to_string(), error: self.error, states };
        (!found.states.is_empty()).then_some(found)
    }
}

/// Value of the parameter called `name`, or of its component `name.k`; NaN where there is none.
pub fn parameter(equations: &dyn AnyEquations, name: &str) -> f64 {
    let index = equations.variables().iter().position(|entry| entry.name == name);
    index.and_then(|index| equations.get(index)).unwrap_or(f64::NAN)
}

/// Numbers of which some are NaN; JSON has none.
mod unknown {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<S: Serializer>(values: &[f64], to: S) -> Result<S::Ok, S::Error> {
        let known = |value: &f64| Some(*value).filter(|value| value.is_finite());
        values.iter().map(known).collect::<Vec<_>>().serialize(to)
    }

    pub(super) fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<Vec<f64>, D::Error> {
        let values = Vec::<Option<f64>>::deserialize(from)?;
        Ok(values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect())
    }
}
