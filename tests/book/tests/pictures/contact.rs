//! Restitution of contacts, rigid contacts, clearance.

use crate::texts::{Bounces, Disk, Latched, Loose, PinInEye, Touches};
use crate::{curve, hold, level, plot, spans};

const LAWS: [&str; 4] = ["exact", "Hunt and Crossley", "Lankarani and Nikravesh", "Flores and others"];

#[test]
fn force_over_depth() {
    let text: Touches = Touches { e: 0.5, ..Touches::default() };
    let seen = traced!(text, 0.012, 480, |run| (*run.q(), run.outputs().map(|push| push.value)));
    let looped = |law: usize| {
        let closed = seen.iter().filter(|(x, _)| x[law] < 0.0);
        let within = closed.map(|(x, push)| [-1e3 * x[law], push[law]]);
        curve(LAWS[law], [[0.0; 2]].into_iter().chain(within).chain([[0.0; 2]]).collect())
    };
    let curves = (0..4).map(looped).collect();
    let axes = ["depth (mm)", "force (N)"];
    hold("contact_loop", &plot("Force of a contact over its depth, loading and unloading", axes, curves));
}

/// Shares of the speed that return by the four laws.
fn returned(e: f64, v: f64) -> [f64; 4] {
    let text: Touches = Touches { e, v, ..Touches::default() };
    let seen = traced!(text, 1e-3 / v + 0.1, 1, |run| (*run.q(), *run.qd()));
    let (x, rates) = seen[1];
    assert!(x.iter().all(|x| *x > 0.0), "{e} {v}: {x:?}");
    rates.map(|rate| rate / v)
}

#[test]
fn restitution_over_what_is_asked() {
    let shares: Vec<(f64, [f64; 4])> =
        (2..=40).map(|part| 0.025 * f64::from(part)).map(|e| (e, returned(e, 0.5))).collect();
    assert!(shares.iter().all(|(e, found)| (found[0] - e).abs() < 1e-6), "{shares:?}");
    let curves =
        (0..4).map(|law| curve(LAWS[law], shares.iter().map(|(e, found)| [*e, found[law]]).collect()));
    let axes = ["restitution asked for (1)", "restitution found (1)"];
    hold("restitution_asked", &plot("Restitution found over the one asked for", axes, curves.collect()));
}

#[test]
fn restitution_over_the_speed_at_touch() {
    let speeds = (1..=40).map(|part| 0.05 * f64::from(part));
    let shares: Vec<(f64, [f64; 4])> = speeds.clone().map(|v| (v, returned(0.8, v))).collect();
    let latched = speeds.map(|v| {
        let text: Latched = Latched { v };
        let seen = traced!(text, 1e-3 / v + 0.1, 1, |run| run.qd()[0]);
        [v, seen[1] / v]
    });
    let latched: Vec<[f64; 2]> = latched.collect();
    assert!(latched.iter().all(|[_, share]| (share - 0.8).abs() < 1e-6), "{latched:?}");
    let mut curves: Vec<_> = (0..4)
        .map(|law| curve(LAWS[law], shares.iter().map(|(v, found)| [*v, found[law]]).collect()))
        .collect();
    curves.push(curve("latched speed", latched));
    let axes = ["speed at touch (m/s)", "restitution found (1)"];
    hold("restitution_speed", &plot("Restitution over the speed at touch", axes, curves));
}

#[test]
fn bounces_that_end() {
    let fallen = |e: f64| -> Vec<[f64; 3]> {
        traced!(Bounces { e }, 3.2, 640, |run| [run.t(), run.q()[0], run.qd()[0]])
    };
    let (hard, soft) = (fallen(0.7), fallen(0.5));
    let rests = spans(hard.iter().map(|[t, y, rate]| (*t, y.abs() < 1e-9 && rate.abs() < 1e-9)));
    // √(2 h/g) (1 + e)/(1 − e)
    let end = (2.0_f64 / 9.81).sqrt() * 1.7 / 0.3;
    assert!(rests.len() == 1 && (rests[0][0] - end).abs() < 0.01, "{rests:?} {end}");
    let drawn = |label: &str, seen: &[[f64; 3]]| curve(label, seen.iter().map(|p| [p[0], p[1]]).collect());
    let curves = vec![drawn("e = 0.7", &hard), drawn("e = 0.5", &soft)];
    let mut picture = plot("Height of a bouncing ball", ["time (s)", "height (m)"], curves);
    picture.marks = Some(("at rest, e = 0.7".to_string(), rests));
    hold("bounces", &picture);
}

#[test]
fn a_disk_that_is_thrown_without_spin() {
    let seen = traced!(Disk::<f64>::default(), 2.0, 400, |run| [run.t(), run.qd()[0], -0.1 * run.qd()[2]]);
    // It rolls at two thirds of its speed.
    let [_, centre, rim] = seen[400];
    assert!((centre - 2.0 / 3.0).abs() < 1e-9 && (rim - centre).abs() < 1e-9, "{centre} {rim}");
    let drawn = |label: &str, of: usize| curve(label, seen.iter().map(|p| [p[0], p[of]]).collect());
    let curves = vec![drawn("centre", 1), drawn("rim", 2)];
    hold("disk", &plot("Speed of a disk and of its rim", ["time (s)", "speed (m/s)"], curves));
}

#[test]
fn a_slider_with_play() {
    let seen = traced!(Loose::<f64>::default(), 0.03, 600, |run| {
        let (height, tilt) = (run.q()[5], run.q()[8]);
        [1e3 * run.t(), 1e3 * (height - 0.05 * tilt.sin()), 1e3 * (height + 0.05 * tilt.sin())]
    });
    let drawn = |label: &str, of: usize| curve(label, seen.iter().map(|p| [p[0], p[of]]).collect());
    let curves = vec![
        drawn("end towards the crank", 1),
        drawn("far end", 2),
        level("upper wall", [0.0, 30.0], 1.0),
        level("lower wall", [0.0, 30.0], -1.0),
    ];
    hold("clearance", &plot("A slider between two walls", ["time (ms)", "height (mm)"], curves));
}

#[test]
fn a_pin_with_play_in_its_eye() {
    let seen =
        traced!(PinInEye::<f64>::default(), 0.5, 500, |run| [run.t(), run.outputs()[0].value, run.q()[2]]);
    // Of the ideal joint: m = 1 kg, l = 0.2 m, J = 0.02 + 0.04 kg·m², ω² = −2 m g l sin φ / J, α = −m g l cos φ / J.
    let ideal = |phi: f64| {
        let (sine, cosine) = phi.sin_cos();
        let (along, across) =
            (9.81 * sine + 2.0 * 0.04 * 9.81 * sine / 0.06, 9.81 * cosine * (1.0 - 0.04 / 0.06));
        along.hypot(across)
    };
    let late = seen.iter().filter(|[t, ..]| *t > 0.1);
    let apart = late.map(|[_, push, phi]| (push - ideal(*phi)).abs()).fold(0.0, f64::max);
    assert!(apart < 1.0, "{apart} N");
    let curves = vec![
        curve("with play", seen.iter().map(|[t, push, _]| [1e3 * t, *push]).collect()),
        curve("ideal joint", seen.iter().map(|[t, _, phi]| [1e3 * t, ideal(*phi)]).collect()).dashed(),
    ];
    hold("pin_in_eye", &plot("Force of a pin in its eye", ["time (ms)", "force (N)"], curves));
}
