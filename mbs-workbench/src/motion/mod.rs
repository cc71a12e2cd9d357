//! Motions as plain columns.

pub mod course;
pub mod mismatch;
pub mod power_balance;

use mbs_runtime::{Energy, Entry, OutputValue};
use serde::Serialize;

use crate::motion::mismatch::MismatchCurve;
use crate::motion::power_balance::{PowerCurve, PowerSource, works};

/// A state at which functions are evaluated: `q`, `q̇`, `q̈` (N each, coordinate unit per s, s²) and `t` (s).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Coordinates.
    pub q: Vec<f64>,
    /// Velocities.
    pub qd: Vec<f64>,
    /// Accelerations.
    pub qdd: Vec<f64>,
    /// Time (s).
    pub t: f64,
}

/// A motion as plain columns, one value an instant.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Motion {
    /// Instants (s).
    pub time: Vec<f64>,
    /// Coordinates.
    pub coordinates: Vec<CoordinateCurve>,
    /// Outputs, component by component.
    pub outputs: Vec<OutputCurve>,
    /// Largest residual, each row measured in the reference metric (dimensionless).
    pub closure: Vec<f64>,
    /// Evaluations that the instant took: of the constraints for a position, of the equations of motion since the
    /// instant before.
    pub iterations: Vec<u32>,
    /// Margin to singularity: 0 where singular, at most 1.
    pub margin: Vec<f64>,
    /// Contradictions of rows that yield; none of a motion from forces, which holds all rows.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mismatches: Vec<MismatchCurve>,
    /// Energies and forces, where there are masses.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dynamics: Option<Forces>,
}

/// Energies and forces of a motion, one value an instant.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Forces {
    /// Kinetic energy (J).
    pub kinetic: Vec<f64>,
    /// Potential energy (J).
    pub potential: Vec<f64>,
    /// Work of forces and drives since the start (J): integrated with a motion from forces, for a driven one by [`works`];
    /// empty at rest.
    pub work: Vec<f64>,
    /// Energy less work less the energy at the start (J); empty at rest.
    pub defect: Vec<f64>,
    /// Largest |Φ̇ᵢ|, each row measured in the reference metric (1/s); empty where nothing is integrated.
    pub closure_rate: Vec<f64>,
    /// Outputs that use multipliers or states, component by component.
    pub loads: Vec<LoadCurve>,
    /// Multipliers, one a row.
    pub multipliers: Vec<LoadCurve>,
    /// Powers and works of forces, of rows and of the time; empty at rest.
    pub supplies: Vec<PowerCurve>,
    /// First-order states of the text at the last instant.
    #[serde(skip)]
    pub states: Vec<f64>,
    /// Number of rows that follow from others, one value an instant.
    pub dependent: Vec<u32>,
    /// Those rows, each once.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub dependent_rows: Vec<DependentRow>,
}

/// A row that follows from others at some instants.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DependentRow {
    /// Name, as the text labels it.
    pub name: &'static str,
    /// Its line in the text.
    pub line: u32,
    /// Number of those instants.
    pub instants: usize,
}

/// A load or a multiplier over the time.
#[derive(Clone, Debug, Serialize)]
pub struct LoadCurve {
    /// Name of the output or of the row.
    pub name: &'static str,
    /// Unit of the values.
    pub unit: String,
    /// Values.
    pub value: Vec<f64>,
    /// Number of instants at which the value is not unique, because rows follow from others; the minimum-norm value is given.
    pub shared: usize,
}

/// One instant of a motion.
#[derive(Clone, Copy, Debug)]
pub struct Instant<'a> {
    /// Time (s).
    pub t: f64,
    /// Coordinates, velocities and accelerations: N each.
    pub q: [&'a [f64]; 3],
    /// Outputs with their derivatives.
    pub outputs: &'a [OutputValue<f64>],
    /// Largest residual in the reference metric.
    pub closure: f64,
    /// Evaluations since the instant before.
    pub iterations: u32,
    /// Margin to singularity.
    pub margin: f64,
}

