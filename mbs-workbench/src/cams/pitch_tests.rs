//! The lecture's opener as a text with a cam joint, against its lift law. The pitch curve is taken in closed form and from
//! tables of it.

use core::f64::consts::TAU;

use mbs_runtime::{Function, Stepper};

use super::Pitch;
use crate::cams::CamError;
use crate::cams::follower::{Cam, Direction, Follower};
use crate::cams::lift::{Flank, Lift};
use crate::tables::Table;

mbs_runtime::mechanism! {
    /// Finger between the cam and the valve, kinematically driven.
    pub mechanism Opener;
    const pivot: m = [31mm, 1mm];
    const centre: m = [12mm, 20mm];
    const cam_arm: m = [-18mm, -4.98mm];
    const valve_arm: m = [-31mm, 7mm];
    /// Speed of the cam.
    param omega: rad/s = 1;
    /// Polar radius of the pitch curve.
    function pitch: m(rad), C3, periodic TAU;
    coord theta: rad;
    coord psi: rad = 0;
    let pad = pivot + rot(psi)*cam_arm;
    let tip = pivot + rot(psi)*valve_arm;
    curve cam = polar pitch about centre turned theta;
    drive shaft: theta == omega*t;
    constraint rides { pad on cam; }
    branch finger: cos(psi) > 0;
    out lift: m = 8mm - tip.1;
    out gap: m = distance(pad, cam);
    out pressure: rad = asin(dot(outward(pad, cam), d(pad, psi))/norm(d(pad, psi)));
    out leverage: m = d(tip.1, psi);
    limit open: lift <= 11.5mm;
    limit seat: -1mm <= lift;
}

fn opener(direction: Direction) -> Cam {
    let from = |x: f64, y: f64| [(x - 12.0) * 1e-3, (y - 20.0) * 1e-3];
    let follower = Follower::Rocker {
        pivot: from(31.0, 1.0),
        cam_pad: from(13.0, -3.98),
        radius: 0.012,
        valve_pad: from(0.0, 8.0),
    };
    let law = Lift::hump(&[2, 6, 8, 10, 12], 0.011, 160_f64.to_radians()).expect("a law");
    Cam::new(law, follower, direction).expect("a cam")
}

/// Largest differences of the lift and its two derivatives from the law, on the way of one turn at 1 rad/s.
fn errors<F: Function<f64> + Clone>(cam: &Cam, pitch: F) -> [f64; 3] {
    let start = cam.lift.origin();
    let mut stepper = Stepper::assemble(Opener::new(pitch), [start, 0.0], start).expect("an assembly");
    let mut largest = [0.0_f64; 3];
    for step in 0..=360 {
        let theta = start + TAU * f64::from(step) / 360.0;
        stepper.advance_to(theta).expect("a position");
        let lift = stepper.outputs().as_ref()[0];
        let found = [Some(lift.value), lift.rate, lift.acceleration].map(|part| part.expect("a derivative"));
        for (largest, (found, law)) in largest.iter_mut().zip(found.into_iter().zip(cam.lift.jet(theta))) {
            *largest = largest.max((found - law).abs());
        }
        assert!(stepper.outputs().as_ref()[1].value.abs() < 1e-15, "the pad is on the cam");
    }
    largest
}

#[test]
fn a_cam_joint_lifts_by_the_law_from_which_its_pitch_curve_comes() {
    let cam = opener(Direction::CounterClockwise);
    let pitch = Pitch::<3>::new(&cam).expect("a pitch curve");
    let [lift, velocity, acceleration] = errors(&cam, pitch.clone());
    // The radius is 24 mm and more, so that its rounding is 3e-18 m.
    assert!(
        lift < 1e-14 && velocity < 1e-13 && acceleration < 1e-12,
        "{lift:e} {velocity:e} {acceleration:e}"
    );
    // A point of the text that is the follower's: pressure angle and leverage.
    let theta = -0.6;
    let mut stepper = Stepper::assemble(Opener::new(pitch), [theta, 0.1], theta).expect("an assembly");
    stepper.advance_to(theta).expect("the start");
    let place = cam.place(theta);
    let outputs = stepper.outputs();
    assert!((outputs.as_ref()[2].value.cos().abs() - place.pressure.sin().abs()).abs() < 1e-12);
    let leverage = 0.031_f64.hypot(0.007) * (0.007_f64.atan2(-0.031) + stepper.q()[1]).cos();
    assert!((outputs.as_ref()[3].value - leverage).abs() < 1e-15);
}

