//! A mechanism as if its text declared no branch.

use mbs_runtime::{
    Block, BlockSolver, Entry, Factorization, FunctionEntry, Kinematic, Margin, Mechanism, Outcome, Roots,
};

/// The mechanism `S` without its branch conditions: any assembly is right.
#[derive(Clone, Copy, Debug)]
pub struct Branchless<S>(pub S);

impl<S: Kinematic<f64, N, M>, const N: usize, const M: usize> Mechanism<f64, N, M> for Branchless<S> {
    type Parameters = S::Parameters;
    type Position = S::Position;
    type Entries = S::Entries;
    type Branches = [f64; 0];
    type Limits = S::Limits;
    type Phases = S::Phases;
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
    const BRANCHES: &'static [Entry] = &[];
    const LIMITS: &'static [Entry] = S::LIMITS;
    const PHASES: &'static [Entry] = S::PHASES;
    const OUTPUTS: &'static [Entry] = S::OUTPUTS;
    const FUNCTIONS: &'static [FunctionEntry] = S::FUNCTIONS;

    fn get(&self, index: usize) -> Option<f64> {
        self.0.get(index)
    }
    fn set(&mut self, index: usize, value: f64) -> bool {
        self.0.set(index, value)
    }
    fn lane(&self, lane: usize) -> S::Lane {
        self.0.lane(lane)
    }
    fn phases(&self) -> S::Phases {
        self.0.phases()
    }
    fn set_phases(&mut self, phases: S::Phases) {
        self.0.set_phases(phases);
    }
    fn start_phases(&mut self, q: &[f64; N], t: f64) {
        self.0.start_phases(q, t);
    }
    fn advance_phases(&mut self, from: f64, to: f64) {
        self.0.advance_phases(from, to);
    }
    fn phase_rates(&self, t: f64) -> S::Phases {
        self.0.phase_rates(t)
    }
    fn parameters(&self) -> S::Parameters {
        self.0.parameters()
    }
    fn guess(&self, parameters: &S::Parameters) -> [f64; N] {
        self.0.guess(parameters)
    }
    fn coordinate_scales(&self, parameters: &S::Parameters) -> [f64; N] {
        self.0.coordinate_scales(parameters)
    }
    fn row_scales(&self, parameters: &S::Parameters) -> [f64; M] {
        self.0.row_scales(parameters)
    }
    fn position(&self, parameters: &S::Parameters, q: &[f64; N], t: f64) -> S::Position {
        self.0.position(parameters, q, t)
    }
    fn phi(&self, parameters: &S::Parameters, position: &S::Position) -> [f64; M] {
        self.0.phi(parameters, position)
    }
    fn phi_q(&self, parameters: &S::Parameters, position: &S::Position) -> [[f64; N]; M] {
        self.0.phi_q(parameters, position)
    }
    fn phi_q_entries(&self, parameters: &S::Parameters, position: &S::Position) -> S::Entries {
        self.0.phi_q_entries(parameters, position)
    }
    fn phi_t(&self, parameters: &S::Parameters, position: &S::Position) -> [f64; M] {
        self.0.phi_t(parameters, position)
    }
    fn phi_tt(&self, parameters: &S::Parameters, position: &S::Position) -> [f64; M] {
        self.0.phi_tt(parameters, position)
    }
    fn phi_qt_qd(&self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N]) -> [f64; M] {
        self.0.phi_qt_qd(parameters, position, qd)
    }
    fn gamma(&self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N]) -> [f64; M] {
        self.0.gamma(parameters, position, qd)
    }
    fn branches(&self, _: &S::Parameters, _: &S::Position) -> [f64; 0] {
        []
    }
    fn limits(&self, parameters: &S::Parameters, position: &S::Position) -> S::Limits {
        self.0.limits(parameters, position)
    }
    fn outputs(
        &self,
        parameters: &S::Parameters,
        position: &S::Position,
        qd: &[f64; N],
        qdd: &[f64; N],
    ) -> S::Outputs {
        self.0.outputs(parameters, position, qd, qdd)
    }
}

impl<S: Kinematic<f64, N, M>, const N: usize, const M: usize> Kinematic<f64, N, M> for Branchless<S> {
    type Factors = S::Factors;

    fn solve_blocks<B: BlockSolver<f64>>(
        &self,
        parameters: &S::Parameters,
        q: &mut [f64; N],
        t: f64,
        solver: &mut B,
    ) -> [Outcome; 1] {
        self.0.solve_blocks(parameters, q, t, &mut Blind(solver))
    }
    fn factorize(&self, parameters: &S::Parameters, position: &S::Position) -> (S::Factors, Margin<f64>) {
        self.0.factorize(parameters, position)
    }
    fn solve_linear(&self, factors: &S::Factors, b: &[f64; M]) -> [f64; N] {
        self.0.solve_linear(factors, b)
    }
}

/// A solver that no block tells which branches it decides.
struct Blind<'a, B>(&'a mut B);

impl<B: BlockSolver<f64>> BlockSolver<f64> for Blind<'_, B> {
    fn solve<const K: usize, F: Factorization<f64, K>>(
        &mut self,
        block: &Block<f64, K>,
        x: [f64; K],
        evaluate: impl FnMut(&[f64; K]) -> ([f64; K], [[f64; K]; K]),
    ) -> ([f64; K], [Outcome; 1]) {
        self.0.solve::<K, F>(block, x, evaluate)
    }

    fn solve_closed<const K: usize, F: Factorization<f64, K>>(
        &mut self,
        block: &Block<f64, K>,
        x: [f64; K],
        evaluate: impl FnMut(&[f64; K]) -> ([f64; K], [[f64; K]; K]),
        _holds: impl FnMut(&[f64; K]) -> bool,
        roots: impl FnOnce(&[f64; K]) -> Roots<f64, K>,
    ) -> ([f64; K], [Outcome; 1]) {
        self.0.solve_closed::<K, F>(block, x, evaluate, |_| true, roots)
    }

    fn solve_redundant<const K: usize, const M: usize>(
        &mut self,
        block: &Block<f64, K, M>,
        x: [f64; K],
        evaluate: impl FnMut(&[f64; K]) -> ([f64; M], [[f64; K]; M]),
        _holds: impl FnMut(&[f64; K]) -> bool,
    ) -> ([f64; K], [Outcome; 1]) {
        self.0.solve_redundant::<K, M>(block, x, evaluate, |_| true)
    }
}

#[cfg(test)]
mod tests {
    use mbs_runtime::{Mechanism, assemble, mechanism};

    use super::Branchless;

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
            let found = assemble(&Branchless(bars), from, 0.0).expect("it assembles");
            // A search from so far away takes more than what polishes a formula.
            assert!(!found.statistics.fallback && found.statistics.evaluations <= 3, "{found:?}");
            let declared = assemble(&bars, from, 0.0).expect("it assembles");
            assert!((declared.q[2] - declared.q[1]).sin() > 0.0);
        }
    }
}
