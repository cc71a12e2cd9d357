//! Direct dynamics: the motion that forces cause, by a chosen formulation.

use core::marker::PhantomData;
use std::time::Duration;

use mbs_runtime::dynamics::{
    AugmentedLagrangian, Baumgarte, Counts, Embedded, Explicit, Extrapolated, Formulation, GeneralizedAlpha,
    Method, MethodWarning, MoreauJean, MovedStart, Penalty, ProjectedStages, Projection, Radau5, Simulation,
    Tolerance, Unstabilized, VelocityTransformation,
};
use mbs_runtime::{Dynamic, Failure, FailureKind, Partitioned};

use super::integrators::Integrators;
use super::record::Record;
use super::start::{Start, moved_start, start, text_start};
use super::work_by_source::{Counted, Quadrature, add_works};
use super::{AnyDynamics, power_balance};
use crate::erased::facade::{Motion, State};
use crate::erased::feeds::Feeds;

/// Stabilisation of the constraints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stabilization {
    /// Not at all: Φ̈ = 0 alone.
    None,
    /// Baumgarte's oscillators.
    Baumgarte(Baumgarte),
    /// Violations are held down by stiff springs and dampers.
    Penalty(Penalty),
    /// Positions and velocities are projected. With adaptive steps this is done at every stage, with fixed ones at the end of a
    /// step and at stages if the rows need it. Fixed steps cannot be made smaller if a stage goes too far.
    Projection,
    /// Independent coordinates through the blocks of the rows, projected after each step.
    Velocity,
    /// By an implicit method, which is on them at each step's end; it has steps of its own.
    Implicit(Implicit),
    /// Projected after each step of Radau IIA, adaptive within the tolerance or as long as they are given.
    Radau,
}

/// Implicit steps, equal ones from instant to instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Implicit {
    /// Method.
    pub method: ImplicitMethod,
    /// Longest step (s).
    pub longest: f64,
}

/// Methods with steps and a formulation of their own, for stiff mechanisms and for many contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImplicitMethod {
    /// Trapezoidal rule with penalties, multipliers and projections; redundant rows need no care.
    AugmentedLagrangian,
    /// Three thirds of a step by the same rule against a whole one, extrapolated.
    Extrapolated,
    /// Generalised-α on the equations of index 3, ρ∞ = 0.8.
    GeneralizedAlpha,
    /// Time-stepping of Moreau and Jean over impacts; explicit in the forces.
    MoreauJean,
}

/// Step size selection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Steps {
    /// As long as this tolerance allows and not beyond the next instant.
    Adaptive {
        /// Pair of methods.
        pair: Pair,
        /// Relative and absolute, in the reference metric.
        tolerance: f64,
    },
    /// One step from instant to instant.
    Fixed(Rule),
    /// Equal steps from instant to instant.
    Equal {
        /// Method of the steps.
        rule: Rule,
        /// The longest (s).
        longest: f64,
    },
}

/// Pairs of explicit methods whose difference is the error of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pair {
    /// Dormand and Prince, 8(5,3).
    Order8,
    /// Dormand and Prince, 5(4).
    Order5,
}

/// Explicit methods with steps of a given size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// The classical method of order 4.
    RungeKutta4,
    /// Velocities first, then positions by them.
    SemiImplicitEuler,
}

/// Formulation and steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Stabilisation of the constraints.
    pub stabilization: Stabilization,
    /// Step size selection.
    pub steps: Steps,
}

/// The state at `t` (s, not negative) to which forces move a mechanism from the text's start.
///
/// # Errors
/// The mechanism cannot start, or the motion ends before `t`.
pub fn moved_to(dynamics: &dyn AnyDynamics, t: f64) -> Result<State, Failure> {
    /// Far below the digits of a printed number.
    const TOLERANCE: f64 = 1e-10;
    let steps = Steps::Adaptive { pair: Pair::Order8, tolerance: TOLERANCE };
    let approach = Approach { stabilization: Stabilization::Projection, steps };
    let times = if t > 0.0 { vec![0.0, t] } else { vec![0.0] };
    let Simulated { motion, failure, .. } = dynamics.simulate(&approach, &times, &mut |_| ())?;
    match failure {
        Some(failure) => Err(failure),
        None => Ok(motion.last(t)),
    }
}

