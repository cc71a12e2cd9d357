//! The analyses of `mbs run`: each turns a mechanism into a motion with figures.

use std::io::Write;
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use mbs_runtime::Failure;
use mbs_runtime::dynamics::{Baumgarte, Counts, Doubt, Penalty, Tolerance};
use mechanisms::analyses::AnyDynamics;
use mechanisms::analyses::direct::{
    Approach, Implicit, ImplicitMethod, Pair, Rule, Simulated, Stabilization, Steps,
};
use mechanisms::analyses::linear::{Fate, SmallMotions, ZERO};
use mechanisms::analyses::rest::Rest;
use mechanisms::facade::{AnyMechanism, Motion, MotionStop};
use mechanisms::motion::{DependentRow, Forces, LoadCurve};
use mechanisms::registry::{Preset, instants};

use super::chosen::{coordinate, finite};
use super::subject::{Instance, Subject};
use super::{CommandError, table};

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

/// How a motion from forces stays on its constraints.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum MethodName {
    /// Positions and velocities are put back onto the constraints
    Projection,
    /// Violations are damped as oscillators of frequency `--frequency`
    Baumgarte,
    /// Stiff springs and dampers against violations, `--frequency` and `--damping` theirs: to see what a penalty is
    Penalty,
    /// Nothing: the constraints drift
    None,
    /// Independent coordinates through the blocks of the constraints
    Velocity,
    /// Implicit trapezoidal steps of `--step` with penalties and multipliers, for stiff forces
    AugmentedLagrangian,
    /// The same, three thirds of a step extrapolated against a whole one: order 3
    Extrapolated,
    /// Implicit steps of `--step` by generalised-alpha, for stiff forces
    GeneralizedAlpha,
}

impl MethodName {
    /// Whether violations have a frequency and a damping in it.
    pub fn is_damped(self) -> bool {
        matches!(self, MethodName::Baumgarte | MethodName::Penalty)
    }

    /// Whether it has steps of its own.
    pub fn is_implicit(self) -> bool {
        matches!(
            self,
            MethodName::AugmentedLagrangian | MethodName::Extrapolated | MethodName::GeneralizedAlpha
        )
    }
}

/// What integrates a motion from forces, unless the method has steps of its own.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum IntegratorName {
    /// Dormand and Prince 8(5,3), adaptive steps within `--tolerance`
    Order8,
    /// Dormand and Prince 5(4), adaptive steps within `--tolerance`
    Order5,
    /// The classical Runge-Kutta method of order 4, equal steps of at most `--step`
    Rk4,
    /// Semi-implicit Euler, order 1, equal steps of at most `--step`
    Euler,
}

impl IntegratorName {
    /// The method of equal steps, where it is one.
    pub fn rule(self) -> Option<Rule> {
        match self {
            IntegratorName::Rk4 => Some(Rule::RungeKutta4),
            IntegratorName::Euler => Some(Rule::SemiImplicitEuler),
            IntegratorName::Order8 | IntegratorName::Order5 => None,
        }
    }

    /// Adaptive steps within `tolerance`, or equal ones of at most `longest` (s).
    pub fn steps(self, tolerance: f64, longest: f64) -> Steps {
        match self {
            IntegratorName::Order8 => Steps::Adaptive { pair: Pair::Order8, tolerance },
            IntegratorName::Order5 => Steps::Adaptive { pair: Pair::Order5, tolerance },
            IntegratorName::Rk4 => Steps::Equal { rule: Rule::RungeKutta4, longest },
            IntegratorName::Euler => Steps::Equal { rule: Rule::SemiImplicitEuler, longest },
        }
    }
}

/// The constants of Baumgarte's stabilisation and of a penalty.
#[derive(Args, Clone, Copy, Default)]
pub struct Damping {
    /// Frequency omega (rad/s) of violations by Baumgarte or penalty [default: 10]
    #[arg(long, value_name = "OMEGA", value_parser = at_least_zero, allow_negative_numbers = true)]
    frequency: Option<f64>,
    /// Their damping xi, 1 is critical [default: 1]
    #[arg(long, value_name = "XI", value_parser = at_least_zero, allow_negative_numbers = true)]
    damping: Option<f64>,
}

impl Damping {
    /// Whether the command line says anything.
    pub fn is_given(self) -> bool {
        self.frequency.is_some() || self.damping.is_some()
    }

