//! Blocks that the assembly takes from formulas of both their positions, where plain Newton would iterate.

use mbs_runtime::{
    Block, BlockSolver, Factorization, Kinematic, Outcome, Roots, Safeguarded, Widths, diagnosis,
};

/// A block with the positions that formulas give it.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    /// Indices of its coordinates.
    pub coordinates: Vec<usize>,
    /// Both positions, in the order of the coordinates; none where the block does not reach.
    pub positions: Option<[Vec<f64>; 2]>,
    /// The position that the assembly takes.
    pub taken: Vec<f64>,
}

/// What the formulas say on the way of [`mbs_runtime::assemble()`] from `guess` (N) at `t` (s), in the order of solution.
pub fn formulas<S: Kinematic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    guess: &[f64; N],
    t: f64,
) -> Vec<Formula> {
    let mut mechanism = mechanism.clone();
    mechanism.start_phases(guess, t);
    let parameters = mechanism.parameters();
    let extent = diagnosis::extent(guess, &mechanism.coordinate_scales(&parameters));
    let mut watched = Watched { solver: Safeguarded::new(extent), formulas: Vec::new() };
    mechanism.solve_blocks(&parameters, &mut guess.clone(), t, &mut watched);
    watched.formulas
}

/// The assembly's solver, its formulas written down.
struct Watched {
    solver: Safeguarded<f64>,
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

#[cfg(test)]
mod tests {
    use crate::registry::find;

    #[test]
    fn the_four_bar_has_two_mirrored_positions_and_the_assembly_takes_the_declared_one() {
        let mechanism = (find("four_bar").expect("in the list").make)();
        let experiment = mechanism.experiment();
        for mirror in [1.0, -1.0] {
            let guess: Vec<f64> = experiment.guess().iter().map(|q| mirror * q).collect();
            let [formula] = &experiment.formulas(&guess, 0.0)[..] else { panic!("one dyad") };
            let [first, second] = formula.positions.as_ref().expect("the bars reach");
            assert!(first.iter().zip(second).all(|(a, b)| (a + b).sin().abs() < 1e-12), "{formula:?}");
            let assembled = experiment.assembled(&guess, 0.0, true).expect("it assembles");
            let taken: Vec<f64> = formula.coordinates.iter().map(|index| assembled[*index]).collect();
            assert_eq!(formula.taken, taken);
        }
    }

    #[test]
    fn bars_that_do_not_reach_have_no_position() {
        let mut mechanism = (find("four_bar").expect("in the list").make)();
        crate::registry::set(mechanism.as_mut(), "L2", 0.05).expect("a parameter");
        let experiment = mechanism.experiment();
        let [formula] = &experiment.formulas(&experiment.guess(), 0.0)[..] else { panic!("one dyad") };
        assert!(formula.positions.is_none(), "{formula:?}");
    }
}
