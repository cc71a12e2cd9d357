//! A mechanism whose branches may count or not, as is said at run time: what solves it is compiled once for both.

use mbs_runtime::{
    Block, BlockSolver, Entry, Factorization, FunctionEntry, Kinematic, Margin, Mechanism, Outcome,
    Reference, Roots, Solved, Widths,
};

/// The mechanism `S` with its branch conditions, or as if its text declared none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Branching<S> {
    mechanism: S,
    counted: bool,
}

impl<S> Branching<S> {
    /// `mechanism` as it is.
    pub(crate) fn declared(mechanism: S) -> Self {
        Branching { mechanism, counted: true }
    }

    /// `mechanism` without its branch conditions: any assembly is right.
    pub(crate) fn none(mechanism: S) -> Self {
        Branching { mechanism, counted: false }
    }
}

/// Values of the branch conditions that count.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Counted<B>(Option<B>);

impl<B: AsRef<[f64]>> AsRef<[f64]> for Counted<B> {
    fn as_ref(&self) -> &[f64] {
        self.0.as_ref().map_or(&[], |values| values.as_ref())
    }
}

impl<S: Kinematic<f64, N, M>, const N: usize, const M: usize> Mechanism<f64, N, M> for Branching<S> {
    type Parameters = S::Parameters;
    type Position = S::Position;
    type Entries = S::Entries;
    type Branches = Counted<S::Branches>;
    type Limits = S::Limits;
    type Phases = S::Phases;
    type Values = S::Values;
    type Kept = S::Kept;
    type Outputs = S::Outputs;
    type Lane = S::Lane;

    const NAME: &'static str = S::NAME;
    const SOURCE: &'static str = S::SOURCE;
    const COORDINATES: &'static [Entry] = S::COORDINATES;
    const SCENE: &'static str = S::SCENE;
    const ROWS: &'static [Entry] = S::ROWS;
    const REDUNDANT: &'static [bool] = S::REDUNDANT;
    const SPARSITY: &'static [(u16, u16)] = S::SPARSITY;
    const VARIABLES: &'static [Entry] = S::VARIABLES;
    const ANGLES: &'static [u16] = S::ANGLES;
    const TURNING_INPUTS: &'static [u16] = S::TURNING_INPUTS;
    const REFERENCE: Reference = S::REFERENCE;
    const BRANCHES: &'static [Entry] = S::BRANCHES;
    const BRANCHES_AT_START: &'static [bool] = S::BRANCHES_AT_START;
    const LIMITS: &'static [Entry] = S::LIMITS;
    const PHASES: &'static [Entry] = S::PHASES;
    const TURNS: &'static [u16] = S::TURNS;
    const OUTPUTS: &'static [Entry] = S::OUTPUTS;
    const FUNCTIONS: &'static [FunctionEntry] = S::FUNCTIONS;
    const HAS_SIGNALS: bool = S::HAS_SIGNALS;

