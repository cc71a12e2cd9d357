//! Equations of motion as emitted for a text with bodies and forces: M q̈ + Φ_qᵀ λ = Q with Φ = 0.

use crate::mechanism::block::BlockSolver;
use crate::mechanism::enclosure::WithIntervals;
use crate::mechanism::event::Event;
use crate::mechanism::limit::Limit;
use crate::mechanism::margin::Margin;
use crate::mechanism::normal_forces::WithNormalForces;
use crate::mechanism::outcome::Outcome;
use crate::mechanism::set_valued::{SetValuedMode, WithSetValuedRows};
use crate::mechanism::transformed::Transformed;
use crate::mechanism::{Entry, Mechanism};
use crate::scalar::number::Scalar;

/// Kinetic and potential energy of one state (J).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy<T> {
    /// ½ q̇ᵀ M q̇, and the terms that the text adds by `kinetic`.
    pub kinetic: T,
    /// Gravity, springs, and the terms that the text adds by `potential`.
    pub potential: T,
}

/// The gap of a contact in one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap<T> {
    /// Gap (m): open above 0, closed below.
    pub gap: T,
    /// Its rate (m/s).
    pub rate: T,
    /// Largest |second time derivative of the gap| while it is open (m/s²), where the text declares it.
    pub bound: Option<T>,
}

/// Velocities, accelerations, multipliers and first-order states of one state of motion.
///
/// The multipliers have the text's sign: a row's force on the coordinates is −Φ_qᵀ λ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DynamicState<'a, T, const N: usize, const M: usize, Z> {
    /// Velocities q̇: N.
    pub qd: &'a [T; N],
    /// Accelerations q̈: N.
    pub qdd: &'a [T; N],
    /// Multipliers λ: M.
    pub lambda: &'a [T; M],
    /// First-order states of the text.
    pub states: &'a Z,
}

/// A mass, moment of inertia or stiffness that parameters alone make: at least 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NonNegative {
    /// Body or force, and field: `rod.mass`.
    pub name: &'static str,
    /// Its line in the text.
    pub line: u32,
    /// The first parameter that it is made of.
    pub parameter: &'static str,
}

/// A derivative of the forces that a declared function is not smooth enough for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissingSlope {
    /// The derivative that is missing: `∂Q/∂q`.
    pub slope: &'static str,
    /// The declared function.
    pub function: Entry,
    /// Order of its derivative that would be needed.
    pub order: u8,
    /// Order up to which the text declares it continuous.
    pub declared: u8,
    /// `true` where a position of rest depends on it: not on ∂Q/∂q̇.
    pub acts_at_rest: bool,
}

/// Derivatives of the forces by one first-order state z, and those of its rate ż.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateSlope<T, const N: usize, Z> {
    /// ∂Q/∂z: N.
    pub force: [T; N],
    /// ∂ż/∂q: N.
    pub q: [T; N],
    /// ∂ż/∂q̇: N.
    pub qd: [T; N],
    /// ∂ż by all states of the text.
    pub states: Z,
}

impl<T: Scalar, const N: usize, Z: AsRef<[T]> + AsMut<[T]>> StateSlope<T, N, Z> {
    /// ∂ż by the state at `index`; 0 where there is none.
    pub(crate) fn entry(&self, index: usize) -> T {
        self.states.as_ref().get(index).copied().unwrap_or(T::constant(0.0))
    }

    /// `factor` times the rate.
    pub(crate) fn scale(&mut self, factor: T) {
        let rates = self.q.iter_mut().chain(&mut self.qd).chain(self.states.as_mut());
        rates.for_each(|entry| *entry = *entry * factor);
    }

    /// The rate less `factor` times another.
    pub(crate) fn subtract(&mut self, factor: T, other: &Self) {
        let rates = self.q.iter_mut().chain(&mut self.qd).chain(self.states.as_mut());
        let others = other.q.iter().chain(&other.qd).chain(other.states.as_ref());
        rates.zip(others).for_each(|(entry, other)| *entry = *entry - factor * *other);
    }
}

