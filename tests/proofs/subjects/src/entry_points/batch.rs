//! Mechanisms side by side.

use mbs_runtime::{Batch, Failure, Kinematic, Lanes, Real, Statistics, Stepper};

entry_points! {
    /// The first positions.
    fn assemble[
        S: Kinematic<Lanes<R, L>, N, M>, R: Real, const L: usize, const N: usize, const M: usize
    ](mechanism: S, guess: &[[R; N]; L], t: [R; L]) -> Result<Batch<S, R, L, N, M>, (usize, Failure)>
    where [S::Lane: Kinematic<R, N, M>] {
        Batch::assemble(mechanism, guess, t)
    }
    /// The first positions of the lanes that have one.
    fn assemble_each[
        S: Kinematic<Lanes<R, L>, N, M>, R: Real, const L: usize, const N: usize, const M: usize
    ](mechanism: S, guess: &[[R; N]; L], t: [R; L]) -> Result<Batch<S, R, L, N, M>, [Failure; L]>
    where [S::Lane: Kinematic<R, N, M>] {
        Batch::assemble_each(mechanism, guess, t)
    }
    /// A lane that is out.
    fn retire[
        S: Kinematic<Lanes<R, L>, N, M>, R: Real, const L: usize, const N: usize, const M: usize
    ](batch: &mut Batch<S, R, L, N, M>, lane: usize, failure: Failure) -> bool
    where [S::Lane: Kinematic<R, N, M>] {
        batch.retire(lane, failure);
        batch.failures().iter().any(Option::is_some)
    }
    /// A lane that is in again.
    fn revive[
        S: Kinematic<Lanes<R, L>, N, M>, R: Real, const L: usize, const N: usize, const M: usize
    ](batch: &mut Batch<S, R, L, N, M>, lane: usize, guess: &[R; N], t: R) -> Result<(), Failure>
    where [S::Lane: Kinematic<R, N, M>] {
        batch.revive(lane, guess, t)
    }
    /// A step in all lanes.
    fn advance_to[
        S: Kinematic<Lanes<R, L>, N, M>, R: Real, const L: usize, const N: usize, const M: usize
    ](batch: &mut Batch<S, R, L, N, M>, t: [R; L]) -> [Result<Statistics, Failure>; L]
    where [S::Lane: Kinematic<R, N, M>] {
        batch.advance_to(t)
    }
    /// A change of a variable in all lanes.
    fn change[
        S: Kinematic<Lanes<R, L>, N, M>, R: Real, const L: usize, const N: usize, const M: usize
    ](batch: &mut Batch<S, R, L, N, M>, index: usize, value: Lanes<R, L>) -> bool
    where [S::Lane: Kinematic<R, N, M>] {
        batch.change(|mechanism| mechanism.set(index, value))
    }
    /// One lane alone.
    fn stepper[
        S: Kinematic<Lanes<R, L>, N, M>, R: Real, const L: usize, const N: usize, const M: usize
    ](batch: &Batch<S, R, L, N, M>, lane: usize) -> Option<Stepper<S::Lane, R, N, M>>
    where [S::Lane: Kinematic<R, N, M>] {
        batch.stepper(lane)
    }
}
