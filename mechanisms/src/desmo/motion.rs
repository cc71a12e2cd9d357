//! Motions of the valvetrain for its study: the last of some turns, sampled over the cam angle.

use core::f64::consts::TAU;
use std::time::{Duration, Instant};

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_runtime::{Energy, Failure};

use super::DesmoFriction;
use super::design::Curve;

/// The valvetrain with contacts, play and friction.
pub type Valvetrain = DesmoFriction<Curve, Curve>;

/// Names of [`Turn::forces`].
pub const FORCES: [&str; 5] =
    ["opener on its cam", "opener on the valve", "seat", "closer on its cam", "fork on the valve"];

/// A turn of the cam, one value for each cam angle.
#[derive(Clone, Debug, Default)]
pub struct Turn {
    /// Cam angle from −180 to 180 (deg).
    pub angle: Vec<f64>,
    /// Lift (m).
    pub lift: Vec<f64>,
    /// Acceleration of the valve, positive where it opens (m/s²).
    pub acceleration: Vec<f64>,
    /// Contact forces (N).
    pub forces: [Vec<f64>; 5],
    /// Torque that the cam needs (N m).
    pub torque: Vec<f64>,
    /// Work of the cam since the start (J).
    pub work: f64,
    /// Largest part of the work that energy, contacts and guide do not account for.
    pub defect: f64,
    /// Right-hand sides of all turns, and their time.
    pub evaluations: u64,
    /// Time of all turns.
    pub time: Duration,
}

impl Turn {
    /// The last of `turns` turns from rest at 180° before full lift, at `samples` cam angles.
    ///
    /// # Errors
    /// Those of [`Simulation::start_from_text`] and [`Simulation::watch`].
    pub fn of(valvetrain: &Valvetrain, turns: u32, samples: u32, tolerance: f64) -> Result<Self, Failure> {
        let started = Instant::now();
        let method: Explicit<DormandPrince8, Projection> = Explicit::default();
        let run = Simulation::start_from_text(valvetrain.clone(), method, 0.0)?;
        let mut run = run.with_tolerance(Tolerance::new(tolerance));
        let energy = |energy: Energy<f64>| energy.kinetic + energy.potential;
        let before = energy(run.balance().energy);
        let turn = TAU / valvetrain.speed.abs();
        if turns > 1 {
            run.advance_to(turn * f64::from(turns - 1))?;
        }
        let mut found = Turn::default();
        let mut defect = 0.0_f64;
        run.watch(turn * f64::from(turns), samples, |run| {
            let outputs = run.outputs();
            let loads = run.loads();
            let [torque, work, taken] = [0, 1, 2].map(|index| loads.as_ref()[index]);
            let forces = outputs.as_ref().iter().map(|output| output.value);
            found.forces.iter_mut().zip(forces).for_each(|(all, force)| all.push(force));
            // Over the place in the turn: an uneven cam has another angle.
            let place =
                f64::from(u32::try_from(found.lift.len() + 1).unwrap_or(samples)) / f64::from(samples);
            found.angle.push(360.0 * place - 180.0);
            found.lift.push(run.q()[2]);
            found.acceleration.push(run.qdd()[2]);
            found.torque.push(torque);
            found.work = work;
            let rest = work - (energy(run.balance().energy) - before) - taken;
            defect = defect.max(rest.abs());
        })?;
        found.defect = defect / found.work.abs().max(f64::MIN_POSITIVE);
        found.evaluations = run.counts().evaluations;
        found.time = started.elapsed();
        Ok(found)
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
        let touches = |k: usize| [1, 2, 4].iter().any(|force| self.forces[*force][k] > 0.0);
        let mut spans: Vec<[f64; 2]> = Vec::new();
        for (k, angle) in self.angle.iter().enumerate().filter(|(k, _)| !touches(*k)) {
            let before = if k == 0 { *angle } else { self.angle[k - 1] };
            match spans.last_mut() {
                Some(span) if span[1] == before => span[1] = *angle,
                _ => spans.push([before, *angle]),
            }
        }
        spans
    }

    /// Part of the turn in which nothing touches the valve.
    pub fn in_flight(&self) -> f64 {
        self.flights().iter().fold(0.0, |sum, [from, to]| sum + to - from) / 360.0
    }
}
