//! Single steps of the solvers, from any guess, behind an object-safe trait.

use core::f64::consts::{PI, TAU};

use mbs_runtime::{
    Block, Entry, Failure, Kinematic, Newton, Outcome, Stepper, Trace, Traced, assemble, extent,
    newton_raphson, newton_raphson_watched, solve_position,
};

use super::formulas::{Formula, formulas};
use crate::erased::branching::{Branching, Judging};
use crate::erased::facade::{AnyMechanism, Facade, State};
use crate::motion::instants;

/// Single steps of the solvers for a mechanism of any size. Vectors are in the order of the text, with N components each.
///
/// # Panics
/// Every method, if a vector does not have N components.
pub trait Experiment {
    /// The text's guess: N.
    fn guess(&self) -> Vec<f64>;
    /// Branch conditions.
    fn branches(&self) -> &'static [Entry];
    /// Their values at `q`, `t` (s); each positive where it holds.
    fn branch_values(&self, q: &[f64], t: f64) -> Vec<f64>;
    /// The lecture's full Newton–Raphson from `q` at `t` (s): position and iterations.
    ///
    /// # Errors
    /// Those of [`mbs_runtime::newton_raphson()`].
    fn newton_raphson(&self, q: &[f64], t: f64) -> Result<(Vec<f64>, u32), Failure>;
    /// The position that [`mbs_runtime::assemble()`] finds; `branches`: `true` if the declared ones count.
    ///
    /// # Errors
    /// Those of [`mbs_runtime::assemble()`].
    fn assembled(&self, guess: &[f64], t: f64, branches: bool) -> Result<Vec<f64>, Failure>;
    /// Velocities and accelerations at a position that closes.
    ///
    /// # Errors
    /// [`Singular`](mbs_runtime::FailureKind::Singular) where they are not determined.
    fn rates(&self, q: &[f64], t: f64) -> Result<[Vec<f64>; 2], Failure>;
    /// One step of the [`Stepper`] from the position `q` at `t` to `until` (s), without branches. Returns the position, and
    /// the iterations of the block that needed the most.
    ///
    /// # Errors
    /// Those of the stepper.
    fn advance(&self, q: &[f64], t: f64, until: f64) -> Result<(Vec<f64>, u32), Failure>;
    /// Newton's iterations from `guess` at `t` (s): the runtime's, block by block, or the lecture's on all of Φ.
    fn iterations(&self, guess: &[f64], t: f64, plain: bool) -> Protocol;
    /// Blocks that the assembly from `guess` at `t` (s) takes from formulas.
    fn formulas(&self, guess: &[f64], t: f64) -> Vec<Formula>;
}

/// The iterations of a solution.
#[derive(Clone, Debug)]
pub struct Protocol {
    /// In the order of solution; coordinates that are assigned are in none.
    pub blocks: Vec<BlockProtocol>,
    /// The position found: N.
    pub found: Result<Vec<f64>, Failure>,
}

/// The iterations of one block.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockProtocol {
    /// Indices of its rows.
    pub rows: Vec<usize>,
    /// Indices of its coordinates.
    pub coordinates: Vec<usize>,
    /// Start and iterates.
    pub iterates: Vec<IterateProtocol>,
}

/// One iterate.
#[derive(Clone, Debug, PartialEq)]
pub struct IterateProtocol {
    /// Coordinates of the block.
    pub x: Vec<f64>,
    /// Length of the residuals in the reference metric.
    pub residual: f64,
    /// Length of the step from the iterate before, in the reference metric; none at the start.
    pub step: Option<f64>,
}

impl BlockProtocol {
    /// Adds an iterate; the scales are the reference metric's.
    fn push(&mut self, x: &[f64], residuals: &[f64], row_scales: &[f64], scales: &[f64]) {
        let step = self.iterates.last().map(|last| {
            let changes = x.iter().zip(&last.x).zip(scales).map(|((new, old), scale)| (new - old) / scale);
            length(changes)
        });
        let residual = length(residuals.iter().zip(row_scales).map(|(r, scale)| r / scale));
        self.iterates.push(IterateProtocol { x: x.to_vec(), residual, step });
    }

