//! Choice of scenes, round by round: the whole, all but one, each alone, then greedy elimination.

use std::collections::BTreeMap;

use super::comparison::{Change, changes};
use super::measurement::{Measured, Order, instants};
use super::scene::{Measures, Scene, Text};

/// A scene that was looked at.
#[derive(Clone, Debug, Default)]
pub struct Candidate {
    /// Sizes of its text.
    pub measures: Measures,
    /// Its motion, times and code; none where the text is none or it has no motion.
    pub measured: Option<Measured>,
    /// Reason why it was left out.
    pub reason: Option<String>,
    /// Changes of the watched outputs from the whole.
    pub changes: Vec<Change>,
}

impl Candidate {
    /// `true` where all watched outputs are within the bound.
    pub fn is_within(&self, within: f64) -> bool {
        self.reason.is_none()
            && self.measured.is_some()
            && self.changes.iter().all(|change| change.is_within(within))
    }

    /// Largest of all changes; infinite where one is not comparable.
    pub fn largest(&self) -> f64 {
        let size = |change: &Change| change.size.as_ref().map_or(f64::INFINITY, |size| size.largest);
        self.changes.iter().map(size).fold(0.0, f64::max)
    }

    /// Largest of all root mean squares; infinite where one is not comparable.
    pub fn rms(&self) -> f64 {
        let size = |change: &Change| change.size.as_ref().map_or(f64::INFINITY, |size| size.rms);
        self.changes.iter().map(size).fold(0.0, f64::max)
    }
}

/// Part of the whole's time of a step up to which times are not told apart: they scatter by that much on a machine with other work.
const NOISE: f64 = 0.05;

/// All that a study found.
#[derive(Clone, Debug)]
pub struct Study {
    /// The text.
    pub text: Text,
    /// Scenes that were looked at.
    pub candidates: BTreeMap<Scene, Candidate>,
    /// Scenes of the elimination, from the whole to the last within the bound.
    pub eliminated: Vec<Scene>,
    /// The cheapest scene within the bound.
    pub enough: Scene,
    /// Programs that were built or found built.
    pub rounds: usize,
    /// Instants of the motions (s).
    pub times: Vec<f64>,
}

impl Study {
    /// The whole.
    pub fn whole(&self) -> Scene {
        Scene::whole(self.text.effects.len())
    }

    /// Time of a step (s) of a scene.
    pub fn step(&self, scene: Scene) -> Option<f64> {
        self.candidate(scene)?.measured.as_ref().map(|measured| measured.step)
    }

    /// A scene that was looked at.
    pub fn candidate(&self, scene: Scene) -> Option<&Candidate> {
        self.candidates.get(&scene)
    }
}

/// Measures scenes of a copy of the text: number of the round from 1, the copy, names of its scenes.
pub type Workshop<'a> = &'a mut dyn FnMut(usize, &str, &[String]) -> Result<Vec<Measured>, String>;

/// Compares scenes of `text` until no effect can be left out within the bound.
///
/// # Errors
/// The whole is no mechanism or has no motion, or a round could not be measured.
pub fn study(text: Text, order: &Order, within: f64, workshop: Workshop<'_>) -> Result<Study, String> {
    let count = text.effects.len();
    let whole = Scene::whole(count);
    let times = instants(order);
    let mut study =
        Study { text, candidates: BTreeMap::new(), eliminated: vec![whole], enough: whole, rounds: 0, times };
    let mut first = vec![whole, Scene::default()];
    first.extend((0..count).map(|index| whole.without(index)));
    first.extend((0..count).map(Scene::only));
    study.look_at(&first, within, workshop)?;
    let mut current = whole;
    loop {
        let nearest: Vec<Scene> =
            (0..count).filter(|index| current.has(*index)).map(|index| current.without(index)).collect();
        study.look_at(&nearest, within, workshop)?;
        let Some(next) = study.cheapest_change(current, &nearest, within) else { break };
        study.eliminated.push(next);
        current = next;
        if current.is_empty() {
            break;
        }
    }
    // A scene of the first round may be cheaper than where the elimination ends, by more than times are known to.
    let cost = |scene: Scene| study.step(scene).unwrap_or(f64::INFINITY);
    let within_bound = study.candidates.iter().filter(|(_, candidate)| candidate.is_within(within));
    let cheapest = within_bound.map(|(scene, _)| *scene).min_by(|a, b| cost(*a).total_cmp(&cost(*b)));
    study.enough = match cheapest {
        Some(scene) if cost(scene) < cost(current) - NOISE * cost(whole) => scene,
        _ => current,
    };
    Ok(study)
}

impl Study {
    /// Measures those of `scenes` that are not known.
    fn look_at(&mut self, scenes: &[Scene], within: f64, workshop: Workshop<'_>) -> Result<(), String> {
        let whole = self.whole();
        let mut asked: Vec<Scene> = Vec::new();
        for scene in scenes {
            if self.candidates.contains_key(scene) {
                continue;
            }
            let mut candidate = Candidate::default();
            match self.text.measures(*scene) {
                Ok(measures) => {
                    candidate.measures = measures;
                    asked.push(*scene);
                }
                Err(reason) if *scene == whole => return Err(format!("the whole is no mechanism: {reason}")),
                Err(reason) => candidate.reason = Some(reason),
            }
            self.candidates.insert(*scene, candidate);
        }
        if asked.is_empty() {
            return Ok(());
        }
        self.rounds += 1;
        // Times of rounds are compared by that of the whole in each: the load of the machine changes.
        let built: Vec<Scene> =
            asked.iter().copied().chain((!asked.contains(&whole)).then_some(whole)).collect();
        let names: Vec<String> = built.iter().map(|scene| scene.name()).collect();
        let mut measured = workshop(self.rounds, &self.text.copy(&built), &names)?;
        let again =
            measured.iter().zip(&built).find(|(_, scene)| **scene == whole).map(|(found, _)| found.step);
        if let (Some(first), Some(again)) = (self.step(whole), again.filter(|again| *again > 0.0)) {
            measured.iter_mut().for_each(|found| found.step *= first / again);
        }
        for (scene, found) in asked.iter().zip(measured) {
            if let Some(candidate) = self.candidates.get_mut(scene) {
                candidate.reason = found.failure.as_ref().map(|reason| format!("no motion: {reason}"));
                candidate.measured = found.failure.is_none().then_some(found);
            }
        }
        let Some(Candidate { measured: Some(reference), .. }) = self.candidates.get(&whole).cloned() else {
            let reason = self.candidates.get(&whole).and_then(|candidate| candidate.reason.clone());
            return Err(format!("the whole has {}", reason.unwrap_or_else(|| "no motion".to_string())));
        };
        for scene in asked {
            if let Some(candidate) = self.candidates.get_mut(&scene)
                && let Some(measured) = &candidate.measured
            {
                candidate.changes = changes(&reference, measured, &self.times, within);
            }
        }
        Ok(())
    }

    /// The scene within the bound that changes least for what it saves, of those with one effect less than `current`.
    fn cheapest_change(&self, current: Scene, nearest: &[Scene], within: f64) -> Option<Scene> {
        let (cost, floor) = (self.step(current)?, NOISE * self.step(self.whole())?);
        let ratio = |scene: Scene| {
            let candidate = self.candidate(scene).filter(|candidate| candidate.is_within(within))?;
            // Of effects that take less than is measured the one with the smallest change is left out first.
            let saved = (cost - self.step(scene)?).max(floor);
            Some((candidate.largest() / saved, scene))
        };
        nearest
            .iter()
            .filter_map(|scene| ratio(*scene))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, scene)| scene)
    }
}
