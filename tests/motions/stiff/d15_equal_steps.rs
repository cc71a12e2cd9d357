//! D15: implicit methods of equal steps gave up on smoothed stick–slip with "no balance of forces after 40 iterations".

use mbs_runtime::Dynamic;
use mbs_runtime::dynamics::{
    AugmentedLagrangian, Explicit, Extrapolated, GeneralizedAlpha, Method, Projection, Radau5, Simulation,
};

use crate::peers::reference;
use crate::texts::{Belt, Grounded, Oscillator};

/// Steps of each run: the coarsest pass a whole time of sticking.
const STEPS: [u32; 4] = [100, 300, 1000, 5000];

/// Upper bound of the speed of all blocks (m/s). Equal steps miss an instant of sticking by a step at most; the error of a
/// block is then at most this speed times the step.
const FASTEST: f64 = 0.6;

/// Runs with all step counts, each compared with the reference within the error of steps that do not end at the instant of
/// sticking.
fn arrives<S: Dynamic<f64, N, M>, X: Method<S, f64, N, M> + Copy, const N: usize, const M: usize>(
    (name, problem, end): (&str, &str, f64),
    mechanism: &S,
    method: X,
    place: impl Fn(&[f64; N]) -> f64,
) {
    for steps in STEPS {
        let mut run = Simulation::start_from_text(mechanism.clone(), method, 0.0).expect("it starts");
        if let Err(failure) = run.step_to(end, steps) {
            panic!("{name}, {problem}, {steps} steps: {failure}");
        }
        let (error, bound) = ((place(run.q()) - reference(problem)).abs(), FASTEST * end / f64::from(steps));
        let iterations = run.counts().iterations as f64 / f64::from(steps);
        println!(
            "{name}, {problem}, {steps} steps: {error:.1e} m of {bound:.1e}, {iterations:.1} iterations"
        );
        assert!(error < bound, "{name}, {problem}, {steps} steps: {error:e} of {bound:e}");
    }
}

/// All texts with both smoothings.
fn arrives_everywhere<X>(name: &str, method: X)
where
    X: Method<Oscillator, f64, 1, 0> + Method<Belt, f64, 1, 0> + Method<Grounded, f64, 2, 1> + Copy,
{
    for (smooth, [oscillator, belt]) in
        [(1e-3, ["oscillator 1e-3", "belt 1e-3"]), (1e-4, ["oscillator 1e-4", "belt 1e-4"])]
    {
        let block = Oscillator { smooth, ..Oscillator::default() };
        arrives((name, oscillator, 5.0), &block, method, |q| q[0]);
        arrives((name, belt, 3.0), &Belt { smooth, ..Belt::default() }, method, |q| q[0]);
        let block = Grounded { smooth, ..Grounded::default() };
        arrives((name, oscillator, 5.0), &block, method, |q| q[0].hypot(q[1]).copysign(q[0]));
    }
}

#[test]
fn equal_steps_of_the_augmented_lagrangian_lead_across_the_bend_of_smoothed_friction() {
    arrives_everywhere("augmented Lagrangian", AugmentedLagrangian);
}

#[test]
fn equal_steps_of_the_extrapolated_method_lead_across_the_bend_of_smoothed_friction() {
    arrives_everywhere("extrapolated", Extrapolated);
}

#[test]
fn equal_steps_of_generalised_alpha_lead_across_the_bend_of_smoothed_friction() {
    arrives_everywhere("generalised-alpha", GeneralizedAlpha::default());
}

#[test]
fn equal_steps_of_radau_are_taken_in_parts_where_friction_bends() {
    arrives_everywhere("Radau IIA", Explicit::new(Radau5, Projection::default()));
}