    /// As the command line spells them.
    pub fn command(self) -> String {
        let option = |name: &str, value: Option<f64>| {
            value.map_or_else(String::new, |value| format!(" --{name} {value}"))
        };
        option("frequency", self.frequency) + &option("damping", self.damping)
    }

    /// `longest`: of an implicit method's steps (s).
    pub fn stabilization(self, method: MethodName, longest: f64) -> Stabilization {
        let implicit = |method| Stabilization::Implicit(Implicit { method, longest });
        let standard = Baumgarte::default();
        let (omega, xi) = (self.frequency.unwrap_or(standard.omega), self.damping.unwrap_or(standard.xi));
        match method {
            MethodName::AugmentedLagrangian => implicit(ImplicitMethod::AugmentedLagrangian),
            MethodName::Extrapolated => implicit(ImplicitMethod::Extrapolated),
            MethodName::GeneralizedAlpha => implicit(ImplicitMethod::GeneralizedAlpha),
            MethodName::Projection => Stabilization::Projection,
            MethodName::None => Stabilization::None,
            MethodName::Velocity => Stabilization::Velocity,
            MethodName::Baumgarte => Stabilization::Baumgarte(Baumgarte { xi, omega }),
            MethodName::Penalty => Stabilization::Penalty(Penalty { xi, omega, ..Penalty::default() }),
        }
    }
}

/// A motion with what is worth saying about it.
pub struct Done {
    pub label: &'static str,
    pub description: &'static str,
    pub motion: Motion,
    pub figures: Vec<[String; 2]>,
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

/// Which options the command line has.
#[derive(Clone, Copy, Default)]
pub struct Given {
    /// `--steps`
    pub steps: bool,
    /// `--method`
    pub method: bool,
    /// `--integrator`
    pub integrator: bool,
    /// `--step`
    pub step: bool,
    /// `--tolerance`
    pub tolerance: bool,
    /// `--frequency` or `--damping`
    pub damping: bool,
    /// Whether the method that runs has steps of its own.
    pub implicit: bool,
    /// Whether it damps violations.
    pub damped: bool,
    /// Whether the steps of an explicit integrator adapt themselves.
    pub adaptive: bool,
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

    /// The motion of `instance`, or of its rest.
    pub fn done(
        &self,
        subject: Subject,
        (preset, instance): &(Preset, Instance),
    ) -> Result<Done, CommandError> {
        let done =
            |motion, figures| Done { label: preset.label, description: preset.description, motion, figures };
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
            Analysis::Kinematic => kinematic(fixed(subject, instance)?, &times, &mut heard),
            Analysis::Inverse => {
                let dynamics = dynamics(subject, instance)?;
                inverse(fixed(subject, instance)?, dynamics, &times, &mut heard)
            }
            Analysis::Static => rest(dynamics(subject, instance)?, &self.guesses(subject, instance)?),
            Analysis::Linear => {
                let dynamics = dynamics(subject, instance)?;
                match self.at {
                    None => linear(dynamics, rest(dynamics, &self.guesses(subject, instance)?)),
                    Some(_) => linear(dynamics, direct(dynamics, &self.approach(), &times, &mut heard)),
                }
            }
            Analysis::Dynamic => direct(dynamics(subject, instance)?, &self.approach(), &times, &mut heard),
        };
        bar.finish_and_clear();
        found.map(|(motion, figures)| done(motion, figures)).map_err(fail)
    }

    /// Whether it looks for a position of rest.
    pub fn is_of_rest(&self, subject: Subject) -> bool {
        match self.analysis_of(subject) {
            Analysis::Static => true,
            Analysis::Linear => self.at.is_none(),
            Analysis::Kinematic | Analysis::Dynamic | Analysis::Inverse => false,
        }
    }

