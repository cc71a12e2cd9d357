//! Circles, flat faces and curves on curves, against closed forms of ellipses: their places and normals lead the follower, so both
//! the foot and the gap are known before.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use mbs_runtime::driver::{ClosedCurve, Harmonic, Parametric, Polar};
use mbs_runtime::{Failure, FailureKind, Stepper, mechanism};

use crate::Waves;

/// [a cos s, b sin s].
#[derive(Clone, Copy)]
struct Ellipse {
    a: f64,
    b: f64,
}

impl Ellipse {
    fn components(self) -> [Harmonic; 2] {
        let wave = |amplitude, phase| Harmonic { offset: 0.0, amplitude, frequency: 1.0, phase };
        [wave(self.a, -FRAC_PI_2), wave(self.b, 0.0)]
    }

    fn place(self, s: f64) -> [f64; 2] {
        [self.a * s.cos(), self.b * s.sin()]
    }

    /// Direction of the outward normal.
    fn normal(self, s: f64) -> f64 {
        (self.a * s.sin()).atan2(self.b * s.cos())
    }

    /// Largest distance of a tangent with this normal from the centre.
    fn support(self, direction: f64) -> f64 {
        (self.a * direction.cos()).hypot(self.b * direction.sin())
    }
}

/// A place `at` in axes that stand at `origin`, turned by `angle`.
fn carried(origin: [f64; 2], angle: f64, at: [f64; 2]) -> [f64; 2] {
    let (sine, cosine) = angle.sin_cos();
    [origin[0] + cosine * at[0] - sine * at[1], origin[1] + sine * at[0] + cosine * at[1]]
}

/// Derivative of a place by differences of order 4, along the direction of `angle`.
fn speed_along(angle: f64, place: impl Fn(f64) -> [f64; 2]) -> f64 {
    const STEP: f64 = 1e-3;
    let rate = |k: usize| {
        let at = |h: f64| place(h)[k];
        (8.0 * (at(STEP) - at(-STEP)) - (at(2.0 * STEP) - at(-2.0 * STEP))) / (12.0 * STEP)
    };
    rate(0) * angle.cos() + rate(1) * angle.sin()
}

fn turns_apart(one: f64, other: f64) -> f64 {
    let turns = (one - other) / TAU;
    (turns - turns.round()).abs()
}

/// Largest errors so far: of gaps (m), of places (turns), of sliding speeds (m/s).
#[derive(Default)]
struct Worst([f64; 3]);

impl Worst {
    fn add(&mut self, errors: [f64; 3]) {
        self.0.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error.abs()));
    }

    fn judge(&self, what: &str) {
        let [gap, place, slip] = self.0;
        println!(
            "{what}: gap {gap:.1e} m of 1e-15, place {place:.1e} turns of 1e-9, sliding {slip:.1e} m/s of 1e-9"
        );
        assert!(gap < 1e-15 && place < 1e-9 && slip < 1e-9, "{what}: {:?}", self.0);
    }
}

const CENTRE: [f64; 2] = [0.005, -0.003];

mechanism! {
    /// A round pad on a turning ellipse, and its centre alone.
    pub mechanism Rolling;
    param a: m = 30mm;
    param b: m = 20mm;
    param rho: m = 6mm;
    param off: m = 2mm;
    param bound: m = 1mm;
    function x: m(rad), C4, periodic TAU;
    function y: m(rad), C4, periodic TAU;
    coord theta: rad;
    drive shaft: theta == 3 [rad/s]*t;
    let s = 0.2 + 1.7*t/1s;
    let n = [b*cos(s), a*sin(s)]/hypot(b*cos(s), a*sin(s));
    let A = [5mm, -3mm] + rot(theta)*([a*cos(s), b*sin(s)] + (rho + off*sin(5*t/1s))*n);
    curve rim = parametric x, y about [5mm, -3mm] turned theta;
    foot w of circle(A, rho) turned -2*t/1s on rim within bound near 0.2;
    foot u of A on rim within bound near 0.2;
    out pad: [m; 2] = [w_gap, u_gap - rho];
    out sliding: [m/s; 2] = [w_slip, u_slip];
    out direction: [1; 2] = w_normal;
}

