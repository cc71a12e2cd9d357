//! A mechanism whose inputs follow courses over the time.

use mbs_runtime::dynamics::{Event, SetValuedMode, Transformed, WithNormalForces, WithSetValuedRows};
use mbs_runtime::{
    BlockSolver, Dynamic, DynamicState, Energy, Entry, FunctionEntry, Gap, Kinematic, Limit, Margin,
    Mechanism, MissingSlope, NonNegative, Outcome, Partitioned, Reference, Solved,
};

use super::branching::{constants, forward};
use super::feeds::Feeds;

/// The mechanism `S` with inputs that follow courses wherever an integrator looks at them, and not at the ends of its steps alone.
///
/// Without courses it is `S`.
#[derive(Clone, Debug)]
pub struct Fed<S> {
    mechanism: S,
    feeds: Feeds,
    /// Time (s) of the inputs.
    t: f64,
}

impl<S> Fed<S> {
    /// `mechanism` with the inputs that it has.
    pub fn of(mechanism: S) -> Self {
        Fed { mechanism, feeds: Feeds::default(), t: 0.0 }
    }

    /// Makes the inputs of `fed` follow `feeds` from the time `t` (s) on.
    pub fn feed<const N: usize, const M: usize>(fed: &mut Self, feeds: &Feeds, t: f64)
    where
        S: Mechanism<f64, N, M>,
    {
        fed.feeds = feeds.clone();
        fed.lead::<N, M>(t);
    }

    fn lead<const N: usize, const M: usize>(&mut self, t: f64)
    where
        S: Mechanism<f64, N, M>,
    {
        let Fed { mechanism, feeds, .. } = self;
        feeds.show(t, |index, value| {
            mechanism.set(index, value);
        });
        self.t = t;
    }
}

/// `true` if the word `input` stands in a text: without it there is no input.
pub const fn may_have_inputs(text: &str) -> bool {
    const WORD: &[u8] = b"input";
    let text = text.as_bytes();
    let (mut at, mut matched) = (0, 0);
    while at < text.len() {
        // No letter of the word comes twice, so a mismatch begins anew.
        matched = match text[at] {
            letter if letter == WORD[matched] => matched + 1,
            letter if letter == WORD[0] => 1,
            _ => 0,
        };
        if matched == WORD.len() {
            return true;
        }
        at += 1;
    }
    false
}

impl<S: Mechanism<f64, N, M>, const N: usize, const M: usize> Mechanism<f64, N, M> for Fed<S> {
    type Parameters = S::Parameters;
    type Position = S::Position;
    type Entries = S::Entries;
    type Branches = S::Branches;
    type Limits = S::Limits;
    type Phases = S::Phases;
    type Values = S::Values;
    type Kept = S::Kept;
    type Outputs = S::Outputs;
    type Lane = S::Lane;

    constants!(forward);
    const HAS_SIGNALS: bool = true;

    forward! {
        fn get(self, index: usize) -> Option<f64>;
        fn set(mut self, index: usize, value: f64) -> bool;
        fn values(self) -> S::Values;
        fn set_values(mut self, values: S::Values);
        fn lane(self, lane: usize) -> S::Lane;
        fn jets(self, index: usize, x: f64, see: impl FnOnce(&[f64]));
        fn turn_back(mut self, coordinate: u16, turns: i64);
        fn phases(self) -> S::Phases;
        fn set_phases(mut self, phases: S::Phases);
        fn start_phases(mut self, q: &[f64; N], t: f64);
        fn advance_phases(mut self, from: f64, to: f64);
        fn phase_rates(self, t: f64) -> S::Phases;
        fn parameters(self) -> S::Parameters;
        fn guess(self, parameters: &S::Parameters) -> [f64; N];
        fn coordinate_scales(self, parameters: &S::Parameters) -> [f64; N];
        fn row_scales(self, parameters: &S::Parameters) -> [f64; M];
        fn widths(self, parameters: &S::Parameters) -> [f64; M];
        fn position(self, parameters: &S::Parameters, q: &[f64; N], t: f64) -> S::Position;
        fn phi(self, parameters: &S::Parameters, position: &S::Position) -> [f64; M];
        fn phi_q(self, parameters: &S::Parameters, position: &S::Position) -> [[f64; N]; M];
        fn phi_q_entries(self, parameters: &S::Parameters, position: &S::Position) -> S::Entries;
        fn phi_t(self, parameters: &S::Parameters, position: &S::Position) -> [f64; M];
        fn phi_tt(self, parameters: &S::Parameters, position: &S::Position) -> [f64; M];
        fn phi_qt_qd(self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N]) -> [f64; M];
        fn gamma(self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N]) -> [f64; M];
        fn branches(self, parameters: &S::Parameters, position: &S::Position) -> S::Branches;
        fn limits(self, parameters: &S::Parameters, position: &S::Position) -> S::Limits;
        fn outputs(self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N], qdd: &[f64; N]) -> S::Outputs;
    }

    fn carry_signals(&mut self, start: &Self, h: f64) {
        self.mechanism.carry_signals(&start.mechanism, h);
        if !self.feeds.is_empty() {
            self.lead::<N, M>(start.t + h);
        }
    }
}