    fn get(&self, index: usize) -> Option<f64> {
        self.mechanism.get(index)
    }
    fn set(&mut self, index: usize, value: f64) -> bool {
        self.mechanism.set(index, value)
    }
    fn values(&self) -> S::Values {
        self.mechanism.values()
    }
    fn set_values(&mut self, values: S::Values) {
        self.mechanism.set_values(values);
    }
    fn lane(&self, lane: usize) -> S::Lane {
        self.mechanism.lane(lane)
    }
    fn carry_signals(&mut self, start: &Self, h: f64) {
        self.mechanism.carry_signals(&start.mechanism, h);
    }
    fn turn_back(&mut self, coordinate: u16, turns: i64) {
        self.mechanism.turn_back(coordinate, turns);
    }
    fn phases(&self) -> S::Phases {
        self.mechanism.phases()
    }
    fn set_phases(&mut self, phases: S::Phases) {
        self.mechanism.set_phases(phases);
    }
    fn start_phases(&mut self, q: &[f64; N], t: f64) {
        self.mechanism.start_phases(q, t);
    }
    fn advance_phases(&mut self, from: f64, to: f64) {
        self.mechanism.advance_phases(from, to);
    }
    fn phase_rates(&self, t: f64) -> S::Phases {
        self.mechanism.phase_rates(t)
    }
    fn parameters(&self) -> S::Parameters {
        self.mechanism.parameters()
    }
    fn guess(&self, parameters: &S::Parameters) -> [f64; N] {
        self.mechanism.guess(parameters)
    }
    fn coordinate_scales(&self, parameters: &S::Parameters) -> [f64; N] {
        self.mechanism.coordinate_scales(parameters)
    }
    fn row_scales(&self, parameters: &S::Parameters) -> [f64; M] {
        self.mechanism.row_scales(parameters)
    }
    fn widths(&self, parameters: &S::Parameters) -> [f64; M] {
        self.mechanism.widths(parameters)
    }
    fn position(&self, parameters: &S::Parameters, q: &[f64; N], t: f64) -> S::Position {
        self.mechanism.position(parameters, q, t)
    }
    fn phi(&self, parameters: &S::Parameters, position: &S::Position) -> [f64; M] {
        self.mechanism.phi(parameters, position)
    }
    fn phi_q(&self, parameters: &S::Parameters, position: &S::Position) -> [[f64; N]; M] {
        self.mechanism.phi_q(parameters, position)
    }
    fn phi_q_entries(&self, parameters: &S::Parameters, position: &S::Position) -> S::Entries {
        self.mechanism.phi_q_entries(parameters, position)
    }
    fn phi_t(&self, parameters: &S::Parameters, position: &S::Position) -> [f64; M] {
        self.mechanism.phi_t(parameters, position)
    }
    fn phi_tt(&self, parameters: &S::Parameters, position: &S::Position) -> [f64; M] {
        self.mechanism.phi_tt(parameters, position)
    }
    fn phi_qt_qd(&self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N]) -> [f64; M] {
        self.mechanism.phi_qt_qd(parameters, position, qd)
    }
    fn gamma(&self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N]) -> [f64; M] {
        self.mechanism.gamma(parameters, position, qd)
    }
    fn branches(&self, parameters: &S::Parameters, position: &S::Position) -> Counted<S::Branches> {
        Counted(self.counted.then(|| self.mechanism.branches(parameters, position)))
    }
    fn limits(&self, parameters: &S::Parameters, position: &S::Position) -> S::Limits {
        self.mechanism.limits(parameters, position)
    }
    fn outputs(
        &self,
        parameters: &S::Parameters,
        position: &S::Position,
        qd: &[f64; N],
        qdd: &[f64; N],
    ) -> S::Outputs {
        self.mechanism.outputs(parameters, position, qd, qdd)
    }
}

impl<S: Kinematic<f64, N, M>, const N: usize, const M: usize> Kinematic<f64, N, M> for Branching<S> {
    type Factors = S::Factors;

    const BLOCK_BY_BLOCK: bool = S::BLOCK_BY_BLOCK;

    fn solve_blocks<B: BlockSolver<f64>>(
        &self,
        parameters: &S::Parameters,
        q: &mut [f64; N],
        t: f64,
        solver: &mut B,
    ) -> [Outcome; 1] {
        self.mechanism.solve_blocks(parameters, q, t, &mut Judging { solver, counted: self.counted })
    }
    fn solve_with_position<B: BlockSolver<f64>>(
        &self,
        parameters: &S::Parameters,
        q: &mut [f64; N],
        t: f64,
        solver: &mut B,
    ) -> ([Outcome; 1], S::Position) {
        self.mechanism.solve_with_position(parameters, q, t, &mut Judging { solver, counted: self.counted })
    }
    fn solve_motion<B: BlockSolver<f64>>(
        &self,
        parameters: &S::Parameters,
        motion: &mut [[f64; N]; 3],
        t: f64,
        solver: &mut B,
    ) -> Solved<S::Position, f64> {
        self.mechanism.solve_motion(parameters, motion, t, &mut Judging { solver, counted: self.counted })
    }
    fn factorize(&self, parameters: &S::Parameters, position: &S::Position) -> (S::Factors, Margin<f64>) {
        self.mechanism.factorize(parameters, position)
    }
    fn solve_linear(&self, factors: &S::Factors, b: &[f64; M]) -> [f64; N] {
        self.mechanism.solve_linear(factors, b)
    }
}

