//! Profiles against independent solutions: contact solved in two unknowns, formulas of textbooks.

use core::f64::consts::TAU;

use super::CamError;
use super::follower::{Cam, Direction, Follower, Place, Side};
use super::lift::{Flank, Lift};
use super::limits::{Limit, Limits, Load, Size, examine, least_size};

/// The lecture's law: 11 mm over 160°.
fn valve_lift() -> Lift {
    Lift::hump(&[2, 6, 8, 10, 12], 0.011, 160_f64.to_radians()).expect("a law")
}

/// Places relative to the cam's centre (12, 20) mm. The closer's pad is 29 mm from both pivot and cam: an arm of 29 mm, the largest
/// radius 17 mm and the pad's 12 mm.
fn opener() -> Follower {
    let from = |x: f64, y: f64| [(x - 12.0) * 1e-3, (y - 20.0) * 1e-3];
    Follower::Rocker {
        pivot: from(31.0, 1.0),
        cam_pad: from(13.0, -3.98),
        radius: 0.012,
        valve_pad: from(0.0, 8.0),
    }
}

fn closer() -> Follower {
    let from = |x: f64, y: f64| [(x - 12.0) * 1e-3, (y - 20.0) * 1e-3];
    let pivot: [f64; 2] = from(35.0, -9.0);
    let apart = pivot[0].hypot(pivot[1]);
    // Isosceles over the line from the pivot to the cam's centre, on its right.
    let angle = (-pivot[1]).atan2(-pivot[0]) - (0.5 * apart / 0.029).acos();
    let cam_pad = [pivot[0] + 0.029 * angle.cos(), pivot[1] + 0.029 * angle.sin()];
    Follower::Rocker { pivot, cam_pad, radius: 0.012, valve_pad: from(0.0, -12.0) }
}

fn angle_law(degrees: f64) -> Lift {
    let durations = [80_f64, 40.0, 100.0].map(f64::to_radians);
    Lift::flanks(Flank::Polynomial4567, degrees.to_radians(), durations).expect("a law")
}

fn cams() -> Vec<Cam> {
    let linear = || Lift::flanks(Flank::Polynomial4567, 0.008, [1.5, 0.5, 1.8]).expect("a law");
    let translating =
        [Follower::Flat { base: 0.03 }, Follower::Roller { base: 0.025, radius: 0.008, offset: 0.006 }];
    let pivot = [0.06, 0.01];
    let mut all = Vec::new();
    for direction in [Direction::CounterClockwise, Direction::Clockwise] {
        for follower in translating {
            all.push(Cam::new(linear(), follower, direction).expect("a cam"));
        }
        for side in [Side::Left, Side::Right] {
            let roller = Follower::OscillatingRoller { base: 0.03, pivot, arm: 0.055, radius: 0.01, side };
            let flat = Follower::OscillatingFlat { base: 0.03, pivot, face: 0.004, side };
            all.push(Cam::new(angle_law(18.0), roller, direction).expect("a cam"));
            all.push(Cam::new(angle_law(6.0), flat, direction).expect("a cam"));
        }
        for follower in [opener(), closer()] {
            all.push(Cam::new(valve_lift(), follower, direction).expect("a cam"));
        }
    }
    all
}