/// A coordinate over the time.
#[derive(Clone, Debug, Serialize)]
pub struct CoordinateCurve {
    /// As the text spells it.
    pub name: &'static str,
    /// Unit of `q`; those of `qd` and `qdd` are this per s and per s².
    pub unit: &'static str,
    /// Position.
    pub q: Vec<f64>,
    /// Velocity.
    pub qd: Vec<f64>,
    /// Acceleration.
    pub qdd: Vec<f64>,
}

/// A component of an output over the time.
#[derive(Clone, Debug, Serialize)]
pub struct OutputCurve {
    /// As the text spells it, components counted from 0: `P.0`.
    pub name: &'static str,
    /// Unit of `value`; those of the derivatives are this per s and per s².
    pub unit: &'static str,
    /// Value.
    pub value: Vec<f64>,
    /// First derivative, where the definition leaves one.
    pub rate: Option<Vec<f64>>,
    /// Second derivative, where the definition leaves one.
    pub acceleration: Option<Vec<f64>>,
}

impl Motion {
    /// The last instant's state, which is at `t` (s).
    pub fn last(&self, t: f64) -> State {
        let last = |pick: fn(&CoordinateCurve) -> &Vec<f64>| {
            self.coordinates.iter().filter_map(|curve| pick(curve).last().copied()).collect()
        };
        State { q: last(|curve| &curve.q), qd: last(|curve| &curve.qd), qdd: last(|curve| &curve.qdd), t }
    }

    /// Numbers an instant, the time included.
    pub fn columns(&self) -> usize {
        let given = |column: &Option<Vec<f64>>| usize::from(column.is_some());
        let outputs = self.outputs.iter().map(|curve| 1 + given(&curve.rate) + given(&curve.acceleration));
        let forces = self.dynamics.iter().map(|forces| {
            let optional = [&forces.work, &forces.defect, &forces.closure_rate];
            let optional = optional.iter().filter(|values| !values.is_empty()).count();
            3 + optional + forces.loads.len() + forces.multipliers.len() + 2 * forces.supplies.len()
        });
        4 + 3 * (self.coordinates.len() + self.mismatches.len())
            + outputs.sum::<usize>()
            + forces.sum::<usize>()
    }

    /// At most `count` instants spread evenly over the motion, first and last included, with the digits that a page shows.
    pub fn decimate(&self, count: usize) -> Motion {
        let kept = spread(self.time.len(), count);
        let pick = |values: &Vec<f64>| kept.iter().map(|index| rounded(values[*index])).collect::<Vec<_>>();
        let coordinate = |curve: &CoordinateCurve| CoordinateCurve {
            q: pick(&curve.q),
            qd: pick(&curve.qd),
            qdd: pick(&curve.qdd),
            ..*curve
        };
        let output = |curve: &OutputCurve| OutputCurve {
            value: pick(&curve.value),
            rate: curve.rate.as_ref().map(pick),
            acceleration: curve.acceleration.as_ref().map(pick),
            ..*curve
        };
        Motion {
            time: pick(&self.time),
            coordinates: self.coordinates.iter().map(coordinate).collect(),
            outputs: self.outputs.iter().map(output).collect(),
            closure: pick(&self.closure),
            iterations: kept.iter().map(|index| self.iterations[*index]).collect(),
            margin: pick(&self.margin),
            mismatches: self.mismatches.iter().map(|curve| curve.picked(pick)).collect(),
            dynamics: self.dynamics.as_ref().map(|forces| forces.picked(&kept, pick)),
        }
    }

    /// No instant yet; outputs have the derivatives that `values` have.
    pub fn of(coordinates: &'static [Entry], outputs: &'static [Entry], values: &[OutputValue<f64>]) -> Self {
        let coordinate = |e: &Entry| CoordinateCurve {
            name: e.name,
            unit: e.unit,
            q: Vec::new(),
            qd: Vec::new(),
            qdd: Vec::new(),
        };
        let output = |(e, value): (&Entry, &OutputValue<f64>)| OutputCurve {
            name: e.name,
            unit: e.unit,
            value: Vec::new(),
            rate: value.rate.map(|_| Vec::new()),
            acceleration: value.acceleration.map(|_| Vec::new()),
        };
        Motion {
            coordinates: coordinates.iter().map(coordinate).collect(),
            outputs: outputs.iter().zip(values).map(output).collect(),
            ..Motion::default()
        }
    }

