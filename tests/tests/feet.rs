//! Feet of perpendiculars on curves, against a bracketed minimization of the distance.
#![forbid(unsafe_code)]

#[path = "feet/followers.rs"]
mod followers;
#[path = "feet/hollows.rs"]
mod hollows;

use core::f64::consts::{PI, TAU};

use mbs_runtime::driver::{Bounded, nearest_foot, reach};
use mbs_runtime::{Failure, FailureKind, Function, Stepper, mechanism};

/// R = 30 + a cos 2w + b cos 3w (mm).
#[derive(Clone, Copy, Debug)]
struct Waves {
    second: f64,
    third: f64,
}

impl Waves {
    /// Reach inside and outside, by the largest third derivative.
    fn reach(self) -> [f64; 2] {
        reach(&self.bounded()).expect("a reach")
    }

    fn bounded(self) -> Bounded<Self> {
        Bounded { function: self, third: 1e-3 * (8.0 * self.second.abs() + 27.0 * self.third.abs()) }
    }

    fn radius(&self, w: f64) -> f64 {
        1e-3 * (30.0 + self.second * (2.0 * w).cos() + self.third * (3.0 * w).cos())
    }
}

impl Function<f64> for Waves {
    const ORDER: usize = 3;

    fn jet<const K: usize>(&self, w: f64) -> [f64; K] {
        core::array::from_fn(|order| {
            let part = |size: f64, n: f64| {
                1e-3 * size * n.powi(order as i32) * (n * w + order as f64 * PI / 2.0).cos()
            };
            let mean = if order == 0 { 0.03 } else { 0.0 };
            mean + part(self.second, 2.0) + part(self.third, 3.0)
        })
    }
}

mechanism! {
    /// A point that circles about a cam that turns, and its foot on the cam.
    pub mechanism Circling;
    param far: m = 33mm;
    param breath: m = 0mm;
    param from: rad = 0.2;
    param pace: 1 = 0.7;
    param bound: m = 1mm;
    function pitch: m(rad), C3, periodic TAU;
    coord theta: rad;
    let centre = [5mm, -3mm];
    curve cam = polar pitch about centre turned theta;
    drive shaft: theta == 3 [rad/s]*t;
    let A = centre + (far + breath*sin(7 [rad/s]*t))*unit(from - pace*t/1s);
    foot w of A on cam within bound near 0.2;
    out gap: m = w_gap;
    out place: [m; 2] = place(w, cam);
    out first_order: m = distance(A, cam);
}

/// The least distance of a point in the axes of the cam from the curve, negative inside, and its angle: samples, then a golden section
/// in each bracket.
fn nearest(cam: &Waves, [x, y]: [f64; 2]) -> [f64; 2] {
    const SAMPLES: usize = 720;
    const SECTION: f64 = 0.618_033_988_749_894_9;
    let off = |w: f64| (cam.radius(w) * w.cos() - x).hypot(cam.radius(w) * w.sin() - y);
    let mut best = [f64::INFINITY, 0.0];
    for k in 0..SAMPLES {
        let at = |k: usize| TAU * k as f64 / SAMPLES as f64;
        let [before, here, after] = [at(k) - TAU / SAMPLES as f64, at(k), at(k + 1)];
        if off(here) > off(before) || off(here) > off(after) {
            continue;
        }
        let (mut from, mut to) = (before, after);
        while to - from > 1e-9 {
            let (a, b) = (to - SECTION * (to - from), from + SECTION * (to - from));
            if off(a) < off(b) { to = b } else { from = a }
        }
        let w = 0.5 * (from + to);
        if off(w) < best[0] {
            best = [off(w), w];
        }
    }
    let inside = x.hypot(y) < cam.radius(y.atan2(x));
    [if inside { -best[0] } else { best[0] }, best[1]]
}

/// Distance and foot of a stepper's instant by minimization.
fn minimized(cam: &Waves, circling: &Circling<Waves>, t: f64) -> [f64; 2] {
    let r = circling.far + circling.breath * (7.0 * t).sin();
    let angle = circling.from - circling.pace * t - 3.0 * t;
    nearest(cam, [r * angle.cos(), r * angle.sin()])
}

fn start(circling: Circling<Waves>) -> Result<Stepper<Circling<Waves>, f64, 2>, Failure> {
    Stepper::assemble(circling, [0.0, 0.2], 0.0)
}

