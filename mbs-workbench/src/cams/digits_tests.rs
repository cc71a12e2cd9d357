//! Laws and profiles against values in 60 digits, made by a program that shares no code with the library.

use super::bspline::{BSpline, Constraint};
use super::follower::{Cam, Direction, Follower, Side};
use super::lift::{FLANKS, Flank, Lift};
use super::limits::Load;
use super::shapes::Harmonics;
use crate::double_double::DoubleDouble;

/// Values in 60 digits as sums of two numbers, with the command that made them in `digits.py`.
const DIGITS: &str = include_str!("digits.txt");

/// Names of the quantities of a place, in the order of `digits.py`.
const QUANTITIES: [&str; 20] = [
    "pitch x",
    "pitch y",
    "contour x",
    "contour y",
    "rate x",
    "rate y",
    "contact x",
    "contact y",
    "centre x",
    "centre y",
    "normal x",
    "normal y",
    "radius",
    "radius of the pitch curve",
    "polar radius",
    "d²r/dϑ²",
    "pressure angle",
    "sliding",
    "along the face",
    "Hertz pressure",
];

fn law(name: &str) -> Lift {
    let flanks = |name: &str, height, durations| {
        let flank = FLANKS.iter().find(|(known, _)| *known == name).expect("a flank").1;
        Lift::flanks(flank, height, durations).expect("a law")
    };
    let even = |exponents: &[u32]| Lift::hump(exponents, 0.011, 2.8).expect("a law");
    match name {
        "even:2,6,8,10,12" => even(&[2, 6, 8, 10, 12]),
        "even:2,4,6" => even(&[2, 4, 6]),
        "polydyne" => even(&[2, 6, 8, 10, 12]).with_polydyne(0.0625).expect("a correction"),
        "ramps" => flanks("345", 0.01, [1.5, 0.5, 1.8]).with_ramps(0.00025, 0.5).expect("ramps"),
        "harmonics" => {
            let amplitudes = [[-0.0045, 0.0005], [0.0005, 0.00025], [0.0, -0.0001]];
            Lift::harmonics(Harmonics::new(0.004, &amplitudes).expect("harmonics"))
        }
        "bspline" => {
            let values = [(0.0, [0.0; 3]), (1.25, [0.0078125, 0.0, -0.015625]), (2.75, [0.0; 3])];
            let constraints: Vec<_> = values
                .into_iter()
                .flat_map(|(angle, values)| {
                    (0..3).zip(values).map(move |(order, value)| Constraint { angle, order, value })
                })
                .collect();
            let law = BSpline::new(5, &[0.0, 1.25, 1.25, 1.25, 2.75], &constraints, false);
            Lift::bspline(law.expect("a spline")).expect("a law")
        }
        flank => flanks(flank, 0.01, [1.5, 0.5, 1.8]),
    }
}

fn cam(follower: &str, sense: &str) -> Cam {
    let flanks = |height, durations| Lift::flanks(Flank::Polynomial4567, height, durations).expect("a law");
    let linear = || flanks(0.008, [1.5, 0.5, 1.8]);
    let hump = || law("even:2,6,8,10,12");
    let side = if follower.ends_with("left") { Side::Left } else { Side::Right };
    let pivot = [0.0625, 0.01];
    let rocker = |pivot, cam_pad, valve_pad| Follower::Rocker { pivot, cam_pad, radius: 0.012, valve_pad };
    let (law, follower) = match follower {
        "flat" => (linear(), Follower::Flat { base: 0.03 }),
        "roller" => (linear(), Follower::Roller { base: 0.025, radius: 0.008, offset: 0.006 }),
        "oscillating-flat-left" | "oscillating-flat-right" => (
            flanks(0.1, [1.4, 0.7, 1.75]),
            Follower::OscillatingFlat { base: 0.03, pivot, face: 0.004, side },
        ),
        "oscillating-roller-left" | "oscillating-roller-right" => {
            let follower = Follower::OscillatingRoller { base: 0.03, pivot, arm: 0.055, radius: 0.01, side };
            (flanks(0.3, [1.4, 0.7, 1.75]), follower)
        }
        "opener" => (hump(), rocker([0.019, -0.019], [0.001, -0.02398], [-0.012, -0.012])),
        "closer" => (hump(), rocker([0.023, -0.029], [0.0287, -0.0006], [-0.012, -0.032])),
        other => panic!("unknown follower {other}"),
    };
    let direction = if sense == "ccw" { Direction::CounterClockwise } else { Direction::Clockwise };
    Cam::new(law, follower, direction).expect("a cam")
}

