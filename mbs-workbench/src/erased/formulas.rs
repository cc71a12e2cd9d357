//! Blocks that the assembly takes from formulas of both their positions, where plain Newton would iterate.

use crate::erased::branching::Judging;
use mbs_runtime::{AssemblySolver, Block, Kinematic, Outcome, Roots, Trace, Traced, extent};

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
    let mut record = Record(Vec::new());
    let mut solver = Traced::new(AssemblySolver::new(extent), &mut record);
    mechanism.solve_blocks(&parameters, &mut guess.clone(), t, &mut Judging::declared(&mut solver));
    record.0
}

/// Formulas that the assembly's solver evaluated.
struct Record(Vec<Formula>);

impl Trace<f64> for Record {
    fn block<const K: usize, const M: usize>(&mut self, _: &Block<f64, K, M>) {}

    fn iterate<const K: usize, const M: usize>(
        &mut self,
        _: &Block<f64, K, M>,
        _: &[f64; K],
        _: &[f64; M],
        _: &[[f64; K]; M],
    ) {
    }

    fn formula<const K: usize>(&mut self, block: &Block<f64, K>, roots: &Roots<f64, K>, taken: &[f64; K]) {
        self.0.push(Formula {
            coordinates: block.coordinates.iter().map(|index| usize::from(*index)).collect(),
            positions: roots.real.then(|| roots.x.map(|x| x.to_vec())),
            taken: taken.to_vec(),
        });
    }

    fn end(&mut self, _: &[Outcome; 1]) {}
}
