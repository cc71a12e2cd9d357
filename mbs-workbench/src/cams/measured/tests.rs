//! Measured profiles against the exact law.

use super::*;
use crate::cams::follower::{Cam, Side};
use crate::cams::lift::{Flank, Lift};

fn cam(follower: Follower, direction: Direction) -> Cam {
    let height = if follower.lifts_by_angle() { 0.12 } else { 0.006 };
    Cam::new(Lift::hump(&[2, 6, 8, 10, 12], height, 2.6).expect("a law"), follower, direction).expect("a cam")
}

fn followers() -> [Follower; 4] {
    let pivot = [0.06, 0.01];
    [
        Follower::Flat { base: 0.03 },
        Follower::Roller { base: 0.03, radius: 0.01, offset: 0.004 },
        Follower::OscillatingFlat { base: 0.03, pivot, face: 0.004, side: Side::Left },
        Follower::OscillatingRoller { base: 0.03, pivot, arm: 0.055, radius: 0.01, side: Side::Right },
    ]
}

/// An opening and a closing cam.
fn rockers() -> [Follower; 2] {
    let rocker = |side, valve_pad| Follower::rocker(0.03, [0.05, -0.02], 0.04, 0.012, side, valve_pad);
    [rocker(Side::Left, [-0.01, -0.025]), rocker(Side::Right, [0.005, -0.03])]
        .map(|one| one.expect("a rocker"))
}

/// Points at unequal angles with noise, of the contour itself.
fn measured(cam: &Cam, count: usize, noise: f64, leave: impl Fn(f64) -> bool) -> Vec<[f64; 2]> {
    let mut state = 5_u64;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut points = Vec::new();
    for k in 0..count {
        let place = cam.place(-3.1 + TAU * (k as f64 + 0.3 * uniform()) / count as f64);
        let r = place.polar[0] + noise * uniform();
        if !leave(place.polar[1]) {
            points.push([r * place.polar[1].cos(), r * place.polar[1].sin()]);
        }
    }
    points
}

/// Root mean square of the acceleration's error, and the largest error of the lift, as shares of the law's largest.
fn errors(cam: &Cam, found: &Recovered) -> [f64; 2] {
    let exact = |theta: f64| cam.lift.jet::<f64>(theta);
    let largest =
        |order: usize| found.motion.iter().map(|(theta, _)| exact(*theta)[order].abs()).fold(0.0, f64::max);
    let squares = found.motion.iter().map(|(theta, m)| (m[2] - exact(*theta)[2]).powi(2)).sum::<f64>();
    let lift = found.motion.iter().map(|(theta, m)| (m[0] - exact(*theta)[0]).abs()).fold(0.0, f64::max);
    [(squares / found.motion.len() as f64).sqrt() / largest(2), lift / largest(0)]
}

/// Root mean square over the cam angle.
fn mean_square_of(found: &Recovered, value: impl Fn(f64, &[f64; 3]) -> f64) -> f64 {
    let motion = &found.motion;
    let sum = (0..motion.len()).map(|k| {
        let [before, after] = [k + motion.len() - 1, k + 1].map(|place| motion[place % motion.len()].0);
        0.5 * (after - before).rem_euclid(TAU) * value(motion[k].0, &motion[k].1).powi(2)
    });
    (sum.sum::<f64>() / TAU).sqrt()
}

fn recovered(cam: &Cam, points: &[[f64; 2]]) -> Result<Recovered, CamError> {
    Profile::cartesian(points).and_then(|profile| profile.motion(&cam.follower, cam.direction))
}

