//! Record of a motion from forces, instant by instant.

use std::time::Instant;

use mbs_runtime::dynamics::{Counts, Method, Simulation};
use mbs_runtime::{Dynamic, DynamicState, Failure, FailureKind};

use super::direct_dynamics::Simulated;
use super::{determined, power_balance};
use crate::erased::facade::Motion;
use crate::motion::{self, Forces};

/// Record of a run, instant by instant.
pub(super) struct Record<'a> {
    motion: Motion,
    forces: Forces,
    /// Evaluations up to the last instant.
    before: Counts,
    pub(super) failure: Option<Failure>,
    started: Instant,
    /// Instants after the start.
    done: usize,
    progress: &'a mut dyn FnMut(usize),
}

impl<'a> Record<'a> {
    /// With the start of `run`.
    pub(super) fn new<S, X, const N: usize, const M: usize>(
        run: &Simulation<S, X, f64, N, M>,
        progress: &'a mut dyn FnMut(usize),
    ) -> Self
    where
        S: Dynamic<f64, N, M>,
        X: Method<S, f64, N, M>,
    {
        let mut record = Record {
            motion: Motion::of(S::COORDINATES, S::OUTPUTS, run.outputs().as_ref()),
            forces: Forces::of(S::LOADS, S::ROWS),
            before: run.counts(),
            failure: None,
            started: Instant::now(),
            done: 0,
            progress,
        };
        record.push(run);
        record
    }

    /// The next instant; nothing after a failure.
    pub(super) fn see<S, X, const N: usize, const M: usize>(&mut self, run: &Simulation<S, X, f64, N, M>)
    where
        S: Dynamic<f64, N, M>,
        X: Method<S, f64, N, M>,
    {
        self.done += 1;
        (self.progress)(self.done);
        if self.failure.is_none() {
            self.push(run);
        }
    }

    fn push<S, X, const N: usize, const M: usize>(&mut self, run: &Simulation<S, X, f64, N, M>)
    where
        S: Dynamic<f64, N, M>,
        X: Method<S, f64, N, M>,
    {
        self.failure = push(&mut self.motion, &mut self.forces, run, self.before).err();
        self.before = run.counts();
    }

    /// The result; `run` is in its last state.
    pub(super) fn end<S, X, const N: usize, const M: usize>(
        mut self,
        run: &Simulation<S, X, f64, N, M>,
        times: &[f64],
    ) -> Simulated
    where
        S: Dynamic<f64, N, M>,
        X: Method<S, f64, N, M>,
    {
        (self.progress)(times.len());
        let counts = run.counts();
        let span = run.t() - times.first().copied().unwrap_or(0.0);
        // The margin of a lost run is arbitrary: only the failure is reported.
        let lost = matches!(
            self.failure,
            Some(
                Failure { kind: FailureKind::Unbounded { .. }, .. }
                    | Failure { kind: FailureKind::EnergyGain { .. }, .. }
                    | Failure { kind: FailureKind::NonFinite { .. }, .. }
            )
        );
        self.forces.add_works(&self.motion.time);
        self.motion.dynamics = Some(self.forces);
        Simulated {
            motion: self.motion,
            counts,
            rejected: 0,
            replaced: false,
            moved_start: None,
            doubt: run.doubt(span / counts.steps.max(1) as f64),
            undetermined: run.passage().filter(|_| !lost).map(|passage| passage.t),
            failure: self.failure,
            elapsed: self.started.elapsed(),
        }
    }
}

fn push<S, X, const N: usize, const M: usize>(
    motion: &mut Motion,
    forces: &mut Forces,
    run: &Simulation<S, X, f64, N, M>,
    before: Counts,
) -> Result<(), Failure>
where
    S: Dynamic<f64, N, M>,
    X: Method<S, f64, N, M>,
{
    let balance = run.balance();
    motion.push(&motion::Instant {
        t: run.t(),
        q: [run.q(), run.qd(), run.qdd()],
        outputs: run.outputs().as_ref(),
        closure: balance.phi,
        iterations: u32::try_from(run.counts().evaluations - before.evaluations).unwrap_or(u32::MAX),
        margin: run.margin(),
    });
    forces.push(balance.energy, run.loads().as_ref(), run.lambda());
    forces.states = run.states().as_ref().to_vec();
    forces.work.push(balance.work);
    forces.defect.push(balance.defect);
    forces.closure_rate.push(balance.phi_d);
    let (mechanism, parameters) = (run.mechanism(), run.parameters_with_forces());
    let position = mechanism.position(&parameters, run.q(), run.t());
    let moving = DynamicState { qd: run.qd(), qdd: run.qdd(), lambda: run.lambda(), states: run.states() };
    power_balance::push(forces, mechanism, (&parameters, &position), &moving);
    determined::push(forces, mechanism, (&parameters, &position), run.t(), &moving)
}
