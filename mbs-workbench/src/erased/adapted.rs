//! A mechanism in other coordinates and with other rows: q = A x + b, rows in another order and times factors.
//!
//! The motion is the same, so a method must find the same one. The elimination that the compiler chose for the text takes no part:
//! the blocks are not those of the text, and all entries count.

use mbs_runtime::dynamics::{Event, SetValuedMode, SetValuedRow, Transformed, WithSetValuedRows};
use mbs_runtime::{
    BlockSolver, Dynamic, DynamicState, Energy, Entry, FunctionEntry, Gap, Limit, Margin, Mechanism,
    MissingSlope, NonNegative, Outcome, Partitioned, Reference, Scalar, StateSlope,
};

use super::adaption::Adaption;

/// The mechanism seen through an [`Adaption`].
#[derive(Clone, Debug)]
pub struct Adapted<S, const N: usize, const M: usize> {
    /// The mechanism.
    pub mechanism: S,
    /// Its other coordinates and rows.
    pub adaption: Adaption<N, M>,
}

/// All entries of a matrix.
#[derive(Clone, Copy, Debug)]
pub struct Entries<T, const N: usize, const M: usize>([[T; N]; M]);

impl<T, const N: usize, const M: usize> AsRef<[T]> for Entries<T, N, M> {
    fn as_ref(&self) -> &[T] {
        self.0.as_flattened()
    }
}

const fn places<const N: usize, const M: usize>() -> [[(u16, u16); N]; M] {
    let mut all = [[(0, 0); N]; M];
    let mut row = 0;
    while row < M {
        let mut column = 0;
        while column < N {
            all[row][column] = (row as u16, column as u16);
            column += 1;
        }
        row += 1;
    }
    all
}

impl<S, const N: usize, const M: usize> Adapted<S, N, M> {
    const PLACES: [[(u16, u16); N]; M] = places::<N, M>();
}

