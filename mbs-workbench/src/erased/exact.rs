//! Functions of a mechanism in double-double numbers behind an object-safe trait, for reference solutions.

use mbs_runtime::{Dynamic, DynamicState, Scalar};

use crate::double_double::DoubleDouble as D;

/// Numbers of coordinates, rows, first-order states and contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Coordinates: N.
    pub coordinates: usize,
    /// Rows: M.
    pub rows: usize,
    /// First-order states.
    pub states: usize,
    /// Contacts; their gaps change sign at events.
    pub contacts: usize,
}

/// A state of motion: time (s), coordinates and velocities (N each), first-order states.
#[derive(Clone, Debug, PartialEq)]
pub struct Moving {
    /// Time (s).
    pub t: D,
    /// Coordinates: N.
    pub q: Vec<D>,
    /// Velocities: N.
    pub qd: Vec<D>,
    /// First-order states.
    pub states: Vec<D>,
}

/// Rows at a state. Matrices are dense, row by row.
#[derive(Clone, Debug)]
pub struct Rows {
    /// Φ: M.
    pub phi: Vec<D>,
    /// Φ_q q̇ + Φ_t: M.
    pub rate: Vec<D>,
    /// Φ_q: M rows of N.
    pub phi_q: Vec<D>,
}

/// Masses and forces at a state.
#[derive(Clone, Debug)]
pub struct Terms {
    /// M: N rows of N.
    pub mass: Vec<D>,
    /// Q: N.
    pub force: Vec<D>,
    /// ∂Q/∂λ: N rows of M; none where Q does not depend on λ.
    pub force_lambda: Option<Vec<D>>,
    /// ż.
    pub state_rates: Vec<D>,
}

/// Quantities that settings are compared in.
#[derive(Clone, Debug, PartialEq)]
pub struct Observed<T> {
    /// Φ_qᵀ λ, which is unique where λ is not: N.
    pub reaction: Vec<T>,
    /// Kinetic and potential energy (J).
    pub energy: T,
    /// Kinetic energy (J).
    pub kinetic: T,
    /// Outputs, then outputs of loads, component by component.
    pub outputs: Vec<T>,
}

/// Functions of a mechanism with masses in double-double numbers. Vectors are in the order of the text.
pub trait ExactEquations {
    /// Sizes.
    fn sizes(&self) -> Sizes;
    /// Reference metric of the coordinates: N.
    fn scales(&self) -> Vec<f64>;
    /// Reference metric of the rows: M.
    fn row_scales(&self) -> Vec<f64>;
    /// The text's start of the first-order states.
    fn start_states(&self) -> Vec<D>;
    /// Starts drives that prescribe a rate, and inputs with rates, at `q` (N) and `t` (s).
    fn begin(&mut self, t: D, q: &[D]);
    /// Moves these drives and inputs on to `t` (s).
    fn move_on(&mut self, t: D);
    /// Rows at a state.
    fn rows(&self, at: &Moving) -> Rows;
    /// γ at a state: M.
    fn gamma(&self, at: &Moving) -> Vec<D>;
    /// Masses and forces at a state with multipliers `lambda` (M).
    fn terms(&self, at: &Moving, lambda: &[D]) -> Terms;
    /// Gaps of the contacts with their rates.
    fn gaps(&self, at: &Moving) -> Vec<[D; 2]>;
    /// Quantities to compare, with accelerations `qdd` (N) and multipliers `lambda` (M).
    fn observed(&self, at: &Moving, qdd: &[D], lambda: &[D]) -> Observed<D>;
}

/// A mechanism with its drives at a time.
pub struct Exact<S, const N: usize, const M: usize> {
    mechanism: S,
    t: D,
}

impl<S, const N: usize, const M: usize> Exact<S, N, M> {
    /// `mechanism` as it is.
    pub fn of(mechanism: S) -> Self {
        Exact { mechanism, t: D::constant(0.0) }
    }
}

fn array<const K: usize>(values: &[D]) -> [D; K] {
    <[D; K]>::try_from(values).expect("a vector of the mechanism's size")
}

fn flat<const R: usize, const C: usize>(matrix: [[D; C]; R]) -> Vec<D> {
    matrix.into_iter().flatten().collect()
}

impl<S: Dynamic<D, N, M>, const N: usize, const M: usize> Exact<S, N, M> {
    /// The mechanism with its drives and inputs at `t` (s).
    fn at(&self, t: D) -> S {
        let mut mechanism = self.mechanism.clone();
        if S::HAS_SIGNALS {
            mechanism.carry_signals(&self.mechanism, t - self.t);
        }
        if !S::PHASES.is_empty() {
            mechanism.advance_phases(self.t, t);
        }
        mechanism
    }

    fn states(&self, values: &[D]) -> S::States {
        let mut states = self.mechanism.start_states(&self.mechanism.parameters());
        states.as_mut().copy_from_slice(values);
        states
    }
}

