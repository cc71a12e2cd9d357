//! The first position: from a guess, in the declared assembly.

use crate::diagnosis::{Statistics, extent};
use crate::kinematics::{
    branch_failure, coordinate_failure, non_finite, position_failure, time_failure, variable_failure,
};
use crate::{Failure, Kinematic, Real, Safeguarded};

/// Starts beside the guess. One of them falls into each of a dyad's two assemblies for any guess with odds of
/// about one half, so 32 miss a declared one in 4e9; five dyads at once need about that many.
const OTHER_STARTS: u32 = 32;

/// Share of the search box in which the first other start lies; the last one uses all of it.
const FIRST_RADIUS: f64 = 0.25;

/// A mechanism at rest in its first position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assembled<R, const N: usize> {
    /// Coordinates: N.
    pub q: [R; N],
    /// What the start that succeeded cost.
    pub statistics: Statistics,
    /// Which start succeeded: 0 for the guess itself, 1 … 32 for the others.
    pub start: u32,
}

/// Solves Φ(q, t) = 0 from `guess` (N) at time `t` (s) such that every declared branch holds.
///
/// The guess comes first; where it leads nowhere or to another assembly, a fixed list of starts around it is
/// tried, up to π away in angles and a reference length in lengths. Angles are as the solver found them: whole
/// turns of the guess are kept, none is taken off.
///
/// # Errors
/// [`Failure::NonFinite`] for a guess, parameter, input or time that is no number, or a row that is none from
/// every start; [`Failure::WrongBranch`] where positions were found but none in the declared assembly;
/// [`Failure::NotAssemblable`] with the least residual found and its row.
pub fn assemble<S: Kinematic<R, N>, R: Real, const N: usize>(
    mechanism: &S,
    guess: impl Into<[R; N]>,
    t: R,
) -> Result<Assembled<R, N>, Failure> {
    let guess = guess.into();
    let broken = non_finite(&guess, S::COORDINATES).or(variable_failure(mechanism)).or(time_failure(t));
    if let Some(failure) = broken {
        return Err(failure);
    }
    let parameters = mechanism.parameters();
    let mut search = Search { least: f64::INFINITY, open: None, wrong: None };
    for start in 0..=OTHER_STARTS {
        let from = displaced::<S, R, N>(mechanism, &parameters, &guess, start);
        match search.attempt(mechanism, &parameters, from, t) {
            Some((q, statistics)) => return Ok(Assembled { q, statistics, start }),
            None => continue,
        }
    }
    // A wrong assembly outranks a start that led nowhere: the mechanism can be put together.
    Err(search.wrong.or(search.open).unwrap_or(Failure::NonFinite { name: "t", line: 0 }))
}

/// What the starts so far came to.
struct Search {
    least: f64,
    open: Option<Failure>,
    wrong: Option<Failure>,
}

impl Search {
    fn attempt<S: Kinematic<R, N>, R: Real, const N: usize>(
        &mut self,
        mechanism: &S,
        parameters: &S::Parameters,
        mut q: [R; N],
        t: R,
    ) -> Option<([R; N], Statistics)> {
        let scales = mechanism.coordinate_scales(parameters);
        let mut solver = Safeguarded::new(extent(&q, &scales));
        let outcome = mechanism.solve_blocks(parameters, &mut q, t, &mut solver);
        let failure = position_failure::<S, R, N>(outcome, solver.diagnosis(), t);
        let Some(failure) = failure.or_else(|| coordinate_failure::<S, R, N>(&q, &scales, t)) else {
            let position = mechanism.position(parameters, &q, t);
            let Some(branch) = branch_failure(mechanism, parameters, &position, t, true) else {
                return Some((q, Statistics::of(solver.diagnosis())));
            };
            self.wrong = self.wrong.or(Some(branch));
            return None;
        };
        let ratio = solver.diagnosis().worst.ratio.to_f64();
        match failure {
            Failure::NotConverged { row, residual, time, .. } if ratio < self.least => {
                self.least = ratio;
                self.open = Some(Failure::NotAssemblable { row, residual, time });
            }
            other => self.open = self.open.or(Some(other)),
        }
        None
    }
}

/// Start number `start`: the guess plus a point of Roberts' low-discrepancy sequence in a growing box.
///
/// Half widths are π for angles and the coordinate's scale for others. The sequence is additive with
/// αⱼ = g^−(j+1), g the root of g^(N+1) = g + 1. Source: M. Roberts 2018, "The unreasonable effectiveness of
/// quasirandom sequences".
fn displaced<S: Kinematic<R, N>, R: Real, const N: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    guess: &[R; N],
    start: u32,
) -> [R; N] {
    let mut q = *guess;
    if start == 0 {
        return q;
    }
    let number = f64::from(start);
    let radius = FIRST_RADIUS + (1.0 - FIRST_RADIUS) * number / f64::from(OTHER_STARTS);
    let ratio = generalized_golden_ratio(N as f64);
    let mut step = 1.0;
    let scales = mechanism.coordinate_scales(parameters);
    for ((coordinate, scale), entry) in q.iter_mut().zip(scales).zip(S::COORDINATES) {
        step /= ratio;
        let point = 0.5 + number * step;
        let offset = R::constant(radius * (2.0 * (point - libm::floor(point)) - 1.0));
        let width = if entry.is_angle() { R::constant(core::f64::consts::PI) } else { scale };
        *coordinate = *coordinate + offset * width;
    }
    q
}

/// The root above 1 of g^(n+1) = g + 1, by fixed-point iteration, which gains a digit or more in two steps.
fn generalized_golden_ratio(n: f64) -> f64 {
    (0..32).fold(1.5, |g, _| libm::pow(1.0 + g, 1.0 / (n + 1.0)))
}