impl<S, T, const N: usize, const M: usize> Mechanism<T, N, M> for Adapted<S, N, M>
where
    S: Mechanism<T, N, M>,
    T: Scalar,
{
    type Parameters = S::Parameters;
    type Position = S::Position;
    type Entries = Entries<T, N, M>;
    type Branches = S::Branches;
    type Limits = S::Limits;
    type Phases = S::Phases;
    type Values = S::Values;
    type Kept = S::Kept;
    type Outputs = S::Outputs;
    type Lane = Adapted<S::Lane, N, M>;

    const NAME: &'static str = S::NAME;
    const SCENE: &'static str = S::SCENE;
    const SOURCE: &'static str = S::SOURCE;
    const COORDINATES: &'static [Entry] = S::COORDINATES;
    const ROWS: &'static [Entry] = S::ROWS;
    const REDUNDANT: &'static [bool] = S::REDUNDANT;
    const SPARSITY: &'static [(u16, u16)] = Self::PLACES.as_flattened();
    const VARIABLES: &'static [Entry] = S::VARIABLES;
    const ANGLES: &'static [u16] = S::ANGLES;
    const REFERENCE: Reference = S::REFERENCE;
    const BRANCHES: &'static [Entry] = S::BRANCHES;
    const BRANCHES_AT_START: &'static [bool] = S::BRANCHES_AT_START;
    const LIMITS: &'static [Entry] = S::LIMITS;
    const PHASES: &'static [Entry] = S::PHASES;
    const OUTPUTS: &'static [Entry] = S::OUTPUTS;
    const FUNCTIONS: &'static [FunctionEntry] = S::FUNCTIONS;
    const HAS_SIGNALS: bool = S::HAS_SIGNALS;

    fn get(&self, index: usize) -> Option<T> {
        self.mechanism.get(index)
    }
    fn set(&mut self, index: usize, value: T) -> bool {
        self.mechanism.set(index, value)
    }
    fn lane(&self, lane: usize) -> Self::Lane {
        Adapted { mechanism: self.mechanism.lane(lane), adaption: self.adaption.clone() }
    }
    fn jets(&self, index: usize, x: T, see: impl FnOnce(&[T])) {
        self.mechanism.jets(index, x, see);
    }
    fn values(&self) -> Self::Values {
        self.mechanism.values()
    }
    fn set_values(&mut self, values: Self::Values) {
        self.mechanism.set_values(values);
    }
    fn carry_signals(&mut self, start: &Self, h: T) {
        self.mechanism.carry_signals(&start.mechanism, h);
    }
    fn phases(&self) -> Self::Phases {
        self.mechanism.phases()
    }
    fn set_phases(&mut self, phases: Self::Phases) {
        self.mechanism.set_phases(phases);
    }
    fn start_phases(&mut self, q: &[T; N], t: T) {
        self.mechanism.start_phases(&self.adaption.position(q), t);
    }
    fn advance_phases(&mut self, from: T, to: T) {
        self.mechanism.advance_phases(from, to);
    }
    fn phase_rates(&self, t: T) -> Self::Phases {
        self.mechanism.phase_rates(t)
    }
    fn parameters(&self) -> Self::Parameters {
        self.mechanism.parameters()
    }
    fn guess(&self, _: &Self::Parameters) -> [T; N] {
        let Adaption { shift, start: [q, _], .. } = &self.adaption;
        let away = core::array::from_fn(|i| T::constant(q[i] - shift[i]));
        self.adaption.force(&away)
    }
    fn coordinate_scales(&self, parameters: &Self::Parameters) -> [T; N] {
        self.mechanism.coordinate_scales(parameters)
    }
    fn row_scales(&self, parameters: &Self::Parameters) -> [T; M] {
        let scales = self.mechanism.row_scales(parameters);
        self.adaption.rows.map(|(row, _)| scales[row])
    }
    fn widths(&self, parameters: &Self::Parameters) -> [T; M] {
        let widths = self.mechanism.widths(parameters);
        self.adaption.rows.map(|(row, factor)| widths[row] * T::constant(factor.abs()))
    }
    fn position(&self, parameters: &Self::Parameters, q: &[T; N], t: T) -> Self::Position {
        self.mechanism.position(parameters, &self.adaption.position(q), t)
    }
    fn phi(&self, parameters: &Self::Parameters, position: &Self::Position) -> [T; M] {
        self.adaption.in_rows(&self.mechanism.phi(parameters, position))
    }
    fn phi_q(&self, parameters: &Self::Parameters, position: &Self::Position) -> [[T; N]; M] {
        let phi_q = self.mechanism.phi_q(parameters, position);
        self.adaption
            .rows
            .map(|(row, factor)| self.adaption.force(&phi_q[row]).map(|entry| entry * T::constant(factor)))
    }
    fn phi_q_entries(&self, parameters: &Self::Parameters, position: &Self::Position) -> Self::Entries {
        Entries(self.phi_q(parameters, position))
    }
    fn phi_t(&self, parameters: &Self::Parameters, position: &Self::Position) -> [T; M] {
        self.adaption.in_rows(&self.mechanism.phi_t(parameters, position))
    }
    fn phi_tt(&self, parameters: &Self::Parameters, position: &Self::Position) -> [T; M] {
        self.adaption.in_rows(&self.mechanism.phi_tt(parameters, position))
    }
    fn phi_qt_qd(&self, parameters: &Self::Parameters, position: &Self::Position, qd: &[T; N]) -> [T; M] {
        let qd = self.adaption.direction(qd);
        self.adaption.in_rows(&self.mechanism.phi_qt_qd(parameters, position, &qd))
    }
    fn gamma(&self, parameters: &Self::Parameters, position: &Self::Position, qd: &[T; N]) -> [T; M] {
        let qd = self.adaption.direction(qd);
        self.adaption.in_rows(&self.mechanism.gamma(parameters, position, &qd))
    }
    fn branches(&self, parameters: &Self::Parameters, position: &Self::Position) -> Self::Branches {
        self.mechanism.branches(parameters, position)
    }
    fn limits(&self, parameters: &Self::Parameters, position: &Self::Position) -> Self::Limits {
        self.mechanism.limits(parameters, position)
    }
    fn outputs(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        qdd: &[T; N],
    ) -> Self::Outputs {
        let (qd, qdd) = (self.adaption.direction(qd), self.adaption.direction(qdd));
        self.mechanism.outputs(parameters, position, &qd, &qdd)
    }
}

