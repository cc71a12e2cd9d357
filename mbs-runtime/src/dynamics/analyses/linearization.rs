//! Small motions about a state: M̄ s̈ + C̄ ṡ + K̄ s = 0 in as many coordinates s as there are degrees of freedom.

use crate::dynamics::analyses::held_variation::{AlongMotion, FreeMotions};
use crate::dynamics::analyses::modes::FreeOfHeld;
use crate::dynamics::analyses::virtual_motions::{VirtualMotions, left};
use crate::dynamics::equilibrium::free_stiffness::FreeStiffness;
use crate::dynamics::formulations::variation::{FreeMotion, Variation};
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::System;
use crate::dynamics::linear_systems::states::require_no_states;
use crate::dynamics::linear_systems::tangent::Tangent;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::method::require_smooth;
use crate::dynamics::model::metric::Metric;
use crate::dynamics::model::{Model, Solved};
use crate::failure::Failure;
use crate::linear_algebra::vectors::{dot, times};
use crate::mechanism::dynamic::{Dynamic, StateSlope};
use crate::scalar::number::Real;
use crate::tolerances::{forces, singular};

/// Matrices of small motions q + R s on the constraints.
///
/// The eigenvalues of s̈ = −M̄⁻¹ (C̄ ṡ + K̄ s) are 2·`freedom` and finite: no multiplier and no stabilisation adds any.
///
/// About an equilibrium s are orthonormal motions, and the eigenvalues do not depend on that choice. About a state that
/// moves s are the variations of the [`independent`](Self::independent) coordinates. The equation with the matrices of
/// each instant is then that of the true neighbouring motions; its eigenvalues at one instant differ in other coordinates.
/// Multipliers and forces of rigid contacts vary, with the frictions that slide by them: then Lᵀ is on the left in place of Rᵀ. Along L what
/// varies with them does no work, and Lᵀ M R = Rᵀ M R. They are held where the rate of a state depends on them. With first-order states z there is Rᵀ ∂Q/∂z ζ on the
/// right, and a further equation ζ̇ = ∂ż/∂z ζ + (∂ż/∂q R + ∂ż/∂q̇ Ṙ) s + ∂ż/∂q̇ R ṡ: [`linearize_with_states`]. The eigenvalues
/// are then 2·`freedom` and as many more as there are states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linearization<R, const N: usize> {
    /// Degrees of freedom: so many rows and columns of the matrices, and columns of the basis, count; the others are 0.
    pub freedom: usize,
    /// The basis R of the motions that the rows leave free, column by column.
    pub basis: [[R; N]; N],
    /// Rᵀ M R.
    pub mass: [[R; N]; N],
    /// Rᵀ (C R + 2 M Ṙ), gyroscopic terms included.
    pub damping: [[R; N]; N],
    /// Rᵀ (K R + C Ṙ + M R̈) with K = (M q̈)_q + (Φ_qᵀ λ)_q − ∂Q/∂q.
    pub stiffness: [[R; N]; N],
    /// `true` if the state moves: the matrices are then those of one moment, and their eigenvalues say nothing about the
    /// stability of the motion (frozen-time).
    pub frozen: bool,
    /// `true` for each coordinate of which s has the variation, in their order, about a state that moves; none about a rest: N.
    pub independent: [bool; N],
}

