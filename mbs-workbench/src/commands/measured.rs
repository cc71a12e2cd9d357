//! Measured tables of a run: inputs that follow them, and points that are drawn over a curve.

use std::fs;

use clap::Args;

use super::CommandError;
use super::summary::{significant, unit};
use super::target::Target;
use crate::erased::erase::Erased;
use crate::erased::facade::{AnyEquations, Motion};
use crate::mismatch::{array, nearest, wrapped};
use crate::motion::course::Course;
use crate::output::report::Overlay;
use crate::tables::measured::Measured;

/// Options of runs with measured tables.
#[derive(Args, Clone, Default)]
pub struct Tables {
    /// Let an input follow a measured table, a CSV with a header as `t (s), theta (deg)`, smooth between its points
    #[arg(long = "input", value_name = "NAME=FILE.csv", value_parser = named)]
    inputs: Vec<Named>,
    /// Draw the points of a measured table over the curve of an output or a coordinate, and compare them
    #[arg(long = "overlay", value_name = "NAME=FILE.csv", value_parser = named)]
    overlays: Vec<Named>,
}

/// A file for a name.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Named {
    name: String,
    path: String,
}

fn named(text: &str) -> Result<Named, String> {
    let (name, path) =
        text.split_once('=').ok_or("write it as NAME=FILE.csv, for example theta=theta.csv")?;
    let (name, path) = (name.trim(), path.trim());
    if name.is_empty() || path.is_empty() {
        return Err("a name is needed before the `=`, a file behind it".to_string());
    }
    Ok(Named { name: name.to_string(), path: path.to_string() })
}

/// Parts of a turn of the clock that the end of a run may be beyond that of a table.
const ROUNDING: f64 = 1e-12;

/// Points on the page of one table, at most.
const SHOWN: usize = 2000;

impl Tables {
    /// The options again.
    pub fn command(&self) -> String {
        let option = |option: &str, Named { name, path }: &Named| format!(" --{option} {name}={path}");
        let inputs = self.inputs.iter().map(|named| option("input", named));
        inputs.chain(self.overlays.iter().map(|named| option("overlay", named))).collect()
    }

    /// Makes the inputs of all instances follow their tables. Range of times (s) that all tables have; `None` without tables.
    pub fn feed(
        &self,
        target: &Target,
        instances: &mut [(mbs_codegen::picture::Preset, Erased)],
    ) -> Result<Option<[f64; 2]>, CommandError> {
        if self.inputs.is_empty() {
            return Ok(None);
        }
        let mut range = [f64::NEG_INFINITY, f64::INFINITY];
        for (k, given) in self.inputs.iter().enumerate() {
            if self.inputs[..k].iter().any(|other| other.name == given.name) {
                return Err(CommandError::Usage(format!("`--input {}` is given twice", given.name)));
            }
            let (index, unit) = input(instances[0].1.equations(), target.name(), &given.name)?;
            let course = read(given, unit, |measured| {
                say_of_wraps(given, measured);
                measured.course()
            })?;
            let [first, last] = course.range();
            range = [range[0].max(first), range[1].min(last)];
            for (_, instance) in instances.iter_mut() {
                if !instance.equations_mut().feed(index, course.clone()) {
                    return Err(CommandError::Failed(format!("`{}` cannot follow a table", given.name)));
                }
            }
        }
        Ok(Some(range))
    }

    /// Refuses a run from 0 to `until` (s) that is longer than the tables.
    pub fn require_data(&self, [first, last]: [f64; 2], until: f64) -> Result<(), CommandError> {
        let files: Vec<&str> = self.inputs.iter().map(|named| named.path.as_str()).collect();
        let files = files.join(", ");
        let small = ROUNDING * last.abs().max(until);
        if first > small {
            return Err(CommandError::Usage(format!(
                "the run begins at 0 s, the data of {files} at {first} s: subtract {first} s from the times"
            )));
        }
        if until > last + small || last <= 0.0 {
            return Err(CommandError::Usage(format!(
                "the run ends at {until} s, the data of {files} at {last} s: say `--until {last}`, or measure longer"
            )));
        }
        Ok(())
    }

    /// Inputs with the table that each follows, in words.
    pub fn followed(&self) -> impl Iterator<Item = (&str, String)> {
        self.inputs.iter().map(|Named { name, path }| (name.as_str(), format!("follows {path}")))
    }

    /// The points to draw, read before anything is computed.
    pub fn overlays(
        &self,
        mechanism: &dyn AnyEquations,
        target: &Target,
    ) -> Result<Vec<Overlay>, CommandError> {
        let overlay = |given: &Named| {
            let unit = curve_unit(mechanism, target.name(), &given.name)?;
            let measured = read(given, unit, |measured| Ok(measured.clone()))?;
            say_of_wraps(given, &measured);
            let Measured { time, value, .. } = measured;
            Ok(Overlay { of: given.name.clone(), file: given.path.clone(), time, value })
        };
        self.overlays.iter().map(overlay).collect()
    }
}