/// A mechanism with masses and forces. Matrices are dense here, for methods that factorise them and for tests; the
/// products that fast methods need are straight-line code without zeros.
pub trait Dynamic<T: Scalar, const N: usize, const M: usize>: Partitioned<T, N, M> {
    /// First-order states `z` of the text: an array.
    type States: Copy + AsRef<[T]> + AsMut<[T]>;
    /// One a first-order state, in the order of [`STATES`](Self::STATES).
    type StateSlopes: Copy + AsRef<[StateSlope<T, N, Self::States>]> + AsMut<[StateSlope<T, N, Self::States>]>;
    /// One value a force of the text.
    type Powers: Copy + AsRef<[T]>;
    /// One value a component of an `out` that uses `lambda`, `effort`, `reaction` or a state.
    type Loads: Copy + AsRef<[T]>;

    /// `true` if [`force`](Self::force) depends on the multipliers: friction. Where it does not, methods save the
    /// iteration for it.
    const FORCE_USES_MULTIPLIERS: bool = true;
    /// Cause of a missing derivative among [`force_q`](Self::force_q), [`force_qd`](Self::force_qd),
    /// [`mass_times_q`](Self::mass_times_q), [`reaction_q`](Self::reaction_q), [`state_slopes`](Self::state_slopes). Its entries
    /// are NaN, or it is `None`. Explicit methods do without; others fail with [`FailureKind::NotSmooth`](crate::FailureKind::NotSmooth).
    const MISSING_SLOPE: Option<&'static MissingSlope> = None;
    /// Coordinates whose start the text declares, ascending.
    const STARTED: &'static [u16] = &[];
    /// Coordinates of which it declares the rate at the start, ascending.
    const STARTED_RATES: &'static [u16] = &[];
    /// First-order states.
    const STATES: &'static [Entry];
    /// Forces by name, in the order of [`powers`](Self::powers): all that are neither gravity nor of a potential.
    const FORCES: &'static [Entry];
    /// Outputs of [`loads`](Self::loads), component by component.
    const LOADS: &'static [Entry];

    /// Contacts, in the order of [`gaps`](Self::gaps).
    const CONTACTS: &'static [Entry] = &[];
    /// Shows `see` the gaps of the contacts, one after the other.
    fn gaps(
        &self,
        _parameters: &Self::Parameters,
        _position: &Self::Position,
        _qd: &[T; N],
        _see: impl FnMut(Gap<T>),
    ) {
    }

    /// Contacts whose force is evaluated, in the order of [`CONTACTS`](Self::CONTACTS): all by default. Of the others
    /// [`force`](Self::force), its derivatives and [`powers`](Self::powers) are those of an open contact, and cost one test. Empty where
    /// contacts cannot be left out.
    #[inline]
    fn evaluated(_parameters: &Self::Parameters) -> &[bool] {
        &[]
    }
    /// The same, to leave open contacts out.
    #[inline]
    fn evaluated_mut(_parameters: &mut Self::Parameters) -> &mut [bool] {
        &mut []
    }

    /// Frictions with stiction and rigid contacts, in the order of [`set_valued_rows`](Self::set_valued_rows).
    const SET_VALUED: &'static [Entry] = &[];
    /// `true` if rigid contacts are among [`SET_VALUED`](Self::SET_VALUED): steps begin with their impacts.
    const HAS_RIGID_CONTACTS: bool = false;
    /// `true` if frictions on rigid contacts are among [`SET_VALUED`](Self::SET_VALUED).
    const HAS_FRICTION_ON_CONTACTS: bool = false;
    /// Their modes, sticking or sliding, in the order of [`SET_VALUED`](Self::SET_VALUED). [`force`](Self::force) has the friction of those that
    /// slide and the [`SetValuedMode::force`] of those that stick.
    #[inline]
    fn set_valued_modes(_parameters: &Self::Parameters) -> &[SetValuedMode<T>] {
        &[]
    }
    /// The same, to be changed.
    #[inline]
    fn set_valued_modes_mut(_parameters: &mut Self::Parameters) -> &mut [SetValuedMode<T>] {
        &mut []
    }
    /// Result of `see` on their rows.
    #[inline]
    fn set_valued_rows<V: WithSetValuedRows<T, N>>(
        &self,
        _parameters: &Self::Parameters,
        _position: &Self::Position,
        _qd: &[T; N],
        _states: &Self::States,
        _lambda: &[T; M],
        see: V,
    ) -> V::Output {
        see.at::<0>(&[])
    }