    /// One instant more.
    pub fn push(&mut self, instant: &Instant) {
        let [q, qd, qdd] = instant.q;
        self.time.push(instant.t);
        for (curve, ((q, qd), qdd)) in self.coordinates.iter_mut().zip(q.iter().zip(qd).zip(qdd)) {
            curve.q.push(*q);
            curve.qd.push(*qd);
            curve.qdd.push(*qdd);
        }
        for (curve, output) in self.outputs.iter_mut().zip(instant.outputs) {
            curve.value.push(output.value);
            let derivatives =
                [(&mut curve.rate, output.rate), (&mut curve.acceleration, output.acceleration)];
            for (column, value) in derivatives {
                column.iter_mut().zip(value).for_each(|(column, value)| column.push(value));
            }
        }
        self.closure.push(instant.closure);
        self.iterations.push(instant.iterations);
        self.margin.push(instant.margin);
    }
}

impl Forces {
    /// No instant yet, for outputs `loads` and the multipliers of `rows`.
    pub fn of(loads: &[Entry], rows: &[Entry]) -> Self {
        let curve = |name, unit| LoadCurve { name, unit, value: Vec::new(), shared: 0 };
        Forces {
            loads: loads.iter().map(|entry| curve(entry.name, entry.unit.to_string())).collect(),
            multipliers: rows.iter().map(|row| curve(row.name, multiplier_unit(row.unit))).collect(),
            ..Forces::default()
        }
    }

    /// Energies, loads and multipliers of one instant more.
    pub fn push(&mut self, energy: Energy<f64>, loads: &[f64], lambda: &[f64]) {
        self.kinetic.push(energy.kinetic);
        self.potential.push(energy.potential);
        let curves = self.loads.iter_mut().zip(loads).chain(self.multipliers.iter_mut().zip(lambda));
        curves.for_each(|(curve, value)| curve.value.push(*value));
    }

    /// Determinacy at the last instant: counts the loads that `loads` and the multipliers that `unique` mark with `false`, and
    /// the `dependent` rows.
    pub fn push_determinacy(&mut self, loads: &[bool], unique: &[bool], dependent: &[Entry]) {
        let curves = self.loads.iter_mut().zip(loads).chain(self.multipliers.iter_mut().zip(unique));
        curves.for_each(|(curve, unique)| curve.shared += usize::from(!unique));
        self.dependent.push(u32::try_from(dependent.len()).unwrap_or(u32::MAX));
        for row in dependent {
            match self.dependent_rows.iter_mut().find(|known| known.name == row.name) {
                Some(known) => known.instants += 1,
                None => {
                    self.dependent_rows.push(DependentRow { name: row.name, line: row.line, instants: 1 });
                }
            }
        }
    }

