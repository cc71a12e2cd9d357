//! The first position: from a guess, in the declared assembly.

use crate::block_solvers::convergence::Statistics;
use crate::block_solvers::levenberg_marquardt::AssemblySolver;
use crate::block_solvers::multistart;
use crate::failure::checks::{coordinate_failure, non_finite, time_failure, variable_failure};
use crate::failure::{Failure, FailureKind};
use crate::kinematics::least_squares_assembly::not_assemblable;
use crate::kinematics::position::{branch_failure, position_failure};
use crate::linear_algebra::vectors::extent;
use crate::mechanism::Kinematic;
use crate::scalar::number::Real;

/// Starts besides the guess for the mechanism as a whole. Each block searches its own declared branches already
/// (see [`AssemblySolver`]); these are for branches that an earlier block without one has spoilt.
const OTHER_STARTS: u32 = 8;

/// A mechanism at rest in its first position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assembled<R, const N: usize> {
    /// Coordinates: N.
    pub q: [R; N],
    /// Effort and residual of the start that succeeded.
    pub statistics: Statistics,
    /// Index of the start that succeeded: 0 for the guess itself, 1 … 8 for the others.
    pub start: u32,
}

/// Solves Φ(q, t) = 0 from `guess` (N) at time `t` (s) such that every declared branch holds.
///
/// The guess comes first. Where it fails or leads to another assembly, a fixed list of starts around it is tried. They are up
/// to π away in angles, two reference lengths in lengths. Each block is searched first, against the branches that it decides,
/// then the mechanism as a whole. Angles are as the solver found them: whole turns of the guess are kept, none is taken off.
/// A drive that prescribes a rate holds its coordinate at the guess. If drives alone hold the pivots of a dyad too far apart,
/// no other start is tried.
///
/// ```
/// use mbs_runtime::{assemble, mechanism};
///
/// # mechanism! {
/// #     /// A crank and a rod that slides along x.
/// #     pub mechanism Crank;
/// #     param r: m = 50mm;
/// #     coord theta: rad = 0;
/// #     coord phi: rad = 0;
/// #     coord x: m = 0.23;
/// #     constraint closure { r*unit(theta) + 180mm*unit(phi) == [x, 0]; }
/// #     drive motor: theta == 30 [rad/s]*t;
/// #     branch ahead: cos(phi) > 0;
/// # }
///
/// let crank: Crank = Crank::default();
/// let found = assemble(&crank, [0.0, 3.0, -0.1], 0.01)?; // a guess in the other assembly
/// assert!(found.q[1].cos() > 0.0 && (found.q[2] - 0.227159).abs() < 1e-6);
///
/// let long: Crank = Crank { r: 0.25, ..Crank::default() };
/// let failure = assemble(&long, [0.0, 0.0, 0.2], 0.05).expect_err("0.25 m sin(1.5) is longer than the rod");
/// assert!(failure.to_string().contains("`closure.")); // the row that stays open
/// # Ok::<(), mbs_runtime::Failure>(())
/// ```
///
/// # Errors
/// [`FailureKind::NonFinite`] for a guess, parameter, input or time that is no number, or a row that is none from every
/// start; [`FailureKind::Unresolved`] for a guess too large to tell positions apart by; [`FailureKind::WrongBranch`] where
/// positions were found but none in the declared assembly; [`FailureKind::NotAssemblable`] with the least residual found and
/// the rows that hold it; [`FailureKind::Inconsistent`] where these are rows of a block with fewer coordinates than rows.
pub fn assemble<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    guess: impl Into<[R; N]>,
    t: R,
) -> Result<Assembled<R, N>, Failure> {
    let guess = guess.into();
    let broken = non_finite(&guess, S::COORDINATES).or(variable_failure(mechanism)).or(time_failure(t));
    if let Some(failure) = broken {
        return Err(failure);
    }
    let mut mechanism = mechanism.clone();
    mechanism.start_phases(&guess, t);
    let mechanism = &mechanism;
    let parameters = mechanism.parameters();
    let scales = mechanism.coordinate_scales(&parameters);
    if let Some(failure) = coordinate_failure::<S, R, N, M>(&guess, &scales, t) {
        return Err(failure);
    }
    let mut search = Search { least: f64::INFINITY, open: None, wrong: None, hopeless: false };
    for start in 0..=OTHER_STARTS {
        let from = displaced::<S, R, N, M>(mechanism, &parameters, &guess, start);
        match search.attempt(mechanism, &parameters, from, t) {
            Some((q, statistics)) => return Ok(Assembled { q, statistics, start }),
            None if search.hopeless => break,
            None => continue,
        }
    }
    // A wrong assembly outranks a start that led nowhere: the mechanism can be put together.
    Err(search.wrong.or(search.open).unwrap_or(FailureKind::NonFinite { name: "t", line: 0 }.without_time()))
}

/// Results of the starts so far.
struct Search {
    least: f64,
    open: Option<Failure>,
    wrong: Option<Failure>,
    /// `true` if no other start can do better.
    hopeless: bool,
}

impl Search {
    fn attempt<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
        &mut self,
        mechanism: &S,
        parameters: &S::Parameters,
        mut q: [R; N],
        t: R,
    ) -> Option<([R; N], Statistics)> {
        let scales = mechanism.coordinate_scales(parameters);
        let mut solver = AssemblySolver::new(extent(&q, &scales));
        let outcome = mechanism.solve_blocks(parameters, &mut q, t, &mut solver);
        self.hopeless = solver.is_apart();
        let failure = position_failure::<S, R, N, _>(outcome, solver.diagnosis(), t);
        let Some(failure) = failure.or_else(|| coordinate_failure::<S, R, N, _>(&q, &scales, t)) else {
            let position = mechanism.position(parameters, &q, t);
            let Some(branch) = branch_failure(mechanism, parameters, &position, t, true) else {
                return Some((q, Statistics::of(solver.diagnosis())));
            };
            self.wrong = self.wrong.or(Some(branch));
            return None;
        };
        let ratio = solver.diagnosis().worst.ratio.to_f64();
        match failure {
            Failure { kind: FailureKind::NotConverged { .. }, .. }
            | Failure { kind: FailureKind::Inconsistent { .. }, .. }
                if ratio < self.least =>
            {
                self.least = ratio;
                self.open = Some(not_assemblable(mechanism, parameters, &q, t, failure));
            }
            other => self.open = self.open.or(Some(other)),
        }
        None
    }
}

/// Start number `start`: the guess itself, or a point near it.
fn displaced<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    guess: &[R; N],
    start: u32,
) -> [R; N] {
    if start == 0 {
        return *guess;
    }
    let mut angles = [false; N];
    angles.iter_mut().zip(S::COORDINATES).for_each(|(angle, entry)| *angle = entry.is_angle());
    multistart::displaced(guess, &angles, &mechanism.coordinate_scales(parameters), start, OTHER_STARTS)
}
