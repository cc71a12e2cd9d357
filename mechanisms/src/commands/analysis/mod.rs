//! The analyses of `mbs run`: each turns a mechanism into a motion with figures.

mod direct;
mod driven;
mod given;
mod linear;
mod loads;
mod method;
mod rest;
mod watch;

use clap::ValueEnum;
use mechanisms::analyses::AnyDynamics;
use mechanisms::analyses::direct::{Approach, Stabilization, Steps, equal};
use mechanisms::analyses::linear::SmallMotions;
use mechanisms::facade::{AnyMechanism, Motion};
use mechanisms::registry::{Preset, instants};

pub use self::direct::{doubtful, largest, undetermined};
pub use self::given::Given;
pub use self::method::{Damping, IntegratorName, MethodName, above_zero, at_least_zero, tolerance};
use self::watch::{Watch, progress};
use super::CommandError;
use super::chosen::coordinate;
use super::subject::{Instance, Subject};

/// What is computed of a mechanism.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum Analysis {
    /// Positions, velocities and accelerations that drives prescribe
    Kinematic,
    /// The motion that forces cause
    Dynamic,
    /// The position of rest
    Static,
    /// Efforts and loads of the motion that drives prescribe
    Inverse,
    /// Small motions about the position of rest, or about a state: their eigenvalues
    Linear,
}

/// A motion with what is worth saying about it.
pub struct Done {
    pub label: String,
    pub description: &'static str,
    pub motion: Motion,
    pub figures: Vec<[String; 2]>,
    /// Small motions about its last instant, where they were asked for.
    pub small: Option<SmallMotions>,
}

/// What the command line says about an analysis.
pub struct Wish {
    pub analysis: Option<Analysis>,
    pub stabilization: Stabilization,
    /// Of an explicit method.
    pub steps_of_method: Steps,
    /// Coordinates by name that the search for a position of rest starts from.
    pub guesses: Vec<(String, f64)>,
    /// Time (s) of the state that small motions are about.
    pub at: Option<f64>,
    pub until: Option<f64>,
    pub steps: usize,
    /// Options of the command line that say how a motion is divided or integrated.
    pub given: Given,
}

impl Wish {
    /// The analysis asked for, or the one that moves the mechanism.
    pub fn analysis_of(&self, subject: Subject) -> Analysis {
        let standard = match subject {
            Subject::Fixed(_) => Analysis::Kinematic,
            Subject::Free(_) => Analysis::Dynamic,
        };
        self.analysis.unwrap_or(standard)
    }

    /// The motion of `instance`, or of its rest, and of the stable one below where that is unstable.
    pub fn done(
        &self,
        subject: Subject,
        (preset, instance): &(Preset, Instance),
    ) -> Result<Vec<Done>, CommandError> {
        let done = |(index, Finding { motion, figures, small }): (usize, Finding)| {
            // The second one of an unstable rest.
            let (settled, description) = match index {
                0 => ("", preset.description),
                _ => (", settled", "where it falls from the unstable rest"),
            };
            Done { label: format!("{}{settled}", preset.label), description, motion, figures, small }
        };
        let fail =
            |reason: String| CommandError::Failed(format!("{}, {}: {reason}", subject.name(), preset.label));
        self.require_use(subject)?;
        let (times, bar) = (self.times(subject, instance)?, progress(preset.label));
        self.require_end(subject, &times)?;
        bar.set_length(times.len() as u64);
        let mut watch = Watch::new(preset.label, times.len(), bar.is_hidden());
        let mut heard = |count: usize| {
            bar.set_position(count as u64);
            watch.heard(count, &mut std::io::stderr());
        };
        let found = match self.analysis_of(subject) {
            Analysis::Kinematic => driven::kinematic(fixed(subject, instance)?, &times, &mut heard),
            Analysis::Inverse => {
                let dynamics = dynamics(subject, instance)?;
                driven::inverse(fixed(subject, instance)?, dynamics, &times, &mut heard)
            }
            Analysis::Static => {
                let found = rest::rests(dynamics(subject, instance)?, &self.guesses(subject, instance)?);
                bar.finish_and_clear();
                return Ok(found.map_err(fail)?.into_iter().enumerate().map(done).collect());
            }
            Analysis::Linear => {
                let dynamics = dynamics(subject, instance)?;
                match self.at {
                    None => linear::linear(dynamics, rest::rest(dynamics, &self.guesses(subject, instance)?)),
                    Some(_) => linear::linear(
                        dynamics,
                        direct::direct(dynamics, &self.approach(), &times, &mut heard),
                    ),
                }
            }
            Analysis::Dynamic => {
                direct::direct(dynamics(subject, instance)?, &self.approach(), &times, &mut heard)
            }
        };
        bar.finish_and_clear();
        found.map(|found| vec![done((0, found))]).map_err(fail)
    }

