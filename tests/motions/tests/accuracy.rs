//! Errors that are asked for and errors that are estimated, on ready mechanisms from 20 starts each.
#![forbid(unsafe_code)]

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, Projection, Simulation, Tolerance, VelocityTransformation,
};
use mbs_runtime::{Dynamic, FailureKind};
use mechanisms::andrews::Andrews;
use mechanisms::cart_pole::CartPole;
use mechanisms::double_pendulum::DoublePendulum;
use mechanisms::four_bar_mass::FourBarMassReleased;
use mechanisms::heavy_top::HeavyTop;
use mechanisms::n_four_bar_1::NFourBar1;
use mechanisms::pendulum::Pendulum;
use mechanisms::slider_crank_mass::CrankPistonReleased;

/// Starts of each mechanism.
const STARTS: u32 = 20;

/// A number in [−1, 1] for each start and coordinate: the fractional parts of multiples of the golden ratio.
fn shaken(start: u32, index: usize) -> f64 {
    2.0 * (f64::from(start * 31 + 7 * index as u32 + 1) * 0.618_033_988_749_895).fract() - 1.0
}

/// Errors over those asked for, and right-hand sides over those of the cheapest tolerance that does as well.
#[derive(Default)]
struct Found {
    asked: Vec<f64>,
    cost: Vec<f64>,
}

fn error<const N: usize>(a: &[f64; N], b: &[f64; N], scales: &[f64; N]) -> f64 {
    a.iter().zip(b).zip(scales).map(|((a, b), scale)| ((a - b) / scale).abs()).fold(0.0, f64::max)
}

/// All starts of a mechanism to `until` (s), for one error.
fn asked<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    until: f64,
    accuracy: f64,
    found: &mut Found,
) {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let scales = mechanism.coordinate_scales(&mechanism.parameters());
    let text = Simulation::start_from_text(mechanism.clone(), method, 0.0).expect("it starts");
    for start in 0..STARTS {
        let (mut q, mut qd) = (*text.q(), *text.qd());
        for (index, (q, qd)) in q.iter_mut().zip(&mut qd).enumerate() {
            *q += 0.05 * shaken(start, index) * scales[index];
            *qd *= 1.0 + 0.05 * shaken(start, index + N);
        }
        let Ok(run) = Simulation::start_near(mechanism.clone(), method, 0.0, q, qd) else { continue };
        // The truth by the other formulation, three digits finer than any that is asked for.
        let other = Explicit::new(DormandPrince8, VelocityTransformation);
        let truth = Simulation::start_near(mechanism.clone(), other, 0.0, *run.q(), *run.qd())
            .expect("the same start");
        let mut truth = truth.with_tolerance(Tolerance::new(1e-13));
        truth.advance_to(until).expect("a motion");
        let mut accurate = run.clone().with_accuracy(accuracy).expect("an error above rounding");
        accurate.advance_to(until).expect("a motion");
        let right = error(accurate.run().q(), truth.q(), &scales);
        found.asked.push(right / accuracy);
        let (mut tolerance, mut cheapest) = (accuracy * 100.0, f64::INFINITY);
        while tolerance > accuracy * 1e-3 && cheapest.is_infinite() {
            let mut plain = run.clone().with_tolerance(Tolerance::new(tolerance));
            plain.advance_to(until).expect("a motion");
            if error(plain.q(), truth.q(), &scales) <= accuracy {
                cheapest = plain.counts().evaluations as f64;
            }
            tolerance *= 0.5;
        }
        // All runs that led to the result, each from the same start.
        let spent: u64 = accurate.evaluations();
        found.cost.push(spent as f64 / cheapest);
    }
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Errors of 1e-5, 1e-7 and 1e-9 from all starts, and what was found of them.
fn reached<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(name: &str, mechanism: S, until: f64) {
    for accuracy in [1e-5, 1e-7, 1e-9] {
        let mut found = Found::default();
        asked(&mechanism, until, accuracy, &mut found);
        let Found { mut asked, mut cost } = found;
        assert!(asked.len() >= 15, "{name}: {} starts", asked.len());
        let (middle, worst) = (median(&mut asked), asked[asked.len() - 1]);
        let price = median(&mut cost);
        println!("{name} {accuracy:e}: error over asked {middle:.2} (largest {worst:.2}), cost {price:.1}");
        assert!(worst <= 2.0, "{name}: {worst:e} of the error asked for");
        assert!(middle >= 0.005, "{name}: {middle:e} of the error asked for, at too high a price");
        assert!(price <= 5.0, "{name}: {price} times the cheapest");
    }
}

#[test]
fn asked_accuracies_are_reached() {
    reached("pendulum", Pendulum::<f64>::default(), 5.0);
    reached("double pendulum", DoublePendulum::<f64>::default(), 3.0);
    reached("cart-pole", CartPole::<f64>::default(), 1.0);
    reached("four-bar", FourBarMassReleased::<f64>::default(), 1.0);
    reached("slider-crank", CrankPistonReleased::<f64>::default(), 1.0);
    reached("one loop", NFourBar1::<f64>::default(), 2.0);
    reached("heavy top", HeavyTop::<f64>::default(), 1.0);
    reached("Andrews", Andrews::<f64>::default(), 0.02);
}

#[test]
fn a_chaotic_motion_beyond_its_horizon_is_refused() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(DoublePendulum::<f64>::default(), method, 0.0).expect("it starts");
    let mut run = run.with_accuracy(1e-6).expect("an error above rounding");
    let failure = run.advance_to(100.0).expect_err("its digits are lost");
    assert!(matches!(failure.kind, FailureKind::Unreachable { .. }), "{failure}");
    assert_eq!(run.run().t(), 0.0);
}
