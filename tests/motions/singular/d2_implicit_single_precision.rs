//! D2: implicit steps in single precision, which left their branch with bars in line, or gained energy there, and ended with `Ok`.

use mbs_runtime::Dynamic;
use mbs_runtime::dynamics::{AugmentedLagrangian, Extrapolated, GeneralizedAlpha, Method, Simulation};

use crate::d2_single_precision::{Heads, Rods};

const SECONDS: f32 = 2.0;

/// Angle (rad) of all uprights after two seconds, φ̈ = −stiffness cos φ from the vertical, by RK4.
fn exact(stiffness: f64, speed: f64) -> f64 {
    const STEPS: u32 = 40_000;
    let h = f64::from(SECONDS) / f64::from(STEPS);
    let (mut angle, mut rate) = (core::f64::consts::FRAC_PI_2, speed);
    let pull = |angle: f64| -stiffness * angle.cos();
    for _ in 0..STEPS {
        let first = (rate, pull(angle));
        let second = (rate + 0.5 * h * first.1, pull(angle + 0.5 * h * first.0));
        let third = (rate + 0.5 * h * second.1, pull(angle + 0.5 * h * second.0));
        let fourth = (rate + h * third.1, pull(angle + h * third.0));
        angle += h / 6.0 * (first.0 + 2.0 * (second.0 + third.0) + fourth.0);
        rate += h / 6.0 * (first.1 + 2.0 * (second.1 + third.1) + fourth.1);
    }
    angle
}

/// Runs that end right, that end wrong and that are refused. `head`: place (m) of the first head.
fn counted<S, X, const N: usize, const M: usize>(
    text: impl Fn(f32) -> S,
    (name, method): (&str, X),
    stiffness: f64,
    head: impl Fn(&[f32; N]) -> [f64; 2],
) -> [u32; 3]
where
    S: Dynamic<f32, N, M>,
    X: Method<S, f32, N, M> + Copy,
{
    let (mut found, mut largest) = ([0; 3], 0.0_f64);
    for k in 0..6_u16 {
        let speed = -3.0 - 0.1 * f32::from(k);
        let angle = exact(stiffness, f64::from(speed));
        for steps in [400, 1000, 2000, 4000, 8000] {
            let steps = steps + 7 * u32::from(k);
            let mut run = Simulation::start_from_text(text(speed), method, 0.0).expect("it starts");
            let place = match run.step_to(SECONDS, steps) {
                Err(_) => 2,
                Ok(()) => {
                    let [x, y] = head(run.q());
                    let error = (x - angle.cos()).hypot(y - angle.sin());
                    largest = largest.max(error);
                    // Of the rule itself, three times; of rounding in the passages, a hundredth.
                    let rule = 3e3 / f64::from(steps).powi(2);
                    usize::from(rule.max(0.01) < error)
                }
            };
            found[place] += 1;
        }
    }
    println!("{} {name}: {found:?} right, wrong, refused; largest error {largest:.1e}", S::NAME);
    found
}

#[test]
fn no_implicit_step_in_single_precision_leaves_its_branch_with_ok() {
    let by_angle = |q: &[f32; 5]| [f64::from(q[0]).cos(), f64::from(q[0]).sin()];
    let by_point = |q: &[f32; 4]| [f64::from(q[0]), f64::from(q[1])];
    let rods = |speed| Rods::<f32> { speed };
    let heads = |speed| Heads::<f32> { speed };
    let (of_rods, of_heads) = (9.81 * 3.5 / 3.0, 9.81);
    let all = [
        counted::<_, _, 5, 4>(rods, ("augmented Lagrangian", AugmentedLagrangian), of_rods, by_angle),
        counted::<_, _, 4, 3>(heads, ("augmented Lagrangian", AugmentedLagrangian), of_heads, by_point),
        counted::<_, _, 5, 4>(rods, ("generalised alpha", GeneralizedAlpha::default()), of_rods, by_angle),
        counted::<_, _, 4, 3>(heads, ("generalised alpha", GeneralizedAlpha::default()), of_heads, by_point),
        counted::<_, _, 4, 3>(heads, ("extrapolated", Extrapolated), of_heads, by_point),
    ];
    assert!(all.iter().all(|[_, wrong, _]| *wrong == 0), "{all:?}");
    let right: u32 = all.iter().map(|[right, ..]| right).sum();
    assert!(right >= 10, "{all:?}");
}
