//! D8: a declared start was changed without a report, though the other coordinates could meet the rows.

use core::f64::consts::FRAC_PI_2;

use mbs_runtime::dynamics::{
    AugmentedLagrangian, DormandPrince8, Explicit, Projection, Simulation, VelocityTransformation,
};
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    /// A slider-crank whose rod is as long as its crank: with the crank upright the slider is at the pivot and the bars are in line.
    pub mechanism Isosceles;
    param r: m = 0.18;
    param L: m = 0.18;
    param th0: rad = 1.5707963;
    param w0: rad/s = 3;
    coord th: rad = 0.8;
    coord phi: rad = -0.24;
    coord x: m = 0.2;
    body crank { mass: 1, inertia: 1e-3, com: r/2*unit(th), angle: th }
    body rod { mass: 1, inertia: 1e-3, com: r*unit(th) + L/2*unit(phi), angle: phi }
    body slider { mass: 1, com: [x, 0] }
    constraint closure { r*unit(th) + L*unit(phi) == [x, 0]; }
    start th = th0 rate w0;
}

mechanism! {
    /// The same with the crank pin as a point.
    pub mechanism IsoscelesPoints;
    param r: m = 0.18;
    param L: m = 0.18;
    param th0: rad = 1.5707963;
    param w0: rad/s = 3;
    coord th: rad = 0.8;
    coord A: [m; 2] = [0.1, 0.1];
    coord x: m = 0.2;
    body crank { mass: 1, com: A }
    body slider { mass: 1, com: [x, 0] }
    constraint pin { A == r*unit(th); }
    constraint rod { norm(A - [x, 0]) == L; }
    start th = th0 rate w0;
}

/// Slider and its speed in the assembly in which it moves, and in the one in which it stays at the pivot.
fn exact(r: f64, th: f64, w: f64) -> [(f64, f64); 2] {
    [(2.0 * r * th.cos(), -2.0 * r * th.sin() * w), (0.0, 0.0)]
}

/// Start angles from far off the upright crank to 2.7e-8 rad from it. There the columns of the other coordinates have a singular
/// value of the same size.
#[allow(clippy::approx_constant, reason = "numbers as a text has them, beside the upright crank")]
const ANGLES: [f64; 13] =
    [0.3, 1.2, 1.5, 1.57, 1.5707, 1.57079, 1.570796, 1.5707963, 1.5708, 1.6, 2.5, -0.4, -1.5707963];

#[test]
fn a_declared_start_is_kept_though_the_others_nearly_lose_rank() {
    let method = || Explicit::new(DormandPrince8, Projection::default());
    for th0 in ANGLES {
        for w0 in [3.0, -3.0, 0.1, 0.0] {
            let angles = Isosceles { th0, w0, ..Isosceles::default() };
            let angles = Simulation::start_from_text(angles, method(), 0.0).unwrap();
            let points = IsoscelesPoints { th0, w0, ..IsoscelesPoints::default() };
            let points = Simulation::start_from_text(points, method(), 0.0).unwrap();
            assert_eq!((angles.moved_start(), points.moved_start()), (None, None));
            let (q, qd, p, pd) = (angles.q(), angles.qd(), points.q(), points.qd());
            for (th, w, x, v) in [(q[0], qd[0], q[2], qd[2]), (p[0], pd[0], p[3], pd[3])] {
                assert!((th - th0).abs() < 1e-14 && (w - w0).abs() < 1e-13, "{th0} {w0}: {th} {w}");
                // 1e-5: next to singular values of ∛ε, 6e-6, neither derivative of the rows determines a rate better.
                let error =
                    exact(0.18, th0, w0).map(|(place, speed)| (x - place).abs().max((v - speed).abs()));
                assert!(error[0].min(error[1]) < 1e-5, "{th0} {w0}: x {x}, v {v}, {error:?}");
            }
        }
    }
}

