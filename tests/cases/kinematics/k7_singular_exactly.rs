//! K7: a step that ends exactly at a change point was reported as one that did not converge in natural coordinates.

use std::f64::consts::{FRAC_PI_2, PI};

use mbs_runtime::{Failure, FailureKind, Kinematic, Real, Stepper, mechanism};

mechanism! {
    /// A parallelogram by the points of its joints, its crank turned by the time.
    pub mechanism Points;
    coord A: [m; 2] = [1, 0.4];
    coord B: [m; 2] = [3, 0.4];
    constraint crank { A == 1m*unit(t/1s); }
    constraint bars { norm(B - A) == 2m; norm(B - [2m, 0]) == 1m; }
}

mechanism! {
    /// The same with squares, and an angle that is driven.
    pub mechanism Squares;
    coord phi: rad = 0.4;
    coord A: [m; 2] = [1, 0.4];
    coord B: [m; 2] = [3, 0.4];
    constraint crank { A == 1m*unit(phi); }
    constraint bars { dot(B - A, B - A) == 4 [m^2]; dot(B - [2m, 0], B - [2m, 0]) == 1 [m^2]; }
    drive motor: phi == t*1/1s;
}

mechanism! {
    /// The same by an input, and the crank's row a length too.
    pub mechanism Measured;
    input theta: rad, rates;
    coord A: [m; 2] = [1, 0.4];
    coord B: [m; 2] = [3, 0.4];
    constraint crank { norm(A) == 1m; dot(A, [-sin(theta), cos(theta)]) == 0; }
    constraint bars { norm(B - A) == 2m; norm(B - [2m, 0]) == 1m; }
    branch same: dot(A, unit(theta)) > 0;
}

mechanism! {
    /// The same by angles.
    pub mechanism Angles;
    coord p1: rad = 0.4;
    coord p2: rad = 0;
    coord p3: rad = 0.4;
    constraint closure { 1m*unit(p1) + 2m*unit(p2) == [2m, 0] + 1m*unit(p3); }
    drive motor: p1 == t*1/1s;
}

mechanism! {
    /// A slider whose rod is as long as its crank: it is singular where the crank stands upright.
    pub mechanism Slider;
    coord A: [m; 2] = [0.92, 0.38];
    coord x: m = 1.84;
    constraint crank { A == 1m*unit(t/1s); }
    constraint rod { norm([x, 0] - A) == 1m; }
}

/// Results of steps that end exactly at a singular position, as numbers of (singular, right positions, others).
fn steps_onto<S: Kinematic<R, N>, R: Real, const N: usize>(
    start: impl Fn() -> Stepper<S, R, N>,
    place: f64,
    turn: impl Fn(&mut Stepper<S, R, N>, R) -> Result<(), Failure>,
) -> [usize; 3] {
    let mut told = [0; 3];
    for h in [1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 0.5, 1.0] {
        for part in [0.0, 0.01, 0.37, 0.62] {
            let from = place - h * (1.0 + part);
            let mut stepper = start();
            let count = ((from - 0.4) / 0.05).ceil().max(1.0);
            let first = (1..=count as u32).map(|k| 0.4 + (from - 0.4) * f64::from(k) / count);
            for theta in first {
                if let Err(failure) = turn(&mut stepper, R::constant(theta)) {
                    panic!("{theta} {failure}")
                }
            }
            let before = *stepper.q();
            match turn(&mut stepper, R::constant(place)) {
                Err(Failure { kind: FailureKind::Singular { margin, required, .. }, .. }) => {
                    assert!(margin < required && *stepper.q() == before);
                    told[0] += 1;
                }
                Ok(()) => told[1] += 1,
                Err(other) => {
                    println!("{h} {part}: {other}");
                    told[2] += 1;
                }
            }
        }
    }
    told
}

fn to<S: Kinematic<R, N>, R: Real, const N: usize>(
    stepper: &mut Stepper<S, R, N>,
    t: R,
) -> Result<(), Failure> {
    stepper.advance_to(t).map(|_| ())
}

fn by_input(stepper: &mut Stepper<Measured<f64>, f64, 4>, theta: f64) -> Result<(), Failure> {
    stepper.change(|measured| measured.theta.value = theta);
    stepper.advance(0.0).map(|_| ())
}

fn guessed<S: Kinematic<R, N>, R: Real, const N: usize>(mechanism: S) -> Stepper<S, R, N> {
    let guess = mechanism.guess(&mechanism.parameters());
    Stepper::assemble(mechanism, guess, R::constant(0.4)).expect("it assembles")
}

#[test]
fn a_step_exactly_onto_a_change_point_is_singular() {
    assert_eq!(steps_onto(|| guessed::<Points<f64>, f64, 4>(Points::default()), PI, to), [32, 0, 0]);
    assert_eq!(steps_onto(|| guessed::<Squares<f64>, f64, 5>(Squares::default()), PI, to), [32, 0, 0]);
    assert_eq!(steps_onto(|| guessed::<Angles<f64>, f64, 3>(Angles::default()), PI, to), [32, 0, 0]);
    assert_eq!(steps_onto(|| guessed::<Slider<f64>, f64, 3>(Slider::default()), FRAC_PI_2, to), [32, 0, 0]);
    let measured = || {
        let mut measured = Measured::<f64>::default();
        measured.theta.value = 0.4;
        guessed(measured)
    };
    assert_eq!(steps_onto(measured, PI, by_input), [32, 0, 0]);
}