    /// Fails where the command line says what the analysis has no use for.
    fn require_use(&self, subject: Subject) -> Result<(), CommandError> {
        let analysis = self.analysis_of(subject);
        let rest = self.is_of_rest(subject);
        let moved = self.is_moved(subject);
        let searched = matches!(analysis, Analysis::Static | Analysis::Linear);
        let of_motion =
            "is how a motion from forces is integrated: use `--analysis dynamic`, or `linear` with `--at`";
        let Given { implicit, damped, adaptive, .. } = self.given;
        let useless = [
            (
                searched && !rest && !self.guesses.is_empty(),
                "`--at`",
                "follows the motion from the text's start; a position of rest alone takes `--guess`",
            ),
            (
                !searched && !self.guesses.is_empty(),
                "`--guess`",
                "is where the search for rest starts: use `--analysis static` or `linear`",
            ),
            (
                analysis != Analysis::Linear && self.at.is_some(),
                "`--at`",
                "is when small motions are looked at: use `--analysis linear`; a motion ends at `--until`",
            ),
            (
                rest && self.until.is_some(),
                "`--until`",
                "is the end of a motion; a position of rest has none",
            ),
            (
                !rest && searched && self.until.is_some(),
                "`--until`",
                "is the end of a motion; small motions are looked at `--at`",
            ),
            (rest && self.given.steps, "`--steps`", "divide a motion; a position of rest has none"),
            (!moved && self.given.method, "`--method`", of_motion),
            (!moved && self.given.integrator, "`--integrator`", of_motion),
            (!moved && self.given.step, "`--step`", of_motion),
            (!moved && self.given.tolerance, "`--tolerance`", of_motion),
            (
                !moved && self.given.damping,
                "`--frequency` and `--damping`",
                "belong to `--method baumgarte` or `penalty` of a motion from forces",
            ),
            (
                !damped && self.given.damping,
                "`--frequency` and `--damping`",
                "belong to `--method baumgarte` or `penalty`",
            ),
            (
                implicit && self.given.integrator,
                "`--integrator`",
                "is for methods without steps of their own; an implicit one takes `--step`",
            ),
            (
                implicit && self.given.tolerance,
                "`--tolerance`",
                "is for adaptive steps; an implicit method takes `--step`",
            ),
            (
                !implicit && adaptive && self.given.step,
                "`--step`",
                "is for implicit methods and for `--integrator rk4` or `euler`; adaptive steps take `--tolerance`",
            ),
            (
                !implicit && !adaptive && self.given.tolerance,
                "`--tolerance`",
                "is for adaptive steps; equal ones take `--step`",
            ),
        ];
        match useless.into_iter().find(|(is, ..)| *is) {
            Some((_, option, reason)) => Err(CommandError::Usage(format!("{option} {reason}"))),
            None => Ok(()),
        }
    }

    /// Fails where the equal steps of a motion from forces are more than anyone waits for.
    fn require_end(&self, subject: Subject, times: &[f64]) -> Result<(), CommandError> {
        /// A minute or two of the smallest mechanisms.
        const MOST_STEPS: f64 = 1e8;
        let (Some(longest), Some(duration)) = (self.approach().longest(), times.last()) else {
            return Ok(());
        };
        let steps = duration / longest;
        if steps <= MOST_STEPS || !self.is_moved(subject) {
            return Ok(());
        }
        let adapt = if self.given.implicit { "" } else { ", or let them adapt: `--integrator order8`" };
        Err(CommandError::Usage(format!(
            "steps of {longest:e} s to t = {duration} s are {steps:.1e}, more than the {MOST_STEPS:.0e} of a run: end earlier, take \
             longer ones by `--step`{adapt}"
        )))
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
        Ok(instants(duration, self.steps))
    }
}

/// Time between two lines of a run that no bar shows: long enough to keep short runs silent.
const SILENCE: Duration = Duration::from_secs(5);

/// Says how far a long run is where nobody sees a bar.
struct Watch {
    label: &'static str,
    instants: usize,
    hidden: bool,
    started: Instant,
    said: Duration,
}

impl Watch {
    fn new(label: &'static str, instants: usize, hidden: bool) -> Self {
        Watch { label, instants, hidden, started: Instant::now(), said: Duration::ZERO }
    }

    fn heard(&mut self, count: usize, out: &mut dyn Write) {
        let elapsed = self.started.elapsed();
        if self.hidden && elapsed >= self.said + SILENCE {
            self.said = elapsed;
            // Where nobody can read it the run goes on.
            let _ = writeln!(
                out,
                "{}: {count} of {} instants after {} s",
                self.label,
                self.instants,
                elapsed.as_secs()
            );
        }
    }
}

fn progress(label: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} steps, {msg}").expect("a valid template");
    ProgressBar::new(0).with_style(style).with_message(label)
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

