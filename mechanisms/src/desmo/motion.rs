//! Motions of the valvetrain for its study: the last of some turns, sampled over the cam angle.

use core::f64::consts::{PI, TAU};
use std::time::{Duration, Instant};

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_runtime::{Dynamic, Energy, Failure, Stepper};
use mbs_workbench::cams::lift::Lift;

use super::design::{Curve, Design};
use super::{DesmoFriction, DesmoHeld, DesmoOrdinary};

/// The valvetrain with contacts, play and friction.
pub type Valvetrain = DesmoFriction<Curve>;

/// The valvetrain with a valve spring in place of the closing cam.
pub type Ordinary = DesmoOrdinary<Curve>;

/// Names of [`Turn::forces`].
pub const FORCES: [&str; 5] =
    ["opener on its cam", "opener on the valve", "seat", "closer on its cam", "fork on the valve"];

/// Motion of the valve with permanent contact over the cam angle.
#[derive(Clone, Debug, Default)]
pub struct Permanent {
    /// Cam angle from −180 to 180 (deg).
    pub angle: Vec<f64>,
    /// Lift (m), velocity (m/rad), acceleration (m/rad²).
    pub columns: [Vec<f64>; 3],
    /// Distance of the closer's fork from the place where the opener holds the valve (m).
    pub apart: Vec<f64>,
}

impl Permanent {
    /// At `places` cam angles of a turn, shifted by the share `shift` of their distance.
    ///
    /// # Errors
    /// Those of [`Stepper::assemble`] and [`Stepper::advance_to`].
    pub fn of(design: &Design, pitch: &[Curve; 2], places: u32, shift: f64) -> Result<Self, Failure> {
        let mut mechanism = design.moved_by(pitch.clone());
        mechanism.speed = 1.0;
        let mut stepper = Stepper::assemble(mechanism, [-PI, 0.0, 0.0, 0.0], 0.0)?;
        let mut found = Permanent::default();
        for step in 0..places {
            let t = TAU * (f64::from(step) + shift) / f64::from(places);
            stepper.advance_to(t)?;
            let outputs = stepper.outputs();
            let [apart, lift] = [outputs.as_ref()[0], outputs.as_ref()[1]];
            found.angle.push((t - PI).to_degrees());
            found.apart.push(apart.value);
            let values = [Some(lift.value), lift.rate, lift.acceleration];
            found
                .columns
                .iter_mut()
                .zip(values)
                .for_each(|(column, value)| column.push(value.unwrap_or(f64::NAN)));
        }
        Ok(found)
    }

    /// The law and its derivatives at the same cam angles.
    pub fn law(&self, law: &Lift) -> [Vec<f64>; 3] {
        let jets: Vec<[f64; 4]> = self.angle.iter().map(|angle| law.jet(angle.to_radians())).collect();
        [0, 1, 2].map(|order| jets.iter().map(|jet| jet[order]).collect())
    }
}

/// Largest differences of lift, velocity and acceleration from the law over a turn (m over rad) with permanent contact. The last
/// number is the range of the distance of both rockers (m). Compared are 720 places, shifted by this share of their distance.
///
/// # Errors
/// Those of [`Permanent::of`].
pub fn against_law(design: &Design, pitch: &[Curve; 2], shift: f64) -> Result<[f64; 4], Failure> {
    let found = Permanent::of(design, pitch, 720, shift)?;
    let law = found.law(&design.law);
    let [lift, velocity, acceleration] = [0, 1, 2].map(|order| {
        let pairs = found.columns[order].iter().zip(&law[order]);
        // A derivative that is not known is no small error.
        pairs
            .map(|(found, law)| (found - law).abs())
            .fold(0.0, |most: f64, error| if error.is_nan() { f64::INFINITY } else { most.max(error) })
    });
    let (least, most) =
        found.apart.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), apart| {
            (least.min(*apart), most.max(*apart))
        });
    Ok([lift, velocity, acceleration, most - least])
}

/// Contradiction of both cams over the cam angle: the way of the fork less the one of the valve, with permanent contact.
#[derive(Clone, Debug, Default)]
pub struct Misfit {
    /// Cam angle from −180 to 180 (deg).
    pub angle: Vec<f64>,
    /// Position (m), rate (m/rad), acceleration (m/rad²).
    pub columns: [Vec<f64>; 3],
}