impl<S: Kinematic<f64, N, M>, const N: usize, const M: usize> Kinematic<f64, N, M> for Fed<S> {
    type Factors = S::Factors;
    type GroupNumber = f64;
    type Group = Self;

    const BLOCK_BY_BLOCK: bool = S::BLOCK_BY_BLOCK;
    const HAS_CIRCLES: bool = S::HAS_CIRCLES;
    const HAS_ORDERS: bool = S::HAS_ORDERS;

    fn group(&self, _: usize) -> Self {
        self.clone()
    }

    fn solve_blocks<B: BlockSolver<f64>>(
        &self,
        parameters: &S::Parameters,
        q: &mut [f64; N],
        t: f64,
        solver: &mut B,
    ) -> [Outcome; 1] {
        self.mechanism.solve_blocks(parameters, q, t, solver)
    }
    fn solve_with_position<B: BlockSolver<f64>>(
        &self,
        parameters: &S::Parameters,
        q: &mut [f64; N],
        t: f64,
        solver: &mut B,
    ) -> ([Outcome; 1], S::Position) {
        self.mechanism.solve_with_position(parameters, q, t, solver)
    }
    fn solve_motion<B: BlockSolver<f64>>(
        &self,
        parameters: &S::Parameters,
        motion: &mut [[f64; N]; 3],
        t: f64,
        solver: &mut B,
    ) -> Solved<S::Position, f64> {
        self.mechanism.solve_motion(parameters, motion, t, solver)
    }
    forward! {
        fn factorize(self, parameters: &S::Parameters, position: &S::Position) -> (S::Factors, Margin<f64>);
        fn solve_linear(self, factors: &S::Factors, b: &[f64; M]) -> [f64; N];
    }
}

impl<S: Dynamic<f64, N, M>, const N: usize, const M: usize> Partitioned<f64, N, M> for Fed<S> {
    type Partition = S::Partition;

    const IS_PARTITIONED: bool = S::IS_PARTITIONED;
    const INDEPENDENT: &'static [u16] = S::INDEPENDENT;
    const IS_UNCOUPLED: bool = S::IS_UNCOUPLED;
    const IS_SPARSE: bool = S::IS_SPARSE;

    fn solve_dependent<B: BlockSolver<f64>>(
        &self,
        parameters: &S::Parameters,
        q: &mut [f64; N],
        t: f64,
        solver: &mut B,
    ) -> [Outcome; 1] {
        self.mechanism.solve_dependent(parameters, q, t, solver)
    }
    fn margin_of_rows(partition: &S::Partition) -> f64 {
        S::margin_of_rows(partition)
    }
    fn solve_by_rows(partition: &S::Partition, force: &[f64; N], gamma: &[f64; M]) -> Transformed<f64, N, M> {
        S::solve_by_rows(partition, force, gamma)
    }
    forward! {
        fn partition(self, parameters: &S::Parameters, position: &S::Position) -> (S::Partition, Margin<f64>);
        fn complete(self, partition: &S::Partition, b: &[f64; M], x: &mut [f64; N]);
        fn reduce(self, partition: &S::Partition, y: &mut [f64; N]) -> [f64; M];
    }
    forward! {
        fn accelerations(self, parameters: &Self::Parameters, position: &Self::Position, partition: &Self::Partition, force: &[f64; N], gamma: &[f64; M]) -> Transformed<f64, N, M>;
    }
}

impl<S: Dynamic<f64, N, M>, const N: usize, const M: usize> Dynamic<f64, N, M> for Fed<S> {
    type States = S::States;
    type StateSlopes = S::StateSlopes;
    type Powers = S::Powers;
    type Loads = S::Loads;