type Found = Result<(Motion, Vec<[String; 2]>), String>;

fn kinematic(mechanism: &dyn AnyMechanism, times: &[f64], heard: &mut dyn FnMut(usize)) -> Found {
    /// Instants timed: enough for a mean, short for any number of steps.
    const TIMED: usize = 10_000;
    let timed = &times[..times.len().min(TIMED)];
    let found = mechanism.follow(times, heard).and_then(|motion| {
        let step_time = mechanism.time_a_step(timed)?;
        let figures = table::figures(&motion, step_time).to_vec();
        Ok((motion, figures))
    });
    found.map_err(|failure| {
        let stop = mechanism.stop(times).map_or_else(String::new, |stop| described(&stop));
        format!("{failure}{stop}")
    })
}

/// Where the motion ends, as lines below the failure.
fn described(stop: &MotionStop) -> String {
    let MotionStop { reachable, refused, failure } = stop;
    format!(
        "\nthe motion ends between t = {reachable} s and t = {refused} s; at the end of that step\n{failure}"
    )
}

fn inverse(
    mechanism: &dyn AnyMechanism,
    dynamics: &dyn AnyDynamics,
    times: &[f64],
    heard: &mut dyn FnMut(usize),
) -> Found {
    let (mut motion, mut figures) = kinematic(mechanism, times, heard)?;
    dynamics.add_forces(&mut motion).map_err(|failure| failure.to_string())?;
    figures.extend(loads(&motion));
    Ok((motion, figures))
}

/// Part of the largest coordinate of a unit that rounding leaves of another that is 0.
const ROUNDING: f64 = 1e-12;

fn rest(dynamics: &dyn AnyDynamics, guesses: &[(usize, f64)]) -> Found {
    let Rest { motion, indifferent, held } = dynamics.rest(guesses).map_err(restless)?;
    let mut figures = vec![["iterations".to_string(), motion.iterations[0].to_string()]];
    let small = dynamics.small_motions(&motion).map(|small| stability(small.fate()));
    figures
        .push(["this rest is".to_string(), small.unwrap_or_else(|reason| format!("not judged: {reason}"))]);
    if !indifferent.is_empty() {
        let names = indifferent.join(", ");
        figures.push([
            "indifferent coordinates".to_string(),
            format!("{names}: no force answers where they move"),
        ]);
    }
    if held {
        let what = "the time, at 0 s: what depends on it stands still as it is then";
        figures.push(["held".to_string(), what.to_string()]);
    }
    for coordinate in &motion.coordinates {
        let alike = motion.coordinates.iter().filter(|other| other.unit == coordinate.unit);
        let size = alike.map(|other| other.q[0].abs()).fold(0.0, f64::max);
        let settled = if coordinate.q[0].abs() <= ROUNDING * size { 0.0 } else { coordinate.q[0] };
        let value = format!("{}{}", table::short(settled), table::unit(coordinate.unit));
        figures.push([format!("{} at rest", coordinate.name), value]);
    }
    figures.extend(loads(&motion));
    Ok((motion, figures))
}

/// What becomes of small motions about a rest, in a phrase.
fn stability(fate: Fate) -> String {
    match fate {
        Fate::Fixed => "fixed: nothing can move".to_string(),
        Fate::Grow(time) => format!("unstable: small motions grow, the fastest by e in {time:.4} s"),
        Fate::Indifferent(1) => "indifferent: one motion meets no force, no other grows".to_string(),
        Fate::Indifferent(count) => format!("indifferent: {count} motions meet no force, no other grows"),
        Fate::GoOn => "stable: small motions go on and do not grow".to_string(),
        Fate::Decay => "stable: small motions die out".to_string(),
    }
}

/// Why the search for a position of rest failed, and what helps.
fn restless(failure: Failure) -> String {
    match failure {
        Failure::Restless { coordinate, .. } => format!("{failure}: `--guess {}=…`", coordinate.name),
        other => other.to_string(),
    }
}