impl<S: Dynamic<D, N, M>, const N: usize, const M: usize> ExactEquations for Exact<S, N, M> {
    fn sizes(&self) -> Sizes {
        Sizes { coordinates: N, rows: M, states: S::STATES.len(), contacts: S::CONTACTS.len() }
    }
    fn scales(&self) -> Vec<f64> {
        self.mechanism.coordinate_scales(&self.mechanism.parameters()).map(|scale| scale.high).to_vec()
    }
    fn row_scales(&self) -> Vec<f64> {
        self.mechanism.row_scales(&self.mechanism.parameters()).map(|scale| scale.high).to_vec()
    }
    fn start_states(&self) -> Vec<D> {
        self.mechanism.start_states(&self.mechanism.parameters()).as_ref().to_vec()
    }
    fn begin(&mut self, t: D, q: &[D]) {
        self.mechanism.start_phases(&array(q), t);
        self.t = t;
    }
    fn move_on(&mut self, t: D) {
        self.mechanism = self.at(t);
        self.t = t;
    }
    fn rows(&self, at: &Moving) -> Rows {
        let mechanism = self.at(at.t);
        let parameters = mechanism.parameters();
        let position = mechanism.position(&parameters, &array(&at.q), at.t);
        let phi_q = mechanism.phi_q(&parameters, &position);
        let mut rate = mechanism.phi_t(&parameters, &position);
        for (rate, row) in rate.iter_mut().zip(&phi_q) {
            for (entry, qd) in row.iter().zip(&at.qd) {
                *rate = *rate + *entry * *qd;
            }
        }
        Rows { phi: mechanism.phi(&parameters, &position).to_vec(), rate: rate.to_vec(), phi_q: flat(phi_q) }
    }
    fn gamma(&self, at: &Moving) -> Vec<D> {
        let mechanism = self.at(at.t);
        let parameters = mechanism.parameters();
        let position = mechanism.position(&parameters, &array(&at.q), at.t);
        mechanism.gamma(&parameters, &position, &array(&at.qd)).to_vec()
    }
    fn terms(&self, at: &Moving, lambda: &[D]) -> Terms {
        let mechanism = self.at(at.t);
        let parameters = mechanism.parameters();
        let position = mechanism.position(&parameters, &array(&at.q), at.t);
        let (qd, lambda, states) = (array(&at.qd), array(lambda), self.states(&at.states));
        let (p, s) = (&parameters, &position);
        let slope = || flat(mechanism.force_lambda(p, s, &qd, &states, &lambda));
        Terms {
            mass: flat(mechanism.mass(p, s)),
            force: mechanism.force(p, s, &qd, &states, &lambda).to_vec(),
            force_lambda: S::FORCE_USES_MULTIPLIERS.then(slope),
            state_rates: mechanism.state_rates(p, s, &qd, &states, &lambda).as_ref().to_vec(),
        }
    }
    fn gaps(&self, at: &Moving) -> Vec<[D; 2]> {
        if S::CONTACTS.is_empty() {
            return Vec::new();
        }
        let mechanism = self.at(at.t);
        let parameters = mechanism.parameters();
        let position = mechanism.position(&parameters, &array(&at.q), at.t);
        let mut gaps = Vec::new();
        mechanism.gaps(&parameters, &position, &array(&at.qd), |gap| gaps.push([gap.gap, gap.rate]));
        gaps
    }
    fn observed(&self, at: &Moving, qdd: &[D], lambda: &[D]) -> Observed<D> {
        let mechanism = self.at(at.t);
        let parameters = mechanism.parameters();
        let position = mechanism.position(&parameters, &array(&at.q), at.t);
        let (qd, qdd, lambda) = (array(&at.qd), array(qdd), array(lambda));
        let states = self.states(&at.states);
        let moving = DynamicState { qd: &qd, qdd: &qdd, lambda: &lambda, states: &states };
        observed(&mechanism, (&parameters, &position), &moving)
    }
}

/// Quantities that settings are compared in, in the numbers of the mechanism.
pub fn observed<S, T, const N: usize, const M: usize>(
    mechanism: &S,
    (parameters, position): (&S::Parameters, &S::Position),
    moving: &DynamicState<'_, T, N, M, S::States>,
) -> Observed<T>
where
    S: Dynamic<T, N, M>,
    T: Scalar,
{
    let energy = mechanism.energy(parameters, position, moving.qd);
    let outputs = mechanism.outputs(parameters, position, moving.qd, moving.qdd);
    let loads = mechanism.loads(parameters, position, moving);
    let outputs = outputs.as_ref().iter().map(|output| output.value);
    Observed {
        reaction: mechanism.reaction(parameters, position, moving.lambda).to_vec(),
        energy: energy.kinetic + energy.potential,
        kinetic: energy.kinetic,
        outputs: outputs.chain(loads.as_ref().iter().copied()).collect(),
    }
}
