//! K5: accelerations at margins of 0.01 to 0.1 had 7 to 9 digits because of the residual of Newton's method in the position.

use mbs_runtime::{Batch, Budget, Kinematic, Lanes, Step, Stepper, mechanism};

mechanism! {
    /// A slider on a rod that is too short for a whole turn: its end as a point.
    pub mechanism Point;
    coord A: [m; 2] = [0.95, 0.3];
    coord B: [m; 2] = [1.7, 0];
    constraint crank { A == 1m*unit(t/1s); }
    constraint rod { norm(B - A) == 0.8414709848078965m; B.1 == 0; }
    branch right: B.0 - A.0 > 0;
}

mechanism! {
    /// The same by squares of lengths.
    pub mechanism Squares;
    coord A: [m; 2] = [0.95, 0.3];
    coord B: [m; 2] = [1.7, 0];
    constraint crank { A == 1m*unit(t/1s); }
    constraint rod { dot(B - A, B - A) == (0.8414709848078965m)^2; B.1 == 0; }
    branch right: B.0 - A.0 > 0;
}

mechanism! {
    /// The same by the angle of the rod.
    pub mechanism Angles;
    coord phi: rad = 0.3;
    coord psi: rad = -0.4;
    coord x: m = 1.7;
    constraint loop_abc { 1m*unit(phi) + 0.8414709848078965m*unit(psi) == [x, 0]; }
    drive crank: phi == t*1/1s;
    branch right: cos(psi) > 0;
}

/// Velocity and acceleration of the slider at a crank angle (rad), at 1 rad/s.
fn exact(theta: f64) -> [f64; 3] {
    let (sine, cosine) = theta.sin_cos();
    // The length of the rod less sin 1, which it would be in exact numbers.
    let rounding = -1.776_845_092_935_536e-18;
    let missing = rounding + 2.0 * (0.5 * (1.0 + theta)).cos() * (0.5 * (1.0 - theta)).sin();
    let root = (missing * (0.841_470_984_807_896_5 + sine)).sqrt();
    let (square, product) = (cosine * cosine - sine * sine, sine * cosine);
    let acceleration = -cosine - square / root - product * product / (root * root * root);
    [cosine + root, -sine - product / root, acceleration]
}

/// Results of `step` for 3000 positions (m, distance to the end of the range at 1) and step lengths, which begin farther
/// away.
fn errors<X>(mut step: impl FnMut(f64, f64) -> X) -> Vec<X> {
    let mut seed = 12345_u64;
    let places = (0..3000).map(|k| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let random = (seed >> 11) as f64 / (1_u64 << 53) as f64;
        let gap = 10_f64.powf(-5.5 + 5.2 * f64::from(k) / 3000.0);
        step(1.0 - gap, gap * (0.01 + 0.5 * random))
    });
    places.collect()
}

fn error(found: f64, theta: f64) -> f64 {
    let [_, _, acceleration] = exact(theta);
    ((found - acceleration) / acceleration).abs()
}

fn assembled<S: Kinematic<f64, N> + Default, const N: usize>(t: f64) -> Stepper<S, f64, N> {
    let mechanism = S::default();
    let guess = mechanism.guess(&mechanism.parameters());
    Stepper::assemble(mechanism, guess, t).expect("it assembles")
}

/// Largest allowed error at a margin μ: rounding of the rows over μ², and a residual that is not worth a further step.
///
/// Rounding: rows of some four terms have errors of 3 ε at most, and a residual r causes 6 r/μ² in the acceleration. Residual:
/// 1e-11 from a margin of 0.017 on.
fn allowed(margin: f64) -> f64 {
    let rounding = 30.0 * f64::EPSILON / (margin * margin);
    rounding.max(1e-11_f64.min(64.0 * rounding))
}

