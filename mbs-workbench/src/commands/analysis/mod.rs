//! The analyses of the command line: each turns a mechanism into a motion with figures.

mod direct_dynamics;
mod early_end;
mod linearization;
mod loads;
mod method;
mod prescribed_motion;
mod static_equilibrium;
mod used_options;
mod watch;

use crate::erased::dynamics::AnyDynamics;
use crate::erased::dynamics::direct_dynamics::{Approach, Stabilization, Steps, equal};
use crate::erased::dynamics::linearization::SmallMotions;
use crate::erased::erase::Erased;
use crate::erased::facade::{AnyMechanism, Motion};
use crate::motion::instants;
use crate::output::report::Verdict;
use mbs_codegen::picture::Preset;

pub use self::direct_dynamics::{doubtful, largest, undetermined};
pub use self::early_end::EarlyEnd;
pub use self::method::{Damping, IntegratorName, MethodName, above_zero, at_least_zero, tolerance};
pub use self::used_options::UsedOptions;
use self::watch::{Watch, progress};
use super::CommandError;
use super::assignment::Assignment;
use super::chosen::coordinate;
use super::target::Target;

/// Analysis of a mechanism, one for each command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Analysis {
    /// Positions, velocities and accelerations that drives prescribe.
    Kinematics,
    /// The motion that forces cause.
    Simulation,
    /// The position of rest.
    Equilibrium,
    /// Efforts and loads of the motion that drives prescribe.
    Inverse,
    /// Small motions about the position of rest, or about a state: their eigenvalues.
    Modes,
}

impl Analysis {
    /// Name on the page.
    pub fn word(self) -> &'static str {
        match self {
            Analysis::Kinematics => "kinematics",
            Analysis::Simulation => "simulation",
            Analysis::Equilibrium => "equilibrium",
            Analysis::Inverse => "inverse",
            Analysis::Modes => "modes",
        }
    }
}

/// A motion with its figures.
pub struct RunResult {
    /// Index of the instance that it is of.
    pub instance: usize,
    pub label: String,
    pub description: String,
    pub motion: Motion,
    pub figures: Vec<[String; 2]>,
    /// Verdict on a position of rest.
    pub verdict: Option<Verdict>,
    /// End of a motion before its time.
    pub ended: Option<EarlyEnd>,
    /// Small motions about its last instant, where they were asked for.
    pub small: Option<SmallMotions>,
}

/// Options of the command line for an analysis.
pub struct Request {
    pub analysis: Option<Analysis>,
    pub stabilization: Stabilization,
    /// Steps of an explicit method.
    pub steps_of_method: Steps,
    /// Coordinates by name that the search for a position of rest starts from.
    pub guesses: Vec<Assignment>,
    /// Time (s) of the state that small motions are about.
    pub at: Option<f64>,
    pub until: Option<f64>,
    pub steps: usize,
    /// Options of the command line for instants and integration of a motion.
    pub used_options: UsedOptions,
}

impl Request {
    /// The analysis asked for, or the one that moves the mechanism.
    pub fn analysis_of(&self, target: &Target) -> Analysis {
        let standard = if target.is_free() { Analysis::Simulation } else { Analysis::Kinematics };
        self.analysis.unwrap_or(standard)
    }

    /// The motion of `instance`, or its equilibrium and, if that is unstable, also the stable one reached from it.
    pub fn done(
        &self,
        target: &Target,
        (preset, instance): &(Preset, Erased),
    ) -> Result<Vec<RunResult>, CommandError> {
        let done = |(index, found): (usize, AnalysisResult)| {
            let AnalysisResult { motion, mut figures, verdict, ended, small } = found;
            // Lines are those of the text; its rows stand below the message of the failure alone.
            let ended = ended.map(|ended| {
                let quoted = target.quoted(instance.equations(), &ended.line);
                let line = quoted.lines().next().unwrap_or_default().to_string();
                figures
                    .iter_mut()
                    .filter(|[_, value]| *value == ended.line)
                    .for_each(|[_, value]| value.clone_from(&line));
                EarlyEnd { line, message: ended.message }
            });
            // The stable equilibrium reached from an unstable one.
            let (settled, description) = match index {
                0 => ("", preset.description.as_str()),
                _ => (", settled", "where it falls from the unstable rest"),
            };
            let label = format!("{}{settled}", preset.label);
            let description = description.to_string();
            RunResult { instance: 0, label, description, motion, figures, verdict, ended, small }
        };
        let fail =
            |reason: String| target.failed(instance.equations(), &format!("{}: {reason}", preset.label));
        self.require_use(target)?;
        let (times, bar) = (self.times(target, instance)?, progress(&preset.label));
        self.require_end(target, &times)?;
        bar.set_length(times.len() as u64);
        let mut watch = Watch::new(&preset.label, times.len(), bar.is_hidden());
        let mut on_progress = |count: usize| {
            bar.set_position(count as u64);
            watch.on_progress(count, &mut std::io::stderr());
        };
        let found = match self.analysis_of(target) {
            Analysis::Kinematics => {
                prescribed_motion::kinematic(fixed(target, instance)?, &times, &mut on_progress)
            }
            Analysis::Inverse => {
                let dynamics = dynamics(target, instance)?;
                prescribed_motion::inverse(fixed(target, instance)?, dynamics, &times, &mut on_progress)
            }
            Analysis::Equilibrium => {
                let found =
                    static_equilibrium::rests(dynamics(target, instance)?, &self.guesses(target, instance)?);
                bar.finish_and_clear();
                return Ok(found.map_err(fail)?.into_iter().enumerate().map(done).collect());
            }
            Analysis::Modes => {
                let dynamics = dynamics(target, instance)?;
                match self.at {
                    None => linearization::linear(
                        dynamics,
                        static_equilibrium::rest(dynamics, &self.guesses(target, instance)?),
                    ),
                    Some(_) => linearization::linear(
                        dynamics,
                        direct_dynamics::direct(dynamics, &self.approach(), &times, &mut on_progress),
                    ),
                }
            }
            Analysis::Simulation => direct_dynamics::direct(
                dynamics(target, instance)?,
                &self.approach(),
                &times,
                &mut on_progress,
            ),
        };
        bar.finish_and_clear();
        found.map(|found| vec![done((0, found))]).map_err(fail)
    }