/// Every follower, both sides of an arm, either sense, from no noise to 4 µm: the law comes back, and no point is called an outlier.
///
/// Points at equal cam angles lie up to seven times denser on the nose than on the flanks.
#[test]
fn the_law_is_recovered_from_its_own_profile() {
    const BOUNDS: [(f64, [f64; 2]); 4] =
        [(0.0, [5e-5, 1e-6]), (1e-7, [3e-3, 3e-5]), (1e-6, [0.015, 3e-4]), (4e-6, [0.05, 1e-3])];
    let mut worst = [[0.0_f64; 2]; 4];
    for (index, follower) in followers().into_iter().chain(rockers()).enumerate() {
        for (step, (noise, bounds)) in BOUNDS.into_iter().enumerate() {
            if index >= followers().len() && step != 2 {
                continue;
            }
            let direction =
                if (index + step) % 2 == 0 { Direction::CounterClockwise } else { Direction::Clockwise };
            let cam = cam(mirrored(follower, step % 4 < 2), direction);
            let found = recovered(&cam, &measured(&cam, 360, noise, |_| false));
            let found = found.unwrap_or_else(|why| panic!("{follower:?} {direction:?} {noise:e}: {why}"));
            let errors = errors(&cam, &found);
            assert!(found.outliers.is_empty(), "{follower:?} {noise:e}: {:?}", found.outliers);
            assert!(errors[0] < bounds[0] && errors[1] < bounds[1], "{follower:?} {noise:e}: {errors:?}");
            worst[step] = [0, 1].map(|k| worst[step][k].max(errors[k]));
            if noise >= 1e-6 {
                let squares =
                    mean_square_of(&found, |theta, motion| motion[2] - cam.lift.jet::<f64>(theta)[2]);
                let share = squares / found.acceleration_error;
                assert!((0.1..4.0).contains(&share), "{follower:?} {noise:e}: {share} of the estimate");
            }
        }
    }
    for ((noise, bounds), [acceleration, lift]) in BOUNDS.into_iter().zip(worst) {
        println!(
            "profile with noise of {:.1} µm → law: acceleration {acceleration:.1e}, bound {:.0e}; lift {lift:.1e}, bound {:.0e}",
            1e6 * noise,
            bounds[0],
            bounds[1]
        );
    }
}

fn mirrored(follower: Follower, is_mirrored: bool) -> Follower {
    let other = |side| if side == Side::Left { Side::Right } else { Side::Left };
    match follower {
        Follower::OscillatingFlat { base, pivot, face, side } if is_mirrored => {
            Follower::OscillatingFlat { base, pivot, face, side: other(side) }
        }
        Follower::OscillatingRoller { base, pivot, arm, radius, side } if is_mirrored => {
            Follower::OscillatingRoller { base, pivot, arm, radius, side: other(side) }
        }
        same => same,
    }
}

/// The acceleration of a 3-4-5 law has corners, which no spline follows: residuals there are no outliers.
#[test]
fn corners_of_a_law_are_no_outliers() {
    for (follower, lift) in followers().into_iter().zip([0.006, 0.006, 0.12, 0.12]) {
        let law = Lift::flanks(Flank::Polynomial345, lift, [1.3, 0.3, 1.3]).expect("a law");
        let cam = Cam::new(law, follower, Direction::Clockwise).expect("a cam");
        let found = recovered(&cam, &measured(&cam, 360, 0.0, |_| false)).expect("a motion");
        let [acceleration, _] = errors(&cam, &found);
        assert!(
            found.outliers.is_empty() && acceleration < 0.01,
            "{follower:?}: {acceleration:e} {:?}",
            found.outliers
        );
    }
}

/// A gap in the dwell, a narrow one on a flank, unequal distances, and outliers, two of them neighbours, of all followers at once.
#[test]
fn gaps_that_hide_nothing_and_outliers_are_borne() {
    for follower in followers() {
        let cam = cam(follower, Direction::CounterClockwise);
        // The dwell is the side that full lift is not at; places of contour points are those of the cam's frame.

        let angle = |theta: f64| cam.place(theta).polar[1];
        let (rest, flank) = (angle(3.0), angle(0.9));
        let near = |a: f64, b: f64, width: f64| {
            ((a - b + 9.0 * TAU / 2.0).rem_euclid(TAU) - TAU / 2.0).abs() < width
        };
        let mut points =
            measured(&cam, 480, 1e-6, |polar| near(polar, rest, 0.1) || near(polar, flank, 0.02));
        let kept = points.len();
        for k in [40, 200, 201, 400] {
            points[k] = points[k].map(|x| x * 1.003);
        }
        let found = recovered(&cam, &points).unwrap_or_else(|why| panic!("{follower:?}: {why}"));
        assert_eq!(found.outliers.len(), 4, "{follower:?} of {kept}: {:?}", found.outliers);
        let [acceleration, lift] = errors(&cam, &found);
        assert!(acceleration < 0.05 && lift < 1e-3, "{follower:?}: {acceleration:e} {lift:e}");
    }
}

