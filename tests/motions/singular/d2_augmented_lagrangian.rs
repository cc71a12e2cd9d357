//! D2: steps of the augmented Lagrangian method that ended before the multiplier of a weak direction had come, with `Ok`.
//!
//! In two parallelograms in a row that multiplier grows with the reciprocal of the margin. The springs stood still long before it had;
//! the accelerations made up for it, and 60 000 steps were less accurate than 10 000.

use mbs_runtime::Dynamic;
use mbs_runtime::dynamics::{AugmentedLagrangian, Method, Simulation};

use crate::n_four_bars::{Angles2, Design, Designed, Mixed2, Natural2};

const SECONDS: f64 = 3.0;

/// Steps whose error tells that of shorter ones: four times as many have a sixteenth.
const COARSE: u32 = 2000;

/// Error of the head over the three seconds (m), or none where the run is refused.
fn error<S, const N: usize, const M: usize>(
    design: &Design,
    head: impl Fn(&[f64; N]) -> [f64; 2],
    steps: u32,
) -> Option<f64>
where
    S: Designed + Dynamic<f64, N, M>,
    AugmentedLagrangian: Method<S, f64, N, M>,
{
    let mut run =
        Simulation::start_from_text(S::designed(design), AugmentedLagrangian, 0.0).expect("it starts");
    run.step_to(SECONDS, steps).ok()?;
    let angle = design.exact(S::LOOPS, SECONDS);
    let [x, y] = head(run.q());
    Some((x - design.upright * angle.sin()).hypot(y - design.upright * angle.cos()))
}

/// All runs of a text: as accurate as steps of their length are, or refused, and at most one of those.
fn is_of_second_order<S, const N: usize, const M: usize>(head: impl Fn(&[f64; N], &Design) -> [f64; 2])
where
    S: Designed + Dynamic<f64, N, M>,
    AugmentedLagrangian: Method<S, f64, N, M>,
{
    let (mut refused, mut worst) = (0, 0.0_f64);
    for k in 0..2_u32 {
        let share = f64::from(k);
        let usual = Design::USUAL;
        let design =
            Design { gravity: usual.gravity - 0.4 * share, speed: usual.speed + 0.13 * share, ..usual };
        let coarse = error::<S, N, M>(&design, |q| head(q, &design), COARSE).expect("coarse steps pass");
        for steps in [6007, 12_011, 24_000] {
            let steps = steps + 13 * k;
            let expected = coarse * (f64::from(COARSE) / f64::from(steps)).powi(2);
            match error::<S, N, M>(&design, |q| head(q, &design), steps) {
                Some(error) => {
                    worst = worst.max(error / expected);
                    println!("{} {steps}: {error:.1e} m of {expected:.1e}", S::NAME);
                    assert!(error < 3.0 * expected, "{} {steps} {design:?}: {error:e} {expected:e}", S::NAME);
                }
                None => refused += 1,
            }
        }
    }
    println!("{}: at most {worst:.2} times the error of the order, {refused} refused", S::NAME);
    assert!(refused <= 1, "{}: {refused} refused", S::NAME);
}

#[test]
fn short_steps_of_the_augmented_lagrangian_take_multipliers_along_that_springs_hold_weakly() {
    is_of_second_order::<Angles2, 5, 4>(|q, design| {
        [design.upright * q[0].cos(), design.upright * q[0].sin()]
    });
    is_of_second_order::<Natural2, 6, 5>(|q, _| [q[0], q[1]]);
    is_of_second_order::<Mixed2, 5, 4>(|q, design| {
        [design.upright * q[0].cos(), design.upright * q[0].sin()]
    });
}

#[test]
fn short_steps_at_regular_positions_are_not_refused() {
    for steps in [100, 1000, 10_000, 100_000] {
        let design = Design::USUAL;
        let text = <Natural2 as Designed>::designed(&design);
        let mut run = Simulation::start_from_text(text, AugmentedLagrangian, 0.0).expect("it starts");
        let h = 0.01 / f64::from(steps);
        for step in 0..100 {
            run.step(h).unwrap_or_else(|failure| panic!("step {step} of {h:e} s: {failure}"));
        }
    }
}