#[test]
fn a_kept_start_is_kept_by_every_method() {
    let m = || Isosceles::<f64> { th0: 1.5, ..Isosceles::default() };
    let velocity = Explicit::new(DormandPrince8, VelocityTransformation);
    let starts = [
        Simulation::start_from_text(m(), velocity, 0.0)
            .map(|run| (*run.q(), *run.qd(), run.moved_start().is_some())),
        Simulation::start_from_text(m(), AugmentedLagrangian, 0.0)
            .map(|run| (*run.q(), *run.qd(), run.moved_start().is_some())),
    ];
    for start in starts {
        let (q, qd, moved) = start.unwrap();
        assert!(!moved && q[0] == 1.5 && (qd[0] - 3.0).abs() < 1e-14, "{q:?} {qd:?}");
    }
}

#[test]
fn a_declared_start_is_kept_in_single_precision() {
    for th0 in [0.3_f32, 1.5, 1.56, 1.6, 2.5] {
        let m = Isosceles::<f32> { th0, ..Isosceles::default() };
        let run = Simulation::start_from_text(m, Explicit::new(DormandPrince8, Projection::default()), 0.0)
            .unwrap();
        let (q, qd) = (run.q(), run.qd());
        assert!(
            run.moved_start().is_none() && (q[0] - th0).abs() < 1e-6 && (qd[0] - 3.0).abs() < 1e-4,
            "{q:?} {qd:?}"
        );
    }
}

#[test]
fn rates_on_a_change_point_that_belong_to_no_motion_are_undecided() {
    // Upright the slider may stay at the pivot or leave it: the rate of the crank does not decide that.
    let method = || Explicit::new(DormandPrince8, Projection::default());
    let m = Isosceles::<f64> { th0: FRAC_PI_2, ..Isosceles::default() };
    let start = Simulation::start_from_text(m, method(), 0.0).map(|run| (*run.q(), *run.qd()));
    assert!(matches!(start, Err(Failure { kind: FailureKind::Undecided { .. }, .. })), "{start:?}");
    // At rest nothing is to be decided yet.
    let m = Isosceles::<f64> { th0: FRAC_PI_2, w0: 0.0, ..Isosceles::default() };
    assert!(Simulation::start_from_text(m, method(), 0.0).unwrap().moved_start().is_none());
}

mechanism! {
    /// A start that is declared twice: the rod tells the place of the slider, and so does the text.
    pub mechanism TwiceStarted;
    param x0: m = 0.3;
    coord th: rad = 0.8;
    coord phi: rad = -0.24;
    coord x: m = 0.2;
    body crank { mass: 1, inertia: 1e-3, com: 0.05m*unit(th), angle: th }
    body slider { mass: 1, com: [x, 0] }
    constraint closure { 0.1m*unit(th) + 0.25m*unit(phi) == [x, 0]; }
    start th = 1 rate 2;
    start x = x0 rate 0;
}

#[test]
fn a_start_that_must_move_is_told_with_its_numbers() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(TwiceStarted::<f64>::default(), method, 0.0).unwrap();
    let moved = run.moved_start().expect("the rod has one length");
    let q = TwiceStartedCoordinates::from(*run.q());
    assert!(!moved.rate && ["th", "x"].contains(&moved.coordinate.name), "{moved:?}");
    let (declared, actual) = if moved.coordinate.name == "x" { (0.3, q.x) } else { (1.0, q.th) };
    assert_eq!((moved.declared, moved.actual), (declared, actual));
    assert!((q.th - 1.0).abs() > 1e-3 || (q.x - 0.3).abs() > 1e-3, "one of both moved: {q:?}");
    // The place that belongs to th = 1, and a rate that does not.
    let x0 = 0.1 * 1.0_f64.cos() + (0.0625 - 0.01 * 1.0_f64.sin().powi(2)).sqrt();
    let run = Simulation::start_from_text(TwiceStarted::<f64> { x0 }, method, 0.0).unwrap();
    let moved = run.moved_start().expect("both rates cannot be");
    assert!(moved.rate && (run.q()[0] - 1.0).abs() < 1e-14, "{moved:?} {:?}", run.q());
}

