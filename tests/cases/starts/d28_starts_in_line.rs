//! D28: bars that turn could not start in line, for want of a row that holds them there.

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, GeneralizedAlpha, Penalty, Projection, RungeKutta4, Simulation, Unstabilized,
    VelocityTransformation,
};
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    /// Crank and rocker of 0.1 m, a coupler of 0.3 m.
    pub mechanism Parallelogram;
    param r: m = 0.1;
    const b: m = 0.3;
    coord phi1: rad = 90deg;
    coord phi2: rad = 0;
    coord phi3: rad = 90deg;
    body crank { mass: 1, inertia: 1e-3, com: r/2*unit(phi1), angle: phi1 }
    body coupler { mass: 2, inertia: 2e-2, com: r*unit(phi1) + b/2*unit(phi2), angle: phi2 }
    body rocker { mass: 1, inertia: 1e-3, com: [b, 0] + r/2*unit(phi3), angle: phi3 }
    gravity weight { acceleration: [0, -9.81] }
    constraint closure { r*unit(phi1) + b*unit(phi2) == [b, 0] + r*unit(phi3); }
}

mechanism! {
    /// Two cranks and a bar: one row, which vanishes in line.
    pub mechanism TwoCranks;
    coord phi1: rad = 0;
    coord phi3: rad = 0;
    let A = 0.1m*unit(phi1);
    let B = [0.3m, 0m] + 0.1m*unit(phi3);
    body one { mass: 1, com: A }
    body other { mass: 1, com: B }
    gravity weight { acceleration: [0, -9.81] }
    constraint bar { norm(B - A) == 0.3m; }
}

mechanism! {
    /// The same in coordinates of the points: no row vanishes, two depend on each other in line.
    pub mechanism TwoPoints;
    coord p: [m; 2] = [0, 0.1];
    coord q: [m; 2] = [0.3, 0.1];
    body one { mass: 1, com: p }
    body other { mass: 1, com: q }
    gravity weight { acceleration: [0, -9.81] }
    constraint one_arm { norm(p) == 0.1m; }
    constraint bar { norm(q - p) == 0.3m; }
    constraint other_arm { norm(q - [0.3m, 0m]) == 0.1m; }
}

/// I/S g of all bars about the crank's angle.
const STIFFNESS: f64 = 9.81 * 0.3 / (2.0 * (1e-3 + 0.01 / 4.0) + 0.02);

/// Largest change of the energy over `stiffness`, relative to the start, and of the angle between crank and rocker (rad).
fn of_uprights([angle, other]: [f64; 2], rate: f64, start: f64, stiffness: f64) -> [f64; 2] {
    let defect = 0.5 * rate * rate + stiffness * angle.sin() - 0.5 * start * start;
    [(defect / (0.5 * start * start)).abs(), (angle - other).abs()]
}

/// Runs a start in line for two seconds.
macro_rules! run {
    ($text:expr, $method:expr, $q:expr, $qd:expr) => {{
        let mut run = Simulation::start($text, $method, 0.0, $q, $qd).expect("it starts");
        let qdd = *run.qdd();
        assert_eq!(run.margin(), 0.0);
        run.advance_to(2.0).expect("it turns");
        (*run.q(), *run.qd(), qdd)
    }};
}

fn methods() -> (Explicit<DormandPrince8, Projection>, Explicit<DormandPrince8, VelocityTransformation>) {
    (Explicit::default(), Explicit::default())
}

#[test]
fn a_parallelogram_starts_in_line_with_both_kinds_of_rates() {
    for speed in [5.0, 20.0] {
        let (projected, transformed) = methods();
        let parallel = [speed, 0.0, speed];
        let runs = [
            run!(Parallelogram::<f64>::default(), projected, [0.0; 3], parallel),
            run!(Parallelogram::<f64>::default(), transformed, [0.0; 3], parallel),
        ];
        for (q, qd, qdd) in runs {
            let [defect, turned] = of_uprights([q[0], q[2]], qd[0], speed, STIFFNESS);
            assert!(defect < 1e-7 && turned < 1e-9 && q[1].abs() < 1e-9, "{q:?} {defect:e}");
            let wanted = [-STIFFNESS, 0.0, -STIFFNESS];
            assert!(qdd.iter().zip(wanted).all(|(qdd, wanted)| (qdd - wanted).abs() < 1e-9), "{qdd:?}");
        }
        // The other assembly: crank and coupler cross.
        let crossed = [speed, -speed, -2.0 * speed];
        let (q, _, qdd) = run!(Parallelogram::<f64>::default(), projected, [0.0; 3], crossed);
        let (other, _, others) = run!(Parallelogram::<f64>::default(), transformed, [0.0; 3], crossed);
        assert!(q.iter().zip(other).all(|(q, other)| (q - other).abs() < 1e-5), "{q:?} {other:?}");
        assert!(qdd.iter().zip(others).all(|(qdd, other)| (qdd - other).abs() < 1e-9), "{qdd:?}");
        assert!(q[1].abs() > 0.01, "{q:?}");
    }
}