/// Lines of the table that begin with `word`: two names, the angle, the values.
fn lines(word: &str, names: usize) -> impl Iterator<Item = (Vec<&'static str>, f64, Vec<DoubleDouble>)> {
    let of_word = DIGITS.lines().filter_map(move |line| line.strip_prefix(word)?.strip_prefix(' '));
    of_word.map(move |line| {
        let mut words = line.split(' ');
        let found: Vec<&str> = words.by_ref().take(names).collect();
        let numbers: Vec<f64> = words.map(|word| word.parse().expect("a number")).collect();
        let values = numbers[1..].chunks(2).map(|part| DoubleDouble { high: part[0], low: part[1] });
        (found, numbers[0], values.collect())
    })
}

#[test]
fn laws_agree_with_60_digits() {
    let (mut worst, mut count) = ((0.0_f64, ""), 0);
    for (names, theta, expected) in lines("law", 1) {
        let law = law(names[0]);
        let scales: [f64; 4] = core::array::from_fn(|order| {
            let samples = (0..720).map(|k| law.jet(law.origin() + f64::from(k).to_radians() / 2.0)[order]);
            samples.fold(0.0, |most: f64, value| most.max(value.abs()))
        });
        for ((found, expected), scale) in law.jet(theta).into_iter().zip(expected).zip(scales) {
            count += 1;
            let error = (DoubleDouble::new(found) - expected).high.abs() / scale;
            assert!(error < 4e-14, "{} at {theta}: {error:e}", names[0]);
            if worst.0 < error {
                worst = (error, names[0]);
            }
        }
    }
    // 13 laws at 11 angles.
    assert_eq!(count, 572);
    println!("laws, {count} values beside 60 digits: {:.1e} of their largest ({})", worst.0, worst.1);
}

#[test]
fn profiles_agree_with_60_digits() {
    let load = Load { force: 800.0, width: 0.012, modulus: 115e9 };
    let (mut worst, mut count) = ((0.0_f64, String::new()), 0);
    for (names, theta, expected) in lines("place", 2) {
        let cam = cam(names[0], names[1]);
        let place = cam.place(theta);
        let pressure = load.pressure(place.radius, cam.follower.pad());
        // A flank that is too hollow has none.
        let pressure = if pressure.is_finite() { pressure } else { 0.0 };
        let points =
            [place.pitch, place.contour, place.contour_rate, place.contact, place.centre, place.normal];
        let rest = [place.radius, place.pitch_radius, place.polar[0], place.polar[2]];
        let rest = rest.into_iter().chain([place.pressure, place.sliding, place.along, pressure]);
        let found = points.into_iter().flatten().chain(rest);
        for ((name, found), expected) in QUANTITIES.into_iter().zip(found).zip(expected) {
            let value = expected.high;
            let scale = match name {
                // 1/κ, where κ is small.
                "radius" | "radius of the pitch curve" => value.abs() * (1.0 + value.abs() / 0.01),
                "d²r/dϑ²" => 0.05 + 100.0 * value.abs(),
                "Hertz pressure" => value + 1.0,
                "pressure angle" | "normal x" | "normal y" => 1.0,
                _ => 0.05,
            };
            count += 1;
            let error = (DoubleDouble::new(found) - expected).high.abs() / scale;
            assert!(error < 4e-14, "{name} of {names:?} at {theta}: {error:e}, {value}");
            if worst.0 < error {
                worst = (error, format!("{name}, {}", names[0]));
            }
        }
    }
    // 8 followers in both senses at 8 angles.
    assert_eq!(count, 2560);
    println!("profiles, {count} values beside 60 digits: {:.1e} of their scales ({})", worst.0, worst.1);
}
