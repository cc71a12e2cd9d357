//! Cam joints with the place of the contact as a coordinate of its own, against closed forms of circles.
#![forbid(unsafe_code)]

use core::f64::consts::TAU;

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_runtime::{Function, Stepper, mechanism};

/// Polar radius of a circle whose centre lies `beside` the curve's centre: e cos w + √(ρ² − e² sin² w).
#[derive(Clone, Copy, Debug)]
struct Eccentric {
    beside: f64,
    radius: f64,
}

impl Function<f64> for Eccentric {
    const ORDER: usize = 3;

    fn jet<const K: usize>(&self, w: f64) -> [f64; K] {
        let (sine, cosine) = w.sin_cos();
        let e = self.beside;
        let inside = self.radius * self.radius - e * e * sine * sine;
        let root = inside.sqrt();
        // g = ρ² − e² sin² w and its derivatives; h = √g.
        let g = [
            -2.0 * e * e * sine * cosine,
            -2.0 * e * e * (cosine * cosine - sine * sine),
            8.0 * e * e * sine * cosine,
        ];
        let h1 = g[0] / (2.0 * root);
        let h2 = (g[1] - 2.0 * h1 * h1) / (2.0 * root);
        let h3 = (g[2] - 6.0 * h1 * h2) / (2.0 * root);
        let all = [e * cosine + root, -e * sine + h1, -e * cosine + h2, e * sine + h3];
        core::array::from_fn(|order| all.get(order).copied().unwrap_or(f64::NAN))
    }
}

const CAM: Eccentric = Eccentric { beside: 0.008, radius: 0.025 };

mechanism! {
    /// A follower on a cam, its distance by the foot of the perpendicular.
    pub mechanism ByFoot;
    param speed: rad/s = 3000rpm;
    function pitch: m(rad), C3, periodic TAU;
    coord theta: rad = 0;
    coord y: m = 30mm;
    curve cam = polar pitch about [0m, 0m] turned theta;
    foot w of [0m, y] on cam within 24mm near 60deg;
    drive shaft: theta == speed*t;
    body follower { mass: 100gram, com: [0, y] }
    tsda spring { from: [0, 90mm], to: [0, y], stiffness: 4000, length: 80mm }
    contact face {
        gap: w_gap,
        stiffness: 1e8,
        exponent: 1.5,
        depth: 1mm,
        damping: 0.3
    }
    start theta = 0 rate speed;
    start y = 34mm rate 0;
}

mechanism! {
    /// The same from the distance of two centres.
    pub mechanism ByCentres;
    param speed: rad/s = 3000rpm;
    coord theta: rad = 0;
    coord y: m = 30mm;
    drive shaft: theta == speed*t;
    body follower { mass: 100gram, com: [0, y] }
    tsda spring { from: [0, 90mm], to: [0, y], stiffness: 4000, length: 80mm }
    contact face {
        gap: norm([0m, y] - 8mm*unit(theta)) - 25mm,
        stiffness: 1e8,
        exponent: 1.5,
        depth: 1mm,
        damping: 0.3
    }
    start theta = 0 rate speed;
    start y = 34mm rate 0;
}

/// Heights (m) of the follower over two turns.
macro_rules! heights {
    ($mechanism:expr) => {{
        let mechanism = $mechanism;
        let method: Explicit<DormandPrince8, Projection> = Explicit::default();
        let run = Simulation::start_from_text(mechanism, method, 0.0).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(1e-11));
        let mut found = Vec::new();
        run.watch(2.0 * TAU / mechanism.speed, 200, |run| {
            found.push([run.q()[1], run.q()[2.min(run.q().len() - 1)]])
        })
        .expect("it moves");
        found
    }};
}

#[test]
fn a_contact_by_the_foot_of_the_perpendicular_is_exact() {
    let (by_foot, by_centres) = (heights!(ByFoot::<_, f64>::new(CAM)), heights!(ByCentres::<f64>::default()));
    let apart = by_foot.iter().zip(&by_centres).map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f64::max);
    let stroke = by_centres.iter().fold(0.0_f64, |most, y| most.max((y[0] - by_centres[0][0]).abs()));
    println!("contact by the foot: {apart:.1e} m of 1e-9, stroke {:.1} mm", 1e3 * stroke);
    assert!(apart < 1e-9 && stroke > 5e-3, "{apart:e} {stroke}");
}