#[test]
fn round_pads_on_ellipses_have_the_gap_that_leads_them() {
    let rim = Ellipse { a: 0.03, b: 0.02 };
    for (rho, off) in [(0.006, 0.002), (-0.006, 0.002)] {
        let [x, y] = rim.components();
        let [inside, _]: [f64; 2] = Parametric { x: &x, y: &y }.reach().expect("a reach");
        let rolling = Rolling { rho, off, bound: inside, ..Rolling::new(x, y) };
        let mut stepper = Stepper::assemble(rolling, [0.0, 0.2, 0.2], 0.0).expect("a foot");
        let mut worst = Worst::default();
        for k in 1..=400 {
            let t = 0.01 * f64::from(k);
            stepper.advance_to(t).expect("a foot below the reach");
            let s = |t: f64| 0.2 + 1.7 * t;
            let normal = |t: f64| rim.normal(s(t)) + 3.0 * t;
            let gap = |t: f64| off * (5.0 * t).sin();
            let foot = |t: f64| carried(CENTRE, 3.0 * t, rim.place(s(t)));
            let outputs = stepper.outputs().map(|output| output.value);
            let [w, u] = [stepper.q()[1], stepper.q()[2]];
            assert!(turns_apart(w, u) < 1e-12 && (outputs[0] - outputs[1]).abs() < 1e-15, "{outputs:?}");
            assert!(
                (outputs[4] - normal(t).cos()).abs() < 1e-9 && (outputs[5] - normal(t).sin()).abs() < 1e-9
            );
            // Velocities of the centre, of the cam's place, and of the pad's place that turns with it.
            let tangent = normal(t) + FRAC_PI_2;
            let far = |t: f64| carried(foot(t), normal(t), [rho + gap(t), 0.0]);
            let centre = speed_along(tangent, |h| far(t + h));
            let cam = speed_along(tangent, |h| carried(CENTRE, 3.0 * (t + h), rim.place(s(t))));
            let touch = speed_along(tangent, |h| carried(far(t + h), normal(t) - 2.0 * h, [-rho, 0.0]));
            let slips = [outputs[2] - (touch - cam), outputs[3] - (centre - cam)];
            worst.add([outputs[0] - gap(t), turns_apart(w, s(t)), slips[0].abs().max(slips[1].abs())]);
        }
        worst.judge(&format!("a round pad of {rho} m"));
    }
}

mechanism! {
    /// A flat face that turns on a turning ellipse, and one on a polar curve.
    pub mechanism Flats;
    param flattest: m = 1mm;
    param polar_flattest: m = 1mm;
    param from: rad = 0;
    function x: m(rad), C4, periodic TAU;
    function y: m(rad), C4, periodic TAU;
    function pitch: m(rad), C4, periodic TAU;
    coord theta: rad;
    drive shaft: theta == from + 3 [rad/s]*t;
    let P = [9mm + 2mm*sin(4*t/1s), 28mm + 1mm*cos(5*t/1s)];
    let alpha = 90deg + 0.4*sin(2*t/1s);
    curve rim = parametric x, y about [5mm, -3mm] turned theta;
    curve cam = polar pitch about [5mm, -3mm] turned theta;
    foot w of flat(P, alpha) on rim within flattest near 90deg;
    foot u of flat(P, alpha) on cam within polar_flattest near 90deg;
    out gaps: [m; 2] = [w_gap, u_gap];
    out sliding: m/s = w_slip;
}

const RIM: Ellipse = Ellipse { a: 0.03, b: 0.02 };

const CAM: Waves = Waves { second: 3.0, third: 0.6 };