/// The contact of the finished contour with the follower: equations in the lift and the place on the contour, by Newton's method.
///
/// It knows points and tangents of the contour, and the follower as a drawing shows it.
pub fn solved_lift(cam: &Cam, theta: f64) -> f64 {
    let sigma = cam.direction.sign();
    let rotate = |[x, y]: [f64; 2], angle: f64| {
        let (s, c) = angle.sin_cos();
        [c * x - s * y, s * x + c * y]
    };
    // Two residuals: the follower's surface passes through the contour's point, and is tangent there.
    let residual = |lift: f64, place: &Place<f64>| {
        let point = rotate(place.contour, sigma * theta);
        let tangent = rotate(place.contour_rate, sigma * theta);
        let length = tangent[0].hypot(tangent[1]);
        let tangent = tangent.map(|x| x / length);
        let pad = |centre: [f64; 2], radius: f64| {
            let (dx, dy) = (point[0] - centre[0], point[1] - centre[1]);
            [dx * dx + dy * dy - radius * radius, (dx * tangent[0] + dy * tangent[1]) * radius]
        };
        match cam.follower {
            Follower::Flat { base } => [point[1] - base - lift, 0.03 * tangent[1]],
            Follower::Roller { base, radius, offset } => {
                let height = ((base + radius) * (base + radius) - offset * offset).sqrt() + lift;
                pad([offset, height], radius)
            }
            Follower::OscillatingRoller { base, pivot, arm, radius, side } => {
                let apart = pivot[0].hypot(pivot[1]);
                let reach = base + radius;
                let rest = ((apart * apart + arm * arm - reach * reach) / (2.0 * apart * arm)).acos();
                let angle = if side == Side::Left { rest + lift } else { -rest - lift };
                let unit = [-pivot[0] / apart, -pivot[1] / apart];
                let turned = rotate(unit, angle);
                pad([pivot[0] + arm * turned[0], pivot[1] + arm * turned[1]], radius)
            }
            Follower::OscillatingFlat { base, pivot, face, side } => {
                let apart = pivot[0].hypot(pivot[1]);
                let rest = ((base - face) / apart).acos();
                let angle = if side == Side::Left { rest - lift } else { lift - rest };
                let normal = rotate([pivot[0] / apart, pivot[1] / apart], angle);
                let (dx, dy) = (point[0] - pivot[0], point[1] - pivot[1]);
                [
                    dx * normal[0] + dy * normal[1] - face,
                    0.03 * (tangent[0] * normal[0] + tangent[1] * normal[1]),
                ]
            }
            Follower::Rocker { pivot, cam_pad, radius, valve_pad } => {
                // The unknown is the arm's angle; the valve's pad falls by the lift.
                let centre = rotate([cam_pad[0] - pivot[0], cam_pad[1] - pivot[1]], lift);
                let _ = valve_pad;
                pad([pivot[0] + centre[0], pivot[1] + centre[1]], radius)
            }
        }
    };
    let is_rocker = matches!(cam.follower, Follower::Rocker { .. });
    let start = cam.place(theta);
    let (mut lift, mut u) = (if is_rocker { start.angle[0] } else { start.lift[0] } + 1e-4, theta + 2e-3);
    let (mut by_lift, mut by_u) = ([0.0; 2], [0.0; 2]);
    for iteration in 0..8 {
        let here = cam.place(u);
        let [a, b] = residual(lift, &here);
        // The slopes of the third iteration are those of the solution to six digits.
        if iteration < 3 {
            let h = 1e-6;
            let partial = |high: [f64; 2], low: [f64; 2]| {
                [(high[0] - low[0]) / (2.0 * h), (high[1] - low[1]) / (2.0 * h)]
            };
            by_lift = partial(residual(lift + h, &here), residual(lift - h, &here));
            by_u = partial(residual(lift, &cam.place(u + h)), residual(lift, &cam.place(u - h)));
        }
        let determinant = by_lift[0] * by_u[1] - by_lift[1] * by_u[0];
        lift -= (a * by_u[1] - b * by_u[0]) / determinant;
        u -= (by_lift[0] * b - by_lift[1] * a) / determinant;
    }
    match cam.follower {
        Follower::Rocker { pivot, valve_pad, .. } => {
            let arm = [valve_pad[0] - pivot[0], valve_pad[1] - pivot[1]];
            arm[1] - rotate(arm, lift)[1]
        }
        _ => lift,
    }
}

/// Law → profile → lift.
#[test]
fn the_contact_of_the_profile_returns_the_law() {
    let mut worst = 0.0_f64;
    for cam in cams() {
        // An angle moves its contact by the arm.
        let arm = if cam.follower.lifts_by_angle() { 0.06 } else { 1.0 };
        for k in 0..30 {
            let theta = cam.lift.origin() + TAU * (f64::from(k) + 0.37) / 30.0;
            let difference = arm * (solved_lift(&cam, theta) - cam.lift.jet(theta)[0]).abs();
            assert!(difference < 1e-14, "{:?} at {theta}: {difference:e}", cam.follower);
            worst = worst.max(difference);
        }
    }
    println!("law → profile → lift: largest difference {worst:.1e} m, bound 1e-14 m");
}