#[test]
fn a_pitch_curve_has_the_derivatives_of_its_radius() {
    for direction in [Direction::CounterClockwise, Direction::Clockwise] {
        let cam = opener(direction);
        let pitch = Pitch::<3>::new(&cam).expect("a pitch curve");
        for step in 0..97 {
            let theta = cam.lift.origin() + TAU * f64::from(step) / 97.0;
            let [x, y] = cam.place(theta).pitch;
            let w = y.atan2(x);
            let [radius, first, second, third]: [f64; 4] = pitch.jet(w + 3.0 * TAU);
            assert!((radius - x.hypot(y)).abs() < 1e-16, "{radius}");
            const STEP: f64 = 1e-4;
            let slope = |order: usize| {
                let [before, behind] = [w - STEP, w + STEP].map(|w| pitch.jet::<4>(w)[order]);
                (behind - before) / (2.0 * STEP)
            };
            for (order, found) in [first, second, third].into_iter().enumerate() {
                assert!((found - slope(order)).abs() < 1e-6, "{theta} {order}: {found} {}", slope(order));
            }
        }
    }
}

#[test]
fn a_pitch_curve_without_a_polar_radius_is_refused() {
    let law = || Lift::flanks(Flank::Cycloid, 0.008, [1.5, 0.5, 1.8]).expect("a law");
    let roller = Follower::Roller { base: 0.025, radius: 0.008, offset: 0.0 };
    let cam = |law, follower| Cam::new(law, follower, Direction::CounterClockwise).expect("a cam");
    let refused = |cam: &Cam| Pitch::<3>::new(cam).map(|_| ());
    assert!(matches!(refused(&cam(law(), roller)), Err(CamError::Value("law", _))));
    assert!(Pitch::<2>::new(&cam(law(), roller)).is_ok());
    let flat = cam(law(), Follower::Flat { base: 0.025 });
    assert!(matches!(Pitch::<2>::new(&flat).map(|_| ()), Err(CamError::Value("pitch curve", _))));
    // A large rocker's pad that swings through half a turn about the cam goes back there.
    let law = Lift::flanks(Flank::Polynomial4567, 1.2, [0.6, 0.4, 0.6]).expect("a law");
    let swinging = Follower::OscillatingRoller {
        base: 0.02,
        pivot: [0.06, 0.0],
        arm: 0.055,
        radius: 0.01,
        side: crate::cams::follower::Side::Left,
    };
    let cam = Cam::new(law, swinging, Direction::CounterClockwise).expect("a cam");
    let found = refused(&cam);
    assert!(
        matches!(&found, Err(CamError::Value("pitch curve", why)) if why.contains("no polar radius")),
        "{found:?}"
    );
}

/// A curve about the cam's centre: a circle of this radius.
#[derive(Clone)]
struct Circle(f64);

impl Function<f64> for Circle {
    const ORDER: usize = 3;

    fn jet<const K: usize>(&self, _: f64) -> [f64; K] {
        core::array::from_fn(|order| if order == 0 { self.0 } else { 0.0 })
    }
}

#[test]
fn a_curve_that_the_pad_does_not_reach_has_no_position() {
    // The pad's arm keeps it 8 mm and more from the cam's centre, which it never reaches.
    let start = |radius: f64| Stepper::assemble(Opener::new(Circle(radius)), [0.0, 0.0], 0.0).map(|_| ());
    assert!(start(0.024).is_ok());
    for radius in [0.0, -0.024, 0.001, f64::NAN, f64::INFINITY] {
        let failure = start(radius).expect_err("no position");
        assert!(!failure.to_string().is_empty(), "{radius}");
    }
}