/// Small motions about the state `q`, `qd`, `qdd` (N each) with multipliers `lambda` (M) at time `t` (s), on the
/// constraints. About a state that moves they are in the coordinates that determine the others best.
///
/// Rigid contacts that push and frictions that stick hold: they take motions away. Events have the values of a run that starts there.
///
/// Source: Negrut & Ortiz 2006 for the reduction to the null space of Φ_q.
///
/// ```
/// use mbs_runtime::dynamics::{equilibrium, linearize};
/// use mbs_runtime::mechanism;
///
/// # mechanism! {
/// #     /// A pendulum of a rod.
/// #     pub mechanism Pendulum;
/// #     coord phi: rad = -1;
/// #     body rod { mass: 1, com: 0.5m*unit(phi), inertia: 1/12, angle: phi }
/// #     gravity weight { acceleration: [0, -9.81] }
/// #     start phi = -60deg rate 0;
/// # }
///
/// let pendulum = Pendulum::default();
/// let rest = equilibrium(&pendulum, 0.0_f64, &[-1.0])?;
/// let small = linearize(&pendulum, 0.0, (&rest.q, &[0.0], &[0.0]), &rest.lambda)?;
/// let omega = (small.stiffness[0][0] / small.mass[0][0]).sqrt();
/// assert!((omega - (1.5 * 9.81_f64).sqrt()).abs() < 1e-9); // rad/s
/// # Ok::<(), mbs_runtime::Failure>(())
/// ```
///
/// # Errors
/// [`NonFinite`](crate::FailureKind::NonFinite); [`SingularMass`](crate::FailureKind::SingularMass) where a free motion moves no mass; [`StatesUnknown`](crate::FailureKind::StatesUnknown) for a text with
/// first-order states, see [`linearize_with_states`]; [`NotSmooth`](crate::FailureKind::NotSmooth);
/// [`SetValuedEdge`](crate::FailureKind::SetValuedEdge) where a rigid contact touches without a force or a friction is at its limit;
/// [`SetValuedForce`](crate::FailureKind::SetValuedForce) where a friction slides on a rigid contact whose force is one of many;
/// [`SharedNormalForce`](crate::FailureKind::SharedNormalForce) where a multiplier is, by which a friction slides;
/// this and [`EventOfMotion`](crate::FailureKind::EventOfMotion) where the state is not one of the modes that it would start in.
pub fn linearize<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    state: (&[R; N], &[R; N], &[R; N]),
    lambda: &[R; M],
) -> Result<Linearization<R, N>, Failure> {
    linearize_in(mechanism, t, state, lambda, &[])
}

/// [`linearize`] in the coordinates `independent` about a state that moves, as far as they determine the others. So the
/// equation has the same s from instant to instant.
///
/// # Errors
/// As [`linearize`].
pub fn linearize_in<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    (q, qd, qdd): (&[R; N], &[R; N], &[R; N]),
    lambda: &[R; M],
    independent: &[u16],
) -> Result<Linearization<R, N>, Failure> {
    require_no_states::<S, R, N, M>(t)?;
    let y = IntegratorState {
        q: *q,
        qd: *qd,
        states: mechanism.start_states(&mechanism.parameters()),
        work: R::constant(0.0),
    };
    about(mechanism, (t, &y, qdd), lambda, independent).map(|(linear, _)| linear)
}

/// [`linearize_in`] for a text with first-order states: about the instant, states included. Also returns the coupling
/// with the states, one a state, its parts in s instead of q: Rᵀ ∂Q/∂z, ∂ż/∂q R + ∂ż/∂q̇ Ṙ, ∂ż/∂q̇ R, ∂ż/∂z; none
/// where there are no states.
///
/// # Errors
/// As [`linearize`], without the last.
pub fn linearize_with_states<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    instant: &Instant<R, N, M, S::States>,
    independent: &[u16],
) -> Result<WithStates<R, N, S::StateSlopes>, Failure> {
    let Instant { t, y, solved, .. } = instant;
    about(mechanism, (*t, y, &solved.rate.qd), &solved.lambda, independent)
}

/// Matrices of small motions, and their coupling with first-order states.
pub type WithStates<R, const N: usize, P> = (Linearization<R, N>, Option<P>);

/// The matrices about a state, and their coupling with first-order states.
fn about<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    (t, y, qdd): (R, &IntegratorState<R, N, S::States>, &[R; N]),
    lambda: &[R; M],
    independent: &[u16],
) -> Result<WithStates<R, N, S::StateSlopes>, Failure> {
    require_smooth::<S, R, N, M>()?;
    let mut parameters = mechanism.parameters();
    let metric = Metric::next_to(mechanism, &parameters, t, &y.q);
    let model = Model::of_states(mechanism, &parameters, &metric);
    model.check(t, y)?;
    let mut judged = None;
    if const { S::HAS_MODES } {
        let (modes, rates) = model.judged(t, y)?;
        (parameters, judged) = (modes, Some(rates));
    }
    let model = Model::of_states(mechanism, &parameters, &metric);
    about_in_modes(&model, (t, y, qdd), (lambda, judged.as_ref()), independent)
}