mechanism! {
    /// A flat face that rises on a cam, and a second cam that a cam turns.
    pub mechanism FlatAndPair;
    function pitch: m(rad), C3, periodic TAU;
    coord theta: rad = 0.3;
    coord y: m = 26mm;
    drive shaft: theta == 0.3 + 1 [rad/s]*t;
    curve cam = polar pitch about [0m, 0m] turned theta;
    foot u of flat([0m, y], 90deg) on cam within 26mm near 70deg;
    constraint touches { u_gap == 0m; }

    coord psi: rad = 1.9;
    curve other = polar pitch about [60mm, 0mm] turned psi;
    foot v of other at w on cam within 20mm near -15deg, 75deg;
    constraint meets { v_gap == 0m; }
    out height: m = y;
    out turned: rad = psi;
}

#[test]
fn flat_faces_and_pairs_of_curves_meet_as_circles_do() {
    let mut stepper =
        Stepper::assemble(FlatAndPair::<_, f64>::new(CAM), [0.3, 0.027, 1.2, 1.9, -0.3, 1.3], 0.0)
            .expect("an assembly");
    let mut worst = [0.0_f64; 2];
    // Further on the second cam is out of reach.
    for step in 0..80 {
        let t = f64::from(step) * 0.01;
        stepper.advance_to(t).expect("a position");
        let outputs = stepper.outputs();
        let [height, turned] = [outputs.as_ref()[0].value, outputs.as_ref()[1].value];
        let theta = 0.3 + t;
        worst[0] = worst[0].max((height - (0.025 + 0.008 * theta.sin())).abs());
        // Both centres stay two radii apart.
        let [a, b] =
            [[0.008 * theta.cos(), 0.008 * theta.sin()], [0.06 + 0.008 * turned.cos(), 0.008 * turned.sin()]];
        worst[1] = worst[1].max(((b[0] - a[0]).hypot(b[1] - a[1]) - 0.05).abs());
    }
    println!("flat on a curve: {:.1e} m, curve on curve: {:.1e} m of 1e-14", worst[0], worst[1]);
    assert!(worst.iter().all(|worst| *worst < 1e-14), "{worst:?}");
}

/// Circle that does not surround the cam's centre, so it has no polar radius: a coordinate of e [1, 0] + ρ [cos φ, sin φ], with
/// φ = u + sin(u)/3 so that the point does not move evenly.
#[derive(Clone, Copy, Debug)]
struct Round {
    /// 0 for x, a quarter of a turn for y, as the phase of cos(φ − phase).
    phase: f64,
    beside: f64,
}

impl Function<f64> for Round {
    const ORDER: usize = 3;

    fn jet<const K: usize>(&self, u: f64) -> [f64; K] {
        let (sine, cosine) = (u + u.sin() / 3.0 - self.phase).sin_cos();
        let [f1, f2, f3] = [1.0 + u.cos() / 3.0, -u.sin() / 3.0, -u.cos() / 3.0];
        let all = [
            self.beside + 0.025 * cosine,
            -0.025 * sine * f1,
            -0.025 * (cosine * f1 * f1 + sine * f2),
            -0.025 * (3.0 * cosine * f1 * f2 + sine * (f3 - f1 * f1 * f1)),
        ];
        core::array::from_fn(|order| all.get(order).copied().unwrap_or(f64::NAN))
    }
}

mechanism! {
    /// A follower on a rocking cam with a parameter, its distance by the foot of the perpendicular.
    pub mechanism ByParameter;
    param speed: rad/s = 3000rpm;
    function px: m(rad), C3, periodic TAU;
    function py: m(rad), C3, periodic TAU;
    coord theta: rad = 90deg;
    coord y: m = 56mm;
    curve rim = parametric px, py about [0m, 0m] turned theta;
    foot u of [0m, y] on rim within 24mm near 0;
    drive shaft: theta == 90deg + 25deg*sin(speed*t);
    body follower { mass: 100gram, com: [0, y] }
    tsda spring { from: [0, 120mm], to: [0, y], stiffness: 4000, length: 80mm }
    contact face {
        gap: u_gap,
        stiffness: 1e8,
        exponent: 1.5,
        depth: 1mm,
        damping: 0.3
    }
    start y = 56mm rate 0;
}

mechanism! {
    /// The same from the distance of two centres.
    pub mechanism ByBoth;
    param speed: rad/s = 3000rpm;
    coord theta: rad = 90deg;
    coord y: m = 56mm;
    drive shaft: theta == 90deg + 25deg*sin(speed*t);
    body follower { mass: 100gram, com: [0, y] }
    tsda spring { from: [0, 120mm], to: [0, y], stiffness: 4000, length: 80mm }
    contact face {
        gap: norm([0m, y] - 30mm*unit(theta)) - 25mm,
        stiffness: 1e8,
        exponent: 1.5,
        depth: 1mm,
        damping: 0.3
    }
    start y = 56mm rate 0;
}

