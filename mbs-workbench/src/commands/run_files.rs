//! Content of the files and of the document of a run.

use mbs_codegen::picture::Preset;
use mbs_runtime::Entry;
use serde_json::{Value, json};

use super::analysis::RunResult;
use super::measured::Tables;
use super::target::Target;
use super::{CommandError, slide, summary};
use crate::erased::dynamics::linearization::SmallMotions;
use crate::erased::erase::Erased;
use crate::erased::facade::{AnyEquations, Motion};
use crate::output::animation::animation;
use crate::output::csv;
use crate::output::origin::Origin;
use crate::output::places::{PlaceCurve, places};
use crate::output::report::{ForceArrow, Overlay, Report, Run, Slider, SliderStop, html};
use crate::output::shapes::shapes;

/// Instants of a run on the page, at most; beyond them a browser slows down and an eye sees no more.
const SHOWN: usize = 2000;

/// Numbers of all runs on the page, at most: two megabytes of text, which a page opens with at once.
const NUMBERS: usize = 170_000;

/// Instants of a run on the page, however many columns it has: twenty-four a second of a motion of ten.
const LEAST_SHOWN: usize = 240;

/// A run as data: parameters, figures, and the whole motion.
pub fn described(done: &RunResult, instance: &Erased) -> Value {
    let equations = instance.equations();
    let variable = |(index, entry): (usize, &Entry)| json!({ "name": entry.name, "unit": entry.unit, "value": equations.get(index) });
    let variables: Vec<Value> = equations.variables().iter().enumerate().map(variable).collect();
    json!({
        "label": done.label, "description": done.description, "variables": variables, "figures": done.figures,
        "verdict": done.verdict, "ended": done.ended.as_ref().map(|ended| &ended.line), "motion": done.motion,
        "small_motions": done.small,
    })
}

/// The motion as an animated picture.
pub fn animated(
    target: &Target,
    mechanism: &dyn AnyEquations,
    motion: &Motion,
) -> Result<String, CommandError> {
    let places = places(target.picture(), mechanism, motion, None);
    animation(&shapes(target.shapes()), motion, &places)
        .map_err(|reason| CommandError::Failed(format!("no animated drawing: {reason}")))
}

/// Numbers and names worth knowing, as pairs.
pub fn facts(instances: &[(Preset, Erased)], done: &[RunResult], tables: &Tables) -> Vec<[String; 2]> {
    let first = instances[0].1.equations();
    let mut facts = vec![["coordinates".to_string(), first.coordinates().len().to_string()]];
    facts.extend(super::functions::facts());
    let declared = mbs_codegen::variables(first.source(), Some(first.scene())).unwrap_or_default();
    let is_of =
        |entry: &str, input: &str| entry.strip_prefix(input).is_some_and(|rest| rest.starts_with('.'));
    for (index, entry) in first.variables().iter().enumerate() {
        if let Some((_, followed)) = tables.followed().find(|(input, _)| *input == entry.name) {
            facts.push([entry.name.to_string(), followed]);
            continue;
        }
        if tables.followed().any(|(input, _)| is_of(entry.name, input)) {
            continue;
        }
        let bounds = declared.iter().find(|variable| variable.name == entry.name);
        let bounds = bounds.map_or_else(String::new, |variable| {
            let [low, high] = variable.range.map(summary::short);
            let range =
                if variable.range[1].is_finite() { format!(", {low} to {high}") } else { String::new() };
            let tolerance = variable.tolerance.map(|deviation| format!(" ± {}", summary::short(deviation)));
            tolerance.unwrap_or_default() + &range
        });
        let written = |mechanism: &dyn AnyEquations| {
            let value = mechanism.get(index).unwrap_or(f64::NAN);
            format!("{}{}{bounds}", summary::short(value), summary::unit(entry.unit))
        };
        if instances.iter().all(|(_, other)| other.equations().get(index) == first.get(index)) {
            facts.push([entry.name.to_string(), written(first)]);
            continue;
        }
        for (preset, instance) in instances {
            facts.push([format!("{}, {}", entry.name, preset.label), written(instance.equations())]);
        }
    }
    for done in done {
        facts.push([format!("instants, {}", done.label), done.motion.time.len().to_string()]);
        for [name, value] in &done.figures {
            facts.push([format!("{name}, {}", done.label), value.clone()]);
        }
    }
    facts
}

