//! The model's expressions in second-order Taylor arithmetic.

use super::law;
use super::masses;
use super::taylor::Jet;
use super::{ROUNDINGS, Random};
use crate::model::expression::Node;
use crate::model::{Model, VariableKind};

/// Data of one evaluation, exact numbers all.
pub struct Evaluation {
    /// Coordinates: N.
    pub q: Vec<f64>,
    /// Velocities: N.
    pub qd: Vec<f64>,
    /// Accelerations: N.
    pub qdd: Vec<f64>,
    /// Time (s).
    pub t: f64,
    /// Parameters and inputs, component by component.
    pub variables: Vec<f64>,
    /// First-order states; none without masses.
    pub states: Vec<f64>,
    /// Multipliers: M; none without masses.
    pub lambda: Vec<f64>,
}

impl Evaluation {
    /// Numbers within ±2; the constraints need not hold.
    pub(super) fn draw(model: &Model, random: &mut Random) -> Self {
        let mut numbers = |count: usize| (0..count).map(|_| random.number()).collect::<Vec<_>>();
        let n = model.coordinates.len();
        Evaluation {
            q: numbers(n),
            qd: numbers(n),
            qdd: numbers(n),
            t: numbers(1)[0],
            variables: numbers(model.variables.len()),
            states: numbers(model.dynamics.as_ref().map_or(0, |dynamics| dynamics.states.len())),
            lambda: numbers(model.dynamics.as_ref().map_or(0, |_| model.rows.len())),
        }
    }
}

/// A number to be reproduced, and the bound on rounding in units of 2⁻⁵³.
pub struct Expected {
    /// The number.
    pub value: f64,
    /// Sum of the absolute values of all intermediate results that are rounded.
    pub bound: f64,
    /// `true` if rounding decides on which side of a kink it is computed.
    pub torn: bool,
}

impl Expected {
    /// Error of `value` as a part of what rounding may do; `None` where rounding decides on the number itself.
    pub fn error(&self, value: f64) -> Option<f64> {
        if self.torn {
            return None;
        }
        let error = (value - self.value).abs() / (ROUNDINGS * self.bound).max(f64::MIN_POSITIVE);
        Some(if error.is_nan() { f64::INFINITY } else { error })
    }
}

/// The line along which expressions are followed: how each leaf moves.
#[derive(Clone, Copy)]
struct Direction {
    /// Time and inputs move.
    time: bool,
    /// Coordinates move with q̇.
    velocity: bool,
    /// Coordinates are accelerated by q̈.
    acceleration: bool,
    /// The coordinate that moves alone at rate 1.
    axis: Option<usize>,
}

/// All functions in the order in which the interpreter gives them: Φ, Φ_q row by row, Φ_t, Φ_tt, Φ_qt q̇, γ,
/// branches, outputs with rate and acceleration; then those of masses.
pub fn run(model: &Model, state: &Evaluation) -> Vec<Expected> {
    let still = Direction { time: false, velocity: false, acceleration: false, axis: None };
    let rows: Vec<usize> = model.rows.iter().map(|row| row.residual.index()).collect();
    let along = |line: Direction| {
        let jets = evaluate(model, state, line);
        rows.iter().map(|row| jets[*row]).collect::<Vec<Jet>>()
    };
    let part = |jets: &[Jet], k: usize, sign: f64| -> Vec<Expected> {
        jets.iter().map(|jet| Expected { value: sign * jet.v[k], bound: jet.b[k], torn: jet.torn }).collect()
    };
    let time = along(Direction { time: true, ..still });
    let motion = along(Direction { velocity: true, ..still });
    let both = along(Direction { time: true, velocity: true, ..still });
    let mut expected = part(&time, 0, 1.0);
    let columns: Vec<Vec<Jet>> =
        (0..state.q.len()).map(|axis| along(Direction { axis: Some(axis), ..still })).collect();
    for row in 0..rows.len() {
        expected.extend(columns.iter().flat_map(|column| part(&column[row..=row], 1, 1.0)));
    }
    expected.extend(part(&time, 1, 1.0));
    expected.extend(part(&time, 2, 1.0));
    // Polarisation: twice the mixed derivative is the second derivative of the joint motion less those of its parts.
    for ((both, motion), time) in both.iter().zip(&motion).zip(&time) {
        let value = 0.5 * (both.v[2] - motion.v[2] - time.v[2]);
        expected.push(Expected { value, bound: both.b[2] + motion.b[2] + time.b[2], torn: both.torn });
    }
    expected.extend(part(&both, 2, -1.0));
    let jets =
        evaluate(model, state, Direction { time: true, velocity: true, acceleration: true, axis: None });
    expected
        .extend(model.branches.iter().flat_map(|branch| part(&jets[branch.value.index()..][..1], 0, 1.0)));
    for output in &model.outputs {
        expected.extend((0..3).flat_map(|k| part(&jets[output.value.index()..][..1], k, 1.0)));
    }
    expected.extend(model.dynamics.iter().flat_map(|dynamics| masses::run(model, dynamics, state)));
    expected
}

/// One jet an expression.
fn evaluate(model: &Model, state: &Evaluation, line: Direction) -> Vec<Jet> {
    let mut jets: Vec<Jet> = Vec::with_capacity(model.expressions.len());
    let moved = |on: bool, rate: f64| if on { rate } else { 0.0 };
    for (_, node) in model.expressions.iter() {
        let jet = match node {
            Node::Number(value) => Jet::constant(value),
            Node::Time => Jet::new([state.t, moved(line.time, 1.0), 0.0]),
            Node::Coordinate(i) => {
                let rate = if line.axis == Some(i) { 1.0 } else { moved(line.velocity, state.qd[i]) };
                Jet::new([state.q[i], rate, moved(line.acceleration, state.qdd[i])])
            }
            Node::Variable(i) => {
                let moves = line.time && model.variables[i].kind == VariableKind::InputWithRates;
                let v = |offset: usize| state.variables.get(i + offset).copied().unwrap_or(0.0);
                Jet::new([v(0), moved(moves, v(1)), moved(moves, v(2))])
            }
            Node::Unary(function, a) => jets[a.index()].unary(function),
            Node::Binary(function, a, b) => jets[a.index()].binary(function, jets[b.index()]),
            Node::Call { function, order, argument } => {
                let (function, jet) = (function as u32, jets[argument.index()]);
                let orders = [0, 1, 2, 3].map(|more| order + more);
                jet.chain_of_terms(
                    orders.map(|order| law::derivative(function, order, jet.v[0])),
                    orders.map(|order| law::magnitude(function, order)),
                )
            }
            // Part of forces alone: anywhere else it would make every comparison fail.
            Node::Rate(..) | Node::State(_) | Node::Multiplier(_) => Jet::constant(f64::NAN),
            Node::Pin(..)
            | Node::Margin(_)
            | Node::Ratio(..)
            | Node::Sliding(_)
            | Node::Holding(_)
            | Node::Impulse(_)
            | Node::Remembered(_) => {
                unreachable!("random texts use no pin, no margin and no ratio")
            }
        };
        jets.push(jet);
    }
    jets
}