/// The points in words, compared with the curve of the motion.
pub fn compared(overlay: &Overlay, motion: &Motion) -> Option<[String; 2]> {
    let coordinate = motion.coordinates.iter().find(|curve| curve.name == overlay.of);
    let output = motion.outputs.iter().find(|curve| curve.name == overlay.of);
    let (entry_unit, value, rates) = match (coordinate, output) {
        (Some(curve), _) => (curve.unit, &curve.q, Some((&curve.qd, &curve.qdd))),
        (None, Some(curve)) => {
            (curve.unit, &curve.value, curve.rate.as_ref().zip(curve.acceleration.as_ref()))
        }
        (None, None) => return None,
    };
    let course = rates.and_then(|(rate, acceleration)| {
        let jets = value.iter().zip(rate).zip(acceleration).map(|((x, v), a)| [*x, *v, *a]);
        Course::new(motion.time.clone(), jets.collect())
    });
    let (first, last) = (motion.time.first()?, motion.time.last()?);
    let at = |t: f64| match &course {
        Some(course) => course.at(t)[0],
        None => linear(&motion.time, value, t),
    };
    let points = overlay.time.iter().zip(&overlay.value);
    let differences: Vec<f64> = points
        .filter(|(t, _)| (*first..=*last).contains(*t))
        .map(|(t, measured)| measured - at(*t))
        .collect();
    let count = differences.len();
    let outside = overlay.time.len() - count;
    let beyond = if outside > 0 { format!(", {outside} outside of the motion") } else { String::new() };
    let text = match count {
        0 => format!("no point of {} is within the motion", overlay.file),
        _ => {
            let largest = differences.iter().fold(0.0, |most: f64, difference| most.max(difference.abs()));
            let mean = (differences.iter().map(|x| x * x).sum::<f64>() / count as f64).sqrt();
            let [largest, mean] = [largest, mean].map(|x| significant(x, 4) + &unit(entry_unit));
            format!("{count} points, largest difference {largest}, root mean square {mean}{beyond}")
        }
    };
    Some([format!("{} against {}", overlay.of, overlay.file), text])
}

/// The points that a page shows: all, or evenly left out.
pub fn decimate(overlays: &[Overlay]) -> Vec<Overlay> {
    let thin = |overlay: &Overlay| {
        let stride = overlay.time.len().div_ceil(SHOWN).max(1);
        let every = |values: &[f64]| values.iter().copied().step_by(stride).collect();
        Overlay { time: every(&overlay.time), value: every(&overlay.value), ..overlay.clone() }
    };
    overlays.iter().map(thin).collect()
}

fn linear(times: &[f64], values: &[f64], t: f64) -> f64 {
    let behind = times.partition_point(|time| *time <= t).clamp(1, times.len().max(2) - 1);
    match (times.get(behind), values.get(behind)) {
        (Some(time), Some(value)) => {
            let (before, start) = (times[behind - 1], values[behind - 1]);
            start + (value - start) * (t - before) / (time - before)
        }
        _ => values.first().copied().unwrap_or(f64::NAN),
    }
}

/// Tells of whole turns that were added to an angle.
fn say_of_wraps(Named { name, path }: &Named, measured: &Measured) {
    if measured.wraps > 0 {
        let times = if measured.wraps == 1 { "once".into() } else { format!("{} times", measured.wraps) };
        eprintln!("{path}: `{name}` jumps by a turn {times}: whole turns are added");
    }
}

/// Reads a table; its faults name the file.
fn read<T>(
    Named { name, path }: &Named,
    unit: &str,
    then: impl FnOnce(&Measured) -> Result<T, crate::tables::ReadFault>,
) -> Result<T, CommandError> {
    let bytes =
        fs::read(path).map_err(|error| CommandError::Usage(format!("cannot read {path}: {error}")))?;
    let read = Measured::read(&bytes, name, unit).and_then(|measured| then(&measured));
    read.map_err(|fault| CommandError::Failed(format!("{path}: {fault}")))
}

/// Index and unit of the input called `name`.
fn input(
    mechanism: &dyn AnyEquations,
    card: &str,
    name: &str,
) -> Result<(usize, &'static str), CommandError> {
    let declared = mbs_codegen::variables(mechanism.source(), Some(mechanism.scene()));
    let declared = declared.map_err(CommandError::Failed)?;
    let known: Vec<&str> =
        declared.iter().filter(|variable| variable.is_input).map(|variable| variable.name.as_str()).collect();
    let entries = mechanism.variables();
    let index = entries.iter().position(|entry| entry.name == name);
    if let Some(index) = index.filter(|_| known.contains(&name)) {
        return Ok((index, entries[index].unit));
    }
    let missing = format!("`{card}` has no input `{name}`");
    Err(CommandError::Usage(match (index, array(name, &known)) {
        (Some(_), _) if name.ends_with(".rate") || name.ends_with(".acceleration") => {
            format!("{missing}: a rate stands in the table of its input, in a column of its own")
        }
        (Some(_), _) => format!("`{name}` is a parameter, which has one value: set it by `--param {name}=…`"),
        (None, Some(array)) => format!("{missing}: it is an array, {array}"),
        (None, None) if known.is_empty() => {
            format!("{missing}: it has none; declare it in the text: `input {name}: rad, rates;`")
        }
        (None, None) => {
            let near = nearest(name, known.iter().copied());
            let near = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            format!("{missing}{near}\nknown: {}", wrapped(&known))
        }
    }))
}

/// Unit of the output or the coordinate called `name`.
fn curve_unit(mechanism: &dyn AnyEquations, card: &str, name: &str) -> Result<&'static str, CommandError> {
    let entries = || mechanism.coordinates().iter().chain(mechanism.outputs());
    if let Some(entry) = entries().find(|entry| entry.name == name) {
        return Ok(entry.unit);
    }
    let known: Vec<&str> = entries().map(|entry| entry.name).collect();
    let missing = format!("`{card}` has no output and no coordinate `{name}`");
    Err(CommandError::Usage(match array(name, &known) {
        Some(array) => format!("{missing}: it is an array, {array}"),
        None => {
            let near = nearest(name, known.iter().copied());
            let near = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            format!("{missing}{near}\nknown: {}", wrapped(&known))
        }
    }))
}
