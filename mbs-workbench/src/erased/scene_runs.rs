//! Motions of a scene by one method, for comparisons of scenes: less code than [`erase`](super::erase::erase) makes of it.

use std::time::{Duration, Instant};

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, ProjectedStages, Projection, Simulation, Tolerance, inverse_with_states,
};
use mbs_runtime::{
    Dynamic, DynamicState, Entry, Failure, Kinematic, Mechanism, Partitioned, Reveal, Stepper, Visitor,
};

use super::dynamics::start::{Start, start, text_start};
use super::exact::observed;

/// Mover of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mover {
    /// Nothing: its rows leave it free and it has no masses.
    Nothing,
    /// Drives.
    Drives,
    /// Forces.
    Forces,
}

/// A motion to be computed.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// Instants (s) at equal distances.
    pub times: &'a [f64],
    /// Relative and absolute tolerance of a motion from forces.
    pub tolerance: f64,
    /// Changes of the start in the reference metric, by coordinate and rate, of a motion from forces.
    pub shift: fn(usize) -> [f64; 2],
    /// Longest time of computation.
    pub limit: Duration,
}

/// Effort of a motion.
#[derive(Clone, Copy, Debug, Default)]
pub struct Effort {
    /// Steps taken; of a motion from forces those accepted.
    pub steps: u64,
    /// Right-hand sides or iterations.
    pub evaluations: u64,
    /// Time of computation.
    pub elapsed: Duration,
}

/// Gets the values of the outputs at each instant.
pub type See<'a> = &'a mut dyn FnMut(&[f64]);

/// Motions of a scene.
pub trait SceneRuns {
    /// Mover of the scene.
    fn mover(&self) -> Mover;
    /// Names and units of the outputs, then of outputs that depend on multipliers.
    fn outputs(&self) -> Vec<Entry>;
    /// Number of contacts.
    fn contacts(&self) -> usize;
    /// The motion; `see` gets the values of the outputs at each instant. Without it nothing is computed beside the motion.
    ///
    /// # Errors
    /// Reason why there is none.
    fn run(&self, asked: &Asked<'_>, see: Option<See<'_>>) -> Result<Effort, String>;
}

/// Motions of `mechanism` with `values` of parameters and inputs by their names; names that it does not have are left out.
pub fn scene_runs<S: Reveal>(mechanism: S, values: &[(String, f64)]) -> Box<dyn SceneRuns> {
    mechanism.reveal(Of(values))
}

struct Of<'a>(&'a [(String, f64)]);

impl Of<'_> {
    fn set<S: Mechanism<f64, N, M>, const N: usize, const M: usize>(&self, mut mechanism: S) -> S {
        for (index, entry) in S::VARIABLES.iter().enumerate() {
            if let Some((_, value)) = self.0.iter().find(|(name, _)| name == entry.name) {
                mechanism.set(index, *value);
            }
        }
        mechanism
    }
}

impl<S: 'static> Visitor<S> for Of<'_> {
    type Output = Box<dyn SceneRuns>;

    fn described<const N: usize, const M: usize>(self, _: S) -> Self::Output
    where
        S: Mechanism<f64, N, M>,
    {
        Box::new(Still(S::OUTPUTS))
    }
    fn kinematic<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Kinematic<f64, N, M>,
    {
        Box::new(Driven::<S, N, M> { mechanism: self.set(mechanism), loads: &[], forces: |_, _, _| Ok(()) })
    }
    fn driven<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Kinematic<f64, N, M> + Dynamic<f64, N, M> + Partitioned<f64, N, M>,
    {
        Box::new(Driven::<S, N, M>::with_masses(self.set(mechanism)))
    }
    fn free<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Dynamic<f64, N, M> + Partitioned<f64, N, M>,
    {
        Box::new(Moved::<S, N, M>::of(self.set(mechanism)))
    }
    fn large_driven<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Kinematic<f64, N, M> + Dynamic<f64, N, M> + Partitioned<f64, N, M>,
    {
        Box::new(Driven::<S, N, M>::with_masses(self.set(mechanism)))
    }
    fn large_free<const N: usize, const M: usize>(self, mechanism: S) -> Self::Output
    where
        S: Dynamic<f64, N, M> + Partitioned<f64, N, M>,
    {
        Box::new(Moved::<S, N, M>::of(self.set(mechanism)))
    }
}

