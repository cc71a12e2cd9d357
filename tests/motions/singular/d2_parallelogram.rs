//! D2: a parallelogram of three bars in angles, which stopped with its bars in line under default methods and tolerances.

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, Formulation, Projection, Simulation, Tolerance, VelocityTransformation,
};
use mbs_runtime::mechanism;

mechanism! {
    /// Crank and rocker of 0.1 m, a coupler of 0.3 m.
    pub mechanism Parallelogram;
    param r: m = 0.1;
    param b: m = 0.3;
    param speed: rad/s = -20;
    coord phi1: rad = 90deg;
    coord phi2: rad = 0;
    coord phi3: rad = 90deg;
    body crank { mass: 1, inertia: 1e-3, com: r/2*unit(phi1), angle: phi1 }
    body coupler { mass: 2, inertia: 2e-2, com: r*unit(phi1) + b/2*unit(phi2), angle: phi2 }
    body rocker { mass: 1, inertia: 1e-3, com: [b, 0] + r/2*unit(phi3), angle: phi3 }
    gravity weight { acceleration: [0, -9.81] }
    constraint closure { r*unit(phi1) + b*unit(phi2) == [b, 0] + r*unit(phi3); }
    start phi1 = 90deg rate speed;
}

const SECONDS: f64 = 10.0;

/// The crank's angle (rad) after ten seconds, by a composition of leapfrogs. The coupler does not turn:
/// I φ̈ = −S g cos φ with I = 2 (1e-3 + r²/4) + 2 r², S = 3 r. Source: Yoshida 1990.
fn exact(r: f64, speed: f64) -> f64 {
    const STEPS: u32 = 200_000;
    let stiffness = 9.81 * 3.0 * r / (2.0 * (1e-3 + r * r / 4.0) + 2.0 * r * r);
    let h = SECONDS / f64::from(STEPS);
    let outer = 1.0 / (2.0 - 2.0_f64.cbrt());
    let (mut angle, mut rate) = (core::f64::consts::FRAC_PI_2, speed);
    for _ in 0..STEPS {
        for share in [outer, 1.0 - 2.0 * outer, outer] {
            angle += 0.5 * share * h * rate;
            rate -= share * h * stiffness * angle.cos();
            angle += 0.5 * share * h * rate;
        }
    }
    angle
}

/// Error of the crank's angle, and the coupler's angle (rad) after ten seconds.
fn errors<F: Formulation<Parallelogram, f64, 3, 2>>(
    formulation: F,
    (text, tolerance): (Parallelogram, f64),
) -> [f64; 2] {
    let angle = exact(text.r, text.speed);
    let run = Simulation::start_from_text(text, Explicit::new(DormandPrince8, formulation), 0.0)
        .expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(tolerance));
    run.advance_to(SECONDS).unwrap_or_else(|failure| panic!("{tolerance:e}: {failure}"));
    [(run.q()[0] - angle).abs(), run.q()[1].abs()]
}

#[test]
fn a_parallelogram_of_three_bars_passes_with_its_bars_in_line_at_every_tolerance() {
    // Some 60 turns: errors of the energy come back as errors of the angle, 1e4 times the tolerance of a step.
    for tolerance in [1e-8, 1e-9, 1e-10, 1e-11] {
        let mut largest = [0.0_f64; 2];
        for k in 0..10 {
            let share = f64::from(k) / 10.0;
            let text =
                || Parallelogram { r: 0.1 + 0.02 * share, b: 0.3 - 0.05 * share, speed: -20.0 - share };
            for found in [
                errors(Projection::default(), (text(), tolerance)),
                errors(VelocityTransformation, (text(), tolerance)),
            ] {
                largest = [largest[0].max(found[0]), largest[1].max(found[1])];
            }
        }
        println!(
            "parallelogram, {tolerance:e}: angle {:.1e} rad, coupler {:.1e} rad",
            largest[0], largest[1]
        );
        assert!(largest[0] < 1e4 * tolerance && largest[1] < tolerance, "{largest:?}");
    }
}

mechanism! {
    /// The crank alone, with the inertia and the weight of all three bars.
    pub mechanism Crank;
    param inertia: kg*m^2 = 1;
    param weight: N*m = 1;
    param speed: rad/s = -20;
    coord phi: rad = 90deg;
    body crank { mass: 0, inertia: inertia, com: [0, 0], angle: phi }
    potential height = weight*sin(phi);
    start phi = 90deg rate speed;
}

#[test]
fn no_run_of_one_crank_is_far_less_accurate_than_its_neighbours() {
    let error = |k: u32| {
        let share = f64::from(k) / 100.0;
        let (r, speed) = (0.1 + 0.02 * share, -20.0 - share);
        let inertia = 2.0 * (1e-3 + r * r / 4.0) + 2.0 * r * r;
        let crank = Crank { inertia, weight: 9.81 * 3.0 * r, speed };
        let method = Explicit::new(DormandPrince8, Projection::default());
        let run = Simulation::start_from_text(crank, method, 0.0).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(1e-8));
        run.advance_to(SECONDS).expect("it turns");
        (run.q()[0] - exact(r, speed)).abs()
    };
    let mut errors: Vec<f64> = (0..100).map(error).collect();
    errors.sort_by(f64::total_cmp);
    let [median, largest] = [errors[50], errors[99]];
    println!("one crank at 1e-8: median {median:.1e} rad, largest {largest:.1e} rad");
    // With growth by six the largest of a hundred was 30 times the median.
    assert!(largest < 5.0 * median, "{largest:e} {median:e}");
}
