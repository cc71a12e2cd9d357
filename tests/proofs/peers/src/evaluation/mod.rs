//! {Φ, nonzeros of Φ_q, Φ_t, γ} of one state.

pub mod by_hand;
pub mod derived;
mod emitted;
mod generated;

use std::hint::black_box;

use mbs_runtime::Mechanism;

use crate::measure::Case;
use crate::texts::{AdjustableFourBar, Andrews, Chain10, FourBar};
use generated::Casadi;

/// States that a run walks along.
const STATES: usize = 256;

/// Results of all implementations: N rows, Z entries of Φ_q row by row.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Output<T, const N: usize, const Z: usize> {
    pub phi: [T; N],
    pub entries: [T; Z],
    pub phi_t: [T; N],
    pub gamma: [T; N],
}

/// Coordinates, velocities, time.
#[derive(Clone, Copy)]
pub struct State<const N: usize> {
    pub q: [f64; N],
    pub qd: [f64; N],
    pub t: f64,
}

/// An implementation; called through a pointer, so that no caller's knowledge enters it.
pub type Evaluate<const N: usize, const Z: usize> = fn(&[f64; N], &[f64; N], f64, &mut Output<f64, N, Z>);

/// The lecture's four-bar.
pub fn four_bar() -> Vec<Case> {
    let states = states(
        [0.3, 0.4, 0.0, 0.8, 1.8],
        [0.2, 0.1, 0.0, 0.4, 0.5],
        [0.5, -1.2, std::f64::consts::TAU, -2.5, 3.1],
        Some(2),
    );
    let mut cases = Problem::new::<FourBar>("four_bar", states, generated::FOUR_BAR).cases(
        generated::sympy_four_bar,
        by_hand::four_bar,
        by_hand::four_bar_c_library,
        derived::dual::<derived::FourBar, 5, 13>,
        derived::differences::<derived::FourBar, 5, 13>,
        emitted::scalar::<FourBar, 5, 13>,
    );
    let problem = Problem::new::<FourBar>("four_bar", states, generated::FOUR_BAR);
    cases.push(problem.case("by_hand_from_parts", by_hand::four_bar_from_parts));
    cases.push(problem.case("emitted_adjustable", emitted::scalar::<AdjustableFourBar, 5, 13>));
    cases.push(emitted::lanes::<FourBar<_>, 8, _, _>("emitted_lanes", &problem));
    cases.push(emitted::lanes::<FourBar<_>, 4, _, _>("emitted_4_lanes", &problem));
    cases
}

/// Andrews' squeezing mechanism.
pub fn andrews() -> Vec<Case> {
    let states = states(
        [0.0, 0.1, 0.45, 0.22, 0.49, -0.22, 1.23],
        [0.0, 0.3, 0.2, 0.3, 0.2, 0.3, 0.2],
        [std::f64::consts::TAU, 3.0, -2.0, 1.5, 2.5, -1.0, 2.0],
        Some(0),
    );
    let problem = Problem::new::<Andrews>("andrews", states, generated::ANDREWS);
    let lanes = [
        emitted::lanes::<Andrews<_>, 8, _, _>("emitted_lanes", &problem),
        emitted::lanes::<Andrews<_>, 4, _, _>("emitted_4_lanes", &problem),
    ];
    let mut cases = problem.cases(
        generated::sympy_andrews,
        by_hand::andrews,
        by_hand::andrews_c_library,
        derived::dual::<derived::Andrews, 7, 23>,
        derived::differences::<derived::Andrews, 7, 23>,
        emitted::scalar::<Andrews, 7, 23>,
    );
    cases.extend(lanes);
    cases
}

/// Ten loops in natural coordinates: no sine but the driver's.
pub fn chain() -> Vec<Case> {
    let center = std::array::from_fn(|k| if k % 2 == 0 { 0.1 } else { 0.9 } + 0.01 * (k * k % 7) as f64);
    let states = states(center, [0.2; 22], std::array::from_fn(|k| 1.0 - 0.1 * k as f64), None);
    let problem = Problem::new::<Chain10>("chain", states, generated::CHAIN);
    let lanes = [
        emitted::lanes::<Chain10<_>, 8, _, _>("emitted_lanes", &problem),
        emitted::lanes::<Chain10<_>, 4, _, _>("emitted_4_lanes", &problem),
    ];
    let mut cases = problem.cases(
        generated::sympy_chain,
        by_hand::chain,
        by_hand::chain_c_library,
        derived::dual::<derived::Chain, 22, 63>,
        derived::differences::<derived::Chain, 22, 63>,
        emitted::scalar::<Chain10, 22, 63>,
    );
    cases.extend(lanes);
    cases
}

/// States around a turn; they need not close the loops. `turning`: the coordinate that turns with the phase.
fn states<const N: usize>(
    center: [f64; N],
    swing: [f64; N],
    speed: [f64; N],
    turning: Option<usize>,
) -> [State<N>; STATES] {
    std::array::from_fn(|state| {
        let fraction = state as f64 / STATES as f64;
        let (sine, cosine) = (std::f64::consts::TAU * fraction).sin_cos();
        let mut q: [f64; N] =
            std::array::from_fn(|k| center[k] + swing[k] * if k % 2 == 0 { cosine } else { sine });
        let mut qd: [f64; N] = std::array::from_fn(|k| speed[k] * if k % 2 == 0 { -sine } else { cosine });
        if let Some(turning) = turning {
            q[turning] = std::f64::consts::TAU * fraction;
            qd[turning] = std::f64::consts::TAU;
        }
        State { q, qd, t: 0.05 + fraction }
    })
}

