//! Result of a comparison: table, sentence, scene to paste, document, page.

use mbs_codegen::scene_statement;
use serde_json::{Value, json};

use super::comparison::{Change, range};
use super::measurement::Curve;
use super::scene::Scene;
use super::study::{Candidate, Study};
use crate::output::page::Template;

/// A study with what was asked for.
pub struct EffectsResult {
    /// The study.
    pub study: Study,
    /// Largest change of the watched outputs, over their ranges.
    pub within: f64,
    /// Title of the mechanism.
    pub title: String,
    /// Origin of the text.
    pub origin: String,
    /// The command line.
    pub command: String,
    /// Facts about the measurement.
    pub facts: Vec<[String; 2]>,
}

/// Contribution of an effect: the whole minus the whole without it.
pub struct Contribution {
    /// The effect.
    pub name: String,
    /// Coordinates and rows that it adds.
    pub coordinates: i64,
    /// Rows that it adds.
    pub rows: i64,
    /// Operations that it adds.
    pub operations: i64,
    /// Machine code that it adds (bytes).
    pub bytes: Option<i64>,
    /// Time of a step that it adds (s).
    pub step: Option<f64>,
    /// Changes of the watched outputs without it.
    pub changes: Vec<Change>,
    /// Reason why nothing is known without it.
    pub reason: Option<String>,
}

/// Difference of two counts.
fn more(a: usize, b: usize) -> i64 {
    i64::try_from(a).unwrap_or(i64::MAX).saturating_sub(i64::try_from(b).unwrap_or(i64::MAX))
}

/// `0.83 %`, two digits; of what is far beyond all outputs `> 1000 %`.
pub fn percent(part: f64) -> String {
    let value = 100.0 * part;
    match value {
        _ if value > 1000.0 => "> 1000 %".to_string(),
        0.0 => "0 %".to_string(),
        _ if value < 1e-3 => format!("{value:.0e} %"),
        _ => {
            let digits = (1.0 - value.log10().floor()).clamp(0.0, 5.0) as usize;
            let text = format!("{value:.digits$}");
            let text = if digits > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
            format!("{text} %")
        }
    }
}

/// A time as nanoseconds.
pub fn nanoseconds(seconds: f64) -> String {
    let value = 1e9 * seconds;
    if value.abs() < 100.0 { format!("{value:.1}") } else { format!("{value:.0}") }
}

impl EffectsResult {
    fn of(&self, scene: Scene) -> Option<&Candidate> {
        self.study.candidate(scene)
    }

    /// Watched outputs of the whole.
    pub fn watched(&self) -> Vec<&Curve> {
        let measured = self.of(self.study.whole()).and_then(|candidate| candidate.measured.as_ref());
        measured.map(|measured| measured.outputs.iter().collect()).unwrap_or_default()
    }

    /// Contributions of the effects, in the order of the text.
    pub fn contributions(&self) -> Vec<Contribution> {
        let whole = self.study.whole();
        let Some(all) = self.of(whole) else { return Vec::new() };
        let one = |(index, name): (usize, &String)| {
            let without = self.of(whole.without(index));
            let measures = without.filter(|found| found.measures.operations > 0).map(|found| found.measures);
            let measures = measures.unwrap_or(all.measures);
            let measured = without.and_then(|found| found.measured.as_ref());
            let pair = all.measured.as_ref().zip(measured);
            Contribution {
                name: name.clone(),
                coordinates: more(all.measures.coordinates, measures.coordinates),
                rows: more(all.measures.rows, measures.rows),
                operations: more(all.measures.operations, measures.operations),
                bytes: pair.and_then(|(all, one)| Some(all.bytes?.cast_signed() - one.bytes?.cast_signed())),
                step: pair.map(|(all, one)| all.step - one.step),
                changes: without.map(|found| found.changes.clone()).unwrap_or_default(),
                reason: without.and_then(|found| found.reason.clone()),
            }
        };
        self.study.text.effects.iter().enumerate().map(one).collect()
    }

    /// Time of a step of a scene over that of the whole.
    pub fn share(&self, scene: Scene) -> Option<f64> {
        Some(self.study.step(scene)? / self.study.step(self.study.whole())?)
    }

    /// Names of the watched outputs in words.
    fn outputs_in_words(&self) -> String {
        let names: Vec<String> = self.watched().iter().map(|curve| format!("`{}`", curve.name)).collect();
        match names.len() {
            0..=6 => names.join(", "),
            count => format!("{} and {} more outputs", names[..5].join(", "), count - 5),
        }
    }

    /// The answer in one sentence.
    pub fn sentence(&self) -> String {
        let (enough, whole) = (self.study.enough, self.study.whole());
        let (within, outputs) = (percent(self.within), self.outputs_in_words());
        if self.of(whole).is_none_or(|candidate| candidate.changes.iter().all(|change| change.size.is_err()))
        {
            let reasons = self.of(whole).map(|candidate| candidate.changes.as_slice()).unwrap_or_default();
            let reason = reasons.iter().find_map(|change| change.size.clone().err()).unwrap_or_default();
            return format!("no cheapest scene on {outputs}: {reason}");
        }
        if enough == whole {
            return format!(
                "no cheaper scene is within {within} of the whole on {outputs} (largest and RMS): all effects are needed"
            );
        }
        let share = self.share(enough).unwrap_or(1.0);
        let effects = self.study.text.all_of(enough);
        let words = if effects.is_empty() { "the base alone".to_string() } else { effects.join(" + ") };
        format!(
            "cheapest scene within {within} of the whole on {outputs} (largest and RMS): {words}, {share:.2} of its cost"
        )
    }