/// Content of a page besides the motions.
pub struct PageContent<'a> {
    /// The command line again.
    pub command: &'a str,
    /// The analysis in one word.
    pub analysis: &'a str,
    pub facts: &'a [[String; 2]],
    pub overlays: &'a [Overlay],
    pub slider: Option<&'a slide::Slider>,
}

/// Motions as a page shows them, with what they draw beside outputs.
struct Shown<'a> {
    done: &'a [RunResult],
    drawn: Vec<(Motion, Vec<PlaceCurve>)>,
}

impl<'a> Shown<'a> {
    /// At most `most` instants of each motion of `instances`.
    fn of(target: &Target, instances: &[(Preset, Erased)], done: &'a [RunResult], most: usize) -> Self {
        let drawn = done.iter().map(|done| {
            let motion = done.motion.decimate(most);
            let mechanism = instances[done.instance].1.equations();
            let places = places(target.picture(), mechanism, &motion, done.small.as_ref());
            (motion, places)
        });
        Shown { done, drawn: drawn.collect() }
    }

    fn runs(&self) -> Vec<Run<'_>> {
        let mut runs = Vec::new();
        for (done, (motion, places)) in self.done.iter().zip(&self.drawn) {
            runs.push(Run {
                label: &done.label,
                description: &done.description,
                motion,
                places,
                verdict: done.verdict.as_ref(),
                ended: done.ended.as_ref().map(|ended| ended.line.as_str()),
                small: done.small.as_ref(),
            });
        }
        runs
    }
}

/// The page of the report.
pub fn page(
    target: &Target,
    instances: &[(Preset, Erased)],
    done: &[RunResult],
    content: &PageContent,
) -> String {
    let PageContent { command, analysis, facts, overlays, slider } = *content;
    let stops = slider.map_or(&[][..], |slider| &slider.stops);
    let all = done.iter().chain(stops.iter().flat_map(|stop| stop.runs.iter().flatten()));
    let columns: usize = all.map(|done| done.motion.columns()).sum();
    let most = (NUMBERS / columns.max(1)).clamp(LEAST_SHOWN, SHOWN);
    let shown = Shown::of(target, instances, done, most);
    let stops: Vec<_> = stops
        .iter()
        .map(|stop| {
            let shown = stop.runs.as_ref().map(|runs| Shown::of(target, &stop.instances, runs, most));
            (stop.value, shown)
        })
        .collect();
    let stops = stops.iter().map(|(value, shown)| SliderStop {
        value: *value,
        runs: shown.as_ref().map_or_else(|_| Vec::new(), Shown::runs),
        reason: shown.as_ref().err().map(|reason| reason.as_str()),
    });
    let slider = slider.map(|slider| Slider {
        name: &slider.name,
        unit: &slider.unit,
        value: slider.value,
        range: slider.range,
        tolerance: slider.tolerance,
        stops: stops.collect(),
    });
    let forces = &target.picture().forces;
    let forces: Vec<ForceArrow> =
        forces.iter().map(|force| ForceArrow { of: &force.output, at: &force.at }).collect();
    html(&Report {
        name: target.name(),
        title: target.title(),
        description: target.description(),
        source: instances[0].1.equations().source(),
        command,
        facts,
        runs: &shown.runs(),
        drawing: &shapes(target.shapes()),
        forces: &forces,
        overlays,
        slider: slider.as_ref(),
        origin: &Origin::of_text(target.name(), instances[0].1.equations().source()).line(),
        analysis,
    })
}

/// The table of the motions.
pub fn values(done: &[RunResult]) -> String {
    csv::write(&done.iter().map(|done| (done.label.as_str(), &done.motion)).collect::<Vec<_>>())
}

/// Small motions as values, where they were asked for.
pub fn modes(done: &[RunResult]) -> Option<String> {
    let small: Vec<(&str, &Motion, &SmallMotions)> = done
        .iter()
        .filter_map(|done| Some((done.label.as_str(), &done.motion, done.small.as_ref()?)))
        .collect();
    (!small.is_empty()).then(|| csv::write_modes(&small))
}