#[test]
fn a_start_next_to_given_numbers_tells_what_it_moved() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let m = TwiceStarted::<f64>::default();
    let run = Simulation::start_near(m, method, 0.0, [1.0, -0.3, 0.4], [0.0; 3]).unwrap();
    assert!(run.moved_start().is_some_and(|moved| !moved.rate));
    let again =
        Simulation::start_near(TwiceStarted::<f64>::default(), method, 0.0, *run.q(), *run.qd()).unwrap();
    assert_eq!(again.moved_start(), None);
}

mechanism! {
    /// A crank that a drive holds, with a start that is a guess; the pendulum on it is started.
    pub mechanism DrivenPivot;
    coord th: rad = 0;
    coord phi: rad = 0;
    coord P: [m; 2] = [0.5, 0];
    body bob { mass: 1, com: P }
    constraint rod { P == 0.1m*unit(th) + 0.4m*unit(phi); }
    drive crank: th == 0.7 + 2*t/1s;
    start th = 0.5 rate 0;
    start phi = -1 rate 0.5;
}

#[test]
fn the_start_of_a_driven_coordinate_is_a_guess() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(DrivenPivot::<f64>::default(), method, 0.0).unwrap();
    let (q, qd) = (DrivenPivotCoordinates::from(*run.q()), DrivenPivotCoordinates::from(*run.qd()));
    assert!(run.moved_start().is_none() && q.phi == -1.0 && (qd.phi - 0.5).abs() < 1e-14, "{q:?} {qd:?}");
    assert!((q.th - 0.7).abs() < 1e-15 && (qd.th - 2.0).abs() < 1e-14, "{q:?} {qd:?}");
}

mechanism! {
    /// A four-bar whose guess is of the other assembly than its branch.
    pub mechanism Opened;
    coord phi1: rad = 0;
    coord phi2: rad = 0.2;
    coord phi3: rad = -1;
    body crank { mass: 1, inertia: 1e-3, com: 0.05m*unit(phi1), angle: phi1 }
    body coupler { mass: 1, inertia: 1e-3, com: 0.1m*unit(phi1) + 0.12m*unit(phi2), angle: phi2 }
    constraint closure { 0.1m*unit(phi1) + 0.25m*unit(phi2) == [0.3m, 0] + 0.2m*unit(phi3); }
    branch open: sin(phi3 - phi2) > 0;
    start phi1 = 0.4 rate 5;
}

#[test]
fn a_declared_start_is_kept_in_the_declared_branch_from_a_guess_of_the_other() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Opened::<f64>::default(), method, 0.0).unwrap();
    let q = OpenedCoordinates::from(*run.q());
    assert!(run.moved_start().is_none() && q.phi1 == 0.4 && (q.phi3 - q.phi2).sin() > 0.0, "{q:?}");
}

mechanism! {
    /// A mass that slides along an inclined line.
    pub mechanism Inclined;
    param slope: rad = 0.3;
    coord p: [m; 2] = [0, 0];
    body b { mass: 1, com: p }
    constraint line { det(unit(slope), p) == 0; }
}

#[test]
fn a_consistent_start_in_single_precision_may_have_the_rounding_of_its_type() {
    for k in 1..=1000u16 {
        let (slope, speed) = (f32::from(k) * 1.5e-3, f32::from(k % 7 + 1));
        let along = |size: f32| [size * slope.cos(), size * slope.sin()];
        let inclined: Inclined<f32> = Inclined { slope };
        let method = Explicit::new(DormandPrince8, Projection::default());
        let run = Simulation::start(inclined, method, 0.0, along(1.7), along(speed));
        assert!(run.is_ok(), "{slope}: {:?}", run.map(|run| *run.q()));
        // A rate with an error of more than its digits is refused.
        let [x, y] = along(speed);
        let rates = [x - 1e-4 * speed * slope.sin(), y + 1e-4 * speed * slope.cos()];
        let off = Simulation::start(inclined, method, 0.0, along(1.7), rates);
        assert!(
            matches!(off, Err(Failure { kind: FailureKind::OffConstraints { rate: true, .. }, .. })),
            "{slope}"
        );
    }
}