    /// `true` if the analysis looks for an equilibrium.
    pub fn is_of_rest(&self, target: &Target) -> bool {
        match self.analysis_of(target) {
            Analysis::Equilibrium => true,
            Analysis::Modes => self.at.is_none(),
            Analysis::Kinematics | Analysis::Simulation | Analysis::Inverse => false,
        }
    }

    /// `true` if the analysis integrates a motion from forces.
    fn is_moved(&self, target: &Target) -> bool {
        match self.analysis_of(target) {
            Analysis::Simulation => true,
            Analysis::Modes => self.at.is_some(),
            Analysis::Kinematics | Analysis::Equilibrium | Analysis::Inverse => false,
        }
    }

    fn approach(&self) -> Approach {
        Approach { stabilization: self.stabilization, steps: self.steps_of_method }
    }

    /// The guesses by index.
    fn guesses(&self, target: &Target, instance: &Erased) -> Result<Vec<(usize, f64)>, CommandError> {
        let equations = instance.equations();
        let index = |guess: &Assignment| {
            let index = coordinate(equations, target.name(), &guess.name)?;
            Ok((index, guess.in_unit(equations.coordinates()[index].unit)?))
        };
        self.guesses.iter().map(index).collect()
    }

    fn times(&self, target: &Target, instance: &Erased) -> Result<Vec<f64>, CommandError> {
        let duration = match (self.at, self.until) {
            (Some(0.0), _) => return Ok(vec![0.0]),
            (Some(at), _) => at,
            (None, Some(until)) => until,
            (None, None) => target.duration(instance.equations())?,
        };
        // Default instants do not cut steps that the command line sets.
        let most = match self.approach().longest() {
            Some(longest) if self.used_options.step && !self.used_options.steps => equal(duration, longest),
            _ => u32::MAX,
        };
        Ok(instants(duration, self.steps.min(most as usize)))
    }
}

fn fixed<'a>(target: &Target, instance: &'a Erased) -> Result<&'a dyn AnyMechanism, CommandError> {
    let name = target.name();
    match instance {
        Erased::Fixed(mechanism) => Ok(mechanism.as_ref()),
        Erased::Free(_) => Err(CommandError::Usage(format!(
            "`{name}` is free to move: no drive prescribes its motion; use `mbs simulate {name}` or `mbs equilibrium {name}`"
        ))),
    }
}

pub fn dynamics<'a>(target: &Target, instance: &'a Erased) -> Result<&'a dyn AnyDynamics, CommandError> {
    instance.equations().dynamics().ok_or_else(|| {
        let name = target.name();
        CommandError::Usage(format!("`{name}` has neither masses nor forces; use `mbs kinematics {name}`"))
    })
}

/// Result of an analysis.
struct AnalysisResult {
    motion: Motion,
    figures: Vec<[String; 2]>,
    /// Verdict on a position of rest.
    verdict: Option<Verdict>,
    /// End of a motion before its time.
    ended: Option<EarlyEnd>,
    /// Small motions about its last instant.
    small: Option<SmallMotions>,
}

/// A result, or the reason why there is none.
type Analysed = Result<AnalysisResult, String>;

impl AnalysisResult {
    fn of(motion: Motion, figures: Vec<[String; 2]>) -> Self {
        AnalysisResult { motion, figures, verdict: None, ended: None, small: None }
    }
}