    /// Events, in the order of the text.
    const EVENTS: &'static [Entry] = &[];
    /// Indices of the events that latch a value, one a value.
    const LATCHED_BY: &'static [u16] = &[];
    /// `true` if what they watch depends on accelerations, multipliers or forces that hold.
    const EVENTS_USE_ACCELERATIONS: bool = true;
    /// `true` if a step begins with a decision on modes: of frictions that stick, of rigid contacts, or of events.
    const HAS_MODES: bool = !(Self::SET_VALUED.is_empty() && Self::EVENTS.is_empty());
    /// Values that events set: one an event, 1 where it holds and otherwise 0, then one a latched value.
    #[inline]
    fn remembered(_parameters: &Self::Parameters) -> &[T] {
        &[]
    }
    /// The same, to be changed.
    #[inline]
    fn remembered_mut(_parameters: &mut Self::Parameters) -> &mut [T] {
        &mut []
    }
    /// Shows `see` the conditions of the events, and the values that these would latch now.
    #[inline]
    fn events(
        &self,
        _parameters: &Self::Parameters,
        _position: &Self::Position,
        _motion: &DynamicState<'_, T, N, M, Self::States>,
        see: impl FnOnce(&[Event<T>], &[T]),
    ) {
        see(&[], &[]);
    }

    /// Result of `see` on the mechanism in interval arithmetic, at the present parameters and inputs. `None` where the text calls
    /// functions or has drives that prescribe a rate.
    #[inline]
    fn enclosed<V: WithIntervals<T, N, M>>(&self, _see: V) -> Option<V::Output> {
        None
    }
    /// Shows `see` the rates of the working ranges, one after the other, where [`enclosed`](Self::enclosed) is not `None`.
    #[inline]
    fn limit_rates(
        &self,
        _parameters: &Self::Parameters,
        _position: &Self::Position,
        _qd: &[T; N],
        _see: impl FnMut(Limit<T>),
    ) {
    }

    /// Quantities that must not be negative, in the order of [`signed`](Self::signed).
    const NON_NEGATIVE: &'static [NonNegative] = &[];

    /// Shows `see` the values of [`NON_NEGATIVE`](Self::NON_NEGATIVE), one after the other.
    fn signed(&self, _parameters: &Self::Parameters, _see: impl FnMut(T)) {}
    /// Start values of the first-order states.
    fn start_states(&self, parameters: &Self::Parameters) -> Self::States;
    /// The rates that the text's `start … rate` declares; 0 elsewhere: N.
    fn start_rates(&self, parameters: &Self::Parameters) -> [T; N];