fn flats(flattest: f64, from: f64) -> Result<Stepper<Flats<Harmonic, Harmonic, Waves>, f64, 3>, Failure> {
    let [x, y] = RIM.components();
    let near = FRAC_PI_2 - from;
    let polar_flattest = Polar(&CAM.bounded()).flattest().expect("a convex curve");
    Stepper::assemble(
        Flats { flattest, polar_flattest, from, ..Flats::new(x, y, CAM) },
        [from, near, near],
        0.0,
    )
}

#[test]
fn flat_faces_rest_on_the_farthest_place_of_a_curve() {
    let [x, y] = RIM.components();
    let flattest: f64 = Parametric { x: &x, y: &y }.flattest().expect("a convex curve");
    let mut stepper = flats(flattest, 0.0).expect("feet");
    let (mut worst, mut polar) = (Worst::default(), 0.0_f64);
    for k in 1..=400 {
        let t = 0.01 * f64::from(k);
        stepper.advance_to(t).expect("convex curves");
        let point = |t: f64| [0.009 + 0.002 * (4.0 * t).sin(), 0.028 + 0.001 * (5.0 * t).cos()];
        let alpha = |t: f64| FRAC_PI_2 + 0.4 * (2.0 * t).sin();
        let beside = |t: f64| {
            let p = point(t);
            (p[0] - CENTRE[0]) * alpha(t).cos() + (p[1] - CENTRE[1]) * alpha(t).sin()
        };
        let seen = alpha(t) - 3.0 * t;
        let outputs = stepper.outputs().map(|output| output.value);
        // The normal [b cos s, a sin s] has the direction of the face.
        let s = (RIM.b * seen.sin()).atan2(RIM.a * seen.cos());
        let foot = carried(CENTRE, 3.0 * t, RIM.place(s));
        let tangent = alpha(t) + FRAC_PI_2;
        let cam_side = speed_along(tangent, |h| carried(CENTRE, 3.0 * (t + h), RIM.place(s)));
        // The place of the face in its own axes.
        let from = [foot[0] - point(t)[0], foot[1] - point(t)[1]];
        let own = carried([0.0; 2], -alpha(t), from);
        let face = speed_along(tangent, |h| carried(point(t + h), alpha(t + h), [0.0, own[1]]));
        worst.add([
            outputs[0] - (beside(t) - RIM.support(seen)),
            turns_apart(stepper.q()[1], s),
            outputs[2] - (face - cam_side),
        ]);
        polar = polar.max((outputs[1] - (beside(t) - farthest(seen))).abs());
    }
    worst.judge("a flat face on an ellipse");
    println!("a flat face on a polar curve: {polar:.1e} m of 1e-15");
    assert!(polar < 1e-15, "{polar:e}");
}

/// Largest R cos(w − direction), by golden section about the largest of 720 samples.
fn farthest(direction: f64) -> f64 {
    const SECTION: f64 = 0.618_033_988_749_894_9;
    let along = |w: f64| CAM.radius(w) * (w - direction).cos();
    let at = |k: u32| TAU * f64::from(k) / 720.0;
    let best = (0..720).max_by(|a, b| along(at(*a)).total_cmp(&along(at(*b)))).expect("samples");
    let (mut from, mut to) = (at(best) - at(1), at(best) + at(1));
    while to - from > 1e-9 {
        let (a, b) = (to - SECTION * (to - from), from + SECTION * (to - from));
        if along(a) > along(b) { to = b } else { from = a }
    }
    along(0.5 * (from + to))
}