/// A motion from forces, with its cost.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// Up to the instant before the failure, if there is one.
    pub motion: Motion,
    /// Steps and evaluations.
    pub counts: Counts,
    /// Steps tried again with a smaller size.
    pub rejected: u32,
    /// `true` if all rows together took the place of independent coordinates, which the mechanism does not have.
    pub replaced: bool,
    /// The number of the text's start that changed most to meet the rows.
    pub moved_start: Option<MovedStart<f64>>,
    /// Warning about the stabilisation.
    pub doubt: Option<MethodWarning>,
    /// Time (s) after which the motion is not determined, because the method does not pass a singular position; none for a run
    /// that is lost.
    pub undetermined: Option<f64>,
    /// Failure that ended the motion early.
    pub failure: Option<Failure>,
    /// Time of computation, outputs included.
    pub elapsed: Duration,
}

/// Functions that need the partition into dependent and independent coordinates, for a mechanism of type `S` that is moved by
/// integrators of `I`.
pub struct PartitionedFunctions<S: 'static, I, const N: usize, const M: usize> {
    /// Makes the inputs follow their courses from a time (s) on; of a mechanism without inputs nothing.
    pub feed: fn(&mut S, &Feeds, f64),
    /// The start at a time (s).
    pub start: fn(&S, f64) -> Start<N>,
    /// Formulation in independent coordinates; that in all rows together where there are none.
    pub velocity: fn() -> AnyFormulation<'static, S, N, M>,
    /// `true` if there are independent coordinates.
    pub is_partitioned: bool,
    /// The independent coordinates: as the text names them, or chosen.
    pub independent: &'static [u16],
    integrators: PhantomData<I>,
}

impl<S: 'static, I, const N: usize, const M: usize> Clone for PartitionedFunctions<S, I, N, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S: 'static, I, const N: usize, const M: usize> Copy for PartitionedFunctions<S, I, N, M> {}

impl<S, I, const N: usize, const M: usize> PartitionedFunctions<S, I, N, M>
where
    S: Dynamic<f64, N, M> + Partitioned<f64, N, M> + 'static,
{
    /// Functions of `S`. If rows follow from one another there are no blocks of them. The motion then begins at the text's start
    /// and is projected onto all rows together.
    pub fn of() -> Self {
        PartitionedFunctions {
            feed: |_, _, _| (),
            start: if S::IS_PARTITIONED { start::<S, N, M> } else { text_start::<S, N, M> },
            velocity: if S::IS_PARTITIONED { || &VelocityTransformation } else { || &STAGES },
            is_partitioned: S::IS_PARTITIONED,
            independent: <S as Partitioned<f64, N, M>>::INDEPENDENT,
            integrators: PhantomData,
        }
    }
}

/// Any formulation: the integrator of a mechanism is compiled once for all of them.
pub(super) type AnyFormulation<'a, S, const N: usize, const M: usize> = &'a dyn Formulation<S, f64, N, M>;

/// Ends of steps on the constraints, stages where the rows need it: for other analyses, as [`AnyFormulation`].
pub(super) const ENDS: Projection = Projection { stages: ProjectedStages::WhereNeeded };

/// Ends of steps and all stages on the constraints.
const STAGES: Projection = Projection { stages: ProjectedStages::All };

/// Any method with steps of a given size, as [`AnyFormulation`].
type AnyMethod<'a, S, const N: usize, const M: usize> = &'a dyn Method<S, f64, N, M>;