/// Both rockers on their cams: the valve's ends stay as far apart as they are at rest.
#[test]
fn rockers_of_a_desmodromic_pair_keep_their_distance() {
    for direction in [Direction::CounterClockwise, Direction::Clockwise] {
        let [open, close] =
            [opener(), closer()].map(|one| Cam::new(valve_lift(), one, direction).expect("a cam"));
        let distances = (0..720).map(|k| {
            let theta = TAU * f64::from(k) / 720.0 - TAU / 2.0;
            solved_lift(&open, theta) - solved_lift(&close, theta)
        });
        let (low, high) =
            distances.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        println!("distance of the rockers, 720 points, peak to peak: {:.1e} m, bound 2e-12 m", high - low);
        assert!(high - low <= 2e-12, "{:e}", high - low);
    }
}

/// Formulas of textbooks that the code does not use.
#[test]
fn flat_and_roller_have_the_formulas_of_textbooks() {
    for cam in cams() {
        for k in 0..36 {
            let theta = cam.lift.origin() + TAU * f64::from(k) / 36.0 + 0.01;
            let (place, [s, v, a, _]) = (cam.place(theta), cam.lift.jet(theta));
            match cam.follower {
                Follower::Flat { base } => {
                    assert!((place.radius - (base + s + a)).abs() < 1e-15);
                    assert!((place.along.abs() - v.abs()).abs() < 1e-17 && place.pressure.abs() < 1e-15);
                    assert!((place.sliding.abs() - (base + s)).abs() < 1e-16);
                }
                Follower::Roller { base, radius, offset } => {
                    let d = ((base + radius).powi(2) - offset * offset).sqrt();
                    // The offset helps the rise of one sense, and spoils that of the other.
                    let tangent = (cam.direction.sign() * v - offset) / (d + s);
                    assert!((place.pressure.tan().abs() - tangent.abs()).abs() < 1e-14, "{theta}");
                }
                _ => {}
            }
        }
    }
}

/// A cam that turns the other way is the mirror image, for a follower that is its own.
#[test]
fn the_other_sense_is_the_mirror_image() {
    let law = Lift::flanks(Flank::Cycloid, 0.006, [1.0, 0.4, 1.6]).expect("a law");
    let cam = |sense, offset| {
        Cam::new(law.clone(), Follower::Roller { base: 0.02, radius: 0.006, offset }, sense).expect("a cam")
    };
    let (one, other) = (cam(Direction::CounterClockwise, 0.003), cam(Direction::Clockwise, -0.003));
    for k in 0..50 {
        let theta = f64::from(k) * 0.125;
        let (a, b) = (one.place(theta), other.place(theta));
        assert!((a.contour[0] + b.contour[0]).abs() < 1e-17 && (a.contour[1] - b.contour[1]).abs() < 1e-17);
        assert!(
            (a.radius - b.radius).abs() < 1e-14 * a.radius.abs() && (a.pressure + b.pressure).abs() < 1e-14
        );
    }
}

#[test]
fn the_least_base_circle_meets_its_limit_with_equality() {
    let law = || Lift::flanks(Flank::Polynomial4567, 0.01, [1.4, 0.3, 1.4]).expect("a law");
    let roller = Follower::Roller { base: 1.0, radius: 0.008, offset: 0.0 };
    let cam = Cam::new(law(), roller, Direction::CounterClockwise).expect("a cam");
    let range = [0.01, 0.2];
    let load = Load { force: 800.0, width: 0.012, modulus: Load::contact_modulus([210e9; 2], [0.3; 2]) };
    for limits in [
        Limits { pressure_angle: Some(30_f64.to_radians()), ..Limits::default() },
        Limits { radius: Some(0.004), ..Limits::default() },
        Limits { hertz: Some((9e8, load)), ..Limits::default() },
        Limits { wheel: Some(0.06), pressure_angle: Some(1.2), ..Limits::default() },
    ] {
        let least = least_size(&cam, &limits, Size::Base, range).expect("a cam");
        let active = least.active.expect("a limit");
        let verdict = least.verdicts.iter().find(|one| one.limit == active).expect("its verdict");
        assert!(
            verdict.kept && (verdict.value / active.bound() - 1.0).abs() < 1e-12,
            "{active:?}: {verdict:?}"
        );
        assert!(active != Limit::Undercut && least.verdicts.iter().all(|one| one.kept));
    }
    // Flat: R_c = r_b + s + s″, so the least base circle follows from the law alone.
    let flat = Cam::new(law(), Follower::Flat { base: 1.0 }, Direction::CounterClockwise).expect("a cam");
    let limits = Limits { radius: Some(0.002), ..Limits::default() };
    let least = least_size(&flat, &limits, Size::Base, range).expect("a cam");
    let law = law();
    let lowest =
        (0..20_000).map(|k| law.jet(f64::from(k) * 3.2 / 2e4)).map(|j| j[0] + j[2]).fold(0.0, f64::min);
    assert!((least.size - (0.002 - lowest)).abs() < 1e-8, "{} {lowest}", least.size);
}