impl Misfit {
    /// Largest magnitudes of position, rate and acceleration.
    pub fn largest(&self) -> [f64; 3] {
        [0, 1, 2].map(|order| self.columns[order].iter().fold(0.0, |most: f64, value| most.max(value.abs())))
    }

    /// At `places` cam angles of a turn, shifted by the share `shift` of their distance.
    ///
    /// # Errors
    /// Those of [`Stepper::assemble`] and [`Stepper::advance_to`]. Cams of coarse tables may contradict each other by more than the text
    /// allows: the row yields by twice what permanent contact without it leaves.
    pub fn of(design: &Design, pitch: &[Curve; 2], places: u32, shift: f64) -> Result<Self, Failure> {
        let mut mechanism: DesmoHeld<_> = design.moved_by(pitch.clone()).scene();
        mechanism.speed = 1.0;
        let free = Permanent::of(design, pitch, places, shift)?;
        let apart = free.apart.iter().fold(0.0, |most: f64, apart| most.max(apart.abs()));
        mechanism.misfit = mechanism.misfit.max(2.0 * apart);
        let mut stepper = Stepper::assemble(mechanism, [-PI, 0.0, 0.0, 0.0], 0.0)?;
        let mut found = Misfit::default();
        for step in 0..places {
            let t = TAU * (f64::from(step) + shift) / f64::from(places);
            stepper.advance_to(t)?;
            found.angle.push((t - PI).to_degrees());
            for row in stepper.mismatches() {
                let values = [row.position, row.rate, row.acceleration];
                found.columns.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
            }
        }
        Ok(found)
    }
}

/// Parts of a step at which largest values are looked for; a step is a fraction of an impact.
const PARTS: u32 = 8;

/// The one with the larger magnitude.
fn larger(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}

/// A turn of the cam, one value for each cam angle.
///
/// Accelerations, forces and torques are those of largest magnitude from one cam angle to the next. These are of all steps of the
/// motion, for an impact is shorter than the distance of two cam angles.
#[derive(Clone, Debug, Default)]
pub struct Turn {
    /// Cam angle from −180 to 180 (deg).
    pub angle: Vec<f64>,
    /// Cam angle and angle of the opener (rad), lift (m), angle of the closer (rad), which stays empty without one.
    pub coordinates: [Vec<f64>; 4],
    /// Acceleration of the valve, positive where it opens (m/s²).
    pub acceleration: Vec<f64>,
    /// Contact forces (N); those of a closer that is not there are 0.
    pub forces: [Vec<f64>; 5],
    /// `true` of each contact that is closed at the cam angle itself.
    pub closed: [Vec<bool>; 5],
    /// Torque that the cam needs (N m).
    pub torque: Vec<f64>,
    /// Work of the cam since the start (J).
    pub work: f64,
    /// Largest part of the work that energy, contacts and guide do not account for.
    pub defect: f64,
    /// Right-hand sides of all turns.
    pub evaluations: u64,
    /// Time of all turns, without that of largest values.
    pub time: Duration,
}

impl Turn {
    /// The last of `turns` turns from rest at 180° before full lift, at `samples` cam angles.
    ///
    /// # Errors
    /// Those of [`Simulation::start_from_text`] and [`Simulation::watch`].
    pub fn of(valvetrain: &Valvetrain, turns: u32, samples: u32, tolerance: f64) -> Result<Self, Failure> {
        Self::moved((valvetrain.clone(), valvetrain.speed), turns, samples, tolerance)
    }

    /// The same with a valve spring in place of the closing cam; work and defect stay 0.
    ///
    /// # Errors
    /// As [`of`](Self::of).
    pub fn of_spring(
        valvetrain: &Ordinary,
        turns: u32,
        samples: u32,
        tolerance: f64,
    ) -> Result<Self, Failure> {
        Self::moved((valvetrain.clone(), valvetrain.speed), turns, samples, tolerance)
    }