/// A solver to which any position is right where branches do not count.
struct Judging<'a, B> {
    solver: &'a mut B,
    counted: bool,
}

impl<B: BlockSolver<f64>> BlockSolver<f64> for Judging<'_, B> {
    const COPIED: bool = B::COPIED;

    fn solve<const K: usize, F: Factorization<f64, K>>(
        &mut self,
        block: &Block<f64, K>,
        x: [f64; K],
        evaluate: impl FnMut(&[f64; K]) -> ([f64; K], [[f64; K]; K]),
    ) -> ([f64; K], [Outcome; 1]) {
        self.solver.solve::<K, F>(block, x, evaluate)
    }

    fn solve_branched<const K: usize, F: Factorization<f64, K>>(
        &mut self,
        block: &Block<f64, K>,
        x: [f64; K],
        evaluate: impl FnMut(&[f64; K]) -> ([f64; K], [[f64; K]; K]),
        mut holds: impl FnMut(&[f64; K]) -> bool,
    ) -> ([f64; K], [Outcome; 1]) {
        let counted = self.counted;
        self.solver.solve_branched::<K, F>(block, x, evaluate, |x| !counted || holds(x))
    }

    fn solve_closed<const K: usize, F: Factorization<f64, K>>(
        &mut self,
        block: &Block<f64, K>,
        x: [f64; K],
        evaluate: impl FnMut(&[f64; K]) -> ([f64; K], [[f64; K]; K]),
        mut holds: impl FnMut(&[f64; K]) -> bool,
        roots: impl FnOnce(&[f64; K]) -> Roots<f64, K>,
    ) -> ([f64; K], [Outcome; 1]) {
        let counted = self.counted;
        self.solver.solve_closed::<K, F>(block, x, evaluate, |x| !counted || holds(x), roots)
    }

    fn solve_redundant<const K: usize, const M: usize>(
        &mut self,
        block: &Block<f64, K, M>,
        widths: &Widths<f64, M>,
        x: [f64; K],
        evaluate: impl FnMut(&[f64; K]) -> ([f64; M], [[f64; K]; M]),
        mut holds: impl FnMut(&[f64; K]) -> bool,
    ) -> ([f64; K], [Outcome; 1]) {
        let counted = self.counted;
        self.solver.solve_redundant::<K, M>(block, widths, x, evaluate, |x| !counted || holds(x))
    }
}

#[cfg(test)]
mod tests {
    use mbs_runtime::{Mechanism, assemble, mechanism};

    use super::Branching;

    mechanism! {
        pub mechanism Bars;
        coord crank: rad = 0.3;
        coord coupler: rad = 0.9;
        coord rocker: rad = 1.8;
        constraint closure { 0.1m*unit(crank) + 0.25m*unit(coupler) == [0.3m, 0] + 0.2m*unit(rocker); }
        drive motor: crank == 0.3 + 2*t/1s;
        branch open: sin(rocker - coupler) > 0;
    }

    #[test]
    fn formulas_are_used_without_branches_too() {
        let bars = Bars::<f64>::default();
        let guess = bars.guess(&bars.parameters());
        for (coupler, rocker) in [(0.9, 1.8), (-0.9, -1.8), (3.0, 0.1), (-2.0, 2.0)] {
            let from = [guess[0], coupler, rocker];
            let found = assemble(&Branching::none(bars), from, 0.0).expect("it assembles");
            // A search from so far away takes more than what polishes a formula.
            assert!(!found.statistics.fallback && found.statistics.evaluations <= 3, "{found:?}");
            let declared = assemble(&Branching::declared(bars), from, 0.0).expect("it assembles");
            assert!((declared.q[2] - declared.q[1]).sin() > 0.0);
        }
    }
}
