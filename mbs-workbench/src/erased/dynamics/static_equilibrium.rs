//! Static equilibrium of a mechanism under its forces.

use mbs_runtime::dynamics::{
    Counts, Equilibrium, Formulation, IntegratorState, Metric, Model, Unstabilized, closed,
    equilibrium_with_modes,
};
use mbs_runtime::{Dynamic, DynamicState, Failure};

use super::determined;
use crate::erased::facade::Motion;
use crate::motion::{Forces, Instant};

/// Step of a guess, as a part of the coordinate's scale, after which the other coordinates follow it.
const PIECE: f64 = 0.1;

/// Times (s) at which forces and rows are compared with those at time 0, to find a dependence on the time.
const OTHER_TIMES: [f64; 3] = [0.1, 0.37, 1.3];

/// A position of static equilibrium.
#[derive(Clone, Debug)]
pub struct Rest {
    /// The position as a motion of one instant.
    pub motion: Motion,
    /// Coordinates that may move without a restoring force.
    pub indifferent: Vec<&'static str>,
    /// Coordinates that frictions hold.
    pub rubbed: Vec<&'static str>,
    /// `true` if forces of contacts and frictions are one choice of many.
    pub shared: bool,
    /// `true` if forces or rows depend on the time, which is held at 0.
    pub held: bool,
}

/// Before: the text's start, and guesses of coordinates by their indices. After: the start of the search. The other coordinates
/// follow the guesses so that the rows hold; if they cannot, they keep the start's values.
pub(crate) fn begin<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    start: [f64; N],
    guesses: &[(usize, f64)],
) -> [f64; N] {
    let scales = mechanism.coordinate_scales(&mechanism.parameters());
    let held: Vec<u16> = guesses.iter().filter_map(|(index, _)| u16::try_from(*index).ok()).collect();
    let far = guesses.iter().map(|(index, value)| ((value - start[*index]) / scales[*index]).abs());
    let pieces = (far.fold(0.0, f64::max) / PIECE).ceil().clamp(1.0, 1e3) as u32;
    let moved = |mut q: [f64; N], share: f64| {
        for (index, value) in guesses {
            q[*index] = start[*index] + share * (value - start[*index]);
        }
        q
    };
    let mut q = start;
    for piece in 1..=pieces {
        match closed(mechanism, 0.0, &moved(q, f64::from(piece) / f64::from(pieces)), &held) {
            Ok(found) => q = found,
            Err(_) => return moved(start, 1.0),
        }
    }
    if guesses.is_empty() { start } else { q }
}

/// Most moves along the positions of rest, and the part of a coordinate's scale that is near enough.
const MOVES: usize = 8;
const NAMED: f64 = 1e-9;

/// Before: an equilibrium, and the guesses that it was searched from. After: the same where no force answers, with the coordinates
/// that the guesses name at their values: the search has moved them together with others.
pub(crate) fn at_guesses<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    mut found: Rest,
    guesses: &[(usize, f64)],
) -> Rest {
    let position = |rest: &Rest| core::array::from_fn(|index: usize| rest.motion.coordinates[index].q[0]);
    let scales = mechanism.coordinate_scales(&mechanism.parameters());
    for _ in 0..MOVES {
        let q: [f64; N] = position(&found);
        let off = |(index, value): &(usize, f64)| ((value - q[*index]) / scales[*index]).abs();
        let free =
            guesses.iter().filter(|(index, _)| found.indifferent.contains(&S::COORDINATES[*index].name));
        let farthest = free.max_by(|a, b| off(a).total_cmp(&off(b)));
        let Some((index, value)) = farthest.filter(|guess| off(guess) > NAMED).copied() else {
            return found;
        };
        let held: Vec<u16> = u16::try_from(index).into_iter().collect();
        let moved_to = |from: [f64; N]| {
            let q = closed(mechanism, 0.0, &from, &held).ok()?;
            rest(mechanism, &q).ok()
        };
        // A rest beside this one shows the way along them.
        let mut beside = q;
        beside[index] = value;
        let Some(other) = moved_to(beside) else { return found };
        let to: [f64; N] = position(&other);
        let way = to[index] - q[index];
        let ahead = core::array::from_fn(|i| q[i] + (to[i] - q[i]) * (value - q[index]) / way);
        let is_way = way.abs() > NAMED * scales[index];
        found = match is_way.then(|| moved_to(ahead)).flatten() {
            Some(ahead) if (position(&ahead)[index] - value).abs() < (to[index] - value).abs() => ahead,
            _ => other,
        };
    }
    found
}

