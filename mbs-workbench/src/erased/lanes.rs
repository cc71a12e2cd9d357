//! Emitted code on lanes of numbers, behind the trait that the oracles compare.

use std::cell::Cell;

use mbs_runtime::{Lanes, Mechanism, OutputValue, Scalar};

use crate::erased::facade::{AnyEquations, Description, Functions, State};

/// A mechanism in L lanes: each state is evaluated in the next lane, with other states of other designs in the other lanes.
#[derive(Clone, Debug)]
pub struct InLanes<S, const L: usize, const N: usize, const M: usize = N> {
    mechanism: S,
    /// The lane of the next state.
    next: Cell<usize>,
}

/// Difference between the numbers of neighbouring lanes; relative for parameters and inputs.
const APART: f64 = 0.03;

impl<S, const L: usize, const N: usize, const M: usize> InLanes<S, L, N, M>
where
    S: Mechanism<Lanes<f64, L>, N, M> + Clone,
{
    /// `mechanism` with the design of its first lane.
    pub fn new(mechanism: S) -> Self {
        InLanes { mechanism, next: Cell::new(0) }
    }

    /// The mechanism with its design in lane `lane`, others around it.
    fn with_neighbour_lanes(&self, lane: usize) -> S {
        let mut mechanism = self.mechanism.clone();
        for index in 0..S::VARIABLES.len() {
            let value = self.get(index).unwrap_or(0.0);
            mechanism.set(index, around(lane, |apart| value * (1.0 + APART * apart)));
        }
        mechanism
    }
}

/// `number` of each lane's distance from lane `lane`.
fn around<const L: usize>(lane: usize, number: impl Fn(f64) -> f64) -> Lanes<f64, L> {
    Lanes::from_lanes(|other| number(other as f64 - lane as f64))
}

impl<S, const L: usize, const N: usize, const M: usize> AnyEquations for InLanes<S, L, N, M>
where
    S: Mechanism<Lanes<f64, L>, N, M> + Clone,
{
    fn description(&self) -> &'static Description {
        const { &Description::of::<S, Lanes<f64, L>, N, M>() }
    }
    fn get(&self, index: usize) -> Option<f64> {
        self.mechanism.get(index).map(|value| value.lane(0))
    }
    fn set(&mut self, index: usize, value: f64) -> bool {
        self.mechanism.set(index, Lanes::splat(value))
    }
    fn coordinate_scales(&self) -> Vec<f64> {
        self.mechanism.coordinate_scales(&self.mechanism.parameters()).map(|scale| scale.lane(0)).to_vec()
    }
    fn row_scales(&self) -> Vec<f64> {
        self.mechanism.row_scales(&self.mechanism.parameters()).map(|scale| scale.lane(0)).to_vec()
    }

    fn evaluate(&self, state: &State) -> Functions {
        let lane = self.next.get();
        self.next.set((lane + 1) % L.max(1));
        let beside = |values: &[f64]| {
            let values = <[f64; N]>::try_from(values).expect("a state has N components");
            values.map(|value| around(lane, |apart| value + APART * apart))
        };
        let (q, qd, qdd) = (beside(&state.q), beside(&state.qd), beside(&state.qdd));
        let t = around(lane, |apart| state.t + APART * apart);
        let mechanism = self.with_neighbour_lanes(lane);
        let parameters = mechanism.parameters();
        let position = mechanism.position(&parameters, &q, t);
        let of = |values: &[Lanes<f64, L>]| values.iter().map(|value| value.lane(lane)).collect();
        let output = |output: &OutputValue<Lanes<f64, L>>| OutputValue {
            value: output.value.lane(lane),
            rate: output.rate.map(|rate| rate.lane(lane)),
            acceleration: output.acceleration.map(|acceleration| acceleration.lane(lane)),
        };
        Functions {
            phi: of(&mechanism.phi(&parameters, &position)),
            phi_q: of(mechanism.phi_q(&parameters, &position).as_flattened()),
            phi_t: of(&mechanism.phi_t(&parameters, &position)),
            phi_tt: of(&mechanism.phi_tt(&parameters, &position)),
            phi_qt_qd: of(&mechanism.phi_qt_qd(&parameters, &position, &qd)),
            gamma: of(&mechanism.gamma(&parameters, &position, &qd)),
            outputs: mechanism
                .outputs(&parameters, &position, &qd, &qdd)
                .as_ref()
                .iter()
                .map(output)
                .collect(),
        }
    }
}