/// Eigenvalues of small motions about the last instant of what was found.
fn linear(dynamics: &dyn AnyDynamics, found: Found) -> Found {
    let (motion, mut figures) = found?;
    let small = dynamics.small_motions(&motion)?;
    let about = match (small.frozen, motion.time.last()) {
        (true, Some(t)) => {
            format!(
                "the state at t = {t} s, which moves: eigenvalues of one moment (frozen-time), which depend on the \
                 coordinates and do not decide about stability"
            )
        }
        _ if figures.iter().any(|[name, _]| name == "held") => {
            "a position of rest, the time held at 0 s".to_string()
        }
        _ => "a position of rest".to_string(),
    };
    figures.push(["small motions about".to_string(), about]);
    figures.push(["degrees of freedom".to_string(), small.freedom.to_string()]);
    if small.frozen {
        figures.push(["in the coordinates".to_string(), variations(&small)]);
    }
    // Of a pair the one with the positive imaginary part speaks for both.
    let spoken = small.eigenvalues.iter().filter(|[_, imaginary]| *imaginary >= 0.0);
    for (number, value) in spoken.enumerate() {
        figures.push([format!("eigenvalue {}", number + 1), spelt(*value, small.norm)]);
    }
    Ok((motion, figures))
}

/// The coordinates that small motions about a moving state are the variations of, and which of the text's are not among them.
fn variations(small: &SmallMotions) -> String {
    let names = small.coordinates.join(", ");
    match small.passed_over.as_slice() {
        [] => names,
        others => format!("{names}; {} would not determine the others there", others.join(", ")),
    }
}

/// An eigenvalue (1/s) of a system of this norm, with what it means.
fn spelt([real, imaginary]: [f64; 2], norm: f64) -> String {
    let size = real.hypot(imaginary);
    if size <= ZERO * norm {
        return format!("0 ({size:.1e} 1/s): no force answers");
    }
    if imaginary == 0.0 {
        let fate = if real < 0.0 { "decays in" } else { "grows in" };
        return format!("{real:.6} 1/s: {fate} {:.4} s", 1.0 / real.abs());
    }
    let (hertz, damping) = (imaginary / std::f64::consts::TAU, -real / size);
    format!("{real:.6} ± {imaginary:.6}i 1/s: {hertz:.6} Hz, damping ratio {damping:.4}")
}

fn direct(
    dynamics: &dyn AnyDynamics,
    approach: &Approach,
    times: &[f64],
    heard: &mut dyn FnMut(usize),
) -> Found {
    let found = dynamics.simulate(approach, times, heard).map_err(|failure| failure.to_string())?;
    if let Some(failure) = found.failure {
        return Err(failure.to_string());
    }
    let mut figures = balance(&found);
    figures.extend(loads(&found.motion));
    Ok((found.motion, figures))
}

/// Energy, constraints and cost of a motion from forces.
pub fn balance(found: &Simulated) -> Vec<[String; 2]> {
    let Some(forces) = &found.motion.dynamics else { return Vec::new() };
    let pair = |name: &str, value: String| [name.to_string(), value];
    let kinetic = largest(&forces.kinetic);
    let margin = found.motion.margin.iter().copied().fold(f64::INFINITY, f64::min);
    let mut figures = vec![
        pair(
            "largest energy defect",
            format!("{:.1e} J, largest kinetic energy {kinetic:.4} J", largest(&forces.defect)),
        ),
        pair("largest |Φ|", format!("{:.1e} of the reference length", largest(&found.motion.closure))),
        pair("largest |Φ̇|", format!("{:.1e} 1/s of the reference length", largest(&forces.closure_rate))),
        pair("steps", format!("{}, {} rejected", found.counts.steps, found.rejected)),
        pair("evaluations", evaluations(&found.counts)),
        pair("smallest margin to singularity", format!("{margin:.3}")),
        pair("time of computation", milliseconds(found.elapsed)),
    ];
    if found.replaced {
        let reason =
            "projection onto all rows together: of rows that may follow from others no blocks are made";
        figures.push(pair("method", reason.to_string()));
    }
    if found.counts.rechosen > 0 {
        let (rechosen, all) = (found.counts.rechosen, found.counts.evaluations);
        let reason = "the independent coordinates hardly determine the others there";
        figures.push(pair(
            "independent motions chosen anew",
            format!("{rechosen} of {all} evaluations: {reason}"),
        ));
    }
    if found.counts.handed_over > 0 {
        let (handed, all) = (found.counts.handed_over, found.counts.evaluations);
        let reason = "the rows lose rank there";
        figures.push(pair("handed over to projection", format!("{handed} of {all} evaluations: {reason}")));
    }
    if found.counts.rank_revealing > 0 {
        figures.push(pair("rank-revealing factorizations", found.counts.rank_revealing.to_string()));
    }
    if let Some(t) = found.undetermined {
        figures.push(pair("not determined", undetermined(t)));
    }
    if let Some(doubt) = found.doubt {
        figures.push(pair("doubtful", doubtful(doubt).to_string()));
    }
    figures
}