/// The matrices in the modes of the model, whose parameters have the forces of rows that hold. `judged`: its rates, of a text with modes.
pub(crate) fn about_in_modes<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y, qdd): (R, &IntegratorState<R, N, S::States>, &[R; N]),
    (lambda, judged): (&[R; M], Option<&Solved<R, N, M, S::States>>),
    independent: &[u16],
) -> Result<WithStates<R, N, S::StateSlopes>, Failure> {
    let (mechanism, parameters, metric) = (model.mechanism, model.parameters, model.metric);
    let (zero, position) = (R::constant(0.0), model.position(t, y));
    if judged.is_some() {
        model.require_modes_of(t, y, (qdd, lambda))?;
    }
    let tangent = Tangent::of(model, &position, y, qdd, lambda);
    let slopes = mechanism.state_slopes(parameters, &position, &y.qd, &y.states, lambda);
    let phi_q = mechanism.phi_q(parameters, &position);
    let system = System::new(&tangent.mass, &phi_q, metric);
    let factors = system.factorize_rank_revealing(singular::DEPENDENT.of(), S::COORDINATES, t)?;
    let scaled = |rates: &[R; N]| {
        let rates = rates.iter().zip(&metric.coordinates);
        rates.fold(zero, |largest, (rate, scale)| largest.max((*rate / *scale).abs()))
    };
    let (mut freedom, mut basis) = (N.saturating_sub(factors.rank()), factors.free_motions());
    let rows = (&tangent.mass, &phi_q, factors.rank());
    let mut directions = VirtualMotions::by_multipliers(model, (t, y, lambda), &position, rows)?;
    if const { !S::SET_VALUED.is_empty() }
        && let Some(rates) = judged
    {
        let free = FreeOfHeld { model, t, y, rates, basis: (basis, freedom), directions };
        ((basis, freedom), directions) =
            mechanism.set_valued_rows(parameters, &position, &y.qd, &y.states, lambda, free)?;
    }
    let slow = scaled(&y.qd) <= forces::AT_REST.of();
    if !slow || (forces::AT_REST.of::<R>() < scaled(qdd) && !rests(model, t, y, (&position, qdd), lambda)?) {
        let variation = &Variation::of(model, (t, y, qdd), &position, independent)?;
        let along = AlongMotion { model, t, y, qdd, lambda, variation, preferred: independent };
        let motions = if const { S::SET_VALUED.is_empty() } {
            along.free_motions()
        } else {
            mechanism.set_valued_rows(parameters, &position, &y.qd, &y.states, lambda, along)
        };
        let (linear, left, rates) = moving(&tangent, &motions, directions.as_ref())?;
        return Ok((linear, slopes.map(|slopes| coupled(slopes, &linear, &left, &rates))));
    }
    let columns = |matrix: &[[R; N]; N]| basis.map(|right| times(matrix, &right));
    let inertia = columns(&tangent.mass);
    let mass = reduced(&basis, &inertia, freedom);
    let left = left(&tangent.mass, (&basis, freedom), (&inertia, &mass), directions.as_ref())?;
    let linear = Linearization {
        freedom,
        basis,
        mass,
        damping: reduced(&left, &columns(&tangent.damping), freedom),
        stiffness: reduced(&left, &columns(&tangent.stiffness), freedom),
        frozen: has_moving_states(model, &position, y, (slopes.as_ref(), lambda)),
        independent: [false; N],
    };
    Ok((linear, slopes.map(|slopes| coupled(slopes, &linear, &left, &[[zero; N]; N]))))
}

/// `true` if the accelerations `qdd` (N) of a state without speeds are those of an equilibrium next to it, as those of a stiff
/// spring from rounded coordinates are.
#[cold]
fn rests<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
    (position, qdd): (&S::Position, &[R; N]),
    lambda: &[R; M],
) -> Result<bool, Failure> {
    let inertia = model.mechanism.mass_times(model.parameters, position, qdd);
    let answer = FreeStiffness::of(model, t, y, lambda)?.answer(&inertia, &[R::constant(0.0); M]);
    // Written so that NaN moves.
    Ok(answer.push <= R::constant(0.0) && model.largest(&answer.step) <= forces::AT_REST.of())
}

/// `true` if a first-order state moves: by more than [`forces::AT_REST`] of itself, or of its unit, a second, and by more than rounding.
fn has_moving_states<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    position: &S::Position,
    y: &IntegratorState<R, N, S::States>,
    (slopes, lambda): (Option<&S::StateSlopes>, &[R; M]),
) -> bool {
    let rates = model.mechanism.state_rates(model.parameters, position, &y.qd, &y.states, lambda);
    let size = |sum: R, (slope, value): (&R, &R)| sum + (*slope * *value).abs();
    let rounding = |index: usize| {
        let slope = slopes.and_then(|slopes| slopes.as_ref().get(index));
        let sum = slope.map_or(R::constant(0.0), |slope| {
            let by_place = slope.q.iter().zip(&y.q).fold(R::constant(0.0), size);
            slope.states.as_ref().iter().zip(y.states.as_ref()).fold(by_place, size)
        });
        forces::OF_STATE_RATE.of::<R>() * sum
    };
    let allowed = |state: &R| forces::AT_REST.of::<R>() * state.abs().max(R::constant(1.0));
    let states = rates.as_ref().iter().zip(y.states.as_ref()).enumerate();
    let mut moving = states.map(|(index, (rate, state))| allowed(state).max(rounding(index)) < rate.abs());
    moving.any(|moves| moves)
}

