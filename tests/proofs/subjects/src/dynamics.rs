//! A mechanism with masses through all its entry points of dynamics.

use core::hint::black_box;

use mbs_runtime::dynamics::{
    AugmentedLagrangian, Baumgarte, Direction, DormandPrince5, DormandPrince8, Embedded, Explicit,
    Extrapolated, Formulation, GeneralizedAlpha, Method, MoreauJean, Penalty, Projection, Radau5,
    RungeKutta4, SemiImplicitEuler, Simulation, Simulations, Unstabilized, VelocityTransformation,
};
use mbs_runtime::{Dynamic, DynamicState, Failure, Partitioned, Real, Scalar};

use crate::Start;
use crate::entry_points::{emitted, masses, simulations as entry};

/// The emitted functions of masses and forces, of any scalar type, lanes included.
pub fn exercise_masses<S, T: Scalar, const N: usize, const M: usize>(mechanism: S, start: &Start<T, N>)
where
    S: Dynamic<T, N, M> + Partitioned<T, N, M>,
{
    let Start { mut q, qd, qdd, t } = *black_box(start);
    let parameters = emitted::parameters(&mechanism);
    black_box(masses::solve_dependent(&mechanism, &parameters, &mut q, t));
    let position = emitted::position(&mechanism, &parameters, &q, t);
    let (states, rates) = black_box(masses::starts(&mechanism, &parameters));
    let lambda = black_box([T::constant(1.0); M]);
    let motion = DynamicState { qd: &qd, qdd: &qdd, lambda: &lambda, states: &states };
    black_box(masses::mass(&mechanism, &parameters, &position));
    black_box(masses::mass_times(&mechanism, &parameters, &position, &rates));
    black_box(masses::mass_times_q(&mechanism, &parameters, &position, &rates));
    let force = black_box(masses::force(&mechanism, &parameters, &position, &motion));
    black_box(masses::force_q(&mechanism, &parameters, &position, &motion));
    black_box(masses::force_qd(&mechanism, &parameters, &position, &motion));
    black_box(masses::reactions(&mechanism, &parameters, &position, &lambda));
    black_box(masses::third_derivative(&mechanism, &parameters, &position, &qd, &lambda));
    black_box(masses::energy(&mechanism, &parameters, &position, &qd));
    black_box(masses::rates(&mechanism, &parameters, &position, &motion));
    black_box(masses::loads(&mechanism, &parameters, &position, &motion));
    let (partition, margin) = masses::partition(&mechanism, &parameters, &position);
    black_box(margin);
    let gamma = emitted::gamma(&mechanism, &parameters, &position, &qd);
    black_box(masses::transformed(&mechanism, &parameters, &position, &partition, &force, &gamma));
}

/// Every formulation, every integrator, every implicit method, and the analyses without integration.
///
/// # Errors
/// Those of the solvers.
pub fn exercise_dynamics<S, R: Real, const N: usize, const M: usize>(mechanism: S) -> Result<(), Failure>
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M> + Copy,
{
    let step = Explicit::new(RungeKutta4, Baumgarte::default());
    let motion = fixed(mechanism, step)?;
    let (q, qd) = (*motion.q(), *motion.qd());
    black_box(entry::start_near(mechanism, step, motion.t(), q, qd)?);
    black_box(entry::determinacy(&motion, black_box(&mut [true; 4]))?);
    black_box(entry::linearize(motion.mechanism(), motion.instant())?);
    black_box(entry::inverse(motion.mechanism(), motion.t(), &q, &motion.instant().y.states)?);
    let rest = entry::equilibrium(motion.mechanism(), motion.t(), &q)?;
    black_box(entry::states_at_rest(motion.mechanism(), motion.t(), &rest.q, &rest.lambda)?);
    fixed(mechanism, Explicit::new(SemiImplicitEuler, Unstabilized))?;
    fixed(mechanism, Explicit::new(RungeKutta4, Projection::default()))?;
    // Soft: a stiff one leaves too few digits of the multipliers that the friction is balanced with.
    let penalty = Penalty { alpha: 10.0, ..Penalty::default() };
    fixed(mechanism, Explicit::new(RungeKutta4, penalty))?;
    fixed(mechanism, Explicit::new(RungeKutta4, VelocityTransformation))?;
    fixed(mechanism, GeneralizedAlpha::default())?;
    fixed(mechanism, AugmentedLagrangian)?;
    fixed(mechanism, Extrapolated)?;
    fixed(mechanism, Explicit::new(Radau5, Projection::default()))?;
    adaptive(mechanism, Explicit::new(Radau5, Projection::default()))?;
    adaptive(mechanism, Explicit::new(DormandPrince5, Projection::default()))?;
    adaptive(mechanism, Explicit::new(DormandPrince8, VelocityTransformation))?;
    adaptive(mechanism, Explicit::new(DormandPrince8, Projection::default()))
}

/// Contacts and limits, which are the same for every method but for the steps that look for them.
///
/// # Errors
/// Those of the solvers.
pub fn exercise_contacts<S, R: Real, const N: usize, const M: usize>(mechanism: S) -> Result<(), Failure>
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M> + Copy,
{
    fixed(mechanism, Explicit::new(RungeKutta4, Projection::default()))?;
    adaptive(mechanism, Explicit::new(DormandPrince8, Projection::default()))
}