    /// Observed order of convergence at iterate `k`: ln(rₖ/rₖ₋₁)/ln(rₖ₋₁/rₖ₋₂).
    ///
    /// None before the third iterate, where residuals do not fall, and where the last one is rounding.
    pub fn order(&self, k: usize) -> Option<f64> {
        /// Residuals below 64 ε, in the reference metric, are rounding and independent of the method.
        const ROUNDING: f64 = 64.0 * f64::EPSILON;
        let residual = |k: usize| self.iterates.get(k).map(|iterate| iterate.residual);
        let (last, middle, first) =
            (residual(k)?, residual(k.checked_sub(1)?)?, residual(k.checked_sub(2)?)?);
        (ROUNDING < last && last < middle && middle < first)
            .then(|| (last / middle).ln() / (middle / first).ln())
    }
}

fn length(components: impl Iterator<Item = f64>) -> f64 {
    components.map(|component| component * component).sum::<f64>().sqrt()
}

/// Largest difference of two positions in the reference metric, angles on the circle.
pub fn difference(a: &[f64], b: &[f64], coordinates: &[Entry], scales: &[f64]) -> f64 {
    let pairs = a.iter().zip(b).zip(coordinates).zip(scales);
    let differences = pairs.map(|(((a, b), entry), scale)| match entry.is_angle() {
        true => ((a - b + PI).rem_euclid(TAU) - PI).abs(),
        false => ((a - b) / scale).abs(),
    });
    // A NaN must not look like agreement.
    differences.fold(0.0, |largest, d| if d <= largest || largest.is_nan() { largest } else { d })
}

/// The state at `t` (s), followed there from the assembly at 0 in steps of 1/720 of `duration` (s).
///
/// # Errors
/// The solver's [`Failure`] on the way.
pub fn state_at(mechanism: &dyn AnyMechanism, duration: f64, t: f64) -> Result<State, Failure> {
    /// Half a degree of a turn.
    const FINE: f64 = 720.0;
    /// A far time is reached in larger steps; the solver refuses those that are too large.
    const MOST: f64 = 200_000.0;
    let steps = (FINE * (t / duration).abs()).ceil().clamp(1.0, MOST) as usize;
    let times = if t == 0.0 { vec![0.0] } else { instants(t, steps) };
    let motion = mechanism.follow(&times, &mut |_| ())?;
    Ok(motion.last(t))
}

/// Positions nearer than this, in the reference metric, are the same assembly. That is far above the errors of solvers, 1e-14
/// and √ε at a dead centre, and far below the distance of assemblies.
pub const SAME: f64 = 1e-6;

/// Records the reports of a [`Traced`] solver.
#[derive(Default)]
struct Recorder {
    blocks: Vec<BlockProtocol>,
}

impl Trace<f64> for Recorder {
    fn block<const K: usize, const M: usize>(&mut self, block: &Block<f64, K, M>) {
        let indices = |indices: &[u16]| indices.iter().map(|index| usize::from(*index)).collect();
        let (rows, coordinates) = (indices(&block.rows), indices(&block.coordinates));
        self.blocks.push(BlockProtocol { rows, coordinates, iterates: Vec::new() });
    }

    fn iterate<const K: usize, const M: usize>(
        &mut self,
        block: &Block<f64, K, M>,
        x: &[f64; K],
        r: &[f64; M],
        _: &[[f64; K]; M],
    ) {
        if let Some(last) = self.blocks.last_mut() {
            last.push(x, r, &block.row_scales, &block.coordinate_scales);
        }
    }

    fn end(&mut self, _: &[Outcome; 1]) {}
}

impl<S: Kinematic<f64, N, M>, F, const N: usize, const M: usize> Facade<S, N, M, F> {
    fn block_by_block(&self, guess: &[f64; N], t: f64) -> Protocol {
        let parameters = self.0.parameters();
        let mut recorder = Recorder::default();
        let extent = extent(guess, &self.0.coordinate_scales(&parameters));
        let mut solver = Traced::new(Newton::new(extent), &mut recorder);
        self.0.solve_blocks(&parameters, &mut guess.clone(), t, &mut Judging::declared(&mut solver));
        // Once more for the failure itself; the solver is deterministic.
        let declared = Branching::declared(self.0.clone());
        let found = solve_position(&declared, &parameters, guess, t).map(|(q, _)| q.to_vec());
        Protocol { blocks: recorder.blocks, found }
    }

