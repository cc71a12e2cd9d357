//! The runtime's methods on emitted code.

use std::hint::black_box;

use mbs_runtime::dynamics::{
    Counts, DormandPrince5, DormandPrince8, Embedded, Explicit, Formulation, IntegratorState as Moving,
    Metric, Model, Simulation, Tolerance, VelocityTransformation,
};
use mbs_runtime::{Dynamic, Lanes, Partitioned, Scalar};

use super::{Accelerations, Attempt, State};
use crate::measure::Case;

/// Accelerations as an integrator evaluates them: with multipliers, margin and all failures.
pub fn rates<S, const N: usize, const M: usize>() -> impl Fn(&State<N>) -> [f64; N] + 'static
where
    S: Dynamic<f64, N, M> + Partitioned<f64, N, M> + Default + 'static,
{
    let mechanism = S::default();
    let parameters = mechanism.parameters();
    let metric = Metric::of(&mechanism, &parameters);
    let states = mechanism.start_states(&parameters);
    move |state| {
        let model = Model::of_states(&mechanism, &parameters, &metric);
        let y = Moving { q: state.q, qd: state.qd, states, work: 0.0 };
        let solved = VelocityTransformation.solve(&model, 0.0, &y, &[0.0; M], &mut Counts::default());
        solved.expect("the state is regular").rate.qd
    }
}

/// Mechanisms a call of [`lanes`].
const LANES: usize = 8;

type Eight = Lanes<f64, LANES>;

/// Accelerations of eight mechanisms a call.
pub fn lanes<S, const N: usize, const M: usize>(problem: &Accelerations<N>) -> Case
where
    S: Dynamic<Eight, N, M> + Partitioned<Eight, N, M> + Default + 'static,
{
    let mechanism = S::default();
    let parameters = mechanism.parameters();
    let chunks: Vec<([Eight; N], [Eight; N])> = problem
        .states
        .chunks(LANES)
        .map(|chunk| {
            let lanes = |value: &dyn Fn(&State<N>) -> f64| Eight::from_lanes(|lane| value(&chunk[lane]));
            (
                std::array::from_fn(|k| lanes(&|state| state.q[k])),
                std::array::from_fn(|k| lanes(&|state| state.qd[k])),
            )
        })
        .collect();
    let found: Vec<[f64; N]> = chunks
        .iter()
        .flat_map(|state| {
            let qdd = eight(&mechanism, &parameters, state);
            (0..LANES).map(move |lane| qdd.map(|component| component.lane(lane)))
        })
        .collect();
    let (work, error) = (problem.states.len() as u32, problem.error(&found));
    let run = move || {
        for state in black_box(&chunks) {
            black_box(eight(&mechanism, &parameters, state));
        }
    };
    Case { group: problem.group, name: "emitted_lanes", work, error, run: Box::new(run) }
}

#[inline(never)]
fn eight<S, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    (q, qd): &([Eight; N], [Eight; N]),
) -> [Eight; N]
where
    S: Dynamic<Eight, N, M> + Partitioned<Eight, N, M>,
{
    let position = mechanism.position(parameters, q, Lanes([0.0; LANES]));
    let (partition, _) = mechanism.partition(parameters, &position);
    let gamma = mechanism.gamma(parameters, &position, qd);
    let states = mechanism.start_states(parameters);
    let force = mechanism.force(parameters, &position, qd, &states, &[Lanes([0.0; LANES]); M]);
    mechanism.accelerations(parameters, &position, &partition, &force, &gamma).qdd
}

/// A motion that is integrated to `end` (s).
pub struct Run<const N: usize> {
    pub start: State<N>,
    pub end: f64,
}

impl<const N: usize> Run<N> {
    /// Attempts with both pairs and all tolerances; `error` is the error of the states that a simulation shows on its way.
    pub fn attempts<S, const M: usize>(&self, error: impl Fn(&mut dyn Shown<N>) -> f64) -> Vec<Attempt>
    where
        S: Dynamic<f64, N, M> + Partitioned<f64, N, M> + Default + Copy + 'static,
    {
        let mut attempts = Vec::new();
        for exponent in 12..=24 {
            let tolerance = 10.0_f64.powf(-0.5 * f64::from(exponent));
            attempts.push(self.attempt::<S, _, M>("emitted_order_5", DormandPrince5, tolerance, &error));
            attempts.push(self.attempt::<S, _, M>("emitted_order_8", DormandPrince8, tolerance, &error));
        }
        attempts
    }

    fn attempt<S, I, const M: usize>(
        &self,
        name: &'static str,
        integrator: I,
        tolerance: f64,
        error: &impl Fn(&mut dyn Shown<N>) -> f64,
    ) -> Attempt
    where
        S: Dynamic<f64, N, M> + Partitioned<f64, N, M> + Default + Copy + 'static,
        I: Embedded + 'static,
    {
        let (State { q, qd }, end) = (self.start, self.end);
        let start = move || {
            let method = Explicit::new(integrator, VelocityTransformation);
            let simulation = Simulation::start(S::default(), method, 0.0, *black_box(&q), qd);
            simulation
                .expect("a start on the constraints")
                .without_work()
                .with_tolerance(Tolerance::new(tolerance))
        };
        let error = error(&mut start());
        let run = move || {
            let mut simulation = start();
            simulation.advance_to(end).expect("a regular motion");
            black_box(simulation.q());
        };
        Attempt { name, error, run: Box::new(run) }
    }
}

/// A simulation that shows its coordinates on the way.
pub trait Shown<const N: usize> {
    /// Shows `samples` of them at equal distances until `end` (s).
    fn show(&mut self, end: f64, samples: u32, see: &mut dyn FnMut(&[f64; N]));
}

impl<S, I, const N: usize, const M: usize> Shown<N>
    for Simulation<S, Explicit<I, VelocityTransformation>, f64, N, M>
where
    S: Dynamic<f64, N, M> + Partitioned<f64, N, M>,
    I: Embedded,
{
    fn show(&mut self, end: f64, samples: u32, see: &mut dyn FnMut(&[f64; N])) {
        self.sample(end, samples, |instant| see(&instant.y.q)).expect("a regular motion");
    }
}
