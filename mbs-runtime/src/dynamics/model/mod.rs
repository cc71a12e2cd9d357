//! Model of a mechanism for the methods: with its stage-0 values and its metric.

pub(crate) mod events;
pub(crate) mod forward;
pub(crate) mod instant;
pub(crate) mod method;
pub(crate) mod metric;
mod multipliers;
mod number_checks;
pub(crate) mod sign_checks;

use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::forward::forward;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::metric::Metric;
use crate::failure::{Failure, FailureKind, checks};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{forces, positions};

/// A mechanism with the values that do not change while it moves.
pub struct Model<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    /// The mechanism.
    pub mechanism: &'a S,
    /// Its stage-0 values.
    pub parameters: &'a S::Parameters,
    /// Its reference metric.
    pub metric: &'a Metric<R, N, M>,
    /// `true` if the work of forces and drives is integrated.
    pub balanced: bool,
    /// `true` if rows follow from others on the constraints alone, so that off them the rank of Φ_q rises.
    pub rank_rises: bool,
    /// `true` if limits of rows next to a singular position have their first order: in steps of fixed size, and in their parts.
    pub first_order: bool,
    /// Residual over the row's scale at which a projection of positions ends: 64 ε, or a looser tolerance of the caller.
    pub position_tolerance: R,
    /// Energy (J) of springs a reference length long, in the place of set-valued forces: in a search for a rest alone.
    pub springs: Option<R>,
}

/// Rates of one state, with the multipliers that belong to them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved<R, const N: usize, const M: usize, Z> {
    /// q̇, q̈, ż and the power of forces and drives.
    pub rate: IntegratorState<R, N, Z>,
    /// Multipliers λ: M.
    pub lambda: [R; M],
    /// Margin of Φ_q to a loss of rank: 0 at the loss, at most 1.
    pub margin: R,
}

/// Evaluations, steps and iterations of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Right-hand sides evaluated.
    pub evaluations: u64,
    /// Right-hand sides evaluated in addition, for requested instants between the steps.
    pub shown: u64,
    /// Of the evaluations, those with a rank-revealing factorization.
    pub rank_revealing: u64,
    /// Of the evaluations of texts with blocks of rows, those by all rows together, where the independent coordinates turn back.
    pub rechosen: u64,
    /// Of the evaluations, those handed over by a method that needs independent motions where the rows lose rank.
    pub handed_over: u64,
    /// Stages that were put onto the constraints before they were evaluated.
    pub projected_stages: u64,
    /// Of the evaluations, those next to a singular position, whose rows lose their hold there.
    pub singular: u64,
    /// Corrections of positions and velocities by a projection.
    pub corrections: u64,
    /// Steps taken.
    pub steps: u64,
    /// Iterations of implicit methods.
    pub iterations: u64,
    /// Steps of the augmented Lagrangian that ended with a multiplier still moving: by less than the error of the rule in the step.
    pub unfinished: u64,
}

/// Formulation of the equations of motion: accelerations of a state, and its return to the constraints.
pub trait Formulation<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    /// Rates and multipliers at `(t, y)`; `lambda` (M) are those of the last state, where friction starts from.
    ///
    /// # Errors
    /// [`FailureKind::NonFinite`], [`FailureKind::SingularMass`], and those of the formulation itself.
    fn solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure>;

    /// Rates of [`solve`](Self::solve) alone, of a stage; `lambda` (M) become those of the state. `None` where they are not known this
    /// way, with all as before. Without room for a failure the rates stay in registers.
    #[inline(always)]
    fn rate(
        &self,
        _model: &Model<'_, S, R, N, M>,
        _t: R,
        _y: &IntegratorState<R, N, S::States>,
        _lambda: &mut [R; M],
        _counts: &mut Counts,
    ) -> Option<IntegratorState<R, N, S::States>> {
        None
    }

    /// Accelerations of a stage that cannot be put onto the constraints, in a step that cannot be made smaller: of the
    /// state as it is.
    ///
    /// # Errors
    /// Those of [`solve`](Self::solve).
    fn solve_as_it_is(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        self.solve(model, t, y, lambda, counts)
    }

    /// Puts the state that a step ended in back onto the constraints, as far as the formulation does.
    ///
    /// # Errors
    /// [`FailureKind::OffConstraints`] where that cannot be done.
    fn project(
        &self,
        _model: &Model<'_, S, R, N, M>,
        _t: R,
        _y: &mut IntegratorState<R, N, S::States>,
        _counts: &mut Counts,
    ) -> Result<(), Failure> {
        Ok(())
    }

    /// [`project`](Self::project), then [`solve`](Self::solve): a formulation that has factors of the settled position from
    /// the one may use them in the other.
    ///
    /// # Errors
    /// Those of both.
    #[inline]
    fn project_and_solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &mut IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        self.project(model, t, y, counts)?;
        self.solve(model, t, y, lambda, counts)
    }

    /// Checks the numbers that set the formulation.
    ///
    /// # Errors
    /// [`FailureKind::InvalidMethodParameter`] with the first one that is not.
    fn require_suitable(&self) -> Result<(), Failure> {
        Ok(())
    }

    /// Checks that the formulation is stable with a step of `h` (s).
    ///
    /// # Errors
    /// [`FailureKind::StepTooLong`].
    fn check_step(&self, _h: R, _t: R) -> Result<(), Failure> {
        Ok(())
    }

    /// `true` if accelerations of states off the constraints are taken from all rows as they are there.
    fn leaves_constraints(&self) -> bool {
        false
    }

    /// Warning about steps of `h` (s) in a run of `span` (s).
    fn doubt(&self, _h: R, _span: R) -> Option<MethodWarning> {
        None
    }
}