#[test]
fn distances_to_feet_are_the_least_ones() {
    let cam = Waves { second: 3.0, third: 1.0 };
    let [inside, outside] = cam.reach();
    // Outside, inside, and across the curve.
    for (far, breath) in [(0.045, 0.002), (0.022, 0.001), (0.031, 0.004)] {
        let bound = inside.min(outside);
        let circling = Circling { far, breath, bound, ..Circling::new(cam) };
        let mut stepper = start(circling).expect("a foot");
        let (mut largest, mut first_order) = (0.0_f64, 0.0_f64);
        for k in 1..=500 {
            stepper.advance_to(0.01 * f64::from(k)).expect("a foot below the reach");
            let [distance, foot] = minimized(&cam, &circling, stepper.t());
            let outputs = stepper.outputs();
            let found = outputs.as_ref();
            largest = largest.max((found[0].value - distance).abs());
            first_order = first_order.max((found[3].value - distance).abs());
            let turns = (stepper.q()[1] - foot) / TAU;
            if k % 100 == 0 {
                let r = circling.far + circling.breath * (7.0 * stepper.t()).sin();
                let (y, x) = (circling.from - circling.pace * stepper.t() - 3.0 * stepper.t()).sin_cos();
                let bounded = nearest_foot(&cam.bounded(), [r * x, r * y]).expect("one foot is the nearest");
                assert!((bounded.distance - distance).abs() < 1e-15, "{bounded:?} {distance}");
            }
            assert!((turns - turns.round()).abs() < 1e-7, "{k}: {} {foot}", stepper.q()[1]);
        }
        println!(
            "foot at {far} m: {largest:.1e} m of 1e-15, first order {first_order:.1e} m, reach {bound:.4} m"
        );
        assert!(largest < 1e-15, "{largest:e}");
        assert!(first_order > 1e-6, "the distance of first order is another one: {first_order:e}");
    }
}

/// A waist of 36 mm across its middle.
const WAIST: Waves = Waves { second: 12.0, third: 0.0 };

/// A point on the axis of the waist that stands still in the axes of the cam.
fn across(far: f64, bound: f64) -> Circling<Waves> {
    Circling { far, bound, from: PI / 2.0, pace: -3.0, ..Circling::new(WAIST) }
}

/// Moves the point across from 17 mm above the middle to 10 mm below it. Returns the largest error of the distance to its foot, and
/// the place at which it is refused.
fn moved_across(bound: f64) -> (f64, Option<(f64, Failure)>) {
    let mut stepper = Stepper::assemble(across(0.017, bound), [0.0, PI / 2.0], 0.0).expect("a foot");
    let mut wrong = 0.0_f64;
    for k in 1..=100 {
        let far = 0.017 - 0.027 * f64::from(k) / 100.0;
        stepper.change(|circling| circling.far = far);
        if let Err(failure) = stepper.advance(0.0) {
            return (wrong, Some((far, failure)));
        }
        let [distance, _] = nearest(&WAIST, [0.0, far]);
        wrong = wrong.max((stepper.outputs().as_ref()[0].value - distance).abs());
    }
    (wrong, None)
}

#[test]
fn a_foot_beyond_the_reach_is_refused_before_another_one_is_nearer() {
    let [inside, _] = WAIST.reach();
    let is_reach = |failure: Failure| matches!(failure.kind, FailureKind::BeyondLimit { limit, .. } if limit.name == "w_reach");
    // A bound beyond the reach, which nothing backs, keeps the foot that the motion began with.
    let (wrong, refused) = moved_across(1.0);
    assert!(wrong > 0.019 && refused.is_none(), "{wrong} {refused:?}");
    let (wrong, refused) = moved_across(inside);
    let (far, failure) = refused.expect("the middle is as far from both flanks");
    println!("refused {far} m above the middle, distances to {wrong:.1e} m until then");
    // The first place refused is at most a step of 0.27 mm beyond the bound.
    let beyond = 0.018 - far - inside;
    assert!(wrong < 1e-15 && (0.0..2.7e-4).contains(&beyond) && is_reach(failure), "{far} {failure}");
    // The same at the start: from a guess on the far flank.
    let refused = Stepper::assemble(across(0.010, inside), [0.0, -PI / 2.0], 0.0).map(|_| ());
    assert!(refused.is_err_and(is_reach));
}
