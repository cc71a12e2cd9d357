//! Motions, times and code of scenes, measured in a program that has them.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::symbols::bytes_of;
use crate::erased::scene_runs::{Asked, Mover, SceneRuns};

/// Name of a scene, and its motions with values of parameters and inputs.
pub type NamedScene = (&'static str, fn(&[(String, f64)]) -> Box<dyn SceneRuns>);

/// Order for a program that has scenes.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Order {
    /// Values of parameters and inputs by their names; others keep their defaults.
    pub values: Vec<(String, f64)>,
    /// End of the motion (s).
    pub until: f64,
    /// Instants behind the first.
    pub instants: u32,
    /// Tolerance of motions from forces.
    pub tolerance: f64,
    /// Outputs by their names, all where there are none; components by the name of their array.
    pub watched: Vec<String>,
    /// Longest time of a run (s).
    pub limit: f64,
}

/// A scene as it was measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Name of the scene.
    pub name: String,
    /// Reason why there is no motion.
    pub failure: Option<String>,
    /// `true` where forces move it.
    pub is_moved_by_forces: bool,
    /// Its watched outputs.
    pub outputs: Vec<Curve>,
    /// Steps of the motion.
    pub steps: u64,
    /// Time of a step (s), the shortest of several runs.
    pub step: f64,
    /// Machine code of the scene in the program (bytes), where the program's format is known.
    pub bytes: Option<u64>,
}

/// An output over the time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// Name, with the component's number for arrays.
    pub name: String,
    /// Unit of the text.
    pub unit: String,
    /// Values at the instants.
    pub values: Vec<f64>,
    /// Largest difference from a motion of ten times the tolerance; 0 where drives move the scene.
    pub error: f64,
    /// Least and largest values over perturbed starts; none for a scene without contacts.
    pub envelope: Option<[Vec<f64>; 2]>,
}

/// Perturbed starts of an envelope.
const PERTURBED: usize = 16;

/// Size of their changes in the reference metric: what one measures of a start.
const CHANGE: f64 = 1e-6;

/// Most and least runs of a scene that are timed, and the time of all (s) behind which no more than the least are begun.
const TIMED: [usize; 2] = [25, 3];
const TIMED_SECONDS: f64 = 1.0;

/// Instants of a motion.
pub fn instants(order: &Order) -> Vec<f64> {
    let parts = order.instants.max(1);
    (0..=parts).map(|k| order.until * f64::from(k) / f64::from(parts)).collect()
}

/// Numbers in [−1, 1]: fractional parts of multiples of the golden ratio.
fn shaken(set: usize, index: usize) -> f64 {
    2.0 * ((set as f64 * 61.0 + index as f64 * 7.0 + 1.0) * 0.618_033_988_749_895).fract() - 1.0
}

/// Changes of the perturbed starts; the first is none.
const SHIFTS: [fn(usize) -> [f64; 2]; PERTURBED + 1] = [
    |_| [0.0; 2],
    |index| shift(1, index),
    |index| shift(2, index),
    |index| shift(3, index),
    |index| shift(4, index),
    |index| shift(5, index),
    |index| shift(6, index),
    |index| shift(7, index),
    |index| shift(8, index),
    |index| shift(9, index),
    |index| shift(10, index),
    |index| shift(11, index),
    |index| shift(12, index),
    |index| shift(13, index),
    |index| shift(14, index),
    |index| shift(15, index),
    |index| shift(16, index),
];

fn shift(set: usize, index: usize) -> [f64; 2] {
    [CHANGE * shaken(set, 2 * index), CHANGE * shaken(set, 2 * index + 1)]
}

/// Measures `scenes`, times in turns so that the load of the machine falls on all alike.
pub fn measure(scenes: &[NamedScene], order: &Order) -> Vec<Measured> {
    let times = instants(order);
    let mut made: Vec<(Measured, Box<dyn SceneRuns>)> = Vec::new();
    for (name, make) in scenes {
        let runs = make(&order.values);
        let measured = moved(name, runs.as_ref(), order, &times);
        made.push((measured, runs));
    }
    let limit = Duration::from_secs_f64(order.limit);
    let asked = Asked { times: &times, tolerance: order.tolerance, shift: SHIFTS[0], limit };
    let [most, least] = TIMED;
    for round in 0..most {
        for (measured, runs) in &mut made {
            let spent = round as f64 * measured.step * measured.steps as f64;
            if measured.failure.is_some() || (least <= round && TIMED_SECONDS < spent) {
                continue;
            }
            if let Ok(effort) = runs.run(&asked, None) {
                let step = effort.elapsed.as_secs_f64() / effort.steps.max(1) as f64;
                let is_first = measured.step == 0.0;
                measured.step = if is_first { step } else { measured.step.min(step) };
                measured.steps = effort.steps;
            }
        }
    }
    let names: Vec<&str> = scenes.iter().map(|(name, _)| *name).collect();
    let sizes = bytes_of(&names);
    let mut found: Vec<Measured> = made.into_iter().map(|(measured, _)| measured).collect();
    for (index, measured) in found.iter_mut().enumerate() {
        measured.bytes = sizes.as_ref().and_then(|sizes| sizes.get(index)).copied().filter(|size| *size > 0);
    }
    found
}