impl<S, T, const N: usize, const M: usize> Partitioned<T, N, M> for Adapted<S, N, M>
where
    S: Mechanism<T, N, M>,
    T: Scalar,
{
    type Partition = ();
    const IS_PARTITIONED: bool = false;
    const INDEPENDENT: &'static [u16] = &[];

    fn solve_dependent<B: BlockSolver<T>>(
        &self,
        _: &Self::Parameters,
        _: &mut [T; N],
        _: T,
        _: &mut B,
    ) -> T::Lanes<Outcome> {
        T::per_lane(|_| Outcome::NotConverged { row: 0 })
    }
    fn partition(&self, _: &Self::Parameters, _: &Self::Position) -> ((), Margin<T>) {
        ((), Margin::regular().with_block(T::constant(0.0), 0, 0))
    }
    fn complete(&self, (): &(), _: &[T; M], _: &mut [T; N]) {}
    fn reduce(&self, (): &(), _: &mut [T; N]) -> [T; M] {
        [T::constant(0.0); M]
    }
    fn accelerations(
        &self,
        _: &Self::Parameters,
        _: &Self::Position,
        _: &Self::Partition,
        _: &[T; N],
        _: &[T; M],
    ) -> Transformed<T, N, M> {
        let zero = T::constant(0.0);
        Transformed { qdd: [zero; N], lambda: [zero; M], inert: false }
    }
}

/// Rows of frictions with their gradients in the adapted coordinates.
struct AdaptedRows<'a, V, const N: usize, const M: usize> {
    adaption: &'a Adaption<N, M>,
    see: V,
}

impl<V, T, const N: usize, const M: usize> WithSetValuedRows<T, N> for AdaptedRows<'_, V, N, M>
where
    V: WithSetValuedRows<T, N>,
    T: Scalar,
{
    type Output = V::Output;

    fn at<const K: usize>(self, rows: &[SetValuedRow<T, N>; K]) -> V::Output {
        let adapted = rows.map(|row| SetValuedRow { gradient: self.adaption.force(&row.gradient), ..row });
        self.see.at(&adapted)
    }
}

