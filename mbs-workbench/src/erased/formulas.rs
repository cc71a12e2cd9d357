//! Blocks that the assembly takes from formulas of both their positions, where plain Newton would iterate.

use mbs_runtime::{
    AssemblySolver, Block, BlockSolver, Factorization, Kinematic, Outcome, Roots, Widths, extent,
};

/// A block with the positions that formulas give it.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    /// Indices of its coordinates.
    pub coordinates: Vec<usize>,
    /// Both positions, in the order of the coordinates; none if the block cannot close.
    pub positions: Option<[Vec<f64>; 2]>,
    /// The position that the assembly takes.
    pub taken: Vec<f64>,
}

/// Closed-form solutions that [`mbs_runtime::assemble()`] evaluates from `guess` (N) at `t` (s), in the order of solution.
pub fn formulas<S: Kinematic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    guess: &[f64; N],
    t: f64,
) -> Vec<Formula> {
    let mut mechanism = mechanism.clone();
    mechanism.start_phases(guess, t);
    let parameters = mechanism.parameters();
    let extent = extent(guess, &mechanism.coordinate_scales(&parameters));
    let mut watched = Watched { solver: AssemblySolver::new(extent), formulas: Vec::new() };
    mechanism.solve_blocks(&parameters, &mut guess.clone(), t, &mut watched);
    watched.formulas
}

/// The assembly's solver, with a record of its formulas.
struct Watched {
    solver: AssemblySolver<f64>,
    formulas: Vec<Formula>,
}

impl BlockSolver<f64> for Watched {
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
        holds: impl FnMut(&[f64; K]) -> bool,
    ) -> ([f64; K], [Outcome; 1]) {
        self.solver.solve_branched::<K, F>(block, x, evaluate, holds)
    }

    fn solve_closed<const K: usize, F: Factorization<f64, K>>(
        &mut self,
        block: &Block<f64, K>,
        x: [f64; K],
        evaluate: impl FnMut(&[f64; K]) -> ([f64; K], [[f64; K]; K]),
        holds: impl FnMut(&[f64; K]) -> bool,
        roots: impl FnOnce(&[f64; K]) -> Roots<f64, K>,
    ) -> ([f64; K], [Outcome; 1]) {
        let both = roots(&x);
        let (taken, outcome) = self.solver.solve_closed::<K, F>(block, x, evaluate, holds, |_| both);
        self.formulas.push(Formula {
            coordinates: block.coordinates.iter().map(|index| usize::from(*index)).collect(),
            positions: both.real.then(|| both.x.map(|x| x.to_vec())),
            taken: taken.to_vec(),
        });
        (taken, outcome)
    }

    fn solve_redundant<const K: usize, const M: usize>(
        &mut self,
        block: &Block<f64, K, M>,
        widths: &Widths<f64, M>,
        x: [f64; K],
        evaluate: impl FnMut(&[f64; K]) -> ([f64; M], [[f64; K]; M]),
        holds: impl FnMut(&[f64; K]) -> bool,
    ) -> ([f64; K], [Outcome; 1]) {
        self.solver.solve_redundant::<K, M>(block, widths, x, evaluate, holds)
    }
}