#[test]
fn limits_that_contradict_are_named() {
    let law = Lift::flanks(Flank::Polynomial4567, 0.01, [1.4, 0.3, 1.4]).expect("a law");
    let roller = Follower::Roller { base: 1.0, radius: 0.008, offset: 0.0 };
    let cam = Cam::new(law, roller, Direction::CounterClockwise).expect("a cam");
    let limits = Limits { pressure_angle: Some(0.4), outer: Some(0.03), ..Limits::default() };
    match least_size(&cam, &limits, Size::Base, [0.012, 0.1]) {
        Err(CamError::Contradiction { larger, smaller }) => {
            assert_eq!((larger.0, smaller.0), ("pressure angle", "outer radius"));
            assert!((smaller.1 - 0.02).abs() < 1e-9 && larger.1 > smaller.1, "{larger:?} {smaller:?}");
            // At the named size the first limit holds with equality.
            let mut at = cam.clone();
            at.follower = Follower::Roller { base: larger.1, radius: 0.008, offset: 0.0 };
            let found = examine(&at, &limits);
            assert!(found.iter().any(|one| one.kept && (one.value - 0.4).abs() < 1e-12), "{found:?}");
        }
        other => panic!("{other:?}"),
    }
    let never = Limits { outer: Some(0.005), ..Limits::default() };
    assert_eq!(least_size(&cam, &never, Size::Base, [0.012, 0.1]), Err(CamError::Never("outer radius")));
}

/// Sizes that keep all limits, between two that are tried: 2 % where steps are 10 %.
#[test]
fn a_narrow_window_of_sizes_is_found() {
    let law = Lift::flanks(Flank::Polynomial4567, 0.01, [1.4, 0.3, 1.4]).expect("a law");
    let roller = Follower::Roller { base: 1.0, radius: 0.008, offset: 0.0 };
    let cam = Cam::new(law, roller, Direction::CounterClockwise).expect("a cam");
    let slope = Limits { pressure_angle: Some(0.4), ..Limits::default() };
    let find = |limits: &Limits, range: [f64; 2]| least_size(&cam, limits, Size::Base, range);
    let alone = find(&slope, [0.012, 0.1]).expect("a cam").size;
    let range = [0.8 * alone, 1.3 * alone];
    let limits = Limits { outer: Some(1.02 * alone + 0.01), ..slope };
    let least = find(&limits, range).expect("a window");
    assert!(
        (least.size - alone).abs() < 1e-14 && least.active == Some(Limit::PressureAngle(0.4)),
        "{least:?}"
    );
    let narrower = Limits { outer: Some(0.999 * alone + 0.01), ..slope };
    match find(&narrower, range) {
        Err(CamError::Contradiction { larger, smaller }) => assert!(larger.1 > smaller.1),
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_undercut_is_found_with_its_angle() {
    let law = Lift::flanks(Flank::Harmonic, 0.012, [0.9, 0.0, 0.9]).expect("a law");
    let flat = Cam::new(law, Follower::Flat { base: 0.012 }, Direction::CounterClockwise).expect("a cam");
    let verdict = examine(&flat, &Limits::default())[0];
    // s + s″ is least at full lift, where the harmonic's acceleration is.
    assert!(!verdict.kept && (verdict.angle - 0.9).abs() < 1e-6, "{verdict:?}");
    assert!(verdict.value < 0.0);
}