impl<S, T, const N: usize, const M: usize> Dynamic<T, N, M> for Adapted<S, N, M>
where
    S: Dynamic<T, N, M>,
    T: Scalar,
{
    type States = S::States;
    type StateSlopes = S::StateSlopes;
    type Powers = S::Powers;
    type Loads = S::Loads;

    const FORCE_USES_MULTIPLIERS: bool = S::FORCE_USES_MULTIPLIERS;
    const MISSING_SLOPE: Option<&'static MissingSlope> = S::MISSING_SLOPE;
    const STATES: &'static [Entry] = S::STATES;
    const FORCES: &'static [Entry] = S::FORCES;
    const LOADS: &'static [Entry] = S::LOADS;
    const CONTACTS: &'static [Entry] = S::CONTACTS;
    const SET_VALUED: &'static [Entry] = S::SET_VALUED;
    const HAS_RIGID_CONTACTS: bool = S::HAS_RIGID_CONTACTS;
    const EVENTS: &'static [Entry] = S::EVENTS;
    const LATCHED_BY: &'static [u16] = S::LATCHED_BY;
    const EVENTS_USE_ACCELERATIONS: bool = S::EVENTS_USE_ACCELERATIONS;
    const HAS_MODES: bool = S::HAS_MODES;
    const HAS_FRICTION_ON_CONTACTS: bool = S::HAS_FRICTION_ON_CONTACTS;
    const NON_NEGATIVE: &'static [NonNegative] = S::NON_NEGATIVE;

    fn gaps(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        see: impl FnMut(Gap<T>),
    ) {
        self.mechanism.gaps(parameters, position, &self.adaption.direction(qd), see);
    }
    fn evaluated(parameters: &Self::Parameters) -> &[bool] {
        S::evaluated(parameters)
    }
    fn evaluated_mut(parameters: &mut Self::Parameters) -> &mut [bool] {
        S::evaluated_mut(parameters)
    }
    fn set_valued_modes(parameters: &Self::Parameters) -> &[SetValuedMode<T>] {
        S::set_valued_modes(parameters)
    }
    fn set_valued_modes_mut(parameters: &mut Self::Parameters) -> &mut [SetValuedMode<T>] {
        S::set_valued_modes_mut(parameters)
    }
    fn remembered(parameters: &Self::Parameters) -> &[T] {
        S::remembered(parameters)
    }
    fn remembered_mut(parameters: &mut Self::Parameters) -> &mut [T] {
        S::remembered_mut(parameters)
    }
    fn set_valued_rows<V: WithSetValuedRows<T, N>>(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        states: &Self::States,
        lambda: &[T; M],
        see: V,
    ) -> V::Output {
        let (qd, lambda) = (self.adaption.direction(qd), self.adaption.multipliers(lambda));
        let see = AdaptedRows { adaption: &self.adaption, see };
        self.mechanism.set_valued_rows(parameters, position, &qd, states, &lambda, see)
    }
    fn limit_rates(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        see: impl FnMut(Limit<T>),
    ) {
        self.mechanism.limit_rates(parameters, position, &self.adaption.direction(qd), see);
    }
    fn signed(&self, parameters: &Self::Parameters, see: impl FnMut(T)) {
        self.mechanism.signed(parameters, see);
    }
    fn start_states(&self, parameters: &Self::Parameters) -> Self::States {
        self.mechanism.start_states(parameters)
    }
    fn start_rates(&self, _: &Self::Parameters) -> [T; N] {
        self.adaption.force(&self.adaption.start[1].map(T::constant))
    }
    fn mass(&self, parameters: &Self::Parameters, position: &Self::Position) -> [[T; N]; N] {
        self.adaption.both(&self.mechanism.mass(parameters, position))
    }
    fn mass_times(&self, parameters: &Self::Parameters, position: &Self::Position, x: &[T; N]) -> [T; N] {
        let x = self.adaption.direction(x);
        self.adaption.force(&self.mechanism.mass_times(parameters, position, &x))
    }
    fn force(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        states: &Self::States,
        lambda: &[T; M],
    ) -> [T; N] {
        let (qd, lambda) = (self.adaption.direction(qd), self.adaption.multipliers(lambda));
        self.adaption.force(&self.mechanism.force(parameters, position, &qd, states, &lambda))
    }
    fn force_q(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        states: &Self::States,
        lambda: &[T; M],
    ) -> [[T; N]; N] {
        let (qd, lambda) = (self.adaption.direction(qd), self.adaption.multipliers(lambda));
        self.adaption.both(&self.mechanism.force_q(parameters, position, &qd, states, &lambda))
    }
    fn force_qd(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        states: &Self::States,
        lambda: &[T; M],
    ) -> [[T; N]; N] {
        let (qd, lambda) = (self.adaption.direction(qd), self.adaption.multipliers(lambda));
        self.adaption.both(&self.mechanism.force_qd(parameters, position, &qd, states, &lambda))
    }
    fn force_lambda(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        states: &Self::States,
        lambda: &[T; M],
    ) -> [[T; M]; N] {
        let (qd, lambda) = (self.adaption.direction(qd), self.adaption.multipliers(lambda));
        let slopes = self.mechanism.force_lambda(parameters, position, &qd, states, &lambda);
        let columns = self
            .adaption
            .rows
            .map(|(row, factor)| self.adaption.force(&slopes.map(|slope| slope[row] * T::constant(factor))));
        core::array::from_fn(|i| core::array::from_fn(|j| columns[j][i]))
    }
    fn mass_times_q(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        x: &[T; N],
    ) -> [[T; N]; N] {
        let x = self.adaption.direction(x);
        self.adaption.both(&self.mechanism.mass_times_q(parameters, position, &x))
    }
    fn reaction(&self, parameters: &Self::Parameters, position: &Self::Position, lambda: &[T; M]) -> [T; N] {
        let lambda = self.adaption.multipliers(lambda);
        self.adaption.force(&self.mechanism.reaction(parameters, position, &lambda))
    }
    fn reaction_q(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        lambda: &[T; M],
    ) -> [[T; N]; N] {
        let lambda = self.adaption.multipliers(lambda);
        self.adaption.both(&self.mechanism.reaction_q(parameters, position, &lambda))
    }
    fn third_derivative(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        lambda: &[T; M],
    ) -> Option<([T; N], T)> {
        let (qd, lambda) = (self.adaption.direction(qd), self.adaption.multipliers(lambda));
        let (direction, right) = self.mechanism.third_derivative(parameters, position, &qd, &lambda)?;
        Some((self.adaption.force(&direction), right))
    }
    fn energy(&self, parameters: &Self::Parameters, position: &Self::Position, qd: &[T; N]) -> Energy<T> {
        self.mechanism.energy(parameters, position, &self.adaption.direction(qd))
    }
    fn powers(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        states: &Self::States,
        lambda: &[T; M],
    ) -> Self::Powers {
        let (qd, lambda) = (self.adaption.direction(qd), self.adaption.multipliers(lambda));
        self.mechanism.powers(parameters, position, &qd, states, &lambda)
    }
    fn carried(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        qdd: &[T; N],
    ) -> Option<T> {
        let (qd, qdd) = (self.adaption.direction(qd), self.adaption.direction(qdd));
        self.mechanism.carried(parameters, position, &qd, &qdd)
    }
    fn state_rates(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        states: &Self::States,
        lambda: &[T; M],
    ) -> Self::States {
        let (qd, lambda) = (self.adaption.direction(qd), self.adaption.multipliers(lambda));
        self.mechanism.state_rates(parameters, position, &qd, states, &lambda)
    }
    fn state_slopes(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        qd: &[T; N],
        states: &Self::States,
        lambda: &[T; M],
    ) -> Option<Self::StateSlopes> {
        let (qd, lambda) = (self.adaption.direction(qd), self.adaption.multipliers(lambda));
        let mut slopes = self.mechanism.state_slopes(parameters, position, &qd, states, &lambda)?;
        for slope in slopes.as_mut() {
            let StateSlope { force, q, qd, .. } = slope;
            for part in [force, q, qd] {
                *part = self.adaption.force(part);
            }
        }
        Some(slopes)
    }
    fn loads(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        motion: &DynamicState<'_, T, N, M, Self::States>,
    ) -> Self::Loads {
        let (qd, qdd) = (self.adaption.direction(motion.qd), self.adaption.direction(motion.qdd));
        let lambda = self.adaption.multipliers(motion.lambda);
        let motion = DynamicState { qd: &qd, qdd: &qdd, lambda: &lambda, states: motion.states };
        self.mechanism.loads(parameters, position, &motion)
    }
    fn events(
        &self,
        parameters: &Self::Parameters,
        position: &Self::Position,
        motion: &DynamicState<'_, T, N, M, Self::States>,
        see: impl FnOnce(&[Event<T>], &[T]),
    ) {
        let (qd, qdd) = (self.adaption.direction(motion.qd), self.adaption.direction(motion.qdd));
        let lambda = self.adaption.multipliers(motion.lambda);
        let motion = DynamicState { qd: &qd, qdd: &qdd, lambda: &lambda, states: motion.states };
        self.mechanism.events(parameters, position, &motion, see);
    }
}
