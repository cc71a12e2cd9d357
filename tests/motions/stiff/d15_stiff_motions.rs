//! D15: no method integrated stiff motions with steps as long as a tolerance allows. Radau IIA of order 5 against SciPy's.

use mbs_runtime::Dynamic;
use mbs_runtime::dynamics::{Explicit, Projection, Radau5, Simulation, Tolerance};

use crate::peers::{cost, doubt, front, reference};
use crate::texts::{Andrews, Belt, Governor, Grounded, Oscillator, VanDerPol};

/// Tolerances of the runs that are compared.
const TOLERANCES: [f64; 7] = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];

/// Right-hand sides at equal true error, over SciPy's.
const MOST: f64 = 2.0;

/// True error over the tolerance: local errors of the steps add up, and the instant of sticking has an error of some steps.
const LARGEST_ERROR: f64 = 100.0;

fn run<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: S,
    end: f64,
    tolerance: f64,
) -> Simulation<S, Explicit<Radau5, Projection>, f64, N, M> {
    let method = Explicit::new(Radau5, Projection::default());
    let run = Simulation::start_from_text(mechanism, method, 0.0).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(tolerance));
    if let Err(failure) = run.advance_to(end) {
        panic!("{tolerance:e}: {failure} after {:?}", run.counts());
    }
    run
}

/// Right-hand sides over SciPy's at the same true error of one coordinate, the mean over the tolerances; each error within the
/// tolerance times a factor.
fn keeps_up<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    problem: &str,
    (mechanism, end): (&S, f64),
    place: impl Fn(&[f64; N]) -> f64,
) {
    let (exact, doubt, front) = (reference(problem), doubt(problem), front(problem));
    let mut ratios = Vec::new();
    for tolerance in TOLERANCES {
        let run = run(mechanism.clone(), end, tolerance);
        let (error, counts) = ((place(run.q()) - exact).abs(), run.counts());
        // Below that the reference itself is in doubt.
        let peer = cost(&front, error).filter(|_| 10.0 * doubt < error);
        let ratio = peer.map(|cost| counts.evaluations as f64 / cost);
        println!(
            "{problem}, {tolerance:e}: {error:.1e}, {} right-hand sides, {} steps, {} rejected, {ratio:.2?} of SciPy's",
            counts.evaluations,
            counts.steps,
            run.adaptive().rejected,
        );
        assert!(error < LARGEST_ERROR * tolerance + doubt, "{problem}, {tolerance:e}: {error:e}");
        ratios.extend(ratio);
    }
    let mean = (ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len() as f64).exp();
    println!("{problem}: {mean:.2} of {MOST} of SciPy's right-hand sides at equal error");
    assert!(3 < ratios.len() && mean < MOST, "{problem}: {mean} of {}", ratios.len());
}

#[test]
fn van_der_pol_at_a_million_takes_no_more_than_twice_what_scipy_does() {
    keeps_up("van der Pol", (&VanDerPol::default(), 2.0), |q| q[0]);
}

#[test]
fn a_block_that_sticks_and_slips_takes_no_more_than_twice_what_scipy_does() {
    keeps_up("oscillator 1e-3", (&Oscillator::default(), 5.0), |q| q[0]);
    keeps_up("oscillator 1e-4", (&Oscillator { smooth: 1e-4, ..Oscillator::default() }, 5.0), |q| q[0]);
    keeps_up("belt 1e-3", (&Belt::default(), 3.0), |q| q[0]);
    keeps_up("belt 1e-4", (&Belt { smooth: 1e-4, ..Belt::default() }, 3.0), |q| q[0]);
}

#[test]
fn a_block_whose_normal_force_is_a_multiplier_takes_no_more_than_twice_what_scipy_does() {
    let along = |q: &[f64; 2]| q[0].hypot(q[1]).copysign(q[0]);
    keeps_up("oscillator 1e-3", (&Grounded::default(), 5.0), along);
    keeps_up("oscillator 1e-4", (&Grounded { smooth: 1e-4, ..Grounded::default() }, 5.0), along);
}

#[test]
fn a_stiff_governor_in_sixteen_coordinates_takes_no_more_than_twice_what_scipy_does_in_four() {
    keeps_up("governor", (&Governor::default(), 2.0), |q| q[1]);
}

#[test]
fn andrews_squeezer_takes_no_more_than_twice_what_scipy_does() {
    keeps_up("Andrews", (&Andrews::default(), 0.03), |q| q[0]);
}

#[test]
fn the_matrices_of_a_stiff_step_fit_a_small_stack() {
    let governor = Radau5::stack::<Governor, f64, 16, 12>();
    let andrews = Radau5::stack::<Andrews, f64, 7, 6>();
    let block = Radau5::stack::<Oscillator, f64, 1, 0>();
    println!("stack of a stiff step: governor {governor} B, Andrews {andrews} B, block {block} B");
    // Two slopes, a real and a complex matrix of N² numbers, and a few vectors.
    assert!(governor < 6 * 16 * 16 * 8 && andrews < 7 * 7 * 7 * 8 && block < 512);
}