    /// Powers (W) of one instant more, always the same ones in the same order.
    pub fn push_powers(&mut self, powers: impl Iterator<Item = (&'static str, PowerSource, f64)>) {
        let first = self.supplies.iter().all(|supply| supply.power.is_empty());
        for (index, (name, by, power)) in powers.enumerate() {
            if first {
                self.supplies.push(PowerCurve::of(name, by));
            }
            if let Some(supply) = self.supplies.get_mut(index) {
                supply.power.push(power);
            }
        }
    }

    /// Adds the work of each power over the instants `time` (s). If no work was integrated with the motion, also their sum and
    /// the energy defect.
    pub fn add_works(&mut self, time: &[f64]) {
        for supply in &mut self.supplies {
            supply.work = works(time, &supply.power);
        }
        if self.work.is_empty() {
            let sum = |instant: usize| self.supplies.iter().map(|supply| supply.work[instant]).sum();
            self.work = (0..time.len()).map(sum).collect();
            let energy = |instant: usize| self.kinetic[instant] + self.potential[instant];
            self.defect =
                self.work.iter().enumerate().map(|(k, work)| energy(k) - energy(0) - work).collect();
        }
    }

    fn picked(&self, kept: &[usize], pick: impl Fn(&Vec<f64>) -> Vec<f64>) -> Forces {
        let curves = |curves: &[LoadCurve]| {
            let curve = |curve: &LoadCurve| LoadCurve {
                name: curve.name,
                unit: curve.unit.clone(),
                value: pick(&curve.value),
                shared: curve.shared,
            };
            curves.iter().map(curve).collect()
        };
        let optional = |values: &Vec<f64>| if values.is_empty() { Vec::new() } else { pick(values) };
        Forces {
            kinetic: pick(&self.kinetic),
            potential: pick(&self.potential),
            work: optional(&self.work),
            defect: optional(&self.defect),
            closure_rate: optional(&self.closure_rate),
            loads: curves(&self.loads),
            multipliers: curves(&self.multipliers),
            supplies: self
                .supplies
                .iter()
                .map(|supply| PowerCurve { power: pick(&supply.power), work: pick(&supply.work), ..*supply })
                .collect(),
            states: self.states.clone(),
            dependent: kept.iter().filter_map(|index| self.dependent.get(*index).copied()).collect(),
            dependent_rows: self.dependent_rows.clone(),
        }
    }
}

/// Leaves out of all motions the rows that supply nothing in any of them, and a time that changes nothing.
///
/// Before: motions of one mechanism. After: the others in the same order, the same of every motion.
pub fn drop_idle(motions: &mut [&mut Motion]) {
    let supplies = |motion: &Motion| motion.dynamics.as_ref().map_or(0, |forces| forces.supplies.len());
    let count = motions.iter().map(|motion| supplies(motion)).max().unwrap_or(0);
    let idle = |motion: &&mut Motion, index: usize| {
        let supply = motion.dynamics.as_ref().and_then(|forces| forces.supplies.get(index));
        supply.is_none_or(PowerCurve::is_idle)
    };
    // The source of a row may be known only in motions in which it does work.
    let by = |index: usize, motions: &[&mut Motion]| {
        let acting = motions.iter().find(|motion| !idle(motion, index))?;
        acting.dynamics.as_ref()?.supplies.get(index).map(|supply| supply.by)
    };
    let kept: Vec<Option<PowerSource>> = (0..count).map(|index| by(index, motions)).collect();
    for forces in motions.iter_mut().filter_map(|motion| motion.dynamics.as_mut()) {
        let mut marks = kept.iter();
        forces.supplies.retain_mut(|supply| match marks.next() {
            Some(by) => by.map(|by| supply.by = by).is_some(),
            None => true,
        });
    }
}

/// `value` to seven digits, one more than a page shows.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}

/// Unit of the multiplier of a row in `unit`: λ times the row is an energy.
pub fn multiplier_unit(unit: &str) -> String {
    match unit {
        "1" | "rad" => "N*m".to_string(),
        "m" => "N".to_string(),
        "m^2" => "N/m".to_string(),
        other => format!("N*m/({other})"),
    }
}

/// At most `count` indices below `length`, evenly spread, first and last included.
pub fn spread(length: usize, count: usize) -> Vec<usize> {
    let last = length.saturating_sub(1);
    if length <= count || count < 2 {
        return (0..length.min(count)).collect();
    }
    (0..count).map(|index| index * last / (count - 1)).collect()
}

/// `steps` equal steps from 0 to `duration` (s): `steps + 1` instants.
pub fn instants(duration: f64, steps: usize) -> Vec<f64> {
    (0..=steps).map(|step| duration * step as f64 / steps.max(1) as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_indices_reach_from_the_first_to_the_last() {
        assert_eq!(spread(721, 9), [0, 90, 180, 270, 360, 450, 540, 630, 720]);
        assert_eq!(spread(3, 9), [0, 1, 2]);
        assert_eq!(spread(1, 9), [0]);
        assert!(spread(0, 9).is_empty() && spread(9, 0).is_empty());
    }

    #[test]
    fn seven_digits_are_kept_of_every_size() {
        assert_eq!(
            [0.1 + 0.2, -123_456_789.0, 1.0 / 3.0, 0.0].map(rounded),
            [0.3, -123_456_800.0, 0.3333333, 0.0]
        );
        assert_eq!((rounded(1.234_567_89e-17), rounded(f64::INFINITY)), (1.234_568e-17, f64::INFINITY));
        assert!(rounded(f64::NAN).is_nan());
    }

    #[test]
    fn multipliers_times_rows_are_energies() {
        let units = ["rad", "m", "m^2", "m^3"].map(multiplier_unit);
        assert_eq!(units, ["N*m", "N", "N/m", "N*m/(m^3)"]);
    }
}
