//! Andrews' squeezing mechanism.

use super::cvodes::{Integrator, TOLERANCES};
use super::emitted::{self, Run};
use super::{Accelerations, Attempt, State, casadi, dense, exact_enough, larger};
use crate::measure::Case;
use crate::released::Squeezer;
use mbs_runtime::dynamics::{DormandPrince8, Explicit, Simulation, VelocityTransformation};

/// Duration (s) of the published problem.
const END: f64 = 0.03;

/// Coordinates at the start, at rest (rad).
const START: [f64; 7] = [
    -0.061_713_890_014_276_45,
    0.0,
    0.455_279_819_163_070_37,
    0.222_668_390_165_885_88,
    0.487_364_979_543_842_56,
    -0.222_668_390_165_885_88,
    1.230_547_444_549_821_2,
];

/// Coordinates at the end (rad) to eleven digits, on which integrations of order 8 and 16 with tolerances of 1e-13 agree. The
/// Test Set for IVP Solvers gives eight of them.
const AT_END: [f64; 7] = [
    15.810_771_195_153_707,
    -15.756_371_058_411_839,
    0.040_822_240_119_645_8,
    -0.534_730_116_342_079_6,
    0.524_409_965_879_954,
    0.534_730_116_342_079_6,
    1.048_080_741_041_938,
];

/// Largest allowed error of a motion at its end (rad).
const LIMIT: f64 = 2e-7;

/// States on the way.
const STATES: u32 = 256;

pub fn rates() -> Vec<Case> {
    let method = Explicit::new(DormandPrince8, VelocityTransformation);
    let simulation = Simulation::start(Squeezer::default(), method, 0.0, START, [0.0; 7]);
    let mut states = Vec::new();
    simulation
        .expect("a start on the constraints")
        .sample(END, STATES, |instant| states.push(State { q: instant.y.q, qd: instant.y.qd }))
        .expect("a regular motion");
    let expected = states.iter().map(dense::squeezer).collect();
    let problem = Accelerations { group: "andrews_rates", states, expected };
    let mut cases = vec![
        problem.case("dense", dense::squeezer),
        problem.case("casadi_rates", casadi::squeezer),
        problem.case("emitted", emitted::rates::<Squeezer, 7, 6>()),
    ];
    cases.push(emitted::lanes::<Squeezer<_>, 7, 6>(&problem));
    cases
}

pub fn motions() -> Vec<Case> {
    let error = |q: &[f64]| q.iter().zip(&AT_END).fold(0.0, |sum, (q, end)| larger(sum, (q - end).abs()));
    let mut attempts: Vec<Attempt> = (0..TOLERANCES)
        .map(|index| {
            let start = [START, [0.0; 7]].concat();
            let mut integrator = Integrator::new(&format!("andrews_end_{index}"), start, 14);
            integrator.run();
            let error = error(&integrator.states[..7]);
            Attempt { name: "cvodes", error, run: Box::new(move || integrator.run()) }
        })
        .collect();
    let run = Run { start: State { q: START, qd: [0.0; 7] }, end: END };
    attempts.extend(run.attempts::<Squeezer, 6>(|simulation| {
        let mut found = f64::NAN;
        simulation.show(END, 1, &mut |q| found = error(q));
        found
    }));
    exact_enough("andrews_motion", LIMIT, attempts)
}