    /// Mass matrix M(q), symmetric: N rows of N.
    fn mass(&self, parameters: &Self::Parameters, position: &Self::Position) -> [[T; N]; N];
    /// M x: N.
    fn mass_times(&self, parameters: &Self::Parameters, position: &Self::Position, x: &[T; N]) -> [T; N];
    /// Q: generalized forces less the velocity-quadratic inertia terms, the whole right-hand side of
    /// M q̈ + Φ_qᵀ λ = Q: N. `lambda` (M) are the multipliers of the last accepted stage, for friction.
    fn force(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        states: &Self::States,
        lambda: &[T; M],
    ) -> [T; N];
    /// ∂Q/∂q: N rows of N.
    fn force_q(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        states: &Self::States,
        lambda: &[T; M],
    ) -> [[T; N]; N];
    /// ∂Q/∂q̇: N rows of N.
    fn force_qd(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        states: &Self::States,
        lambda: &[T; M],
    ) -> [[T; N]; N];
    /// ∂Q/∂λ: N rows of M. At a kink of friction the derivative of one side.
    #[inline]
    fn force_lambda(
        &self,
        _parameters: &Self::Parameters,
        _position: &Self::Position,
        _qd: &[T; N],
        _states: &Self::States,
        _lambda: &[T; M],
    ) -> [[T; M]; N] {
        [[T::constant(0.0); M]; N]
    }
    /// Result of `see` on [`NormalForces`](crate::mechanism::normal_forces::NormalForces); `None` where Q depends on the
    /// multipliers in any other form.
    #[inline]
    fn normal_forces<V: WithNormalForces<T, N, M>>(
        &self,
        _parameters: &Self::Parameters,
        _position: &Self::Position,
        _qd: &[T; N],
        _states: &Self::States,
        _see: V,
    ) -> Option<V::Output> {
        None
    }
    /// (M x)_q with x held, for linearisation and implicit methods: N rows of N.
    fn mass_times_q(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        x: &[T; N],
    ) -> [[T; N]; N];
    /// Φ_qᵀ λ: N.
    fn reaction(&self, parameters: &Self::Parameters, position: &Self::Position, lambda: &[T; M]) -> [T; N];
    /// (Φ_qᵀ λ)_q with λ held: N rows of N, symmetric.
    fn reaction_q(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        lambda: &[T; M],
    ) -> [[T; N]; N];
    /// Condition on q̈ from the third time derivative of Φ, for the combination `lambda` (M) of the rows held:
    /// d³/dt³ λᵀΦ = λᵀΦ_q q⃛ + 3 rᵀq̈ − c with r = Φ̇_qᵀ λ = ∂_q(λᵀ(Φ_q q̇ + Φ_t)): N, and c = λᵀγ̇, γ̇ the derivative of γ along (q̇, 1).
    /// If λᵀΦ_q vanishes, 3 rᵀq̈ = c takes the place of λᵀΦ_q q̈ = λᵀγ. None where it is not known.
    #[inline]
    fn third_derivative(
        &self,
        _parameters: &Self::Parameters,
        _position: &Self::Position,
        _qd: &[T; N],
        _lambda: &[T; M],
    ) -> Option<([T; N], T)> {
        None
    }
    /// Kinetic and potential energy (J).
    fn energy(&self, parameters: &Self::Parameters, position: &Self::Position, qd: &[T; N]) -> Energy<T>;
    /// Power of each force (W), positive where it feeds the mechanism; without the power that springs store as potential
    /// energy. Kinetic and potential energy change by the sum of these, by the power of drives and by
    /// [`carried`](Self::carried).
    ///
    /// If the time moves the place of a force, that motion counts only as it loads a spring.
    fn powers(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        states: &Self::States,
        lambda: &[T; M],
    ) -> Self::Powers;
    /// Power (W) that the time gives to kinetic and potential energy by itself, inputs held: where it carries masses along
    /// or changes a potential. None where it does nothing of that.
    #[inline]
    fn carried(
        &self,
        _parameters: &Self::Parameters,
        _position: &Self::Position,
        _qd: &[T; N],
        _qdd: &[T; N],
    ) -> Option<T> {
        None
    }
    /// ż of the first-order states.
    fn state_rates(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        states: &Self::States,
        lambda: &[T; M],
    ) -> Self::States;
    /// ∂Q/∂z and the derivatives of ż, multipliers held; none where the text has no first-order states.
    #[inline]
    fn state_slopes(
        &self,
        _parameters: &Self::Parameters,
        _position: &Self::Position,
        _qd: &[T; N],
        _states: &Self::States,
        _lambda: &[T; M],
    ) -> Option<Self::StateSlopes> {
        None
    }
    /// Outputs that use multipliers or states.
    fn loads(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        motion: &DynamicState<'_, T, N, M, Self::States>,
    ) -> Self::Loads;
}

