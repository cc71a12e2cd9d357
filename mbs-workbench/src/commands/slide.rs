//! A parameter that the page has a slider for: the same runs at values from one end of its range to the other.

use mbs_codegen::picture::Preset;

use super::CommandError;
use super::analysis::{Request, RunResult};
use super::target::Target;
use crate::erased::erase::Erased;
use crate::mismatch::{array, listed, nearest, wrapped};
use crate::motion::rounded;

/// Stops of a slider where the command line names no number.
const STOPS: usize = 11;

/// Stops of a slider at most: each has motions of its own on the page.
const MOST_STOPS: usize = 41;

/// Part of a range within which a stop is the present value.
const SAME: f64 = 1e-6;

/// Name of the parameter and number of stops.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Slide {
    name: String,
    stops: usize,
}

/// Reads `L1` or `L1=21`.
pub fn slide(text: &str) -> Result<Slide, String> {
    let (name, count) = match text.split_once('=') {
        Some((name, count)) => (name, Some(count.trim())),
        None => (text, None),
    };
    let name = listed(name.trim());
    if name.is_empty() {
        return Err("the name of a parameter is needed, for example L1".to_string());
    }
    let stops = match count.map(str::parse) {
        None => STOPS,
        Some(Ok(stops)) if (2..=MOST_STOPS).contains(&stops) => stops,
        Some(_) => {
            return Err(format!("write it as NAME or NAME=N with a number of stops from 2 to {MOST_STOPS}"));
        }
    };
    Ok(Slide { name, stops })
}

/// A slider with the motions at its stops.
pub struct Slider {
    pub name: String,
    pub unit: String,
    /// Value that the page opens with; its motions are those of the run.
    pub value: f64,
    pub range: [f64; 2],
    /// Largest deviation of a part that is made.
    pub tolerance: Option<f64>,
    /// The other stops.
    pub stops: Vec<Stop>,
}

/// One value with its motions.
pub struct Stop {
    pub value: f64,
    pub instances: Vec<(Preset, Erased)>,
    /// The motions, or the reason why there are none.
    pub runs: Result<Vec<RunResult>, String>,
}

impl Slide {
    /// The option again.
    pub fn command(&self) -> String {
        let Slide { name, stops } = self;
        if *stops == STOPS { format!(" --slide {name}") } else { format!(" --slide {name}={stops}") }
    }

    /// Runs at all stops but the present one. `make` gives the instances as the command line asks for them, with their inputs.
    ///
    /// # Errors
    /// The text gives the parameter no range, or there is no such parameter.
    pub fn slider(
        &self,
        target: &Target,
        request: &Request,
        make: impl Fn() -> Result<Vec<(Preset, Erased)>, CommandError>,
    ) -> Result<Slider, CommandError> {
        let present = make()?;
        let equations = present[0].1.equations();
        let (index, variable) = self.declared(target, equations)?;
        let [low, high] = variable.range;
        let value = equations.get(index).unwrap_or(variable.default);
        let even = (0..self.stops).map(|k| {
            let part = k as f64 / (self.stops - 1) as f64;
            // The ends are those of the text to the last digit.
            if k + 1 == self.stops { high } else { low + (high - low) * part }
        });
        let is_other = |stop: &f64| (stop - value).abs() > SAME * (high - low);
        let mut stops = Vec::new();
        for stop in even.filter(is_other) {
            let mut instances = make()?;
            for (_, instance) in &mut instances {
                instance.equations_mut().set(index, stop);
            }
            let runs = runs(target, request, &instances);
            stops.push(Stop { value: rounded(stop), instances, runs });
        }
        let (name, unit, tolerance) = (variable.name, variable.unit, variable.tolerance);
        Ok(Slider { name, unit, value, range: [low, high], tolerance, stops })
    }

    /// Index of the parameter, and its declaration.
    fn declared(
        &self,
        target: &Target,
        equations: &dyn crate::erased::facade::AnyEquations,
    ) -> Result<(usize, mbs_codegen::Variable), CommandError> {
        let name = &self.name;
        let declared = mbs_codegen::variables(equations.source(), Some(equations.scene()));
        let declared = declared.map_err(CommandError::Failed)?;
        let index = equations.variables().iter().position(|entry| entry.name == name);
        let found = index.zip(declared.iter().find(|variable| variable.name == *name));
        let Some((index, variable)) = found else {
            let known: Vec<&str> = declared.iter().map(|variable| variable.name.as_str()).collect();
            let missing = format!("`{}` has no parameter `{name}`", target.name());
            return Err(CommandError::Usage(match array(name, &known) {
                Some(array) => format!("{missing}: it is an array, {array}"),
                None if known.is_empty() => missing,
                None => {
                    let near = nearest(name, known.iter().copied());
                    let near = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
                    format!("{missing}{near}\nknown: {}", wrapped(&known))
                }
            }));
        };
        if variable.is_input {
            return Err(CommandError::Usage(format!(
                "`{name}` is an input: it follows a table by `--input {name}=FILE.csv`, it has no slider"
            )));
        }
        if !variable.range.iter().all(|end| end.is_finite()) {
            let unit = &variable.unit;
            return Err(CommandError::Usage(format!(
                "`{name}` has no range for a slider: give its declaration one, `param {name}: {unit} = … in LEAST..LARGEST;`"
            )));
        }
        Ok((index, variable.clone()))
    }
}

/// Motions of all instances; the reason where one has none.
fn runs(
    target: &Target,
    request: &Request,
    instances: &[(Preset, Erased)],
) -> Result<Vec<RunResult>, String> {
    let mut all = Vec::new();
    for (index, instance) in instances.iter().enumerate() {
        match request.done(target, instance) {
            Ok(found) => all.extend(found.into_iter().map(|done| RunResult { instance: index, ..done })),
            Err(error) => return Err(error.to_string().lines().next().unwrap_or_default().to_string()),
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slider_has_a_name_and_a_number_of_stops() {
        let known = |name: &str, stops| Ok(Slide { name: name.to_string(), stops });
        assert_eq!(slide("L1"), known("L1", STOPS));
        assert_eq!(slide(" side.0 = 21 "), known("side.0", 21));
        for bad in ["", "=3", "L1=1", "L1=42", "L1=many", "L1="] {
            assert!(slide(bad).is_err(), "{bad}");
        }
        for written in ["L1", "L1=21"] {
            assert_eq!(slide(written).map(|slide| slide.command()), Ok(format!(" --slide {written}")));
        }
    }
}
