//! The code that the macro emits.

use std::hint::black_box;

use mbs_runtime::{Lanes, Mechanism, Scalar};

use super::{Output, Problem, STATES};
use crate::measure::Case;

/// One mechanism a call; a design's own stage is part of it.
pub fn scalar<S, const N: usize, const Z: usize>(
    q: &[f64; N],
    qd: &[f64; N],
    t: f64,
    out: &mut Output<f64, N, Z>,
) where
    S: Mechanism<f64, N, N, Entries = [f64; Z]> + Default,
{
    evaluate(&S::default(), q, qd, t, out);
}

#[inline(always)]
fn evaluate<S, T: Scalar, const N: usize, const Z: usize>(
    mechanism: &S,
    q: &[T; N],
    qd: &[T; N],
    t: T,
    out: &mut Output<T, N, Z>,
) where
    S: Mechanism<T, N, N, Entries = [T; Z]>,
{
    let parameters = mechanism.parameters();
    let evaluation = mechanism.evaluate(&parameters, q, t, qd);
    *out = Output {
        phi: evaluation.phi,
        entries: evaluation.phi_q_entries,
        phi_t: evaluation.phi_t,
        gamma: evaluation.gamma,
    };
}

#[inline(never)]
fn called<S, T: Scalar, const N: usize, const Z: usize>(
    mechanism: &S,
    state: &([T; N], [T; N], T),
    out: &mut Output<T, N, Z>,
) where
    S: Mechanism<T, N, N, Entries = [T; Z]>,
{
    evaluate(mechanism, &state.0, &state.1, state.2, out);
}

/// L mechanisms a call.
pub fn lanes<S, const L: usize, const N: usize, const Z: usize>(
    name: &'static str,
    problem: &Problem<N, Z>,
) -> Case
where
    S: Mechanism<Lanes<f64, L>, N, N, Entries = [Lanes<f64, L>; Z]> + Default + 'static,
{
    let states: Vec<([Lanes<f64, L>; N], [Lanes<f64, L>; N], Lanes<f64, L>)> = problem
        .states
        .chunks(L)
        .map(|chunk| {
            let lanes = |value: &dyn Fn(usize) -> f64| Lanes::from_lanes(value);
            (
                std::array::from_fn(|k| lanes(&|lane| chunk[lane].q[k])),
                std::array::from_fn(|k| lanes(&|lane| chunk[lane].qd[k])),
                lanes(&|lane| chunk[lane].t),
            )
        })
        .collect();
    let zero = Lanes([0.0; L]);
    let mut out = Output { phi: [zero; N], entries: [zero; Z], phi_t: [zero; N], gamma: [zero; N] };
    let mechanism = S::default();
    let mut found = Vec::new();
    for state in &states {
        called(&mechanism, state, &mut out);
        let of =
            |values: &[Lanes<f64, L>], lane: usize| values.iter().map(|v| v.lane(lane)).collect::<Vec<_>>();
        found.extend((0..L).map(|lane| Output {
            phi: of(&out.phi, lane).try_into().expect("N values"),
            entries: of(&out.entries, lane).try_into().expect("Z values"),
            phi_t: of(&out.phi_t, lane).try_into().expect("N values"),
            gamma: of(&out.gamma, lane).try_into().expect("N values"),
        }));
    }
    let error = problem.error(&found);
    let run = move || {
        for state in black_box(&states) {
            called(&mechanism, state, black_box(&mut out));
        }
    };
    Case { group: problem.name, name, work: STATES as u32, error, run: Box::new(run) }
}