    fn all_at_once(&self, guess: &[f64; N], t: f64) -> Protocol {
        let parameters = self.0.parameters();
        let (row_scales, scales) = (self.0.row_scales(&parameters), self.0.coordinate_scales(&parameters));
        let all: Vec<usize> = (0..N).collect();
        let rows = (0..M).collect();
        let mut block = BlockProtocol { rows, coordinates: all, iterates: Vec::new() };
        let watch = |iterate: mbs_runtime::Iterate<'_, f64, N, M>| {
            block.push(iterate.q, iterate.phi, &row_scales, &scales);
        };
        let found = newton_raphson_watched(&self.0, *guess, t, watch).map(|(q, _)| q.to_vec());
        Protocol { blocks: vec![block], found }
    }
}

fn array<const N: usize>(values: &[f64]) -> [f64; N] {
    <[f64; N]>::try_from(values).expect("a vector of N components")
}

impl<S: Kinematic<f64, N, M>, F, const N: usize, const M: usize> Experiment for Facade<S, N, M, F> {
    fn guess(&self) -> Vec<f64> {
        self.0.guess(&self.0.parameters()).to_vec()
    }
    fn branches(&self) -> &'static [Entry] {
        S::BRANCHES
    }
    fn branch_values(&self, q: &[f64], t: f64) -> Vec<f64> {
        let parameters = self.0.parameters();
        let position = self.0.position(&parameters, &array(q), t);
        self.0.branches(&parameters, &position).as_ref().to_vec()
    }
    fn newton_raphson(&self, q: &[f64], t: f64) -> Result<(Vec<f64>, u32), Failure> {
        newton_raphson(&self.0, array::<N>(q), t).map(|(q, iterations)| (q.to_vec(), iterations))
    }
    fn assembled(&self, guess: &[f64], t: f64, branches: bool) -> Result<Vec<f64>, Failure> {
        let guess = array::<N>(guess);
        let mechanism = self.0.clone();
        let mechanism = if branches { Branching::declared(mechanism) } else { Branching::none(mechanism) };
        assemble(&mechanism, guess, t).map(|assembled| assembled.q.to_vec())
    }
    fn rates(&self, q: &[f64], t: f64) -> Result<[Vec<f64>; 2], Failure> {
        let stepper = Stepper::assemble(Branching::none(self.0.clone()), array::<N>(q), t)?;
        Ok([stepper.qd().to_vec(), stepper.qdd().to_vec()])
    }
    fn advance(&self, q: &[f64], t: f64, until: f64) -> Result<(Vec<f64>, u32), Failure> {
        let mut stepper = Stepper::assemble(Branching::none(self.0.clone()), array::<N>(q), t)?;
        let statistics = stepper.advance_to(until)?;
        // The first evaluation is that of the start.
        Ok((stepper.q().to_vec(), statistics.evaluations.saturating_sub(1)))
    }
    fn iterations(&self, guess: &[f64], t: f64, plain: bool) -> Protocol {
        let guess = array(guess);
        if plain { self.all_at_once(&guess, t) } else { self.block_by_block(&guess, t) }
    }
    fn formulas(&self, guess: &[f64], t: f64) -> Vec<Formula> {
        formulas(&self.0, &array(guess), t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_do_not_make_a_difference_and_nan_does() {
        let entry = |unit| Entry { name: "x", unit, line: 0 };
        let entries = [entry("rad"), entry("m")];
        assert!(difference(&[0.1, 1.0], &[0.1 + TAU, 1.0], &entries, &[1.0, 2.0]) < 1e-15);
        assert_eq!(difference(&[0.1, 1.0], &[0.1, 2.0], &entries, &[1.0, 2.0]), 0.5);
        assert!(difference(&[f64::NAN, 1.0], &[0.1, 1.0], &entries, &[1.0, 2.0]).is_nan());
    }
}
