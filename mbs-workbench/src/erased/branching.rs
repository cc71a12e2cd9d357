//! A mechanism whose branch conditions are switched at run time: its solver is compiled once for both cases.

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

/// Hands the constants of a mechanism with their types to a macro, but for `HAS_SIGNALS`.
macro_rules! constants {
    ($apply:ident) => {
        $apply! {
            const NAME: &'static str;
            const SCENE: &'static str;
            const SOURCE: &'static str;
            const COORDINATES: &'static [Entry];
            const ROWS: &'static [Entry];
            const REDUNDANT: &'static [bool];
            const SPARSITY: &'static [(u16, u16)];
            const VARIABLES: &'static [Entry];
            const ANGLES: &'static [u16];
            const TURNING_INPUTS: &'static [u16];
            const FOLDING: &'static [u16];
            const REFERENCE: Reference;
            const BRANCHES: &'static [Entry];
            const BRANCHES_AT_START: &'static [bool];
            const LIMITS: &'static [Entry];
            const PHASES: &'static [Entry];
            const TURNS: &'static [u16];
            const OUTPUTS: &'static [Entry];
            const FUNCTIONS: &'static [FunctionEntry];
        }
    };
}

/// Constants of `S`, and functions of the field `mechanism` under their own names.
macro_rules! forward {
    () => {};
    (const $name:ident: $type:ty; $($rest:tt)*) => {
        const $name: $type = S::$name;
        forward! { $($rest)* }
    };
    (fn $name:ident(mut self $(, $argument:ident: $type:ty)*) $(-> $found:ty)?; $($rest:tt)*) => {
        fn $name(&mut self $(, $argument: $type)*) $(-> $found)? {
            self.mechanism.$name($($argument),*)
        }
        forward! { $($rest)* }
    };
    (fn $name:ident(self $(, $argument:ident: $type:ty)*) $(-> $found:ty)?; $($rest:tt)*) => {
        fn $name(&self $(, $argument: $type)*) $(-> $found)? {
            self.mechanism.$name($($argument),*)
        }
        forward! { $($rest)* }
    };
}

pub(super) use {constants, forward};

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

    constants!(forward);
    const HAS_SIGNALS: bool = S::HAS_SIGNALS;

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
        fn limits(self, parameters: &S::Parameters, position: &S::Position) -> S::Limits;
        fn outputs(self, parameters: &S::Parameters, position: &S::Position, qd: &[f64; N], qdd: &[f64; N]) -> S::Outputs;
    }

    fn carry_signals(&mut self, start: &Self, h: f64) {
        self.mechanism.carry_signals(&start.mechanism, h);
    }
    fn branches(&self, parameters: &S::Parameters, position: &S::Position) -> Counted<S::Branches> {
        Counted(self.counted.then(|| self.mechanism.branches(parameters, position)))
    }
}

impl<S: Kinematic<f64, N, M>, const N: usize, const M: usize> Kinematic<f64, N, M> for Branching<S> {
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

/// A solver that accepts any position if branches do not count. A block is known to it by its size alone, so that solvers off the
/// critical path of a step are compiled once for all blocks of all mechanisms.
pub(crate) struct Judging<'a, B> {
    solver: &'a mut B,
    counted: bool,
}

impl<'a, B> Judging<'a, B> {
    /// `solver` with the branches of the text.
    pub(crate) fn declared(solver: &'a mut B) -> Self {
        Judging { solver, counted: true }
    }
}

/// Residuals (M) and Jacobian of a block of K coordinates.
type Evaluated<const K: usize, const M: usize = K> = ([f64; M], [[f64; K]; M]);