#[test]
fn a_table_from_a_file_is_the_pitch_curve_that_it_was_made_of() {
    let cam = opener(Direction::CounterClockwise);
    let pitch = Pitch::<3>::new(&cam).expect("a pitch curve");
    let folder = std::env::temp_dir().join(format!("mbs_pitch_{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join("pitch.csv");
    let written = |count: usize| {
        let line = |k: usize| {
            let degrees = 360.0 * k as f64 / count as f64;
            let [radius]: [f64; 1] = pitch.jet(degrees.to_radians());
            format!("{degrees:.17e},{:.17e}\n", 1e3 * radius)
        };
        std::fs::write(&file, (0..count).map(line).collect::<String>()).expect("a file");
        errors(&cam, Table::from_csv(&file, "deg, mm").expect("a table"))
    };
    let [coarse, fine] = [360, 720].map(written);
    for ((coarse, fine), gain) in coarse.iter().zip(&fine).zip([4.0, 3.0, 2.0]) {
        // Orders of about 5, 4 and 3, less where the law has a joint.
        assert!((coarse / fine).log2() > gain, "{coarse:e} {fine:e}");
    }
    assert!(fine[0] < 1e-9 && fine[2] < 1e-3, "{fine:?}");
    std::fs::remove_dir_all(&folder).expect("the folder");
}

/// Cams of every kind of law, with a pad.
fn cams() -> Vec<Cam> {
    let roller = Follower::Roller { base: 0.02, radius: 0.01, offset: 0.003 };
    let arm = Follower::OscillatingRoller {
        base: 0.02,
        pivot: [0.05, 0.01],
        arm: 0.045,
        radius: 0.01,
        side: crate::cams::follower::Side::Left,
    };
    let flanks = |flank, height| Lift::flanks(flank, height, [1.2, 0.4, 1.4]).expect("a law");
    let samples: Vec<f64> = (0..48).map(|k| TAU * f64::from(k) / 48.0).collect();
    let heights: Vec<f64> = samples.iter().map(|x| 0.002 * (1.0 - x.cos()) * (1.0 + 0.3 * x.sin())).collect();
    let spline =
        crate::tables::Spline::fit(&samples, &heights, crate::tables::SplineKind::PeriodicQuintic(TAU), None);
    [
        (flanks(Flank::Polynomial4567, 0.008), roller),
        (flanks(Flank::ModifiedTrapezoid, 0.008), roller),
        (flanks(Flank::ModifiedSine, 0.2), arm),
        (flanks(Flank::Cycloid, 0.2).with_ramps(0.01, 0.5).expect("ramps"), arm),
        (
            Lift::hump(&[2, 6, 8, 10, 12], 0.008, 2.4).expect("a law").with_polydyne(0.01).expect("a law"),
            roller,
        ),
        (Lift::table(spline.expect("a spline")).expect("a law"), roller),
    ]
    .into_iter()
    .map(|(law, follower)| Cam::new(law, follower, Direction::Clockwise).expect("a cam"))
    .chain([opener(Direction::CounterClockwise)])
    .collect()
}

#[test]
fn values_of_pitch_curves_are_within_their_enclosures() {
    for cam in cams() {
        let pitch = Pitch::<2>::new(&cam).expect("a pitch curve");
        for k in 0..60 {
            let width = 10.0_f64.powf(-0.1 * f64::from(k));
            let low = 0.37 * f64::from(k * k) - 7.0;
            let bounds = pitch.enclosure::<3>(low, low + width).expect("bounds");
            for share in 0..=20 {
                let w = low + width * f64::from(share) / 20.0;
                for (order, value) in pitch.jet::<3>(w).into_iter().enumerate() {
                    let bound = bounds[order];
                    let is_within = bound.low() <= value + 1e-10 && value <= bound.high() + 1e-10;
                    assert!(is_within, "{:?}: {order} at {w}: {value} {bound:?}", cam.lift);
                    let is_close = width > 1e-3 || bound.high() - bound.low() < 20.0 * width;
                    assert!(is_close, "{:?}: {order} within {width}: {bound:?}", cam.lift);
                }
            }
        }
    }
}

#[test]
fn reach_of_a_pitch_curve_is_that_of_many_of_its_places() {
    let cam = opener(Direction::CounterClockwise);
    let pitch = Pitch::<3>::new(&cam).expect("a pitch curve");
    let [inside, outside] = mbs_runtime::driver::reach(&pitch).expect("a reach");
    // Radius of curvature by the synthesis at places of the cam angle.
    let radii = (0..7200).map(|k| cam.place(TAU * f64::from(k) / 7200.0).pitch_radius);
    let (mut convex, mut hollow) = (f64::INFINITY, f64::INFINITY);
    for radius in radii {
        if radius > 0.0 { convex = convex.min(radius) } else { hollow = hollow.min(-radius) }
    }
    println!("reach {inside:.5} m of {convex:.5}, {outside:.5} m of {hollow:.5}");
    assert!(inside <= convex && inside > 0.99 * convex, "{inside} {convex}");
    assert!(outside <= hollow && (hollow.is_infinite() || outside > 0.5 * hollow), "{outside} {hollow}");
}

#[test]
fn a_pitch_curve_that_turns_back_between_two_places_is_refused() {
    let roller = Follower::Roller { base: 0.02, radius: 0.01, offset: 0.005 };
    // A bump of a tenth of a degree, full at a place that is looked at.
    let law = |height: f64| Lift::hump(&[2, 4, 6, 8], height, 0.1_f64.to_radians()).expect("a law");
    let pitch = |height: f64| {
        let cam = Cam::new(law(height), roller, Direction::CounterClockwise).expect("a cam");
        Pitch::<3>::new(&cam).map(|_| ()).map_err(|error| error.to_string())
    };
    assert_eq!(pitch(1e-5), Ok(()));
    assert!(pitch(1e-3).is_err_and(|error| error.contains("no polar radius")));
}