    /// The last turn of a mechanism at this speed (rad/s).
    fn moved<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
        (mechanism, speed): (S, f64),
        turns: u32,
        samples: u32,
        tolerance: f64,
    ) -> Result<Self, Failure> {
        let started = Instant::now();
        let method: Explicit<DormandPrince8, Projection> = Explicit::default();
        let run = Simulation::start_from_text(mechanism, method, 0.0)?;
        let mut run = run.with_tolerance(Tolerance::new(tolerance));
        let energy = |energy: Energy<f64>| energy.kinetic + energy.potential;
        let before = energy(run.balance().energy);
        let turn = TAU / speed.abs();
        if turns > 1 {
            run.advance_to(turn * f64::from(turns - 1))?;
        }
        let mut found = Turn::default();
        let (mut defect, mut within) = (0.0_f64, run.clone());
        let (from, until) = (run.t(), turn * f64::from(turns));
        run.watch(until, samples, |run| {
            let (outputs, loads) = (run.outputs(), run.loads());
            let forces = outputs.as_ref().iter().map(|output| output.value).chain(core::iter::repeat(0.0));
            for ((all, closed), force) in found.forces.iter_mut().zip(&mut found.closed).zip(forces) {
                all.push(force);
                closed.push(force > 0.0);
            }
            // Over the place in the turn: an uneven cam has another angle.
            let place =
                f64::from(u32::try_from(found.angle.len() + 1).unwrap_or(samples)) / f64::from(samples);
            found.angle.push(360.0 * place - 180.0);
            found.coordinates.iter_mut().zip(run.q()).for_each(|(all, value)| all.push(*value));
            found.acceleration.push(run.qdd()[2]);
            found.torque.push(loads.as_ref()[0]);
            if let [_, work, taken] = loads.as_ref() {
                found.work = *work;
                let rest = work - (energy(run.balance().energy) - before) - taken;
                defect = defect.max(rest.abs());
            }
        })?;
        found.time = started.elapsed();
        within.watch_steps(until, PARTS, |run| {
            let place = (run.t() - from) / (until - from) * f64::from(samples);
            let Some(k) = (place.ceil() as usize).min(found.angle.len()).checked_sub(1) else { return };
            let (outputs, loads) = (run.outputs(), run.loads());
            for (all, force) in found.forces.iter_mut().zip(outputs.as_ref()) {
                all[k] = all[k].max(force.value);
            }
            found.acceleration[k] = larger(found.acceleration[k], run.qdd()[2]);
            found.torque[k] = larger(found.torque[k], loads.as_ref()[0]);
        })?;
        found.defect = defect / found.work.abs().max(f64::MIN_POSITIVE);
        found.evaluations = run.counts().evaluations;
        Ok(found)
    }

    /// Lift (m) over the cam angle.
    pub fn lift(&self) -> &[f64] {
        &self.coordinates[2]
    }

    /// Intervals of the cam angle (deg) in which a contact is closed.
    pub fn touches(&self, force: usize) -> Vec<[f64; 2]> {
        self.spans(|k| self.closed[force][k])
    }

    /// Intervals of the cam angle (deg) at which `holds` holds.
    fn spans(&self, holds: impl Fn(usize) -> bool) -> Vec<[f64; 2]> {
        let mut spans: Vec<[f64; 2]> = Vec::new();
        for (k, angle) in self.angle.iter().enumerate().filter(|(k, _)| holds(*k)) {
            let before = if k == 0 { *angle } else { self.angle[k - 1] };
            match spans.last_mut() {
                Some(span) if span[1] == before => span[1] = *angle,
                _ => spans.push([before, *angle]),
            }
        }
        spans
    }

    /// Largest value of a contact force (N).
    pub fn peak(&self, force: usize) -> f64 {
        self.forces[force].iter().copied().fold(0.0, f64::max)
    }

    /// Largest magnitude of the valve's acceleration (m/s²).
    pub fn hardest(&self) -> f64 {
        self.acceleration.iter().fold(0.0, |most: f64, value| most.max(value.abs()))
    }

    /// Intervals of the cam angle (deg) in which neither rocker nor the seat touches the valve.
    pub fn flights(&self) -> Vec<[f64; 2]> {
        self.spans(|k| [1, 2, 4].iter().all(|force| !self.closed[*force][k]))
    }

    /// Part of the turn in which nothing touches the valve.
    pub fn in_flight(&self) -> f64 {
        self.flights().iter().fold(0.0, |sum, [from, to]| sum + to - from) / 360.0
    }
}