/// A mechanism with independent coordinates: the rows fix the others, block after block.
///
/// [`Kinematic`](crate::Kinematic) is the case without independent coordinates.
pub trait Partitioned<T: Scalar, const N: usize, const M: usize>: Mechanism<T, N, M> {
    /// Factorised diagonal blocks over the dependent coordinates, and the other entries of Φ_q.
    type Partition: Copy;

    /// `true` if there are such blocks. A text with more rows than its coordinates take has none. Its partition is then empty and
    /// of margin 0, its functions give 0 and `NotConverged`, and
    /// [`VelocityTransformation`](crate::dynamics::formulations::velocity_transformation::VelocityTransformation) goes over to
    /// [`Projection`](crate::dynamics::formulations::projection::Projection).
    const IS_PARTITIONED: bool = true;
    /// The independent coordinates, ascending: N − M; none where there are no blocks.
    const INDEPENDENT: &'static [u16];
    /// `true` if each independent coordinate has a mass of its own: none is in a row, and no entry of M couples one with any other
    /// coordinate.
    const IS_UNCOUPLED: bool = false;
    /// `true` if a partition has factors of M and all rows without their zeros too: texts with so many independent coordinates that their
    /// motions cost many times as much. [`accelerations`](Self::accelerations) then uses these.
    const IS_SPARSE: bool = false;

    /// Solves Φ(q, t) = 0 for the dependent coordinates; the independent ones of `q` (N) stay as they are.
    fn solve_dependent<S: BlockSolver<T>>(
        &self,
        parameters: &Self::Parameters,
        q: &mut [T; N],
        t: T,
        solver: &mut S,
    ) -> T::Lanes<Outcome>;
    /// Factorises the dependent columns of Φ_q block by block; returns the smallest margin of any block.
    fn partition(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
    ) -> (Self::Partition, Margin<T>);
    /// Margin of M and all rows, of a partition that has factors of them without their zeros ([`IS_SPARSE`](Self::IS_SPARSE)): 0 where
    /// these are of no use, at most 1.
    #[inline(always)]
    fn margin_of_rows(_partition: &Self::Partition) -> T {
        T::constant(0.0)
    }
    /// q̈ (N) and λ (M) by those factors, for a force (N) and γ (M).
    #[inline(always)]
    fn solve_by_rows(_partition: &Self::Partition, _force: &[T; N], _gamma: &[T; M]) -> Transformed<T, N, M> {
        let zero = T::constant(0.0);
        Transformed { qdd: [zero; N], lambda: [zero; M], inert: false }
    }
    /// Completes `x` (N), whose independent entries are given, so that Φ_q x = b (M).
    fn complete(&self, partition: &Self::Partition, b: &[T; M], x: &mut [T; N]);
    /// Adds to `y` (N) at the independent coordinates the part of its dependent entries, y_i − Gᵀ y_d with
    /// G = Φ_qd⁻¹ Φ_qi. So a force on all coordinates becomes one on the independent ones.
    /// Returns the multipliers that balance the dependent entries: Φ_qdᵀ λ = y_d: M.
    fn reduce(&self, partition: &Self::Partition, y: &mut [T; N]) -> [T; M];
    /// q̈ (N) and λ (M) of a factorised partition for a force (N) and γ (M): the function
    /// [`accelerations`](crate::dynamics::formulations::block_elimination::accelerations) with the number of independent
    /// coordinates, which stable Rust cannot compute from N and M.
    fn accelerations(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        partition: &Self::Partition,
        force: &[T; N],
        gamma: &[T; M],
    ) -> Transformed<T, N, M>
    where
        Self: Dynamic<T, N, M>;
}
