//! D31: a start within 1e-9 of a set where the gradient of a row vanishes was held to be doubtful: `cos(a) == cos(b)` has the branches
//! a = b and a = −b, which cross there.
//!
//! The start is refused, or the motion follows the branch of its rates.

use core::f64::consts::PI;

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, Formulation, Projection, RungeKutta4, Simulation, VelocityTransformation,
};
use mbs_runtime::{Failure, FailureKind, Mechanism, Stepper, mechanism};

mechanism! {
    /// Two wheels whose cosines agree.
    mechanism Wheels;
    param a0: rad = 0.1;
    param b0: rad = 0.1;
    param speed: rad/s = 1;
    coord a: rad = a0;
    coord b: rad = b0;
    body first { mass: 1, inertia: 1, com: [0, 0], angle: a }
    body second { mass: 1, inertia: 2, com: [0, 0], angle: b }
    torque push: 0.3 on a;
    torque brake: -0.1 on b;
    constraint tie { cos(a) == cos(b); }
    start a = a0 rate 1;
    start b = b0 rate speed;
}

mechanism! {
    /// The same row under a drive: the second wheel turns either way.
    mechanism Driven;
    param a0: rad = 0.1;
    coord a: rad = a0;
    coord b: rad = a0;
    constraint tie { cos(a) == cos(b); }
    drive crank: a == a0 + 1 [rad/s]*t;
}

/// Half a second of adaptive steps: the angles, and how far the start has moved the rates.
fn turned<F: Formulation<Wheels, f64, 2, 1>>(
    wheels: Wheels,
    formulation: F,
) -> Result<([f64; 2], f64), Failure> {
    let method = Explicit::new(DormandPrince8, formulation);
    let mut run = Simulation::start_from_text(wheels, method, 0.0)?;
    let moved = (run.qd()[0] - 1.0).abs().max((run.qd()[1] - wheels.speed).abs());
    run.advance_to(0.5)?;
    Ok((*run.q(), moved))
}

/// The same in 500 equal steps.
fn stepped(wheels: Wheels) -> Result<([f64; 2], f64), Failure> {
    let method = Explicit::new(RungeKutta4, Projection::default());
    let mut run = Simulation::start_from_text(wheels, method, 0.0)?;
    let moved = (run.qd()[0] - 1.0).abs().max((run.qd()[1] - wheels.speed).abs());
    for _ in 0..500 {
        run.step(1e-3)?;
    }
    Ok((*run.q(), moved))
}

/// Distances from the singular set: below the resolution of its cosine, and above.
const NEAR: [f64; 8] = [1e-14, 1e-12, 1e-10, 3e-10, 1e-9, 3e-9, 1e-8, 1e-7];

#[test]
fn a_start_next_to_vanishing_rows_is_refused_or_follows_its_rates() {
    let (mut right, mut refused) = (0, 0);
    for distance in NEAR {
        for ratio in [1.0, 0.99, 0.5, 0.0, -0.5, -1.0, 2.0] {
            for speed in [1.0, 0.5, 0.0, -1.0] {
                for offset in [0.0, PI] {
                    let (a0, b0) = (offset + distance, offset + ratio * distance);
                    let wheels = Wheels { a0, b0, speed };
                    let runs = [
                        turned(wheels, Projection::default()),
                        turned(wheels, VelocityTransformation),
                        stepped(wheels),
                    ];
                    for run in runs {
                        let Ok((q, moved)) = run else {
                            refused += 1;
                            continue;
                        };
                        let [a, b] = q.map(|angle| angle - offset);
                        let open = match speed {
                            1.0 => (a - b).abs(),
                            -1.0 => (a + b).abs(),
                            // The rates of neither branch.
                            _ => f64::INFINITY,
                        };
                        assert!(open < 1e-6 && moved < 1e-6, "{a0:e} {b0:e} {speed}: {a:e} {b:e}, {moved:e}");
                        right += 1;
                    }
                }
            }
        }
    }
    println!("{right} motions right, {refused} starts refused");
    assert!(right > 600 && refused > 600);
}

#[test]
fn a_position_next_to_vanishing_rows_is_refused_where_its_rates_are_lost() {
    for distance in NEAR {
        for a0 in [distance, -distance, PI + distance] {
            let driven = Driven { a0 };
            let guess = driven.guess(&driven.parameters());
            let failure =
                Stepper::assemble(driven, guess, 0.0).map(|_| ()).expect_err("half of the digits are gone");
            assert!(matches!(failure.kind, FailureKind::Singular { .. }), "{a0:e}: {failure}");
        }
    }
    // Farther off the branch of the guess is followed.
    let driven: Driven = Driven { a0: 1e-3 };
    let mut motion = Stepper::assemble(driven, [1e-3; 2], 0.0).expect("regular");
    for _ in 0..100 {
        motion.advance(0.01).expect("it turns");
    }
    assert!((motion.q()[0] - motion.q()[1]).abs() < 1e-9);
}