/// Coupling of the states with q, transformed from the coordinates q to s: `left` takes forces to the equation, `rates` is Ṙ, column by column.
fn coupled<R: Real, const N: usize, Z, P>(
    mut slopes: P,
    linear: &Linearization<R, N>,
    left: &[[R; N]; N],
    rates: &[[R; N]; N],
) -> P
where
    Z: AsRef<[R]> + AsMut<[R]>,
    P: AsMut<[StateSlope<R, N, Z>]>,
{
    for slope in slopes.as_mut() {
        let (force, q, qd) = (slope.force, slope.q, slope.qd);
        let columns = linear.basis.iter().zip(rates).zip(left);
        let parts = slope.force.iter_mut().zip(&mut slope.q).zip(&mut slope.qd).zip(columns);
        for (index, (((along, place), speed), ((basis, rate), left))) in parts.enumerate() {
            let free = index < linear.freedom;
            let of = |value: R| if free { value } else { R::constant(0.0) };
            *along = of(dot(&force, left));
            *place = of(dot(&q, basis) + dot(&qd, rate));
            *speed = of(dot(&qd, basis));
        }
    }
    slopes
}

/// The matrices about a state that moves, with two more matrices.
type Moving<R, const N: usize> = (Linearization<R, N>, [[R; N]; N], [[R; N]; N]);

/// The matrices about a state that moves, what takes forces to the equation, and Ṙ, column by column.
///
/// # Errors
/// Those of [`left`].
fn moving<R: Real, const N: usize>(
    tangent: &Tangent<R, N>,
    (motions, independent): &FreeMotions<R, N>,
    directions: Option<&VirtualMotions<R, N>>,
) -> Result<Moving<R, N>, Failure> {
    let (one, none) = (R::constant(1.0), [[R::constant(0.0); N]; N]);
    let (mut basis, mut rates, mut mass, mut damping, mut stiffness) = (none, none, none, none, none);
    let mut freedom = 0;
    for (motion, _) in motions.iter().zip(independent).filter(|(_, independent)| **independent) {
        let FreeMotion { place, rate, acceleration } = *motion;
        let columns = [&mut basis, &mut rates, &mut mass, &mut damping, &mut stiffness]
            .map(|columns| columns.get_mut(freedom));
        if let [Some(basis), Some(turning), Some(mass), Some(damping), Some(stiffness)] = columns {
            *basis = place;
            *turning = rate;
            *mass = times(&tangent.mass, &place);
            *damping = times(&tangent.damping, &place).plus(one, &[2.0], [&times(&tangent.mass, &rate)]);
            let [turned, bent] = [times(&tangent.damping, &rate), times(&tangent.mass, &acceleration)];
            *stiffness = times(&tangent.stiffness, &place).plus(one, &[1.0, 1.0], [&turned, &bent]);
            freedom += 1;
        }
    }
    let reduced_mass = reduced(&basis, &mass, freedom);
    let left = left(&tangent.mass, (&basis, freedom), (&mass, &reduced_mass), directions)?;
    let linear = Linearization {
        freedom,
        mass: reduced_mass,
        damping: reduced(&left, &damping, freedom),
        stiffness: reduced(&left, &stiffness, freedom),
        basis,
        frozen: true,
        independent: *independent,
    };
    Ok((linear, left, rates))
}

/// Rᵀ A, R the first `freedom` vectors of `basis`, A as many `columns`.
fn reduced<R: Real, const N: usize>(
    basis: &[[R; N]; N],
    columns: &[[R; N]; N],
    freedom: usize,
) -> [[R; N]; N] {
    let mut reduced = [[R::constant(0.0); N]; N];
    for (row, left) in reduced.iter_mut().zip(basis).take(freedom) {
        for (entry, right) in row.iter_mut().zip(columns).take(freedom) {
            *entry = dot(left, right);
        }
    }
    reduced
}