/// A problem: states, places of the entries, and CasADi's results.
struct Problem<const N: usize, const Z: usize> {
    name: &'static str,
    states: [State<N>; STATES],
    places: &'static [(u16, u16)],
    expected: Vec<Output<f64, N, Z>>,
    casadi: Casadi,
}

impl<const N: usize, const Z: usize> Problem<N, Z> {
    fn new<S: Mechanism<f64, N, N>>(name: &'static str, states: [State<N>; STATES], casadi: Casadi) -> Self {
        let places = S::SPARSITY;
        assert_eq!(places.len(), Z, "entries of {name}");
        let order = casadi.order(places);
        let expected = states
            .iter()
            .map(|state| {
                let mut out = zeros();
                casadi.plain(&state.q, &state.qd, state.t, &mut out);
                let by_columns = out.entries;
                out.entries = std::array::from_fn(|k| by_columns[order[k]]);
                out
            })
            .collect();
        Problem { name, states, places, expected, casadi }
    }

    /// All implementations that every problem has.
    fn cases(
        &self,
        sympy: generated::Sympy,
        by_hand: Evaluate<N, Z>,
        by_hand_c_library: Evaluate<N, Z>,
        dual: Evaluate<N, Z>,
        differences: Evaluate<N, Z>,
        emitted: Evaluate<N, Z>,
    ) -> Vec<Case> {
        let casadi = self.casadi;
        let states = self.states;
        let casadi_case = |name, shared: bool| {
            let mut out = zeros::<N, Z>();
            let run = move || {
                for state in black_box(&states) {
                    let call = if shared { Casadi::shared } else { Casadi::plain };
                    call(&casadi, &state.q, &state.qd, state.t, black_box(&mut out));
                }
            };
            // It is the reference of the others.
            Case { group: self.name, name, work: STATES as u32, error: 0.0, run: Box::new(run) }
        };
        let sympy_case = {
            let evaluate = move |q: &[f64; N], qd: &[f64; N], t: f64, out: &mut Output<f64, N, Z>| {
                generated::sympy(sympy, q, qd, t, out)
            };
            self.case_of("sympy", evaluate)
        };
        vec![
            casadi_case("casadi_plain", false),
            casadi_case("casadi_shared", true),
            sympy_case,
            self.case("by_hand", by_hand),
            self.case("by_hand_c_library", by_hand_c_library),
            self.case("dual", dual),
            self.case("differences", differences),
            self.case("emitted", emitted),
        ]
    }

    fn case(&self, name: &'static str, evaluate: Evaluate<N, Z>) -> Case {
        self.case_of(name, move |q, qd, t, out| black_box(evaluate)(q, qd, t, out))
    }

    fn case_of(
        &self,
        name: &'static str,
        evaluate: impl Fn(&[f64; N], &[f64; N], f64, &mut Output<f64, N, Z>) + Copy + 'static,
    ) -> Case {
        let found = self.states.each_ref().map(|state| {
            let mut out = zeros();
            evaluate(&state.q, &state.qd, state.t, &mut out);
            out
        });
        let error = self.error(&found);
        let states = self.states;
        let mut out = zeros();
        let run = move || {
            for state in black_box(&states) {
                evaluate(&state.q, &state.qd, state.t, black_box(&mut out));
            }
        };
        Case { group: self.name, name, work: STATES as u32, error, run: Box::new(run) }
    }

    /// Largest difference from CasADi's plain code, each row measured by its largest value over the states.
    fn error(&self, found: &[Output<f64, N, Z>]) -> f64 {
        let rows = |out: &Output<f64, N, Z>| -> Vec<(usize, f64)> {
            let plain = |offset: usize, part: [f64; N]| {
                part.into_iter().enumerate().map(move |(row, value)| (offset + row, value))
            };
            let entries = self.places.iter().zip(out.entries);
            let entries = entries.map(|((row, _), value)| (N + usize::from(*row), value));
            plain(0, out.phi)
                .chain(entries)
                .chain(plain(2 * N, out.phi_t))
                .chain(plain(3 * N, out.gamma))
                .collect()
        };
        let mut scales = vec![0.0_f64; 4 * N];
        for expected in &self.expected {
            rows(expected).into_iter().for_each(|(row, value)| scales[row] = scales[row].max(value.abs()));
        }
        let mut largest = 0.0;
        for (expected, found) in self.expected.iter().zip(found) {
            for ((row, expected), (_, found)) in rows(expected).into_iter().zip(rows(found)) {
                let scale = if scales[row] > 0.0 { scales[row] } else { 1.0 };
                let error = (found - expected).abs() / scale;
                // A NaN stays.
                largest = if error <= largest { largest } else { error };
            }
        }
        largest
    }
}

fn zeros<const N: usize, const Z: usize>() -> Output<f64, N, Z> {
    Output { phi: [0.0; N], entries: [0.0; Z], phi_t: [0.0; N], gamma: [0.0; N] }
}