/// A scene without a motion.
struct Still(&'static [Entry]);

impl SceneRuns for Still {
    fn mover(&self) -> Mover {
        Mover::Nothing
    }
    fn outputs(&self) -> Vec<Entry> {
        self.0.to_vec()
    }
    fn contacts(&self) -> usize {
        0
    }
    fn run(&self, _: &Asked<'_>, _: Option<&mut dyn FnMut(&[f64])>) -> Result<Effort, String> {
        Err("its rows leave coordinates free, and it has no masses".to_string())
    }
}

/// Adds the loads of a position to the outputs.
type AddLoads<S, const N: usize, const M: usize> =
    fn(&S, &Stepper<S, f64, N, M>, &mut Vec<f64>) -> Result<(), Failure>;

/// A scene that drives move.
struct Driven<S: Kinematic<f64, N, M>, const N: usize, const M: usize> {
    mechanism: S,
    loads: &'static [Entry],
    forces: AddLoads<S, N, M>,
}

impl<S: Dynamic<f64, N, M> + Kinematic<f64, N, M>, const N: usize, const M: usize> Driven<S, N, M> {
    fn with_masses(mechanism: S) -> Self {
        Driven {
            mechanism,
            loads: S::LOADS,
            forces: |mechanism, stepper, values| {
                if S::LOADS.is_empty() {
                    return Ok(());
                }
                let states = mechanism.start_states(&mechanism.parameters());
                let found = inverse_with_states(stepper.mechanism(), stepper.t(), stepper.q(), &states)?;
                values.extend_from_slice(found.loads.as_ref());
                Ok(())
            },
        }
    }
}

/// Words of a failure.
fn told(failure: Failure) -> String {
    failure.to_string()
}

/// Refusal of a run that takes too long.
fn too_long(limit: Duration, t: f64) -> String {
    format!("it takes more than {} s to t = {t:.4} s", limit.as_secs())
}

impl<S, const N: usize, const M: usize> SceneRuns for Driven<S, N, M>
where
    S: Kinematic<f64, N, M>,
{
    fn mover(&self) -> Mover {
        Mover::Drives
    }
    fn outputs(&self) -> Vec<Entry> {
        [S::OUTPUTS, self.loads].concat()
    }
    fn contacts(&self) -> usize {
        0
    }
    fn run(&self, asked: &Asked<'_>, mut see: Option<See<'_>>) -> Result<Effort, String> {
        let first = asked.times.first().copied().unwrap_or(0.0);
        let guess = self.mechanism.guess(&self.mechanism.parameters());
        let mut stepper = Stepper::assemble(self.mechanism.clone(), guess, first).map_err(told)?;
        let mut effort = Effort::default();
        let began = Instant::now();
        let mut values = Vec::new();
        for (index, time) in asked.times.iter().enumerate() {
            if index > 0 {
                effort.evaluations += u64::from(stepper.advance_to(*time).map_err(told)?.evaluations);
                effort.steps += 1;
            }
            if asked.limit < began.elapsed() {
                return Err(too_long(asked.limit, *time));
            }
            values.clear();
            values.extend(stepper.outputs().as_ref().iter().map(|output| output.value));
            (self.forces)(&self.mechanism, &stepper, &mut values).map_err(told)?;
            match &mut see {
                Some(see) => see(&values),
                None => drop(core::hint::black_box(&values)),
            }
        }
        effort.elapsed = began.elapsed();
        Ok(effort)
    }
}

/// A scene that forces move.
struct Moved<S, const N: usize, const M: usize> {
    mechanism: S,
    start: fn(&S, f64) -> Start<N>,
}

impl<S: Dynamic<f64, N, M> + Partitioned<f64, N, M>, const N: usize, const M: usize> Moved<S, N, M> {
    fn of(mechanism: S) -> Self {
        // Rows that may follow from one another have no blocks.
        let start = if S::IS_PARTITIONED { start::<S, N, M> } else { text_start::<S, N, M> };
        Moved { mechanism, start }
    }
}

/// The method of `mbs run`, with stages on the constraints.
fn method() -> Explicit<DormandPrince8, Projection> {
    Explicit::new(DormandPrince8, Projection { stages: ProjectedStages::All })
}

type Run<S, const N: usize, const M: usize> = Simulation<S, Explicit<DormandPrince8, Projection>, f64, N, M>;

/// Pieces of a motion, after each of which the time of computation is looked at.
const PIECES: usize = 16;

fn values<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(run: &Run<S, N, M>) -> Vec<f64> {
    let mechanism = run.mechanism();
    let parameters = run.parameters_with_forces();
    let position = mechanism.position(&parameters, run.q(), run.t());
    let moving = DynamicState { qd: run.qd(), qdd: run.qdd(), lambda: run.lambda(), states: run.states() };
    observed(mechanism, (&parameters, &position), &moving).outputs
}

impl<S: Dynamic<f64, N, M>, const N: usize, const M: usize> SceneRuns for Moved<S, N, M> {
    fn mover(&self) -> Mover {
        Mover::Forces
    }
    fn outputs(&self) -> Vec<Entry> {
        [S::OUTPUTS, S::LOADS].concat()
    }
    fn contacts(&self) -> usize {
        S::CONTACTS.len()
    }
    fn run(&self, asked: &Asked<'_>, mut see: Option<See<'_>>) -> Result<Effort, String> {
        let first = asked.times.first().copied().unwrap_or(0.0);
        let (mut q, mut qd) = (self.start)(&self.mechanism, first);
        let scales = self.mechanism.coordinate_scales(&self.mechanism.parameters());
        for (index, scale) in scales.iter().enumerate() {
            let [position, rate] = (asked.shift)(index);
            q[index] += position * scale;
            // A rate changes by a part of itself, and by a part of one scale a second.
            qd[index] += rate * (scale + qd[index].abs());
        }
        let started = Simulation::start_near(self.mechanism.clone(), method(), first, q, qd).map_err(told)?;
        let mut run = started.with_tolerance(Tolerance::new(asked.tolerance)).without_work();
        if let Some(see) = &mut see {
            see(&values(&run));
        }
        let began = Instant::now();
        let steps = asked.times.len().saturating_sub(1);
        let each = steps.div_ceil(PIECES).max(1);
        for piece in asked.times.get(1..).unwrap_or_default().chunks(each) {
            let Some(end) = piece.last() else { continue };
            match &mut see {
                Some(see) => {
                    let count = u32::try_from(piece.len()).unwrap_or(u32::MAX);
                    run.watch(*end, count, |run| see(&values(run))).map_err(told)?;
                }
                None => run.advance_to(*end).map_err(told)?,
            }
            if asked.limit < began.elapsed() {
                return Err(too_long(asked.limit, *end));
            }
        }
        let counts = run.counts();
        Ok(Effort { steps: counts.steps, evaluations: counts.evaluations, elapsed: began.elapsed() })
    }
}