impl<B: BlockSolver<f64>> BlockSolver<f64> for Judging<'_, B> {
    const INLINED_PER_BLOCK: bool = B::INLINED_PER_BLOCK;

    fn solve<const K: usize, F: Factorization<f64, K>>(
        &mut self,
        block: &Block<f64, K>,
        x: [f64; K],
        mut evaluate: impl FnMut(&[f64; K]) -> Evaluated<K>,
    ) -> ([f64; K], [Outcome; 1]) {
        if B::INLINED_PER_BLOCK {
            return self.solver.solve::<K, F>(block, x, evaluate);
        }
        let evaluate: &mut dyn FnMut(&[f64; K]) -> Evaluated<K> = &mut evaluate;
        self.solver.solve::<K, F>(block, x, evaluate)
    }

    fn solve_branched<const K: usize, F: Factorization<f64, K>>(
        &mut self,
        block: &Block<f64, K>,
        x: [f64; K],
        mut evaluate: impl FnMut(&[f64; K]) -> Evaluated<K>,
        mut holds: impl FnMut(&[f64; K]) -> bool,
    ) -> ([f64; K], [Outcome; 1]) {
        let counted = self.counted;
        let mut holds = |x: &[f64; K]| !counted || holds(x);
        if B::INLINED_PER_BLOCK {
            return self.solver.solve_branched::<K, F>(block, x, evaluate, holds);
        }
        let evaluate: &mut dyn FnMut(&[f64; K]) -> Evaluated<K> = &mut evaluate;
        let holds: &mut dyn FnMut(&[f64; K]) -> bool = &mut holds;
        self.solver.solve_branched::<K, F>(block, x, evaluate, holds)
    }

    fn solve_closed<const K: usize, F: Factorization<f64, K>>(
        &mut self,
        block: &Block<f64, K>,
        x: [f64; K],
        mut evaluate: impl FnMut(&[f64; K]) -> Evaluated<K>,
        mut holds: impl FnMut(&[f64; K]) -> bool,
        roots: impl FnOnce(&[f64; K]) -> Roots<f64, K>,
    ) -> ([f64; K], [Outcome; 1]) {
        let counted = self.counted;
        let mut holds = |x: &[f64; K]| !counted || holds(x);
        if B::INLINED_PER_BLOCK {
            return self.solver.solve_closed::<K, F>(block, x, evaluate, holds, roots);
        }
        let mut roots = Some(roots);
        let mut roots = |near: &[f64; K]| roots.take().expect("a formula is evaluated once")(near);
        let evaluate: &mut dyn FnMut(&[f64; K]) -> Evaluated<K> = &mut evaluate;
        let holds: &mut dyn FnMut(&[f64; K]) -> bool = &mut holds;
        let roots: &mut dyn FnMut(&[f64; K]) -> Roots<f64, K> = &mut roots;
        self.solver.solve_closed::<K, F>(block, x, evaluate, holds, roots)
    }

    fn solve_redundant<const K: usize, const M: usize>(
        &mut self,
        block: &Block<f64, K, M>,
        widths: &Widths<f64, M>,
        x: [f64; K],
        mut evaluate: impl FnMut(&[f64; K]) -> Evaluated<K, M>,
        mut holds: impl FnMut(&[f64; K]) -> bool,
    ) -> ([f64; K], [Outcome; 1]) {
        let counted = self.counted;
        let mut holds = |x: &[f64; K]| !counted || holds(x);
        if B::INLINED_PER_BLOCK {
            return self.solver.solve_redundant::<K, M>(block, widths, x, evaluate, holds);
        }
        let evaluate: &mut dyn FnMut(&[f64; K]) -> Evaluated<K, M> = &mut evaluate;
        let holds: &mut dyn FnMut(&[f64; K]) -> bool = &mut holds;
        self.solver.solve_redundant::<K, M>(block, widths, x, evaluate, holds)
    }
}

#[cfg(test)]
mod tests {
    use mbs_runtime::{assemble, mechanism};

    use super::*;
    use crate::verify::StandIn;

    mechanism! {
        pub mechanism Bars;
        coord crank: rad = 0.3;
        coord coupler: rad = 0.9;
        coord rocker: rad = 1.8;
        constraint closure { 0.1m*unit(crank) + 0.25m*unit(coupler) == [0.3m, 0] + 0.2m*unit(rocker); }
        drive motor: crank == 0.3 + 2*t/1s;
        branch open: sin(rocker - coupler) > 0;
    }