    /// Whether it looks for a position of rest.
    pub fn is_of_rest(&self, subject: Subject) -> bool {
        match self.analysis_of(subject) {
            Analysis::Static => true,
            Analysis::Linear => self.at.is_none(),
            Analysis::Kinematic | Analysis::Dynamic | Analysis::Inverse => false,
        }
    }

    /// Whether a motion from forces is followed.
    fn is_moved(&self, subject: Subject) -> bool {
        match self.analysis_of(subject) {
            Analysis::Dynamic => true,
            Analysis::Linear => self.at.is_some(),
            Analysis::Kinematic | Analysis::Static | Analysis::Inverse => false,
        }
    }

    fn approach(&self) -> Approach {
        Approach { stabilization: self.stabilization, steps: self.steps_of_method }
    }

    /// The guesses by index.
    fn guesses(&self, subject: Subject, instance: &Instance) -> Result<Vec<(usize, f64)>, CommandError> {
        let index = |(name, value): &(String, f64)| {
            Ok((coordinate(instance.equations(), subject.name(), name)?, *value))
        };
        self.guesses.iter().map(index).collect()
    }

    fn times(&self, subject: Subject, instance: &Instance) -> Result<Vec<f64>, CommandError> {
        let duration = match (self.at, self.until) {
            (Some(0.0), _) => return Ok(vec![0.0]),
            (Some(at), _) => at,
            (None, Some(until)) => until,
            (None, None) => subject.duration(instance)?,
        };
        // Steps that someone asks for are not cut by instants that nobody did.
        let most = match self.approach().longest() {
            Some(longest) if self.given.step && !self.given.steps => equal(duration, longest),
            _ => u32::MAX,
        };
        Ok(instants(duration, self.steps.min(most as usize)))
    }
}

fn fixed(subject: Subject, instance: &Instance) -> Result<&dyn AnyMechanism, CommandError> {
    let name = subject.name();
    match instance {
        Instance::Fixed(mechanism) => Ok(mechanism.as_ref()),
        Instance::Free(_) => Err(CommandError::Usage(format!(
            "`{name}` is free to move: no drive prescribes its motion; use `--analysis dynamic` or `static`"
        ))),
    }
}

pub fn dynamics(subject: Subject, instance: &Instance) -> Result<&dyn AnyDynamics, CommandError> {
    instance.equations().dynamics().ok_or_else(|| {
        let name = subject.name();
        CommandError::Usage(format!("`{name}` has neither masses nor forces; use `--analysis kinematic`"))
    })
}

/// What an analysis finds.
struct Finding {
    motion: Motion,
    figures: Vec<[String; 2]>,
    /// Small motions about its last instant.
    small: Option<SmallMotions>,
}

/// A finding, or why there is none.
type Found = Result<Finding, String>;

impl Finding {
    fn of(motion: Motion, figures: Vec<[String; 2]>) -> Self {
        Finding { motion, figures, small: None }
    }
}