/// The equilibrium next to `q` (N) at time 0, with its loads and multipliers.
pub(crate) fn rest<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    q: &[f64; N],
) -> Result<Rest, Failure> {
    let mut mechanism = mechanism.clone();
    mechanism.start_phases(q, 0.0);
    let (found, states, parameters) = equilibrium_with_modes(&mechanism, 0.0, q)?;
    let none = [0.0; N];
    let position = mechanism.position(&parameters, &found.q, 0.0);
    let outputs = mechanism.outputs(&parameters, &position, &none, &none);
    let scales = Metric::<f64, N, M>::of(&mechanism, &parameters).rows;
    let residuals = mechanism.phi(&parameters, &position);
    let closure = residuals.iter().zip(scales).map(|(residual, scale)| (residual / scale).abs());
    let mut motion = Motion::of(S::COORDINATES, S::OUTPUTS, outputs.as_ref());
    motion.push(&Instant {
        t: 0.0,
        q: [&found.q, &none, &none],
        outputs: outputs.as_ref(),
        closure: closure.fold(0.0, f64::max),
        iterations: found.iterations,
        margin: margin(&mechanism, &parameters, &found, &states),
    });
    let moving = DynamicState { qd: &none, qdd: &none, lambda: &found.lambda, states: &states };
    let loads = mechanism.loads(&parameters, &position, &moving);
    let mut forces = Forces::of(S::LOADS, S::ROWS);
    let energy = mechanism.energy(&parameters, &position, &none);
    forces.push(energy, loads.as_ref(), &found.lambda);
    forces.states = states.as_ref().to_vec();
    determined::push(&mut forces, &mechanism, (&parameters, &position), 0.0, &moving)?;
    motion.dynamics = Some(forces);
    let named = |marks: &[bool; N]| {
        let marked = S::COORDINATES.iter().zip(marks).filter(|(_, mark)| **mark);
        marked.map(|(entry, _)| entry.name).collect()
    };
    Ok(Rest {
        motion,
        indifferent: named(&found.indifferent),
        rubbed: named(&found.held),
        shared: found.shared,
        held: depends_on_time(&mechanism, &found, &states),
    })
}

/// `true` if forces or rows at the equilibrium depend on the time.
fn depends_on_time<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    found: &Equilibrium<f64, N, M>,
    states: &S::States,
) -> bool {
    let (parameters, none) = (mechanism.parameters(), [0.0; N]);
    let at = |t: f64| {
        let position = mechanism.position(&parameters, &found.q, t);
        let force = mechanism.force(&parameters, &position, &none, states, &found.lambda);
        (force, mechanism.phi(&parameters, &position), mechanism.phi_t(&parameters, &position))
    };
    OTHER_TIMES.iter().any(|t| at(*t) != at(0.0)) || at(0.0).2.iter().any(|rate| *rate != 0.0)
}

/// Margin of Φ_q to a loss of rank; NaN if the masses do not determine the accelerations.
fn margin<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    found: &Equilibrium<f64, N, M>,
    states: &S::States,
) -> f64 {
    let metric = Metric::next_to(mechanism, parameters, 0.0, &found.q);
    let model = Model::of_states(mechanism, parameters, &metric);
    let y = IntegratorState { q: found.q, qd: [0.0; N], states: *states, work: 0.0 };
    let solved = Unstabilized.solve(&model, 0.0, &y, &found.lambda, &mut Counts::default());
    solved.map_or(f64::NAN, |solved| solved.margin)
}
