//! Reference tables and comparisons that the tests of the mechanisms share.

use core::f64::consts::{PI, TAU};

use crate::closed_form::{Jet, assert_moves_as, column};
use mbs_workbench::card::{Card, Preset};
use mbs_workbench::catalogue::sweep;
use mbs_workbench::erased::dynamics::direct_dynamics::{Approach, Pair, Simulated, Stabilization, Steps};
use mbs_workbench::erased::facade::Motion;
use mbs_workbench::motion::instants;
pub use mechanisms::known::table;

/// Every entry within `bound` of the expected one, measured by the larger of 1 and the expected magnitude.
#[track_caller]
pub fn assert_near(found: &[f64], expected: &[f64], bound: f64) {
    assert_eq!(found.len(), expected.len());
    for (index, (found, expected)) in found.iter().zip(expected).enumerate() {
        let error = (found - expected).abs() / expected.abs().max(1.0);
        assert!(error <= bound, "entry {index}: {found} instead of {expected}, error {error:e}");
    }
}

/// Distance of two angles (rad) on the circle.
pub fn angle_difference(a: f64, b: f64) -> f64 {
    ((a - b + PI).rem_euclid(TAU) - PI).abs()
}

/// The preset of this index in the card's text.
#[track_caller]
fn preset(card: &Card, run: usize) -> Preset {
    card.runs().expect("a text").swap_remove(run)
}

/// The card's run over its span in `steps` steps.
#[track_caller]
pub fn one_turn(card: &Card, run: usize, steps: usize) -> Motion {
    let run = preset(card, run);
    let mechanism = card.fixed_instance(&run).expect("parameters of the preset");
    let duration = card.duration(mechanism.as_ref()).expect("a duration");
    match sweep(mechanism.as_ref(), duration, steps) {
        Ok(motion) => motion,
        Err(failure) => panic!("{}, {}: {failure}", card.name(), run.label),
    }
}

/// The motion in steps of `step` (s) passes the reference rows `t, q.., q̇.., q̈..` within `bound`.
///
/// Every time of the rows must be a multiple of `step`.
#[track_caller]
pub fn assert_follows(card: &Card, run: usize, step: f64, rows: &[Vec<f64>], bound: f64) {
    let mechanism = card.fixed_instance(&preset(card, run)).expect("parameters of the preset");
    let index = |t: f64| (t / step).round() as usize;
    let last = rows.iter().map(|row| index(row[0])).max().unwrap_or(0);
    let mut times: Vec<f64> = (0..=last).map(|k| k as f64 * step).collect();
    for row in rows {
        assert!((times[index(row[0])] - row[0]).abs() < 1e-12, "{} is no multiple of {step}", row[0]);
        times[index(row[0])] = row[0];
    }
    let motion = mechanism.follow(&times, &mut |_| ()).unwrap_or_else(|failure| panic!("{failure}"));
    for row in rows {
        let at = index(row[0]);
        let columns = |pick: fn(&mbs_workbench::erased::facade::CoordinateCurve) -> &Vec<f64>| {
            motion.coordinates.iter().map(|coordinate| pick(coordinate)[at]).collect::<Vec<_>>()
        };
        let found = [columns(|c| &c.q), columns(|c| &c.qd), columns(|c| &c.qdd)].concat();
        assert_near(&found, &row[1..], bound);
    }
}

/// Over a turn of each preset the columns `names` of one mechanism are those of another, within `bound`.
#[track_caller]
pub fn assert_moves_like(card: &Card, other: &Card, names: &[&str], bound: f64) {
    let count = |card: &Card| card.runs().expect("a text").len();
    for run in 0..count(card).min(count(other)) {
        let (motion, expected) = (one_turn(card, run, 180), one_turn(other, run, 180));
        let columns: Vec<_> = names.iter().map(|name| column(&expected, name).1).collect();
        let mut steps = 0..;
        assert_moves_as(&motion, names, bound, |_| {
            let step = steps.next().expect("it never ends");
            columns.iter().map(|[q, qd, qdd]| Jet([q[step], qd[step], qdd[step]])).collect()
        });
    }
}

/// The motion from forces of `run` over the card's duration in `steps` instants, with projection at tolerance 1e-12.
#[track_caller]
pub fn dynamics_of(card: &Card, run: usize, steps: usize) -> Simulated {
    let run = preset(card, run);
    let mechanism = card.instance(&run).expect("parameters of the preset");
    let duration = card.duration(mechanism.equations()).expect("a duration");
    dynamics_at(card, &run, &instants(duration, steps))
}

/// The same at `times` (s) of equal distances.
#[track_caller]
pub fn dynamics_at(card: &Card, run: &Preset, times: &[f64]) -> Simulated {
    let mechanism = card.instance(run).expect("parameters of the preset");
    let dynamics = mechanism.dynamics().expect("it has masses");
    let approach = Approach {
        stabilization: Stabilization::Projection,
        steps: Steps::Adaptive { pair: Pair::Order8, tolerance: 1e-12 },
    };
    let found = dynamics.simulate(&approach, times, &mut |_| ());
    let found = found.unwrap_or_else(|failure| panic!("{}, {}: {failure}", card.name(), run.label));
    assert_eq!(found.failure, None, "{}, {}", card.name(), run.label);
    found
}

/// The values of a load.
#[track_caller]
pub fn load<'a>(motion: &'a Motion, name: &str) -> &'a [f64] {
    let forces = motion.dynamics.as_ref().expect("it has masses");
    &forces.loads.iter().find(|load| load.name == name).unwrap_or_else(|| panic!("no load {name}")).value
}
