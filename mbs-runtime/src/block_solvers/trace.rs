//! Watching a solver at work: each iterate of each block, for teaching and for diagnosis.

use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::redundant_widths::Widths;
use crate::mechanism::block::{Block, BlockSolver};
use crate::mechanism::outcome::Outcome;
use crate::mechanism::roots::Roots;
use crate::scalar::number::Scalar;

/// Observer of a [`Traced`] solver.
pub trait Trace<T: Scalar> {
    /// A nonlinear block begins; blocks that are assigned are not solved and not heard.
    fn block<const K: usize, const M: usize>(&mut self, block: &Block<T, K, M>);
    /// Residuals (M) and Jacobian (M rows of K) of that block were evaluated at `x` (K).
    fn iterate<const K: usize, const M: usize>(
        &mut self,
        block: &Block<T, K, M>,
        x: &[T; K],
        residuals: &[T; M],
        jacobian: &[[T; K]; M],
    );
    /// The solver asked for both positions of that block by its formula, and ends at `taken` (K).
    fn formula<const K: usize>(&mut self, _block: &Block<T, K>, _roots: &Roots<T, K>, _taken: &[T; K]) {}
    /// The block ended, lane by lane.
    fn end(&mut self, outcome: &T::Lanes<Outcome>);
}

/// A solver whose every evaluation is told to a [`Trace`]; its results are those of the inner solver.
///
/// Trial steps that the inner solver rejects are told too.
#[derive(Debug)]
pub struct Traced<'a, S, L> {
    solver: S,
    trace: &'a mut L,
}

impl<'a, S, L> Traced<'a, S, L> {
    /// `solver`, watched by `trace`.
    pub fn new(solver: S, trace: &'a mut L) -> Self {
        Traced { solver, trace }
    }

    /// The inner solver, for its diagnosis.
    pub fn solver(&self) -> &S {
        &self.solver
    }
}

/// `evaluate` of a block that begins, with each of its results told to `trace`.
fn told<T: Scalar, L: Trace<T>, const K: usize, const M: usize>(
    trace: &mut L,
    block: &Block<T, K, M>,
    mut evaluate: impl FnMut(&[T; K]) -> ([T; M], [[T; K]; M]),
) -> impl FnMut(&[T; K]) -> ([T; M], [[T; K]; M]) {
    trace.block(block);
    move |x| {
        let (residuals, jacobian) = evaluate(x);
        trace.iterate(block, x, &residuals, &jacobian);
        (residuals, jacobian)
    }
}

impl<T: Scalar, S: BlockSolver<T>, L: Trace<T>> BlockSolver<T> for Traced<'_, S, L> {
    fn solve<const K: usize, F: Factorization<T, K>>(
        &mut self,
        block: &Block<T, K>,
        x: [T; K],
        evaluate: impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
    ) -> ([T; K], T::Lanes<Outcome>) {
        let (x, outcome) = self.solver.solve::<K, F>(block, x, told(self.trace, block, evaluate));
        self.trace.end(&outcome);
        (x, outcome)
    }

    fn solve_branched<const K: usize, F: Factorization<T, K>>(
        &mut self,
        block: &Block<T, K>,
        x: [T; K],
        evaluate: impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
        holds: impl FnMut(&[T; K]) -> T::Mask,
    ) -> ([T; K], T::Lanes<Outcome>) {
        let evaluate = told(self.trace, block, evaluate);
        let (x, outcome) = self.solver.solve_branched::<K, F>(block, x, evaluate, holds);
        self.trace.end(&outcome);
        (x, outcome)
    }

    fn solve_closed<const K: usize, F: Factorization<T, K>>(
        &mut self,
        block: &Block<T, K>,
        x: [T; K],
        evaluate: impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
        holds: impl FnMut(&[T; K]) -> T::Mask,
        roots: impl FnOnce(&[T; K]) -> Roots<T, K>,
    ) -> ([T; K], T::Lanes<Outcome>) {
        let evaluate = told(self.trace, block, evaluate);
        let mut asked = None;
        let roots = |x: &[T; K]| *asked.insert(roots(x));
        let (x, outcome) = self.solver.solve_closed::<K, F>(block, x, evaluate, holds, roots);
        if let Some(roots) = asked {
            self.trace.formula(block, &roots, &x);
        }
        self.trace.end(&outcome);
        (x, outcome)
    }

    fn solve_redundant<const K: usize, const M: usize>(
        &mut self,
        block: &Block<T, K, M>,
        widths: &Widths<T, M>,
        x: [T; K],
        evaluate: impl FnMut(&[T; K]) -> ([T; M], [[T; K]; M]),
        holds: impl FnMut(&[T; K]) -> T::Mask,
    ) -> ([T; K], T::Lanes<Outcome>) {
        let evaluate = told(self.trace, block, evaluate);
        let (x, outcome) = self.solver.solve_redundant::<K, M>(block, widths, x, evaluate, holds);
        self.trace.end(&outcome);
        (x, outcome)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block_solvers::newton::Newton;
    use crate::linear_algebra::direct1::Direct1;

    /// Residuals in the order of the iterates, and the outcome.
    struct Heard {
        blocks: usize,
        residuals: [f64; 8],
        count: usize,
        outcome: Option<Outcome>,
    }

    impl Trace<f64> for Heard {
        fn block<const K: usize, const M: usize>(&mut self, _: &Block<f64, K, M>) {
            self.blocks += 1;
        }
        fn iterate<const K: usize, const M: usize>(
            &mut self,
            _: &Block<f64, K, M>,
            _: &[f64; K],
            r: &[f64; M],
            _: &[[f64; K]; M],
        ) {
            self.residuals[self.count] = r[0];
            self.count += 1;
        }
        fn end(&mut self, outcome: &[Outcome; 1]) {
            self.outcome = Some(outcome[0]);
        }
    }

    fn parabola(x: &[f64; 1]) -> ([f64; 1], [[f64; 1]; 1]) {
        ([x[0] * x[0] - 2.0], [[2.0 * x[0]]])
    }

    #[test]
    fn every_iterate_is_heard_and_nothing_changes() {
        let block = Block {
            rows: [0],
            coordinates: [0],
            angles: [false],
            row_scales: [1.0],
            coordinate_scales: [1.0],
        };
        let mut heard = Heard { blocks: 0, residuals: [0.0; 8], count: 0, outcome: None };
        let mut traced = Traced::new(Newton::new(1.0), &mut heard);
        let (x, outcome) = traced.solve::<1, Direct1<f64>>(&block, [1.0], parabola);
        let evaluations = traced.solver().diagnosis().evaluations;
        let plain = Newton::new(1.0).solve::<1, Direct1<f64>>(&block, [1.0], parabola);
        assert_eq!((x, outcome), plain);
        assert_eq!(
            (heard.blocks, heard.count, heard.outcome),
            (1, evaluations as usize, Some(Outcome::Converged))
        );
        assert_eq!(heard.residuals[..3], [-1.0, 0.25, 0.006944444444444642]);
    }
}
