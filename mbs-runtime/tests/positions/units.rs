//! The unit of length is a name: nanometres and kilometres give the same answers with the same effort.

use mbs_runtime::{Failure, FailureKind, Kinematic, ReachLimit, Signal, Stepper, mechanism};

mechanism! {
    /// A four-bar in angles.
    mechanism Bars;
    param crank: m = 1;
    param coupler: m = 3;
    param rocker: m = 3.5;
    param ground: m = 4;
    coord phi: rad;
    coord psi: rad = 0.9;
    coord chi: rad = 1.6;
    constraint closure { crank*unit(phi) + coupler*unit(psi) == [ground, 0] + rocker*unit(chi); }
    drive motor: phi == t*1rad/1s;
    branch open: sin(chi - psi) > 0;
}

mechanism! {
    /// The same in points: rows in square metres.
    mechanism Points;
    param crank: m = 1;
    param coupler: m = 3;
    param rocker: m = 3.5;
    param ground: m = 4;
    input theta: rad, rates;
    coord a: [m; 2] = [crank, 0];
    coord b: [m; 2] = [ground, rocker];
    let rod = b - a;
    let swing = b - [ground, 0];
    constraint distances {
        dot(a, a) == crank^2;
        dot(rod, rod) == coupler^2;
        dot(swing, swing) == rocker^2;
    }
    drive encoder: cross(unit(theta), a) == 0;
    branch forward: dot(unit(theta), a) > 0;
    branch open at start: cross(rod, swing) > 0;
}

const UNITS: [f64; 4] = [1e-9, 1e-3, 1.0, 1e3];

fn bars([crank, coupler, rocker, ground]: [f64; 4], unit: f64) -> Bars {
    Bars { crank: crank * unit, coupler: coupler * unit, rocker: rocker * unit, ground: ground * unit }
}

fn points([crank, coupler, rocker, ground]: [f64; 4], unit: f64, theta: f64) -> Points {
    let theta = Signal { value: theta, rate: 1.0, acceleration: 0.0 };
    Points {
        crank: crank * unit,
        coupler: coupler * unit,
        rocker: rocker * unit,
        ground: ground * unit,
        theta,
    }
}

fn assembled<S: Kinematic<f64, N>, const N: usize>(design: S, t: f64) -> Stepper<S, f64, N> {
    let guess = design.guess(&design.parameters());
    Stepper::assemble(design, guess, t).expect("it assembles")
}

#[test]
fn a_turn_has_the_same_angles_margins_and_newton_steps_in_every_unit() {
    let turn = |unit: f64| -> Vec<_> {
        let mut stepper = assembled(bars([1.0, 3.0, 3.5, 4.0], unit), 0.0);
        stepper.sweep(core::f64::consts::TAU, 90).map(|frame| frame.expect("a crank")).collect()
    };
    let metres = turn(1.0);
    for unit in UNITS {
        for (frame, metre) in turn(unit).iter().zip(&metres) {
            for (angle, expected) in frame.q.iter().zip(metre.q) {
                assert!((angle - expected).abs() < 1e-12, "{unit}");
            }
            for (acceleration, expected) in frame.qdd.iter().zip(metre.qdd) {
                assert!((acceleration - expected).abs() < 1e-10, "{unit}");
            }
            assert!((frame.margin / metre.margin - 1.0).abs() < 1e-10, "{unit}");
            assert_eq!(frame.statistics.evaluations, metre.statistics.evaluations, "{unit}");
        }
    }
}

#[test]
fn points_take_the_same_way_in_every_unit() {
    let turn = |unit: f64| -> Vec<_> {
        let mut stepper = assembled(points([1.0, 3.0, 3.5, 4.0], unit, 0.0), 0.0);
        let step = |k: i32| {
            let theta = Signal { value: 0.07 * f64::from(k), rate: 1.0, acceleration: 0.0 };
            stepper.change(|design| design.theta = theta);
            let statistics = stepper.advance(0.07).expect("a crank");
            (stepper.q().map(|q| q / unit), stepper.margin(), statistics.evaluations, stepper.passages())
        };
        (1..=90).map(step).collect()
    };
    let metres = turn(1.0);
    for unit in UNITS {
        for (found, expected) in turn(unit).iter().zip(&metres) {
            assert!(found.0.iter().zip(expected.0).all(|(q, e)| (q - e).abs() < 1e-12), "{unit}");
            assert!((found.1 / expected.1 - 1.0).abs() < 1e-10);
            assert_eq!((found.2, found.3), (expected.2, expected.3), "{unit}");
        }
    }
}

#[test]
fn a_lock_up_is_found_at_the_same_angle_with_the_same_rows_in_every_unit() {
    for unit in UNITS {
        let stepper = assembled(bars([3.0, 2.0, 2.0, 4.0], unit), 0.5);
        let ReachLimit { reachable, refused, failure, .. } = stepper.reach_towards(1.5).expect("it locks up");
        let lock = (9.0_f64 / 24.0).acos();
        assert!(reachable < lock + 1e-14 && lock - 1e-12 < refused && refused - reachable <= 1e-9, "{unit}");
        let Failure { kind: FailureKind::NotAssemblable { residual, rows, .. }, .. } = failure else {
            panic!("{failure}")
        };
        let mut names: Vec<_> = rows.rows().map(|row| row.name).collect();
        names.sort_unstable();
        assert_eq!(names, ["closure.0", "closure.1"]);
        // Coupler and rocker in line leave a gap, of which the larger component is at least 1/√2.
        let gap = (25.0 - 24.0 * 1.5_f64.cos()).sqrt() - 4.0;
        assert!((0.7 * gap..gap).contains(&(residual / unit)), "{unit}: {residual}");
    }
}

#[test]
fn a_parallelogram_in_line_is_singular_in_every_unit() {
    for unit in UNITS {
        let flat = points([1.0, 2.0, 1.0, 2.0], unit, 0.0);
        let failure =
            Stepper::assemble(flat, [1.0, 0.0, 3.0, 0.0].map(|x| x * unit), 0.0).expect_err("in line");
        assert!(
            matches!(
                failure,
                Failure { kind: FailureKind::Singular { .. }, .. }
                    | Failure { kind: FailureKind::WrongBranch { .. }, .. }
            ),
            "{unit}: {failure}"
        );
        // A ten-thousandth beside it is regular.
        let theta = 1e-4_f64;
        let (sine, cosine) = theta.sin_cos();
        let guess = [cosine, sine, 2.0 + cosine, sine].map(|x| x * unit);
        let stepper = Stepper::assemble(points([1.0, 2.0, 1.0, 2.0], unit, theta), guess, 0.0);
        let stepper = stepper.or_else(|_| {
            Stepper::assemble(
                points([1.0, 2.0, 1.0, 2.0], unit, -theta),
                [guess[0], -guess[1], guess[2], -guess[3]],
                0.0,
            )
        });
        let margin = stepper.expect("one of them is the declared assembly").margin();
        assert!((0.5e-4..1e-4).contains(&margin), "{unit}: {margin:e}");
    }
}