#[test]
fn a_flank_that_is_flatter_than_stated_is_refused() {
    let is_reach = |failure: &Failure| matches!(failure.kind, FailureKind::BeyondLimit { limit, .. } if limit.name == "w_reach");
    // The largest radius of curvature is a²/b = 45 mm, at the start and after a part of a turn.
    let refused = flats(0.0449, 0.0).map(|_| ()).expect_err("the flat flank");
    assert!(is_reach(&refused), "{refused}");
    let mut stepper = flats(0.0449, 1.0).expect("feet");
    let refused = (1..=600).find_map(|k| stepper.advance_to(0.002 * f64::from(k)).err());
    assert!(refused.as_ref().is_some_and(is_reach), "{refused:?}");
}

mechanism! {
    /// Two ellipses, the second one led by the places and normals of both.
    pub mechanism Pair;
    param a: m = 30mm;
    param b: m = 20mm;
    param c: m = 18mm;
    param e: m = 12mm;
    param bound: m = 1mm;
    function x: [m; 2](rad), C4, periodic TAU;
    function y: [m; 2](rad), C4, periodic TAU;
    coord theta: rad;
    drive shaft: theta == 3 [rad/s]*t;
    let s = 0.2 + 1.7*t/1s;
    let r = 0.4 + 1.1*t/1s;
    let n = [b*cos(s), a*sin(s)]/hypot(b*cos(s), a*sin(s));
    let psi = theta + atan2(a*sin(s), b*cos(s)) + PI - atan2(c*sin(r), e*cos(r));
    let middle = [5mm, -3mm] + rot(theta)*([a*cos(s), b*sin(s)] + 2mm*sin(5*t/1s)*n)
        - rot(psi)*[c*cos(r), e*sin(r)];
    curve rim = parametric x[0], y[0] about [5mm, -3mm] turned theta;
    curve pad = parametric x[1], y[1] about middle turned psi;
    foot w of pad at v on rim within bound near 0.2, 0.4;
    out gap: m = w_gap;
    out sliding: m/s = w_slip;
}

#[test]
fn ellipses_on_ellipses_have_the_gap_that_leads_them() {
    let pad = Ellipse { a: 0.018, b: 0.012 };
    let ([x, y], [u, v]) = (RIM.components(), pad.components());
    let both = [Parametric { x: &x, y: &y }, Parametric { x: &u, y: &v }];
    let [deep, far]: [f64; 2] = both[0].pair_reach(&both[1]).expect("convex curves");
    let pair = Pair { bound: deep.min(far), ..Pair::new([x, u], [y, v]) };
    let mut stepper = Stepper::assemble(pair, [0.0, 0.2, 0.4], 0.0).expect("a pair of feet");
    let mut worst = Worst::default();
    for k in 1..=400 {
        let t = 0.01 * f64::from(k);
        stepper.advance_to(t).expect("a pair of feet");
        let (s, r) = (|t: f64| 0.2 + 1.7 * t, |t: f64| 0.4 + 1.1 * t);
        let gap = |t: f64| 0.002 * (5.0 * t).sin();
        let normal = |t: f64| RIM.normal(s(t)) + 3.0 * t;
        let psi = |t: f64| normal(t) + PI - pad.normal(r(t));
        let middle = |t: f64| {
            let foot = carried(CENTRE, 3.0 * t, RIM.place(s(t)));
            let [x, y] = pad.place(r(t));
            carried(carried(foot, normal(t), [gap(t), 0.0]), psi(t), [-x, -y])
        };
        let tangent = normal(t) + FRAC_PI_2;
        let cam = speed_along(tangent, |h| carried(CENTRE, 3.0 * (t + h), RIM.place(s(t))));
        let other = speed_along(tangent, |h| carried(middle(t + h), psi(t + h), pad.place(r(t))));
        let outputs = stepper.outputs().map(|output| output.value);
        let [w, v] = [stepper.q()[1], stepper.q()[2]];
        let apart = turns_apart(w, s(t)).max(turns_apart(v, r(t)));
        worst.add([outputs[0] - gap(t), apart, outputs[1] - (other - cam)]);
    }
    worst.judge("an ellipse on an ellipse");
}