#[test]
fn a_curve_with_a_parameter_need_not_surround_its_centre() {
    let [px, py] = [(0.0, 0.03), (0.25 * TAU, 0.0)].map(|(phase, beside)| Round { phase, beside });
    let by_parameter = heights!(ByParameter::<_, _, f64>::new(px, py));
    let by_both = heights!(ByBoth::<f64>::default());
    let apart = by_parameter.iter().zip(&by_both).map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f64::max);
    let stroke = by_both.iter().fold(0.0_f64, |most, y| most.max((y[0] - by_both[0][0]).abs()));
    println!("contact by a parameter: {apart:.1e} m of 1e-9, stroke {:.1} mm", 1e3 * stroke);
    assert!(apart < 1e-9 && stroke > 2e-3, "{apart:e} {stroke}");
}

mechanism! {
    /// A flat-faced follower, and one whose foot is a cam too, each with clearance and friction.
    pub mechanism Faces;
    param speed: rad/s = 3000rpm;
    function pitch: m(rad), C4, periodic TAU;
    coord theta: rad = 0;
    coord y: [m; 2] = [27mm, 52mm];
    drive shaft: theta == speed*t;
    curve cam = polar pitch about [0m, 0m] turned theta;
    curve pad = polar pitch about [0m, y[1]] turned -60deg;
    foot u of flat([0m, y[0]], 90deg) on cam within 26mm near 90deg;
    foot v of pad at w on cam within 49mm near 80deg, 330deg;
    for i in 0..2 { body followers { mass: 100gram, com: [0, y[i]] } }
    tsda above { from: [0, 90mm], to: [0, y[0]], stiffness: 4000, length: 80mm }
    tsda behind { from: [0, 130mm], to: [0, y[1]], stiffness: 4000, length: 100mm }
    contact face { gap: u_gap, stiffness: 1e8, exponent: 1.5, depth: 1mm, damping: 0.3 }
    contact nose { gap: v_gap, stiffness: 1e8, exponent: 1.5, depth: 1mm, damping: 0.3 }
    force rub: -0.1*normal(nose)*tanh(v_slip/10 [cm/s])*v_tangent on y[1]*[0, 1];
    start theta = 0 rate speed;
    start y = [27mm, 55mm] rate [0, 0];
}

mechanism! {
    /// The same from places of centres, normals and velocities of circles.
    pub mechanism FacesByCentres;
    param speed: rad/s = 3000rpm;
    coord theta: rad = 0;
    coord y: [m; 2] = [27mm, 52mm];
    drive shaft: theta == speed*t;
    let centre = 8mm*unit(theta);
    let other = [0m, y[1]] + 8mm*unit(-60deg);
    let n = (other - centre)/norm(other - centre);
    let along = [-n.1, n.0];
    // The cam's place at the contact turns with it; the pad does not turn.
    let touch = centre + 25mm*n;
    let slip = dot([0 [m/s], der(y[1])] - der(theta)*[-touch.1, touch.0], along);
    for i in 0..2 { body followers { mass: 100gram, com: [0, y[i]] } }
    tsda above { from: [0, 90mm], to: [0, y[0]], stiffness: 4000, length: 80mm }
    tsda behind { from: [0, 130mm], to: [0, y[1]], stiffness: 4000, length: 100mm }
    contact face { gap: y[0] - 8mm*sin(theta) - 25mm, stiffness: 1e8, exponent: 1.5, depth: 1mm, damping: 0.3 }
    contact nose { gap: norm(other - centre) - 50mm, stiffness: 1e8, exponent: 1.5, depth: 1mm, damping: 0.3 }
    force rub: -0.1*normal(nose)*tanh(slip/10 [cm/s])*along on y[1]*[0, 1];
    start theta = 0 rate speed;
    start y = [27mm, 55mm] rate [0, 0];
}

#[test]
fn flat_faces_and_pads_with_clearance_are_exact() {
    let by_feet = heights!(Faces::<_, f64>::new(CAM));
    let by_centres = heights!(FacesByCentres::<f64>::default());
    let apart = by_feet.iter().zip(&by_centres).map(|(a, b)| (a[0] - b[0]).abs().max((a[1] - b[1]).abs()));
    let apart = apart.fold(0.0, f64::max);
    let stroke =
        |k: usize| by_centres.iter().fold(0.0_f64, |most, y| most.max((y[k] - by_centres[0][k]).abs()));
    println!(
        "flat face and pad with clearance: {apart:.1e} m of 1e-9, strokes {:.4} and {:.4} m",
        stroke(0),
        stroke(1)
    );
    assert!(apart < 1e-9 && stroke(0) > 5e-3 && stroke(1) > 5e-3, "{apart:e}");
}