/// What the steps cost, and what the instants between them.
fn evaluations(counts: &Counts) -> String {
    match counts.shown {
        0 => counts.evaluations.to_string(),
        shown => format!("{} of the steps, {shown} of the instants between them", counts.evaluations),
    }
}

/// Largest magnitude.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()))
}

/// What a method that does not lead through singular positions leaves open from `t` (s) on.
pub fn undetermined(t: f64) -> String {
    format!(
        "the motion behind t = {t} s: it passes a singular position there, where this method may leave on another branch; use \
         `--method projection`"
    )
}

/// What is doubtful about a stabilisation, in one phrase.
pub fn doubtful(doubt: Doubt) -> &'static str {
    match doubt {
        Doubt::StiffStabilization => "frequency times step above 0.3: the stabilisation costs accuracy",
        Doubt::IdleStabilization => "frequency times duration below 5: violations have no time to decay",
        Doubt::RisingRank => {
            "rows that follow from others on the constraints do not beside them, where stages are: accelerations there are wrong \
             by their own size; use `--method projection`"
        }
    }
}

fn milliseconds(elapsed: Duration) -> String {
    format!("{:.1} ms", elapsed.as_secs_f64() * 1e3)
}

/// Ranges of the text's loads, or of the multipliers where it has none.
fn loads(motion: &Motion) -> Vec<[String; 2]> {
    let Some(forces) = &motion.dynamics else { return Vec::new() };
    let (prefix, curves) =
        if forces.loads.is_empty() { ("lambda ", &forces.multipliers) } else { ("", &forces.loads) };
    let range = |values: &[f64]| {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if values.len() == 1 { format!("{least:.6}") } else { format!("{least:.4} to {most:.4}") }
    };
    let line = |curve: &LoadCurve| {
        let shared = match curve.shared {
            0 => String::new(),
            all if all == curve.value.len() => ", not unique: the shortest of many".to_string(),
            some => format!(", not unique at {some} of {} instants", curve.value.len()),
        };
        [format!("{prefix}{}", curve.name), format!("{} {}{shared}", range(&curve.value), curve.unit)]
    };
    let mut lines: Vec<[String; 2]> = curves.iter().map(line).collect();
    lines.extend(surplus(forces));
    lines
}

/// The rows that follow from others, each once, and how many multipliers share the forces for that.
fn surplus(forces: &Forces) -> Option<[String; 2]> {
    let instants = forces.dependent.len();
    let row = |row: &DependentRow| {
        let when = if row.instants == instants {
            String::new()
        } else {
            format!(" at {} of {instants} instants", row.instants)
        };
        format!("`{}` (line {}){when}", row.name, row.line)
    };
    let rows: Vec<String> = forces.dependent_rows.iter().map(row).collect();
    let shared = forces.multipliers.iter().filter(|curve| curve.shared > 0).count();
    let all = forces.multipliers.len();
    let rest = format!("the multipliers of {shared} of {all} rows are not unique, but the shortest of many");
    (!rows.is_empty())
        .then(|| ["rows that follow from others".to_string(), format!("{}; {rest}", rows.join(", "))])
}

/// A number of at least zero.
pub fn at_least_zero(text: &str) -> Result<f64, String> {
    match finite(text)? {
        number if number >= 0.0 => Ok(number),
        _ => Err("a number of at least 0 is needed".to_string()),
    }
}

/// A number above zero.
pub fn above_zero(text: &str) -> Result<f64, String> {
    match finite(text)? {
        number if number > 0.0 => Ok(number),
        _ => Err("a number above 0 is needed".to_string()),
    }
}

/// A tolerance that numbers can keep to.
pub fn tolerance(text: &str) -> Result<f64, String> {
    let least = Tolerance::<f64>::least() / 2.0;
    match above_zero(text)? {
        number if number >= least => Ok(number),
        _ => {
            Err(format!("at least {least:.1e} is possible: rounding alone is more than a smaller one allows"))
        }
    }
}