mechanism! {
    /// A pad that is led over the hollow of a cam, farther and farther off.
    pub mechanism OverHollow;
    param bound: m = 1mm;
    function pitch: m(rad), C3, periodic TAU;
    function x: m(rad), C3, periodic TAU;
    function y: m(rad), C3, periodic TAU;
    let s = 90deg + 0.5*sin(9*t/1s);
    let r = 1.1 + 3*t/1s;
    let radius = 30mm + 12mm*cos(2*s);
    let slope = -24mm*sin(2*s);
    let n = (radius*unit(s) - slope*[-sin(s), cos(s)])/hypot(radius, slope);
    let psi = atan2(n.1, n.0) + PI - atan2(6mm*sin(r), 4mm*cos(r));
    let middle = radius*unit(s) + (0.2mm + 1.5 [mm/s]*t)*n - rot(psi)*[6mm*cos(r), 4mm*sin(r)];
    curve cam = polar pitch about [0m, 0m];
    curve pad = parametric x, y about middle turned psi;
    foot w of pad at v on cam within bound near 90deg, 1.1;
    out gap: m = w_gap;
    out place: [m; 2] = middle;
    out turned: [1; 2] = unit(psi);
}

#[test]
fn no_other_pair_of_places_is_nearer_within_the_reach_of_a_pair() {
    const SAMPLES: u32 = 180;
    let pad = Ellipse { a: 0.006, b: 0.004 };
    let ([x, y], cam) = (pad.components(), crate::WAIST.bounded());
    let [deep, far]: [f64; 2] = Polar(&cam).pair_reach(&Parametric { x: &x, y: &y }).expect("one is convex");
    // The hollow has the radius 18²/30 mm, the pad's flattest place 6²/4 mm.
    assert!(far > 0.0017 && far < 0.0018 && far < deep, "{deep} {far}");
    let over = OverHollow { bound: far, ..OverHollow::new(crate::WAIST, x, y) };
    let mut stepper = Stepper::assemble(over, [FRAC_PI_2, 1.1], 0.0).expect("a pair of feet");
    let angles = || (0..SAMPLES).map(|k| TAU * f64::from(k) / f64::from(SAMPLES));
    let places: Vec<[f64; 2]> =
        angles().map(|w| [crate::WAIST.radius(w) * w.cos(), crate::WAIST.radius(w) * w.sin()]).collect();
    let refused = (1..=400).find_map(|k| {
        let t = 0.01 * f64::from(k);
        if let Err(failure) = stepper.advance_to(t) {
            return Some((t, failure));
        }
        let [gap, mx, my, cosine, sine] = stepper.outputs().map(|output| output.value);
        assert!((gap - 2e-4 - 1.5e-3 * t).abs() < 1e-15, "{gap} at {t} s");
        if k % 10 == 0 {
            let other: Vec<_> =
                angles().map(|v| carried([mx, my], sine.atan2(cosine), pad.place(v))).collect();
            let apart = |one: &[f64; 2]| {
                other.iter().map(|o| (o[0] - one[0]).hypot(o[1] - one[1])).fold(1.0, f64::min)
            };
            let nearest = places.iter().map(apart).fold(1.0, f64::min);
            assert!(gap < nearest, "{gap} is not the least: {nearest}");
        }
        None
    });
    let (t, failure) = refused.expect("the gap grows");
    let is_reach = |failure: &Failure| matches!(failure.kind, FailureKind::BeyondLimit { limit, .. } if limit.name == "w_reach");
    assert!(is_reach(&failure) && (far - 2e-4 - 1.5e-3 * t).abs() < 2e-5, "{t} {failure}");
    // From guesses on the far sides of both: a pair of feet too, with a gap far below the depth.
    let refused = Stepper::assemble(over, [-FRAC_PI_2, 1.1 + PI], 0.0).map(|_| ());
    assert!(refused.as_ref().is_err_and(is_reach), "{refused:?}");
}