#[test]
fn accelerations_keep_the_digits_that_the_margin_leaves() {
    fn advanced<S: Kinematic<f64, N> + Default, const N: usize>(slider: usize) -> Vec<[f64; 2]> {
        errors(|theta, h| {
            let mut stepper = assembled::<S, N>(theta - h);
            stepper.advance_to(theta).expect("it moves");
            [stepper.margin(), error(stepper.qdd()[slider], theta)]
        })
    }
    for found in [advanced::<Point<f64>, 4>(2), advanced::<Squares<f64>, 4>(2), advanced::<Angles<f64>, 3>(2)]
    {
        let small = found.iter().filter(|[margin, _]| (0.011..0.1).contains(margin)).count();
        assert!(small > 500, "{small}");
        for [margin, error] in found {
            assert!(error < allowed(margin), "{margin}: {error:e}, allowed {:e}", allowed(margin));
        }
    }
}

#[test]
fn steps_of_bounded_work_and_lanes_keep_them_too() {
    let budget = Budget { newton: 6, fallback: 6 };
    let stepped = errors(|theta, h| {
        let mut stepper = assembled::<Point<f64>, 4>(theta - h);
        let step = stepper.step(theta - stepper.t(), budget);
        (step, stepper.t(), stepper.margin(), stepper.qdd()[2])
    });
    for (step, t, margin, acceleration) in stepped {
        // A budget may be too small for a step that long; the accepted ones are right.
        if matches!(step, Step::Done(_)) {
            assert!(error(acceleration, t) < allowed(margin), "{margin}: {:e}", error(acceleration, t));
        }
    }
    let guess = [0.95, 0.3, 1.7, 0.0];
    let in_lanes = errors(|theta, h| {
        let starts = [1.0, 0.7, 0.4, 0.1].map(|part| theta - part * h);
        let mut batch =
            Batch::<_, f64, 4, 4>::assemble(Point::<Lanes<f64, 4>>::default(), &[guess; 4], starts)
                .expect("it assembles");
        assert!(batch.advance_to([theta; 4]).iter().all(Result::is_ok));
        (0..4)
            .map(|lane| [batch.stepper(lane).expect("a lane").margin(), error(batch.qdd()[2].0[lane], theta)])
            .collect::<Vec<_>>()
    });
    for [margin, error] in in_lanes.into_iter().flatten() {
        assert!(error < allowed(margin), "{margin}: {error:e}");
    }
}

#[test]
fn a_motion_in_equal_steps_keeps_them() {
    for h in [1e-4, 3e-4, 1e-3, 3e-3] {
        let mut stepper = assembled::<Point<f64>, 4>(0.3);
        let count = ((1.0 - 2e-4 - 0.3) / h) as u32;
        for k in 1..=count {
            let theta = 0.3 + h * f64::from(k);
            stepper.advance_to(theta).expect("it moves");
            let error = error(stepper.qdd()[2], theta);
            assert!(error < allowed(stepper.margin()), "{h}, {}: {error:e}", stepper.margin());
        }
    }
}

mechanism! {
    /// A parallelogram by its points.
    pub mechanism Parallelogram;
    coord A: [m; 2] = [0.9, 0.5];
    coord B: [m; 2] = [2.9, 0.5];
    constraint crank { A == 1m*unit(t/1s); }
    constraint bars { norm(B - A) == 2m; norm(B - [2m, 0]) == 1m; }
}

/// A residual r was left as if its error were r/μ². It is r/μ³ here: 6e-11 at 0.1.
#[test]
fn of_a_parallelogram_by_its_points() {
    let at = |t: f64| [t.cos(), t.sin(), 2.0 + t.cos(), t.sin()];
    let mut count = 0;
    errors(|theta, h| {
        // The change point is at π.
        let t = core::f64::consts::PI - (1.0 - theta);
        let Ok(mut stepper) = Stepper::<_, f64, 4>::assemble(Parallelogram::default(), at(t - h), t - h)
        else {
            return;
        };
        if stepper.advance_to(t).is_ok() && stepper.margin() > 1e-3 {
            let margin = stepper.margin();
            let error = (stepper.qdd()[3] + t.sin()).abs();
            let allowed = 1e-11_f64.max(64.0 * f64::EPSILON / (margin * margin * margin));
            assert!(error < allowed, "{t} {h}: margin {margin}, error {error:e}");
            count += 1;
        }
    });
    assert!(count > 1000, "{count}");
}