/// A reference has the behaviour of its target, which may be known at run time only.
impl<S, R, F, const N: usize, const M: usize> Formulation<S, R, N, M> for &F
where
    S: Dynamic<R, N, M>,
    R: Real,
    F: Formulation<S, R, N, M> + ?Sized,
{
    forward! { |it| **it =>
        solve, solve_as_it_is, project, project_and_solve, require_suitable, check_step, leaves_constraints, doubt
    }
}

/// Accelerations (N) and multipliers (M), with the force (N) that belongs to them.
pub(crate) type Balanced<R, const N: usize, const M: usize> = ([R; N], [R; M], [R; N]);

/// Warnings about method parameters that are allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodWarning {
    /// Baumgarte's frequency times the step is above 0.3: the stabilisation costs accuracy.
    StiffStabilization,
    /// Baumgarte's frequency times the duration is below 5: the stabilisation does nothing.
    IdleStabilization,
    /// Rows follow from others on the constraints alone: accelerations off them grow with the inverse of the distance.
    RisingRank,
}

impl<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'a, S, R, N, M> {
    /// Model for single states: no work is integrated, the rank of Φ_q is that of its margin, no step is taken.
    pub fn of_states(mechanism: &'a S, parameters: &'a S::Parameters, metric: &'a Metric<R, N, M>) -> Self {
        Model {
            mechanism,
            parameters,
            metric,
            balanced: false,
            rank_rises: false,
            first_order: false,
            position_tolerance: positions::OF_TERMS.of(),
            springs: None,
        }
    }
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Stage-1 values of a state.
    #[inline(always)]
    pub fn position(&self, t: R, y: &IntegratorState<R, N, S::States>) -> S::Position {
        self.mechanism.position(self.parameters, &y.q, t)
    }

    /// Calls `solve` with the mechanism as it is at time `to` (s). Inputs with rates, and the phases of drives that prescribe a
    /// rate, are moved on from time `from` (s).
    #[inline(always)]
    pub(crate) fn moved<X>(&self, from: R, to: R, solve: impl FnOnce(&Model<'_, S, R, N, M>) -> X) -> X {
        if const { S::PHASES.is_empty() && !S::HAS_SIGNALS } {
            return solve(self);
        }
        let mut mechanism = self.mechanism.clone();
        mechanism.carry_signals(self.mechanism, to - from);
        mechanism.advance_phases(from, to);
        let parameters = self.alike(mechanism.parameters());
        solve(&Model { mechanism: &mechanism, parameters: &parameters, ..*self })
    }

    /// Parameters with the same contacts left out as here, and the same modes.
    #[inline(always)]
    pub(crate) fn alike(&self, mut parameters: S::Parameters) -> S::Parameters {
        for (to, from) in S::evaluated_mut(&mut parameters).iter_mut().zip(S::evaluated(self.parameters)) {
            *to = *from;
        }
        self.with_modes_of(parameters)
    }

    /// The largest of `values` (N) over its coordinate's scale.
    pub(crate) fn largest(&self, values: &[R; N]) -> R {
        let scaled =
            values.iter().zip(&self.metric.coordinates).map(|(value, scale)| (*value / *scale).abs());
        scaled.fold(R::constant(0.0), |largest, value| largest.max(value))
    }

    /// Fails with the coordinate that a step from `from` to `after` (N), at `t` (s), takes too far for a motion: 1e4 in the metric, and
    /// several times as far as rates and accelerations at its start lead.
    pub(crate) fn require_bounded<Z>(
        &self,
        t: R,
        from: &Instant<R, N, M, Z>,
        after: &[R; N],
    ) -> Result<(), Failure> {
        let (h, q, rate) = (t - from.t, &from.y.q, &from.solved.rate);
        let apart = |(before, after): (&R, &R), scale: &R| ((*after - *before) / *scale).abs();
        let all = q.iter().zip(after).zip(&self.metric.coordinates);
        // Written so that NaN is not near. Nearly all steps end here.
        if all.fold(true, |near, (ends, scale)| near & (apart(ends, scale) <= R::constant(LARGEST_MOTION))) {
            return Ok(());
        }
        let led = h * (self.largest(&from.y.qd) + h * self.largest(&rate.qd));
        let mut worst = (R::constant(LARGEST_MOTION).max(R::constant(LARGEST_EXCESS) * led), None);
        let moved = q.iter().zip(after).zip(&self.metric.coordinates);
        for (index, ((before, after), scale)) in (0_u16..).zip(moved) {
            let distance = apart((before, after), scale);
            if worst.0 < distance || !distance.is_finite() {
                worst = (distance, Some((index, *after)));
            }
        }
        let Some((index, value)) = worst.1 else { return Ok(()) };
        let coordinate = checks::entry(S::COORDINATES, index);
        Err(FailureKind::Unbounded { coordinate, value: value.to_f64() }.at(t.to_f64()))
    }

    /// Fails if a step of `h` (s) ends with rates or an energy that no motion has: [`require_bounded`](Self::require_bounded),
    /// and for a step that moves anything far, a kinetic energy without a source.
    #[inline(always)]
    pub(crate) fn require_plausible<Z>(
        &self,
        (from, h): (&Instant<R, N, M, Z>, R),
        next: &Instant<R, N, M, Z>,
    ) -> Result<(), Failure>
    where
        S: Dynamic<R, N, M, States = Z>,
    {
        self.require_bounded(next.t, from, &next.y.q)?;
        let gate = R::constant(LARGE_MOTION);
        let mut small = true;
        for (rate, scale) in next.y.qd.iter().zip(&self.metric.coordinates) {
            // Written so that NaN is not small.
            small &= (h * *rate).abs() < gate * *scale;
        }
        if small { Ok(()) } else { self.require_explained_energy((from, h), next) }
    }

    /// Fails if the kinetic energy at the end of a step of `h` (s) is several times the sum of that at its start, potentials and
    /// the power supplied, or if the energy balance is several times off the energies.
    #[cold]
    #[inline(never)]
    fn require_explained_energy<Z>(
        &self,
        (from, h): (&Instant<R, N, M, Z>, R),
        next: &Instant<R, N, M, Z>,
    ) -> Result<(), Failure>
    where
        S: Dynamic<R, N, M, States = Z>,
    {
        let (zero, most) = (R::constant(0.0), R::constant(LARGEST_GAIN));
        let at = |model: &Model<'_, S, R, N, M>, t: R, y: &IntegratorState<R, N, S::States>| {
            model.mechanism.energy(model.parameters, &model.position(t, y), &y.qd)
        };
        let start = at(self, from.t, &from.y);
        let end = self.moved(from.t, next.t, |model| at(model, next.t, &next.y));
        let released = start.potential - end.potential;
        let work = if self.balanced {
            next.y.work - from.y.work
        } else {
            let power = |model: &Model<'_, S, R, N, M>, instant: &Instant<R, N, M, Z>| {
                let Instant { t, y, solved, .. } = instant;
                model.power(&model.position(*t, y), y, &solved.rate.qd, &solved.lambda)
            };
            h * power(self, from).max(self.moved(from.t, next.t, |model| power(model, next)))
        };
        let available = start.kinetic + released.max(zero) + work.max(zero);
        let known = start.kinetic + end.kinetic + released.abs();
        let defect = end.kinetic - start.kinetic - released - work;
        let balanced = !self.balanced || defect.abs() <= most * known;
        // Written so that NaN is no energy.
        if end.kinetic <= most * available && balanced {
            return Ok(());
        }
        let (kinetic, available) = (end.kinetic.to_f64(), available.to_f64());
        Err(FailureKind::EnergyGain { kinetic, available }.at(next.t.to_f64()))
    }

    /// Rates of a state whose accelerations and multipliers are known.
    #[inline(always)]
    pub(crate) fn rates(
        &self,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        qdd: [R; N],
        lambda: &[R; M],
    ) -> IntegratorState<R, N, S::States> {
        if const { !S::SET_VALUED.is_empty() } {
            let parameters = self.with_set_valued_forces(position, y, (&qdd, lambda));
            let model = Model { parameters: &parameters, ..*self };
            return model.rates_of_forces(position, y, qdd, lambda);
        }
        self.rates_of_forces(position, y, qdd, lambda)
    }

    /// [`rates`](Self::rates) where the forces of frictions that stick are known.
    #[inline(always)]
    fn rates_of_forces(
        &self,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        qdd: [R; N],
        lambda: &[R; M],
    ) -> IntegratorState<R, N, S::States> {
        let (mechanism, parameters) = (self.mechanism, self.parameters);
        let states = mechanism.state_rates(parameters, position, &y.qd, &y.states, lambda);
        let work = if self.balanced { self.power(position, y, &qdd, lambda) } else { R::constant(0.0) };
        IntegratorState { q: y.qd, qd: qdd, states, work }
    }

    /// Power (W) of the forces that are not potential, of the drives, and of the time where it carries masses along or
    /// changes a potential: Σ Pᵢ + λᵀ Φ_t + P_t.
    fn power(
        &self,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        qdd: &[R; N],
        lambda: &[R; M],
    ) -> R {
        let powers = self.mechanism.powers(self.parameters, position, &y.qd, &y.states, lambda);
        let forces = powers.as_ref().iter().fold(R::constant(0.0), |sum, power| sum + *power);
        let moving = self.mechanism.phi_t(self.parameters, position);
        let sum = lambda.iter().zip(&moving).fold(forces, |sum, (lambda, rate)| sum + *lambda * *rate);
        let carried = self.mechanism.carried(self.parameters, position, &y.qd, qdd);
        carried.map_or(sum, |carried| sum + carried)
    }

    /// Solves with forces that may depend on the multipliers. `solve` gives accelerations and multipliers for a force, or, for
    /// `false`, the increment by the force alone.
    #[inline(always)]
    pub(crate) fn balanced(
        &self,
        position: &S::Position,
        at: (R, &IntegratorState<R, N, S::States>),
        lambda: &[R; M],
        solve: impl FnMut(&[R; N], bool) -> ([R; N], [R; M]),
    ) -> Result<Balanced<R, N, M>, Failure> {
        self.balanced_to(forces::STANDING.of(), position, at, lambda, solve)
    }

    /// The same where `solve` leaves changes of `standing` of their size in the multipliers.
    #[inline(always)]
    pub(crate) fn balanced_to(
        &self,
        standing: R,
        position: &S::Position,
        at: (R, &IntegratorState<R, N, S::States>),
        lambda: &[R; M],
        solve: impl FnMut(&[R; N], bool) -> ([R; N], [R; M]),
    ) -> Result<Balanced<R, N, M>, Failure> {
        if const { !S::SET_VALUED.is_empty() } && self.springs.is_none() {
            return self.balanced_in_its_modes(standing, position, at, lambda, solve);
        }
        self.balanced_freely(standing, position, at, lambda, solve)
    }

    /// The same without friction that sticks.
    #[inline(always)]
    pub(crate) fn balanced_freely(
        &self,
        standing: R,
        position: &S::Position,
        at: (R, &IntegratorState<R, N, S::States>),
        lambda: &[R; M],
        mut solve: impl FnMut(&[R; N], bool) -> ([R; N], [R; M]),
    ) -> Result<Balanced<R, N, M>, Failure> {
        let known = if S::FORCE_USES_MULTIPLIERS {
            self.friction(standing, position, at, lambda, &mut solve)?
        } else {
            *lambda
        };
        let y = at.1;
        let force = self.mechanism.force(self.parameters, position, &y.qd, &y.states, &known);
        let (qdd, found) = solve(&force, true);
        Ok((qdd, found, force))
    }
}

/// Motion in one step of fixed size, in the reference metric (rad, or reference lengths), that a mechanism makes only as its rates
/// lead: the integration has lost it.
const LARGEST_MOTION: f64 = 1e4;

/// Such a motion over that by the rates and accelerations at the start of the step. A free motion makes 1 of it at most.
const LARGEST_EXCESS: f64 = 4.0;

/// Motion in one step of fixed size by the rates of its end, in the reference metric (rad, or reference lengths), above which
/// it is checked. A step of a control loop, or one that follows a motion at all, moves less.
const LARGE_MOTION: f64 = 0.5;

/// Kinetic energy at the end of such a step over the sum of that at its start, potentials and the power supplied. Exactly it is 1
/// at most. Errors of a step that follows the motion add a fraction; the first step of a method of first order from rest adds 1
/// again.
const LARGEST_GAIN: f64 = 4.0;
