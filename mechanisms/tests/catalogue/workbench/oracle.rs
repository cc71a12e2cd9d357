//! The oracle of hard cases, which interprets texts, against the emitted code of every ready mechanism.

use std::rc::Rc;

use mbs_workbench::erased::facade::{AnyEquations, State};
use mbs_workbench::erased::masses::Loads;
use mbs_workbench::hard_cases::oracle::{Jet, Oracle, OracleState};

use mechanisms::CATALOGUE;

/// Numbers in −1 to 1 that follow from a seed.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn many(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.next()).collect()
    }
}

fn oracle(equations: &dyn AnyEquations) -> Result<Oracle, String> {
    let known = |name: &str| {
        let index = equations.variables().iter().position(|entry| entry.name == name)?;
        equations.get(index)
    };
    let scene = Some(equations.scene()).filter(|scene| *scene != "AllEffects");
    let jets = equations.jets();
    let functions = |name: &str| {
        let index = equations.functions().iter().position(|entry| entry.name == name)?;
        let jets = jets.clone();
        Some(Rc::new(move |x| jets(index, x)) as Jet)
    };
    Oracle::with_functions(equations.source(), scene, &known, &functions).map_err(|gap| gap.0)
}

/// Largest difference of the oracle and the emitted functions, as a part of their terms; or what the oracle leaves out.
fn apart(equations: &dyn AnyEquations, oracle: &Oracle, noise: &mut Noise) -> Result<f64, String> {
    let (n, m) = (equations.coordinates().len(), equations.rows().len());
    assert_eq!((oracle.size(), oracle.row_count()), (n, m), "{}", equations.full_name());
    let state = State { q: noise.many(n), qd: noise.many(n), qdd: noise.many(n), t: 0.3 + noise.next() };
    let states = noise.many(equations.tables().map_or(0, |tables| tables.states.len()));
    let loads = Loads { states: states.clone(), lambda: noise.many(m) };
    let moving = OracleState {
        t: state.t,
        q: state.q.clone(),
        qd: state.qd.clone(),
        qdd: state.qdd.clone(),
        lambda: loads.lambda.clone(),
        states,
        ..OracleState::default()
    };
    let functions = equations.evaluate(&state);
    let rows = oracle.rows(&moving).expect("rows");
    let mut largest = 0.0_f64;
    for (i, row) in rows.iter().enumerate() {
        let along = |x: &[f64]| {
            let terms = functions.phi_q[i * n..(i + 1) * n].iter().zip(x).map(|(entry, x)| entry * x);
            terms.fold((0.0, 1.0), |(sum, size), term| (sum + term, size + term.abs()))
        };
        let mut compare = |found: f64, expected: f64, size: f64| {
            if found.is_finite() || expected.is_finite() {
                largest = largest.max((found - expected).abs() / size);
            }
        };
        let Some(phi) = row.phi else { continue };
        compare(phi, functions.phi[i], 1.0 + functions.phi[i].abs());
        let (rate, size) = along(&state.qd);
        compare(row.rate, rate + functions.phi_t[i], size + functions.phi_t[i].abs());
        let (second, size) = along(&state.qdd);
        compare(row.second, second - functions.gamma[i], size + functions.gamma[i].abs());
    }
    if let Some(masses) = equations.masses(&state, &loads) {
        let w = noise.many(n);
        let along = |values: &[f64]| values.iter().zip(&w).map(|(value, w)| value * w).sum::<f64>();
        let emitted = along(&masses.mass_times) + along(&masses.reaction) - along(&masses.force);
        let balance = oracle.equations_of_motion(&moving, &w).map_err(|gap| gap.0)?;
        if emitted.is_finite() || balance.sum.is_finite() {
            largest = largest.max((balance.sum - emitted).abs() / balance.size.max(1e-3));
        }
    }
    Ok(largest)
}

#[test]
fn interpreted_texts_agree_with_emitted_code() {
    let mut noise = Noise(19);
    let mut gaps = Vec::new();
    let mut checked = 0;
    for card in CATALOGUE.cards {
        let equations = card.equations();
        let found = oracle(equations.as_ref()).and_then(|oracle| {
            (0..3).try_fold(0.0_f64, |largest, _| {
                apart(equations.as_ref(), &oracle, &mut noise).map(|found| largest.max(found))
            })
        });
        match found {
            Ok(found) => {
                // The damping that a restitution gives is a root, found within 1e-9.
                let bound = if equations.source().contains("approach") { 1e-9 } else { 1e-11 };
                assert!(found < bound, "{}: {found:e}", card.name());
                checked += 1;
            }
            Err(gap) => gaps.push(format!("{}: {gap}", card.name())),
        }
    }
    // Forces of rigid contacts and of frictions that stick, and events of a motion, are in no state.
    let words = ["which is not in the state", "which a motion alone knows"];
    let is_known = |gap: &String| words.iter().any(|known| gap.contains(known));
    println!("{checked} checked, left out: {gaps:#?}");
    assert!(gaps.iter().all(is_known), "{gaps:#?}");
    assert!(checked >= 47, "{checked}, {gaps:#?}");
}