    mechanism! {
        pub mechanism Everything;
        param L: m = 0.4;
        input wind: 1, rates;
        function lift: m(rad), C3;
        coord a: rad = 0.2;
        coord wheel: turn = 0;
        coord x: m = 0.1;
        coord y: m = 0.3;
        constraint a_row { x == L*sin(a) + 0.01m*wind; }
        constraint again redundant { 2*x == 2*L*sin(a) + 0.02m*wind; }
        constraint height { y == lift(a); }
        drive motor: a == 0.2 + 0.1*wind;
        drive spin: rate(wheel) == 2 [rad/s];
        branch near: x < 1m;
        limit reach: 0m <= x <= 0.9m;
        out P: [m; 2] = [x, y];
    }

    /// Every constant of the wrapper is that of the mechanism.
    fn assert_constants<S: Kinematic<f64, N, M>, const N: usize, const M: usize>(_: S) {
        macro_rules! compare {
            ($(const $name:ident: $type:ty;)*) => {
                $(assert_eq!(
                    format!("{:?}", <Branching<S> as Mechanism<f64, N, M>>::$name),
                    format!("{:?}", S::$name),
                    stringify!($name)
                );)*
            };
        }
        constants!(compare);
        assert_eq!(<Branching<S> as Mechanism<f64, N, M>>::HAS_SIGNALS, S::HAS_SIGNALS);
        assert_eq!(<Branching<S> as Kinematic<f64, N, M>>::BLOCK_BY_BLOCK, S::BLOCK_BY_BLOCK);
        assert_eq!(<Branching<S> as Kinematic<f64, N, M>>::HAS_CIRCLES, S::HAS_CIRCLES);
        assert_eq!(<Branching<S> as Kinematic<f64, N, M>>::HAS_ORDERS, S::HAS_ORDERS);
    }

    #[test]
    fn every_constant_and_function_of_the_mechanism_is_forwarded() {
        assert_constants(Bars::<f64>::default());
        assert_constants(Everything::new(StandIn::<0>));
        // Those with a standard in the trait would be missed in silence.
        let contract = include_str!("../../../mbs-runtime/src/mechanism/mod.rs");
        let contract = &contract[contract.find("pub trait Mechanism<").expect("the trait")..];
        let contract = &contract[..contract.find("\n}\n").expect("its end")];
        let wrapper = include_str!("branching.rs");
        let mut count = 0;
        for line in contract.lines() {
            let Some(item) = ["    const ", "    fn "].iter().find_map(|start| line.strip_prefix(start))
            else {
                continue;
            };
            let name: String = item.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            // Made of the others.
            let composed = ["evaluate", "reference", "variable"].contains(&name.as_str());
            let is_forwarded =
                wrapper.contains(&format!("const {name}:")) || wrapper.contains(&format!("fn {name}("));
            assert!(is_forwarded || composed, "`{name}` is not forwarded");
            count += 1;
        }
        assert!(count > 45, "{count}");
    }

    #[test]
    fn formulas_are_used_without_branches_too() {
        let bars = Bars::<f64>::default();
        let guess = bars.guess(&bars.parameters());
        for (coupler, rocker) in [(0.9, 1.8), (-0.9, -1.8), (3.0, 0.1), (-2.0, 2.0)] {
            let from = [guess[0], coupler, rocker];
            let found = assemble(&Branching::none(bars), from, 0.0).expect("it assembles");
            // A search from so far away takes more iterations than the refinement of a formula.
            assert!(!found.statistics.fallback && found.statistics.evaluations <= 3, "{found:?}");
            let declared = assemble(&Branching::declared(bars), from, 0.0).expect("it assembles");
            assert!((declared.q[2] - declared.q[1]).sin() > 0.0);
        }
    }
}