/// The watched outputs of a scene: its motion, a less exact one, and perturbed ones where it has contacts.
fn moved(name: &str, runs: &dyn SceneRuns, order: &Order, times: &[f64]) -> Measured {
    let mut measured = Measured {
        name: name.to_string(),
        is_moved_by_forces: runs.mover() == Mover::Forces,
        ..Measured::default()
    };
    let outputs = runs.outputs();
    let is_watched = |entry: &str| {
        let asked = |name: &String| {
            entry == name || entry.strip_prefix(name.as_str()).is_some_and(|rest| rest.starts_with('.'))
        };
        order.watched.is_empty() || order.watched.iter().any(asked)
    };
    let chosen: Vec<usize> = (0..outputs.len()).filter(|index| is_watched(outputs[*index].name)).collect();
    let columns = |tolerance: f64, shift: fn(usize) -> [f64; 2]| -> Result<Vec<Vec<f64>>, String> {
        let limit = Duration::from_secs_f64(order.limit);
        let asked = Asked { times, tolerance, shift, limit };
        let mut columns = vec![Vec::with_capacity(times.len()); chosen.len()];
        let mut see = |values: &[f64]| {
            for (column, index) in columns.iter_mut().zip(&chosen) {
                column.push(values.get(*index).copied().unwrap_or(f64::NAN));
            }
        };
        runs.run(&asked, Some(&mut see))?;
        for (column, index) in columns.iter().zip(&chosen) {
            if let Some(at) = column.iter().position(|value| !value.is_finite()) {
                let t = times.get(at).copied().unwrap_or_default();
                return Err(format!("`{}` is no number at t = {t:.6} s", outputs[*index].name));
            }
            if column.len() != times.len() {
                return Err(format!("its motion ends before t = {} s", order.until));
            }
        }
        Ok(columns)
    };
    let values = match columns(order.tolerance, SHIFTS[0]) {
        Ok(values) => values,
        Err(reason) => return Measured { failure: Some(reason), ..measured },
    };
    let curve = |(index, values): (&usize, Vec<f64>)| Curve {
        name: outputs[*index].name.to_string(),
        unit: outputs[*index].unit.to_string(),
        values,
        ..Curve::default()
    };
    measured.outputs = chosen.iter().zip(values).map(curve).collect();
    if runs.mover() != Mover::Forces {
        return measured;
    }
    let rough = columns(10.0 * order.tolerance, SHIFTS[0]);
    for (index, curve) in measured.outputs.iter_mut().enumerate() {
        let other = rough.as_ref().ok().and_then(|columns| columns.get(index));
        let differences = other.map(|other| curve.values.iter().zip(other).map(|(a, b)| (a - b).abs()));
        // A run that fails at the rougher tolerance tells nothing about the error.
        curve.error = differences.map_or(f64::MAX, |differences| differences.fold(0.0, f64::max));
    }
    if runs.contacts() == 0 {
        return measured;
    }
    let mut lost = false;
    for shift in &SHIFTS[1..] {
        // As exact as the shift is large asks for.
        let Ok(columns) = columns((100.0 * order.tolerance).min(1e-8), *shift) else {
            lost = true;
            break;
        };
        for (curve, column) in measured.outputs.iter_mut().zip(columns) {
            let own = || [curve.values.clone(), curve.values.clone()];
            let [low, high] = curve.envelope.get_or_insert_with(own);
            for ((low, high), value) in low.iter_mut().zip(high).zip(column) {
                *low = low.min(value);
                *high = high.max(value);
            }
        }
    }
    if lost {
        // A start that is perturbed may lead nowhere: then nothing is known of its outputs.
        for curve in &mut measured.outputs {
            let count = curve.values.len();
            curve.envelope = Some([vec![f64::MIN; count], vec![f64::MAX; count]]);
        }
    }
    measured
}