#[test]
fn steps_of_fixed_size_start_there_too() {
    let method = Explicit::new(RungeKutta4, Projection::default());
    let start = Simulation::start(Parallelogram::<f64>::default(), method, 0.0, [0.0; 3], [5.0, 0.0, 5.0]);
    let mut run = start.expect("it starts");
    run.step_to(2.0, 2000).expect("it turns");
    let [defect, turned] = of_uprights([run.q()[0], run.q()[2]], run.qd()[0], 5.0, STIFFNESS);
    assert!(defect < 1e-7 && turned < 1e-9, "{:?} {defect:e}", run.q());
}

#[test]
fn one_row_that_vanishes_holds_two_cranks_from_a_start_in_line() {
    let (projected, transformed) = methods();
    for (q, qd, qdd) in [
        run!(TwoCranks::<f64>::default(), projected, [0.0; 2], [5.0; 2]),
        run!(TwoCranks::<f64>::default(), transformed, [0.0; 2], [5.0; 2]),
    ] {
        let [defect, turned] = of_uprights(q, qd[0], 5.0, 98.1);
        assert!(defect < 1e-7 && turned < 1e-9, "{q:?} {defect:e}");
        assert!(qdd.iter().all(|qdd| (qdd + 98.1).abs() < 1e-9), "{qdd:?}");
    }
}

/// Kind of a failed start.
macro_rules! refused {
    ($text:expr, $method:expr, $q:expr, $qd:expr) => {
        Simulation::start($text, $method, 0.0, $q, $qd).map(|_| ()).expect_err("no start").kind
    };
}

#[test]
fn rates_of_no_motion_in_line_and_bars_at_rest_are_refused() {
    let (projected, transformed) = methods();
    // The first derivative of the rows allows them, the second does not.
    for kind in [
        refused!(Parallelogram::<f64>::default(), projected, [0.0; 3], [5.0, -1.0, 2.0]),
        refused!(Parallelogram::<f64>::default(), transformed, [0.0; 3], [5.0, -1.0, 2.0]),
        refused!(TwoCranks::<f64>::default(), projected, [0.0; 2], [5.0, 1.0]),
        refused!(TwoCranks::<f64>::default(), projected, [0.0; 2], [5.0, -5.0]),
        refused!(TwoPoints::<f64>::default(), projected, [0.1, 0.0, 0.4, 0.0], [0.0, 5.0, 0.0, 1.0]),
        refused!(TwoPoints::<f64>::default(), projected, [0.1, 0.0, 0.4, 0.0], [0.0, 5.0, 0.0, -5.0]),
    ] {
        assert!(matches!(kind, FailureKind::Undecided { .. }), "{kind:?}");
    }
    for kind in [
        refused!(Parallelogram::<f64>::default(), projected, [0.0; 3], [0.0; 3]),
        refused!(TwoCranks::<f64>::default(), projected, [0.0; 2], [0.0; 2]),
    ] {
        assert!(matches!(kind, FailureKind::VanishingGradient { .. }), "{kind:?}");
    }
}

#[test]
fn a_method_without_limits_of_rows_starts_there_only_with_the_right_accelerations() {
    let crossed = [5.0, -5.0, -10.0];
    for kind in [
        refused!(
            Parallelogram::<f64>::default(),
            Explicit::new(RungeKutta4, Unstabilized),
            [0.0; 3],
            crossed
        ),
        refused!(
            Parallelogram::<f64>::default(),
            Explicit::new(RungeKutta4, Penalty::default()),
            [0.0; 3],
            crossed
        ),
        refused!(Parallelogram::<f64>::default(), GeneralizedAlpha::default(), [0.0; 3], crossed),
    ] {
        assert!(matches!(kind, FailureKind::Undecided { .. }), "{kind:?}");
    }
}

#[test]
fn a_change_in_line_keeps_the_run() {
    let (projected, _) = methods();
    let run = Simulation::start(Parallelogram::<f64>::default(), projected, 0.0, [0.0; 3], [5.0, 0.0, 5.0]);
    let mut run = run.expect("it starts");
    run.change(|text| text.r = 0.12);
    let ended: Result<(), Failure> = run.advance_to(0.5);
    ended.expect("it turns");
    assert!((run.q()[0] - run.q()[2]).abs() < 1e-9 && run.q()[1].abs() < 1e-9, "{:?}", run.q());
}