    /// Statements to paste for the cheapest scene.
    pub fn to_paste(&self) -> String {
        let effects = self.study.text.all_of(self.study.enough);
        let taken = |name: &str| self.study.text.groups.scenes.iter().any(|(known, _)| known == name);
        let name = (1..).map(|k| if k == 1 { "Enough".to_string() } else { format!("Enough{k}") });
        let name = name.into_iter().find(|name| !taken(name)).unwrap_or_default();
        let statement = scene_statement(&name, &effects);
        if effects.is_empty() { format!("effect nothing_more {{}}\n{statement}") } else { statement }
    }

    /// All that the page and the document show.
    pub fn document(&self) -> Value {
        let size = |change: &Change| match &change.size {
            Ok(size) => {
                json!({ "output": change.output, "largest": size.largest, "at": size.at, "rms": size.rms })
            }
            Err(reason) => json!({ "output": change.output, "reason": reason }),
        };
        let sizes = |changes: &[Change]| changes.iter().map(size).collect::<Vec<_>>();
        let effects: Vec<Value> = self
            .contributions()
            .iter()
            .map(|one| {
                json!({
                    "name": one.name, "coordinates": one.coordinates, "rows": one.rows, "operations": one.operations,
                    "bytes": one.bytes, "step": one.step, "changes": sizes(&one.changes), "reason": one.reason,
                })
            })
            .collect();
        let scene = |(scene, candidate): (&Scene, &Candidate)| {
            let measured = candidate.measured.as_ref();
            json!({
                "effects": scene.effects(&self.study.text.effects), "coordinates": candidate.measures.coordinates,
                "rows": candidate.measures.rows, "operations": candidate.measures.operations,
                "bytes": measured.and_then(|measured| measured.bytes), "step": measured.map(|measured| measured.step),
                "steps": measured.map(|measured| measured.steps), "share": self.share(*scene),
                "is_within": candidate.is_within(self.within), "is_whole": *scene == self.study.whole(),
                "is_enough": *scene == self.study.enough, "is_eliminated": self.study.eliminated.contains(scene),
                "changes": sizes(&candidate.changes), "reason": candidate.reason,
            })
        };
        let watched: Vec<Value> = self
            .watched()
            .iter()
            .map(|curve| json!({ "name": curve.name, "unit": curve.unit, "range": range(&curve.values), "error": curve.error }))
            .collect();
        json!({
            "within": self.within, "sentence": self.sentence(), "paste": self.to_paste(), "watched": watched, "effects": effects,
            "kept": self.study.text.kept, "scenes": self.study.candidates.iter().map(scene).collect::<Vec<_>>(),
            "rounds": self.study.rounds,
        })
    }

    /// The self-contained page.
    pub fn page(&self) -> String {
        const TEMPLATE: Template = Template {
            html: include_str!("page/page.html"),
            style: include_str!("page/page.css"),
            script: include_str!("page/page.js"),
        };
        /// Instants of a curve that are drawn.
        const DRAWN: usize = 801;
        let mut data = self.document();
        data["title"] = json!(self.title);
        data["command"] = json!(self.command);
        data["facts"] = json!(self.facts);
        let stride = self.study.times.len().div_ceil(DRAWN).max(1);
        let decimate =
            |values: &[f64]| values.iter().step_by(stride).map(|value| *value as f32).collect::<Vec<f32>>();
        data["times"] = json!(decimate(&self.study.times));
        let enough = self.of(self.study.enough).and_then(|candidate| candidate.measured.as_ref());
        let curves = self.watched().into_iter().map(|curve| {
            let other = enough.and_then(|measured| measured.outputs.iter().find(|one| one.name == curve.name));
            json!({
                "name": curve.name, "unit": curve.unit, "range": range(&curve.values), "whole": decimate(&curve.values),
                "enough": other.map(|other| decimate(&other.values)),
            })
        });
        data["curves"] = json!(curves.collect::<Vec<_>>());
        TEMPLATE.filled(&self.title, &self.origin, &data)
    }

    /// The contributions as a table, one line an effect and watched output.
    pub fn csv(&self) -> String {
        let mut text =
            "effect,coordinates,rows,operations,bytes,step (s),output,largest change,at (s),rms change,reason\n"
                .to_string();
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:?}"));
        let quoted = |words: &str| format!("\"{}\"", words.replace('"', "\"\""));
        for one in self.contributions() {
            let head = format!(
                "{},{},{},{},{},{}",
                one.name,
                one.coordinates,
                one.rows,
                one.operations,
                one.bytes.map_or_else(String::new, |bytes| bytes.to_string()),
                number(one.step)
            );
            if let Some(reason) = &one.reason {
                text += &format!("{head},,,,,{}\n", quoted(reason));
            }
            for change in &one.changes {
                text += &match &change.size {
                    Ok(size) => {
                        let (largest, at, rms) = (size.largest, size.at, size.rms);
                        format!("{head},{},{largest:?},{at:?},{rms:?},\n", change.output)
                    }
                    Err(reason) => format!("{head},{},,,,{}\n", change.output, quoted(reason)),
                };
            }
        }
        text
    }
}