    const FORCE_USES_MULTIPLIERS: bool = S::FORCE_USES_MULTIPLIERS;
    const MISSING_SLOPE: Option<&'static MissingSlope> = S::MISSING_SLOPE;
    const STARTED: &'static [u16] = S::STARTED;
    const STARTED_RATES: &'static [u16] = S::STARTED_RATES;
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

    // `enclosed` stays `None`: intervals know an input by its value and its rates at the start of a step.
    forward! {
        fn gaps(self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N], see: impl FnMut(Gap<f64>));
        fn limit_rates(self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N], see: impl FnMut(Limit<f64>));
        fn signed(self, parameters: &S::Parameters, see: impl FnMut(f64));
        fn start_states(self, parameters: &S::Parameters) -> S::States;
        fn start_rates(self, parameters: &S::Parameters) -> [f64; N];
        fn mass(self, parameters: &S::Parameters, position: &S::Position) -> [[f64; N]; N];
        fn mass_times(self, parameters: &S::Parameters, position: &S::Position, x: &[f64; N]) -> [f64; N];
        fn force(self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N], states: &S::States, lambda: &[f64; M]) -> [f64; N];
        fn force_q(self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N], states: &S::States, lambda: &[f64; M]) -> [[f64; N]; N];
        fn force_qd(self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N], states: &S::States, lambda: &[f64; M]) -> [[f64; N]; N];
        fn force_lambda(self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N], states: &S::States, lambda: &[f64; M]) -> [[f64; M]; N];
        fn mass_times_q(self, parameters: &S::Parameters, position: &S::Position, x: &[f64; N]) -> [[f64; N]; N];
        fn reaction(self, parameters: &S::Parameters, position: &S::Position, lambda: &[f64; M]) -> [f64; N];
        fn reaction_q(self, parameters: &S::Parameters, position: &S::Position, lambda: &[f64; M]) -> [[f64; N]; N];
        fn third_derivative(self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N], lambda: &[f64; M]) -> Option<([f64; N], f64)>;
        fn energy(self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N]) -> Energy<f64>;
        fn powers(self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N], states: &S::States, lambda: &[f64; M]) -> S::Powers;
        fn carried(self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N], qdd: &[f64; N]) -> Option<f64>;
        fn state_rates(self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N], states: &S::States, lambda: &[f64; M]) -> S::States;
        fn state_slopes(self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N], states: &S::States, lambda: &[f64; M]) -> Option<S::StateSlopes>;
        fn events(self, parameters: &S::Parameters, position: &S::Position, motion: &DynamicState<'_, f64, N, M, S::States>, see: impl FnOnce(&[Event<f64>], &[f64]));
        fn loads(self, parameters: &S::Parameters, position: &S::Position, motion: &DynamicState<'_, f64, N, M, S::States>) -> S::Loads;
    }

    fn evaluated(parameters: &S::Parameters) -> &[bool] {
        S::evaluated(parameters)
    }
    fn evaluated_mut(parameters: &mut S::Parameters) -> &mut [bool] {
        S::evaluated_mut(parameters)
    }
    fn set_valued_modes(parameters: &S::Parameters) -> &[SetValuedMode<f64>] {
        S::set_valued_modes(parameters)
    }
    fn set_valued_modes_mut(parameters: &mut S::Parameters) -> &mut [SetValuedMode<f64>] {
        S::set_valued_modes_mut(parameters)
    }
    fn remembered(parameters: &S::Parameters) -> &[f64] {
        S::remembered(parameters)
    }
    fn remembered_mut(parameters: &mut S::Parameters) -> &mut [f64] {
        S::remembered_mut(parameters)
    }
    fn set_valued_rows<V: WithSetValuedRows<f64, N>>(
        &self,
        parameters: &S::Parameters,
        position: &S::Position,
        qd: &[f64; N],
        states: &S::States,
        lambda: &[f64; M],
        see: V,
    ) -> V::Output {
        self.mechanism.set_valued_rows(parameters, position, qd, states, lambda, see)
    }
    fn normal_forces<V: WithNormalForces<f64, N, M>>(
        &self,
        parameters: &S::Parameters,
        position: &S::Position,
        qd: &[f64; N],
        states: &S::States,
        see: V,
    ) -> Option<V::Output> {
        self.mechanism.normal_forces(parameters, position, qd, states, see)
    }
}

#[cfg(test)]
#[path = "fed_tests.rs"]
mod tests;