/// Noise that hides the acceleration is refused, whatever the follower.
#[test]
fn noise_that_hides_the_acceleration_is_refused() {
    for follower in followers() {
        let cam = cam(follower, Direction::CounterClockwise);
        let refused = recovered(&cam, &measured(&cam, 72, 5e-3, |_| false));
        let message = refused.map(|found| found.second_error).expect_err("noise").to_string();
        assert!(
            message.contains("hides the acceleration") || message.contains("hollow"),
            "{follower:?}: {message}"
        );
    }
}

#[test]
fn noise_and_outliers_cost_what_is_estimated() {
    let follower = followers()[0];
    let cam = cam(follower, Direction::CounterClockwise);
    let mut points = measured(&cam, 720, 4e-6, |_| false);
    for k in [50, 300, 301, 600] {
        points[k] = points[k].map(|x| x * 1.004);
    }
    let found = Profile::cartesian(&points)
        .expect("points")
        .motion(&follower, Direction::CounterClockwise)
        .expect("a motion");
    assert_eq!(found.outliers.len(), 4, "{:?}", found.outliers);
    assert!((found.deviation / (4e-6 / 12_f64.sqrt()) - 1.0).abs() < 0.2, "{}", found.deviation);
    let squares: f64 = found.motion.iter().map(|(theta, m)| (m[2] - cam.lift.jet(*theta)[2]).powi(2)).sum();
    let error = (squares / found.motion.len() as f64).sqrt();
    assert!((0.4..2.5).contains(&(error / found.second_error)), "{error} {}", found.second_error);
}

#[test]
fn a_gap_is_refused_with_its_place() {
    let follower = followers()[1];
    let cam = cam(follower, Direction::CounterClockwise);
    let points = measured(&cam, 360, 1e-7, |angle| (1.2..1.7).contains(&angle));
    let refused = Profile::cartesian(&points).expect("points").motion(&follower, Direction::CounterClockwise);
    let message = refused.map(|found| found.knots).expect_err("a gap").to_string();
    assert!(
        message.contains("no point lies between 6") || message.contains("where they are few"),
        "{message}"
    );
    assert!(Profile::polar(&[[0.0, 1.0]; 30]).is_err() && Profile::polar(&[[0.0, 1.0]]).is_err());
}

#[test]
fn a_point_at_both_ends_of_a_turn_is_one() {
    let cam = cam(followers()[1], Direction::CounterClockwise);
    let polar = |[x, y]: &[f64; 2]| [y.atan2(*x).rem_euclid(TAU), x.hypot(*y)];
    let mut open: Vec<[f64; 2]> = measured(&cam, 360, 0.0, |_| false).iter().map(polar).collect();
    open.push([0.0, 0.03]);
    let points = Profile::polar(&open).expect("points");
    // 360° as a file writes it, in degrees or with six decimals in rad.
    for end in [360_f64.to_radians(), 1e-6 * (1e6 * TAU).floor()] {
        let closed = [open.as_slice(), &[[end, 0.03]]].concat();
        assert_eq!(Profile::polar(&closed).expect("points"), points);
    }
    let torn = [open.as_slice(), &[[TAU, 0.0301]]].concat();
    let refused = Profile::polar(&torn).expect_err("two radii").to_string();
    assert!(
        refused.contains("0.000000 deg occurs twice, with radii of 30.0")
            && refused.contains("help: keep one"),
        "{refused}"
    );
}