/// Impacts, frictions that stick and events: steps over them, steps between them, and the analyses of one state.
///
/// # Errors
/// Those of the solvers; a state at which an analysis has no answer is none.
pub fn exercise_modes<S, R: Real, const N: usize, const M: usize>(mechanism: S) -> Result<(), Failure>
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M> + Copy,
{
    let motion = fixed(mechanism, MoreauJean)?;
    let (q, qd) = (*motion.q(), *motion.qd());
    black_box(entry::start_near(mechanism, MoreauJean, motion.t(), q, qd).is_ok());
    black_box(entry::determinacy(&motion, black_box(&mut [true; 4]))?);
    black_box(entry::linearize(motion.mechanism(), motion.instant()).is_ok());
    black_box(entry::inverse(motion.mechanism(), motion.t(), &q, &motion.instant().y.states).is_ok());
    black_box(entry::equilibrium(motion.mechanism(), motion.t(), &q).is_ok());
    adaptive(mechanism, Explicit::new(DormandPrince5, Projection::default()))
}

/// Impacts, frictions that stick and events by further methods.
///
/// # Errors
/// Those of the solvers.
pub fn exercise_modes_further<S, R: Real, const N: usize, const M: usize>(mechanism: S) -> Result<(), Failure>
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M> + Copy,
{
    fixed(mechanism, Explicit::new(SemiImplicitEuler, Projection::default()))?;
    fixed(mechanism, Explicit::new(RungeKutta4, VelocityTransformation))?;
    fixed(mechanism, Explicit::new(Radau5, Projection::default()))?;
    adaptive(mechanism, Explicit::new(Radau5, Projection::default()))?;
    adaptive(mechanism, Explicit::new(DormandPrince8, VelocityTransformation))
}

/// Simulations side by side, of which those at rest sleep.
///
/// # Errors
/// Those of the start.
pub fn exercise_sleep<S, R: Real, const N: usize, const M: usize>(mechanism: S) -> Result<(), Failure>
where
    S: Dynamic<R, N, M> + Copy,
{
    let method = Explicit::new(DormandPrince5, Projection::default());
    let (h, end) = (black_box(R::constant(1e-3)), black_box(R::constant(0.1)));
    let start = entry::start_from_text(black_box(mechanism), method, black_box(R::constant(0.0)))?;
    let mut lanes = Simulations::new([start, start]);
    black_box(entry::step_lanes(&mut lanes, h).map(|step| step.is_ok()));
    black_box(entry::advance_lanes_to(&mut lanes, end).map(|step| step.is_ok()));
    black_box(entry::wake(&mut lanes, black_box(0), h));
    Ok(())
}

/// Steps of fixed size.
fn fixed<S, X, R: Real, const N: usize, const M: usize>(
    mechanism: S,
    method: X,
) -> Result<Simulation<S, X, R, N, M>, Failure>
where
    S: Dynamic<R, N, M> + Copy,
    X: Method<S, R, N, M>,
{
    let h = black_box(R::constant(1e-3));
    let mut motion = entry::start_from_text(black_box(mechanism), method, black_box(R::constant(0.0)))?;
    entry::step(&mut motion, h)?;
    let value = motion.mechanism().get(0).unwrap_or(h);
    black_box(entry::change(&mut motion, black_box(0), value));
    entry::step_to(&mut motion, black_box(R::constant(5e-3)), black_box(4))?;
    black_box(entry::balance(&motion, h));
    black_box(entry::outputs(&motion));
    Ok(motion)
}

/// Steps whose size a tolerance controls.
fn adaptive<S, I, F, R: Real, const N: usize, const M: usize>(
    mechanism: S,
    method: Explicit<I, F>,
) -> Result<(), Failure>
where
    S: Dynamic<R, N, M> + Copy,
    I: Embedded,
    F: Formulation<S, R, N, M> + Clone,
{
    // Within reach of single precision.
    let (tolerance, longest) = (black_box(1e-4), black_box(R::constant(0.05)));
    let motion = entry::start_from_text(black_box(mechanism), method, black_box(R::constant(0.0)))?;
    let mut motion = entry::limited(motion, tolerance, longest);
    entry::advance_to(&mut motion, black_box(R::constant(0.1)))?;
    black_box(entry::sample(&mut motion, black_box(R::constant(0.15)), black_box(3))?);
    black_box(entry::watch(&mut motion, black_box(R::constant(0.2)), black_box(2))?);
    // At the present time: the motion goes on as without it.
    black_box(entry::watch_steps(&mut motion, black_box(R::constant(0.2)), black_box(2))?);
    entry::advance_through(&mut motion, black_box(R::constant(0.3)), black_box(R::constant(0.25)))?;
    let passed = black_box(R::constant(0.0));
    black_box(entry::advance_until_event(
        &mut motion,
        black_box(R::constant(0.6)),
        black_box(Direction::Any),
        passed,
    )?);
    Ok(())
}