/// Follows `mechanism` from the text's start through `times` (s).
pub(crate) fn simulate<S: Dynamic<f64, N, M> + 'static, I: Integrators, const N: usize, const M: usize>(
    mechanism: &S,
    partitioned: &PartitionedFunctions<S, I, N, M>,
    approach: &Approach,
    times: &[f64],
    progress: &mut dyn FnMut(usize),
) -> Result<Simulated, Failure> {
    let steps = approach.steps;
    let start = (partitioned.start)(mechanism, times.first().copied().unwrap_or(0.0));
    let mut by = |formulation: AnyFormulation<'_, S, N, M>, integrators: Chosen<I>| {
        integrate::<S, I, N, M>(mechanism, formulation, integrators, &start, steps, times, progress)
    };
    let explicit = chosen::<I>(steps);
    let found = match approach.stabilization {
        Stabilization::None => by(&Unstabilized, explicit),
        Stabilization::Baumgarte(baumgarte) => by(&baumgarte, explicit),
        Stabilization::Penalty(penalty) => by(&penalty, explicit),
        Stabilization::Projection => {
            let stages = match steps {
                Steps::Adaptive { .. } => ProjectedStages::All,
                Steps::Fixed(_) | Steps::Equal { .. } => ProjectedStages::WhereNeeded,
            };
            by(&Projection { stages }, explicit)
        }
        Stabilization::Velocity => {
            let found = by((partitioned.velocity)(), explicit);
            found.map(|found| Simulated { replaced: !partitioned.is_partitioned, ..found })
        }
        Stabilization::Radau => match I::RADAU {
            Some(radau) => by(&ENDS, radau),
            None => {
                let name = "number of coordinates and rows for `radau`";
                Err(FailureKind::InvalidMethodParameter {
                    name,
                    value: (N + M) as f64,
                    most: Radau5::MOST_UNKNOWNS as f64,
                }
                .without_time())
            }
        },
        Stabilization::Implicit(Implicit { method, longest }) => match method {
            ImplicitMethod::AugmentedLagrangian => {
                let by = (&AugmentedLagrangian as AnyMethod<'_, S, N, M>, Quadrature::Trapezoidal);
                implicit(mechanism, by, &start, longest, times, progress)
            }
            ImplicitMethod::Extrapolated => {
                let by = (&Extrapolated as AnyMethod<'_, S, N, M>, Quadrature::Extrapolated);
                implicit(mechanism, by, &start, longest, times, progress)
            }
            ImplicitMethod::GeneralizedAlpha => {
                let by = GeneralizedAlpha::default();
                let by = (&by as AnyMethod<'_, S, N, M>, Quadrature::Trapezoidal);
                implicit(mechanism, by, &start, longest, times, progress)
            }
            ImplicitMethod::MoreauJean => {
                let by = (&MoreauJean as AnyMethod<'_, S, N, M>, Quadrature::Trapezoidal);
                implicit(mechanism, by, &start, longest, times, progress)
            }
        },
    };
    let mut found = found?;
    found.moved_start = moved_start(mechanism, &found.motion);
    found.motion.dynamics.iter_mut().for_each(power_balance::name_rows::<S, N, M>);
    if !matches!(approach.stabilization, Stabilization::None | Stabilization::Baumgarte(_)) {
        found.undetermined = None;
    }
    Ok(found)
}

fn implicit<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    by: (AnyMethod<'_, S, N, M>, Quadrature),
    start: &Start<N>,
    longest: f64,
    times: &[f64],
    progress: &mut dyn FnMut(usize),
) -> Result<Simulated, Failure> {
    let count = |span| equal(span, longest);
    let mut found = stepped(mechanism, by.0, start, times, progress, &count)?;
    add_works(&mut found, &power_balance::may_act(mechanism, &start.0), &|supplies| {
        stepped(mechanism, &Counted { by, supplies }, start, times, &mut |_| (), &count)
    });
    Ok(found)
}

impl Approach {
    /// The longest of its equal steps (s), where it has such.
    pub fn longest(&self) -> Option<f64> {
        match (self.stabilization, self.steps) {
            (Stabilization::Implicit(Implicit { longest, .. }), _) | (_, Steps::Equal { longest, .. }) => {
                Some(longest)
            }
            (_, Steps::Adaptive { .. } | Steps::Fixed(_)) => None,
        }
    }
}

/// Number of equal steps through `span` (s), none longer than `longest` (s).
pub fn equal(span: f64, longest: f64) -> u32 {
    /// Rounding excess over a whole number of steps, as a part of a step.
    const ROUNDING: f64 = 1e-9;
    ((span / longest - ROUNDING).ceil().max(1.0)) as u32
}

/// Integrators of adaptive and of fixed steps.
type Chosen<I> = (<I as Integrators>::Adaptive, <I as Integrators>::Fixed);

/// The explicit ones of `steps`; of the kind that they are not any.
fn chosen<I: Integrators>(steps: Steps) -> Chosen<I> {
    let (pair, rule) = match steps {
        Steps::Adaptive { pair, .. } => (pair, Rule::RungeKutta4),
        Steps::Fixed(rule) | Steps::Equal { rule, .. } => (Pair::Order8, rule),
    };
    (I::pair(pair), I::rule(rule))
}

/// By steps of `integrators`, and the work of each supply.
fn integrate<S: Dynamic<f64, N, M>, I: Integrators, const N: usize, const M: usize>(
    mechanism: &S,
    formulation: AnyFormulation<'_, S, N, M>,
    (adaptive_steps, fixed_steps): Chosen<I>,
    start: &Start<N>,
    steps: Steps,
    times: &[f64],
    progress: &mut dyn FnMut(usize),
) -> Result<Simulated, Failure> {
    let run = |formulation: AnyFormulation<'_, S, N, M>, progress: &mut dyn FnMut(usize)| {
        let fixed = Explicit::new(fixed_steps, formulation);
        match steps {
            Steps::Adaptive { tolerance, .. } => {
                let method = Explicit::new(adaptive_steps, formulation);
                adaptive(mechanism, method, start, tolerance, times, progress)
            }
            Steps::Equal { longest, .. } => {
                stepped(mechanism, &fixed, start, times, progress, &|span| equal(span, longest))
            }
            Steps::Fixed(_) => stepped(mechanism, &fixed, start, times, progress, &|_| 1),
        }
    };
    let mut found = run(formulation, progress)?;
    add_works(&mut found, &power_balance::may_act(mechanism, &start.0), &|supplies| {
        run(&Counted { by: formulation, supplies }, &mut |_| ())
    });
    Ok(found)
}

/// A motion in adaptive steps.
pub(super) type AdaptiveRun<'a, S, I, const N: usize, const M: usize> =
    Simulation<S, Explicit<I, AnyFormulation<'a, S, N, M>>, f64, N, M>;

/// Moves `run` to `until` (s) and shows it at `samples` equal distances on the way. All adaptive runs of an integrator go through
/// here, so that its search for events is compiled once a mechanism.
fn watched<'a, S, I, const N: usize, const M: usize>(
    run: &mut AdaptiveRun<'a, S, I, N, M>,
    until: f64,
    samples: u32,
    see: &mut dyn FnMut(&AdaptiveRun<'a, S, I, N, M>),
) -> Result<(), Failure>
where
    S: Dynamic<f64, N, M>,
    I: Embedded,
{
    run.watch(until, samples, see)
}

/// Moves `run` to `until` (s).
///
/// # Errors
/// Those of the run.
pub(super) fn advance_to<S, I, const N: usize, const M: usize>(
    run: &mut AdaptiveRun<'_, S, I, N, M>,
    until: f64,
) -> Result<(), Failure>
where
    S: Dynamic<f64, N, M>,
    I: Embedded,
{
    watched(run, until, 0, &mut |_| ())
}

fn adaptive<S, I, const N: usize, const M: usize>(
    mechanism: &S,
    method: Explicit<I, AnyFormulation<'_, S, N, M>>,
    (q, qd): &Start<N>,
    tolerance: f64,
    times: &[f64],
    progress: &mut dyn FnMut(usize),
) -> Result<Simulated, Failure>
where
    S: Dynamic<f64, N, M>,
    I: Embedded,
{
    let first = times.first().copied().unwrap_or(0.0);
    let start = Simulation::start_near(mechanism.clone(), method, first, *q, *qd)?;
    let mut run = start.with_tolerance(Tolerance::new(tolerance));
    let mut record = Record::new(&run, progress);
    if let [_, .., end] = times {
        // Steps are as long as the tolerance allows; instants between their ends are interpolated.
        let count = u32::try_from(times.len() - 1).unwrap_or(u32::MAX);
        let moved = watched(&mut run, *end, count, &mut |run| record.see(run));
        record.failure = record.failure.or(moved.err());
    }
    Ok(Simulated { rejected: run.adaptive().rejected, ..record.end(&run, times) })
}

/// By steps of which `count` lead through a span (s).
fn stepped<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    method: AnyMethod<'_, S, N, M>,
    (q, qd): &Start<N>,
    times: &[f64],
    progress: &mut dyn FnMut(usize),
    count: &dyn Fn(f64) -> u32,
) -> Result<Simulated, Failure> {
    let first = times.first().copied().unwrap_or(0.0);
    let start = Simulation::start_near(mechanism.clone(), method, first, *q, *qd)?;
    Ok(follow(start, times, progress, |run, t| run.step_to(t, count(t - run.t()))))
}

/// Calls `advance` from instant to instant and records the state there.
fn follow<S, X, const N: usize, const M: usize>(
    mut run: Simulation<S, X, f64, N, M>,
    times: &[f64],
    progress: &mut dyn FnMut(usize),
    mut advance: impl FnMut(&mut Simulation<S, X, f64, N, M>, f64) -> Result<(), Failure>,
) -> Simulated
where
    S: Dynamic<f64, N, M>,
    X: Method<S, f64, N, M>,
{
    let mut record = Record::new(&run, progress);
    for time in times.iter().skip(1) {
        if record.failure.is_some() {
            break;
        }
        match advance(&mut run, *time) {
            Ok(()) => record.see(&run),
            Err(failure) => record.failure = Some(failure),
        }
    }
    record.end(&run, times)
}
